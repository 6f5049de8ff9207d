"""`WinchWay`, `FingertipWay`: from what a person asks for to contractions."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import FASTEST, KnownPulls
from hydrostat.errors import HydrostatError, InputError
from hydrostat.ik import InverseReason, Limits, Tracker
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, SolvedPose
from hydrostat.teleop.source import DriveChannels

if TYPE_CHECKING:
    from hydrostat.learning import LearnedModel

NEAR = 3e-3
"""A guard judges where a pose is known within so much of each contraction [m]."""
REACH = 0.5
"""Targets of a marker lie so far about its rest, as a share of the largest side of the body."""
_LONGEST = 0.1
"""Time since the update before counts as so long at most [s]: nobody catches up in a leap."""


class Way(ABC):
    """Contract of how what a person asks for becomes contractions; what is slow is done in a thread of its own.

    Attributes:
        channels: what may be asked for.
        contractions: the newest that follow from it [m].
        known: what the cables pull in the poses on the way, for a guard.
        news: set as soon as there are newer contractions, if somebody waits for it.
        words: what is to be said of the pose; empty for nothing.
    """

    channels: DriveChannels
    contractions: Vector
    known: KnownPulls
    news: threading.Event | None = None
    words: str = ""

    @abstractmethod
    def ask(self, values: Vector) -> None:
        """Let the channels have values [m]; return at once (HydrostatError: what solves has failed)."""

    @abstractmethod
    def held(self, places: Vector) -> Vector:
        """Forget what was asked for, as motors hold at contractions [m]; give the values of the channels there [m]."""

    @abstractmethod
    def close(self) -> None:
        """End its thread."""


class WinchWay(Way):
    """Winches are what is turned; poses are solved behind it, so that a guard knows what should be felt."""

    def __init__(self, simulation: Simulation, contractions: Vector, *, solves: bool = True) -> None:
        """Begin at contractions [m]; poses need not be solved where there is no guard."""
        robot = simulation.robot
        self.channels, self.contractions = winch_channels(robot), contractions.copy()
        self._simulation, self.known = simulation, KnownPulls(robot, near=NEAR)
        self._pose = _first(simulation, contractions, self.known)
        self._newest = _Newest(self._solve) if solves else None

    def ask(self, values: Vector) -> None:
        """Turn them."""
        self.contractions = values.copy()
        if self._newest is not None:
            self._newest.give(self.contractions)

    def held(self, places: Vector) -> Vector:
        """Contractions where they hold [m]."""
        self.contractions = places.copy()
        return places.copy()

    def close(self) -> None:
        """End its thread."""
        if self._newest is not None:
            self._newest.close()

    def _solve(self, contractions: Vector) -> bool:
        found = self._simulation.solve(contractions, start=self._pose, strict=False)
        if found.result.converged:
            self._pose = found
            self.known.add(found)
        return False


class FingertipWay(Way):
    """Markers are what is moved: `Tracker` finds contractions, step by step, each of them a pose in equilibrium.

    With a learned model its networks answer at once. What the simulator finds better from there, step by step, is added
    to its answers from then on.
    """

    def __init__(
        self,
        simulation: Simulation,
        contractions: Vector,
        *,
        model: "LearnedModel | None" = None,
        rate: float = FASTEST,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin at contractions [m]; cables get no faster than a rate [m/s] (InputError: there are no markers)."""
        self._simulation, self._model, self._clock = simulation, model, clock
        self.channels, self.contractions = marker_channels(simulation), contractions.copy()
        self.known = KnownPulls(simulation.robot, near=NEAR)
        self._names, self._dim = tuple(simulation.rest.markers), simulation.robot.body.mesh.dim
        start = _first(simulation, contractions, self.known)
        self._limits = Limits(rate=rate) if model is None else Limits()
        self._tracker, self._updated = Tracker(simulation, limits=self._limits, start=start), clock()
        self._more = np.zeros(len(contractions))
        self._asked: Vector | None = None
        self._lock = threading.Lock()
        self._newest = _Newest(self._step)

    def ask(self, values: Vector) -> None:
        """Move them."""
        if self._asked is not None and np.array_equal(values, self._asked):
            self._newest.check()
            return
        self._asked = values.copy()
        answer = None
        if self._model is not None:
            answer = self._model.solve(self._targets(values)).contractions
            self.contractions = answer + self._more
        self._newest.give((self._asked, answer))

    def held(self, places: Vector) -> Vector:
        """Where the markers are, by simulation, when they hold [m]."""
        with self._lock:
            self.contractions, self._asked = places.copy(), None
        self._newest.forget()
        markers = self._tracker.pose.markers
        return np.concatenate([np.asarray(markers[name]) for name in self._names])

    def close(self) -> None:
        """End its thread."""
        self._newest.close()

    def _targets(self, values: Vector) -> dict[str, tuple[float, ...]]:
        rows = values.reshape(-1, self._dim).tolist()
        return {name: tuple(row) for name, row in zip(self._names, rows, strict=True)}

    def _step(self, job: tuple[Vector, Vector | None]) -> bool:
        """One step nearer; tell whether there is more to do."""
        values, answer = job
        now = self._clock()
        passed, self._updated = min(max(now - self._updated, 1e-3), _LONGEST), now
        if answer is not None:
            start = self._simulation.solve(answer + self._more, start=self._tracker.pose, strict=False)
            if start.result.converged:
                self._tracker = Tracker(self._simulation, start=start)
        reached = self._tracker.update(self._targets(values), seconds=passed)
        self.known.add(reached.pose)
        with self._lock:
            if self._asked is values:  # nobody has asked for something else, or held, meanwhile
                self.contractions = reached.pose.contractions
            if answer is not None:
                self._more = reached.pose.contractions - answer
        self.words = f"{1e3 * max(reached.errors.values()):.1f} mm from its targets"
        if self.news is not None:
            self.news.set()
        return reached.reason is InverseReason.ITERATION_LIMIT


