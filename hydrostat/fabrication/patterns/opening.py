"""`Opening`: the slit in the back with its zipper, through which winches are reached (R10)."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from hydrostat.arrays import Float
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import LaserLine, Layer, PatternPart, Place, Shape, trace
from hydrostat.given import Point
from hydrostat.robot import Robot

ZIPPERS = (100, 150, 200, 250, 300, 350, 400, 450, 500)
"""Lengths in which zippers are sold [mm]; any can be cut shorter."""

_PLACKET = 4.0  # from the slit to the line along which the tape is sewn [mm]


@dataclass(frozen=True)
class Opening:
    """A slit and its zipper."""

    slit: LineString  # slit of the length of the zipper's teeth, seen from the front [mm]
    zipper: int  # length to buy [mm]; longer than the slit where none so short is sold

    @property
    def mark(self) -> LaserLine:
        """The slit for the laser."""
        return trace(self.slit, Layer.CUT, PatternPart.OPENING)[0]

    @property
    def placket(self) -> tuple[Shape, ...]:
        """The box along which the tape is sewn under the cloth."""
        box = self.slit.buffer(_PLACKET, cap_style="square", join_style="mitre")
        return trace(box, Layer.MARK, PatternPart.ZIPPER)

    @property
    def label(self) -> str:
        """Such as "zipper 150 mm"."""
        cut = "" if self.slit.length > self.zipper - 1e-6 else f" cut to {self._length} mm"
        return f"zipper {self.zipper} mm{cut}"

    @property
    def _length(self) -> int:
        """Length of the slit in whole millimeters, rounded down [mm]."""
        return int(self.slit.length + 1e-6)

    @property
    def is_short(self) -> bool:
        """True for a slit shorter than any zipper that is sold."""
        return self.slit.length <= ZIPPERS[0] - 1e-6

    def is_over(self, middle: Float[np.ndarray, " 2"]) -> bool:
        """True if its middle is within a quarter of its length of that of the winches [mm], so in no limb aside."""
        aside = self.slit.interpolate(0.5, normalized=True).distance(shapely.Point(middle))
        return aside <= 0.25 * self.slit.length

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentence that it is short for a hand, if it is."""
        if not self.is_short:
            return ()
        return (
            f"the opening has room for {self._length} mm only. Cut a zipper of {self.zipper} mm down to that, "
            "and check that the winch fits through",
        )


def find_opening(
    robot: Robot,
    seam: Polygon,
    pinholes: tuple[Pinhole, ...],
    options: PatternOptions,
    *,
    runs: Iterable[Sequence[Point]] = (),
) -> Opening | None:
    """The opening along the row of winches and `opening_reach` beyond, as long as a zipper that is sold.

    Turned and shifted if need be, so as to stay inside the seam, off the pinholes of its panel and, if that leaves room
    for a hand, off the `runs` of its cables [m]. None without a winch in the body, without reach, or without room.
    """
    places = [(1e3 * winch.at[0], 1e3 * winch.at[1]) for winch in robot.winches]
    ways = [LineString([(1e3 * point[0], 1e3 * point[1]) for point in run]) for run in runs]
    if ways:
        beside = seam.difference(shapely.union_all(ways).buffer(_PLACKET))
        found = opening_at(places, seam, pinholes, options, room=beside)
        if found is not None and not found.is_short and found.is_over(np.mean(places, axis=0)):
            return found
    found = opening_at(places, seam, pinholes, options)
    winch = 45.0  # through a slit so long the unit of any winch passes [mm]
    if found is not None and found.slit.length > winch:
        return found
    nearer = opening_at(places, seam, pinholes, options, tight=True)
    is_longer = nearer is not None and (found is None or nearer.slit.length > found.slit.length)
    return nearer if is_longer else found


