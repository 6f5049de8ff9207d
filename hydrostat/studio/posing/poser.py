"""`Poser`: the stage "pose"."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from threading import RLock

import numpy as np

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry.anchors import locate
from hydrostat.plot.palette import GHOST
from hydrostat.robot import Point, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.bars import Bar, bars
from hydrostat.studio.posing.held import Held, Mode, Wish
from hydrostat.studio.posing.mover import Anchored
from hydrostat.studio.posing.movers import Movers, same_body
from hydrostat.studio.posing.poses import free_name, held_of, renamed_pose, with_pose, without_pose
from hydrostat.studio.posing.reach import Reach
from hydrostat.studio.stage import Hit, Stage
from hydrostat.studio.view.robot_things import MARKER, robot_things, target_things
from hydrostat.studio.view.shape import Shape, rest_shape
from hydrostat.studio.view.things import Dot, Ghost, Look, Thing

READY = "getting ready ..."
"""Said while the physics of a robot is made."""

NEAR = 0.02
"""A plain point so near to one that is held is that one, in sizes of the body."""

FARTHEST = 1.0
"""No target is farther from the box of the body at rest, in sizes of the body."""

TARGET_GHOST = "#8fb4d6"


@dataclass(frozen=True, kw_only=True)
class _Hold:
    """What the pointer has hold of.

    Attributes:
        name: of the point.
        at: where it is in the rest shape [m].
        offset: from the pointer to its target [m].
    """

    name: str
    at: Point
    offset: tuple[float, ...]


class Poser(Stage):
    """Grab any point of the body and drag it; muscles or the robot's own cables follow (R2, R30, R36).

    What a person wants is one frozen `Wish` that is replaced whole; `step` reads the newest and replaces the shape.

    Attributes:
        reach: all that a marker can reach.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        """Poses of the robot of a document."""
        self._document = document
        self.reach = Reach(document, jobs)
        self._lock = RLock()
        self._movers = Movers(document)
        self._robot: Robot | None = None
        self._wish = Wish(mode=Mode.MUSCLES)
        self._done: tuple[Robot, Wish, float] | None = None
        self._rested: dict[Mode, int] = {}
        self._announced = False
        self._shown: Shape | None = None
        self._hold: _Hold | None = None
        self._armed = ""
        self._chosen = ""
        self._target: Ghost | None = None
        self._anchored: Anchored

    @property
    def mode(self) -> Mode:
        """What moves the body."""
        return self._fit()[1].mode

    @property
    def held(self) -> Mapping[str, Held]:
        """What is held where, by name."""
        return self._fit()[1].held

    @property
    def armed(self) -> bool:
        """Whether the next click or drag moves what is chosen."""
        return bool(self._armed)

    @property
    def chosen(self) -> str:
        """Name of the held point or marker that is chosen; "" if none is."""
        return self._chosen

    def shape(self) -> Shape:
        """The body as it follows; at rest until the first step."""
        robot, _ = self._fit()
        shape = self._shown
        return rest_shape(robot) if shape is None else shape

    def things(self) -> Sequence[Thing]:
        """Ghosts, the robot, points that are held, and rings where they should be."""
        robot, wish = self._fit()
        shape = self.shape()
        limit = self._document.work.wishes.tension
        keys = {f"marker:{self._chosen}", f"point:{self._chosen}"} if self._chosen else set()
        found: list[Thing] = [Ghost(name="rest", nodes=robot.body.mesh.nodes, colour=GHOST)]
        if self._target is not None:
            found.append(self._target)
        cloud = self.reach.cloud(robot)
        if cloud is not None:
            found.append(cloud)
        found += robot_things(robot, tensions=shape.tensions, scale=limit, chosen=keys)
        markers = {marker.name for marker in robot.markers}
        found += [
            Dot(key=f"point:{name}", at=point.at, look=Look.HANDLE, colour=MARKER, chosen=f"point:{name}" in keys)
            for name, point in wish.held.items()
            if name not in markers
        ]
        places = self._anchored.places(wish.held, shape.nodes)
        return found + target_things(
            {name: point.target for name, point in wish.held.items()},
            dict(zip(wish.held, (tuple(place.tolist()) for place in places), strict=True)),
            chosen=f"target:{self._chosen}",
        )

    def grab(self, hit: Hit) -> bool:
        """Take hold of a marker, a target or any point of the body."""
        robot, wish = self._fit()
        name = self._armed or self._name_under(robot, wish, hit)
        if not name:
            return False
        point = self._point(robot, wish, name, hit)
        start = self._place(name, point, shape=self.shape()) if not self._armed else hit.world
        if hit.key == f"target:{name}":
            start = point.target
        offset = tuple((np.array(start) - np.array(hit.world)).tolist())
        self._hold, self._armed, self._chosen = _Hold(name=name, at=point.at, offset=offset), "", name
        return True

    def drag(self, hit: Hit) -> None:
        """What is held should follow the pointer; the newest place wins."""
        hold = self._hold
        if hold is None or not np.isfinite(hit.world).all():
            return
        self._hold_at(hold.name, hold.at, np.array(hit.world) + hold.offset)

    def release(self) -> None:
        """The target stays where it is."""
        self._hold = None

    def click(self, hit: Hit) -> None:
        """Choose what was clicked; after the key g, put what is chosen there."""
        robot, wish = self._fit()
        if self._armed:
            name, self._armed = self._armed, ""
            self._hold_at(name, self._point(robot, wish, name, hit).at, np.array(hit.world))
            return
        kind, _, name = hit.key.partition(":")
        self._chosen = name if kind in ("marker", "target", "point") else ""

    def key(self, name: str) -> bool:
        """R: rest; delete: let go of what is chosen; g: the next click or drag moves it; escape: choose nothing."""
        if name == "r":
            self.rest()
        elif name == "delete" and self._chosen in self.held:
            self.clear(self._chosen)
        elif name == "g" and self._chosen:
            self._armed = self._chosen
        elif name == "escape":
            self._chosen = self._armed = ""
        else:
            return False
        return True

    def choose(self, name: str) -> None:
        """Select a held point or marker."""
        self._chosen = name
        self._document.bell.ring(Topic.THINGS)

    def set_mode(self, mode: Mode) -> None:
        """Let muscles or cables move the body; what is held stays held.

        Raises:
            InputError: the robot has no cables.
        """
        with self._lock:
            robot, wish = self._fit()
            if mode is wish.mode:
                return
            if mode is Mode.CABLES and not robot.cables:
                raise InputError("this robot has no cables yet; find some in Design, or place them in Edit")
            self._target = None
            if mode is Mode.CABLES and wish.held:
                self._target = Ghost(name="target", nodes=self.shape().nodes, colour=TARGET_GHOST)
            self._wish = replace(wish, mode=mode)
        self._ring()

    def rest(self) -> None:
        """Back to rest: no targets, no cable taken in."""
        with self._lock:
            _, wish = self._fit()
            self._wish = Wish(mode=wish.mode, rests=wish.rests + 1)
            self._hold, self._target = None, None
            self._chosen = self._armed = ""
        self._ring()

    def clear(self, name: str) -> None:
        """Let go of a held point."""
        with self._lock:
            _, wish = self._fit()
            self._wish = replace(wish, held={own: held for own, held in wish.held.items() if own != name})
            self._chosen = ""
        self._ring()

    def store(self, name: str) -> None:
        """Keep what is held as a pose of the robot; can be undone.

        Raises:
            InputError: no name, or nothing is held.
        """
        robot, wish = self._fit()
        changed = with_pose(robot, name, wish.held)
        self._document.change(f"store pose {name.strip()}", robot=changed)

    def show_pose(self, name: str) -> None:
        """Hold the targets of a pose; the body moves there.

        Raises:
            InputError: no such pose.
        """
        with self._lock:
            robot, wish = self._fit()
            self._wish = replace(wish, held=held_of(robot, name))
            self._chosen, self._target = "", None
        self._ring()

    def rename_pose(self, old: str, new: str) -> None:
        """Give a pose another name; can be undone.

        Raises:
            InputError: no such pose, no name, or one that is taken.
        """
        self._document.change(f"rename pose {old}", robot=renamed_pose(self._document.robot, old, new))

    def delete_pose(self, name: str) -> None:
        """Remove a pose; can be undone.

        Raises:
            InputError: no such pose.
        """
        self._document.change(f"delete pose {name}", robot=without_pose(self._document.robot, name))

    def bars(self) -> list[Bar]:
        """What each winch does."""
        robot, _ = self._fit()
        return bars(robot, self.shape(), self._document.work.wishes.tension)

    def step(self, now: float) -> bool:
        """One update of the mover; the first only says that it may take a while."""
        robot, wish = self._fit()
        tension = self._document.work.wishes.tension
        if self._done is not None and all(
            old is new for old, new in zip(self._done, (robot, wish, tension), strict=True)
        ):
            return False
        if not self._movers.ready(robot, wish.mode) and not self._announced:
            self._announced = True
            self._publish(robot, replace(self.shape(), notes=(READY,)))
            return True
        self._announced = False
        try:
            mover = self._movers.mover(robot, wish.mode, tension)
        except NotConvergedError as error:
            self._done = (robot, wish, tension)
            self._publish(robot, replace(self.shape(), notes=(str(error),)))
            return False
        if self._rested.get(wish.mode) != wish.rests:
            self._rested[wish.mode] = wish.rests
            mover.rest()
        shape, more = mover.update(wish.held)
        self._publish(robot, shape)
        if not more:
            self._done = (robot, wish, tension)
        return more or self._wish is not wish

    def _publish(self, robot: Robot, shape: Shape) -> None:
        with self._lock:
            if self._robot is not None and same_body(self._robot, robot):
                self._shown = _fitted(self._robot, shape)
        self._document.bell.ring(Topic.SHAPE)

    def _ring(self) -> None:
        self._document.bell.ring(Topic.SHAPE, Topic.THINGS)

    def _fit(self) -> tuple[Robot, Wish]:
        """The robot as it is now, and a wish that fits it."""
        robot = self._document.robot
        if robot is self._robot:
            return robot, self._wish
        with self._lock:
            before, self._robot = self._robot, robot
            if before is None or not same_body(before, robot):
                mode = Mode.CABLES if robot.cables else Mode.MUSCLES
                self._wish = Wish(mode=mode, rests=self._wish.rests + 1)
                self._shown, self._hold, self._target = None, None, None
                self._chosen = self._armed = ""
                self._anchored = Anchored(robot.body.mesh)
            else:
                self._wish = _adapted(self._wish, robot)
                self._shown = None if self._shown is None else _fitted(robot, self._shown)
            return robot, self._wish

    def _name_under(self, robot: Robot, wish: Wish, hit: Hit) -> str:
        """The point that the pointer is on: a marker, one that is held, or a new one; "" beside the body."""
        kind, _, name = hit.key.partition(":")
        if kind == "marker" and any(marker.name == name for marker in robot.markers):
            return name
        if kind in ("target", "point") and name in wish.held:
            return name
        if hit.rest is None:
            return ""
        near = NEAR * robot.body.mesh.size
        for own, held in wish.held.items():
            if np.linalg.norm(np.subtract(held.at, hit.rest)) < near:
                return own
        return free_name([*wish.held, *(marker.name for marker in robot.markers)], "point")

    def _point(self, robot: Robot, wish: Wish, name: str, hit: Hit) -> Held:
        """A point by name, held where it is if it is not held yet."""
        if name in wish.held:
            return wish.held[name]
        for marker in robot.markers:
            if marker.name == name:
                return Held(at=marker.at, target=marker.at)
        assert hit.rest is not None
        mesh = robot.body.mesh
        at = tuple(locate(mesh, np.array([hit.rest])).positions(mesh.nodes)[0].tolist())
        return Held(at=at, target=at)

    def _place(self, name: str, point: Held, *, shape: Shape) -> tuple[float, ...]:
        """Where a point of the body is [m]."""
        held = {name: point}
        return tuple(Anchored(self._document.robot.body.mesh).places(held, shape.nodes)[0].tolist())

    def _hold_at(self, name: str, at: Point, target: np.ndarray) -> None:
        """Wish a point somewhere, though not out of sight."""
        with self._lock:
            robot, wish = self._fit()
            nodes, far = robot.body.mesh.nodes, FARTHEST * robot.body.mesh.size
            near = np.clip(target, nodes.min(axis=0) - far, nodes.max(axis=0) + far)
            point = Held(at=at, target=tuple(near.tolist()))
            self._wish = replace(wish, held={**wish.held, name: point})


def _adapted(wish: Wish, robot: Robot) -> Wish:
    """The same wish for a robot whose markers may have moved, and whose cables may be gone."""
    places = {marker.name: marker.at for marker in robot.markers}
    held = {name: replace(point, at=places.get(name, point.at)) for name, point in wish.held.items()}
    return replace(wish, held=held, mode=wish.mode if robot.cables else Mode.MUSCLES)


def _fitted(robot: Robot, shape: Shape) -> Shape:
    """A shape for a robot whose winches and cables may be others."""
    if len(shape.tensions) == len(robot.cables) and len(shape.contractions) == len(robot.winches):
        return shape
    return replace(shape, tensions=np.zeros(len(robot.cables)), contractions=np.zeros(len(robot.winches)))
