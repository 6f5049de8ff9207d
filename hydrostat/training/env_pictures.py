"""Pictures of environments, frame by frame, in which the robot has one size and colors mean the same tension."""

from dataclasses import replace
from typing import Any

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.plot import Frame, FramePictures, Picture
from hydrostat.robot import Obstacle, ObstacleShape, PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Motion, Simulation
from hydrostat.training.manipulation_world import ManipulationWorld


class _EnvPictures:
    """Pictures in one frame: the body at rest and a quarter more; a copy draws its own, as figures cannot be copied."""

    def __init__(self, robot: Robot, tensions: Vector, *given: Any, obstacles: tuple[Obstacle, ...] = ()) -> None:
        """Room for the body at rest and for obstacles; colors up to `tensions` [N]. `given` makes a copy."""
        self._robot, self._given = robot, given
        rest = robot.body.mesh.nodes
        middle = 0.5 * (rest.min(axis=0) + rest.max(axis=0))
        room = Frame(nodes=middle + 1.25 * (rest - middle), tensions=tensions, obstacles=obstacles)
        self._pictures = FramePictures(robot, [room], width=640)

    def __reduce__(self) -> tuple[type["_EnvPictures"], tuple[Any, ...]]:
        return type(self), self._given


class ReachPictures(_EnvPictures):
    """Pictures of a robot at contractions, with its goal."""

    def __init__(self, robot: Robot) -> None:
        """Colors up to the tensions at full travel."""
        self._simulation = Simulation(robot)
        full = self._simulation.solve(np.array([winch.travel for winch in robot.winches]), strict=False)
        super().__init__(robot, full.tensions, robot)

    def draw(self, pose: Equilibrium | None, contractions: Vector, goal: PoseTarget, words: str) -> Picture:
        """Draw a pose, with words below the name of the robot; without one, solve contractions [m] from rest."""
        pose = pose or self._simulation.solve(contractions, strict=False)
        frame = Frame(
            nodes=pose.nodes, tensions=pose.tensions, contractions=pose.contractions, target=goal, words=words
        )
        return self._pictures.draw(frame)


class ManipulationPictures(_EnvPictures):
    """Pictures of a robot with its object."""

    def __init__(self, robot: Robot, obstacle: Obstacle) -> None:
        """Colors up to the tensions at 0.3 of travel."""
        alone = replace(robot, obstacles=())
        taken = np.array([0.3 * winch.travel for winch in robot.winches])
        tensions = Simulation(alone).solve(taken, strict=False).tensions
        super().__init__(alone, tensions, robot, obstacle, obstacles=(obstacle,))

    def draw(self, world: ManipulationWorld, words: str) -> Picture:
        """Draw robot and object where they are, with words below the name of the robot."""
        return self._pictures.draw(Frame.of(world.motion, words=words, obstacles=world.visible_obstacles()))


class WalkPictures(_EnvPictures):
    """Pictures of a robot that walks: the middle of its mass stays, and the ground goes by."""

    def __init__(self, robot: Robot, most: float) -> None:
        """Colors up to the tensions at a fifth of `most` [m]."""
        full = Simulation(robot).tensions(robot.body.mesh.nodes, np.full(len(robot.winches), 0.2 * most))
        super().__init__(robot, full, robot, most)

    def draw(self, motion: Motion, way: float, words: str) -> Picture:
        """Draw an instant, after a way in x [m], with words below the name of the robot."""
        shift = np.zeros(motion.nodes.shape[1])
        shift[0] = way
        frame = Frame(
            nodes=motion.nodes - shift,
            tensions=motion.tensions,
            contractions=motion.contractions,
            words=words,
            obstacles=self._marks(way),
        )
        return self._pictures.draw(frame)

    def _marks(self, way: float) -> tuple[Obstacle, ...]:
        """Posts in the ground, one every tenth of the body's size, that go by."""
        mesh = self._robot.body.mesh
        ground = next(obstacle for obstacle in self._robot.obstacles if obstacle.shape is ObstacleShape.PLANE)
        gap, middle = 0.1 * mesh.size, 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
        first = np.ceil((middle[0] - 0.7 * mesh.size + way) / gap)
        marks = []
        for number in range(int(first), int(first) + 14):
            low, high = middle.copy(), middle.copy()
            low[0], high[0] = number * gap - way, number * gap - way + 0.15 * gap
            low[-1], high[-1] = ground.at[-1] - 0.2 * gap, ground.at[-1] - 0.02 * gap
            if len(low) == 3:
                low[1], high[1] = mesh.nodes[:, 1].min(), mesh.nodes[:, 1].max()
            marks.append(Obstacle(name=f"mark {number}", shape="box", at=tuple(low), to=tuple(high)))
        return tuple(marks)
