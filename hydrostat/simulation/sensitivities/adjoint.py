"""`sensitivities`: sensitivities of numbers that depend on a pose to all that the robot is made of, by the adjoint."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import locate
from hydrostat.mechanics import Assembly, CableEnergy, FactorizedHessian
from hydrostat.robot import Material, Robot
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.drive_energies import pin_drives
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.load_energies import driven_loads
from hydrostat.simulation.route_points import RouteGradient, RoutePoints


def response(
    assembly: Assembly,
    stiffness: FactorizedHessian,
    state: tuple[Nodes, Vector],
    forces: Float[np.ndarray, "dofs columns"],
) -> Float[np.ndarray, "dofs columns"]:
    """Solution u [m] of H u = f, by the full Hessian at `state`, to rounding.

    Args:
        assembly: the energies that count there.
        stiffness: the Hessian there, or at a state close by.
        state: nodes [m] and contractions [m].
        forces: force on every degree of freedom [N], a column for each load case.
    """
    body, springs = assembly.hessian(*state), assembly.low_rank_hessian(*state)
    allowed = 1e-11 * np.abs(forces).max(axis=0, initial=0.0)
    rounding = 1e-15 * np.abs(body.data).max(initial=0.0)
    moves = stiffness.solve(forces)
    refinements = 4  # Most steps of iterative refinement with factors of a state close by
    for _ in range(refinements):
        missing = forces - body @ moves - springs.columns @ (springs.weights @ (springs.columns.T @ moves))
        hidden = rounding * np.abs(moves).max(axis=0, initial=0.0)
        if (np.abs(missing).max(axis=0, initial=0.0) <= allowed + hidden).all():
            return moves
        moves += stiffness.solve(missing)
    return assembly.stiffness(*state).solve(forces)


Response = Callable[[Float[np.ndarray, "dofs columns"]], Float[np.ndarray, "dofs columns"]]
"""Solution of H u = forces at the pose."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivity:
    """Sensitivities: derivatives of a scalar L of a pose, in units of L per unit of the parameter.

    Attributes:
        contractions: derivative by each winch's contraction [1/m].
        drives: derivative by the value of each drive [1/rad or 1/m].
        slack: derivative by each cable's slack [1/m].
        routes: derivative by the rest position of each point of each cable [1/m], which changes its position in the
            body and the rest lengths next to it. The first point of a cable of a winch in the world moves in space.
        cable_stiffness: derivative by each cable's stiffness [m/N].
        friction: derivative by the friction coefficient mu of each cable; 0 for cables without friction.
        pin_stiffness: derivative by each pin's stiffness [m/N].
        young: derivative by Young's modulus of the body, with that of rigid parts in proportion [1/Pa].
        poisson: derivative by Poisson's ratio of the body [-].
        density: derivative by the density of the body, through the weight [m^3/kg]; 0 without gravity.
        part_young: derivative by Young's modulus of each part of the body [1/Pa], (parts,); 0 for rigid ones.
        part_poisson: derivative by Poisson's ratio of each part [-], (parts,); 0 for rigid ones.
        part_density: derivative by the density of each part [m^3/kg], (parts,).
        thickness: derivative by the thickness of a flat body [1/m]; None in space.
        loads: derivative by the force of each load along each axis [1/N], (loads, dim); 0 for a pressure or moment.
        moments: derivative by the size of the moment of each load [1/(N m)], (loads,); 0 for other loads.
        gravity: derivative by each component of gravity [s^2/m], (dim,), with hung masses.
        rod_axial: derivative by EA of each rod [1/N], (rods,).
        rod_bending: derivative by EI of each rod [1/(N m^2)], (rods,).
        rod_torsion: derivative by GJ of each rod [1/(N m^2)], (rods,); 0 for one that resists no twist.
        sheet_young: derivative by Young's modulus of each sheet [1/Pa], (sheets,).
    """

    contractions: Vector
    slack: Vector
    routes: tuple[RouteGradient, ...]
    cable_stiffness: Vector
    friction: Vector
    pin_stiffness: Vector
    young: float
    poisson: float
    density: float
    part_young: Vector
    part_poisson: Vector
    part_density: Vector
    thickness: float | None
    loads: Points
    moments: Vector
    gravity: Vector
    rod_axial: Vector
    rod_bending: Vector
    rod_torsion: Vector
    sheet_young: Vector
    drives: Vector = field(default_factory=lambda: np.zeros(0))


