"""Poses, tensions and derivatives in the plane and in space. Oracle: the same energy in JAX, minimised by SciPy.

The energy is written afresh from the formulas of ARCHITECTURE.md, weights of cable points included; it shares no code
with hydrostat. Its derivatives are automatic ones, dense and without a sparse pattern.
"""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_robot
from scipy.optimize import minimize

from hydrostat.robot import Cable, Mount, Pin, Robot, Winch
from hydrostat.simulation import Simulation

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)


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


def weights(robot: Robot, point: Sequence[float]) -> np.ndarray:
    """Of each node in the place of a material point: barycentric coordinates of the first element that holds it."""
    nodes, elements = robot.body.mesh.nodes, robot.body.mesh.elements
    for element in elements:
        system = np.vstack([nodes[element].T, np.ones(len(element))])
        shares = np.linalg.solve(system, [*point, 1.0])
        if shares.min() > -1e-9:
            row = np.zeros(len(nodes))
            row[element] = shares
            return row
    raise AssertionError("the point is outside")


def body_energy(robot: Robot) -> Callable[[jax.Array], jax.Array]:
    """Elastic energy and weight of the body [J] at positions (nodes, dim)."""
    X, elements = robot.body.mesh.nodes, robot.body.mesh.elements
    material, thickness = robot.body.material, robot.body.thickness or 1.0
    mu = material.young / (2 * (1 + material.poisson))
    lam = material.young * material.poisson / ((1 + material.poisson) * (1 - 2 * material.poisson))
    sides = X[elements[:, 1:]] - X[elements[:, :1]]
    inverses = np.linalg.inv(sides)
    rest = np.abs(np.linalg.det(sides))
    masses = material.density * thickness * rest / math.factorial(X.shape[1])
    gravity = np.array(robot.gravity or np.zeros(X.shape[1]))

    def energy(x: jax.Array) -> jax.Array:
        now = x[elements[:, 1:]] - x[elements[:, :1]]
        if X.shape[1] == 2:
            J = (now[:, 0, 0] * now[:, 1, 1] - now[:, 0, 1] * now[:, 1, 0]) / rest
        else:
            J = jnp.sum(now[:, 0] * jnp.cross(now[:, 1], now[:, 2]), axis=1) / rest
        F = inverses @ now  # transposed, which changes none of its invariants
        log = jnp.log(jnp.where(J > 0, J, 1.0))
        density = mu / 2 * (jnp.sum(F**2, axis=(1, 2)) - X.shape[1]) - mu * log + lam / 2 * log**2
        elastic = jnp.sum(rest / math.factorial(X.shape[1]) * thickness * density)
        weight = -jnp.sum(masses[:, None] * (x[elements] - X[elements]).mean(axis=1) * gravity)
        return jnp.where(jnp.min(J) > 0, elastic + weight, jnp.inf)

    return energy


def pin_energy(robot: Robot) -> Callable[[jax.Array], jax.Array]:
    """Energy [J] of the springs of all pins."""
    X = robot.body.mesh.nodes
    rows, springs = [], []
    for pin in robot.pins:
        if pin.box is not None:
            held = ((np.min(pin.box, axis=0) <= X) & (np.max(pin.box, axis=0) >= X)).all(axis=1)
        else:
            held = np.linalg.norm(X - np.array(pin.at), axis=1) <= pin.radius
        own = np.eye(len(X))[held] if held.any() else weights(robot, pin.at or ())[None]
        rows.append(own)
        springs.append(np.full(len(own), pin.stiffness / len(own)))
    W, k = np.concatenate(rows), np.concatenate(springs)
    return lambda x: jnp.sum(k * jnp.sum((W @ (x - X)) ** 2, axis=1)) / 2


