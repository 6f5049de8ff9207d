"""`MarkerReach`: all that a marker can reach, as a cloud that grows while it is found."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import HydrostatError, InputError
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.sobol import draw_sobol
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs, Report
from hydrostat.studio.posing.movers import same_physics
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.view.scene_items import Cloud
from hydrostat.units import quote

COUNT = 400  # so many poses are tried


def sweep(report: Report, robot: Robot, marker: str, tension: float, count: int = COUNT) -> int:
    """Sample `count` poses with contractions spread evenly over the ranges of all winches; return the number held.

    The report is told where the marker is, a few places (points, dim) [m] at a time. Poses that do not converge, are
    not stable or ask a cable for more than its limit [N] are left out. Where cables rub, each is come to from rest.
    """
    simulation = Simulation(robot)
    last, held, places = simulation.rest, 0, []
    rubs = simulation.assembly.has_history  # the way counts there
    portion = 8  # so many are told at once
    for index, contractions in enumerate(spread_contractions(robot, count)):
        report.progress("sampling poses", index, count)
        try:
            pose = simulation.solve(contractions, start=None if rubs else last, strict=False)
        except HydrostatError:
            continue
        if pose.result.converged and pose.result.stable and pose.tensions.max(initial=0.0) <= tension:
            last = pose
            held += 1
            places.append(pose.markers[marker])
        if len(places) == portion:
            report.part(np.array(places))
            places = []
    if places:
        report.part(np.array(places))
    return held


def spread_contractions(robot: Robot, count: int) -> list[Vector]:
    """Return contractions of all winches [m] by Sobol's sequence, ordered so that successive solves are short."""
    low = np.array([-winch.release for winch in robot.winches])
    high = np.array([winch.travel for winch in robot.winches])
    seed = 8
    drawn = draw_sobol(len(robot.winches), count, np.random.default_rng(seed))
    left = list(range(count))
    order, here = [], np.clip(-low / (high - low), 0.0, 1.0)
    while left:
        near = left[int(np.argmin(((drawn[left] - here) ** 2).sum(axis=1)))]
        left.remove(near)
        order.append(near)
        here = drawn[near]
    return [low + share * (high - low) for share in drawn[order]]


COLOR = "#1787b8"


@dataclass(eq=False)
class _ReachSearch:
    """One search, of one marker of one robot, with what it has found so far."""

    robot: Robot
    marker: str
    tension: float
    running: bool = True
    cloud: Cloud | None = None

    def fits(self, robot: Robot, tension: float) -> bool:
        """Return True if it would find the same with this robot and this limit."""
        same = tension == self.tension and _place(robot, self.marker) == _place(self.robot, self.marker)
        return same and same_physics(self.robot, robot, Mode.CABLES)


class MarkerReach:
    """The cloud of one marker at a time; it is forgotten when the robot moves in another way."""

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs
        self._search: _ReachSearch | None = None
        document.bell.listen(self._on_topic)

    @property
    def marker(self) -> str:
        """Marker whose cloud it is; "" for none."""
        return "" if self._search is None else self._search.marker

    @property
    def running(self) -> bool:
        """True if the cloud is still growing."""
        return self._search is not None and self._search.running

    def cloud(self, robot: Robot) -> Cloud | None:
        """Return the workspace found so far, if it holds for this robot."""
        search = self._search
        fits = search is not None and search.fits(robot, self._document.work.wishes.constraints.tension)
        return search.cloud if search is not None and fits else None

    @property
    def count(self) -> int:
        """Number of places that have been found."""
        cloud = None if self._search is None else self._search.cloud
        return 0 if cloud is None else len(cloud.points)

    def start(self, marker: str, count: int = COUNT) -> None:
        """Begin to look where a marker can go (InputError: no such marker, no cables, or other work is in progress)."""
        robot, tension = self._document.robot, self._document.work.wishes.constraints.tension
        if _place(robot, marker) is None:
            raise InputError(f"unknown marker {quote(marker)}")
        if not robot.cables:
            raise InputError("this robot has no cables yet. Find some in Design, or place them in Edit")
        before, search = self._search, _ReachSearch(robot, marker, tension)
        self._search = search  # work may tell something, or be over, before it is said to have begun
        try:
            self._jobs.start(
                f"Workspace of {marker}",
                sweep,
                robot,
                marker,
                tension,
                count,
                on_part=lambda points: self._grow(search, points),
                on_end=lambda *_: self._end(search),
            )
        except InputError:
            self._search = before
            raise
        self._document.bell.ring(Topic.SCENE)

    def stop(self) -> None:
        """End with what has been found."""
        if self.running:
            self._jobs.stop()

    def clear(self) -> None:
        """Show no cloud."""
        self.stop()
        self._search = None
        self._document.bell.ring(Topic.SCENE)

    def _on_topic(self, topic: Topic) -> None:
        search = self._search
        if topic is not Topic.ROBOT or search is None or not self._document.is_open:
            return
        work = self._document.work
        if not search.fits(work.robot, work.wishes.constraints.tension):
            self.clear()

    def _grow(self, search: _ReachSearch, points: Points) -> None:
        known = points if search.cloud is None else np.concatenate([search.cloud.points, points])
        search.cloud = Cloud(name="reach", points=known, color=COLOR)
        if search is self._search:
            self._document.bell.ring(Topic.SCENE)

    def _end(self, search: _ReachSearch) -> None:
        search.running = False
        self._document.bell.ring(Topic.SCENE)


def _place(robot: Robot, marker: str) -> Point | None:
    """Position of a marker in the rest shape [m]; None if there is none of this name."""
    return next((own.at for own in robot.markers if own.name == marker), None)
