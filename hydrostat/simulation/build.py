"""From the parts of a robot to the energies of its physics."""

import numpy as np

from hydrostat.geometry.anchors import locate
from hydrostat.mechanics import CableEnergy, Energy, NeoHookean, PinEnergy, RoundOff, TensionLaw
from hydrostat.robot import Cable, Mount, Robot


def body_energies(robot: Robot) -> list[Energy]:
    """The elastic body and the pins that hold it."""
    return [_body(robot), _pins(robot)]


def cable_energies(robot: Robot) -> list[CableEnergy]:
    """One energy for each cable, in their order; the control is the index of its winch."""
    order = {winch.name: index for index, winch in enumerate(robot.winches)}
    return [_cable(robot, cable, order[cable.winch]) for cable in robot.cables]


def round_off(robot: Robot) -> RoundOff:
    """What the rounding errors of the body's own forces hide."""
    body = robot.body
    mu, lame = body.material.lame
    scale = (2 * mu + lame) * float(body.mesh.volumes.sum()) * (body.thickness or 1.0)
    springs = max((pin.stiffness for pin in robot.pins), default=0.0) * body.mesh.size
    return RoundOff(force=1e-13 * scale / body.mesh.size + 2e-16 * springs, energy=1e-15 * scale)


def _body(robot: Robot) -> NeoHookean:
    body = robot.body
    mu, lame = body.material.lame
    return NeoHookean(body.mesh.nodes, body.mesh.elements, mu=mu, lame=lame, thickness=body.thickness or 1.0)


def _pins(robot: Robot) -> PinEnergy:
    nodes = robot.body.mesh.nodes
    anchors = [pin.anchors(robot.body.mesh) for pin in robot.pins]
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


def _cable(robot: Robot, cable: Cable, control: int) -> CableEnergy:
    mesh = robot.body.mesh
    points = np.array(cable.points)
    fixed = np.zeros(len(points), dtype=bool)
    fixed[0] = robot.winch(cable.winch).mount is Mount.WORLD
    anchors = locate(mesh, points[~fixed])
    stencil, places = np.unique(anchors.stencils, return_inverse=True)
    rows = np.repeat(np.flatnonzero(~fixed), anchors.weights.shape[1])
    weights = np.zeros((len(points), len(stencil)))
    np.add.at(weights, (rows, places.ravel()), anchors.weights.ravel())
    return CableEnergy(
        mesh.nodes,
        stencil=stencil,
        weights=weights,
        offsets=np.where(fixed[:, None], points, 0.0),
        bare=cable.bare,
        law=TensionLaw(stiffness=cable.stiffness, smoothing=cable.smoothing),
        control=control,
        slack=cable.slack,
    )
