"""`Outlining`, `reshape_outline`: an outline while a person draws it, and a robot that is given it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.geometry import read_drawing
from hydrostat.given import Point
from hydrostat.project import Work
from hydrostat.robot import Body, BodyPart, Cable, Mount, Pin, PoseTarget, Robot
from hydrostat.studio.starting.loops import Loop, LoopCorner, fit_loops, loops_svg, outline_of, read_loops
from hydrostat.studio.starting.photo import Backdrop
from hydrostat.units import plural

Move = Callable[[Point], Point]  # from a place in the old body to the same in the new


@dataclass(frozen=True, kw_only=True, eq=False)
class Reshaped:
    """A robot with another outline."""

    work: Work  # with the new body
    dropped: tuple[str, ...]  # what lay outside it and is gone, in words, such as "marker tip"


class Outlining:
    """Loops that are drawn, checked as they change."""

    def __init__(
        self, loops: tuple[Loop, ...] = (), robot: Robot | None = None, behind: Backdrop | None = None
    ) -> None:
        self.robot = robot  # whose outline is edited; None: a new one is drawn
        self.behind = behind  # a picture that it is drawn over; None: none
        self.loops: tuple[Loop, ...] = ()  # the rim and holes, in any order
        self.fault = ""  # why they are no body yet; "" if they are
        self.words = ""  # what they are, such as "280 x 240 mm, 21 corners"; "" if they are no body
        self._set(loops)

    @classmethod
    def of(cls, robot: Robot) -> "Outlining":
        """Edit the outline of a robot, as few corners (InputError: it was not drawn)."""
        if robot.body.outline is None:
            raise InputError(f"{robot.name} has no outline. Only flat bodies made from a drawing have one")
        return cls(fit_loops(robot.body.outline), robot)

    def take(self, raw: Any) -> None:
        """Take what a screen has sent (InputError: it is no loops)."""
        self._set(read_loops(raw))

    def drawing(self) -> bytes:
        """The loops as SVG in millimeters (InputError: they are no body)."""
        return loops_svg(self.loops)[0]

    def apply_outline(self, work: Work) -> Reshaped:
        """Return the work with this outline (InputError: it is no body, or no pin lies in it)."""
        drawing, corner = loops_svg(self.loops)
        return reshape_outline(work, drawing, corner)

    def _set(self, loops: tuple[Loop, ...]) -> None:
        self.loops = loops
        try:
            outline = outline_of(loops)
        except HydrostatError as error:
            self.fault, self.words = str(error), ""
            return
        wide, high = 1e3 * np.ptp(outline.exterior, axis=0)
        holes = f", {len(loops) - 1} hole{'s' if len(loops) > 2 else ''}" if len(loops) > 1 else ""
        self.fault = ""
        self.words = f"{wide:.0f} x {high:.0f} mm, {sum(map(len, loops))} corners{holes}"


def beginnings() -> dict[str, tuple[Loop, ...]]:
    """Simple shapes to begin with, by name."""
    disc = tuple(LoopCorner(100 * x, 70 * y, True) for x, y in (_spoke(k, 8) for k in range(8)))
    bar = (LoopCorner(-120, -25), LoopCorner(120, -25), LoopCorner(120, 25), LoopCorner(-120, 25))
    radii = [120 if k % 2 else 45 for k in range(10)]
    spokes = (_spoke(k + 1.5, 10) for k in range(10))
    star = tuple(LoopCorner(radius * x, radius * y, True) for radius, (x, y) in zip(radii, spokes, strict=True))
    return {"Disc": (disc,), "Bar": (bar,), "Star": (star,)}


def _spoke(step: float, steps: int) -> tuple[float, float]:
    angle = 2 * np.pi * step / steps
    return round(float(np.cos(angle)), 3), round(float(np.sin(angle)), 3)


def reshape_outline(work: Work, drawing: bytes, corner: tuple[float, float]) -> Reshaped:
    """Give a flat robot another outline, an SVG in millimeters (InputError: it is no body, or no pin lies in it).

    Coordinates of a body count from the middle of its drawing, so what stays is moved when that moves: `corner` is what
    of the robot lies in the upper left corner of the drawing [mm].
    """
    old = work.robot.body
    if old.thickness is None or old.element_size is None:
        raise InputError("only flat bodies have an outline that can be edited")
    file = old.file if old.file.lower().endswith(".svg") else "outline.svg"
    body = Body.from_outline(
        drawing,
        file=file,
        material=old.material,
        element_size=old.element_size,
        thickness=old.thickness,
        volume=old.volume,
        inner=old.inner,
    )
    x, y = read_drawing(drawing, name=file, inner=old.inner, part=1).page.origin
    middle = np.array([1e-3 * (corner[0] + x), 1e-3 * (corner[1] - y)])

    def move(point: Point) -> Point:
        return tuple(float(value) for value in np.round(np.array(point) - middle, 9))

    body, lost = _with_regions(body, [part.with_transform(move) for part in old.parts])
    body = replace(body, plane=old.plane).with_elements(old.elements)
    robot, dropped = _within_body(_move_parts(work.robot, move), work.robot, body)
    return Reshaped(work=_matching(work, robot, move), dropped=(*lost, *dropped))


def _with_regions(body: Body, parts: Sequence[BodyPart]) -> tuple[Body, list[str]]:
    """The body with the parts that it still holds, and the rest in words."""
    lost = []
    for part in parts:
        try:
            body = body.with_parts((*body.parts, part))
        except InputError:
            lost.append(f"part {part.name}")
    return body, lost


@dataclass(frozen=True, kw_only=True)
class _Parts:
    """All that lies on a body."""

    pins: tuple[Pin, ...]
    rest: dict[str, tuple]
    poses: tuple[PoseTarget, ...]


def _move_parts(robot: Robot, move: Move) -> _Parts:
    def pin_moved(pin: Pin) -> Pin:
        if pin.at is not None:
            return replace(pin, at=move(pin.at))
        assert pin.box is not None
        return replace(pin, box=(move(pin.box[0]), move(pin.box[1])))

    def pose_moved(pose: PoseTarget) -> PoseTarget:
        return replace(pose, targets={name: move(place) for name, place in pose.targets.items()})

    return _Parts(
        pins=tuple(map(pin_moved, robot.pins)),
        rest={
            "winches": tuple(replace(winch, at=move(winch.at)) for winch in robot.winches),
            "cables": tuple(replace(cable, points=tuple(map(move, cable.points))) for cable in robot.cables),
            "markers": tuple(replace(marker, at=move(marker.at)) for marker in robot.markers),
            "loads": tuple(replace(load, at=None if load.at is None else move(load.at)) for load in robot.loads),
        },
        poses=tuple(map(pose_moved, robot.poses.values())),
    )


def _within_body(parts: _Parts, robot: Robot, body: Body) -> tuple[Robot, tuple[str, ...]]:
    """The robot with all parts that lie in the body, and the rest in words."""
    dropped: list[str] = []

    def fits(words: str, points: tuple[Point, ...]) -> bool:
        good = not len(points) or bool((body.distances(np.array(points)) <= 0).all())
        if not good:
            dropped.append(words)
        return good

    pins = []
    for number, pin in enumerate(parts.pins, start=1):
        try:
            pin.anchors(body.mesh)
            pins.append(pin)
        except InputError:
            dropped.append(f"pin {number}")
    if not pins:
        raise InputError("no pin lies inside the new outline. Keep the pinned area, or move a pin first")
    worlds = {winch.name for winch in robot.winches if winch.mount is Mount.WORLD}
    winches = [
        winch for winch in parts.rest["winches"] if winch.name in worlds or fits(f"winch {winch.name}", (winch.at,))
    ]
    standing = {winch.name for winch in winches}
    cables: list[Cable] = []
    for number, cable in enumerate(parts.rest["cables"]):
        inside = cable.points[1:] if cable.winch in worlds else cable.points
        if cable.winch not in standing:
            dropped.append(f"cable {number + 1}")
        elif fits(f"cable {number + 1}", inside):
            cables.append(cable)
    markers = [marker for marker in parts.rest["markers"] if fits(f"marker {marker.name}", (marker.at,))]
    poses = _poses_of(parts.poses, {marker.name for marker in markers}, dropped)
    carriers = {None, *(marker.name for marker in markers)}
    loads = [load for load in parts.rest["loads"] if load.at is None or fits(f"load {load.name}", (load.at,))]
    dropped += [f"load {load.name}" for load in loads if load.marker not in carriers]
    loads = tuple(load for load in loads if load.marker in carriers)
    options = {"pins": tuple(pins), "markers": tuple(markers), "poses": poses, "loads": loads}
    made = replace(robot, body=body, winches=tuple(winches), cables=tuple(cables), **options)
    return made, tuple(dropped)


def _poses_of(poses: tuple[PoseTarget, ...], markers: set[str], dropped: list[str]) -> dict[str, PoseTarget]:
    """Poses of the markers that are left."""
    kept = {}
    for pose in poses:
        targets = {name: place for name, place in pose.targets.items() if name in markers}
        lost = len(pose.targets) - len(targets)
        if targets or not pose.targets:
            kept[pose.name] = replace(pose, targets=targets)
        if lost:
            dropped.append(f"{plural(lost, 'target')} of pose {pose.name}")
    return kept


def _matching(work: Work, robot: Robot, move: Move) -> Work:
    """Wishes and keyframes that fit the robot."""
    zones = tuple((paint, zone.move(move)) for paint, zone in work.wishes.zones)
    timeline, wishes = work.follow_robot(robot)
    return replace(work, robot=robot, timeline=timeline, wishes=replace(wishes, zones=zones))