def cable_stretch(robot: Robot, cable: Cable) -> Callable[[jax.Array, jax.Array], jax.Array]:
    """Stretch [m] of a cable at positions and contractions."""
    X = robot.body.mesh.nodes
    winch = [winch.name for winch in robot.winches].index(cable.winch)
    W = np.zeros((len(cable.points), len(X)))
    fixed = np.zeros((len(cable.points), X.shape[1]))
    for place, point in enumerate(cable.points):
        if place == 0 and robot.winches[winch].mount is Mount.WORLD:
            fixed[place] = point
        else:
            W[place] = weights(robot, point)
    counts = [not any(i <= s < j for i, j in cable.sheathed) for s in range(len(cable.points) - 1)]
    rest = np.linalg.norm(np.diff(np.array(cable.points), axis=0), axis=1)

    def length(x: jax.Array | np.ndarray) -> jax.Array:
        spans = jnp.diff(W @ x + fixed, axis=0)
        return jnp.sum(jnp.where(np.array(counts), jnp.sqrt(jnp.sum(spans**2, axis=1) + (1e-3 * rest) ** 2), 0.0))

    return lambda x, a: length(x) - length(X) + a[winch] - cable.slack


def spring(elongation: jax.Array, k: float, eps: float) -> jax.Array:
    """Energy of a cable [J]: the tension 0, then a parabola, then a line, integrated."""
    parabola = k * elongation**3 / (12 * eps)
    line = k / 2 * (elongation - eps) ** 2 + k * eps**2 / 6
    return jnp.where(elongation <= 0, 0.0, jnp.where(elongation <= 2 * eps, parabola, line))


@dataclass(frozen=True)
class Answer:
    """What the oracle finds: nodes [m], tensions [N], d nodes / d contractions, and its own residual [N]."""

    nodes: np.ndarray
    tensions: np.ndarray
    jacobian: np.ndarray
    residual: float


@cache
def oracle(name: str) -> Answer:
    """Least energy by a trust region with dense Hessians, then Newton; derivatives by implicit differentiation."""
    robot, contractions = CASES[name][0](), jnp.array(CASES[name][1])
    shape = robot.body.mesh.nodes.shape
    body, pins = body_energy(robot), pin_energy(robot)
    elongations = [cable_stretch(robot, cable) for cable in robot.cables]

    def energy(flat: jax.Array, a: jax.Array) -> jax.Array:
        x = flat.reshape(shape)
        cables = zip(robot.cables, elongations, strict=True)
        return body(x) + pins(x) + sum(spring(s(x, a), cable.stiffness, cable.smoothing) for cable, s in cables)

    def pulls(flat: jax.Array, a: jax.Array) -> jax.Array:
        cables = zip(robot.cables, elongations, strict=True)
        slope = jax.grad(spring)
        return jnp.array([slope(s(flat.reshape(shape), a), cable.stiffness, cable.smoothing) for cable, s in cables])

    value_and_slope = jax.jit(jax.value_and_grad(energy))
    curvatures = jax.jit(jax.jacfwd(jax.grad(energy), argnums=(0, 1)))
    rough = minimize(
        lambda flat: tuple(map(np.array, value_and_slope(flat, contractions))),
        robot.body.mesh.nodes.ravel(),
        jac=True,
        hess=lambda flat: np.array(curvatures(flat, contractions)[0]),
        method="trust-exact",
        options={"gtol": 1e-6},
    )
    flat = rough.x
    for _ in range(3):
        flat = flat - np.linalg.solve(curvatures(flat, contractions)[0], value_and_slope(flat, contractions)[1])
    hessian, mixed = map(np.array, curvatures(flat, contractions))
    assert np.linalg.eigvalsh(hessian).min() > 0
    return Answer(
        nodes=flat.reshape(shape),
        tensions=np.array(jax.jit(pulls)(flat, contractions)),
        jacobian=-np.linalg.solve(hessian, mixed).reshape(*shape, -1),
        residual=float(np.linalg.norm(value_and_slope(flat, contractions)[1])),
    )


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
