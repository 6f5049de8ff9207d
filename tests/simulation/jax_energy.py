"""The energy of a robot in JAX, and its minimum by SciPy: an oracle that shares no code with hydrostat.

It is written afresh from the formulas of docs/theory/mechanics.md, weights of cable points included. Its derivatives
are automatic ones, dense and without a sparse pattern.
"""

import math
import os
from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize

from hydrostat.robot import Cable, Mount, Robot

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)


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


def find_equilibrium(robot: Robot, taken: Sequence[float]) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Least energy by a trust region with dense Hessians, then Newton; derivatives by implicit differentiation.

    Returns nodes [m], tensions [N], d nodes / d contractions, and what is left of the forces [N].
    """
    contractions = jnp.array(taken)
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
    return (
        flat.reshape(shape),
        np.array(jax.jit(pulls)(flat, contractions)),
        -np.linalg.solve(hessian, mixed).reshape(*shape, -1),
        float(np.linalg.norm(value_and_slope(flat, contractions)[1])),
    )
