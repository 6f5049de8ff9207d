"""From fibres to routes, and via points apart. Oracles: hand-made fibres; distances of all pairs."""

from itertools import combinations

import numpy as np
import pytest
import shapely
from builders import strip_robot

from hydrostat.design.polyline import length, resample
from hydrostat.design.region import Region
from hydrostat.design.trees.grow_routes import GrowthLimits, grow_routes, keep_apart, lay_route, strongest

LIMITS = GrowthLimits(distance=0.5, steps=20, turn=60.0, spacing=1.0)


def fibres(*segments: tuple[float, float, float, float]) -> np.ndarray:
    return np.array(segments).reshape(-1, 2, 2)


def chain(count: int, *, gap: float = 0.0) -> np.ndarray:
    return fibres(*((index * (1 + gap), 0, index * (1 + gap) + 1, 0) for index in range(count)))


def grown(ends: np.ndarray, tensions: list[float] | None = None, **limits: float) -> list[np.ndarray]:
    values = {"distance": 0.5, "steps": 20, "turn": 60.0, "spacing": 1.0} | limits
    strengths = np.arange(len(ends), 0, -1.0) if tensions is None else np.array(tensions)
    return grow_routes(ends, strengths, GrowthLimits(**values))


def test_the_strongest_fibres() -> None:
    tensions = np.array([0.5, 3.0, 0.01, 2.0, 0.0, 3.0])
    assert strongest(tensions, 3).tolist() == [1, 5, 3]
    assert strongest(tensions, 10).tolist() == [1, 5, 3, 0]
    assert strongest(tensions, 10, weakest=0.0).tolist() == [1, 5, 3, 0, 2]
    assert strongest(np.zeros(3), 2).size == 0


@pytest.mark.parametrize("seed", [0, 2, 4])
def test_a_straight_chain_is_one_route(seed: int) -> None:
    """Whichever fibre is the strongest, and however the fibres are turned round."""
    ends = chain(5)
    ends[1::2] = ends[1::2, ::-1]
    tensions = np.ones(5)
    tensions[seed] = 2.0
    (route,) = grown(ends, tensions.tolist())
    along = route[:, 0] if route[0, 0] < route[-1, 0] else route[::-1, 0]
    assert along == pytest.approx([0, 1, 2, 3, 4, 5])


def test_gaps_up_to_the_limit_are_bridged() -> None:
    (route,) = grown(chain(3, gap=0.4))
    assert length(route) == pytest.approx(3.8)
    assert grown(chain(3, gap=0.6)) == []


@pytest.mark.parametrize(("angle", "joined"), [(50.0, True), (70.0, False), (180.0, False)])
def test_turns_up_to_the_limit_are_taken(angle: float, joined: bool) -> None:
    x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    routes = grown(fibres((0, 0, 1, 0), (1, 0, 1 + x, y)))
    assert len(routes) == joined


def test_a_route_has_at_most_so_many_steps() -> None:
    (route,) = grown(chain(9), steps=3)[:1]
    assert len(route) == 5


def test_the_nearer_then_the_stronger_fibre_is_joined() -> None:
    ends = fibres((0, 0, 1, 0), (1.3, 0, 2.3, 0), (1.0, 0, 1.9, 0.4), (1.0, 0, 1.9, -0.4))
    (route,) = grown(ends, [9.0, 8.0, 1.0, 2.0])[:1]
    assert [1.9, -0.4] in route.tolist()
    assert [1.9, 0.4] not in route.tolist()
    assert [2.3, 0.0] not in route.tolist()


def test_a_ring_of_fibres_is_run_through_once() -> None:
    corners = np.array([[np.cos(a), np.sin(a)] for a in np.arange(12) * np.pi / 6]) * 2
    ring = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    (route,) = grown(ring, spacing=1.04)
    away = np.linalg.norm(route[:, None] - route[None], axis=2) + np.eye(len(route)) * 9
    assert away.min() > 0.5
    assert len(route) >= 11


def test_fibres_along_a_route_are_used_up_others_are_not() -> None:
    beside, apart = (chain(4) + np.array([0.0, height]) for height in (0.4, 1.5))
    routes = grown(np.concatenate([chain(4), beside, apart]))
    assert sorted(float(route[:, 1].mean()) for route in routes) == pytest.approx([0.0, 1.5])


