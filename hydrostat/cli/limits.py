"""Limits of material and line that a pose exceeds."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.simulation import Equilibrium


def print_exceeded(pose: "Equilibrium", indent: str = "") -> None:
    """Print strain beyond a material's measured range, and lines that would break."""
    from hydrostat.fabrication import find_weak_lines

    for reason in find_weak_lines(pose.robot, pose.tensions):
        print(f"{indent}error: {reason}")
    if words := pose.overstrain:
        print(f"{indent}warning: {words}")
