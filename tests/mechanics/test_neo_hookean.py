"""The elastic body in the plane (plane strain) and in space. Oracle: closed forms, and invariance."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from loads import Rollers
from scipy.optimize import root, root_scalar
from states import CONTROLS, deform, rough_mesh

from hydrostat.geometry import Mesh
from hydrostat.mechanics import Assembly, DeadLoadEnergy, NeoHookean, NewtonOptions, RoundOff, minimize

MU, LAME, THICKNESS = 11e3, 17e3, 0.03
NONE = np.zeros(CONTROLS)


def body(mesh: Mesh) -> NeoHookean:
    return NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME, thickness=THICKNESS if mesh.dim == 2 else 1.0)


def volume(mesh: Mesh) -> float:
    return float(np.prod(np.ptp(mesh.nodes, axis=0))) * (THICKNESS if mesh.dim == 2 else 1.0)


def block(dim: int) -> Mesh:
    return strip_mesh(3, 2, size=(0.1, 0.05)) if dim == 2 else box_mesh((2, 2, 1), size=(0.1, 0.05, 0.04))


def mean_stress(mesh: Mesh, F: np.ndarray) -> tuple[float, np.ndarray]:
    """Energy density, and the first Piola-Kirchhoff stress from the nodal forces: sum of f (x) X = volume P."""
    energy, nodes = body(mesh), mesh.nodes @ F.T
    total = np.zeros_like(nodes)
    np.add.at(total, energy.stencils, energy.gradient(nodes, NONE))
    return energy.value(nodes, NONE) / volume(mesh), total.T @ mesh.nodes / volume(mesh)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("s", [0.6, 0.99, 1.0, 1.5])
def test_hydrostatic(dim: int, s: float) -> None:
    """F = s I: Psi = mu/2 d (s^2 - 1) - mu d ln s + lambda/2 (d ln s)^2."""
    density, stress = mean_stress(block(dim), s * np.eye(dim))
    log = dim * np.log(s)
    assert density == pytest.approx(MU / 2 * dim * (s**2 - 1) - MU * log + LAME / 2 * log**2, abs=1e-9 * MU)
    assert stress == pytest.approx((MU * (s - 1 / s) + LAME * log / s) * np.eye(dim), abs=1e-9 * MU)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_smallest_volume_ratio_is_that_of_the_element_squeezed_most(dim: int) -> None:
    """Oracle: det F of all elements of a shape sheared and bent at random; swollen alike, none is squeezed."""
    mesh = block(dim)
    nodes = mesh.nodes + 0.002 * np.random.default_rng(0).standard_normal(mesh.nodes.shape)
    found = body(mesh)
    assert found.min_volume_ratio(nodes) == pytest.approx(
        np.linalg.det(found.deformation_gradients(nodes)).min(), rel=1e-9
    )
    assert found.min_volume_ratio(1.1 * mesh.nodes) == 1.0


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("g", [-1.3, 0.2, 2.0])
def test_simple_shear(dim: int, g: float) -> None:
    """F = I + g e1 (x) e2 keeps the volume: Psi = mu g^2 / 2, P = mu (F - F^-T) has P12 = P21 = mu g alone."""
    F = np.eye(dim)
    F[0, 1] = g
    expected = np.zeros((dim, dim))
    expected[0, 1] = expected[1, 0] = MU * g
    density, stress = mean_stress(block(dim), F)
    assert density == pytest.approx(MU * g**2 / 2, rel=1e-9)
    assert stress == pytest.approx(expected, abs=1e-9 * MU)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("stretch", [0.5, 0.9, 1.2, 2.0])
def test_uniaxial(dim: int, stretch: float) -> None:
    """Free sides: t solves mu (t - 1/t) + lambda ln(s t^(d-1)) / t = 0; in the plane the thickness is held."""

    def side(t: float) -> float:
        return MU * (t - 1 / t) + LAME * np.log(stretch * t ** (dim - 1)) / t

    t = float(root_scalar(side, bracket=(0.1, 10), xtol=1e-15).root)
    log = np.log(stretch * t ** (dim - 1))
    expected = np.zeros((dim, dim))
    expected[0, 0] = MU * (stretch - 1 / stretch) + LAME * log / stretch
    _, stress = mean_stress(block(dim), np.diag([stretch] + [t] * (dim - 1)))
    assert stress == pytest.approx(expected, abs=1e-9 * MU)


def end_areas(mesh: Mesh, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the face x = end and the area that belongs to each."""
    facets = mesh.boundary[(np.abs(mesh.nodes[mesh.boundary, 0] - end) < 1e-9).all(axis=1)]
    corners = mesh.nodes[facets][:, :, 1:]
    spans = corners[:, 1:] - corners[:, :1]
    size = np.abs(spans[:, 0, 0]) * THICKNESS if mesh.dim == 2 else 0.5 * np.abs(np.linalg.det(spans))
    areas = np.bincount(facets.ravel(), np.repeat(size / mesh.dim, mesh.dim), len(mesh.nodes))
    return np.flatnonzero(areas), areas[areas > 0]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("traction", [-6e3, 15e3])
