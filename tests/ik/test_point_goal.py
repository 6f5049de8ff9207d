"""Any point of the body at a place. Oracles: central differences, `MarkerTarget` at the same points, `solve_ik`."""

import numpy as np
import pytest
from wishes import BENT, FLAT, SPACE

from hydrostat.errors import InputError
from hydrostat.ik.inverse_kinematics import solve_ik
from hydrostat.ik.objectives.marker_target import MarkerTarget, PointTarget
from hydrostat.ik.objectives.objective import EquilibriumState
from hydrostat.ik.tracker import Tracker
from hydrostat.testing import check_objective


def test_it_conforms_in_the_plane() -> None:
    goal = PointTarget(
        points={"one": (0.11, 0.01), "two": (0.17, -0.02)}, targets={"one": (0.1, 0.04), "two": (0.15, 0.03)}
    )
    check_objective(goal, FLAT, BENT[2])


def test_it_conforms_in_space() -> None:
    check_objective(PointTarget(points={"a": (0.1, 0.02, 0.03)}, targets={"a": (0.08, 0.0, 0.05)}), SPACE, BENT[3])


def test_at_markers_it_is_the_goal_of_markers() -> None:
    targets = {"tip": (0.17, 0.06), "top": (0.09, 0.05)}
    points = {marker.name: marker.at for marker in FLAT.robot.markers if marker.name in targets}
    posture = EquilibriumState.at(FLAT, FLAT.solve(BENT[2]))
    found = PointTarget(points=points, targets=targets).bind(FLAT)
    known = MarkerTarget(targets={name: targets[name] for name in points}).bind(FLAT)
    assert found.residual(posture) == pytest.approx(known.residual(posture))
    assert found.errors(posture) == pytest.approx(known.errors(posture))


@pytest.mark.slow
def test_a_tracker_follows_a_point_that_moves() -> None:
    points = {"grip": (0.15, 0.01)}
    start = np.array(points["grip"])
    tracker = Tracker(FLAT)
    shares = np.linspace(0, 1, 25)[1:]
    goals = [
        PointTarget(points=points, targets={"grip": tuple((start + share * np.array([-0.005, 0.03])).tolist())})
        for share in shares
    ]
    reached = [tracker.update(seconds=0.03, objectives=[goal]) for goal in goals for _ in range(3)][-1]
    goal = goals[-1]
    best = solve_ik(FLAT, objectives=[goal])
    assert reached.errors["grip"] < best.errors["grip"] + 1e-4


@pytest.mark.parametrize(
    ("points", "targets", "words"),
    [
        ({}, {}, "at least one"),
        ({"a": (0.1, 0.0)}, {}, 'point "a" has a place on the body but no target'),
        ({}, {"a": (0.1, 0.0)}, "at least one"),
        ({"a": (0.1, 0.0), "b": (0.1, 0.0)}, {"a": (0.1, 0.0)}, 'point "b" has a place'),
        ({"a": (0.1, 0.0)}, {"a": (0.1, 0.0), "b": (0.1, 0.0)}, 'point "b" has a target but no place'),
        ({"a": (0.1,)}, {"a": (0.1, 0.0)}, "1 coordinates"),
        ({"a": (0.1, 0.0)}, {"a": (np.nan, 0.0)}, "not finite"),
        ({"a": (0.1, 0.0)}, {"a": (180.0, 60.0)}, "meters"),
    ],
)
def test_what_is_wrong_is_named(points: dict, targets: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        PointTarget(points=points, targets=targets).bind(FLAT)
