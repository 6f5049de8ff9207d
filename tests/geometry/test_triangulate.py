import tomllib
from pathlib import Path

import numpy as np
import pytest
from geometry.shapes import SHAPES, blob, crossing_bars, disc, outline
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiLineString, box, distance, get_coordinates, points
from shapely.affinity import rotate

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry import Mesh, Outline, read_outline, triangulate


def boundary_distance(shape: Outline, mesh: Mesh) -> float:
    """Two-sided Hausdorff distance between outline and mesh boundary [m], by shapely."""
    sides = MultiLineString([mesh.nodes[side] for side in mesh.boundary])
    rings = MultiLineString([np.concatenate([ring, ring[:1]]) for ring in shape.rings])
    return max(_reach(sides, rings), _reach(rings, sides))


def _reach(one: MultiLineString, other: MultiLineString) -> float:
    """Largest distance from some lines to others [m], at every 0.2 mm."""
    return float(distance(points(get_coordinates(one.segmentize(2e-4))), other).max())


def check(shape: Outline, mesh: Mesh, element_size: float, least_angle: float) -> None:
    """Angles, boundary, topology (Euler: nodes - edges + elements = 1 - holes), nodes all used, edges of the size."""
    assert mesh.smallest_angle() >= least_angle
    assert boundary_distance(shape, mesh) <= element_size / 5
    assert len(mesh.nodes) - len(mesh.edges) + len(mesh.elements) == 1 - len(shape.holes)
    assert np.array_equal(np.unique(mesh.elements), np.arange(len(mesh.nodes)))
    assert mesh.volumes.sum() == pytest.approx(shape.area, rel=0.03)
    starts, ends = np.sort(mesh.boundary[:, 0]), np.sort(mesh.boundary[:, 1])
    assert np.array_equal(starts, np.unique(starts))
    assert np.array_equal(starts, ends)


@pytest.mark.parametrize("name", SHAPES)
def test_known_shapes(name: str) -> None:
    """Oracle: shapely's distances and areas, Euler's formula; 30 degrees is what Delaunay refinement could promise."""
    polygon, size = SHAPES[name]
    shape = outline(polygon)
    check(shape, triangulate(shape, 1e-3 * size), 1e-3 * size, least_angle=30)


@pytest.mark.slow
@given(st.integers(0, 10_000))
@settings(max_examples=6, deadline=None, derandomize=True)
def test_smooth_blobs(seed: int) -> None:
    """Oracle: as for the known shapes."""
    polygon, size = blob(seed)
    shape = outline(polygon)
    mesh = triangulate(shape, 1e-3 * size)
    check(shape, mesh, 1e-3 * size, least_angle=30)
    sides = np.linalg.norm(mesh.nodes[mesh.edges[:, 0]] - mesh.nodes[mesh.edges[:, 1]], axis=1)
    assert sides.mean() == pytest.approx(1e-3 * size, rel=0.15)


@pytest.mark.parametrize("seed", range(6))
def test_crossing_bars(seed: int) -> None:
    """Oracle: as for the known shapes; two bars may meet in a corner of less than 60 degrees of air, never of body."""
    polygon, size = crossing_bars(seed)
    shape = outline(polygon)
    check(shape, triangulate(shape, 1e-3 * size), 1e-3 * size, least_angle=25)


def test_same_bytes_twice() -> None:
    """Oracle: the first run."""
    polygon, size = SHAPES["star"]
    first, second = (triangulate(outline(polygon), 1e-3 * size) for _ in range(2))
    assert first.nodes.tobytes() == second.nodes.tobytes()
    assert first.elements.tobytes() == second.elements.tobytes()


def test_corners_stay() -> None:
    """Oracle: the corners of the drawing."""
    polygon, size = SHAPES["letter e"]
    shape = outline(rotate(polygon.simplify(0), 17))
    mesh = triangulate(shape, 1e-3 * size)
    away = np.linalg.norm(shape.exterior[:, None] - mesh.nodes, axis=2).min(axis=1)
    assert away.max() < 1e-9
    assert mesh.volumes.sum() == pytest.approx(shape.area, rel=1e-12)


def test_thin_neck_is_finer() -> None:
    """Oracle: a neck of half an element gets edges of about its width, and the heads keep theirs."""
    polygon, size = SHAPES["dumbbell"]
    mesh = triangulate(outline(polygon), 1e-3 * size)
    middle = mesh.nodes[mesh.edges].mean(axis=1)
    length = np.linalg.norm(mesh.nodes[mesh.edges[:, 0]] - mesh.nodes[mesh.edges[:, 1]], axis=1)
    assert length[np.abs(middle[:, 0]) < 0.01].max() < 0.0075
    assert length[np.abs(middle[:, 0]) > 0.05].mean() == pytest.approx(0.01, rel=0.15)


def test_too_thin() -> None:
    """Oracle: a neck of 1 mm at the origin asks for elements of 6 mm at most; these then work."""
    shape = outline(disc(30, -50).union(disc(30, 50)).union(box(-50, -0.5, 50, 0.5)))
    with pytest.raises(OutlineError, match=r"only 1 mm wide near \(.*too thin for elements of 12 mm.* 6 mm or less"):
        triangulate(shape, 0.012)
    check(shape, triangulate(shape, 0.0055), 0.0055, least_angle=25)


@pytest.mark.parametrize(
    ("element_size", "message"),
    [
        (0.0, "must be positive, not 0.0 m"),
        (-1.0, "must be positive"),
        (float("nan"), "must be positive, not nan"),
        (0.1, "too large for a body of 100 mm: take .* mm or less"),
        (1e-4, "at most 200000 are made: take .* mm or more"),
    ],
)
def test_element_size_refused(element_size: float, message: str) -> None:
    """Oracle: the message names the value and the remedy, in one line."""
    with pytest.raises(InputError, match=message) as caught:
        triangulate(outline(disc(50)), element_size)
    assert "\n" not in str(caught.value)


def test_the_angle_check_can_fail() -> None:
    """Oracle: a right triangle with legs 1 and sqrt(3) has 30 degrees, one with legs 1 and 10 has atan(0.1)."""
    for side, expected in ((3**0.5, 30.0), (10.0, np.degrees(np.arctan(0.1)))):
        mesh = Mesh(np.array([[0.0, 0.0], [side, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]]))
        assert mesh.smallest_angle() == pytest.approx(expected)


EXAMPLES = [
    path
    for path in sorted(Path(__file__).parents[2].glob("examples/*/robot.toml"))
    if "outline" in tomllib.loads(path.read_text(encoding="utf-8"))["body"]
]


SIZES = ("size", "element_size")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.parent.name)
def test_examples(path: Path) -> None:
    """Oracle: as for the known shapes."""
    body = tomllib.loads(path.read_text(encoding="utf-8"))["body"]
    size, element_size = (1e-3 * float(body[key].removesuffix("mm")) if key in body else None for key in SIZES)
    assert element_size is not None
    shape = read_outline((path.parent / body["outline"]).read_bytes(), name=body["outline"], size=size)
    check(shape, triangulate(shape, element_size), element_size, least_angle=30)
