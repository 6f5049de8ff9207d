"""Contours against closed forms: volumes, areas, Euler characteristics, and what a manifold is."""

import numpy as np
import pytest

from hydrostat.errors import SurfaceError
from hydrostat.geometry.contour import contour
from hydrostat.geometry.surface import Surface


def _sphere(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points - [0.01, -0.02, 0.003], axis=1) - 0.05


def _torus(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    return np.hypot(np.hypot(x, y) - 0.06, z) - 0.02


_BOX = np.array([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]])
_SHAPES = {
    "sphere": (_sphere, 4 / 3 * np.pi * 0.05**3, 4 * np.pi * 0.05**2, 2),
    "torus": (_torus, 2 * np.pi**2 * 0.06 * 0.02**2, 4 * np.pi**2 * 0.06 * 0.02, 0),
}


def _euler(surface: Surface) -> int:
    sides = surface.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    return len(np.unique(surface.triangles)) - len(edges) + len(surface.triangles)


def _assert_closed_and_manifold(surface: Surface) -> None:
    """Each edge has two triangles that run along it in opposite ways; the triangles at each vertex are one fan."""
    import igl

    sides = surface.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    directed, counts = np.unique(sides, axis=0, return_counts=True)
    assert counts.max() == 1
    np.testing.assert_array_equal(np.unique(directed[:, ::-1], axis=0), directed)
    assert np.all(igl.is_vertex_manifold(surface.triangles))
    assert np.linalg.norm(surface.crosses, axis=1).min() > 0.0


@pytest.mark.parametrize("name", _SHAPES)
def test_volume_and_area_converge_to_closed_forms_with_order_two(name: str) -> None:
    field, volume, area, euler = _SHAPES[name]
    surfaces = [contour(field, _BOX, spacing) for spacing in (0.008, 0.004, 0.002)]
    for measure, exact in (("volume", volume), ("area", area)):
        errors = np.array([abs(getattr(surface, measure) / exact - 1.0) for surface in surfaces])
        assert np.all(np.log2(errors[:-1] / errors[1:]) > 1.8), errors
        assert errors[-1] < 2e-3
    for surface in surfaces:
        assert _euler(surface) == euler
        _assert_closed_and_manifold(surface)
        assert np.abs(field(surface.vertices)).max() < 1e-2 * 0.002  # every vertex lies on the true surface


@pytest.mark.parametrize("name", _SHAPES)
def test_a_jump_is_met_as_exactly_as_a_smooth_field(name: str) -> None:
    field = _SHAPES[name][0]
    smooth = contour(field, _BOX, 0.004)
    step = contour(lambda points: np.where(field(points) < 0, -0.5, 0.5), _BOX, 0.004)
    np.testing.assert_array_equal(step.triangles, smooth.triangles)
    np.testing.assert_allclose(step.vertices, smooth.vertices, atol=1e-4 * 0.004)


def test_far_blocks_of_a_distance_are_skipped_with_the_same_result() -> None:
    calls = [0, 0]

    def counted(points: np.ndarray, which: int) -> np.ndarray:
        calls[which] += len(points)
        return _torus(points)

    whole = contour(lambda points: counted(points, 0), _BOX, 0.002)
    part = contour(lambda points: counted(points, 1), _BOX, 0.002, distance=True)
    assert whole.vertices.tobytes() == part.vertices.tobytes()
    assert whole.triangles.tobytes() == part.triangles.tobytes()
    assert calls[1] < 0.5 * calls[0]


@pytest.mark.parametrize("distance", [False, True])
def test_region_that_reaches_beyond_the_box_ends_at_its_sides(distance: bool) -> None:
    """A field that is negative everywhere gives the box itself, of which only edges and corners are cut."""
    box = np.array([[0.0, 0.0, 0.0], [0.03, 0.02, 0.01]])
    surface = contour(lambda points: np.full(len(points), -1.0), box, 0.001, distance=distance)
    np.testing.assert_allclose(surface.box, box, atol=1e-7)
    assert surface.volume == pytest.approx(0.03 * 0.02 * 0.01, rel=0.02)
    assert surface.volume < 0.03 * 0.02 * 0.01
    assert _euler(surface) == 2
    _assert_closed_and_manifold(surface)


@pytest.mark.parametrize("seed", range(8))
def test_wild_fields_leave_a_manifold(seed: int) -> None:
    """Random signs at every grid point show all cases of marching cubes, the ambiguous ones among them."""
    random = np.random.default_rng(seed)
    field = random.normal(size=(40, 40, 40))

    def jump(points: np.ndarray) -> np.ndarray:
        return field[tuple(np.clip((points * 20).astype(int) % 40, 0, 39).T)]

    surface = contour(jump, np.array([[0.0] * 3, [1.0] * 3]), 0.07)
    _assert_closed_and_manifold(surface)
    assert surface.volume > 0.0


def test_the_same_bytes_on_every_run() -> None:
    one, two = (contour(_torus, _BOX, 0.005) for _ in range(2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert one.triangles.tobytes() == two.triangles.tobytes()


@pytest.mark.parametrize(
    ("field", "box", "spacing", "word"),
    [
        (_sphere, _BOX, 0.0001, "larger spacing"),
        (_sphere, _BOX, 0.0, "spacing above 0"),
        (_sphere, _BOX, float("nan"), "spacing above 0"),
        (_sphere, _BOX[::-1].copy(), 0.01, "box"),
        (lambda points: points[:, 0] ** 2 + 1.0, _BOX, 0.01, "nothing is inside"),
        (lambda points: np.full(len(points), np.nan), _BOX, 0.01, "finite"),
    ],
)
def test_refusals_are_one_clear_line(field: object, box: np.ndarray, spacing: float, word: str) -> None:
    with pytest.raises(SurfaceError, match=word) as caught:
        contour(field, box, spacing)  # pyright: ignore[reportArgumentType]
    assert "\n" not in str(caught.value)
