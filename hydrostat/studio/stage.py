"""`Stage`: the contract of each part of the studio that a person works in."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from hydrostat.given import Point
from hydrostat.studio.view.scene_items import RobotShape, SceneItem


class StageName(StrEnum):
    """The stages, in the order of work."""

    START = "start"
    EDIT = "edit"
    POSE = "pose"
    DESIGN = "design"
    DRIVE = "drive"
    EXPORT = "export"


@dataclass(frozen=True, kw_only=True)
class Hit:
    """Object and place under the pointer."""

    key: str = ""  # of a item, such as "marker:tip"; "body" for the body, "" for nothing
    rest: Point | None = None  # the place of the body under the pointer, in the rest shape [m]; None beside the body
    world: Point  # where the pointer is [m]; in space on the item that was hit, or in a plane through what is dragged
    shift: bool = False  # whether the shift key is down


class Stage(ABC):
    """Stage of the studio: handles the pointer and returns its view, without access to network or screen.

    All but `step` return at once. `step` is called by a thread of its own, again and again while it returns True.
    """

    @abstractmethod
    def shape(self) -> RobotShape:
        """Shape that the body has now."""

    @abstractmethod
    def scene_items(self) -> Sequence[SceneItem]:
        """Objects shown with the body, in an order that does not change during a drag."""

    def enter(self) -> None:
        """Begin: the stage is shown from now on."""

    def leave(self) -> None:
        """End: another stage is shown."""

    def grab(self, hit: Hit) -> bool:
        """Take hold of what is under the pointer; False: nothing to hold, the view may be turned instead."""
        return False

    def drag(self, hit: Hit) -> None:
        """Follow the pointer, which has moved with what it holds."""

    def release(self) -> None:
        """Let go of what the pointer held."""

    def click(self, hit: Hit) -> None:
        """Take a click: the pointer was pressed and let go at the same place."""

    def key(self, name: str) -> bool:
        """Heed a key such as "delete", "escape", "space", "r" or "g"; whether it meant something here."""
        return False

    @property
    def undo_label(self) -> str:
        """Label of the step of this stage alone that undo takes back before a change of the document; "" if none."""
        return ""

    @property
    def redo_label(self) -> str:
        """Label of the step of this stage alone that redo makes again; "" if none."""
        return ""

    def undo(self) -> None:
        """Take back what `undo_label` names."""

    def redo(self) -> None:
        """Do again what `redo_label` names."""

    def step(self, now: float) -> bool:
        """Do a bit of work, at a time [s] of a clock that only runs forward; whether there is more to do."""
        return False


SAME_CLICK = 0.005
"""Distance between two clicks that ends a cable or a polygon, as a share of the body: a double click."""


ARROWS = {
    "arrowleft": (-1, 0), "arrowright": (1, 0), "arrowdown": (-1, -1), "arrowup": (1, -1), "pageup": (1, 1),
    "pagedown": (-1, 1),
}  # fmt: skip
"""Sign and axis by which each key moves the selection; the last axis points up, the second of three away."""


def parse_arrow(key: str) -> tuple[float, int] | None:
    """Step [m] and axis of an arrow key: 1 mm, with "shift " before its name 10 mm. None for other keys."""
    arrow = key.removeprefix("shift ")
    if arrow not in ARROWS:
        return None
    sign, axis = ARROWS[arrow]
    return sign * (1e-3 if arrow == key else 1e-2), axis


def format_error(error: float) -> str:
    """Text of an error [m]; nobody builds a robot that is better than a tenth of a millimeter."""
    if error < 1e-4:
        return "below 0.1 mm"
    return f"{1e3 * error:.1f} mm" if error < 0.01 else f"{1e3 * error:.0f} mm"
