"""From fibres to routes. Oracles: hand-made fibres whose routes are plain to see."""

import numpy as np
import pytest
import shapely
from builders import strip_robot

from hydrostat.design.body_region import body_region
from hydrostat.design.polyline import length, resample
from hydrostat.design.trees.grow_routes import GrowthLimits, grow_routes, lay_route, strongest

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
    region = body_region(strip_robot().body, 0.006)
    route = np.column_stack([np.linspace(0.0, 0.2, 9), np.tile([0.03, 0.018], 5)[:9]])
    laid = lay_route(route, region, 0.02)
    assert laid is not None
    assert region.depths(laid).min() >= 0.006 * (1 - 1e-6)
    assert region.holds(laid)
    assert np.linalg.norm(np.diff(laid, axis=0), axis=1) == pytest.approx(np.full(len(laid) - 1, 0.02), rel=0.2)


def test_region() -> None:
    region = body_region(strip_robot().body, 0.006)
    assert region.body.area == pytest.approx(0.2 * 0.05)
    assert region.depths(np.array([[0.1, 0.0], [0.1, 0.02], [0.1, 0.04]])) == pytest.approx([0.025, 0.005, -0.015])
    starts, ends = np.array([[0.05, 0.0], [0.05, 0.0]]), np.array([[0.15, 0.0], [0.15, 0.0245]])
    assert region.sees(starts, ends).tolist() == [True, False]
    assert not region.holds(np.array([[0.1, 0.0], [0.1, 0.023]]))
    pushed = region.push_inside(np.array([[0.1, 0.0], [0.3, 0.1]]))
    assert pushed[0].tolist() == [0.1, 0.0]
    assert region.inner.distance(shapely.Point(pushed[1])) < 1e-12
