"""Finite flexure of a beam by a cable inside it: the reference for the beam test, a problem in one dimension.

Derivation. A strip of height H, -H/2 <= Y <= H/2, plane strain, thickness b, is bent to a ring sector: the section at X
turns by theta = kappa X, and a point goes to the radius r(Y) from the center of bending. The principal elongations are

    lambda_1 = kappa r(Y)   along the beam,        lambda_2 = r'(Y)   across it.

The cable runs along Y = c through very many via points, hence follows the material line: a unit of its rest length has
become kappa r(c) long. It is frictionless, so its tension T is the same everywhere, and for a given T it adds
T kappa r(c) to the potential per unit of rest length:

    Pi(r, kappa) = b Integral Psi(lambda_1, lambda_2) dY + T kappa r(c).

All cross sections are alike; this holds away from the ends, whose effect dies out over about one height. Stationary in
r, with P_i = dPsi / d lambda_i:

    P_2' = kappa P_1,     P_2 = 0 at both faces,     P_2 jumps by T kappa / b at Y = c     (the cable presses inward),

and stationary in kappa:

    b Integral P_1 r dY + T r(c) = 0.

The first gives the axial force at once: b Integral P_1 dY = -T; the second is the moment about the center of bending.
So the beam carries exactly the thrust -T along the cable, and the moment may be taken about any point: about the line
of radius 1 / kappa, which is as long as at rest, nothing cancels where the bending is small. The state (rho = r - 1 /
kappa, s = r', M = Integral P_1 rho) obeys ordinary equations, as P_2' = (dP_2/d lambda_2) s' + (dP_2/d lambda_1) kappa
s; two unknowns, rho at the lower face and kappa, are shot for, both in units of what linear theory gives. Psi is R22,
for which dP_2/d lambda_1 = lambda / (lambda_1 lambda_2).
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root, root_scalar


def curvature(tension: float, *, height: float, offset: float, thickness: float, mu: float, lame: float) -> float:
    """kappa [1/m] at a tension [N] of a cable at Y = -offset; positive when the beam bends towards the cable."""

    def across(one: float, two: float) -> float:
        return mu * (two - 1 / two) + lame * np.log(one * two) / two

    def slope_at(one: float, stress: float) -> float:
        found = root_scalar(lambda two: across(one, two) - stress, bracket=(0.2, 5.0), xtol=1e-15, rtol=1e-14)
        return float(found.root)

    def equations(_: float, state: np.ndarray, kappa: float) -> list[float]:
        rho, s, _ = state
        one = 1 + kappa * rho
        log = np.log(one * s)
        along = mu * (one - 1 / one) + lame * log / one
        stiffness = mu * (1 + 1 / s**2) + lame * (1 - log) / s**2
        return [s, (kappa * along - lame / (one * s) * kappa * s) / stiffness, along * rho]

    def integrate(start: list[float], span: tuple[float, float], kappa: float) -> np.ndarray:
        return solve_ivp(equations, span, start, args=(kappa,), method="DOP853", rtol=1e-12, atol=1e-18).y[:, -1]

    def misfit(unknowns: np.ndarray) -> list[float]:
        rho, kappa = unknowns[0] * height, unknowns[1] * small
        start = [rho, slope_at(1 + kappa * rho, 0.0), 0.0]
        rho, s, moment = integrate(start, (-height / 2, -offset), kappa)
        one = 1 + kappa * rho
        pulled = tension * rho / thickness
        after = slope_at(one, across(one, s) + tension * kappa / thickness)
        rho, s, total = integrate([rho, after, moment], (-offset, height / 2), kappa)
        bent = modulus * height**2 * small
        return [across(1 + kappa * rho, s) / bent, (total + pulled) / (bent * height)]

    modulus = 4 * mu * (mu + lame) / (2 * mu + lame)
    area, inertia = thickness * height, thickness * height**3 / 12
    small = tension * offset / (modulus * inertia)
    lower = -tension / (modulus * area) / (small * height) - 0.5
    found = root(misfit, [lower, 1.0], tol=1e-13)
    return float(found.x[1]) * small