class _Newest:
    """A thread that works on the newest job alone, as often as there is more to do."""

    def __init__(self, work: Callable) -> None:
        self._work, self._job, self._error = work, None, ""
        self._over, self._some = False, threading.Condition()
        self._thread = threading.Thread(target=self._run, name="poses on the way", daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raise what went wrong."""
        if self._error:
            raise HydrostatError(self._error)

    def give(self, job: object) -> None:
        """Work on this, and on no older one."""
        self.check()
        with self._some:
            self._job = job
            self._some.notify()

    def forget(self) -> None:
        """Let what waits be."""
        with self._some:
            self._job = None

    def close(self) -> None:
        """End after what is being done."""
        with self._some:
            self._over = True
            self._some.notify()
        self._thread.join(5.0)

    def _run(self) -> None:
        job, more = None, False
        while not self._over:
            with self._some:
                while self._job is None and not more and not self._over:
                    self._some.wait()
                if self._job is not None:
                    job, self._job = self._job, None
            if self._over:
                return
            try:
                more = self._work(job)
            except Exception as error:  # noqa: BLE001 (whoever asks next is told)
                self._error, more = f"no pose is found any more: {error}", False


def winch_channels(robot: Robot) -> DriveChannels:
    """The winches of a robot as channels, each a group of its own (InputError: it has none)."""
    if not robot.winches:
        raise InputError(f"{robot.name} has no winches; add some, or let `hydrostat design` find them")
    low, high = ([-winch.release for winch in robot.winches], [winch.travel for winch in robot.winches])
    return DriveChannels(
        names=tuple(winch.name for winch in robot.winches),
        low=np.array(low, dtype=float),
        high=np.array(high, dtype=float),
        rest=np.zeros(len(robot.winches)),
        groups=tuple((index,) for index in range(len(robot.winches))),
    )


def marker_channels(simulation: Simulation) -> DriveChannels:
    """The coordinates of all markers as channels, a group for each marker (InputError: there are none)."""
    markers, dim = simulation.rest.markers, simulation.robot.body.mesh.dim
    if not markers:
        raise InputError(f"{simulation.robot.name} has no markers to move; add [[marker]] to its robot.toml")
    rest = np.concatenate([np.asarray(place, dtype=float) for place in markers.values()])
    reach = REACH * simulation.robot.body.mesh.size
    return DriveChannels(
        names=tuple(f"{name} {axis}" for name in markers for axis in "xyz"[:dim]),
        low=rest - reach,
        high=rest + reach,
        rest=rest,
        groups=tuple(tuple(range(dim * index, dim * index + dim)) for index in range(len(markers))),
    )


def _first(simulation: Simulation, contractions: Vector, known: KnownPulls) -> SolvedPose:
    """The pose at first, which is known then."""
    pose = simulation.solve(contractions, strict=False)
    pose = pose if pose.result.converged else simulation.rest
    known.add(pose)
    return pose
