"""`WinchMapper`, `MarkerMapper`: from what a person asks for to contractions."""

import threading
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import DEFAULT_MAX_SPEED, TensionLookup
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.teleop.pose_process import FingertipPoses, PoseOnWay, PoseProcess, WinchPoses
from hydrostat.teleop.source import DriveChannels

if TYPE_CHECKING:
    from hydrostat.learning import LearnedModel

CONTRACTION_TOLERANCE = 3e-3
"""Largest distance to a known pose at which a guard checks tensions, in each contraction [m]."""
REACH = 0.5
"""Largest distance of a marker target from its rest position, as a share of the longest side of the body."""


class CommandMapper(ABC):
    """Interface for mapping commands of a person to contractions; slow computations run in a separate process.

    Attributes:
        channels: channels that the person can move.
        contractions: latest contractions for these commands [m].
        known: cable tensions of the poses solved so far, for a guard.
        updated: event that is set when contractions change; None if unused.
        words: message about the pose; empty for none.
    """

    channels: DriveChannels
    contractions: Vector
    known: TensionLookup
    updated: threading.Event | None = None
    words: str = ""

    @abstractmethod
    def ask(self, values: Vector) -> None:
        """Request channel values [m]; return immediately (HydrostatError: the solver has failed)."""

    def observe(self, places: Vector) -> None:
        """Report the contractions of the motors [m], at which a guard needs tensions."""
        del places

    @abstractmethod
    def hold_at(self, places: Vector) -> Vector:
        """Discard the request because motors hold at contractions [m]; return the channel values there [m]."""

    @abstractmethod
    def close(self) -> None:
        """End background work."""


class WinchMapper(CommandMapper):
    """Map commands to winches directly; poses are solved in the background, so that a guard has expected tensions."""

    def __init__(self, simulation: Simulation, contractions: Vector, *, solves: bool = True) -> None:
        """Begin at contractions [m]; poses need not be solved where there is no guard."""
        robot = simulation.robot
        self.channels, self.contractions = WinchMapper.list_channels(robot), contractions.copy()
        self.known = TensionLookup(robot, near=CONTRACTION_TOLERANCE)
        self.known.add(simulation.solve(contractions, strict=False))
        self._seen = contractions.copy()
        self._poses = PoseProcess(WinchPoses, (robot,), self._accept_pose) if solves else None

    def ask(self, values: Vector) -> None:
        """Request contractions of the winches [m]."""
        self.contractions = values.copy()
        if self._poses is not None:
            self._poses.check()

    def observe(self, places: Vector) -> None:
        """Request the pose at these contractions [m]."""
        apart = 2e-4  # Poses are solved so far apart [m]
        if self._poses is not None and np.abs(places - self._seen).max(initial=0.0) > apart:
            self._seen = places.copy()
            self._poses.give(self._seen)

    def hold_at(self, places: Vector) -> Vector:
        """Hold at contractions [m]; return them."""
        self.contractions = places.copy()
        return places.copy()

    def close(self) -> None:
        """End the background process."""
        if self._poses is not None:
            self._poses.close()

    def _accept_pose(self, found: PoseOnWay) -> None:
        self.known.store(found.contractions, found.pulls)

    @staticmethod
    def list_channels(robot: Robot) -> DriveChannels:
        """Return the winches of a robot as channels, each a group of its own (InputError: no winches)."""
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


class MarkerMapper(CommandMapper):
    """Map marker targets to contractions: `Tracker` solves them step by step, each step a pose in equilibrium.

    Targets do not wait for the current step. They are first answered to first order about the latest pose, within the
    limits, and later poses correct this answer. With a learned model, its inverse network gives the first answer, and
    the corrections of the simulator, step by step, are added to its later answers.
    """

    def __init__(
        self,
        simulation: Simulation,
        contractions: Vector,
        *,
        model: "LearnedModel | None" = None,
        rate: float = DEFAULT_MAX_SPEED,
    ) -> None:
        """Begin at contractions [m]; cables get no faster than a rate [m/s] (InputError: there are no markers)."""
        self._model, robot = model, simulation.robot
        self.channels, self.contractions = MarkerMapper.list_channels(simulation), contractions.copy()
        self.known = TensionLookup(robot, near=CONTRACTION_TOLERANCE)
        start = simulation.solve(contractions, strict=False)
        self.known.add(start)
        self._names, self._dim = tuple(simulation.rest.markers), robot.body.mesh.dim
        self._markers = np.concatenate([np.asarray(start.markers[name]) for name in self._names])
        self._more, self._jobs, self._hold = np.zeros(len(contractions)), 0, 0
        self._asked: Vector | None = None
        self._targets: dict[str, tuple[float, ...]] = {}
        self._found: PoseOnWay | None = None  # the newest
        self._settled = True  # whether the contractions are those of the newest targets and pose
        self._answers: dict[int, Vector] = {}  # of the networks, by job
        self._lock = threading.Lock()
        if model is not None:
            model.solve({name: tuple(start.markers[name]) for name in self._names}, search=False)  # compiles it
        self._poses = PoseProcess(
            FingertipPoses, (robot, contractions, rate if model is None else None), self._accept_pose
        )

    def ask(self, values: Vector) -> None:
        """Request marker positions [m]."""
        if self._asked is not None and np.array_equal(values, self._asked):
            self._poses.check()
        else:
            self._begin(values)
        with self._lock:
            if not self._settled:
                self._settle()

    def hold_at(self, places: Vector) -> Vector:
        """Hold at contractions [m]; return the simulated marker positions [m]."""
        with self._lock:
            self._jobs, self._asked, self.contractions = self._jobs + 1, None, places.copy()
            self._hold, self._settled = self._jobs, True
        self._poses.give((self._jobs, {}, None))
        return self._markers

    def close(self) -> None:
        """End the background process."""
        self._poses.close()

    def _begin(self, values: Vector) -> None:
        """Let new targets be worked on."""
        rows = values.reshape(-1, self._dim).tolist()
        targets = {name: tuple(row) for name, row in zip(self._names, rows, strict=True)}
        answer = None if self._model is None else self._model.solve(targets, search=False).contractions
        with self._lock:
            self._jobs, self._asked, self._targets, begin = self._jobs + 1, values.copy(), targets, None
            self._settled = False
            if answer is not None:
                self._answers[self._jobs], begin = answer, answer + self._more
        self._poses.give((self._jobs, targets, begin))

    def _settle(self) -> None:
        """Contractions for the newest targets, by the newest pose; done by whoever tells the motors."""
        self._settled, found = True, self._found
        if self._jobs in self._answers:
            self.contractions = self._answers[self._jobs] + self._more
        elif found is not None and found.outlook is not None:
            there = found.done and found.job == self._jobs
            self.contractions = found.contractions if there else found.outlook.towards(self._targets)

    def _accept_pose(self, found: PoseOnWay) -> None:
        self.known.store(found.contractions, found.pulls)
        self._markers = found.markers
        with self._lock:
            self._found = found
            if found.job <= self._hold:  # of before motors held
                return
            self._settled = False
            if found.job in self._answers:
                self._more = found.contractions - self._answers[found.job]
                self._answers = {job: answer for job, answer in self._answers.items() if job >= found.job}
        self.words = f"{1e3 * found.error:.1f} mm from its targets"
        if self.updated is not None:
            self.updated.set()

    @staticmethod
    def list_channels(simulation: Simulation) -> DriveChannels:
        """Return the coordinates of all markers as channels, one group for each marker (InputError: no markers)."""
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
