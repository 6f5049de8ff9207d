"""`Backend`: what an environment asks where markers go: the simulator, a network, or both in turn."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, SensorReader, Simulation


class Backend(ABC):
    """Simulator or networks that compute marker positions for contractions.

    Attributes:
        equilibria: number of equilibria of the exact simulator that were computed: the cost of learning.
    """

    equilibria: int = 0

    pose: Equilibrium | None = None
    """Present shape, if known; None at rest, and in networks, which know no shape."""

    def begin(self) -> None:
        """Begin an episode, at rest."""
        self.back()

    @abstractmethod
    def back(self) -> None:
        """Go back to rest."""

    @abstractmethod
    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates of all markers [m] at contractions [m]; None where no equilibrium is found."""

    def read_sensors(self, random: np.random.Generator) -> Vector:
        """Readings of all sensors with noise, in SI (InputError: networks have none)."""
        del random
        raise InputError("networks know no readings of sensors: use the simulator, or options without sensors")

    def get_state(self) -> tuple[int, ...]:
        """State of the progress: equilibria, and the rest that the next episode depends on."""
        return (self.equilibria,)

    def go_on(self, kept: Sequence[int]) -> None:
        """Go on where a backend was that has been kept."""
        (self.equilibria,) = kept


class ExactBackend(Backend):
    """Equilibria of the simulator, each from the one before: with friction the way counts."""

    def __init__(self, robot: Robot, *, from_rest: bool = True) -> None:
        """A robot; poses begin from rest unless the way shall count."""
        self._simulation, self._from_rest = Simulation(robot), from_rest
        self._reader = SensorReader(self._simulation)

    def read_sensors(self, random: np.random.Generator) -> Vector:
        """Readings in the present pose, or at rest."""
        return self._reader.read_vector(self.pose or self._simulation.rest, random=random)

    def back(self) -> None:
        """Go back to rest."""
        self.pose = None

    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates at an equilibrium."""
        self.equilibria += 1
        start = None if self._from_rest else self.pose
        pose = self._simulation.solve(contractions, start=start, strict=False)
        if not pose.result.converged:
            return None
        self.pose = pose
        return np.array(list(pose.markers.values())).ravel()


class LearnedBackend(Backend):
    """Predictions of the networks of a learned model; they cost no equilibrium beyond its samples."""

    def __init__(self, model: LearnedModel) -> None:
        """Networks of a robot."""
        self._model, self._count = model, model.card.coordinates

    def back(self) -> None:
        """Go back to rest, which networks do not remember."""

    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates that are expected."""
        return self._model.predict(contractions)[0][: self._count]


class MixedBackend(Backend):
    """A network, and the exact simulator in every so many episodes."""

    def __init__(self, learned: Backend, exact: Backend, *, every: int) -> None:
        """Both, and how often the exact one is asked (InputError: not a number from 1)."""
        if every < 1:
            raise InputError(f"every must be 1 or more, not {every}")
        self._worlds, self._every, self._episode = (learned, exact), every, -1

    @property
    def pose(self) -> Equilibrium | None:  # type: ignore[override]
        """Shape of the exact robot in its episodes."""
        return self._now.pose

    @property
    def equilibria(self) -> int:  # type: ignore[override]
        """Equilibria of the exact backend."""
        return self._worlds[1].equilibria

    def read_sensors(self, random: np.random.Generator) -> Vector:
        """Readings of whichever is asked now."""
        return self._now.read_sensors(random)

    def get_state(self) -> tuple[int, ...]:
        """Equilibria, and which episode it is."""
        return (self.equilibria, self._episode)

    def go_on(self, kept: Sequence[int]) -> None:
        """Go on with the episode after."""
        self._worlds[1].equilibria, self._episode = kept

    def begin(self) -> None:
        """Go to the next episode."""
        self._episode += 1
        self.back()

    def back(self) -> None:
        """Go back to rest."""
        self._now.back()

    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates by whichever has this episode."""
        return self._now.reach(contractions)

    @property
    def _now(self) -> Backend:
        return self._worlds[self._episode % self._every == 0]
