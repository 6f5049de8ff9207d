"""Poses against a second program: the same energy, coded afresh in plain loops and minimized by SciPy.

Like hydrostat it rounds off the length of a segment near 0. Its gradient is the complex step of its value, exact to the
last digit; no formula is shared with hydrostat.
"""

import numpy as np
import pytest
from builders import strip_mesh, strip_robot
from scipy.optimize import minimize, root

from hydrostat.robot import Mount, Robot
from hydrostat.simulation import Simulation

CONTRACTIONS = np.array([0.025, 0.006])


def energy(robot: Robot, flat: np.ndarray, contractions: np.ndarray) -> complex:
    """Potential energy at complex positions."""
    x, X = flat.reshape(-1, 2), robot.body.mesh.nodes
    young, poisson = robot.body.material.young, robot.body.material.poisson
    mu, lam = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
    total = 0j
    for a, b, c in robot.body.mesh.elements:
        rest = np.array([[X[b, 0] - X[a, 0], X[c, 0] - X[a, 0]], [X[b, 1] - X[a, 1], X[c, 1] - X[a, 1]]])
        now = np.array([[x[b, 0] - x[a, 0], x[c, 0] - x[a, 0]], [x[b, 1] - x[a, 1], x[c, 1] - x[a, 1]]])
        size = rest[0, 0] * rest[1, 1] - rest[0, 1] * rest[1, 0]
        F = now @ np.array([[rest[1, 1], -rest[0, 1]], [-rest[1, 0], rest[0, 0]]]) / size
        J = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
        if J.real <= 0:
            return complex(np.inf)
        density = mu / 2 * ((F * F).sum() - 2) - mu * np.log(J) + lam / 2 * np.log(J) ** 2
        total += size / 2 * (robot.body.thickness or 0.0) * density
    held = [node for node in range(len(X)) if abs(X[node, 0]) < 1e-3]
    for node in held:
        total += 0.5 * robot.pins[0].stiffness / len(held) * ((x[node] - X[node]) ** 2).sum()
    names = [winch.name for winch in robot.winches]
    for cable in robot.cables:
        elongation = contractions[names.index(cable.winch)] - cable.slack
        world = robot.winch(cable.winch).mount is Mount.WORLD
        places = [
            np.array(point, dtype=complex) if world and index == 0 else follow(robot, np.array(point), x)
            for index, point in enumerate(cable.points)
        ]
        for i in range(len(places) - 1):
            if not any(start <= i < end for start, end in cable.sheathed):
                span = places[i + 1] - places[i]
                rest = float(np.linalg.norm(np.subtract(cable.points[i + 1], cable.points[i])))
                rounding = (1e-3 * rest) ** 2
                elongation += np.sqrt((span * span).sum() + rounding) - np.sqrt(rest**2 + rounding)
        k, eps = cable.stiffness, cable.smoothing
        if elongation.real > 2 * eps:
            total += k / 2 * (elongation - eps) ** 2 + k * eps**2 / 6
        elif elongation.real > 0:
            total += k * elongation**3 / (12 * eps)
    return total


def follow(robot: Robot, point: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Where a material point is: barycentric coordinates from areas, in the first triangle that holds it."""
    X = robot.body.mesh.nodes

    def area(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    for a, b, c in robot.body.mesh.elements:
        whole = area(X[a], X[b], X[c])
        parts = [area(point, X[b], X[c]) / whole, area(X[a], point, X[c]) / whole, area(X[a], X[b], point) / whole]
        if min(parts) > -1e-12:
            return parts[0] * x[a] + parts[1] * x[b] + parts[2] * x[c]
    raise AssertionError("the point is outside")


def equilibrium(robot: Robot, contractions: np.ndarray) -> np.ndarray:
    """Least energy by BFGS, then its gradient brought to zero by MINPACK."""
    rest = robot.body.mesh.nodes.ravel()

    def gradient(flat: np.ndarray) -> np.ndarray:
        steps = 1e-30j * np.eye(len(flat))
        return np.array([energy(robot, flat + step, contractions).imag / 1e-30 for step in steps])

    rough = minimize(
        lambda flat: energy(robot, flat + 0j, contractions).real,
        rest,
        jac=gradient,
        method="BFGS",
        options={"gtol": 1e-4},
    )
    exact = root(gradient, rough.x, method="hybr", options={"xtol": 1e-13})
    assert np.abs(gradient(exact.x)).max() < 1e-9
    assert energy(robot, exact.x + 0j, contractions).real <= rough.fun + 1e-12
    return exact.x.reshape(-1, 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [{}, {"mount": Mount.WORLD}, {"sheathed": ((1, 3),), "slack": 0.004}],
    ids=["plain", "world", "sheath and slack"],
)
def test_the_pose_is_that_of_a_second_program(options: dict) -> None:
    """Node positions agree to 1e-7 of the body's size."""
    robot = strip_robot(columns=4, rows=1, **options)
    pose = Simulation(robot).solve(CONTRACTIONS)
    expected = equilibrium(robot, CONTRACTIONS)
    moved = np.abs(expected - robot.body.mesh.nodes).max()
    assert moved > 0.01 * robot.body.mesh.size
    assert np.abs(pose.nodes - expected).max() < 1e-7 * robot.body.mesh.size
    assert pose.energy == pytest.approx(energy(robot, expected.ravel() + 0j, CONTRACTIONS).real, rel=1e-9)


def test_the_second_program_sees_a_force() -> None:
    """The check can fail: at 1 % more contraction the poses differ by far more than is allowed."""
    robot = strip_robot(columns=4, rows=1)
    one, two = (Simulation(robot).solve(CONTRACTIONS * share) for share in (1.0, 1.01))
    assert np.abs(one.nodes - two.nodes).max() > 1e-4 * strip_mesh(1, 1).size
