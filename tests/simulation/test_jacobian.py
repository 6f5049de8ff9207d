"""The derivative of a pose by its contractions (R33, E16). Oracle: central differences of fully converged solves."""

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Mount, Robot
from hydrostat.simulation import Simulation

TIGHT = NewtonOptions(tolerance=1e-13)
CASES = {
    "taut": (strip_robot(), [0.02, 0.008]),
    "one slack": (strip_robot(), [0.02, -0.01]),
    "cubic zone": (strip_robot(), [0.02, 0.0075]),
    "sheathed": (strip_robot(sheathed=((1, 3),)), [0.02, 0.005]),
    "slack to take in": (strip_robot(slack=0.004), [0.02, 0.005]),
    "world": (strip_robot(mount=Mount.WORLD), [0.015, 0.01]),
    "large": (strip_robot(), [0.06, 0.0]),
    "space": (box_robot(), [0.01, 0.006]),
}


def differences(simulation: Simulation, contractions: np.ndarray, step: float) -> np.ndarray:
    """Fourth order: Richardson on central differences."""
    start = simulation.solve(contractions)

    def slope(winch: int, length: float) -> np.ndarray:
        shift = length * np.eye(len(contractions))[winch]
        ahead, behind = (simulation.solve(contractions + side * shift, start=start).nodes for side in (1, -1))
        return (ahead - behind) / (2 * length)

    return np.stack([(4 * slope(w, step / 2) - slope(w, step)) / 3 for w in range(len(contractions))], axis=-1)


@pytest.mark.parametrize("name", CASES)
def test_the_jacobian_is_the_derivative_of_the_pose(name: str) -> None:
    robot, contractions = CASES[name]
    assert isinstance(robot, Robot)
    simulation, given = Simulation(robot, options=TIGHT), np.array(contractions)
    jacobian = simulation.jacobian(simulation.solve(given))
    found = differences(simulation, given, 1e-5)
    assert np.abs(jacobian - found).max() < 1e-6 * np.abs(found).max()


def test_a_slack_cable_has_no_derivative_of_its_own() -> None:
    """E15: its column is 0."""
    simulation = Simulation(strip_robot())
    jacobian = simulation.jacobian(simulation.solve(np.array([0.02, -0.01])))
    assert not jacobian[..., 1].any()
    assert jacobian[..., 0].any()


def test_the_projected_hessian_would_give_another_answer() -> None:
    """The check can fail, and why E16 asks for the full Hessian."""
    simulation = Simulation(strip_robot())
    pose = simulation.solve(np.array([0.06, 0.0]))
    springs = simulation.assembly.low_rank_hessian(pose.nodes, pose.contractions)
    columns, weights = springs.columns, springs.weights
    projected = simulation.assembly.hessian(pose.nodes, pose.contractions, projection=1.0).toarray()
    projected += columns @ weights @ columns.T
    right = simulation.assembly.control_derivative(pose.nodes, pose.contractions).toarray()
    wrong = -np.linalg.solve(projected, right).reshape(*pose.nodes.shape, -1)
    jacobian = simulation.jacobian(pose)
    assert np.abs(wrong - jacobian).max() > 1e-3 * np.abs(jacobian).max()
