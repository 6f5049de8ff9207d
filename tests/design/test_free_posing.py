"""Free posing in real time. Oracles: `activate` (the same problem, solved slowly), a bounded solver of SciPy, rest."""

import numpy as np
import pytest
from builders import gallery_robot, strip_robot
from scipy.optimize import lsq_linear

from hydrostat.design.muscles.activation import activate, edge_fibres, least_effort
from hydrostat.design.muscles.free_posing import FreePosing
from hydrostat.geometry import Anchors, locate
from hydrostat.robot import PoseTarget

ROBOT = strip_robot(columns=14, rows=3)
TIP = locate(ROBOT.body.mesh, np.array([ROBOT.markers[0].at]))
START = np.array([ROBOT.markers[0].at])


def follow(posing: FreePosing, goals: np.ndarray, most: int = 200) -> int:
    """Updates until there is no more to gain."""
    for count in range(1, most + 1):
        if not posing.update(TIP, goals):
            return count
    raise AssertionError(f"no end after {most} updates")


def miss(posing: FreePosing, goals: np.ndarray) -> float:
    return float(np.linalg.norm(TIP.positions(posing.nodes) - goals))


def test_it_ends_where_activation_ends() -> None:
    goal = START + np.array([[-0.04, 0.08]])
    posing = FreePosing(ROBOT)
    follow(posing, goal)
    slow = activate(
        ROBOT,
        PoseTarget(name="bend", targets={ROBOT.markers[0].name: tuple(goal[0].tolist())}),
        edge_fibres(ROBOT.body.mesh),
    )
    assert miss(posing, goal) < 1e-4
    assert slow.rms_error < 1e-4
    assert np.abs(posing.nodes - slow.nodes).max() < 0.01 * ROBOT.body.mesh.size
    assert posing.tensions.min() >= 0


def test_a_goal_that_moves_is_followed_closely() -> None:
    posing, way = FreePosing(ROBOT), np.array([[-0.05, 0.09]])
    misses = []
    for share in np.linspace(0, 1, 41)[1:]:
        posing.update(TIP, START + share * way)
        misses.append(miss(posing, START + share * way))
    assert max(misses) < 2e-3


@pytest.mark.parametrize("way", [(3.0, 0.0), (-3.0, 0.1), (0.5, 3.0), (-0.4, -0.4)])
def test_a_goal_out_of_reach_crushes_nothing(way: tuple[float, float]) -> None:
    posing = FreePosing(ROBOT)
    follow(posing, START + np.array([way]))
    corners = posing.nodes[ROBOT.body.mesh.elements]
    areas = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    assert (areas / ROBOT.body.mesh.volumes).min() > 0.2
    assert posing.tensions.max() <= posing.strength * (1 + 1e-9)
    follow(posing, START)
    assert np.abs(posing.nodes - ROBOT.body.mesh.nodes).max() < 1e-4, "and the way back is open"


def test_without_points_it_goes_back_to_rest() -> None:
    posing = FreePosing(ROBOT)
    follow(posing, START + np.array([[-0.04, 0.08]]))
    none = TIP.select_points([])
    while posing.update(none, np.zeros((0, 2))):
        pass
    assert np.abs(posing.nodes - ROBOT.body.mesh.nodes).max() < 1e-5
    assert not posing.tensions.any()


def test_rest_is_at_once() -> None:
    posing = FreePosing(ROBOT)
    follow(posing, START + np.array([[-0.04, 0.08]]))
    posing.rest()
    assert np.array_equal(posing.nodes, ROBOT.body.mesh.nodes)


def test_a_pinned_point_pulls_no_harder_than_muscles_can() -> None:
    pinned = locate(ROBOT.body.mesh, ROBOT.body.mesh.nodes[:1])
    posing = FreePosing(ROBOT)
    for _ in range(60):
        if not posing.update(pinned, ROBOT.body.mesh.nodes[:1] + 0.1):
            break
    assert np.isfinite(posing.nodes).all()
    assert posing.tensions.max() <= posing.strength * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_least_effort_within_bounds_is_that_of_a_general_solver(seed: int) -> None:
    rng = np.random.default_rng(seed)
    jacobian, wanted, rho = rng.standard_normal((4, 30)), 10 * rng.standard_normal(4), 0.3
    most = rng.uniform(0.05, 0.4, 30)
    found = least_effort(jacobian, wanted, rho, most=most)
    stacked = np.vstack([jacobian, np.sqrt(rho) * np.eye(30)])
    expected = lsq_linear(stacked, np.concatenate([wanted, np.zeros(30)]), bounds=(0, most), tol=1e-14).x
    assert found == pytest.approx(expected, abs=1e-6)
    assert (found >= most - 1e-9).any(), "a bound holds"


@pytest.mark.slow
@pytest.mark.parametrize("farther", [1.0, 1.6], ids=["in reach", "out of reach"])
def test_markers_that_nobody_holds_rather_stay(farther: float) -> None:
    """Oracle: the same drag of an arm of the starfish by 45 degrees without the wish, which turns all others."""
    robot = gallery_robot("starfish")
    mesh, places = robot.body.mesh, np.array([marker.at for marker in robot.markers])
    number = [marker.name for marker in robot.markers].index("right")
    center, turn = mesh.nodes.mean(axis=0), np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2.0)
    goal = (center + farther * turn @ (places[number] - center))[None]
    markers = locate(mesh, places)
    held, calm = (
        markers.select_points([number]),
        markers.select_points([own for own in range(len(places)) if own != number]),
    )

    def dragged(stays: Anchors | None) -> tuple[float, np.ndarray]:
        """Miss [m], and how far each other marker is from rest [m]."""
        posing = FreePosing(robot)
        for share in np.linspace(0, 1, 21)[1:]:
            posing.update(held, places[[number]] + share * (goal - places[[number]]), stays)
        for _ in range(200):
            if not posing.update(held, goal, stays):
                break
        moved = calm.positions(posing.nodes) - calm.positions(mesh.nodes)
        return float(np.linalg.norm(held.positions(posing.nodes) - goal)), np.linalg.norm(moved, axis=1)

    (free, all_turn), (kept, some_turn) = dragged(None), dragged(calm)
    assert all_turn.min() > 0.04, "without the wish every arm goes along"
    assert (some_turn < 0.5 * all_turn).all()
    assert kept < free + 0.001 * mesh.size