def sensitivities(
    body: BodyPhysics,
    assembly: Assembly,
    cables: CableEnergy,
    pose: Equilibrium,
    *,
    rows: tuple[Float[np.ndarray, "rows nodes dim"], Float[np.ndarray, "rows cables"]],
    points: RoutePoints,
    response: Response,
) -> list[Sensitivity]:
    """Sensitivities of some L by the adjoint: H u = dL/dx, then dL/dtheta = -u . d2E/dx dtheta, one solve for all.

    A tension is T(s) with s = l(x) - l(X) + ratio a - slack: what is given by tensions adds dL/dT T' dl/dx to dL/dx,
    and dL/dT dT/dtheta to the sensitivities.

    Args:
        body: body of the robot in the pose.
        assembly: its energies.
        cables: those of its cables.
        pose: an equilibrium.
        rows: dL/dx at fixed tensions, and dL/dT of each cable, of each L, as `cotangents` checks them.
        points: those of its cables.
        response: solves with the full Hessian at the pose.
    """
    assembly = assembly.with_active_terms(pose.nodes)
    elongations = cables.elongations(pose.nodes, pose.controls)
    tangents, pulls = cables.law.tangent(elongations), cables.law.tension(elongations)
    columns = cables.columns(pose.nodes)
    nodes, tensions = rows
    fields = response(nodes.reshape(len(nodes), -1).T + columns @ (tangents * tensions).T).T
    by_controls = -(assembly.control_derivative(pose.nodes, pose.controls).T @ fields.T).T
    np.add.at(by_controls.T, cables.winches, (cables.ratios * tangents * tensions).T)
    by_tension = tensions - fields @ columns
    by_elongation = tangents * by_tension
    fields = fields.reshape(-1, *assembly.shape)
    count = len(pose.contractions)
    return [
        Sensitivity(
            contractions=controls[:count],
            drives=controls[count:],
            slack=-lever,
            routes=points.by_cable(routes),
            cable_stiffness=by_pull * pulls / cables.law.stiffness,
            friction=np.zeros(len(pulls)),
            **of_body,
        )
        for controls, lever, routes, by_pull, of_body in zip(
            by_controls,
            by_elongation,
            by_routes(points, cables, pose.nodes, fields, by_elongation, pulls),
            by_tension,
            by_body(body, pose, fields),
            strict=True,
        )
    ]


def cotangents(
    pose: Equilibrium, shape: tuple[int, ...], cables: int, nodes: Nodes, tensions: Vector | None
) -> tuple[Nodes, Vector]:
    """dL/dx and dL/dT as numbers, for a robot with nodes of this shape and so many cables.

    Raises:
        InputError: no solved pose or one of another robot, or cotangents of a wrong shape or not finite.
    """
    if not isinstance(pose, Equilibrium):
        raise InputError(f"an adjoint needs an Equilibrium, as solve() returns it, not a {type(pose).__name__}")
    if pose.nodes.shape != shape or pose.tensions.shape != (cables,):
        raise InputError(f"the pose is of another robot: its nodes have shape {pose.nodes.shape}, not {shape}")
    return _check_shape("nodes", nodes, shape), _check_shape(
        "tensions", np.zeros(cables) if tensions is None else tensions, (cables,)
    )


def _check_shape(name: str, given: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    try:
        values = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"the cotangent of {name} must be numbers of shape {shape}, not {given!r:.40}") from None
    if values.shape != shape or not np.isfinite(values).all():
        raise InputError(f"the cotangent of {name} must be finite numbers of shape {shape}, not of {values.shape}")
    return values


