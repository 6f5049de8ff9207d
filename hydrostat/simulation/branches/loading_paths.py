"""`loading_paths_to`: different loading paths to the same contractions (E20); `friction_hysteresis`: there and back."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, islice, permutations
from math import ceil, factorial

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, kw_only=True, eq=False)
class Approach:
    """Loading path that brings a robot to its contractions.

    Attributes:
        name: description of the path.
        stops: contractions along the path [m], the goal last.
        at_once: go to the first stop by one solve from rest instead of small steps.
        push: force on each node [N] that displaces the robot at the goal before it is released; None for no push.
        reach: displacement caused by the push, as a share of the body's size.
    """

    name: str
    stops: tuple[Vector, ...]
    at_once: bool = False
    push: Nodes | None = None
    reach: float = 0.0


def loading_paths_to(simulation: Simulation, goal: Vector, count: int, seed: int) -> list[Approach]:
    """Loading paths to contractions `goal` [m], so many, the plain ones first.

    From rest in one step, all winches together, back from full travel, and from full release where there is any; then
    in turn: one winch after the other, pushed aside and let go, from other contractions. Orders and pushes that are
    drawn come from `seed`.
    """
    robot = simulation.robot
    low, high = robot.control_limits
    plain = [
        Approach(name="from rest in one step", stops=(goal,), at_once=True),
        Approach(name="from rest, all winches together", stops=(goal,)),
        Approach(name="back from full travel", stops=(high, goal)),
    ]
    if low.any():
        plain.append(Approach(name="back from full release", stops=(low, goal)))
    random = np.random.default_rng(seed)
    kinds = [_orders(robot, goal, random), _pushes(simulation, goal, random), _elsewhere(robot, goal, random)]
    return list(islice(chain(plain, _in_turn(kinds)), count))


def follow_approach(simulation: Simulation, way: Approach) -> Equilibrium:
    """Return the pose at the end of a loading path; not converged if no equilibrium was found on it."""
    idle = np.zeros(simulation.robot.num_controls)
    first, *others = way.stops
    if way.at_once:
        pose = simulation.solve(first, strict=False)
    else:
        pose = _in_steps(simulation, simulation.solve(idle, strict=False), first)
    for stop in others:
        pose = _in_steps(simulation, pose, stop)
    return pose if way.push is None else _let_go(simulation, pose, way.push, way.reach)


def _in_turn(kinds: list[Iterator[Approach]]) -> Iterator[Approach]:
    """One of each kind, again and again, until none is left."""
    while kinds:
        for kind in tuple(kinds):
            found = next(kind, None)
            if found is None:
                kinds.remove(kind)
            else:
                yield found


def _orders(robot: Robot, goal: Vector, random: np.random.Generator) -> Iterator[Approach]:
    """Winches that move, one after the other: in all orders if they are few, else in random ones."""
    moved = [int(winch) for winch in np.flatnonzero(goal)]
    if len(moved) < 2:
        return
    most_orders = 24  # With more orders than these, random ones are drawn
    few = factorial(len(moved)) <= most_orders
    orders = list(permutations(moved)) if few else [tuple(random.permutation(moved)) for _ in range(most_orders)]
    for order in orders:
        stops, now = [], np.zeros_like(goal)
        for winch in order:
            now = now.copy()
            now[winch] = goal[winch]
            stops.append(now)
        names = ", ".join((*robot.winches, *robot.drives)[winch].name for winch in order)
        yield Approach(name=f"one winch after the other: {names}", stops=tuple(stops))


def _pushes(simulation: Simulation, goal: Vector, random: np.random.Generator) -> Iterator[Approach]:
    """Paths with a push by a force like the body's weight, in two opposite directions, and a release."""
    masses = simulation.body.masses[:, None]
    reaches = (0.1, 0.4)  # Least and largest reach of a push
    while True:
        direction = random.standard_normal(simulation.robot.body.mesh.dim)
        reach = float(random.uniform(*reaches))
        for sign in (1.0, -1.0):
            yield Approach(name="pushed aside and let go", stops=(goal,), push=sign * masses * direction, reach=reach)


def _elsewhere(robot: Robot, goal: Vector, random: np.random.Generator) -> Iterator[Approach]:
    """From contractions anywhere in the range of the winches."""
    low, high = robot.control_limits
    while True:
        yield Approach(name="from other contractions", stops=(random.uniform(low, high), goal), at_once=True)


def _in_steps(simulation: Simulation, pose: Equilibrium, goal: Vector) -> Equilibrium:
    """From pose to pose in even steps of a small part of a winch's range; no further than it converges."""
    low, high = simulation.robot.control_limits
    begin = pose.controls
    steps = ceil(float((np.abs(goal - begin) / (high - low)).max(initial=0.0)) / _STEP - 1e-9)
    # More steps are not taken, however far beyond its range a winch goes; they are longer then
    most_steps = 100
    steps = min(max(1, steps), most_steps)
    for step in range(1, steps + 1):
        if not pose.result.converged:
            break
        target = goal if step == steps else begin + (goal - begin) * (step / steps)
        pose = simulation.solve(target, start=pose, strict=False)
    return pose


def _let_go(simulation: Simulation, pose: Equilibrium, push: Nodes, reach: float) -> Equilibrium:
    """Return the equilibrium of a pose after a push at fixed contractions."""
    stiffness = simulation.stiffness(pose)
    if not pose.result.converged or stiffness.singular:
        return pose
    robot = simulation.robot
    step = stiffness.solve(push.ravel()).reshape(push.shape)
    step *= reach * robot.body.mesh.size / np.linalg.norm(step, axis=1).max()
    pushed = _push_nodes(simulation, pose, step)
    return simulation.solve(pose.controls, start=replace(pose, nodes=pushed), strict=False)


def _push_nodes(simulation: Simulation, pose: Equilibrium, step: Nodes) -> Nodes:
    """Nodes moved by a step along arcs; by less where an element would be inverted."""
    halvings = 12
    for _ in range(halvings):
        nodes = simulation.body.warp(pose.nodes, step)
        if np.isfinite(simulation.assembly.with_active_terms(nodes).value(nodes, pose.controls)):
            return nodes
        step = 0.5 * step
    return pose.nodes


_STEP = 0.1
"""Largest step on a way, as a share of a winch's travel and release together."""


def friction_hysteresis(simulation: Simulation, pose: Equilibrium, *, overshoot: float = 0.1) -> dict[str, float]:
    """Return the distance of each marker between a pose and the pose at the same contractions after paying out [m].

    All winches take in a share more than in the pose and pay it out again. Empty without path-dependent physics.

    Args:
        simulation: simulation of the robot.
        pose: equilibrium of the robot.
        overshoot: relative increase of all contractions on the path, even beyond the travel of a winch.

    Raises:
        InputError: an overshoot that is not above 0.
        NotConvergedError: the path cannot be followed.
    """
    if not overshoot > 0:
        raise InputError(f"overshoot must be a share above 0, not {overshoot:g}")
    if not simulation.assembly.has_history:
        return {}
    above = simulation.solve((1.0 + overshoot) * pose.controls, start=pose)
    back = simulation.solve(pose.controls, start=above)
    return {name: float(np.linalg.norm(back.markers[name] - place)) for name, place in pose.markers.items()}
