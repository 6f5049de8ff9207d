"""`cable_sensitivities`: sensitivities of markers and tensions to contraction, slack, spool ratio and route."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.sensitivities.adjoint import by_routes
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, eq=False)
class CableSensitivities:
    """Sensitivities of marker coordinates and tensions: a row for each coordinate, then for each tension.

    Attributes:
        contractions: derivatives by the contraction of each winch [m/m, N/m].
        slack: derivatives by the slack of each cable [m/m, N/m].
        ratios: derivatives by the spool ratio of each cable [m, N].
        points: derivatives by the rest position of each point of each cable, cable after cable, as in
            `Sensitivity.routes`.
        fields: adjoint field of each row: H^-1 times its gradient by the nodes, (rows, nodes, dim).
    """

    contractions: Float[np.ndarray, "rows winches"]
    slack: Float[np.ndarray, "rows cables"]
    ratios: Float[np.ndarray, "rows cables"]
    points: Float[np.ndarray, "rows points dim"]
    fields: Float[np.ndarray, "rows nodes dim"]


def cable_sensitivities(
    simulation: Simulation, pose: Equilibrium, markers: list[int], *, tensions: bool = True
) -> CableSensitivities:
    """Derivatives of some markers and of all tensions at an equilibrium, by one adjoint solve for all rows.

    Args:
        simulation: simulation of the robot; cables with friction slip on or stick as for `Simulation.jacobian`.
        pose: an equilibrium of it.
        markers: numbers of the markers asked for.
        tensions: False for rows of markers alone.

    Raises:
        NotConvergedError: the Hessian is singular there: the pose is about to snap.
    """
    robot, cables = simulation.robot, simulation.cables
    nodes, dim = pose.nodes, robot.body.mesh.dim
    elongations = cables.elongations(nodes, pose.contractions)
    tangents, pulls = cables.law.tangent(elongations), cables.law.tension(elongations)
    columns = cables.columns(nodes)
    rows = np.zeros((len(markers) * dim + tensions * len(tangents), nodes.size))
    anchors = simulation.marker_anchors
    for count, marker in enumerate(markers):
        for axis in range(dim):
            rows[count * dim + axis, anchors.stencils[marker] * dim + axis] = anchors.weights[marker]
    own = np.zeros((len(rows), len(tangents)))
    own[len(markers) * dim :] = np.eye(len(tangents))[: tensions * len(tangents)]
    if simulation.friction is not None:
        found = simulation.friction_sensitivities(pose, (rows, own))
        return CableSensitivities(found.contractions, found.slack, found.ratios, found.points, found.fields)
    rows += (own * tangents) @ columns.T
    fields = simulation.response(pose, rows.T).T
    by_elongation = tangents * (own - fields @ columns)
    by_winch = np.zeros((len(tangents), len(robot.winches)))
    by_winch[np.arange(len(tangents)), cables.winches] = cables.ratios
    shaped = fields.reshape(len(rows), *nodes.shape)
    return CableSensitivities(
        contractions=by_elongation @ by_winch,
        slack=-by_elongation,
        ratios=by_elongation * pose.contractions[cables.winches],
        points=by_routes(simulation.route_points, cables, nodes, shaped, by_elongation, pulls),
        fields=shaped,
    )