def test_resample() -> None:
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    even = resample(corner, 0.5)
    assert even.tolist() == [[0, 0], [0.5, 0], [1, 0], [1, 0.5], [1, 1]]
    assert len(resample(corner, 10.0)) == 2


def test_a_laid_route_keeps_its_clearance() -> None:
    region = Region.of_body(strip_robot().body, 0.006)
    route = np.column_stack([np.linspace(0.0, 0.2, 9), np.tile([0.03, 0.018], 5)[:9]])
    laid = lay_route(route, region, 0.02)
    assert laid is not None
    assert region.depths(laid).min() >= 0.006 * (1 - 1e-6)
    assert region.holds(laid)
    assert np.linalg.norm(np.diff(laid, axis=0), axis=1) == pytest.approx(np.full(len(laid) - 1, 0.02), rel=0.2)


def test_region() -> None:
    region = Region.of_body(strip_robot().body, 0.006)
    assert region.body.area == pytest.approx(0.2 * 0.05)
    assert region.depths(np.array([[0.1, 0.0], [0.1, 0.02], [0.1, 0.04]])) == pytest.approx([0.025, 0.005, -0.015])
    starts, ends = np.array([[0.05, 0.0], [0.05, 0.0]]), np.array([[0.15, 0.0], [0.15, 0.0245]])
    assert region.sees(starts, ends).tolist() == [True, False]
    assert not region.holds(np.array([[0.1, 0.0], [0.1, 0.023]]))
    pushed = region.push_inside(np.array([[0.1, 0.0], [0.3, 0.1]]))
    assert pushed[0].tolist() == [0.1, 0.0]
    assert region.inner.distance(shapely.Point(pushed[1])) < 1e-12


GAP = 0.004


def line(start: tuple[float, float], end: tuple[float, float], points: int) -> np.ndarray:
    return np.linspace(start, end, points)


def least_gap(cables: list[np.ndarray]) -> float:
    """Between any two points that do not coincide."""
    points = [point for cable in cables for point in cable]
    gaps = [float(np.linalg.norm(one - other)) for one, other in combinations(points, 2)]
    return min(gap for gap in gaps if gap > 1e-5)


def test_points_that_are_apart_stay() -> None:
    cables = [line((0, 0), (0.1, 0), 6), line((0, 0.02), (0.1, 0.02), 6)]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.012)
    assert kept is not None
    assert all(np.array_equal(one, other) for one, other in zip(kept, cables, strict=True))


@pytest.mark.parametrize(
    "second",
    [
        line((0, 0.002), (0.1, 0.002), 6),  # beside the first
        line((0.06, -0.05), (0.06, 0.05), 6),  # across it
        line((0.041, -0.04), (0.039, 0.04), 5),  # through one of its points, nearly
    ],
)
def test_points_slide_along_their_own_cable(second: np.ndarray) -> None:
    cables = [line((0.0, 0.0), (0.1, 0.0), 6), second]
    kept = keep_apart(cables, gap=GAP, winch_gap=GAP)
    assert kept is not None
    assert least_gap([cable[1:] for cable in kept]) >= GAP
    for before, after in zip(cables, kept, strict=True):
        assert np.array_equal(before[0], after[0])
        along = (before[-1] - before[0]) / np.linalg.norm(before[-1] - before[0])
        across = np.array([-along[1], along[0]])
        assert np.abs((after - before[0]) @ across).max() < 1e-12
        assert (np.diff(after @ along) > 0).all()


def test_a_shared_bend_may_stay_shared() -> None:
    lead = line((0, 0), (0.03, 0), 2)
    cables = [np.vstack([lead, [[0.06, 0.03]]]), np.vstack([lead, [[0.06, -0.03]]])]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.012)
    assert kept is not None
    assert np.array_equal(kept[0][1], kept[1][1])


def test_points_keep_off_other_winches() -> None:
    cables = [line((0, 0), (0.1, 0), 6), line((0.04, 0.003), (0.04, 0.05), 3)]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.008)
    assert kept is not None
    assert np.linalg.norm(kept[0] - cables[1][0], axis=1).min() >= 0.008


def test_no_room_is_told() -> None:
    crowd = [line((0, 1e-4 * index), (0.02, 1e-4 * index), 5) for index in range(4)]
    assert keep_apart(crowd, gap=GAP, winch_gap=GAP) is None