def opening_at(
    places: Iterable[Place],
    seam: Polygon,
    pinholes: tuple[Pinhole, ...],
    options: PatternOptions,
    *,
    room: BaseGeometry | None = None,
    tight: bool = False,
) -> Opening | None:
    """The opening over winches at these places on a panel [mm], within `room` if given; None as for `find_opening`.

    `tight` lets it be as near to the seam as its tape can be sewn, and tries more lines between the pinholes.
    """
    reach = options.opening_reach
    winches = np.array([place for place in places if seam.contains(shapely.Point(place))])
    inner: BaseGeometry = seam.buffer(-1.5 * _PLACKET if tight else -reach / 3)
    narrow, room = room is not None or bool(pinholes), inner if room is None else inner.intersection(room)
    if not len(winches) or not reach or room.is_empty:
        return None
    center = shapely.shortest_line(room, shapely.Point(winches.mean(axis=0))).interpolate(0.0)
    corner = math.sqrt(2) * _PLACKET  # from the end of the slit to a corner of its box
    off = [shapely.Point(hole.center).buffer(hole.radius + options.cloth + corner) for hole in pinholes]
    room = room.difference(shapely.union_all(off))
    row = np.linalg.svd(winches - winches.mean(axis=0))[2][0] if len(winches) > 1 else np.array([1.0, 0.0])
    wanted = 2 * (np.abs((winches - winches.mean(axis=0)) @ row).max() + reach)
    slits = []
    # Directions that are tried, from the row of winches [degrees], the best first
    turns = (0, 90, 15, -15, 30, -30, 45, -45, 60, -60, 75, -75)
    # Offsets of a slit from the winches that keep it off pinholes [mm], the best first
    shifts = (0, 6, -6, 12, -12, 18, -18)
    if tight:
        shifts = tuple(side * 0.5 * step for step in range(60) for side in (1, -1))
    for shift in shifts if narrow else shifts[:1]:
        for angle in turns:
            direction = row @ _turn(np.radians(angle))
            middle = np.array(center.coords[0]) + shift * np.array([-direction[1], direction[0]])
            slits.append(_slit(room, middle, direction, wanted))
    longest = max(slit.length for slit in slits)
    if longest <= reach:
        return None
    whole = [slit for slit in slits if slit.length > ZIPPERS[0] - 1e-6]
    slit = next(slit for slit in whole or slits if round(slit.length) > 0.75 * longest)
    made = [
        Opening(slit, next((zipper for zipper in ZIPPERS if zipper >= slit.length - 1e-6), ZIPPERS[-1]))
        for slit in (slit, *whole)
    ]
    return next((opening for opening in made if opening.is_over(winches.mean(axis=0))), made[0])


def _slit(room: BaseGeometry, middle: np.ndarray, direction: np.ndarray, wanted: float) -> LineString:
    """The slit on a line through a place, at most about as long as wanted."""
    chord, middle = _chord(room, middle, direction), middle @ direction
    if chord is None:
        return LineString()
    line, low, high = chord
    length = next((float(zipper) for zipper in ZIPPERS if zipper >= wanted - 1e-6), float(ZIPPERS[-1]))
    fitting = [float(zipper) for zipper in ZIPPERS if zipper <= min(length, high - low)]
    if fitting:
        start = min(max(middle - fitting[-1] / 2, low), high - fitting[-1])
        ends = (start, start + fitting[-1])
    else:
        ends = (max(low, middle - wanted / 2), min(high, middle + wanted / 2))
    return LineString([line.interpolate(end - low) for end in ends])


def _chord(room: BaseGeometry, middle: np.ndarray, direction: np.ndarray) -> tuple[LineString, float, float] | None:
    """The stretch of a line that stays in the room, nearest to a place; and its ends along the direction."""
    far = 2 * np.hypot(room.bounds[2] - room.bounds[0], room.bounds[3] - room.bounds[1])
    line = LineString([middle - far * direction, middle + far * direction]).intersection(room)
    pieces = [piece for piece in getattr(line, "geoms", (line,)) if isinstance(piece, LineString) and piece.length]
    if not pieces:
        return None
    nearest = min(pieces, key=shapely.Point(middle).distance)
    low, high = sorted(np.array(nearest.coords) @ direction, key=float)
    ordered = nearest if np.array(nearest.coords[0]) @ direction == low else nearest.reverse()
    return ordered, float(low), float(high)


def _turn(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
