"""`Designer`: the stage "design"."""

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from hydrostat.design import DesignRequest, RouteOptions, TreeSettings
from hydrostat.drawing import Color
from hydrostat.errors import InputError
from hydrostat.project import Paint, Wishes
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.designing.cards_file import cards_content, read_cards
from hydrostat.studio.designing.design_work import (
    BestSoFar,
    Candidate,
    DesignsFound,
    PoseResult,
    design_work,
    make_candidate,
    network_words,
)
from hydrostat.studio.designing.painter import Painter
from hydrostat.studio.designing.run import (
    DesignRun,
    ProgressPoint,
    error_at_rest,
    starting_robot,
    wished_request,
)
from hydrostat.studio.designing.sketch import BodySketch, Ease
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.stage import Hit, Stage, format_error
from hydrostat.studio.view.robot_items import diagnostic_items, robot_items, target_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape
from hydrostat.units import plural

TITLE = "Designing cables"
TURN = 60.0  # for which a design may keep other rooms of a class waiting [s]

MODULE = "hydrostat.studio.designing.design_work"

LIVE = frozenset({"method", "winches", "cables", *TreeSettings.ranges()})
"""Wishes that act immediately where the thesis's search is chosen."""


class Designer(Stage):
    """Wishes, zones painted on the body, a design that goes on, and the networks to choose from.

    Nothing of the robot changes before a candidate is accepted.
    """

    def __init__(self, document: Document, jobs: Jobs, *, options: RouteOptions | None = None) -> None:
        """The stage of a document; designs run as jobs, with options of the search for tests that have no time."""
        self._document, self._jobs, self._options = document, jobs, options
        self.painter = Painter(document)  # of zones
        self.run: DesignRun | None = None  # the design that goes on, or the last one; None before the first
        self.chosen: int | None = None  # number of the candidate shown; None: the robot, or the best network so far
        self.pose: str | None = None  # name of the pose in which the candidate is shown; None: at rest
        self.outcome = ""  # what became of the last design, a line; "" while there is nothing to tell
        self.has_failed = False  # whether it ended without a network
        self._all: tuple[Candidate, ...] = ()
        self._numbered = 0
        self.running = False  # whether a design goes on
        self._live: int | None = None  # number of the network of the last live design
        self._is_asked_again = False  # whether a live design follows the one that runs
        self._is_taken = False  # whether the best network is accepted when the design ends
        self._ease: Ease | None = None
        self._sketch: BodySketch | None = None
        self._kept = b""
        document.bell.listen(self._on_topic)

    @property
    def seconds(self) -> float:
        """Since the last design was asked for [s]."""
        return 0.0 if self.run is None else time.monotonic() - self.run.began

    @property
    def wishes(self) -> Wishes:
        """Design settings of the work."""
        return self._document.work.wishes

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All networks that were found for the body as it is now, the latest design first, its best first."""
        if not self._document.is_open:
            return ()
        body = self._document.robot.body
        return tuple(one for one in self._all if one.source.body is body or one.source.body == body)

    def sketch(self, candidate: Candidate) -> str:
        """A small picture of a candidate, as SVG."""
        body = candidate.source.body
        if self._sketch is None or self._sketch.body is not body:
            self._sketch = BodySketch(body)
        return self._sketch.network(candidate.robot)

    @property
    def trail(self) -> tuple[ProgressPoint, ...]:
        """Networks on the way of the last design, if it was for this body."""
        run = self.run
        return run.trail if run is not None and run.robot.body == self._document.robot.body else ()

    @property
    def candidate(self) -> Candidate | None:
        """The one that is shown."""
        return next((one for one in self.candidates if one.number == self.chosen), None)

    def wish(self, **wishes: Any) -> None:
        """Change what is asked for; one step to undo (InputError: a number out of its range)."""
        wanted = self.wishes.with_values(**wishes)
        if wanted == self.wishes:
            return
        self._document.change("change design settings", wishes=wanted, merge=f"wish {' '.join(wishes)}")
        if wanted.method.grows_trees and not LIVE.isdisjoint(wishes) and self._document.robot.poses:
            self._design_live()

    def wish_pose(self, name: str, wanted: bool) -> None:
        """Include a pose in the design or leave it out (InputError: it would be the last one)."""
        names = {pose.name for pose in self.wishes.to_poses(self._document.robot)}
        kept = names | {name} if wanted else names - {name}
        if not kept:
            raise InputError("a design needs at least one pose. Select another pose before you leave this one out")
        every = tuple(self._document.robot.poses)
        self.wish(poses=() if kept == set(every) else tuple(other for other in every if other in kept))

    def take(self, paint: Paint | None) -> None:
        """Take a paint in hand, or put it away; the body is shown at rest to be painted on."""
        self.painter.take(paint)
        self._document.bell.ring(Topic.SCENE, Topic.SHAPE)

    def choose_zone(self, index: int) -> None:
        """Select a zone; the body is shown at rest."""
        self.painter.take(None)
        self.painter.chosen, self.pose = index, None
        self._document.bell.ring(Topic.JOB, Topic.SCENE, Topic.SHAPE)

    def show(self, number: int | None, pose: str | None = None) -> None:
        """Show a candidate, in a pose or at rest; None: the robot as it is."""
        self.painter.take(None)
        self.chosen, self.pose = number, pose
        self._document.bell.ring(Topic.JOB, Topic.SCENE, Topic.SHAPE)

    def design(self, *, is_live: bool = False) -> None:
        """Begin a design in a process of its own (InputError: no pose, wishes that do not fit, or other work).

        The network of one that is live takes the place of that of the live one before.
        """
        robot = self._document.robot
        request = wished_request(robot, self.wishes, self._options)
        before = self.run, self.running, self.outcome
        self.run = DesignRun(
            robot=robot,
            request=request,
            began=time.monotonic(),
            rest=error_at_rest(robot, request.poses),
            best=starting_robot(robot, request),
            is_live=is_live,
        )
        self.running, self.has_failed, self.outcome, self._is_taken = True, False, "", False
        ended = partial(self._on_end, request)
        calls: dict[str, Any] = {"on_part": self._on_better, "on_done": self._on_found, "on_end": ended, "turn": TURN}
        try:
            self._jobs.start(TITLE, design_work, robot, request, **calls)
        except InputError:
            self.run, self.running, self.outcome = before
            raise
        self.show(None)

    def _design_live(self) -> None:
        """Design at once for a knob of the thesis's search, which takes a second; another one that runs is ended."""
        if not self.running:
            self._begin_live()
        elif self.run is not None and self.run.is_live and not self._is_asked_again:
            self._is_asked_again = True
            self._jobs.stop()

    def _begin_live(self) -> None:
        try:
            self.design(is_live=True)
        except InputError as error:
            self.outcome, self.has_failed, self.running = str(error), True, False
            self._document.bell.ring(Topic.JOB)

    def stop(self) -> None:
        """End the design with the best network so far; asked again, with none."""
        if self.running:
            self._jobs.stop()

    def take_best(self) -> None:
        """End the design, and put its best network so far into the robot as soon as it is judged."""
        if self.running:
            self._is_taken = True
            self._jobs.stop()

    def accept(self) -> None:
        """Put the chosen network into the robot, one step to undo (InputError: none is, or it is of another body)."""
        candidate = self.candidate
        if candidate is None:
            raise InputError("no network selected for this body. Select one of its networks, then accept it")
        drawn = self._document.robot.with_network(candidate.robot.winches, candidate.robot.cables)
        robot = replace(drawn, face=candidate.robot.face)
        wishes = self._document.work.after_design(robot)
        self._document.change(f"accept design, {candidate.counts}", robot=robot, wishes=wishes)

    def clear(self) -> None:
        """Forget all candidates."""
        self._all, self.outcome = (), ""
        self._keep()
        self.show(None)

    def enter(self) -> None:
        """A process is made ready, so that the first network appears soon."""
        self._jobs.warm(MODULE)

    def leave(self) -> None:
        """Put down the paint and clear the choice of candidate and pose; a running design continues."""
        self.painter.take(None)
        self.chosen = self.pose = None

    def shape(self) -> RobotShape:
        """The body at rest, or as the chosen candidate brings it into the chosen pose, or on the way there."""
        robot, ease = self._document.robot, self._ease
        if ease is None or len(ease.nodes) != len(robot.body.mesh.nodes):
            return rest_shape(robot)
        reach = self._reach()
        pulled = np.zeros(len(self.shown_robot.winches)) if reach is None else reach.contractions
        errors = {} if reach is None else reach.errors
        return RobotShape(nodes=ease.nodes, tensions=ease.tensions, contractions=pulled, errors=errors)

    def scene_items(self) -> Sequence[SceneItem]:
        """The network that is shown, targets, zones."""
        shown, ease, reach = self.shown_robot, self._ease, self._reach()
        fits = ease is not None and len(ease.tensions) == len(shown.cables)
        items = robot_items(
            shown, tensions=ease.tensions if ease and fits else None, scale=self.wishes.constraints.tension
        )
        there = reach is not None and ease is not None and not ease.moving
        for targets, color in self._targets():
            items += target_items(targets, reach.places if reach is not None and there else {}, color=color)
        judge = self._document.judge
        flags = diagnostic_items(shown, judge.of(shown, self.wishes) or (), judge.chosen)
        return [*items, *flags, *self.painter.scene_items()]

    def step(self, now: float) -> bool:
        """The body glides to the shape that is to be shown; what rests is judged, then one card after another."""
        judge = self._document.judge
        judge.look(self.shown_robot, self.wishes, now, held=self.running)
        if not self.running and judge.of(self.shown_robot, self.wishes) is not None:
            judge.review_kits(candidate.robot for candidate in self.candidates)
        reach = self._reach()
        nodes = self._document.robot.body.mesh.nodes if reach is None else reach.nodes
        tensions = np.zeros(len(self.shown_robot.cables)) if reach is None else reach.tensions
        if self._ease is None or self._ease.nodes.shape != nodes.shape:
            self._ease = Ease(nodes, tensions)
        self._ease.go(nodes, tensions)
        return self._ease.step(now)

    def grab(self, hit: Hit) -> bool:
        """Begin to paint, or take hold of a zone."""
        held = self.painter.grab(hit)
        if held:
            self.pose = None
        return held

    def drag(self, hit: Hit) -> None:
        """Paint on."""
        self.painter.drag(hit)

    def release(self) -> None:
        """Keep what was painted."""
        self.painter.release()

    def click(self, hit: Hit) -> None:
        """Choose a zone, or set a corner."""
        self.painter.click(hit)

    def key(self, name: str) -> bool:
        """Delete, Enter and Escape for zones; R: the candidate at rest."""
        if name == "r":
            self.show(self.chosen, None)
            return True
        return self.painter.key(name)

    @property
    def shown_robot(self) -> Robot:
        """Robot with the network that is shown."""
        candidate, run, robot = self.candidate, self.run, self._document.robot
        if candidate is not None:
            return candidate.robot
        if self.running and run is not None and run.best.body == robot.body:
            return run.best
        return robot

    def _keep(self) -> None:
        """Leave the networks of this body with the document, which keeps them for a crash."""
        self._kept = self._document.designs = cards_content(self.candidates)

    def _on_topic(self, topic: Topic) -> None:
        """Take over networks that a studio had found which crashed."""
        content = self._document.designs
        if topic is not Topic.ROBOT or content is self._kept or not content:
            return
        self._kept = content
        try:
            found = read_cards(content, self._document.robot)
        except InputError as error:
            self.outcome = str(error)
            return
        self._all, self._numbered = tuple(found), max(len(found), self._numbered)
        for candidate in found:
            self._document.judge.learn(candidate.robot, demand=candidate.demand, torque=candidate.torque)
        self.outcome = f"{plural(len(found), 'network')} restored from an earlier session" if found else ""

    def _reach(self) -> PoseResult | None:
        """Result of the chosen candidate in the chosen pose; None: the body is shown at rest."""
        candidate = self.candidate
        if candidate is None or self.pose is None or self.painter.busy:
            return None
        return candidate.reach(self.pose)

    def _targets(self) -> list[tuple[Any, str]]:
        """Targets of the pose that is shown; of all that are to be reached where none is, each in its own color."""
        reach, robot = self._reach(), self._document.robot
        if reach is not None:
            return [(reach.pose.targets, Color.INK)]
        if self.painter.busy or not robot.poses:
            return []
        poses, colors = self.wishes.to_poses(robot), Color.of_poses(robot.poses)
        most_rings = 12  # more targets than these at once say nothing
        if sum(len(pose.targets) for pose in poses) > most_rings:
            return []
        return [(pose.targets, colors[pose.name] if len(poses) > 1 else Color.INK) for pose in poses]

    def _on_better(self, glimpse: BestSoFar) -> None:
        """A better network was found; called in a thread of the jobs."""
        run = self.run
        if run is None:
            return
        self.run = run.with_better(glimpse)
        self._document.bell.ring(Topic.JOB, Topic.SCENE, Topic.SHAPE)

    def _on_found(self, found: DesignsFound) -> None:
        """The design has ended; called in a thread of the jobs."""
        run = self.run
        if run is None:
            return
        source, made = run.robot, []
        for solution in found.solutions:
            self._numbered += 1
            made.append(make_candidate(solution, source, number=self._numbered, complete=found.complete))
            self._document.judge.learn(made[-1].robot, demand=solution.demand, torque=solution.torque)
        self._shelve(made, is_live=run.is_live)
        best = made[0]
        seconds = time.monotonic() - run.began
        early = "" if found.complete else f"{self._ending()} early, best so far: "
        self.outcome = (
            f"{early}{network_words(best.robot)}, expected as-built error {format_error(best.expected_error)} "
            f"({plural(found.num_evaluated, 'candidate')}, {seconds:.0f} s)"
        )
        self.chosen, self.pose = best.number, best.reaches[0].pose.name
        if self._is_taken and self.candidate is not None:
            self.accept()

    def _shelve(self, made: Sequence[Candidate], *, is_live: bool) -> None:
        """Put networks before the others; that of the last live design goes where a live one ends."""
        most = 60  # so many candidates are kept; the oldest go
        others = tuple(one for one in self._all if not is_live or one.number != self._live)
        if is_live:
            self._live = made[0].number if made else None
        self._all = (*made, *others)[:most]
        self._keep()

    def _ending(self) -> str:
        """Words on why the design has ended."""
        state = self._jobs.state
        return "ended for other rooms" if state is not None and state.yielded else "stopped"

    def _on_end(self, request: DesignRequest, error: str) -> None:
        """Called in a thread of the jobs, whatever came of it."""
        if self.run is None or self.run.request is not request:
            return  # the next design has begun
        self.has_failed = bool(error)
        if error:
            self.outcome = f"{self._ending()} before a network was found" if error == "stopped" else error
            if self.run.is_live:
                self._shelve((), is_live=True)
        if self._is_asked_again:
            self._is_asked_again = False
            self._begin_live()
            return
        self.running = False
        self._jobs.warm(MODULE)
        self._document.bell.ring(Topic.JOB, Topic.SCENE, Topic.SHAPE)
