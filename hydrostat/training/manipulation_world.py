"""`ManipulationWorld`: a robot and a free object that it pushes and turns, in time."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.grasp import move_object
from hydrostat.mechanics import GuideEnergy, NewtonOptions
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation import BodyPhysics, Motion, Simulation, StepOptions


@dataclass(frozen=True, kw_only=True)
class ManipulationPhysics:
    """Options for the dynamics of an object.

    Attributes:
        seconds: time between actions [s].
        beats: number of time steps in an action; winches accelerate and decelerate within it.
        drag: damping of all motion, per mass and velocity [1/s].
        hold: stiffness of a spring that holds the object near its start, in place of a palm under it [N/m]; 0 for none.
        viscosity: viscosity of the body if its material has none [Pa s].

    Raises:
        InputError: a value out of range.
    """

    seconds: float = 0.5
    beats: int = 5
    drag: float = 5.0
    hold: float = 0.0
    viscosity: float = 400.0

    def __post_init__(self) -> None:
        if self.beats < 1:
            raise InputError(f"beats must be 1 or more, not {self.beats}")
        if not 0 < self.seconds < np.inf:
            raise InputError(f"seconds must be above 0, not {self.seconds:g}")
        for name in ("drag", "hold", "viscosity"):
            if not 0 <= getattr(self, name) < np.inf:
                raise InputError(f"{name} must be 0 or more, not {getattr(self, name):g}")


class ObjectState(NamedTuple):
    """Properties of an object that are unknown before it is tried.

    Attributes:
        friction: times its own.
        radius: times its own; of an object without a radius, its sides; of a mesh, nothing.
        start: distance from its usual place [m].
    """

    friction: float = 1.0
    radius: float = 1.0
    start: tuple[float, ...] = ()


class ManipulationWorld:
    """A robot and a free object in dynamics, from keyframe to keyframe.

    Attributes:
        robot: robot that moves the object, which is among its obstacles.
        obstacle: object of this episode.
        simulation: simulation of the robot with it.
        motion: present motion of both.
        start: start of the object [m].
        time_steps: number of time steps of the exact simulator.
        turned: by which angle the object has turned about the axis [rad]; more than a turn is counted on.
    """

    def __init__(self, robot: Robot, obstacle: Obstacle, axis: Vector, physics: ManipulationPhysics) -> None:
        """A robot, the object as it usually is, the axis of turns (a unit vector; in the plane (0, 0, 1))."""
        self._given, self._usual, self._axis, self._physics = robot, obstacle, axis, physics
        self.time_steps = 0
        self.begin(ObjectState())

    def begin(self, state: ObjectState) -> None:
        """Begin at rest, with the object in a state."""
        self.obstacle = as_drawn(self._usual, state)
        others = [each for each in self._given.obstacles if each.name != self._usual.name]
        material = self._given.body.material
        body = replace(
            self._given.body, material=replace(material, viscosity=material.viscosity or self._physics.viscosity)
        )
        self.robot = replace(self._given, body=body, obstacles=(self.obstacle, *others))
        physics = BodyPhysics(self.robot)
        self._carriage = physics.rigid_dofs[0]
        self.start, self._begun = self.obstacle.frame()
        along = self._physics.hold * np.eye(len(self.start))
        guide = GuideEnergy(self._carriage, place=self.start, axes=self._begun, along=along, turning=0.0)
        held = [guide] if self._physics.hold else []
        # Share of the largest force that a time step may leave: turns of a disc change by less than 0.1 degrees
        force = 1e-5
        self.simulation = Simulation(self.robot, body=physics, energies=held, options=NewtonOptions(tolerance=force))
        self.motion: Motion = self.simulation.motion_at_rest()
        self.turned = 0.0

    def go(self, contractions: Vector) -> list[Motion]:
        """The motions of the time steps to contractions [m]; fewer than asked for where no step is found."""
        begin, motions, beats = self.motion.contractions, list[Motion](), self._physics.beats
        options = StepOptions(scheme="euler", drag=self._physics.drag)
        for beat in range(1, beats + 1):
            share = beat / beats
            goal = begin + share * share * (3 - 2 * share) * (contractions - begin)
            self.time_steps += 1
            try:
                motion = self.simulation.step(self.motion, goal, self._physics.seconds / beats, options=options)
            except NotConvergedError:
                break
            self.follow(motion)
            motions.append(motion)
        return motions

    def follow(self, motion: Motion) -> None:
        """Go on from a motion that a step of `simulation` led to; the object turns less than half a turn in a step."""
        self.motion = motion
        change = angle_about(self.axes, self._begun, self._axis) - self.turned
        self.turned += (change + np.pi) % (2 * np.pi) - np.pi

    @property
    def place(self) -> Vector:
        """Center of the object [m]."""
        return self._carried_body[0]

    @property
    def axes(self) -> Points:
        """Its axes, a row for each."""
        axes = self._carried_body[1:] / self._carriage.length
        left, _, right = np.linalg.svd(axes)
        return left @ right

    @property
    def _carried_body(self) -> Points:
        assert self.motion.carried is not None
        return self.motion.carried[0][: len(self._carriage.rows)]

    def visible_obstacles(self) -> tuple[Obstacle, ...]:
        """The object in its place, with dots on it, which show its rotation."""
        axes, radius = self.axes, self.obstacle.radius or float(np.sqrt(self.obstacle.second_moments().max()))
        sides = axes[:1] if len(axes) == 2 else np.concatenate([axes, -axes])
        out = 0.6 if len(axes) == 2 else 0.94
        dots = (self.place + out * radius * sides).tolist()
        made = [Obstacle(name="dot", shape="sphere", at=tuple(dot), radius=0.16 * radius) for dot in dots]
        return (self.obstacle.with_frame(self.place, axes), *made)


def as_drawn(obstacle: Obstacle, state: ObjectState) -> Obstacle:
    """An object in a state: its friction, its radius or sides, its place."""
    middle, factor = obstacle.frame()[0], state.radius
    changed = replace(obstacle, friction=state.friction * (obstacle.friction or 0.0))
    if obstacle.radius is not None:
        changed = replace(changed, radius=factor * obstacle.radius)
    elif obstacle.to is not None:
        at, to = (tuple((middle + factor * (np.array(end) - middle)).tolist()) for end in (obstacle.at, obstacle.to))
        changed = replace(changed, at=at, to=to)
    return move_object(changed, middle + np.array(state.start)) if state.start else changed


def is_clear(robot: Robot, obstacle: Obstacle) -> bool:
    """True if a body at rest leaves half of the contact distance or more to an object, and has none of it inside."""
    from hydrostat.geometry import locate

    mesh = robot.body.mesh
    gaps = obstacle.field()(mesh.nodes[np.unique(mesh.boundary)]).values
    return bool(gaps.min() > 0.5 * robot.contact_distance) and not locate(mesh, obstacle.spine()).inside.any()


def angle_about(axes: Points, begun: Points, axis: Vector) -> float:
    """By which angle axes have turned about an axis, from -pi to pi: the twist of swing and twist."""
    turn = axes.T @ begun
    if len(turn) == 2:
        return float(np.arctan2(turn[1, 0], turn[0, 0]))
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(turn).as_quat()
    return float((2 * np.arctan2(np.array([x, y, z]) @ axis, w) + np.pi) % (2 * np.pi) - np.pi)
