"""`pull_bands`: sensitivity of the pull-out force to uncertain parameters."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.errors import HydrostatError
from hydrostat.grasp.pull_out import PullOptions, PullOut, pull_out
from hydrostat.grasp.thing import moved_thing
from hydrostat.progress import Progress
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation import Contractions

FRICTIONS, MODULI, ASIDE = (0.3, 0.8), (0.7, 1.3), 5e-3
"""Variations that are tried: friction coefficients, factors of Young's modulus, offset of the object [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PullCase:
    """Pull-out test with one varied parameter.

    Attributes:
        name: description of the variation.
        pull: result; None if the simulation failed.
        trouble: reason of the failure.
    """

    name: str
    pull: PullOut | None
    trouble: str = ""


def pull_bands(
    robot: Robot,
    thing: Obstacle,
    contractions: Contractions,
    options: PullOptions,
    *,
    progress: Progress | None = None,
) -> tuple[PullCase, ...]:
    """Pull with friction, stiffness and position varied one at a time, and without friction, for the cage alone.

    Args:
        robot: robot that grasps the object.
        thing: object with its nominal friction and position.
        contractions: contractions that close the robot [m].
        options: options of the pull.
        progress: callback for progress.
    """
    cases = list(_cases(robot, thing))
    found = []
    for number, (name, other, moved) in enumerate(cases):
        try:
            found.append(PullCase(name=name, pull=pull_out(other, moved, contractions, options)))
        except HydrostatError as error:
            found.append(PullCase(name=name, pull=None, trouble=str(error)))
        if progress is not None:
            progress("cases", number + 1, len(cases))
    return tuple(found)


def _cases(robot: Robot, thing: Obstacle) -> Iterator[tuple[str, Robot, Obstacle]]:
    yield "no friction", robot, replace(thing, friction=0.0)
    for friction in FRICTIONS:
        yield f"friction {friction:g}", robot, replace(thing, friction=friction)
    material = robot.body.material
    for factor in MODULI:
        body = replace(robot.body, material=replace(material, young=factor * material.young))
        yield f"modulus {factor - 1:+.0%}", replace(robot, body=body), thing
    place = thing.frame()[0]
    for axis in range(len(place)):
        for sign in (-1.0, 1.0):
            aside = place + sign * ASIDE * np.eye(len(place))[axis]
            yield f"{'xyz'[axis]} {1e3 * sign * ASIDE:+.0f} mm", robot, moved_thing(thing, aside)
