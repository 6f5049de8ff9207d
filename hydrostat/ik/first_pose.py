"""`with_first_pose`: a pose to begin with, for a robot that was just sketched."""

from dataclasses import replace

from hydrostat.ik.solve_ik import solve_ik
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation

_SHARES, _REACHED = (0.5, 0.25, 0.1), 0.01  # travels to try, in shares of all; how near is near, in sizes of the body


def with_first_pose(robot: Robot) -> Robot:
    """Robot with a pose that its one cable makes, the farthest of a few that inverse kinematics finds again."""
    simulation = Simulation(robot)
    simulation.solve({}, strict=False)
    for share in _SHARES:
        solved = simulation.solve({"pull": share * robot.winches[0].travel}, strict=False)
        if not solved.result.converged:
            continue
        targets = {name: tuple(round(float(value), 4) for value in place) for name, place in solved.markers.items()}
        pose = PoseTarget(name="bend", targets=targets)
        if solve_ik(simulation, pose).rms_error < _REACHED * robot.body.mesh.size:
            return replace(robot, poses={pose.name: pose})
    return robot
