"""`winch_bodies`: rigid parts of a robot for the motors and housings of its winches, as a kit lays them."""

from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.moulds.pocket import WinchRoom, ways_to_turn
from hydrostat.fabrication.parts.motor import ALL_MOTORS, Motor
from hydrostat.fabrication.parts.winch_unit import WinchUnit, winch_units
from hydrostat.robot import BodyPart, Robot

_COUNT = 500  # points of a box that are tried


def winch_bodies(robot: Robot) -> tuple[tuple[BodyPart, float], ...]:
    """A rigid part for the unit of each winch that has `body`, its box, and the mass of motor and printed parts [kg].

    In a flat body it goes through all the thickness where the unit lies. In space it is a box along the axes, turned so
    that the most of it is inside.

    Raises:
        InputError: no motor is chosen, or such a winch has no cables.
    """
    chosen = [winch.name for winch in robot.winches if winch.body]
    if robot.motor == "auto":
        known = ", ".join(motor.key for motor in ALL_MOTORS)
        raise InputError(f'winch "{chosen[0]}": body = true needs a motor. Set motor above [body]. Available: {known}.')
    units = {unit.winch: unit for unit in winch_units(robot, PartOptions(), Motor.choose(robot.motor))}
    for name in chosen:
        if name not in units:
            raise InputError(f'winch "{name}": body = true needs a cable that is on the winch.')
    return tuple(_part(robot, units[name]) for name in chosen)


def _part(robot: Robot, unit: WinchUnit) -> tuple[BodyPart, float]:
    """Part of a unit, and its mass [kg]."""
    mass = 1e-3 * (unit.motor.mass + sum(piece.mass for piece in unit.printed))
    given: dict[str, Any] = {"name": f"winch {unit.winch}", "winch": unit.winch}
    if unit.place is not None:
        corners = 1e-3 * np.array(unit.place.footprint.exterior.coords)[:-1]
        density = mass / (1e-6 * unit.place.footprint.area * (robot.body.thickness or 1.0))
        return BodyPart(shape="polygon", points=tuple(map(tuple, corners.tolist())), density=density, **given), mass
    room = WinchRoom(low=unit.room.low, high=unit.room.high)
    density = mass / (1e-9 * float(np.prod(room.size)))
    boxes = []
    for way in ways_to_turn(room):
        low, high = (np.array(robot.winch(unit.winch).at) + 1e-3 * end for end in _ends(way.middle, way.sides))
        boxes.append(BodyPart(shape="box", at=tuple(low.tolist()), to=tuple(high.tolist()), density=density, **given))
    best = max(boxes, key=lambda box: round(float((robot.body.distances(box.grid(_COUNT)) <= 0).mean()), 3))
    return best, mass


def _ends(middle: tuple[float, float, float], sides: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Opposite corners of a box [mm]."""
    half = np.array(sides) / 2
    return np.array(middle) - half, np.array(middle) + half
