"""Limits of material, line and robot that a pose exceeds."""

from typing import TYPE_CHECKING

from hydrostat.errors import in_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hydrostat.arrays import Vector
    from hydrostat.robot import PoseTarget, Robot
    from hydrostat.simulation import Equilibrium


def print_far_targets(robot: "Robot", poses: "Iterable[PoseTarget]") -> None:
    """Print a warning of targets that the body cannot reach, before a search spends its time on them."""
    from hydrostat.robot import find_far_targets

    for words in find_far_targets(robot, poses):
        print(f"warning: {in_words(words)}", flush=True)


def print_exceeded(pose: "Equilibrium", indent: str = "") -> None:
    """Print strain beyond a material's measured range, elements held open, and lines that would break."""
    from hydrostat.fabrication import find_weak_lines

    for reason in find_weak_lines(pose.robot, pose.tensions):
        print(f"{indent}error: {reason}")
    for words in filter(None, (pose.squeezed_corners, pose.overstrain)):
        print(f"{indent}warning: {words}")


def print_overloads(robot: "Robot", tensions: "Vector", torques: "Vector") -> None:
    """Print cables [N] and winches [N m] above the robot's own max_tension and max_torque, by more than 1 %."""
    limits = {"max_tension": (robot.max_tension, 1.0, "N"), "max_torque": (robot.max_torque, 1e3, "N mm")}
    loads = (
        [(f"cable {number}", tension) for number, tension in enumerate(tensions.tolist(), start=1)],
        [(f"winch {winch.name}", torque) for winch, torque in zip(robot.winches, torques.tolist(), strict=True)],
    )
    for (key, (limit, factor, unit)), values in zip(limits.items(), loads, strict=True):
        for name, value in values:
            if limit is not None and value > 1.01 * limit:  # poses are solved up to the limit
                most = f"more than its {key} of {factor * limit:.3g} {unit}"
                print(f"warning: {name}: {factor * value:.3g} {unit}, {most}")
