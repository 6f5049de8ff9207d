"""Energies of contact. Oracles: differences (`check_energy`), balance of forces, ipctk's distances, rest."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from touching import DISTANCE, fork_robot

from hydrostat.geometry import DistanceField, Pairs
from hydrostat.kernel import native
from hydrostat.mechanics import (
    Assembly,
    NeoHookean,
    NewtonOptions,
    ObstacleEnergy,
    PinEnergy,
    RoundOff,
    SelfContactEnergy,
    minimize,
)
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.testing import check_energy

IDLE = np.zeros(2)


@cache
def closed(dim: int) -> Equilibrium:
    """The fork with its prongs pulled against each other."""
    return Simulation(fork_robot(dim)).solve({"up": 0.012, "down": 0.01})


def own(dim: int) -> SelfContactEnergy:
    robot = fork_robot(dim)
    return SelfContactEnergy.of(
        robot.body.mesh, distance=DISTANCE, young=robot.body.material.young, thickness=robot.body.thickness
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_derivatives_where_prongs_touch(dim: int) -> None:
    nodes = closed(dim).nodes
    energy = own(dim).with_active_terms(nodes)
    assert energy.value(nodes, IDLE) > 0
    check_energy(energy, nodes, IDLE)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_negative_eigenvalues_are_taken_out(dim: int, share: float) -> None:
    """By those that LAPACK finds, for pairs at random: at corners, on edges and inside triangles."""
    count, corners = 400, dim + 1
    nodes = np.random.default_rng(dim).uniform(-1, 1, (count * corners, dim))
    stencils, edges = np.arange(count * corners).reshape(count, corners), np.arange(count) % 2 * (dim == 3) > 0
    law = stencils, edges, 0.01, np.full(count, 4.0), np.ones(count)
    blocks, found = np.empty((2, count, corners * dim, corners * dim))
    native.barrier_hessian(nodes, *law, 0.0, blocks)
    native.barrier_hessian(nodes, *law, share, found)
    values, axes = np.linalg.eigh(blocks)
    assert (values[:, 0] < 0.0).mean() > 0.9
    expected = blocks - share * (axes * np.minimum(values, 0.0)[:, None, :]) @ axes.swapaxes(1, 2)
    assert (np.abs(found - expected).max(axis=(1, 2)) <= 1e-12 * np.abs(blocks).max(axis=(1, 2))).all()


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_balance(dim: int) -> None:
    """Parts push one another off: no force and no torque on the whole."""
    nodes = closed(dim).nodes
    forces = np.zeros_like(nodes)
    own(dim).with_active_terms(nodes).add_gradient(nodes, IDLE, forces)
    scale = np.abs(forces).sum()
    assert scale > 0.01
    assert np.abs(forces.sum(axis=0)).max() < 1e-12 * scale
    torque = np.einsum("ni,nj->nij", nodes, forces)
    assert np.abs((torque - torque.swapaxes(1, 2)).sum(axis=0)).max() < 1e-9 * np.abs(torque).sum()


@pytest.mark.parametrize("dim", [2, 3])
def test_nothing_is_felt_at_rest(dim: int) -> None:
    """Not even in a slot narrower than the distance, nor between parts of one mesh that lie near."""
    mesh = fork_robot(dim).body.mesh
    energy = SelfContactEnergy.of(mesh, distance=0.05, young=3e4).with_active_terms(mesh.nodes)
    assert energy.watch is not None
    energy = SelfContactEnergy(energy.skin, energy.watch.pairs)
    assert len(energy.stencils) > 100
    assert energy.value(mesh.nodes, IDLE) == 0.0
    assert not energy.gradient(mesh.nodes, IDLE).any()


@pytest.mark.parametrize("dim", [2, 3])
def test_what_is_kept_serves(dim: int) -> None:
    """An energy that has gone along with small moves is the one found anew, to the same forces."""
    nodes, energy = closed(dim).nodes, own(dim).with_active_terms(closed(dim).nodes)
    random = np.random.default_rng(2)
    for _ in range(12):
        nodes = nodes + 1e-4 * random.uniform(-1, 1, nodes.shape)
        energy, fresh = energy.with_active_terms(nodes), own(dim).with_active_terms(nodes)
        forces, anew = np.zeros_like(nodes), np.zeros_like(nodes)
        energy.add_gradient(nodes, IDLE, forces)
        fresh.add_gradient(nodes, IDLE, anew)
        np.testing.assert_allclose(forces, anew, atol=1e-12 * np.abs(anew).max())
        assert energy.value(nodes, IDLE) == pytest.approx(fresh.value(nodes, IDLE), rel=1e-12)


def test_parallel_edges_have_a_hessian() -> None:
    """Two edges side by side, whose nearest points are not certain: the block is the slope of the forces."""
    rest = np.array([[0, 0, 0], [0.01, 0, 0], [0, 0.1, 0], [0.01, 0.1, 0]])
    skin = replace(own(3).skin, rest=rest, areas=np.ones(4))
    pair = SelfContactEnergy(skin, Pairs(np.array([[0, 1, 2, 3]]), np.array([True])))
    for turn in (0.0, 1e-7, 1e-3):
        nodes = np.array([[0, 0, 0], [0.01, 0, 0], [0.001, 4e-4, 0], [0.012, 4e-4, turn]])
        block, slopes, step = pair.hessian(nodes, IDLE)[0], np.empty((12, 12)), 1e-9
        for row, move in enumerate(step * np.eye(12).reshape(12, 4, 3)):
            ahead, behind = (pair.gradient(nodes + sign * move, IDLE).ravel() for sign in (1, -1))
            slopes[row] = (ahead - behind) / (2 * step)
        assert pair.value(nodes, IDLE) > 0
        np.testing.assert_allclose(block, slopes, atol=1e-6 * np.abs(slopes).max())


@pytest.mark.parametrize("kind", ["node and edge", "node and triangle", "edges"])
def test_blocks_to_eight_digits(kind: str) -> None:
    """Pairs in all positions, by differences of sixth order; as exact at the best of some steps as they can be."""
    dim = 2 if kind == "node and edge" else 3
    rest, random = 9.0 * np.eye(dim + 1, dim), np.random.default_rng(3)
    skin = replace(own(dim).skin, rest=rest, areas=np.ones(dim + 1), distance=1.0)
    pair = SelfContactEnergy(skin, Pairs(np.arange(dim + 1)[None], np.array([kind == "edges"])))
    felt = 0
    while felt < 20:
        nodes = random.uniform(-1, 1, (dim + 1, dim))
        if not 0.01 < skin.compute_squared_distances(nodes, pair.pairs)[0] < 0.8:
            continue
        felt += 1
        block, errors = pair.hessian(nodes, IDLE)[0], []
        for step in (3e-3, 1e-3, 3e-4, 1e-4, 3e-5):
            slopes = np.zeros_like(block)
            for row, move in enumerate(step * np.eye(nodes.size).reshape(-1, *nodes.shape)):
                for times, weight in ((1, 45), (2, -9), (3, 1)):
                    ahead, behind = (pair.gradient(nodes + sign * times * move, IDLE).ravel() for sign in (1, -1))
                    slopes[row] += weight * (ahead - behind) / (60 * step)
            errors.append(np.abs(slopes - block).max() / np.abs(block).max())
        assert min(errors) < 1e-8


@pytest.mark.parametrize("dim", [2, 3])
def test_an_obstacle(dim: int) -> None:
    """A ball next to the upper prong, some of which it touches."""
    robot = fork_robot(dim)
    mesh, at = robot.body.mesh, np.array([0.06, 0.0307, 0.011][:dim])
    energy = ObstacleEnergy(
        mesh, DistanceField.sphere(at, 0.01), distance=DISTANCE, young=3e4, thickness=robot.body.thickness
    )
    nodes = mesh.nodes + 1e-4 * np.sin(40 * mesh.nodes)
    assert energy.value(nodes, IDLE) > 0
    check_energy(energy, nodes, IDLE)
    down = np.zeros_like(nodes)
    down[:, 1] = 0.02
    share = energy.largest_step(nodes, down)
    assert 0 < share < 0.05
    assert energy.gap(nodes + share * down) == pytest.approx(0.1 * energy.gap(nodes), rel=0.2)
    assert energy.largest_step(nodes, -down) == 1.0
    assert energy.value(nodes + down, IDLE) == np.inf
    assert energy.shares.sum(axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_samples_stand_for_the_whole_boundary(dim: int) -> None:
    """Their weights are those of an exact rule: the integral of a square over the boundary, by many more points."""
    mesh = fork_robot(dim).body.mesh
    energy = ObstacleEnergy(mesh, DistanceField.sphere(np.ones(dim), 0.1), distance=1.0, young=4.329)
    squares = (energy.places(mesh.nodes) ** 2).sum(axis=1)
    corners = mesh.nodes[mesh.boundary]
    if dim == 2:
        areas = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    else:
        areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    outer = (corners**2).sum(axis=(1, 2)) + (corners.sum(axis=1) ** 2).sum(axis=1)
    wanted = (areas * outer).sum() / (dim * (dim + 1))
    assert energy.weights @ squares == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_block_pressed_against_a_plane(dim: int) -> None:
    """Without lateral contraction a Neo-Hookean block is strained evenly: its pressure is mu (1/l - l) everywhere."""
    mesh = box_mesh((3, 2, 2), size=(0.03, 0.02, 0.02)) if dim == 3 else strip_mesh(3, 2, size=(0.03, 0.02))
    rest, length, mu, depth = mesh.nodes, 0.03, 1e4, 0.01 if dim == 2 else 1.0
    held = np.flatnonzero(rest[:, 0] < 1e-9)
    pin = PinEnergy(
        stencils=held[:, None], weights=np.ones((len(held), 1)), targets=rest[held], stiffness=np.full(len(held), 1e7)
    )
    far, back = np.eye(dim)[0] * (length + 1e-4), -np.eye(dim)[0]
    wall = ObstacleEnergy(
        mesh, DistanceField.plane(far, back), distance=1e-4, young=3e4, thickness=depth if dim == 2 else None
    )
    body = NeoHookean(rest, mesh.elements, mu=mu, lame=0.0, thickness=depth)
    pushed = pin.with_supports_moved(np.tile(0.004 * np.eye(dim)[0], (len(held), 1)))
    whole = Assembly([body, pushed, wall], rest=rest, control_count=0)
    found = minimize(whole, rest, np.zeros(0), round_off=RoundOff(force=1e-9, energy=1e-15), options=NewtonOptions())
    assert found.converged
    forces = np.zeros_like(rest)
    wall.add_gradient(found.nodes, np.zeros(0), forces)
    ends = [found.nodes[rest[:, 0] == end, 0] for end in (rest[:, 0].min(), rest[:, 0].max())]
    assert np.ptp(ends[1]) < 1e-5  # nodes of the rim stand for some of the sides too
    stretch = (ends[1].mean() - ends[0].mean()) / length
    assert stretch < 0.88
    assert forces[:, 0].sum() == pytest.approx(
        0.02 * (0.02 if dim == 3 else depth) * mu * (1 / stretch - stretch), rel=1e-3
    )
    assert 0.5e-4 < wall.gap(found.nodes) < 1e-4


@pytest.mark.parametrize("dim", [2, 3])
def test_gaps_by_differences(dim: int) -> None:
    """Derivatives of each gap by central differences."""
    nodes = closed(dim).nodes
    energy = own(dim).with_active_terms(nodes)
    gaps = energy.gaps(nodes)
    assert gaps is not None
    move = np.random.default_rng(dim).standard_normal(nodes.shape)
    step = 1e-6 * DISTANCE
    ahead, behind = energy.gaps(nodes + step * move), energy.gaps(nodes - step * move)
    assert ahead is not None
    assert behind is not None
    expected = (ahead.widths - behind.widths) / (2 * step)
    slopes = np.einsum("pci,pci->p", gaps.normals, move[gaps.stencils])
    assert slopes == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_no_gaps_without_pairs() -> None:
    assert own(2).gaps(fork_robot(2).body.mesh.nodes) is None
