"""`Constraints`: what makes a network one that can be built."""

# Of the thesis (docs/thesis.md): R12, R14, R44, R53, E12

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import inf, isfinite
from numbers import Integral, Real
from typing import Any, NoReturn

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.closed_set import make_member
from hydrostat.design.zone import Zone, ZoneUnion
from hydrostat.errors import InputError
from hydrostat.fabrication import ALL_MOTORS
from hydrostat.ik import Limits
from hydrostat.robot import Cable, Mount, Robot, Winch


@dataclass(frozen=True, kw_only=True)
class Range:
    """The values that a number may have."""

    least: float = 0.0  # of them
    most: float = inf  # of them; inf for any that is finite
    above: bool = False  # whether the least itself is too small
    whole: bool = False  # whether they are whole numbers
    optional: bool = False  # whether None will do, which leaves the number open
    unit: str = ""  # in which the least and the most are

    def holds(self, value: object) -> bool:
        """True if a value is one of them."""
        if value is None:
            return self.optional
        if isinstance(value, bool) or not isinstance(value, Integral if self.whole else Real) or not isfinite(value):
            return False
        return self.least <= float(value) <= self.most and not (self.above and value == self.least)

    def __str__(self) -> str:
        """The values in words, such as "above 0 and at most 1 m"."""
        return self.words()

    def words(self, scale: float = 1.0, unit: str | None = None) -> str:
        """The values in words, with the limits so many times as large, in another unit."""
        end = f" {unit or self.unit}".rstrip()
        if self.whole and self.most < inf:
            return f"a whole number from {self.least:g} to {self.most:g}"
        kind = "a whole number, " if self.whole else "finite and " if self.most == inf else ""
        words = f"{kind}{'above' if self.above else 'at least'} {scale * self.least:g}"
        return f"{words}{end}" if self.most == inf else f"{words} and at most {scale * self.most:g}{end}"

    @property
    def display_unit(self) -> tuple[float, str]:
        """Factor and unit of the values as people read them: millimeters for meters."""
        return (1e3, "mm") if self.unit == "m" else (1.0, self.unit)


MAX_LENGTH = 20.0
"""Largest length that can be asked for [m]: a larger one was meant in another unit."""

_LENGTH = Range(above=True, most=MAX_LENGTH, unit="m")
_GAP = Range(most=MAX_LENGTH, unit="m")


def _limit(default: Any, allowed: Range | None = None, *, trees: bool = False) -> Any:
    """Field of `Constraints`: its default, the values that it may have, and whether winch trees keep it."""
    return dataclasses.field(default=default, metadata={"range": allowed, "trees": trees})


