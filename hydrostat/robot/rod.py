"""`Rod`: an elastic rod in a body, such as a spring steel wire or a spine."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.errors import InputError
from hydrostat.given import Point, check_name, check_point, check_positive
from hydrostat.robot.body import Body

SHARPEST = 100.0
"""Sharpest turn of a rod at rest [degrees]."""


@dataclass(frozen=True, kw_only=True)
class Rod:
    """Elastic rod embedded in the body along a polyline; it resists stretch, bending and, if given, twist.

    The stiffness of a round rod follows from its diameter and Young's modulus: EA = E pi d^2 / 4, EI = E pi d^4 / 64.
    A bonded rod has GJ = EI / (1 + nu), 0.77 EI for steel; a rod that turns in its sheath resists no twist.

    Attributes:
        name: name, unique in the robot.
        points: corners in the body at rest [m], at least two. A rod that is bent at rest keeps the angles of its bends,
            not their sides.
        diameter: diameter of a round rod [m]; None with stiffnesses.
        young: Young's modulus of a round rod [Pa]; None with stiffnesses.
        axial_stiffness: EA [N]; None for a round rod.
        bending_stiffness: EI [N m^2]; None for a round rod.
        torsional_stiffness: GJ [N m^2], only in space; None if the rod resists no twist.

    Raises:
        InputError: too few points, a value out of range, or neither diameter and young nor both stiffnesses.
    """

    name: str
    points: tuple[Point, ...]
    diameter: float | None = None
    young: float | None = None
    axial_stiffness: float | None = None
    bending_stiffness: float | None = None
    torsional_stiffness: float | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if len(self.points) < 2:
            raise InputError("points: a rod needs at least two")
        for index, point in enumerate(self.points):
            check_point(f"points[{index}]", point)
            if len(point) != len(self.points[0]):
                raise InputError(f"points[{index}] has {len(point)} coordinates, points[0] has {len(self.points[0])}")
            if index and point == self.points[index - 1]:
                raise InputError(f"points[{index}] is the one before it; remove it")
        spans = np.diff(np.array(self.points), axis=0)
        spans /= np.linalg.norm(spans, axis=1)[:, None]
        turns = np.degrees(np.arccos(np.clip((spans[:-1] * spans[1:]).sum(axis=1), -1, 1)))
        if (turns > SHARPEST).any():
            index = int(np.argmax(turns))
            raise InputError(
                f"points[{index + 1}]: the rod turns by {turns[index]:.0f} degrees there, at most {SHARPEST:.0f} are "
                "allowed; round the corner by more points"
            )
        section = (self.diameter, self.young)
        stiffness = (self.axial_stiffness, self.bending_stiffness)
        if [None not in section, None not in stiffness, any(section), any(stiffness)] not in _FORMS:
            raise InputError("give diameter and young, or axial_stiffness and bending_stiffness")
        for key, unit in _UNITS.items():
            if (value := getattr(self, key)) is not None:
                check_positive(key, value, unit)
        if self.torsional_stiffness is not None and len(self.points[0]) == 2:
            raise InputError("torsional_stiffness: a rod in a flat body does not twist; remove it")

    @property
    def length(self) -> float:
        """Length at rest [m]."""
        return float(np.linalg.norm(np.diff(np.array(self.points), axis=0), axis=1).sum())

    def with_transform(self, move: Callable[[Point], Point], factor: float) -> "Rod":
        """Return the rod with points moved by `move`, and diameter scaled by `factor`, GJ included; EA and EI stay."""
        given: dict[str, float] = {}
        if self.diameter is not None:
            given["diameter"] = factor * self.diameter
            if self.torsional_stiffness is not None:
                given["torsional_stiffness"] = factor**4 * self.torsional_stiffness
        return replace(self, points=tuple(map(move, self.points)), **given)

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """EA [N] and EI [N m^2]."""
        if self.diameter is not None and self.young is not None:
            return self.young * math.pi * self.diameter**2 / 4, self.young * math.pi * self.diameter**4 / 64
        return self.axial_stiffness or 0.0, self.bending_stiffness or 0.0


def sample_rod(rod: Rod, count: int = 200) -> Points:
    """Places along a rod at rest, its points among them, about `count` in all [m]."""
    points = np.array(rod.points, dtype=float)
    spans = np.diff(points, axis=0)
    lengths = np.linalg.norm(spans, axis=1)
    places = [points[:1]]
    for start, span, length in zip(points[:-1], spans, lengths, strict=True):
        steps = max(round(count * length / lengths.sum()), 1)
        places.append(start + np.linspace(0, 1, steps + 1)[1:, None] * span)
    return np.concatenate(places)


def check_rods_inside(rods: Iterable[Rod], body: Body, text: Callable[[Point | float], str]) -> None:
    """Reject rods of which a straight piece lies outside the body (InputError); `text` words points and lengths."""
    for index, rod in enumerate(rods):
        places = sample_rod(rod)
        gaps = body.distances(places)
        if gaps.max() > 1e-3 * body.mesh.size:
            where = text(tuple(places[int(np.argmax(gaps))].tolist()))
            raise InputError(
                f"rod[{index}].points: the rod leaves the body by {text(float(gaps.max()))} at {where}; "
                "lead it round by more points"
            )


_FORMS = ([True, False, True, False], [False, True, False, True])
_UNITS = {
    "diameter": "m",
    "young": "Pa",
    "axial_stiffness": "N",
    "bending_stiffness": "N m^2",
    "torsional_stiffness": "N m^2",
}
