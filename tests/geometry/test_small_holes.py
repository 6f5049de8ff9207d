"""Small holes of clean parts. Oracles: volumes in closed form, Euler characteristics, winding numbers."""

import numpy as np
import pytest
from manifold3d import Manifold
from solids import euler

from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.sizing import TooManyNodesError, size_for
from hydrostat.geometry.surface import Solid, Surface
from hydrostat.geometry.tetrahedra.small_holes import fill_small_holes
from hydrostat.geometry.tetrahedra.tetrahedralize import fit, tetrahedralize


def plate() -> Manifold:
    return Manifold.cube((60, 30, 4))


def of(body: Manifold) -> Surface:
    """A body in millimeters as a surface in meters."""
    mesh = body.to_mesh()
    return Surface(1e-3 * np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts))


def drill(diameter: float, length: float, at: tuple[float, float, float], turn: tuple[float, float, float]) -> Manifold:
    """A hole of 24 sides that starts at a point."""
    return Manifold.cylinder(length, diameter / 2, diameter / 2, 24).rotate(turn).translate(at)


def holes(diameter: float, count: int = 10) -> Manifold:
    body = plate()
    for number in range(count):
        body -= drill(diameter, 6, (4 + 5.5 * number, 8 + 5 * (number % 3), -1), (0, 0, 0))
    return body


def peg(radius: float, length: float) -> Manifold:
    return Manifold.cylinder(length + 1, radius, radius, 24).translate((30, 15, 3))


def test_a_plate_of_holes_becomes_a_box() -> None:
    """Oracle: the box's volume, 60 x 30 x 4 mm, and its Euler characteristic; each hole at its middle."""
    body = of(holes(1.5))
    filled = fill_small_holes(body, 0.002)
    assert (euler(body), euler(filled.surface)) == (2 - 20, 2)
    assert filled.surface.volume == pytest.approx(7.2e-6, rel=1e-9)
    assert len(filled) == 10
    assert filled.widths == pytest.approx(np.full(10, 1.5e-3), rel=0.02)
    assert sorted(filled.places[:, 0]) == pytest.approx(1e-3 * (4 + 5.5 * np.arange(10)), abs=1e-5)
    assert filled.places[:, 2] == pytest.approx(np.full(10, 2e-3))
    assert "10 holes up to 1.5 mm wide" in filled.describe(0.002)


KEPT = {
    "wider holes": lambda: holes(2.5),
    "slot": lambda: plate() - Manifold.cube((30, 1, 6)).translate((15, 15, -1)),
    "gap between fingers": lambda: plate() - Manifold.cube((40, 1.5, 6)).translate((25, 14, -1)),
    "groove": lambda: plate() - Manifold.cube((40, 1, 2)).translate((10, 14, 3)),
    "ring": lambda: (
        plate() - (Manifold.cylinder(3, 10, 10, 48) - Manifold.cylinder(3, 9, 9, 48)).translate((30, 15, 2))
    ),
    "grooved peg": lambda: plate() + (peg(0.5, 11) + peg(1.05, 1) + peg(1.05, 6).translate((0, 0, 5))),
    "peg": lambda: plate() + Manifold.cylinder(5, 0.8, 0.8, 24).translate((30, 15, 3)),
    "neck": lambda: (
        plate()
        - Manifold.cube((1.5, 14, 6)).translate((30, -0.1, -1))
        - Manifold.cube((1.5, 14, 6)).translate((30, 16.1, -1))
    ),
}


@pytest.mark.parametrize("name", KEPT)
def test_what_is_no_small_hole_stays(name: str) -> None:
    body = of(KEPT[name]())
    filled = fill_small_holes(body, 0.002)
    assert len(filled) == 0
    assert filled.surface is body


def test_blind_crossing_and_inner_holes() -> None:
    """A blind hole, two that cross, one into a chamber, a bubble: the chamber stays as a cavity, the rest is full."""
    body = Manifold.cube((40, 30, 20))
    chamber = Manifold.cube((10, 12, 10)).translate((25, 9, 5))
    body -= chamber + drill(1.5, 30, (-1, 15, 10), (0, 90, 0)) + drill(1.5, 22, (10, 15, -1), (0, 0, 0))
    body -= drill(1.2, 8, (18, 8, 15), (0, 0, 0)) + Manifold.sphere(0.7, 24).translate((5, 5, 5))
    filled = fill_small_holes(of(body), 0.002)
    assert euler(filled.surface) == 4
    assert filled.surface.volume == pytest.approx(40 * 30 * 20e-9 - 10 * 12 * 10e-9, rel=1e-4)


