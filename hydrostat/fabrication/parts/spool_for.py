"""`spool_for`: the spool that a winch of a robot needs on a motor."""

import math
from collections.abc import Sequence

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.housing import drive_of, roof_of
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.parts.spool import Groove, Spool, capacity, width_for, wraps
from hydrostat.robot import Robot, Winch

_LONGEST = 30.0
"""A spool is no longer than this where several layers can avoid it [mm]: its far end is held by a thin roof."""

_MOST_LAYERS = 6

_INSIDE = 1.2  # the least of a shaft in a spool over its diameter: less, and a flat of plastic wears round


def spool_for(
    robot: Robot, winch: Winch, cables: tuple[int, ...], options: PartOptions, motor: Motor
) -> tuple[Spool, tuple[str, ...], tuple[str, ...]]:
    """The spool of a winch, why it cannot be built well, and what to mind.

    Each cable lies in one layer if the spool then is short enough, else all in as few layers as make it so. A radius
    too small for the shaft is made as small as it can be, one of the problems.
    """
    drive = drive_of(motor, options)
    problems = []
    least_inside = _INSIDE * motor.shaft.diameter
    if drive.inside < least_inside:
        problems.append(
            f'winch "{winch.name}": only {max(drive.inside, 0):.1f} mm of the shaft of {motor.title} would be in the '
            f"spool, {least_inside:.1f} mm are needed: take thinner walls or another motor"
        )
    radii, small = _radii(robot, winch, cables, options, motor)
    turns = wraps(1e3 * (winch.travel + winch.release), 1e3 * winch.spool_radius, options.spare_wraps)
    sizes = [_wound(radii, turns, layers, drive.inside, options, motor) for layers in range(1, _MOST_LAYERS + 1)]
    spool = next((each for each in sizes if each.body <= _LONGEST), sizes[-1])
    if spool.body > _LONGEST:
        problems.append(
            f'winch "{winch.name}": {turns:.1f} turns of cable do not fit on a spool of {_LONGEST:g} mm in '
            f"{_MOST_LAYERS} layers: take a larger spool radius or less travel"
        )
    return spool, (*small, *problems), _layers(spool, winch, cables)


def _radii(
    robot: Robot, winch: Winch, cables: tuple[int, ...], options: PartOptions, motor: Motor
) -> tuple[list[float], list[str]]:
    """Radius at which each cable is wound [mm], and a sentence for each that is too small for the shaft."""
    least = motor.shaft.diameter / 2 + options.fit + options.wall + options.cable / 2
    radii, small = [], []
    for index in cables:
        radius = 1e3 * (robot.cables[index].spool_radius or winch.spool_radius)
        if radius < least - 1e-9:
            small.append(
                f'winch "{winch.name}": spool radius {radius:.2f} mm of cable C{index + 1} is too small for the shaft '
                f"of {motor.title} in a wall of {options.wall:g} mm: at least {least:.2f} mm, which is what is printed"
            )
        radii.append(max(radius, least))
    return radii, small


def _layers(spool: Spool, winch: Winch, cables: tuple[int, ...]) -> tuple[str, ...]:
    """A sentence for each cable that lies in more than one layer."""
    found = []
    for index, groove in zip(cables, spool.grooves, strict=True):
        if groove.layers > 1:
            outer = groove.radius + (groove.layers - 1) * spool.cable
            found.append(
                f'cable C{index + 1} of winch "{winch.name}" lies in {groove.layers} layers: its radius grows from '
                f"{groove.radius:.1f} to {outer:.1f} mm, so the last turns take in "
                f"{100 * (outer / groove.radius - 1):.0f} % more than was simulated (E13)"
            )
    return tuple(found)


def _wound(
    radii: Sequence[float], turns: float, layers: int, inside: float, options: PartOptions, motor: Motor
) -> Spool:
    return Spool(
        grooves=tuple(_groove(radius, turns, layers, options.cable) for radius in radii),
        cable=options.cable,
        shaft=motor.shaft,
        inside=max(inside, 0.5),
        play=options.fit,
        wall=options.wall,
        journal=options.clearance + roof_of(options) - 0.2,
    )


def _groove(radius: float, turns: float, layers: int, cable: float) -> Groove:
    """The narrowest that takes so many turns of the first layer's length in these layers."""
    length = turns * 2 * math.pi * radius
    one_turn = capacity(cable * 2.25, radius, cable, layers)
    return Groove(radius=radius, width=width_for(length / one_turn, cable), layers=layers)
