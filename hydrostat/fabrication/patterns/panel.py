"""`Panel`: one piece of cloth."""

from dataclasses import dataclass, replace
from typing import Self

from hydrostat.fabrication.patterns.shape import Place, Shape
from hydrostat.robot import Point


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One piece of cloth, its right side up.

    Attributes:
        name: "front", "back", or "gusset-1" and so on for the pieces of the strip between them.
        origin: where the robot's [0, 0] lies on the sheet [mm]; of a piece of the gusset, where its seam with the back
            begins.
        mirrored: whether the robot's x runs to the left, as seen from behind.
        shapes: in places of the sheet [mm].
    """

    name: str
    origin: Place
    mirrored: bool
    shapes: tuple[Shape, ...]

    def on_sheet(self, point: Point) -> Place:
        """Where a point of the robot [m] lies on the sheet [mm]; for the front and the back."""
        x, y = 1e3 * point[0], 1e3 * point[1]
        return self.origin[0] + (-x if self.mirrored else x), self.origin[1] + y

    def moved(self, dx: float, dy: float) -> Self:
        """The same panel elsewhere on the sheet, by a shift [mm]."""
        origin = (self.origin[0] + dx, self.origin[1] + dy)
        return replace(self, origin=origin, shapes=tuple(shape.moved(dx, dy) for shape in self.shapes))
