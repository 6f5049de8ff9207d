"""`PoseProcess`: poses solved by a process of its own, so that whoever tells the motors never waits for it."""

import multiprocessing as mp
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import winch_tensions
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKStatus, Limits, LinearizedPose, Tracker
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation

MAX_STEP = 0.1
"""Time since the update before counts as so long at most [s]: nobody catches up in a leap. An outlook looks as far."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseOnWay:
    """A pose that was solved.

    Attributes:
        job: number of the job that it is of.
        contractions: contractions of the pose [m].
        pulls: total cable tension of each winch [N].
        markers: their coordinates, one after the other [m].
        error: largest distance of a marker from its target [m].
        outlook: first-order answer of the contractions, where markers have targets.
        done: True if its job is finished.
    """

    job: int
    contractions: Vector
    pulls: Vector
    markers: Vector
    error: float = 0.0
    outlook: LinearizedPose | None = None
    done: bool = True


class WinchPoses:
    """Poses at contractions, each begun at the one before."""

    def __init__(self, robot: Robot) -> None:
        """The poses of a robot."""
        self._simulation = Simulation(robot)
        self._pose: Equilibrium | None = None

    def __call__(self, contractions: Vector) -> tuple[PoseOnWay | None, bool]:
        """The pose at contractions [m], if there is one; there is never more to do."""
        pose = self._simulation.solve(contractions, start=self._pose, strict=False)
        if not pose.result.converged:
            return None, False
        self._pose = pose
        return _find_pose(0, self._simulation.robot, pose), False


class FingertipPoses:
    """Steps towards targets that move, by `Tracker`."""

    def __init__(self, robot: Robot, contractions: Vector, rate: float | None) -> None:
        """Begin at contractions [m]; cables get no faster than a rate [m/s], if there is one."""
        self._simulation, self._limits = Simulation(robot), Limits(rate=rate)
        pose = self._simulation.solve(contractions, strict=False)
        self._tracker = Tracker(self._simulation, limits=self._limits, start=pose if pose.result.converged else None)
        self._done, self._updated = -1, time.monotonic()

    def __call__(self, job: tuple[int, dict[str, tuple[float, ...]], Vector | None]) -> tuple[PoseOnWay | None, bool]:
        """One step nearer to targets, and whether there is more to do; contractions [m] say where to begin a job."""
        number, targets, begin = job
        if not targets:
            return None, False
        now = time.monotonic()
        passed, self._updated = min(max(now - self._updated, 1e-3), MAX_STEP), now
        if begin is not None and number != self._done:
            start = self._simulation.solve(begin, start=self._tracker.pose, strict=False)
            if start.result.converged:
                self._tracker = Tracker(self._simulation, limits=self._limits, start=start)
        self._done = number
        reached = self._tracker.update(targets, seconds=passed)
        more = reached.status is IKStatus.ITERATION_LIMIT
        told = {
            "error": max(reached.errors.values()),
            "outlook": self._tracker.linearize(seconds=MAX_STEP),
            "done": not more,
        }
        return replace(_find_pose(number, self._simulation.robot, reached.pose), **told), more


class PoseProcess:
    """A process that works on the newest job alone, as often as there is more to do; a thread hears what it finds."""

    def __init__(self, make: Callable, arguments: tuple, hear: Callable[[PoseOnWay], None]) -> None:
        """Begin, and wait until it is ready; what is made of the arguments there answers jobs.

        Raises:
            HydrostatError: nothing can be made of them there.
        """
        context = mp.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, make, arguments), daemon=True)
        self._process.start()
        theirs.close()
        self._hear, self._error, self._over = hear, "", False
        self._newest, self._given = deque[Any](maxlen=1), threading.Event()
        try:
            wrong = self._pipe.recv()
        except EOFError:
            wrong = 'its process has ended; a script that drives begins with if __name__ == "__main__":'
        if wrong:
            raise HydrostatError(f"no pose can be found: {wrong}")
        targets = self._listen, self._tell
        self._threads = [threading.Thread(target=each, name="poses on the way", daemon=True) for each in targets]
        for thread in self._threads:
            thread.start()

    def check(self) -> None:
        """Raise what went wrong there."""
        if self._error:
            raise HydrostatError(f"no pose is found any more: {self._error}")

    def give(self, job: Any) -> None:
        """Work on this, and on no older one; it waits for nothing, however long a pose takes there."""
        self.check()
        if not self._over:
            self._newest.append(job)
            self._given.set()

    def close(self) -> None:
        """End it. It may be called twice."""
        if not self._over:
            self._over = True
            self._newest.append(None)
            self._given.set()
            self._process.join(2.0)
            self._process.kill()
            for thread in self._threads:
                thread.join(2.0)
            self._pipe.close()

    def _tell(self) -> None:
        """Send the newest job: this may wait until a pose is done there."""
        with suppress(OSError):  # told by who listens
            while True:
                self._given.wait()
                self._given.clear()
                while self._newest:
                    self._pipe.send(job := self._newest.popleft())
                    if job is None:
                        return

    def _listen(self) -> None:
        try:
            while True:
                if isinstance(found := self._pipe.recv(), str):
                    self._error = found
                else:
                    self._hear(found)
        except (EOFError, OSError):
            self._error = self._error or ("" if self._over else "its process has ended")
        except Exception as error:
            self._error = str(error)
            raise


def _serve(pipe: Connection, make: Callable, arguments: tuple) -> None:
    """Answer the newest job, until there is nobody to ask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is heard by whoever asks
    yields = 5  # So much nicer than whoever tells the motors is who solves poses, where cores are few (Unix)
    with suppress(AttributeError, OSError):
        os.nice(yields)
    job, more = None, False
    with suppress(EOFError, OSError):
        try:
            answer = make(*arguments)
            pipe.send("")
            while True:
                if not more or pipe.poll():
                    job = pipe.recv()
                    while pipe.poll():
                        job = pipe.recv()
                    if job is None:
                        return
                found, more = answer(job)
                if found is not None:
                    pipe.send(found)
        except (EOFError, OSError):
            return
        except Exception as error:  # noqa: BLE001 (whoever asks is told)
            pipe.send(str(error) or type(error).__name__)


def _find_pose(job: int, robot: Robot, pose: Equilibrium) -> PoseOnWay:
    return PoseOnWay(
        job=job,
        contractions=pose.contractions,
        pulls=winch_tensions(robot, pose.tensions),
        markers=np.concatenate([np.zeros(0), *(np.asarray(place) for place in pose.markers.values())]),
    )