def test_a_block_under_an_end_load_takes_its_closed_form(dim: int, traction: float) -> None:
    """Newton's equilibrium of a whole block; linear elements hold the uniform state exactly."""
    mesh = block(dim)
    mesh = Mesh(mesh.nodes - mesh.nodes.min(axis=0), mesh.elements)
    length = float(np.ptp(mesh.nodes[:, 0]))
    (left, left_areas), (right, right_areas) = end_areas(mesh, 0.0), end_areas(mesh, length)
    forces = np.zeros_like(mesh.nodes)
    forces[right, 0] = traction * right_areas
    sides = [np.flatnonzero(mesh.nodes[:, axis] == 0.0) for axis in range(dim)]
    rollers = [Rollers(sides[axis], axis, np.full(len(sides[axis]), 1e4)) for axis in range(1, dim)]
    springs = 1e9 * left_areas
    assembly = Assembly(
        [body(mesh), DeadLoadEnergy(mesh.nodes, forces), Rollers(left, 0, springs), *rollers],
        rest=mesh.nodes,
        control_count=0,
    )
    result = minimize(
        assembly,
        mesh.nodes,
        np.zeros(0),
        round_off=RoundOff(force=0.0, energy=1e-15 * MU * volume(mesh)),
        options=NewtonOptions(tolerance=1e-11),
    )

    def balance(stretches: np.ndarray) -> np.ndarray:
        s, t = stretches
        log = np.log(s * t ** (dim - 1))
        return np.array([MU * (s - 1 / s) + LAME * log / s - traction, MU * (t - 1 / t) + LAME * log / t]) / MU

    s, t = root(balance, [1.1, 0.97], tol=1e-13).x
    expected = mesh.nodes * ([s] + [t] * (dim - 1))
    expected[:, 0] += traction / 1e9
    assert result.converged
    assert result.nodes == pytest.approx(expected, abs=1e-9 * length)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_rigid_motion_changes_no_energy_and_turns_the_forces(dim: int) -> None:
    random = np.random.default_rng(dim)
    mesh = rough_mesh(dim, random)
    energy, nodes = body(mesh), deform(mesh, random)
    turn = np.linalg.qr(random.standard_normal((dim, dim)))[0]
    turn[0] *= np.linalg.det(turn)
    moved = nodes @ turn.T + random.uniform(-1, 1, dim)
    assert energy.value(moved, NONE) == pytest.approx(energy.value(nodes, NONE), rel=1e-11)
    forces = energy.gradient(nodes, NONE)
    assert energy.gradient(moved, NONE) == pytest.approx(forces @ turn.T, abs=1e-10 * np.abs(forces).max())


def test_an_inverted_element_has_infinite_energy() -> None:
    mesh = strip_mesh(1, 1)
    assert body(mesh).value(mesh.nodes * [1, -1], NONE) == np.inf
    assert body(mesh).value(mesh.nodes * [1, 0], NONE) == np.inf
