"""Markers that a target does not name. Oracle: the sum that should be least, |r| + d^2 / (4 size), of both answers."""

import numpy as np
import pytest

from hydrostat.ik import IKOptions, IKResult, solve_ik
from hydrostat.robot import gallery_folder, load_robot
from hydrostat.simulation import Simulation

SIMULATION = Simulation(load_robot(gallery_folder("starfish")))
PLACES = {marker.name: marker.at for marker in SIMULATION.robot.markers}


def answers(targets: dict[str, tuple[float, float]]) -> tuple[IKResult, IKResult]:
    """Without minding the others, and with."""
    free, minding = (solve_ik(SIMULATION, targets, options=IKOptions(hold_free_markers=stay)) for stay in (False, True))
    return free, minding


def strayed(reached: IKResult) -> float:
    """How far the markers that are not named have gone from rest, in all [m]."""
    places = reached.pose.markers
    others = [marker for marker in SIMULATION.robot.markers if marker.name not in reached.pose_target.targets]
    return float(np.linalg.norm([np.linalg.norm(places[marker.name] - marker.at) for marker in others]))


def worth(reached: IKResult) -> float:
    """What should be least [m]."""
    size = SIMULATION.robot.body.mesh.size
    return float(np.linalg.norm(list(reached.errors.values()))) + strayed(reached) ** 2 / (4 * size)


@pytest.mark.parametrize("name", ["right", "left_foot"])
def test_out_of_reach_others_move_only_for_what_they_gain(name: str) -> None:
    x, y = PLACES[name]
    free, minding = answers({name: (x + 0.009, y + 0.012)})
    assert strayed(minding) < 0.7 * strayed(free)
    assert worth(minding) < worth(free)
    # No contraction a little off is better: the answer is an optimum of that sum, but for limits and the effort.
    for winch in range(len(SIMULATION.robot.winches)):
        for step in (-5e-4, 5e-4):
            near = minding.pose.contractions.copy()
            near[winch] += step
            if not 0 <= near[winch] <= SIMULATION.robot.winches[winch].travel:
                continue
            pose = SIMULATION.solve(near, start=minding.pose)
            missed = {name: float(np.linalg.norm(pose.markers[name] - minding.pose_target.targets[name]))}
            other = IKResult(
                target=minding.target, pose=pose, errors=missed, status=minding.status, iterations=0, solves=0
            )
            assert worth(other) > worth(minding) - 2e-5


def test_in_reach_nothing_changes() -> None:
    x, y = PLACES["right_foot"]
    free, minding = answers({"right_foot": (x + 0.009, y + 0.012)})
    assert max(free.errors.values()) < 1e-5
    np.testing.assert_array_equal(free.pose.contractions, minding.pose.contractions)


def test_a_pose_of_all_markers_has_no_others() -> None:
    pose = SIMULATION.robot.pose("wave")
    free, minding = (solve_ik(SIMULATION, pose, options=IKOptions(hold_free_markers=stay)) for stay in (False, True))
    np.testing.assert_array_equal(free.pose.contractions, minding.pose.contractions)
