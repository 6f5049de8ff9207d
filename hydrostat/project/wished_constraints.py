"""`wished_constraints`: the constraints in a person's wishes."""

from hydrostat.design import Constraints
from hydrostat.project.wishes import Paint, Wishes
from hydrostat.robot import Robot


def wished_constraints(robot: Robot, wishes: Wishes) -> Constraints:
    """Constraints of the design settings, without parts to keep that are gone (InputError: impossible limits)."""
    zones = {paint: tuple(zone for other, zone in wishes.zones if other is paint) for paint in Paint}
    names = {winch.name for winch in robot.winches}
    return Constraints(
        winch_zones=zones[Paint.WINCH_ZONES],
        keep_out=zones[Paint.KEEP_OUT],
        still=zones[Paint.STILL],
        mirror=wishes.mirror,
        tension=wishes.tension,
        clearance=wishes.clearance,
        depth=wishes.depth if robot.body.mesh.dim == 3 else None,
        cables_per_winch=wishes.cables_per_winch,
        slack=wishes.slack,
        spool_ratio=2.0 if wishes.stepped else 1.0,
        torque=wishes.torque,
        locked_winches=tuple(name for name in wishes.kept_winches if name in names),
        locked_cables=tuple(cable.name for cable in robot.cables if cable.name in wishes.kept_cables),
    )
