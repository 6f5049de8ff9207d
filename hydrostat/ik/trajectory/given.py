"""What is checked before a trajectory is sought: its robot, and poses that are given."""

import numpy as np

from hydrostat.errors import InputError
from hydrostat.ik.limits import Bounds
from hydrostat.simulation import Simulation, SolvedPose


def check_robot(simulation: Simulation) -> None:
    """Refuse a robot whose poses do not follow from contractions (InputError: cables with friction)."""
    if simulation.assembly.has_history:
        raise InputError(
            "cables with friction end in another pose for every way there, so a trajectory cannot be found; "
            "set friction = 0 to find one, then simulate it with friction"
        )


def check_given(simulation: Simulation, allowed: Bounds, name: str, pose: SolvedPose) -> None:
    """Refuse a pose that inverse kinematics would not have found; its tensions are told in the report instead.

    Raises:
        InputError: a pose of another robot, a contraction out of its range, or equal winches that are not equal.
    """
    _check_own(simulation, name, pose)
    winches = [winch.name for winch in simulation.robot.winches]
    for winch, channel, value in zip(winches, allowed.channels, pose.contractions, strict=True):
        low, high = float(allowed.low[channel]) + 0.0, float(allowed.high[channel])
        if not low - _HAIR <= value <= high + _HAIR:
            raise InputError(
                f'{name}: the contraction of winch "{winch}" is {value:.6g} m, but its limits are {low:.6g} to '
                f"{high:.6g} m; give another pose, or widen the limits"
            )
    for channel in range(len(allowed.low)):
        group = np.flatnonzero(allowed.channels == channel)
        values = pose.contractions[group]
        if np.ptp(values) > _HAIR:
            each = ", ".join(f'"{winches[winch]}" {pose.contractions[winch]:.6g} m' for winch in group)
            raise InputError(
                f"{name}: winches that should be equal are not equal: {each}; give another pose, or let them differ"
            )


def _check_own(simulation: Simulation, name: str, pose: SolvedPose) -> None:
    robot = simulation.robot
    shape, count = robot.body.mesh.nodes.shape, len(robot.winches)
    remedy = "solve it with the simulation that is given"
    if pose.nodes.shape != shape or not np.isfinite(pose.nodes).all():
        raise InputError(f"{name}: a pose of this robot has finite nodes, {shape}, not {pose.nodes.shape}; {remedy}")
    if len(pose.contractions) != count or not np.isfinite(pose.contractions).all():
        raise InputError(
            f"{name}: a pose of this robot has {count} finite contractions, not {len(pose.contractions)}; {remedy}"
        )
    markers = [marker.name for marker in robot.markers]
    if sorted(pose.markers) != sorted(markers):
        raise InputError(
            f"{name}: a pose of this robot has the markers {', '.join(markers) or 'none'}, "
            f"not {', '.join(pose.markers) or 'none'}; {remedy}"
        )


_HAIR = 1e-9  # a contraction may be out of its limits by this much, for rounding [m]
