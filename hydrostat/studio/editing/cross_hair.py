"""`CrossHair`: a place that arrow keys move, to place parts without a pointer."""

from collections.abc import Callable

import numpy as np

from hydrostat.drawing import Color
from hydrostat.given import Point
from hydrostat.robot import Body
from hydrostat.studio.document import Document
from hydrostat.studio.editing.hold import inside, tidy
from hydrostat.studio.stage import Hit, parse_arrow
from hydrostat.studio.view.scene_items import Dot, Look


class CrossHair:
    """A place in the box around the body, or none while it is hidden."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._shown: tuple[Body, Point] | None = None

    @property
    def at(self) -> Point | None:
        """The place [m]; None while it is hidden, as it is in another body."""
        shown = self._shown
        return shown[1] if shown is not None and shown[0] is self._document.robot.body else None

    def show(self, at: Point | None = None) -> None:
        """Show it at a place [m], or in the middle of the body."""
        body = self._document.robot.body
        low, high = body.mesh.nodes.min(axis=0), body.mesh.nodes.max(axis=0)
        middle = at if at is not None else inside(body, tuple(((low + high) / 2).tolist()))
        self._shown = body, tidy(tuple(np.clip(middle, low, high).tolist()))

    def hide(self) -> None:
        """Hide it."""
        self._shown = None

    def move(self, step: float, axis: int) -> None:
        """Move it by a step [m] along an axis; it stays in the box around the body."""
        if self.at is not None:
            at = np.array(self.at)
            at[axis] += step
            self.show(tuple(at.tolist()))

    def press(self, name: str, use: Callable[[Hit], None], start: Point | None, *, can_show: bool) -> bool:
        """Show it at a start [m] by enter if it may be shown, then call `use`; move it by arrows. False: other keys."""
        hit, arrow = self.hit, parse_arrow(name)
        if hit is None and name == "enter" and can_show:
            self.show(start)
        elif hit is not None and name == "enter":
            use(hit)
        elif hit is not None and arrow is not None:
            self.move(*arrow)
        else:
            return False
        return True

    @property
    def hit(self) -> Hit | None:
        """Hit of a click there; None while it is hidden."""
        return None if self.at is None else Hit(key="body", rest=self.at if self._is_inside else None, world=self.at)

    @property
    def words(self) -> str:
        """Its place, such as "x 12.0, y 30.0 mm"; "" while it is hidden."""
        if self.at is None:
            return ""
        places = ", ".join(f"{axis} {1e3 * value + 0.0:.1f}" for axis, value in zip("xyz", self.at, strict=False))
        return f"{places} mm{'' if self._is_inside else ', outside the body'}"

    @property
    def _is_inside(self) -> bool:
        return self.at is not None and not self._document.robot.body.distances(np.array([self.at])).any()

    def scene_items(self) -> list[Dot]:
        """A cross with its place next to it."""
        if self.at is None:
            return []
        return [Dot(at=self.at, look=Look.TARGET, color=Color.INK, label=self.words, chosen=True, stuck=False)]
