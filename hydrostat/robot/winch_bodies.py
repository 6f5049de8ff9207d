"""`fit_winch_bodies`: rigid parts of a body that are the motors and housings of its winches."""

from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.painters import make_winch_parts
from hydrostat.robot.body import Body
from hydrostat.robot.robot import Robot


def fit_winch_bodies(robot: Robot) -> Robot:
    """Return the robot with a rigid part for the unit of each winch that has `body`, and for no other winch.

    Call it after changes to winches; otherwise parts stay at the old positions. The mesh is fitted to the borders.

    Raises:
        InputError: no motor is chosen, or a unit that does not fit, such as one outside the body.
    """
    own = tuple(part for part in robot.body.parts if not part.winch)
    if any(winch.body for winch in robot.winches):
        parts = make_winch_parts(robot)
        body = robot.body.with_parts((*own, *(part for part, _ in parts)))
        return replace(robot, body=_with_masses(body, [mass for _, mass in parts]))
    return robot if len(own) == len(robot.body.parts) else replace(robot, body=robot.body.with_parts(own))


def _with_masses(body: Body, masses: list[float]) -> Body:
    """Body whose last parts have these masses in its mesh [kg], whose border is not quite theirs."""
    first, found = len(body.parts) - len(masses), np.bincount(body.element_materials, body.element_masses)[1:]
    scaled = [
        replace(part, density=(part.density or 0.0) * mass / found[index])
        for index, (part, mass) in enumerate(zip(body.parts[first:], masses, strict=True), start=first)
    ]
    return replace(body, parts=(*body.parts[:first], *scaled))


def check_winch_bodies(robot: Robot) -> None:
    """Reject a robot whose winches have no parts of their units, or have moved out of them (InputError)."""
    units = {part.winch: part for part in robot.body.parts if part.winch}
    names = {winch.name for winch in robot.winches if winch.body}
    for winch in robot.winches:
        if winch.body and not (winch.name in units and units[winch.name].holds(np.array([winch.at]))[0]):
            raise InputError(f'winch "{winch.name}": its unit is no part of the body. Call hs.fit_winch_bodies(robot).')
    for name in units:
        if name not in names:
            raise InputError(f'winch "{name}": it has no body now. Call hs.fit_winch_bodies(robot).')