def test_a_channel_that_ends_at_narrow_gaps() -> None:
    """Three blocks on a web, 1.5 mm apart, with a channel through all: the channel goes, the gaps stay."""
    blocks = Manifold.cube((60, 10, 3))
    for number in range(3):
        blocks += Manifold.cube((19, 10, 12)).translate((20.5 * number, 0, 0))
    body = of(blocks - drill(1.5, 70, (-5, 5, 8), (0, 90, 0)))
    filled = fill_small_holes(body, 0.002)
    assert len(filled) == 3
    assert filled.surface.volume == pytest.approx(of(blocks).volume, rel=1e-9)


def test_sides_of_points_by_the_nearest_triangle() -> None:
    """Oracle: winding numbers; points about edges and corners, and in a part with long thin triangles."""
    body = of(holes(2.5) + Manifold.cylinder(12, 6, 0.2, 7).translate((30, 15, 3)))
    points = np.random.default_rng(5).uniform(body.box[0] - 2e-3, body.box[1] + 2e-3, (18_000, 3))
    spike = Manifold.cylinder(12, 6, 0, 7).rotate((0, 25, 0)).translate((30, 15, 3))
    leaning = of(plate() + spike)
    tip = leaning.vertices[np.argmax(leaning.vertices[:, 2])]
    near = tip + np.random.default_rng(5).normal(0, 3e-3, (2000, 3))
    for surface, places in ((body, points), (leaning, near)):
        fast, slow = Solid(surface, clean=True).distances(places), Solid(surface).distances(places)
        np.testing.assert_array_equal(fast, slow)


def test_a_mesh_without_small_holes_takes_few_nodes() -> None:
    """The plate with holes of half an element: as many nodes as the plate alone, near its boundary."""
    mesh = tetrahedralize(of(holes(1.5)), 0.003)
    assert len(mesh.nodes) == len(tetrahedralize(of(plate()), 0.003).nodes)
    assert fit(mesh, Solid(of(plate())), 1e-3).largest < 0.3e-3


def test_too_many_nodes_say_where_and_how_many() -> None:
    """Slots as narrow as half an element stay: a few nodes cannot be had, and the place named is at a slot."""
    body = plate()
    for number in range(6):
        body -= Manifold.cube((1.5, 20, 6)).translate((8 + 8 * number, 5, -1))
    with pytest.raises(TooManyNodesError, match=r"near \((\S+), .* mm is thinner. Ask for \d+ nodes or more") as found:
        tetrahedralize(of(body), 0.004, most_nodes=700)
    assert found.value.count > 700
    x = float(str(found.value).split("(")[1].split(",")[0])
    assert min(abs(x - (8.75 + 8 * number)) for number in range(6)) < 4.5


def test_a_search_that_finds_only_too_many_ends_soon() -> None:
    tries = []

    def make(trial: float) -> None:
        tries.append(trial)
        raise TooManyNodesError("too many", 1700)

    size = size_for(1000, make, content=1e-5, rim=6e-3, dim=3, is_hasty=True)  # pyright: ignore
    assert size == tries[0]
    assert len(tries) <= 3
    assert issubclass(TooManyNodesError, InputError)


def test_thin_walls_are_tried_with_finer_elements() -> None:
    """Coarser elements are refined at thin walls, so that they need more nodes than finer ones."""
    tries = []

    def make(trial: float) -> Mesh:
        tries.append(trial)
        if trial == tries[0]:
            raise TooManyNodesError("too many", 4800)
        return Mesh(np.zeros((1900, 3)), np.zeros((0, 4), dtype=int))

    assert size_for(1000, make, content=1e-5, rim=6e-3, dim=3, is_hasty=True) == tries[1]
    assert tries[1] == pytest.approx(0.8 * tries[0], rel=0.01)
    assert len(tries) == 2


def test_finer_elements_that_do_not_help_are_left() -> None:
    """Bumps smaller than the elements: a first mesh within half an element is kept."""
    body = Manifold.cube((40, 20, 8))
    for number in range(8):
        body += Manifold.sphere(0.9, 12).translate((3 + 5 * number, 10, 8))
    mesh = tetrahedralize(of(body), 0.0035)
    assert len(mesh.nodes) < 500  # 568 with the rounds that do not help
    assert fit(mesh, Solid(of(body)), 0.001).largest < 0.5 * 0.0035