@dataclass(frozen=True, kw_only=True)
class Constraints:
    """Limits for every designed network; lengths in meters, at rest.

    `hydrostat.design.buildable` checks a network against them, and defines the measure of each.

    Attributes:
        winch_zones: zones for winches; without zones, anywhere in the body.
        keep_out: zones without cables.
        drawing_gap: minimum distance of cables from small drawn shapes on a flat body, such as eyes [m]; 0 lets cables
            cross them.
        passive_zones: zones in which cables run in sheaths, so that they move nothing.
        mount: place of the winches, in the body or in the world; None: as the robot's own winches are, in the body if
            it has none.
            Winches in the world stand at places of the robot's own winches.
        built_in: restriction of new winches in a flat body to places where motor, spool and housing fit, if they fit
            anywhere; those of a network to be improved stay about where they are.
        cables_per_winch: maximum number of cables of one winch.
        clearance: minimum distance of a cable from the edge of the body [m].
        depth: depth of cables under the surface in space [m], sewn to the skin; 0: on it. It takes the place of
            the clearance, and winches stand in the world. None: anywhere.
        winch_clearance: minimum distance of a winch in the body from its edge [m].
        winch_gap: minimum distance between two winches [m], unless both stand in the world.
        hole_gap: minimum distance between two holes through which cables pass the cloth [m].
        cable_gap: minimum distance [m] between two cables, or two parts of one, so that none cross or run side by side
            within a stitch; and of cables from winches that do not pull them beyond two spool radii. Cables of one
            winch may be nearer within two spool radii of it. 0: cables may cross.
        max_turn: maximum turn of a cable at a via point [degrees].
        bend_radius: minimum radius of the arc that fits a turn between the middles of its two segments [m].
        max_length: maximum length of a cable from winch to stopper [m]; None for no limit.
        tension: maximum cable tension [N].
        torque: maximum torque of the motor of a winch [N m]; None for as much as the tensions need.
        motor: key of the motor of the winches, such as "sts3215"; "auto" for the weakest that is strong enough and
            fits.
        travel: maximum contraction of a winch [m].
        release: maximum payout of a winch [m].
        spool_radius: radius of the spools [m].
        slack: maximum slack at a stopper [m].
        spool_ratio: maximum ratio of a cable's own spool to its winch's, or its inverse; 1 for equal spools.
        two_way: True if a winch may also pull when it turns back, by cables wound in the opposite direction.
        leads: True if a cable may run in a sheath from its winch to the start of the bending part.
        mirror: axis across which the network is symmetric: "x", "y" or "z"; None for no symmetry. The mirror is the
            plane where that coordinate is 0, the center of the drawing.
        locked_winches: names of the robot's own winches to keep.
        locked_cables: names of the robot's own cables to keep unchanged, with their winches.

    Raises:
        InputError: a value of the wrong type or out of range.
    """

    STEPPED = 2.0
    """Spool ratio of a robot whose spools may differ."""

    winch_zones: tuple[Zone, ...] = ()
    keep_out: tuple[Zone, ...] = ()
    drawing_gap: float = _limit(0.003, _GAP)
    passive_zones: tuple[Zone, ...] = ()
    mount: Mount | None = None
    built_in: bool = True
    cables_per_winch: int = _limit(6, Range(whole=True, least=1, most=60), trees=True)
    clearance: float = _limit(0.005, Range(above=True, most=1.0, unit="m"), trees=True)
    depth: float | None = _limit(None, Range(most=0.1, unit="m", optional=True))
    winch_clearance: float = _limit(0.012, _GAP, trees=True)
    winch_gap: float = _limit(0.025, _GAP, trees=True)
    hole_gap: float = _limit(0.004, _GAP, trees=True)
    cable_gap: float = _limit(0.004, _GAP)
    max_turn: float = _limit(30.0, Range(above=True, most=180.0, unit="degrees"))
    bend_radius: float = _limit(0.0, _GAP)
    max_length: float | None = _limit(None, Range(above=True, most=MAX_LENGTH, optional=True, unit="m"))
    tension: float = _limit(20.0, Range(above=True, most=1000.0, unit="N"), trees=True)
    torque: float | None = _limit(None, Range(above=True, most=100.0, unit="N m", optional=True))
    motor: str = "auto"
    travel: float = _limit(0.06, _LENGTH, trees=True)
    release: float = _limit(0.0, _GAP, trees=True)
    spool_radius: float = _limit(0.006, _LENGTH, trees=True)
    slack: float = _limit(0.0, Range(most=1.0, unit="m"))
    spool_ratio: float = _limit(1.0, Range(least=1.0, most=Robot.MAX_RADIUS_RATIO))
    two_way: bool = False
    leads: bool = _limit(True, trees=True)
    mirror: str | None = None
    locked_winches: tuple[str, ...] = ()
    locked_cables: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for field in ("winch_zones", "keep_out", "passive_zones", "locked_winches", "locked_cables"):
            object.__setattr__(self, field, _several(field, getattr(self, field)))
        for field in ("winch_zones", "keep_out", "passive_zones"):
            for place, zone in enumerate(getattr(self, field)):
                if not isinstance(zone, Zone):
                    _refuse(f"{field}[{place}]", zone, "a Zone, such as Zone(at=(0.0, 0.0), radius=0.01)")
        if self.mount is not None:
            make_member(self, "mount", Mount, what="constraints: mount")
        for field in ("leads", "built_in", "two_way"):
            if not isinstance(getattr(self, field), bool):
                _refuse(field, getattr(self, field), "True or False")
        keys = ("auto", *(motor.key for motor in ALL_MOTORS))
        if self.motor not in keys:
            _refuse("motor", self.motor, f"one of {', '.join(keys)}")
        if self.mirror not in (None, "x", "y", "z"):
            _refuse("mirror", self.mirror, '"x", "y", "z", or None for no symmetry')
        self._check_numbers()
        self._check_locks()

    @property
    def tension_limit(self) -> float:
        """Maximum tension of any cable [N].

        The limit is that of the cable, or of the motor of a winch without other cables, on its smallest spool. Cables
        that share a winch share its torque (`Limits.torque`).
        """
        if self.torque is None:
            return self.tension
        return min(self.tension, self.torque * self.spool_ratio / self.spool_radius)

    @cached_property
    def winch_area(self) -> ZoneUnion:
        """All zones for winches together."""
        return ZoneUnion(self.winch_zones)

    @property
    def reverse_release(self) -> float:
        """Maximum payout of a winch that pulls reversed cables [m]."""
        return max(self.release, self.travel)

    def stand_outside(self, robot: Robot) -> bool:
        """True if new winches of a robot are mounted outside the body."""
        if self.mount is None:
            return bool(robot.winches) and all(winch.mount is Mount.WORLD for winch in robot.winches)
        return self.mount is Mount.WORLD

    @property
    def limits(self) -> Limits:
        """Limits on the tension of every cable and the torque of every winch."""
        return Limits(tension=self.tension, torque=self.torque)

    def limit_robot(self, robot: Robot) -> Robot:
        """Return the robot with the limits on tension and torque, which its poses keep."""
        given = {"max_tension": self.tension_limit, "max_torque": self.torque}
        return replace(robot, **{name: value and float(f"{value:.4g}") for name, value in given.items()})

    def restrict_to_trees(self) -> "Constraints":
        """Return only the constraints that winch trees keep."""
        return Constraints(**{one.name: getattr(self, one.name) for one in fields(self) if one.name not in ROUTES_ONLY})

    def flip(self, dim: int) -> Vector:
        """Return the signs that mirror coordinates, (dim,); all 1 without a mirror."""
        return np.array([-1.0 if axis == self.mirror else 1.0 for axis in "xyz"[:dim]])

    def staying(self, robot: Robot) -> tuple[tuple[Winch, ...], tuple[Cable, ...]]:
        """Return the winches and cables of a robot that stay: locked ones, and the winches of locked cables."""
        cables = tuple(cable for cable in robot.cables if cable.name in self.locked_cables)
        names = {*self.locked_winches, *(cable.winch for cable in cables)}
        return tuple(winch for winch in robot.winches if winch.name in names), cables

    def check(self, robot: Robot) -> None:
        """Reject a robot that these constraints do not fit.

        Raises InputError: a zone of another dimension, an unknown locked winch or cable, a mirror on which its body is
        not centered, or winches in the world without a winch of the robot as position.
        """
        mesh = robot.body.mesh
        for field in ("winch_zones", "keep_out", "passive_zones"):
            for place, zone in enumerate(getattr(self, field)):
                if zone.dim != mesh.dim:
                    raise InputError(
                        f"constraints: {field}[{place}]: wrong dimension ({zone.dim}). Body: {mesh.dim}. "
                        f"Give its points {mesh.dim} coordinates."
                    )
                if zone.distances(mesh.nodes).min() > mesh.edge_lengths.max():
                    raise InputError(
                        f"constraints: {field}[{place}]: does not touch the body. "
                        "It would have no effect. Check its position and unit."
                    )
        for field, part in (("locked_winches", robot.winch), ("locked_cables", robot.cable)):
            for place, name in enumerate(getattr(self, field)):
                try:
                    part(name)
                except InputError as error:
                    raise InputError(f"constraints: {field}[{place}]: {error}") from None
        for field, allowed in RANGES.items():
            value = getattr(self, field)
            if allowed.unit == "m" and value is not None and value > _SIZES * mesh.size:
                raise InputError(
                    f"constraints: {field}: too large for a body of {mesh.size:.3g} m ({value:g} m). "
                    f"Maximum: {_SIZES * mesh.size:.3g} m. Give lengths in meters: 5 mm is 0.005."
                )
        if self.mount is Mount.WORLD and not robot.winches:
            raise InputError(
                "constraints: mount: the robot has no winches (world). Winches in the world stand at positions of the "
                "robot's own winches. Add a [[winch]] at each position."
            )
        self._check_mirror(robot)
        self._check_depth(robot)

    def _check_depth(self, robot: Robot) -> None:
        if self.depth is None:
            return
        if robot.body.mesh.dim == 2:
            raise InputError("constraints: depth: a flat body has no skin for cables. Remove depth.")
        winches = all(winch.mount is Mount.WORLD for winch in robot.winches) if self.mount is None else None
        if not robot.winches or not (self.mount is Mount.WORLD if winches is None else winches):
            raise InputError(
                "constraints: depth: cables on the skin come from winches outside the body. "
                'Add a [[winch]] with mount = "world" at each position.'
            )

    def _check_mirror(self, robot: Robot) -> None:
        if self.mirror is None:
            return
        mesh, axis = robot.body.mesh, "xyz".index(self.mirror)
        if axis >= mesh.dim:
            raise InputError(
                f'constraints: mirror: no such axis in a flat body ("{self.mirror}"). Allowed: "x" or "y".'
            )
        low, high = float(mesh.nodes[:, axis].min()), float(mesh.nodes[:, axis].max())
        if abs(low + high) > _ASKEW * (high - low):
            raise InputError(
                f"constraints: mirror: body not centered on {self.mirror} = 0 "
                f"({1e3 * low:.4g} to {1e3 * high:.4g} mm). Move it there or set mirror to None."
            )

    def _check_numbers(self) -> None:
        for field, allowed in RANGES.items():
            value = getattr(self, field)
            if not allowed.holds(value):
                meters = "; in meters: 5 mm is 0.005" if allowed.unit == "m" else ""
                _refuse(field, value, f"{allowed}, or None" if allowed.optional else str(allowed), meters)

    def _check_locks(self) -> None:
        for field, kind in (("locked_winches", "winch"), ("locked_cables", "cable")):
            names = getattr(self, field)
            for place, name in enumerate(names):
                if not isinstance(name, str):
                    _refuse(f"{field}[{place}]", name, f"the name of a {kind}")
                if names.count(name) > 1:
                    raise InputError(f"constraints: {field}: name used twice ({name!r}). Name it once.")

    @classmethod
    def ranges(cls) -> Mapping[str, Range]:
        """Return the allowed values of each number of the record, by the name of its field."""
        return RANGES


RANGES: dict[str, Range] = {one.name: allowed for one in fields(Constraints) if (allowed := one.metadata.get("range"))}
"""Allowed values of each number of `Constraints`."""

ROUTES_ONLY = tuple(one.name for one in fields(Constraints) if not one.metadata.get("trees"))
"""Constraints that winch trees do not keep."""


_SIZES = 10.0  # lengths of constraints are at most so many sizes of the body
_ASKEW = 0.02  # share of its width by which a body's two sides may lie unevenly about a mirror


def _several(field: str, given: object) -> tuple[object, ...]:
    if isinstance(given, str) or not isinstance(given, Iterable):
        _refuse(field, given, "several values in brackets, such as () for none")
    return tuple(given)


def _refuse(field: str, value: object, allowed: str, hint: str = "") -> NoReturn:
    raise InputError(f"constraints: {field} must be {allowed}, not {value!r:.60}{hint}")
