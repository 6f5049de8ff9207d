"""Element sizes for a number of nodes. Oracle: the mesh of that size, counted."""

import numpy as np
import pytest
import shapes
from shapely import box
from solids import Maker, ball, brick, moved, ring, two_fingers

from hydrostat.errors import InputError, SurfaceError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.sizing import COUNT_TOLERANCE, MAX_NODES, size_for
from hydrostat.geometry.tetrahedra.tetrahedralize import tetrahedralize
from hydrostat.geometry.triangles.triangulate import triangulate

SOLIDS: dict[str, tuple[Maker, int]] = {
    "ball": (ball, 300),
    "ring": (ring, 900),
    "rod": (lambda: moved(brick(0.3, 0.01, 0.01), turned=0.3), 1000),
    "fingers": (lambda: two_fingers(0.01), 900),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLIDS)
def test_within_a_tenth_in_space(name: str) -> None:
    maker, nodes = SOLIDS[name]
    body, counts = maker(), {}

    def make(trial: float) -> Mesh:
        mesh = tetrahedralize(body, trial)
        counts[trial] = len(mesh.nodes)
        return mesh

    size = size_for(nodes, make, content=body.volume, dim=3)
    assert counts[size] == pytest.approx(nodes, rel=COUNT_TOLERANCE)
    assert float(f"{1e3 * size:.3g}") == pytest.approx(1e3 * size, rel=1e-12)  # short in a file


@pytest.mark.slow
@pytest.mark.parametrize(("name", "nodes"), [("star", 250), ("letter s", 600), ("annulus", 80)])
def test_within_a_tenth_in_the_plane(name: str, nodes: int) -> None:
    drawn = shapes.outline(shapes.SHAPES[name][0])
    size = size_for(nodes, lambda trial: triangulate(drawn, trial), content=drawn.area, dim=2)
    assert len(triangulate(drawn, size).nodes) == pytest.approx(nodes, rel=COUNT_TOLERANCE)


def _of_nodes(count: float) -> Mesh:
    """A mesh of one triangle, and nodes that it does not use."""
    nodes = np.concatenate([[[0.0, 0], [1, 0], [0, 1]], np.zeros((int(np.clip(count, 3, 20_000)) - 3, 2))])
    return Mesh(nodes, np.array([[0, 1, 2]]))


@pytest.mark.parametrize("power", [1.5, 2.0, 3.5])
@pytest.mark.parametrize("factor", [0.2, 1.0, 50.0])
def test_found_whatever_the_law_and_the_first_guess(power: float, factor: float) -> None:
    """Closed form: nodes = 1000 (factor / size)^power."""
    size = size_for(1000, lambda trial: _of_nodes(1000 * (factor / trial) ** power), content=1000.0, dim=3)
    assert size == pytest.approx(factor, rel=0.1)


def test_a_mesher_that_jumps_gives_the_nearest() -> None:
    """By hand: 70 nodes above 2 m, 160 below; of both 160 is nearer to 120 in proportion."""
    assert size_for(120, lambda trial: _of_nodes(70 if trial > 2.0 else 160), content=1e3, dim=2) <= 2.0


@pytest.mark.parametrize("nodes", [-1, 0, 9, MAX_NODES + 1])
def test_numbers_out_of_range(nodes: int) -> None:
    with pytest.raises(InputError, match="the number of nodes must be from 10 to 200000, not "):
        size_for(nodes, lambda trial: _of_nodes(trial), content=1.0, dim=3)


@pytest.mark.slow
def test_too_few_for_the_shape_gives_what_comes_nearest() -> None:
    """A long thin rod needs more than 12 nodes: of all sizes that are tried the fewest."""
    body, counts = brick(0.3, 0.01, 0.01), []

    def make(trial: float) -> Mesh:
        mesh = tetrahedralize(body, trial)
        counts.append(len(mesh.nodes))
        return mesh

    size = size_for(12, make, content=body.volume, dim=3)
    assert len(tetrahedralize(body, size).nodes) == min(counts) > 12


def test_a_plate_is_told_how_many_nodes_it_needs_before_any_is_meshed() -> None:
    """By hand: 200 x 150 x 2 mm in elements of 2 mm are 15,000 cubes."""

    def make(trial: float) -> Mesh:
        raise AssertionError

    body = brick(0.2, 0.15, 0.002)
    with pytest.raises(InputError, match=r"so thin \(1.95 mm on average\) needs about [0-9]{5} nodes, not 900"):
        size_for(900, make, content=body.volume, rim=body.area, dim=3)


def test_too_many_for_memory_gives_what_comes_nearest() -> None:
    """Only sizes of 4 m and more are meshed, with at most 100 nodes: as if too fine below."""

    def make(trial: float) -> Mesh:
        if trial < 4.0:
            raise InputError("would be about 1e9")
        return _of_nodes(400 / trial)

    assert 4.0 <= size_for(5000, make, content=1000.0, dim=3) < 8.0


@pytest.mark.slow
def test_thin_bodies_are_found_beyond_sizes_that_are_refused() -> None:
    """The first guess is thicker than the plate, which the mesher refuses; smaller ones follow."""
    body = brick(0.1, 0.1, 0.005)
    with pytest.raises(SurfaceError):
        tetrahedralize(body, 0.008)
    size = size_for(2500, lambda trial: tetrahedralize(body, trial), content=20 * body.volume, dim=3)
    assert len(tetrahedralize(body, size).nodes) == pytest.approx(2500, rel=COUNT_TOLERANCE)


def test_a_body_that_is_always_refused_says_why() -> None:
    def make(trial: float) -> Mesh:
        raise SurfaceError("thinner than a hair")

    with pytest.raises(InputError, match="no element size gives about 500 nodes: thinner than a hair"):
        size_for(500, make, content=1.0, dim=3)


@pytest.mark.slow
def test_a_square_in_the_plane_by_closed_form() -> None:
    """Triangles of side h have area sqrt(3)/4 h^2 and there are two for each node: h^2 = 2 / sqrt(3) A / n, about."""
    drawn = shapes.outline(box(0, 0, 100, 100))
    size = size_for(2000, lambda trial: triangulate(drawn, trial), content=drawn.area, dim=2)
    assert size == pytest.approx(np.sqrt(2 / np.sqrt(3) * 0.01 / 2000), rel=0.1)
