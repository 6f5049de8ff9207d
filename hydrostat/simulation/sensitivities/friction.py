"""`friction_sensitivities`: sensitivities of scalars of a pose to all cable parameters, with cable friction."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.mechanics import FactorizedHessian, FrictionCableEnergy
from hydrostat.robot import Robot
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.cable_energies import turn_starts
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.route_points import RoutePoints
from hydrostat.simulation.sensitivities.adjoint import Sensitivity, by_body, by_routes


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionSensitivities:
    """Sensitivities of several scalars with cable friction, a row for each scalar.

    Attributes:
        fields: adjoint field of each scalar, the displacement on which the body forces do work, (rows, nodes, dim).
        contractions: derivatives by the contraction of each winch [1/m].
        slack: derivatives by the slack of each cable [1/m].
        ratios: derivatives by the spool ratio of each cable.
        points: derivatives by the rest position of each point of each cable, cable after cable [1/m].
        stiffness: derivatives by the stiffness of each cable [m/N].
        friction: derivatives by the friction coefficient mu of each cable; 0 for one without friction.
    """

    fields: Float[np.ndarray, "rows nodes dim"]
    contractions: Float[np.ndarray, "rows winches"]
    slack: Float[np.ndarray, "rows cables"]
    ratios: Float[np.ndarray, "rows cables"]
    points: Float[np.ndarray, "rows points dim"]
    stiffness: Float[np.ndarray, "rows cables"]
    friction: Float[np.ndarray, "rows cables"]


def friction_sensitivities(
    robot: Robot,
    points: RoutePoints,
    cables: FrictionCableEnergy,
    stiffness: FactorizedHessian,
    pose: Equilibrium,
    rows: tuple[Float[np.ndarray, "rows dofs"], Float[np.ndarray, "rows cables"]],
) -> FrictionSensitivities:
    """Sensitivities of numbers L while points at the capstan's limit slip on and the others stick, by one adjoint.

    Tensions T of the spans are unknowns beside the nodes: K dx + G dT = -dr and dT = B de + S df, with the elongations
    e, the limits f(T, angles(x), mu), and B and S as in `ChainLaw.compute_slip_jacobians`. docs/theory/derivatives.md.

    Args:
        robot: robot with these cables.
        points: points of the cables.
        cables: energy of the cables in the pose.
        stiffness: the Hessian in the pose.
        pose: an equilibrium.
        rows: dL / d nodes at fixed tensions, and dL / d tensions at the winches.
    """
    nodes, controls = pose.nodes, pose.contractions
    locked = cables.linearize_tensions(nodes, controls)
    spans = cables.spans
    body = stiffness.with_weights(np.zeros_like(stiffness.weights))
    columns, turned = spans.columns(nodes), cables.turn_gradients(nodes)
    by_angle = locked.by_limit * locked.limits_by_angle
    gives = locked.by_elongation @ columns.T + by_angle @ turned.T
    back = body.solve(columns)
    inner = np.eye(len(locked.tensions)) - locked.by_limit @ locked.limits_by_tension + gives @ back
    own = np.zeros((len(rows[0]), len(locked.tensions)))
    own[:, cables.law.starts[:-1]] = rows[1]
    levers = np.linalg.solve(inner.T, (own - rows[0] @ back).T).T
    fields = body.solve((rows[0] + levers @ gives).T).T.reshape(-1, *nodes.shape)
    by_elongation = levers @ locked.by_elongation
    joined = (cables.owners[:, None] == np.arange(len(robot.cables))).astype(float)
    firsts = by_elongation[:, cables.law.starts[:-1]]
    winches = spans.winches[cables.law.starts[:-1]]
    ratios = spans.ratios[cables.law.starts[:-1]]
    by_winch = np.where(winches[:, None] == np.arange(len(robot.winches)), ratios[:, None], 0.0)
    # A span is a spring of a share of its cable: stiffness and smoothing go with the share of the length.
    stretched = by_elongation * locked.stretches
    shares = stretched @ joined / np.maximum(spans.rest_lengths @ joined, np.finfo(float).tiny)
    by_rest = by_elongation + stretched / spans.rest_lengths - shares @ joined.T
    routes = by_routes(points, spans, nodes, fields, by_elongation, locked.tensions, by_rest)
    routes += _by_turns(robot, cables, points, pose, levers @ by_angle)
    softened = by_elongation * locked.tensions / np.maximum(locked.springs, np.finfo(float).tiny)
    whole = np.array([cable.stiffness for cable in robot.cables])
    return FrictionSensitivities(
        fields=fields,
        contractions=firsts @ by_winch,
        slack=-firsts,
        ratios=firsts * controls[winches],
        points=routes,
        stiffness=softened @ joined / whole,
        friction=(levers @ locked.by_limit * locked.limits_by_friction) @ joined,
    )


def friction_adjoints(
    body: BodyPhysics, points: RoutePoints, pose: Equilibrium, found: FrictionSensitivities
) -> list[Sensitivity]:
    """Return the sensitivities of each scalar with cable friction, including those to body parameters."""
    return [
        Sensitivity(
            contractions=found.contractions[row],
            slack=found.slack[row],
            routes=points.by_cable(found.points[row]),
            cable_stiffness=found.stiffness[row],
            friction=found.friction[row],
            **of_body,
        )
        for row, of_body in enumerate(by_body(body, pose, found.fields))
    ]


def _by_turns(
    robot: Robot,
    cables: FrictionCableEnergy,
    points: RoutePoints,
    pose: Equilibrium,
    by_angle: Float[np.ndarray, "rows spans"],
) -> Float[np.ndarray, "rows points dim"]:
    """Sensitivities by the points through the angles by which cables turn."""
    starts, _ = turn_starts(robot)
    sensitivities = cables.turns.derivatives(pose.nodes)
    total = np.zeros((len(points.places), len(by_angle), points.places.shape[1]))
    lever = by_angle[:, cables.turns.points]
    for side, sensitivity in zip(starts, sensitivities, strict=True):
        moved = lever.T[:, :, None] * sensitivity[:, None]
        np.add.at(total, side + 1, moved)
        np.subtract.at(total, side, moved)
    return points.pulled_back(pose.nodes, np.swapaxes(total, 0, 1))