def by_body(body: BodyPhysics, pose: Equilibrium, fields: Float[np.ndarray, "rows nodes dim"]) -> list[dict[str, Any]]:
    """Sensitivities by materials, thickness and stiffness of pins, by their names in `Sensitivity`, for each field."""
    materials = pose.robot.body.materials
    by_lame = np.array([_lame_derivatives(material) for material in materials])
    rigid = np.array([False, *(part.is_rigid for part in pose.robot.body.parts)])
    stiffness = np.array([material.young for material in materials]) / body.material.young  # what rigid parts keep
    loads = _load_gradients(pose, fields)
    return [
        _by_materials(pose.robot, _parameter_derivatives(body, pose, field), field, (by_lame, rigid, stiffness))
        | _by_pieces(body, pose, field)
        | {"loads": by_load}
        for field, by_load in zip(fields, loads, strict=True)
    ]


def _by_materials(
    robot: Robot, works: dict[str, Vector], field: Nodes, materials: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> dict[str, Any]:
    """Sensitivities by materials, thickness, moments and pins.

    `materials` are derivatives of mu and lambda (materials, young and poisson, mu and lame), those of rigid parts, and
    moduli over that of the body.
    """
    by_lame, rigid, stiffness = materials
    shear, squeeze = (_add(np.zeros(len(by_lame)), works.get(name, np.zeros(0))) for name in ("mu", "lame"))
    young, poisson = -(by_lame[:, :, 0] * shear[:, None] + by_lame[:, :, 1] * squeeze[:, None]).T
    density, thickness = _density_gradient(robot, field), robot.body.thickness
    return {
        "young": float(young[0] + stiffness[rigid] @ young[rigid]),
        "poisson": float(poisson[0]),
        "density": float(density[0]),
        "part_young": np.where(rigid, 0.0, young)[1:],
        "part_poisson": np.where(rigid, 0.0, poisson)[1:],
        "part_density": density[1:],
        "thickness": None if thickness is None else -float(works["thickness"][0]) / thickness,
        "moments": -_add(np.zeros(len(robot.loads)), works.get("moment", np.zeros(0))),
        "pin_stiffness": -works["support_stiffness"],
    }


def _by_pieces(body: BodyPhysics, pose: Equilibrium, field: Nodes) -> dict[str, Any]:
    """Sensitivities by gravity, rods and sheets."""
    rods = np.array([rod.stiffness_work(pose.nodes, field) for rod in body.rods]).reshape(-1, 2)
    twists = [0.0 if twist is None else twist.stiffness_work(pose.nodes, field) for twist in body.twists]
    return {
        "gravity": body.heavy_masses @ field,
        "rod_axial": -rods[:, 0],
        "rod_bending": -rods[:, 1],
        "rod_torsion": -np.array(twists),
        "sheet_young": np.array(
            [
                -sum(energy.stiffness_work(pose.nodes, field) for energy in energies) / sheet.material.young
                for sheet, energies in zip(pose.robot.sheets, body.sheets, strict=True)
            ]
        ),
    }


def _parameter_derivatives(body: BodyPhysics, pose: Equilibrium, field: Nodes) -> dict[str, Vector]:
    """Sums of the works of all energies by names of parameters."""
    found = [energy.parameter_derivative(pose.nodes, field) for energy in body.assembly.energies]
    driven = driven_loads(pose.robot, body.rest_unknowns)
    found += [load.parameter_derivative_at(pose.nodes, field, pose.controls) for load in driven]
    works: dict[str, Vector] = {}
    for name, work in (item for each in found for item in each.items()):
        works[name] = _add(works.get(name, np.zeros(0)), work)
    for moved in pin_drives(pose.robot, body.pins):
        works["support_stiffness"] = works["support_stiffness"] + moved.support_work(field, pose.controls)
    return works


def _add(one: Vector, other: Vector) -> Vector:
    """Sum of vectors, the shorter one filled up with zeros: the last materials may be those of other energies."""
    total = np.zeros(max(len(one), len(other)))
    total[: len(one)] += one
    total[: len(other)] += other
    return total


def _density_gradient(robot: Robot, field: Nodes) -> Vector:
    """Work of gravity along a field, by the density of each material [m^3/kg per unit of the field]."""
    body, count = robot.body, len(robot.body.materials)
    if robot.gravity is None:
        return np.zeros(count)
    along = (field[: len(body.mesh.nodes)] @ np.array(robot.gravity))[body.mesh.elements].mean(axis=1)
    return np.bincount(body.element_materials, (body.thickness or 1.0) * body.mesh.volumes * along, count)


def _lame_derivatives(material: Material) -> tuple[tuple[float, float], tuple[float, float]]:
    """Sensitivities of mu and lambda by Young's modulus, and by Poisson's ratio [Pa]."""
    young, poisson = material.young, material.poisson
    mu, lame = material.lame
    product = (1 + poisson) * (1 - 2 * poisson)
    return (mu / young, lame / young), (-mu / (1 + poisson), young * (1 + 2 * poisson**2) / product**2)


def by_routes(
    points: RoutePoints,
    cables: CableEnergy,
    nodes: Nodes,
    fields: Float[np.ndarray, "rows nodes dim"],
    by_elongation: Float[np.ndarray, "rows cables"],
    pulls: Vector,
    by_rest_length: Float[np.ndarray, "rows cables"] | None = None,
) -> Float[np.ndarray, "rows points dim"]:
    """Sensitivities of some numbers by the rest position of every point of every cable.

    A segment with span d, at rest D, has the length l = sqrt(d^2 + r^2), at rest L, with r in proportion to |D|: all
    of these move, and so does the part of the field along it, q = e . d / l with e the difference of the field between
    its ends. The sensitivity is that of by_elongation (l - L) - T q; by_rest_length stands at L if it is given.
    """
    spans = points.spans(points.positions(nodes))
    rests = points.spans(points.rests)
    moves = points.spans(points.values(fields))
    square = cables.roundings**2
    lengths, rest_lengths = (np.sqrt((part**2).sum(axis=1) + square) for part in (spans, rests))
    units = spans / lengths[:, None]
    along = (moves * units).sum(axis=-1)
    lever, pull = by_elongation[:, cables.cables], pulls[cables.cables]
    held = lever if by_rest_length is None else by_rest_length[:, cables.cables]
    by_span = (lever + pull * along / lengths)[..., None] * units - (pull / lengths)[:, None] * moves
    rounded = square / lengths * (lever + pull * along / lengths)
    tiny = np.finfo(float).tiny
    by_rest = ((rounded - held * rest_lengths) / np.maximum((rests**2).sum(axis=1), tiny))[..., None] * rests
    return (
        points.pulled_back(nodes, points.gather_gradients(by_span))
        + points.held_back(points.gather_gradients(by_rest))
        - points.values_pulled_back(fields, points.gather_gradients(pull[:, None] * units))
    )


def _load_gradients(
    pose: Equilibrium, fields: Float[np.ndarray, "rows nodes dim"]
) -> Float[np.ndarray, "rows loads dim"]:
    """Derivatives by the forces of loads; a pressure or moment is no force at a point, so its row is 0."""
    shares: dict[str | None, float] = dict(zip((drive.name for drive in pose.robot.drives), pose.drives, strict=True))
    anchors = locate(pose.robot.body.mesh, pose.robot.load_points())
    found = np.array([anchors.positions(field[: len(pose.nodes)]) for field in fields])
    found[:, [load.force is None and load.mass is None for load in pose.robot.loads]] = 0.0
    return found * np.array([shares.get(load.drive, 1.0) for load in pose.robot.loads])[:, None]
