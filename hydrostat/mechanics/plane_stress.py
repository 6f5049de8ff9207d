"""Plane stress of a flat Neo-Hookean body: it is free to become thicker or thinner.

In place of lambda/2 (ln J)^2, with J the change of area, the energy has the least over the stretch s across of

    mu/2 (s^2 - 1) - mu ln s + lambda/2 (ln J + ln s)^2,

where there is no stress across: mu (s^2 - 1) + lambda (ln J + ln s) = 0. Its derivative by ln J is -mu (s^2 - 1), the
second one 2 s^2 mu lambda / (2 s^2 mu + lambda). `native/elements.hpp` computes them. Plane strain is s = 1.
"""

import numpy as np

from hydrostat.arrays import Float, Vector

Gradients = Float[np.ndarray, "points 2 2"]


def thickening_works(
    mu: Vector, lame: Vector, volumes: Vector, now: Gradients, moved: Gradients
) -> tuple[Vector, Vector]:
    """Return the derivatives by mu and by lambda of the work of each element's pressure along a field.

    Args:
        mu: shear modulus of each element [Pa]; 0 where another energy stands for it.
        lame: Lame's first parameter of each element [Pa].
        volumes: volume of each point of quadrature [m^3], as many of each element, element by element.
        now: deformation gradient at each point.
        moved: gradient of the field there.
    """
    area = np.linalg.det(now)
    along = volumes * np.trace(np.linalg.inv(now) @ moved, axis1=1, axis2=2)  # of a pressure of 1 Pa
    points = len(along) // len(mu)
    own = np.repeat(mu > 0, points)
    mu, lame = np.where(own, np.repeat(mu, points), 1.0), np.repeat(lame, points)
    widened = solve_thickening(area - 1.0, mu, lame)
    s, log = 1.0 + widened, np.log(area) + 0.5 * np.log1p(widened)
    share = own * along / (2 * s * mu + lame)
    by_mu, by_lame = -widened * lame * share, 2 * s * mu * log * share
    return by_mu.reshape(-1, points).sum(axis=1), by_lame.reshape(-1, points).sum(axis=1)


def solve_thickening(change: Vector, mu: Vector, lame: Vector) -> Vector:
    """Return s^2 - 1 without stress across the plane, at a change of area J - 1; by Newton's method from below."""
    log = np.log1p(np.maximum(change, -1.0 + 1e-12))
    least = -1.0 + 1e-15
    found = np.where(log > 0, np.maximum(np.expm1(-2 * log), least), 0.0)  # left of the root of a concave function
    most_steps = 60
    for _ in range(most_steps):
        step = (mu * found + lame * (log + 0.5 * np.log1p(found))) / (mu + 0.5 * lame / (1.0 + found))
        found = np.maximum(found - step, least)
        if (np.abs(step) <= 1e-15 * (1.0 + np.abs(found))).all():
            break
    return found
