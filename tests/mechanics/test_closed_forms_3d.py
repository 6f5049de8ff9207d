"""A block in space under uniform states. Oracles: closed forms of the Neo-Hookean solid, roots by scipy's brentq."""

from collections.abc import Callable

import numpy as np
import pytest
from builders import box_mesh
from loads import Rollers, outward_areas
from scipy.optimize import root_scalar

from hydrostat.geometry import Mesh
from hydrostat.mechanics import Assembly, DeadLoadEnergy, NeoHookean, NewtonOptions, NewtonResult, RoundOff, minimize

MU, LAME = 11e3, 17e3
SIDES = (0.1, 0.06, 0.04)
GROUND = 1e10
"""Stiffness of the rollers [Pa/m]: a traction shifts the block by a known hair."""


def block() -> Mesh:
    """Its inner nodes are off the grid, and those of a face within it."""
    mesh = box_mesh((3, 2, 2), size=SIDES)
    shift = 0.005 * np.random.default_rng(0).uniform(-1, 1, mesh.nodes.shape)
    on_side = (mesh.nodes < 1e-12) | (mesh.nodes > np.array(SIDES) - 1e-12)
    return Mesh(mesh.nodes + np.where(on_side, 0.0, shift), mesh.elements)


def piola(F: np.ndarray) -> np.ndarray:
    """P = mu (F - F^-T) + lambda ln J F^-T."""
    inverse = np.linalg.inv(F).T
    return MU * (F - inverse) + LAME * np.log(np.linalg.det(F)) * inverse


SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
GRADIENTS = {
    "simple shear": SHEAR,
    "two shears": SHEAR @ np.array([[1.0, 0.0, 0.0], [0.0, 1.0, -1.1], [0.0, 0.0, 1.0]]),
    "compression": 0.6 * np.eye(3),
    "all at once": np.array([[1.3, 0.4, -0.2], [0.1, 0.8, 0.3], [-0.5, 0.2, 1.1]]),
}


@pytest.mark.parametrize("name", GRADIENTS)
def test_nodal_forces_are_the_traction_on_the_faces(name: str) -> None:
    """P N on the area that belongs to a node; nothing inside."""
    mesh, F = block(), GRADIENTS[name]
    energy = NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME)
    assembly = Assembly([energy], rest=mesh.nodes, control_count=0)
    forces = assembly.gradient(mesh.nodes @ F.T, np.zeros(0)).reshape(-1, 3)
    areas = outward_areas(mesh)
    inside = ((mesh.nodes > 1e-12) & (mesh.nodes < np.array(SIDES) - 1e-12)).all(axis=1)
    assert inside.sum() == 2
    assert np.abs(areas[inside]).max() < 1e-18
    assert forces == pytest.approx(areas @ piola(F).T, abs=1e-11 * np.abs(forces).max())


def root(balance: Callable[[float], float]) -> float:
    return float(root_scalar(balance, method="brentq", bracket=(0.4, 2.5), xtol=1e-15).root)


def equilibrium(tractions: tuple[float, float, float]) -> tuple[Mesh, NewtonResult]:
    """A block on three rollers, each face opposite pulled by its own dead traction [Pa]."""
    mesh = block()
    outward = outward_areas(mesh)
    areas, held = np.maximum(outward, 0.0), np.maximum(-outward, 0.0)
    sides = [np.flatnonzero(held[:, axis]) for axis in range(3)]
    energies = [
        NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME),
        DeadLoadEnergy(mesh.nodes, areas * tractions),
        *[Rollers(sides[axis], axis, GROUND * held[sides[axis], axis]) for axis in range(3)],
    ]
    result = minimize(
        Assembly(energies, rest=mesh.nodes, control_count=0),
        mesh.nodes,
        np.zeros(0),
        round_off=RoundOff(force=0.0, energy=1e-15 * MU * float(np.prod(SIDES))),
        options=NewtonOptions(),
    )
    return mesh, result


@pytest.mark.parametrize("stretch", [0.7, 0.85, 1.2, 2.0])
def test_a_block_pulled_along_one_axis(stretch: float) -> None:
    """The sides are free: t solves mu (t - 1/t) + lambda ln(s t^2) / t = 0. The traction is that of the stretch s."""
    side = root(lambda t: MU * (t - 1 / t) + LAME * np.log(stretch * t**2) / t)
    traction = piola(np.diag([stretch, side, side]))[0, 0]
    shift = [traction / GROUND, 0.0, 0.0]
    mesh, result = equilibrium((traction, 0.0, 0.0))
    assert result.converged
    assert result.stable
    assert result.nodes == pytest.approx(mesh.nodes * [stretch, side, side] + shift, abs=1e-9 * SIDES[0])


@pytest.mark.parametrize("pressure", [-8e3, 5e3, 12e3])
def test_a_block_pressed_from_all_sides(pressure: float) -> None:
    """F = s I, and s solves mu (s - 1/s) + 3 lambda ln s / s = -pressure (dead loads, on the area at rest)."""
    s = root(lambda s: MU * (s - 1 / s) + 3 * LAME * np.log(s) / s + pressure)
    mesh, result = equilibrium((-pressure, -pressure, -pressure))
    assert result.converged
    assert result.stable
    assert result.nodes == pytest.approx(s * mesh.nodes - pressure / GROUND, abs=1e-9 * SIDES[0])
