"""Poses, tensions and derivatives in the plane and in space. Oracle: the same energy in JAX, `jax_energy`."""

import math
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing import get_context

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_robot

from hydrostat.robot import Cable, Mount, Pin, Robot, Winch
from hydrostat.simulation import Simulation


def bar_robot() -> Robot:
    """A bar 120 x 40 x 30 mm held at its left end, with a cable that winds about its axis."""
    places = (0.008, 0.031, 0.052, 0.079, 0.112)
    points = tuple((x, 0.02 + 0.012 * math.cos(30 * x), 0.015 + 0.009 * math.sin(30 * x)) for x in places)
    return Robot(
        name="bar",
        body=mesh_body(box_mesh((6, 2, 2), size=(0.12, 0.04, 0.03))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="only", at=points[0]),),
        cables=(Cable(winch="only", points=points),),
        poses={},
    )


def block_robot() -> Robot:
    """A block pinned in two places, round a node and at a bare point, with a winch in the world and one in the body.

    The winch in the world pulls two cables, of which one is sheathed in part and the other slack at first; gravity
    points aslant.
    """
    outside, inside = (-0.03, 0.05, 0.06), (0.013, 0.011, 0.009)
    return Robot(
        name="block",
        body=mesh_body(box_mesh((4, 2, 2), size=(0.1, 0.05, 0.05))),
        pins=(
            Pin(at=(0.0, 0.0, 0.0), radius=0.026, stiffness=4e4),
            Pin(at=(0.011, 0.033, 0.041), stiffness=2e4),
            Pin(at=(0.093, 0.007, 0.004), stiffness=30.0),
        ),
        winches=(Winch(name="world", at=outside, mount=Mount.WORLD), Winch(name="body", at=inside)),
        cables=(
            Cable(
                winch="world",
                points=(outside, (0.02, 0.041, 0.038), (0.05, 0.037, 0.042), (0.091, 0.04, 0.033)),
                sheathed=((1, 2),),
                stiffness=2500.0,
            ),
            Cable(winch="body", points=(inside, (0.047, 0.009, 0.012), (0.088, 0.017, 0.008))),
            Cable(winch="world", points=(outside, (0.031, 0.022, 0.044), (0.072, 0.011, 0.031)), slack=0.003),
        ),
        poses={},
        gravity=(2.0, -3.0, -9.0),
    )


CASES: dict[str, tuple[Callable[[], Robot], list[float]]] = {
    "strip": (
        lambda: replace(strip_robot(columns=8, rows=2, slack=0.002, sheathed=((1, 3),)), gravity=(1.0, -9.0)),
        [0.025, 0.015],
    ),
    "bar": (bar_robot, [0.02]),
    "block": (block_robot, [0.012, 0.007]),
}


@dataclass(frozen=True)
class Answer:
    """What the oracle finds: nodes [m], tensions [N], d nodes / d contractions, and its own residual [N]."""

    nodes: np.ndarray
    tensions: np.ndarray
    jacobian: np.ndarray
    residual: float


@cache
def oracles() -> dict[str, Answer]:
    """The oracle's answers, found in a process of its own: JAX starts threads, beside which nothing else may fork."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return {name: Answer(*found) for name, found in zip(CASES, pool.map(_in_jax, CASES), strict=True)}


def oracle(name: str) -> Answer:
    """The oracle's answer of a case."""
    return oracles()[name]


def _in_jax(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    from jax_energy import find_equilibrium

    return find_equilibrium(CASES[name][0](), CASES[name][1])


def gaps(name: str, share: float = 1.0) -> tuple[float, float, float]:
    """How far hydrostat is from the oracle: nodes by the body's size, tensions and Jacobian by their largest entry."""
    robot, contractions = CASES[name][0](), np.array(CASES[name][1])
    simulation, answer = Simulation(robot), oracle(name)
    pose = simulation.solve(share * contractions)
    jacobian = simulation.jacobian(pose)
    return (
        float(np.abs(pose.nodes - answer.nodes).max() / robot.body.mesh.size),
        float(np.abs(pose.tensions - answer.tensions).max() / answer.tensions.max()),
        float(np.abs(jacobian - answer.jacobian).max() / np.abs(answer.jacobian).max()),
    )


@pytest.mark.parametrize("name", CASES)
@pytest.mark.slow
def test_the_oracle_is_at_an_equilibrium_that_moved(name: str) -> None:
    """Its own forces are below 1e-9 N, every cable pulls, and the body has moved by more than 2 % of its size."""
    answer, mesh = oracle(name), CASES[name][0]().body.mesh
    assert answer.residual < 1e-9
    assert answer.tensions.min() > 0.01
    assert np.abs(answer.nodes - mesh.nodes).max() > 0.02 * mesh.size


@pytest.mark.parametrize("name", CASES)
@pytest.mark.slow
def test_nodes_tensions_and_jacobian_are_those_of_jax(name: str) -> None:
    nodes, tensions, jacobian = gaps(name)
    assert nodes < 1e-8
    assert tensions < 1e-7
    assert jacobian < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["strip", "block"])
def test_gravity_is_seen(name: str) -> None:
    """The check can fail: without its weight a body is off by far more than is allowed."""
    robot = replace(CASES[name][0](), gravity=None)
    pose = Simulation(robot).solve(np.array(CASES[name][1]))
    assert np.abs(pose.nodes - oracle(name).nodes).max() > 1e-3 * robot.body.mesh.size


@pytest.mark.parametrize("name", CASES)
def test_a_little_more_contraction_is_seen(name: str) -> None:
    """The check can fail: with 0.1 % more, all three are off by over a hundred times what is allowed."""
    nodes, tensions, jacobian = gaps(name, share=1.001)
    assert nodes > 1e-6
    assert tensions > 1e-5
    assert jacobian > 1e-4
