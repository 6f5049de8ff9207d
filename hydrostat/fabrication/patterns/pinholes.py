"""`Pinhole`: where cables pass through the cloth, and which of them cannot be cut."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patterns.shape import Circle, Layer, PatternPart, Place
from hydrostat.robot import Mount, Robot

_POINT_TOLERANCE = 0.01  # points nearer than this [mm] are one point


@dataclass(frozen=True)
class Pinhole:
    """One hole, for one cable or several."""

    center: Place  # [mm]
    radius: float  # [mm]
    uses: tuple[tuple[int, int], ...]  # (cable, point) index pairs of the cable points that it serves
    winch: str = ""  # name of the winch whose cables leave through it; empty for a hole further along

    @property
    def name(self) -> str:
        """The first cable point that it serves."""
        cable, point = self.uses[0]
        return f"cable[{cable}].points[{point}]"

    @property
    def circle(self) -> Circle:
        """The hole for the laser."""
        return Circle(layer=Layer.PINHOLE, part=PatternPart.PINHOLE, center=self.center, radius=self.radius)

    def gap(self, other: "Pinhole") -> float:
        """Cloth between two holes [mm], below 0 where they overlap."""
        return float(np.hypot(*np.subtract(self.center, other.center))) - self.radius - other.radius


def find_pinholes(robot: Robot, seam: BaseGeometry, options: PatternOptions) -> tuple[Pinhole, ...]:
    """A hole for every cable point, as a cable is stitched in and out of the cloth at its points.

    Cables that meet in a point share its hole; exits of one winch that overlap become one larger hole round them all. A
    cable that comes from a winch outside the body gets no hole there.
    """
    found: dict[tuple[int, int], Pinhole] = {}
    for cable_index, cable in enumerate(robot.cables):
        outside = robot.winch(cable.winch).mount is Mount.WORLD
        for index, point in enumerate(cable.points):
            center = (1e3 * point[0], 1e3 * point[1])
            if index == 0 and outside and not seam.intersects(shapely.Point(center)):
                continue
            exit_of = cable.winch if index == 0 else ""
            found[cable_index, index] = Pinhole(center, options.pinhole / 2, ((cable_index, index),), exit_of)
    return _merge(found.values())


def pinhole_problems(pinholes: Iterable[Pinhole], seam: Polygon, options: PatternOptions) -> tuple[str, ...]:
    """Return the reasons why holes cannot be cut, one line each: too near the seam, or overlapping."""
    pinholes = tuple(pinholes)
    problems = []
    for hole in pinholes:
        distance = seam.boundary.distance(shapely.Point(hole.center))
        inside = seam.contains(shapely.Point(hole.center))
        needed = hole.radius + options.cloth
        if not inside or distance < needed:
            where = f"{distance:.2f} mm {'from' if inside else 'beyond'} the seam"
            problems.append(
                f"{hole.name} = {_text(hole.center)} is {where}, but its pinhole needs {needed:.4g} mm. Move it inwards"
            )
    for one, other in combinations(pinholes, 2):
        if one.gap(other) < 0:
            apart = np.hypot(*np.subtract(one.center, other.center))
            problems.append(
                f"{one.name} = {_text(one.center)} and {other.name} are {apart:.2f} mm apart: their pinholes of "
                f"{2 * one.radius:.4g} mm overlap. Move one away, or both onto one point"
            )
    return tuple(problems)


def _merge(pinholes: Iterable[Pinhole]) -> tuple[Pinhole, ...]:
    """Holes with those on one point, and overlapping exits of one winch, made one."""
    merged: list[Pinhole] = []
    for new in pinholes:
        hole = new
        while partner := next((other for other in merged if _one_hole(hole, other)), None):
            merged.remove(partner)
            hole = _join(partner, hole)
        merged.append(hole)
    return tuple(sorted(merged, key=lambda hole: hole.uses))


def _one_hole(one: Pinhole, other: Pinhole) -> bool:
    same_point = np.hypot(*np.subtract(one.center, other.center)) < _POINT_TOLERANCE
    return bool(same_point or (one.winch and one.winch == other.winch and one.gap(other) < 0))


def _join(one: Pinhole, other: Pinhole) -> Pinhole:
    """The smallest hole round two."""
    uses = tuple(sorted((*one.uses, *other.uses)))
    winch = one.winch or other.winch
    shift = np.subtract(other.center, one.center)
    apart = float(np.hypot(*shift))
    if apart < _POINT_TOLERANCE or apart + min(one.radius, other.radius) <= max(one.radius, other.radius):
        larger = max(one, other, key=lambda hole: hole.radius)
        return Pinhole(larger.center, larger.radius, uses, winch)
    radius = (apart + one.radius + other.radius) / 2
    center = np.add(one.center, shift * ((radius - one.radius) / apart))
    return Pinhole((float(center[0]), float(center[1])), radius, uses, winch)


def _text(place: Place) -> str:
    return f"[{place[0]:.4g}, {place[1]:.4g}] mm"
