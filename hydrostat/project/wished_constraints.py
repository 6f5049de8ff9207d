"""`wished_constraints`: the constraints in a person's wishes."""

from dataclasses import replace
from typing import Any

from hydrostat.design import Constraints
from hydrostat.project.wishes import Paint, Wishes
from hydrostat.robot import Robot


def wished_constraints(robot: Robot, wishes: Wishes) -> Constraints:
    """Constraints of the design settings, without parts to keep that are gone (InputError: impossible limits)."""
    zones: dict[str, Any] = {paint: tuple(zone for other, zone in wishes.zones if other is paint) for paint in Paint}
    names = {winch.name for winch in robot.winches}
    return replace(
        wishes.constraints,
        **zones,
        depth=wishes.constraints.depth if robot.body.mesh.dim == 3 else None,
        locked_winches=tuple(name for name in wishes.kept_winches if name in names),
        locked_cables=tuple(cable.name for cable in robot.cables if cable.name in wishes.kept_cables),
    )
