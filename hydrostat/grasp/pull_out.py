"""`pull_out`: a robot closes on an object, which is then pulled away; the required force."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import HydrostatError, InputError, NotConvergedError
from hydrostat.grasp.grasped_object import move_object
from hydrostat.mechanics import GuideEnergy
from hydrostat.progress import Progress
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation import (
    BodyPhysics,
    Contractions,
    Equilibrium,
    Simulation,
    StepOptions,
    obstacle_forces,
    with_replaced,
)

FRICTIONS, MODULI, ASIDE = (0.3, 0.8), (0.7, 1.3), 5e-3
"""Variations that are tried: friction coefficients, factors of Young's modulus, offset of the object [m]."""


@dataclass(frozen=True, kw_only=True)
class PullOptions:
    """Options of a pull-out test.

    Attributes:
        direction: direction of the pull, of any length.
        step: displacement of the pulling hand in each step [m].
        travel: maximum displacement of the hand [m]; None: 1.5 times the size of the object.
        along: stiffness of the pull along its direction [N/m].
        across: stiffness that holds the object across the pull [N/m] and, at its rim, against rotation. A value as
            large as `along` moves the object straight; a much smaller value lets it find its own path.

    Raises:
        InputError: no direction, or a value that is not above 0.
    """

    direction: tuple[float, ...]
    step: float = 1e-3
    travel: float | None = None
    along: float = 5e3
    across: float = 5e3

    def __post_init__(self) -> None:
        if not (np.isfinite(self.direction).all() and np.any(self.direction)):
            raise InputError("the pull must have a direction, such as +z")
        for name in ("step", "along", "across"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(f"{name} of the pull must be above 0, not {getattr(self, name):g}")

    @property
    def unit(self) -> Vector:
        """Direction of the pull, of length 1."""
        return np.array(self.direction) / np.linalg.norm(self.direction)


@dataclass(frozen=True, kw_only=True, eq=False)
class PullOut:
    """Result of a pull-out test, step by step; the first row is the grasp before the pull.

    Attributes:
        robot: robot with the object as its last obstacle.
        pulled: displacement of the pulling hand [m], (rows,).
        moved: displacement of the object along the pull [m], (rows,).
        forces: force along the pull that holds the object there [N], (rows,).
        contact: force of the robot on the object [N], (rows, dim).
        poses: equilibria of the robot with the object.
        released: True if nothing touches the object at the end.
        status: reason why the pull ended.
    """

    robot: Robot
    pulled: Vector
    moved: Vector
    forces: Vector
    contact: Points
    poses: tuple[Equilibrium, ...]
    released: bool
    status: str

    @property
    def peak(self) -> float:
        """Largest force [N]."""
        return float(self.forces.max())

    @property
    def is_rising(self) -> bool:
        """True if the force was still at its maximum when the pull ended before release."""
        return not self.released and int(self.forces.argmax()) == len(self.forces) - 1

    @property
    def work(self) -> float:
        """Largest work done by the pull up to any position [J]: without friction, the escape energy."""
        done = 0.5 * (self.forces[1:] + self.forces[:-1]) * np.diff(self.moved)
        return float(np.cumsum(done).max(initial=0.0))

    def object_at(self, row: int) -> Obstacle:
        """Return the object at its position in a row, without its rotation."""
        pose = self.poses[row]
        assert pose.carried is not None
        return move_object(self.robot.obstacles[-1], pose.carried[-1 - pose.carried.shape[1]])


def pull_out(
    robot: Robot,
    obstacle: Obstacle,
    contractions: Contractions,
    options: PullOptions,
    *,
    progress: Progress | None = None,
) -> PullOut:
    """Close a robot on a held object, let the object find its equilibrium, then pull it out in small steps.

    Stiff springs hold the object, so the force may fall after its peak. Friction depends on the path; the result does
    not depend on the step length.

    Args:
        robot: robot that grasps the object.
        obstacle: object with a mass, at its rest position, clear of the body.
        contractions: contractions that close the robot [m].
        options: options of the pull.
        progress: callback for progress.

    Raises:
        InputError: an object that overlaps the body, has no mass, or is never touched.
        NotConvergedError: the robot could not be closed.
    """
    if obstacle.mass is None:
        raise InputError(f'"{obstacle.name}" has no mass; give it one, such as 58 g')
    full = replace(robot, obstacles=(*robot.obstacles, obstacle))
    body = BodyPhysics(full)
    carriage = body.rigid_dofs[len(robot.obstacles)]
    place, axes = obstacle.frame()
    unit, dim = options.unit, len(place)
    whole = np.eye(dim)
    held = GuideEnergy(carriage, place=place, axes=axes, along=options.along * whole, turning=options.along)
    closing = Simulation(full, body=body, energies=[held])
    pose = closing.solve(contractions)
    if not obstacle_forces(closing, pose)[-1].any():
        raise InputError(f'nothing touches "{obstacle.name}" in the closed robot. Move it, or close the robot further')
    straight = np.outer(unit, unit)
    springs = options.along * straight + options.across * (whole - straight)
    rows: list[tuple[float, Equilibrium, Vector, Vector]] = []
    travel = options.travel or 1.5 * _size(obstacle)
    count, status = max(1, int(np.ceil(travel / options.step))), "object not free at the end of the pull"
    for number in range(count + 1):
        pulled = min(number * options.step, travel)
        guide = GuideEnergy(carriage, place=place + pulled * unit, axes=axes, along=springs, turning=options.across)
        pulling = with_replaced(closing, held, guide)
        found = pulling.solve(contractions, start=pose, strict=False)
        if not found.result.converged:
            found = _find_settled(pulling, contractions, pose)
        if found is None:
            status = f"no equilibrium found after {1e3 * pulled:.3g} mm"
            break
        pose = found
        push = obstacle_forces(pulling, pose)[-1]
        rows.append((pulled, pose.without_factors(), guide.pull(pose.unknowns), push))
        if progress is not None:
            progress("pulling [mm]", round(1e3 * pulled), round(1e3 * travel))
        if number and not push.any():
            status = "object is free"
            break
    if not rows:
        raise InputError(f'no equilibrium of "{obstacle.name}" in the grasp before the pull: {status}')
    if progress is not None:
        progress("pulling [mm]", round(1e3 * travel), round(1e3 * travel))
    distances, poses, pulls, pushes = zip(*rows, strict=True)
    return PullOut(
        robot=full,
        pulled=np.array(distances),
        moved=np.array([(carriage.place(pose.unknowns) - place) @ unit for pose in poses]),
        forces=np.array(pulls) @ unit,
        contact=np.array(pushes),
        poses=poses,
        released=not pushes[-1].any(),
        status=status,
    )


def _find_settled(simulation: Simulation, contractions: Contractions, pose: Equilibrium) -> Equilibrium | None:
    """Return the equilibrium that a released robot reaches in time; None if it does not.

    Masses tell what a balance of forces alone leaves open: which way an object slips that could slip either way.
    """
    motion = simulation.motion_at_rest(pose)
    # Steps in time [s] in search of rest, the most of them, and what counts as rest [m/s]
    step, steps, slow = 0.01, 150, 1e-3
    for _ in range(steps):
        try:
            motion = simulation.step(motion, contractions, step, options=StepOptions(scheme="euler"))
        except NotConvergedError:
            return None
        fastest = float(np.abs(motion.velocities).max())
        if motion.carried is not None:
            fastest = max(fastest, float(np.abs(motion.carried[1]).max()))
        if fastest < slow:
            still = simulation.solve(contractions, start=motion.pose, strict=False)
            return still if still.result.converged else motion.pose
    return None


def _size(obstacle: Obstacle) -> float:
    """Approximate size of an object [m]."""
    return float(np.sqrt(12 * obstacle.second_moments().max()))


@dataclass(frozen=True, kw_only=True, eq=False)
class PullCase:
    """Pull-out test with one varied parameter.

    Attributes:
        name: description of the variation.
        pull: result; None if the simulation failed.
        trouble: reason of the failure.
    """

    name: str
    pull: PullOut | None
    trouble: str = ""


def pull_bands(
    robot: Robot,
    obstacle: Obstacle,
    contractions: Contractions,
    options: PullOptions,
    *,
    progress: Progress | None = None,
) -> tuple[PullCase, ...]:
    """Pull with friction, stiffness and position varied one at a time, and without friction, to test caging alone.

    Args:
        robot: robot that grasps the object.
        obstacle: object with its nominal friction and position.
        contractions: contractions that close the robot [m].
        options: options of the pull.
        progress: callback for progress.
    """
    cases = list(_cases(robot, obstacle))
    found = []
    for number, (name, other, moved) in enumerate(cases):
        try:
            found.append(PullCase(name=name, pull=pull_out(other, moved, contractions, options)))
        except HydrostatError as error:
            found.append(PullCase(name=name, pull=None, trouble=str(error)))
        if progress is not None:
            progress("cases", number + 1, len(cases))
    return tuple(found)


def _cases(robot: Robot, obstacle: Obstacle) -> Iterator[tuple[str, Robot, Obstacle]]:
    yield "no friction", robot, replace(obstacle, friction=0.0)
    for friction in FRICTIONS:
        yield f"friction {friction:g}", robot, replace(obstacle, friction=friction)
    material = robot.body.material
    for factor in MODULI:
        body = replace(robot.body, material=material.with_young(factor * material.young))
        yield f"modulus {factor - 1:+.0%}", replace(robot, body=body), obstacle
    place = obstacle.frame()[0]
    for axis in range(len(place)):
        for sign in (-1.0, 1.0):
            aside = place + sign * ASIDE * np.eye(len(place))[axis]
            yield f"{'xyz'[axis]} {1e3 * sign * ASIDE:+.0f} mm", robot, move_object(obstacle, aside)
