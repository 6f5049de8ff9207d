"""`print_places`: where the markers are, and how hard the cables pull."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.robot import Robot
    from hydrostat.simulation import Motion, SolvedPose


def print_places(found: "SolvedPose | Motion", robot: "Robot") -> None:
    """A line for each marker [mm] and each cable [N], with its winch."""
    for name, place in found.markers.items():
        print(f"{name:<16} {', '.join(f'{1e3 * value:8.2f}' for value in place)} mm")
    for index, tension in enumerate(found.tensions):
        print(f"cable {index + 1:<10} {tension:8.3f} N  {robot.cables[index].winch}")
