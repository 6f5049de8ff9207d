import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely import Point, Polygon
from shapely.affinity import rotate, scale
from shapes import SHAPES, outline

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.outline_file import read_outline
from hydrostat.geometry.inflate import inflate, torsion
from hydrostat.geometry.surface import Surface
from hydrostat.geometry.triangles.triangulate import triangulate
from hydrostat.units import LENGTH, parse_quantity

EXAMPLES = Path(__file__).parents[2] / "examples"
FLAT = [
    (path.parent, body)
    for path in sorted(EXAMPLES.glob("*/robot.toml"))
    if "outline" in (body := tomllib.loads(path.read_text(encoding="utf-8"))["body"])
]


def ellipse(across: float, up: float) -> Polygon:
    """An ellipse [mm] with so many corners that they play no part."""
    return scale(Point(0, 0).buffer(1.0, quad_segs=512), across, up)


def handles(surface: Surface) -> int:
    """Holes through a surface, after checking that it is one closed, oriented surface without pinches.

    Every edge must be run along once in either direction, and the triangles round a vertex must be one fan.
    """
    edges = np.concatenate([surface.triangles[:, [0, 1]], surface.triangles[:, [1, 2]], surface.triangles[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert np.array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))
    count = len(surface.vertices)
    assert np.array_equal(np.unique(surface.triangles), np.arange(count))
    parts, _ = connected_components(coo_array((np.ones(len(edges)), edges.T), shape=(count, count)), directed=False)
    assert parts == 1
    follow = {}
    for a, b, c in surface.triangles.tolist():
        follow[a, b], follow[b, c], follow[c, a] = c, a, b
    degree = np.bincount(surface.triangles.ravel())
    for a, b in {a: (a, b) for a, b in follow}.values():
        step, steps = follow[a, b], 1
        while step != b:
            step, steps = follow[a, step], steps + 1
        assert steps == degree[a]
    assert surface.volume > 0
    return 1 - (count - len(edges) // 2 + len(surface.triangles)) // 2


@pytest.mark.parametrize("up", [100.0, 45.0])
@pytest.mark.slow
def test_ellipse_becomes_an_ellipsoid(up: float) -> None:
    """Oracle: 2/3 of area times height; the error falls with the power 3/2 of the spacing, over two halvings."""
    errors = []
    for spacing in (0.016, 0.008, 0.004):
        surface = inflate(outline(ellipse(100, up)), 0.04, spacing=spacing)
        errors.append(abs(surface.volume / (2 / 3 * np.pi * 0.1 * 1e-3 * up * 0.04) - 1))
        inner = surface.vertices[np.abs(surface.vertices[:, 2]) > 0.008]
        x, y, z = (inner / [0.1, 1e-3 * up, 0.02]).T
        assert np.abs(np.sqrt(x * x + y * y + z * z) - 1).max() < 6 * spacing
    assert errors[-1] < 0.01
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.4


@pytest.mark.slow
def test_torsion_of_an_ellipse() -> None:
    """Oracle: u = (1 - x^2/a^2 - y^2/b^2) / (2/a^2 + 2/b^2), with second order in the spacing."""
    errors = []
    for spacing in (0.016, 0.008, 0.004):
        mesh = triangulate(outline(ellipse(100, 60)), spacing)
        a, b = 0.1, 0.06
        x, y = mesh.nodes.T
        exact = (1 - (x / a) ** 2 - (y / b) ** 2) / (2 / a**2 + 2 / b**2)
        errors.append(np.sqrt(np.mean((torsion(mesh) - exact) ** 2)) / exact.max())
    assert errors[-1] < 5e-3
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.6


@pytest.mark.parametrize("name", SHAPES)
def test_closed_and_mirrored(name: str) -> None:
    """Oracle: Euler's formula: a handle for each hole; each vertex has its mirror image; the height is as asked."""
    polygon, element_size = SHAPES[name]
    surface = inflate(outline(polygon), 0.02, spacing=1e-3 * element_size)
    assert handles(surface) == len(polygon.interiors)
    vertices = {tuple(vertex) for vertex in surface.vertices.tolist()}
    assert vertices == {(x, y, -z) for x, y, z in vertices}
    assert surface.box[:, 2] == pytest.approx([-0.01, 0.01], rel=1e-12)
    rim = surface.vertices[surface.vertices[:, 2] == 0.0]
    away = [polygon.boundary.distance(Point(1e3 * x, 1e3 * y)) for x, y, _ in rim]
    assert max(away) < 0.25 * element_size
    assert len(rim) > 8


@pytest.mark.parametrize(("folder", "body"), FLAT, ids=[folder.name for folder, _ in FLAT])
def test_gallery(folder: Path, body: dict[str, str]) -> None:
    """Oracle: one closed surface, its volume between that of a cone and that of a slab over the same outline."""
    lengths = {key: parse_quantity(body[key], LENGTH) for key in ("size", "element_size", "thickness") if key in body}
    shape = read_outline((folder / body["outline"]).read_bytes(), name=body["outline"], size=lengths.get("size"))
    surface = inflate(shape, lengths["thickness"], spacing=lengths["element_size"])
    assert handles(surface) == len(shape.holes)
    assert 1 / 3 < surface.volume / (shape.area * lengths["thickness"]) < 0.8


def test_arms_are_thinner_than_the_belly() -> None:
    """Oracle: far from its ends a strip of width w has u = w^2 / 8, the belly of radius R about R^2 / 4."""
    belly = Point(0, 0).buffer(50, quad_segs=64)
    body = belly.union(Polygon([(0, -10), (150, -10), (150, 10), (0, 10)]))
    surface = inflate(outline(body), 0.05, spacing=0.005)
    x, y, z = 1e3 * surface.vertices.T
    arm = z[(np.abs(x - 100) < 8) & (np.abs(y) < 4)].max()
    assert arm == pytest.approx(25 * np.sqrt(20**2 / 8 / (50**2 / 4)), rel=0.06)


@pytest.mark.slow
def test_turned_outline_gives_turned_surface() -> None:
    """Oracle: the volume is that of the outline as it was; the same outline twice gives the same bytes."""
    polygon, element_size = SHAPES["star"]
    spacing = 0.5e-3 * element_size
    first, again = (inflate(outline(polygon), 0.02, spacing=spacing) for _ in range(2))
    assert first.vertices.tobytes() == again.vertices.tobytes()
    assert first.triangles.tobytes() == again.triangles.tobytes()
    turned = inflate(outline(rotate(polygon, 30)), 0.02, spacing=spacing)
    assert turned.volume == pytest.approx(first.volume, rel=0.01)


@pytest.mark.parametrize("height", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_height(height: float) -> None:
    """Oracle: the message names the value."""
    with pytest.raises(InputError, match=f"the height must be positive, not {height} m"):
        inflate(outline(ellipse(10, 10)), height, spacing=0.002)


def test_bad_spacing() -> None:
    """Oracle: the message names the argument and what would do."""
    for spacing in (0.5, 1e-7, 0.0):
        with pytest.raises(InputError, match=r"spacing: ") as caught:
            inflate(outline(ellipse(10, 10)), 0.02, spacing=spacing)
        assert not isinstance(caught.value, OutlineError)
