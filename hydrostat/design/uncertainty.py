"""`BuildTolerances`: manufacturing tolerances, what a robot that is built may differ by from its model."""

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.constraints import Range
from hydrostat.errors import InputError
from hydrostat.robot import Body, Mount, Robot


@dataclass(frozen=True, kw_only=True)
class BuildTolerances:
    """Standard deviations of build tolerances, and the range of unknown friction.

    The default is hand-sewn plush: a needle misses its mark by about 2 mm, filling and felt differ from bag to bag, and
    the friction of fishing line in grommets varies. These values are our estimates, not measurements: measure yours.

    Attributes:
        sewing: deviation of each coordinate of each hole, winches included [m].
        friction: least and largest friction coefficient at via points; uniform between them, one value for each robot.
        young: deviation of the logarithm of Young's modulus.
        thickness: deviation of the logarithm of a flat body's thickness.
        stiffness: deviation of the logarithm of each cable's stiffness.
        pins: deviation of the logarithm of each pin's stiffness.
        slack: deviation of the position of each cable's knot [m]; winches count from where their first cable goes taut.
        spool: deviation of the logarithm of each winch's radius, from layers of line and printing.

    Raises:
        InputError: a value out of range.
    """

    sewing: float = 2e-3
    friction: tuple[float, float] = (0.0, 0.2)
    young: float = 0.2
    thickness: float = 0.1
    stiffness: float = 0.2
    pins: float = 0.5
    slack: float = 1e-3
    spool: float = 0.03

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name == "friction":
                continue
            allowed = UNCERTAINTY_RANGES[field.name]
            if not allowed.holds(value := getattr(self, field.name)):
                raise InputError(f"uncertainty: {field.name} must be {allowed}, not {value!r:.60}")
        low, high = _band(self.friction)
        object.__setattr__(self, "friction", (low, high))

    @classmethod
    def of(cls, body: Body) -> Self:
        """Return the default tolerances for a body: sewn if flat, cast with tubes in the mold if in space.

        The deviation of Young's modulus is that of the material's interval, if measured.
        """
        usual = cls() if body.mesh.dim == 2 else cls(sewing=1e-3, friction=(0.0, 0.15), thickness=0.0)
        measured = body.material.young_deviation
        return usual if measured is None else replace(usual, young=min(measured, 1.0))

    @classmethod
    def none(cls) -> Self:
        """Return zero tolerances, for a robot built exactly as its model."""
        return cls(
            sewing=0.0, friction=(0.0, 0.0), young=0.0, thickness=0.0, stiffness=0.0, pins=0.0, slack=0.0, spool=0.0
        )

    def draw(self, robot: Robot, chance: np.random.Generator) -> Robot:
        """Draw a robot with random build errors; every draw takes the same number of random values.

        Holes stay in the body: a hole that would be outside is moved half as far, repeatedly.
        """
        dim = robot.body.mesh.dim
        young, thick = np.exp(self._deviations[:2] * chance.standard_normal(2))
        low, high = self.friction
        friction = float(chance.uniform(low, high))
        soft = np.exp(self.pins * chance.standard_normal(len(robot.pins)))
        pins = [
            replace(pin, stiffness=float(scale) * pin.stiffness) for pin, scale in zip(robot.pins, soft, strict=True)
        ]
        winches = []
        for winch in robot.winches:
            offset, scale = self.sewing * chance.standard_normal(dim), np.exp(self.spool * chance.standard_normal())
            held = winch.mount is Mount.WORLD
            at = winch.at if held else _move_within(robot.body, np.array([winch.at]), offset[None])[0]
            winches.append((replace(winch, at=tuple(map(float, at))), float(scale)))
        places = {winch.name: (winch, scale) for winch, scale in winches}
        knots = self._knots(robot, chance)
        cables = []
        for cable, knot in zip(robot.cables, knots, strict=True):
            points = np.array(cable.points)
            offsets = self.sewing * chance.standard_normal(points.shape)
            stiff = float(np.exp(self.stiffness * chance.standard_normal()))
            winch, scale = places[cable.winch]
            points[1:] = _move_within(robot.body, points[1:], offsets[1:])
            points[0] += np.subtract(winch.at, robot.winch(cable.winch).at)
            cables.append(
                replace(
                    cable,
                    points=tuple(tuple(map(float, point)) for point in points),
                    stiffness=cable.stiffness * stiff,
                    slack=cable.slack + float(knot),
                    friction=friction,
                    spool_radius=scale * (cable.spool_radius or winch.spool_radius),
                )
            )
        given = robot.body.material
        material = replace(given.with_young(float(young) * given.young), name="", source="")
        thickness = robot.body.thickness
        body = replace(robot.body, material=material, thickness=None if thickness is None else float(thick) * thickness)
        return replace(
            robot,
            body=body,
            pins=tuple(pins),
            winches=tuple(winch for winch, _ in winches),
            cables=tuple(cables),
        )

    @property
    def _deviations(self) -> Vector:
        return np.array([self.young, self.thickness])

    def _knots(self, robot: Robot, chance: np.random.Generator) -> Vector:
        """Delay of each cable behind the first taut one of its winch, as a contraction [m].

        Reversed cables are knotted where the others begin to pull; one that would be taut before is knotted there.
        """
        knots = self.slack * chance.standard_normal(len(robot.cables))
        for winch in robot.winches:
            own = [index for index, cable in enumerate(robot.cables) if cable.winch == winch.name]
            back = [index for index in own if robot.cables[index].reverse]
            own = [index for index in own if index not in back] or back
            if own:
                first = knots[own].min()
                knots[own] -= first
                if back is not own:
                    knots[back] = np.maximum(knots[back] + first, 0.0)
        return knots


_SHARE = Range(most=1.0)
_LENGTH = Range(most=0.1, unit="m")

UNCERTAINTY_RANGES = {
    "sewing": _LENGTH,
    "young": _SHARE,
    "thickness": _SHARE,
    "stiffness": _SHARE,
    "pins": _SHARE,
    "slack": _LENGTH,
    "spool": Range(most=0.3),
}
"""Allowed range of each number of `BuildTolerances`."""


def _band(given: object) -> tuple[float, float]:
    try:
        low, high = map(float, given)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError(f"uncertainty: friction must be two numbers, such as (0.0, 0.2), not {given!r:.60}") from None
    if not 0 <= low <= high <= 1.0:
        raise InputError(f"uncertainty: friction must rise from at least 0 to at most 1, not {given!r:.60}")
    return low, high


def _move_within(body: Body, places: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Move places by offsets, by less where they would leave the body."""
    offsets = offsets.copy()
    for _ in range(_HALVINGS):
        out = body.distances(places + offsets) > 0
        if not out.any():
            return places + offsets
        offsets[out] *= 0.5
    return places


_HALVINGS = 8
