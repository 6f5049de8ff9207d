"""`Ruler`: the distance between two places of the body at rest."""

from dataclasses import dataclass

import numpy as np

from hydrostat.drawing import INK
from hydrostat.robot import Point
from hydrostat.studio.view.things import Dot, Look, Strand, Stroke, Thing


@dataclass(frozen=True)
class Ruler:
    """A ruler that is laid on one place, then on another."""

    points: tuple[Point, ...]  # one or two places [m]

    def to(self, at: Point) -> "Ruler":
        """The same laid on one more place; one that was full begins anew there."""
        return Ruler((*self.points, at) if len(self.points) < 2 else (at,))

    @property
    def words(self) -> str:
        """The straight distance and its parts, such as "50.0 mm (x 30.0, y 40.0)"; "" for one place."""
        if len(self.points) < 2:
            return ""
        ways = 1e3 * np.abs(np.subtract(self.points[1], self.points[0]))
        parts = ", ".join(f"{axis} {way:.1f}" for axis, way in zip("xyz", ways, strict=False))
        return f"{np.linalg.norm(ways):.1f} mm ({parts})"

    def things(self) -> list[Thing]:
        """The line, and its ends."""
        label = self.words.partition(" (")[0]
        dots: list[Thing] = [
            Dot(at=point, look=Look.VIA, colour=INK, label=label if number else "", chosen=bool(number), stuck=False)
            for number, point in enumerate(self.points)
        ]
        if len(self.points) < 2:
            return dots
        return [Strand(points=self.points, stroke=Stroke.PATH, colour=INK, loose=-1), *dots]
