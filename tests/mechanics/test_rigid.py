"""Rigid objects that move, and friction along them. Oracles: differences (`check_energy`), rotations, force balance."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh

from hydrostat.geometry import DistanceField, Mesh
from hydrostat.mechanics import ObstacleEnergy
from hydrostat.mechanics.rigid import GuideEnergy, RigidBodyDofs, RigidBodyWarp, RigidEnergy
from hydrostat.testing import check_energy

IDLE = np.zeros(1)


def meshes(dim: int) -> Mesh:
    return strip_mesh(4, 2) if dim == 2 else box_mesh((3, 2, 2))


def scene(dim: int, *, up: float = 0.0) -> tuple[Mesh, RigidBodyDofs, np.ndarray]:
    """A body, and an object that leans on the middle of its upper side, turned and a little strained."""
    mesh, random = meshes(dim), np.random.default_rng(0)
    carriage = RigidBodyDofs(len(mesh.nodes), 0.03, dim)
    at = mesh.nodes.mean(axis=0)
    at[1] = mesh.nodes[:, 1].max() + 0.0205 + up
    axes = np.linalg.qr(np.eye(dim) + 0.2 * random.normal(size=(dim, dim)))[0]
    moved = mesh.nodes + 1e-3 * random.normal(size=mesh.nodes.shape)
    return mesh, carriage, np.vstack([moved, carriage.unknowns(at, axes)])


def shapes(dim: int) -> dict[str, tuple[DistanceField, float]]:
    corner = np.full(dim, 0.02)
    return {
        "sphere": (DistanceField.sphere(np.zeros(dim), 0.02), 0.0),
        "box": (DistanceField.box(-corner, corner), 3e-3),
    }


def met(dim: int, shape: str, friction: float) -> tuple[ObstacleEnergy, np.ndarray]:
    """Energy of an object that moves, and unknowns at which it is felt."""
    field, up = shapes(dim)[shape]
    mesh, carriage, unknowns = scene(dim, up=up)
    thickness = 0.03 if dim == 2 else None
    energy = ObstacleEnergy(
        mesh, field, distance=6e-3, young=3e4, thickness=thickness, friction=friction, carriage=carriage
    )
    return energy.with_friction_at_rest(unknowns), unknowns


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_derivatives_by_nodes_place_and_axes(dim: int, shape: str) -> None:
    energy, unknowns = met(dim, shape, 0.0)
    assert energy.value(unknowns, IDLE) > 0
    check_energy(energy, unknowns, IDLE)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("way", [1e-5, 3e-3])
def test_derivatives_where_it_sticks_and_where_it_slips(dim: int, way: float) -> None:
    energy, unknowns = met(dim, "box", 0.5)
    anchors = energy.history + way * np.random.default_rng(1).normal(size=energy.history.shape)
    energy = energy.with_history(anchors, unknowns, IDLE)
    assert energy.grip is not None
    slips = energy.grip.slipping(energy.places(unknowns))[energy.grip.limits > 0]
    assert slips.any() == (way > 1e-4)
    check_energy(energy, unknowns, IDLE)


@pytest.mark.parametrize("dim", [2, 3])
def test_what_keeps_it_rigid_and_what_guides_it(dim: int) -> None:
    _, carriage, unknowns = scene(dim)
    strained = unknowns + 1e-3 * np.random.default_rng(2).normal(size=unknowns.shape)
    check_energy(RigidEnergy(carriage, 100.0), strained, IDLE)
    along = np.diag(np.arange(dim) + 1.0)
    guide = GuideEnergy(carriage, place=carriage.place(unknowns) + 0.01, axes=np.eye(dim), along=along, turning=3.0)
    check_energy(guide, strained, IDLE)
    assert guide.pull(unknowns) == pytest.approx(0.01 * np.diag(along))


@pytest.mark.parametrize("dim", [2, 3])
def test_body_and_object_push_each_other_equally(dim: int) -> None:
    energy, unknowns = met(dim, "box", 0.5)
    energy = energy.with_history(energy.history + 1e-3, unknowns, IDLE)
    forces = np.zeros_like(unknowns)
    energy.add_gradient(unknowns, IDLE, forces)
    row = energy.stencils[0, -1 - dim]
    assert -forces[row] == pytest.approx(energy.push(unknowns), rel=1e-12)
    assert -forces[:row].sum(axis=0) == pytest.approx(-energy.push(unknowns), rel=1e-12)
    assert np.abs(energy.push(unknowns)).max() > 0.01


@pytest.mark.parametrize("dim", [2, 3])
def test_energy_does_not_care_how_both_lie_in_the_world(dim: int) -> None:
    """Turned and moved together, body and object feel the same, friction included."""
    energy, unknowns = met(dim, "box", 0.5)
    energy = energy.with_history(energy.history + 1e-3, unknowns, IDLE)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(dim, dim)))[0]
    moved, row = unknowns @ turn.T, energy.stencils[0, -1 - dim]
    moved[: row + 1] += 0.3
    assert energy.value(moved, IDLE) == pytest.approx(energy.value(unknowns, IDLE), rel=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_axes_follow_a_turn_and_stay_a_rotation(dim: int) -> None:
    """Half a turn in one step: the step begins as asked, and ends without strain."""
    _, carriage, unknowns = scene(dim)
    warp = RigidBodyWarp(lambda nodes, step: nodes + step, carriage.row, (carriage,))
    spin = np.zeros((dim, dim))
    spin[0, 1], spin[1, 0] = -np.pi / 2, np.pi / 2
    step = np.zeros_like(unknowns)
    step[carriage.rows[1:]] = carriage.length * carriage.axes(unknowns) @ spin.T
    there = carriage.axes(warp(unknowns, step))
    assert there @ there.T == pytest.approx(np.eye(dim), abs=1e-12)
    little = (warp(unknowns, 1e-6 * step) - unknowns) / 1e-6
    assert little == pytest.approx(step, abs=1e-6 * np.abs(step).max() + 1e-12)
    turned = carriage.axes(unknowns)
    assert there[:, 0] == pytest.approx(-turned[:, 1] if dim == 2 else there[:, 0], abs=1e-9)
