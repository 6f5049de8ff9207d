"""`Poser`: the stage "pose"."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from threading import RLock

import numpy as np

from hydrostat.closed_set import parse_choice
from hydrostat.drawing import Color
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.cable_proposals import CableProposals
from hydrostat.studio.posing.movers import Movers, same_body
from hydrostat.studio.posing.pose_state import (
    Anchored,
    HeldPoint,
    Mode,
    PoseState,
    PoseTargets,
    Trail,
    checked_name,
    held_of,
    name_under,
    point_of,
    renamed_markers,
    renamed_pose,
    wishes_after,
    with_network_of,
    with_pose,
    without_pose,
)
from hydrostat.studio.posing.reach import MarkerReach
from hydrostat.studio.stage import Hit, Stage, parse_arrow
from hydrostat.studio.view.contact_items import contact_items
from hydrostat.studio.view.robot_items import (
    MARKER,
    Bar,
    prediction_items,
    proposal_items,
    robot_items,
    target_items,
    winch_bars,
)
from hydrostat.studio.view.scene_items import Dot, Ghost, Look, RobotShape, SceneItem, rest_shape

READY = "preparing the physics…"  # said while the physics of a robot is made


@dataclass(frozen=True, kw_only=True)
class _Hold:
    """Point that the pointer drags."""

    name: str  # of the point
    point: HeldPoint  # of the body
    offset: tuple[float, ...]  # from the pointer to its target [m]


class Poser(Stage):
    """Grab any point of the body and drag it; muscles or the robot's own cables follow (R2, R30, R36).

    Robot, targets and shape are one frozen `PoseState`, replaced whole; `step` reads the newest and replaces the shape.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document = document
        self.reach = MarkerReach(document, jobs)  # all that a marker can reach
        self._lock = RLock()
        self.proposals = CableProposals(document, jobs.slots)  # cables for what the muscles do
        self._movers = Movers(document)
        self._now: PoseState | None = None
        self._done: tuple[Robot, PoseTargets, float] | None = None
        self._rested: dict[Mode, int] = {}
        self._announced = False
        self._hold: _Hold | None = None
        self._trail = Trail(document)
        self._dragged = False
        self._armed = self._chosen = ""
        document.bell.listen(self._on_topic)

    @property
    def mode(self) -> Mode:
        """Actuation of the body: by muscles or by cables."""
        return self._fit().targets.mode

    @property
    def held_points(self) -> Mapping[str, HeldPoint]:
        """Held points with their targets, by name."""
        return self._fit().targets.held

    @property
    def is_armed(self) -> bool:
        """True if the next click or drag moves the chosen point."""
        return bool(self._armed)

    @property
    def chosen_name(self) -> str:
        """Name of the held point or marker that is chosen; "" if none is."""
        return self._chosen

    def shape(self) -> RobotShape:
        """The body as it follows; at rest until the first step."""
        return self._fit().shape

    def scene_items(self) -> Sequence[SceneItem]:
        """Ghosts, the robot, points that are held, and rings where they should be."""
        now = self._fit()
        robot, targets, shape = now.robot, now.targets, now.shape
        limit = self._document.work.wishes.constraints.tension
        keys = {f"marker:{self._chosen}", f"point:{self._chosen}"} if self._chosen else set()
        found: list[SceneItem] = [Ghost(name="rest", nodes=robot.body.mesh.nodes, color=Color.GHOST)]
        if now.ghost is not None:
            found.append(now.ghost)
        cloud = self.reach.cloud(robot)
        if cloud is not None:
            found.append(cloud)
        proposed = None if self.proposals.is_kept(robot) else self.proposals.network(robot)
        if proposed is not None and targets.mode is Mode.MUSCLES:  # own cables pull nothing: show the proposed alone
            found += robot_items(robot.with_network([], []), chosen=keys)
        else:
            options = {"scale": limit, "carried": shape.carried}
            found += robot_items(robot, tensions=shape.tensions, chosen=keys, **options)
        if proposed is not None:
            found += proposal_items(proposed, robot.winches if targets.mode is Mode.CABLES else ())
        markers = {marker.name for marker in robot.markers}
        found += [
            Dot(key=f"point:{name}", at=point.at, look=Look.HANDLE, color=MARKER, chosen=f"point:{name}" in keys)
            for name, point in targets.held.items()
            if name not in markers
        ]
        places = now.anchored.places(targets.held, shape.nodes)
        found += prediction_items(shape)
        found += contact_items(shape, robot.body.mesh.size)
        return found + target_items(
            {name: point.target for name, point in targets.held.items()},
            dict(zip(targets.held, (tuple(place.tolist()) for place in places), strict=True)),
            chosen=f"target:{self._chosen}",
        )

    def grab(self, hit: Hit) -> bool:
        """Take hold of a marker, a target or any point of the body."""
        now = self._fit()
        armed = self._armed
        name = armed or name_under(now, hit)
        if not name:
            return False
        point = point_of(now, name, hit)
        start = hit.world if armed else now.place(name, point)
        if hit.key == f"target:{name}":
            start = point.target
        offset = tuple((np.array(start) - np.array(hit.world)).tolist())
        self._hold, self._armed, self._chosen = _Hold(name=name, point=point, offset=offset), "", name
        self._dragged = False
        return True

    def drag(self, hit: Hit) -> None:
        """Let what is held follow the pointer; the newest place wins."""
        with self._lock:
            self._fit()
            hold = self._hold
            if hold is not None and np.isfinite(hit.world).all():
                if not self._dragged:
                    self._note(f"drag {hold.name}")
                self._dragged = True
                self._hold_at(hold.name, hold.point, np.array(hit.world) + hold.offset)

    def release(self) -> None:
        """Let go: the target stays where it is."""
        self._hold = None

    def click(self, hit: Hit) -> None:
        """Choose what was clicked; after the key g, put what is chosen there."""
        with self._lock:
            now = self._fit()
            if self._armed:
                name, self._armed = self._armed, ""
                self._note(f"move {name}")
                self._hold_at(name, point_of(now, name, hit), np.array(hit.world))
                return
            kind, _, name = hit.key.partition(":")
            self._chosen = now.find_name(name) if kind in ("marker", "target", "point") else ""

    def key(self, name: str) -> bool:
        """Heed r, delete, g (the next click or drag moves the chosen point), arrows (move its target), escape."""
        if name == "r":
            self.rest()
        elif name == "delete" and self._chosen in self.held_points:
            self.clear(self._chosen)
        elif name == "g" and self._chosen:
            self._armed = self._chosen
        elif (arrow := parse_arrow(name)) is not None and self._fit().find_name(self._chosen):
            self._nudge(*arrow)
        elif name == "escape":
            self._chosen = self._armed = ""
        else:
            return False
        return True

    def _nudge(self, step: float, axis: int) -> None:
        """Move the target of the chosen point by a step [m] along an axis."""
        with self._lock:
            self._note(f"nudge {self._chosen}")
            self._now = self._fit().nudge(self._chosen, step, axis)
        self._ring()

    def choose(self, name: str) -> None:
        """Select a held point or marker."""
        self._chosen = self._fit().find_name(name)
        self._document.bell.ring(Topic.SCENE)

    def set_mode(self, mode: Mode | str) -> None:
        """Let muscles or cables move the body; what is held stays held (InputError: no such mode, or no cables)."""
        mode = parse_choice(Mode, mode, what="mode")
        with self._lock:
            now = self._fit()
            if mode is now.targets.mode:
                return
            if mode is Mode.CABLES and not now.robot.cables:
                raise InputError("this robot has no cables yet. Find some in Design, or place them in Edit")
            ghost = None
            if mode is Mode.CABLES and now.targets.held:
                ghost = Ghost(name="target", nodes=now.shape.nodes, color="#8fb4d6")
            self._now = replace(now, targets=replace(now.targets, mode=mode), ghost=ghost)
        self._ring()

    def rest(self) -> None:
        """Back to rest: no targets, no cable taken in."""
        with self._lock:
            now = self._fit()
            if now.targets.held:
                self._note("rest")
            self._now = replace(
                now, targets=PoseTargets(mode=now.targets.mode, rests=now.targets.rests + 1), ghost=None
            )
            self._let_go()
        self._ring()

    def clear(self, name: str) -> None:
        """Let go of a held point."""
        with self._lock:
            now = self._fit()
            self._note(f"release {name}")
            left = {own: held for own, held in now.targets.held.items() if own != name}
            self._now = replace(now, targets=replace(now.targets, held=left))
            self._chosen = self._armed = ""
        self._ring()

    def store(self, name: str) -> None:
        """Keep what is held as a pose of the robot; can be undone (InputError: no name, or nothing is held)."""
        now = self._fit()
        changed = with_pose(now.robot, name, now.targets.held)
        self._document.change(f"store pose {name.strip()}", robot=changed)

    def show_pose(self, name: str) -> None:
        """Hold the targets of a pose; the body moves there (InputError: no such pose)."""
        with self._lock:
            now = self._fit()
            held = held_of(now.robot, name)
            self._note(f"show {name}")
            self._now = replace(now, targets=replace(now.targets, held=held), ghost=None)
            self._let_go()
        self._ring()

    def rename_pose(self, old: str, new: str) -> None:
        """Give a pose another name; can be undone (InputError: no such pose, no name, or one that is taken)."""
        work, new = self._document.work, checked_name(new)
        robot = renamed_pose(work.robot, old, new)
        self._document.change(f"rename pose {old}", robot=robot, wishes=wishes_after(work.wishes, robot, {old: new}))

    def delete_pose(self, name: str) -> None:
        """Remove a pose; can be undone (InputError: no such pose)."""
        work = self._document.work
        robot = without_pose(work.robot, name)
        self._document.change(f"delete pose {name}", robot=robot, wishes=wishes_after(work.wishes, robot))

    def bars(self) -> list[Bar]:
        """Bars of all winches: contraction and tension."""
        now = self._fit()
        return winch_bars(now.robot, now.shape, self._document.work.wishes.constraints.tension)

    def step(self, now: float) -> bool:
        """One update of the mover; the first only says that it may take a while."""
        current = self._fit()
        robot, targets = current.robot, current.targets
        tension = self._document.work.wishes.constraints.tension
        if self._done is not None and all(
            old is new for old, new in zip(self._done, (robot, targets, tension), strict=True)
        ):
            self.proposals.follow(robot, targets, self._movers.muscles, is_settled=True)
            return False
        if not self._movers.ready(robot, targets.mode) and not self._announced:
            self._announced = True
            self._publish(robot, replace(current.shape, notes=(READY,)))
            return True
        self._announced = False
        try:
            mover = self._movers.mover(robot, targets.mode, tension)
        except NotConvergedError as error:
            self._done = (robot, targets, tension)
            self._publish(robot, replace(current.shape, notes=(str(error),)))
            return False
        if self._rested.get(targets.mode) != targets.rests:
            self._rested[targets.mode] = targets.rests
            mover.rest()
        shape, more = mover.update(targets.held)
        self._publish(robot, shape)
        self.proposals.follow(robot, targets, self._movers.muscles, is_settled=not more)
        if not more:
            self._done = (robot, targets, tension)
        return more or self._fit().targets is not targets

    @property
    def undo_label(self) -> str:
        """The last drag, if nothing was done to the robot since; "" if there is none."""
        return self._trail.undo_label

    @property
    def redo_label(self) -> str:
        """The drag that was undone last; "" if there is none."""
        return self._trail.redo_label

    def undo(self) -> None:
        """Hold what was held before the last drag."""
        self._hold_again(self._trail.undo)

    def redo(self) -> None:
        """Hold what was held before that was undone."""
        self._hold_again(self._trail.redo)

    def _hold_again(self, way: Callable[[Mapping[str, HeldPoint]], Mapping[str, HeldPoint]]) -> None:
        """Go to another step of the trail; where nothing was held, back to rest."""
        with self._lock:
            now = self._fit()
            held = way(now.targets.held)
            rests = now.targets.rests + (not held)
            self._now = replace(now, targets=replace(now.targets, held=held, rests=rests), ghost=None)
            self._let_go()
        self._ring()

    def _note(self, label: str) -> None:
        """Note for undo that the held points change now."""
        self._trail.note(label, self._fit().targets.held)

    def _publish(self, robot: Robot, shape: RobotShape) -> None:
        with self._lock:
            now = self._now
            if now is not None and same_body(now.robot, robot):
                self._now = replace(now, shape=with_network_of(now.robot, shape))
        self._document.bell.ring(Topic.SHAPE)

    def _ring(self) -> None:
        self._document.bell.ring(Topic.SHAPE, Topic.SCENE)

    def _fit(self) -> PoseState:
        """Return the state of posing for the robot as it is now, rebuilt if the robot has changed."""
        now = self._now
        if now is not None and now.robot is self._document.robot:
            return now
        with self._lock:
            robot, before = self._document.robot, self._now
            if before is not None and before.robot is robot:
                return before
            if before is None or not same_body(before.robot, robot):
                rests = 0 if before is None else before.targets.rests
                targets = PoseTargets(mode=Mode.CABLES if robot.cables else Mode.MUSCLES, rests=rests + 1)
                anchored = Anchored(robot.body.mesh)
                now = PoseState(robot=robot, targets=targets, anchored=anchored, shape=rest_shape(robot))
                self._let_go()
            else:
                now = before.adapt_to(robot)
                self._rename(before, now)
            self._now = now
            return now

    def _on_topic(self, topic: Topic) -> None:
        """Follow each change of markers, also while another stage is shown."""
        now = self._now
        if topic is Topic.ROBOT and now is not None and same_body(now.robot, self._document.robot):
            self._fit()

    def _let_go(self) -> None:
        """Nothing is chosen, and the pointer holds nothing."""
        self._hold, self._chosen, self._armed = None, "", ""

    def _rename(self, before: PoseState, now: PoseState) -> None:
        """Follow the new names of markers; let go of those that are gone."""
        names, hold = renamed_markers(before.robot, now.robot), self._hold
        self._chosen = now.find_name(names.get(self._chosen, self._chosen))
        self._armed = now.find_name(names.get(self._armed, self._armed))
        if hold is not None:
            name = names.get(hold.name, hold.name)
            gone = hold.point.marker and not now.find_name(name)
            self._hold = None if gone else replace(hold, name=name)

    def _hold_at(self, name: str, point: HeldPoint, target: np.ndarray) -> None:
        """Set the target of a point."""
        self._now = self._fit().with_target(name, point, target.tolist())
