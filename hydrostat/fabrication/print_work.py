"""`print_work`: a body that is printed in one piece, with a hole for each cable."""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from manifold3d import Manifold

from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import KitOptions, PartOptions
from hydrostat.fabrication.kit_plan import BodyWork
from hydrostat.fabrication.solids.body_solid import MILLIMETERS, body_solid
from hydrostat.fabrication.solids.construct import segments, sides_text
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Cable, Mount, Robot

DRILL_OVERSHOOT = 3.0  # length by which a hole is drilled past the first and the last point of its cable [mm]
HOLE_ALLOWANCE = 1.0  # diameter of a hole beyond that of its line [mm]: holes that lie print too narrow. Assumed.


def print_work(robot: Robot, options: KitOptions) -> BodyWork:
    """Make the body as one printed piece (InputError: its surface is not closed)."""
    whole = body_solid(robot.body)
    drilled = whole
    for cable in robot.cables:
        drilled -= drill(cable, hole_of(options.parts))
    low = drilled.bounding_box()[2]
    name = robot.body.material.name or "the material of the robot file"
    note = f"{name}: 100 % infill, slow, dry filament, no supports"
    printed = Printed(name="body", title="body", solid=drilled.translate((0.0, 0.0, -low)), note=note)
    mass = 1e-6 * robot.body.material.density * printed.volume
    return BodyWork(
        printed=(printed,),
        summary=(f"Body: one printed piece of {name}, {sides_text(printed.size)} mm, {mass:.0f} g",),
        problems=print_problems(robot, options.parts),
        warnings=(f"print the body of {name}, solid: another filament or infill has other forces",),
        checks=(_open_ends(robot.cables, whole, drilled, hole_of(options.parts)),) if robot.cables else (),
    )


def hole_of(parts: PartOptions) -> float:
    """Diameter of the holes [mm]."""
    return parts.cable + HOLE_ALLOWANCE


def print_problems(robot: Robot, parts: PartOptions) -> tuple[str, ...]:
    """Return a line for each winch in a printed body, and for a body thinner than its holes."""
    inside = [winch.name for winch in robot.winches if winch.mount is Mount.BODY]
    told = [f'winch {name}: a printed body has no room for it. Set mount = "world"' for name in inside]
    thickness, least = robot.body.thickness, hole_of(parts) + 2 * parts.wall
    if thickness is not None and robot.cables and MILLIMETERS * thickness < least:
        told.append(f"the body is {MILLIMETERS * thickness:.3g} mm thick, but holes need {least:.3g} mm. Thicken it")
    return tuple(told)


def drill(cable: Cable, diameter: float) -> Manifold:
    """Make the hole of a cable along its points, longer at both ends [mm]."""
    points = _points(cable)
    first, last = points[0] - points[1], points[-1] - points[-2]
    points[0] += DRILL_OVERSHOOT * first / np.linalg.norm(first)
    points[-1] += DRILL_OVERSHOOT * last / np.linalg.norm(last)
    sides = segments(diameter / 2)
    ball = Manifold.sphere(diameter / 2, sides)
    pieces = []
    for start, end in pairwise(points):
        ends = [ball.translate(tuple(place)) for place in (start, end)]
        pieces.append(Manifold.batch_hull(ends))
    return sum(pieces[1:], start=pieces[0])


def _points(cable: Cable) -> np.ndarray:
    """Points of a cable in space [mm]; of a flat body in the middle of its thickness."""
    points = MILLIMETERS * np.array(cable.points)
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _open_ends(cables: Iterable[Cable], whole: Manifold, drilled: Manifold, diameter: float) -> Check:
    """Each cable, as a line of half the hole's diameter, meets no material; without holes it would."""
    lines = [drill(cable, diameter / 2) for cable in cables]
    closed = sum(1 for line in lines if (line ^ drilled).volume() > 0)
    holes = sum(1 for line in lines if (line ^ whole).volume() > 0)
    return Check(
        what=f"the holes of {len(lines)} cables are open from end to end",
        measured=f"{closed} closed, {holes} go through the body",
        allowed="none closed",
        passed=not closed,
    )
