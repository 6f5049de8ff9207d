"""From the parts of a robot to the energies of its physics."""

from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.mechanics import (
    CableEnergy,
    Energy,
    FrictionCableEnergy,
    NeoHookean,
    PinEnergy,
    RoundOff,
    TensionLaw,
    Warp,
    WeightEnergy,
)
from hydrostat.mechanics.patch_volume import PatchVolume
from hydrostat.mechanics.patches import PATCH_SIZE, grow_patches
from hydrostat.robot import Robot, Volume
from hydrostat.simulation.turns import cable_segments, cable_turns


def body_energies(robot: Robot) -> tuple[NeoHookean, PinEnergy, *tuple[Energy, ...]]:
    """The elastic body, the pins that hold it; then its volume in patches and its weight, if it has these."""
    others: list[Energy] = []
    if robot.body.volume is Volume.PATCH:
        others.append(_patch_volume(robot))
    if robot.gravity is not None:
        others.append(_weight(robot))
    return elastic_energy(robot), pin_energy(robot), *others


def cable_energy(robot: Robot) -> CableEnergy:
    """All cables, in their order, as if they had no friction; the control of each is the index of its winch."""
    return CableEnergy(robot.body.mesh.nodes, **_runs(robot))


def friction_energy(robot: Robot) -> FrictionCableEnergy | None:
    """All cables as they rub, in place of `cable_energy`; None if none of them does."""
    friction = np.array([cable.friction for cable in robot.cables])
    if not friction.any():
        return None
    return FrictionCableEnergy(robot.body.mesh.nodes, **_runs(robot), friction=friction, turns=cable_turns(robot))


def warp(robot: Robot, body: NeoHookean, pins: PinEnergy) -> Warp:
    """Steps along arcs for the body of a robot."""
    return Warp(
        stencils=body.stencils,
        shape_gradients=body.shape_gradients,
        volumes=body.volumes,
        rest=robot.body.mesh.nodes,
        held=pins.stencils,
        holds=pins.weights,
    )


def round_off(robot: Robot) -> RoundOff:
    """What the rounding errors of the body's own forces, of pins and of cables hide."""
    body = robot.body
    mu, lame = body.material.lame
    scale = (2 * mu + lame) * float(body.mesh.volumes.sum()) * (body.thickness or 1.0)
    reach = max(float(np.abs(body.mesh.nodes).max()), body.mesh.size)
    springs = max((part.stiffness for part in (*robot.pins, *robot.cables)), default=0.0)
    force = 1e-14 * scale / body.mesh.size * (reach / body.mesh.size) + 2e-16 * springs * reach
    return RoundOff(force=force, energy=1e-15 * scale)


def node_masses(robot: Robot) -> np.ndarray:
    """Mass of each node [kg], (nodes,): each element shares its own evenly among its corners."""
    body = robot.body
    masses = body.material.density * (body.thickness or 1.0) * body.mesh.volumes
    elements = body.mesh.elements
    shares = np.repeat(masses / elements.shape[1], elements.shape[1])
    return np.bincount(elements.ravel(), shares, len(body.mesh.nodes))


def elastic_energy(robot: Robot) -> NeoHookean:
    """The elastic body, without what resists a change of its volume if that is measured in patches."""
    body = robot.body
    mu, lame = body.material.lame
    if body.volume is Volume.PATCH:
        lame = 0.0
    return NeoHookean(body.mesh.nodes, body.mesh.elements, mu=mu, lame=lame, thickness=body.thickness or 1.0)


def _patch_volume(robot: Robot) -> PatchVolume:
    mesh, thickness = robot.body.mesh, robot.body.thickness or 1.0
    patches = grow_patches(mesh.elements, PATCH_SIZE[mesh.dim])
    return PatchVolume(mesh.nodes, mesh.elements, patches, lame=robot.body.material.lame[1], thickness=thickness)


def pin_energy(robot: Robot) -> PinEnergy:
    """The pins, each at the points that it holds.

    Raises:
        InputError: a part of the mesh that no pin holds.
    """
    nodes = robot.body.mesh.nodes
    anchors = [pin.anchors(robot.body.mesh) for pin in robot.pins]
    parts = robot.body.mesh.parts
    loose = np.setdiff1d(parts, [parts[node] for held in anchors for node in held.stencils[:, 0]])
    if loose.size:
        raise InputError(
            f"body: {loose.size} of the {parts.max() + 1} parts of the mesh are held by no pin, the first has "
            f"{int((parts == loose[0]).sum())} nodes; join them to the rest (merge nodes at one place) or pin them"
        )
    return PinEnergy(
        stencils=np.concatenate([held.stencils for held in anchors]),
        weights=np.concatenate([held.weights for held in anchors]),
        targets=np.concatenate([held.positions(nodes) for held in anchors]),
        stiffness=np.concatenate(
            [
                np.full(len(held.stencils), pin.stiffness / len(held.stencils))
                for pin, held in zip(robot.pins, anchors, strict=True)
            ]
        ),
    )


def _weight(robot: Robot) -> WeightEnergy:
    return WeightEnergy(robot.body.mesh.nodes, node_masses(robot)[:, None] * np.array(robot.gravity))


def _runs(robot: Robot) -> dict[str, Any]:
    """Arguments of a `CableEnergy` but for the nodes."""
    order = {winch.name: index for index, winch in enumerate(robot.winches)}
    cables = robot.cables
    segments = [tuple(part[cable.bare] for part in cable_segments(robot, cable)) for cable in cables]
    corners, dim = 2 * robot.body.mesh.dim + 2, robot.body.mesh.dim
    return {
        "stencils": np.concatenate([np.zeros((0, corners), dtype=np.int64), *(own[0] for own in segments)]),
        "weights": np.concatenate([np.zeros((0, corners)), *(own[1] for own in segments)]),
        "offsets": np.concatenate([np.zeros((0, dim)), *(own[2] for own in segments)]),
        "cables": np.repeat(np.arange(len(cables)), [len(own[0]) for own in segments]),
        "law": TensionLaw(
            stiffness=np.array([cable.stiffness for cable in cables]),
            smoothing=np.array([cable.smoothing for cable in cables]),
        ),
        "winches": np.array([order[cable.winch] for cable in cables], dtype=np.int64),
        "slack": np.array([cable.slack for cable in cables]),
        "ratios": robot.spool_ratios,
    }
