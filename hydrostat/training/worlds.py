"""`World`: what an environment asks where markers go: the simulator, a network, or both in turn."""

from abc import ABC, abstractmethod

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation


class World(ABC):
    """Where the markers of a robot go when its winches take in cable.

    Attributes:
        equilibria: how many equilibria of the exact simulator have been asked for: what learning costs.
    """

    equilibria: int = 0

    pose: Equilibrium | None = None
    """Where the robot is, where that is known; None at rest, and in networks, which know no shape."""

    def begin(self) -> None:
        """Begin an episode, at rest."""
        self.back()

    @abstractmethod
    def back(self) -> None:
        """Go back to rest."""

    @abstractmethod
    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates of all markers [m] at contractions [m]; None where no equilibrium is found."""

    def kept(self) -> tuple[int, ...]:
        """How far it has come: equilibria, and what else the next episode depends on."""
        return (self.equilibria,)

    def go_on(self, kept: tuple[int, ...]) -> None:
        """Go on where a world was that has been kept."""
        (self.equilibria,) = kept


class ExactWorld(World):
    """Equilibria of the simulator, each from the one before: with friction the way counts."""

    def __init__(self, robot: Robot, *, from_rest: bool = True) -> None:
        """A robot; poses begin from rest unless the way shall count."""
        self._simulation, self._from_rest = Simulation(robot), from_rest

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


class LearnedWorld(World):
    """What the networks of a learned model expect; it costs no equilibrium beyond its samples."""

    def __init__(self, model: LearnedModel) -> None:
        """Networks of a robot."""
        self._model, self._count = model, model.card.coordinates

    def back(self) -> None:
        """Go back to rest, which networks do not remember."""

    def reach(self, contractions: Vector) -> Vector | None:
        """Coordinates that are expected."""
        return self._model.predict(contractions)[0][: self._count]


class MixedWorld(World):
    """A network, and the exact simulator in every so many episodes."""

    def __init__(self, learned: World, exact: World, *, every: int) -> None:
        """Both, and how often the exact one is asked (InputError: not a number from 1)."""
        if every < 1:
            raise InputError(f"every must be 1 or more, not {every}")
        self._worlds, self._every, self._episode = (learned, exact), every, -1

    @property
    def pose(self) -> Equilibrium | None:  # type: ignore[override]
        """Where the exact robot is, in its episodes."""
        return self._now.pose

    @property
    def equilibria(self) -> int:  # type: ignore[override]
        """Equilibria of the exact world."""
        return self._worlds[1].equilibria

    def kept(self) -> tuple[int, ...]:
        """Equilibria, and which episode it is."""
        return (self.equilibria, self._episode)

    def go_on(self, kept: tuple[int, ...]) -> None:
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
    def _now(self) -> World:
        return self._worlds[self._episode % self._every == 0]
