"""`sample_shard`: the samples of one file, each found from rest."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.geometry import find_crossings
from hydrostat.learning.sample_plan import SamplePlan, SamplingScheme, physics_hash
from hydrostat.mechanics import NewtonStatus
from hydrostat.simulation import Equilibrium, SensorReader, Simulation

REASONS = (*NewtonStatus, "error")
"""Meaning of the numbers in column `reason`."""


def sample_type(plan: SamplePlan) -> np.dtype:
    """Columns of a file of samples, little-endian, SI units.

    Among them are `touches`, whether parts of the body push one another off, and `crosses`, whether it passes through
    itself, which it can only without contact; `sensors` are readings with noise.
    """
    robot, dim = plan.robot, plan.robot.body.mesh.dim
    winches, markers = robot.num_controls, len(robot.markers)
    columns = [
        ("number", "<i8", ()),
        ("draw", "u1", ()),
        ("reason", "u1", ()),
        ("stable", "u1", ()),
        ("touches", "u1", ()),
        ("crosses", "u1", ()),
        ("iterations", "<i4", ()),
        ("energy", "<f8", ()),
        ("contractions", "<f8", (winches,)),
        ("markers", "<f8", (markers, dim)),
        ("jacobian", "<f8", (markers, dim, winches)),
        ("tensions", "<f8", (len(robot.cables),)),
        ("tension_slopes", "<f8", (len(robot.cables), winches)),
    ]
    if robot.sensors:
        columns.append(("sensors", "<f8", (sum(sensor.count_values(dim) for sensor in robot.sensors),)))
    kept = [("nodes", "<f4", robot.body.mesh.nodes.shape)] if plan.nodes else []
    return np.dtype(columns + kept)


def sample_shard(plan: SamplePlan, shard: int) -> np.ndarray:
    """Compute the samples of one file, with the columns of `sample_type`: NaN and the reason where solving failed."""
    simulation, numbers = _simulation(plan), plan.numbers(shard)
    rows = np.zeros(len(numbers), sample_type(plan))
    for row, number, contractions in zip(rows, numbers, plan.contractions(numbers), strict=True):
        draw = plan.draw_of(number)
        row["number"], row["draw"] = number, list(SamplingScheme).index(draw)
        _fill(row, simulation, contractions, plan.tension if draw is SamplingScheme.TENSION else None, plan.seed)
    return rows


def _simulation(plan: SamplePlan) -> Simulation:
    """Physics of the robot, kept by a process from one file to the next."""
    key = physics_hash(plan.robot) + str(plan.robot.contact) + str(plan.robot.sensors)
    if key not in _KEPT:
        _KEPT.clear()
        _KEPT[key] = Simulation(plan.robot)
    return _KEPT[key]


def _fill(row: np.void, simulation: Simulation, contractions: Vector, tension: float | None, seed: int) -> None:
    """Solve one sample; what has no equilibrium is NaN, never an exception that ends all others."""
    columns = row.dtype.names or ()
    for name in columns:
        if row.dtype[name].base.kind == "f":
            row[name] = np.nan
    row["contractions"], row["reason"] = contractions, REASONS.index("error")
    pose = _within(simulation, contractions, tension)
    row["contractions"], row["iterations"] = pose.controls, pose.result.iterations
    row["reason"], row["stable"] = REASONS.index(pose.result.status), pose.result.stable
    if not pose.result.converged:
        return
    anchors = simulation.marker_anchors
    row["energy"], row["tensions"] = pose.energy, pose.tensions
    row["markers"] = anchors.positions(pose.nodes)
    row["touches"], row["crosses"] = _touches(simulation, pose), _crosses(simulation, pose)
    if "sensors" in columns:
        random = np.random.default_rng([seed, int(row["number"])])
        row["sensors"] = SensorReader(simulation).read_vector(pose, random=random)
    if "nodes" in columns:
        row["nodes"] = pose.nodes
    if pose.result.stable:
        moves = simulation.jacobian(pose)
        row["jacobian"] = np.einsum("pc,pcdw->pdw", anchors.weights, moves[anchors.stencils])
        row["tension_slopes"] = _tension_jacobian(simulation, pose, moves)


def _tension_jacobian(simulation: Simulation, pose: Equilibrium, moves: np.ndarray) -> np.ndarray:
    """Compute dT/da, tensions by contractions [N/m], (cables, winches): T' (dl/dx dx/da + ratio); 0 if slack."""
    cables, count = simulation.cables, len(simulation.robot.cables)
    if simulation.friction is not None:
        return simulation.friction_sensitivities(pose, (np.zeros((count, pose.nodes.size)), np.eye(count))).contractions
    longer = cables.columns(pose.nodes).T @ moves.reshape(pose.nodes.size, -1)
    longer[np.arange(count), cables.winches] += cables.ratios
    return cables.law.tangent(cables.elongations(pose.nodes, pose.contractions))[:, None] * longer


def _within(simulation: Simulation, contractions: Vector, tension: float | None) -> Equilibrium:
    """Pose at contractions that are let out, in proportion, until no cable pulls harder than allowed [N]."""
    pose = simulation.solve(contractions, strict=False)
    if tension is None:
        return pose
    trials = 12  # So often a sample is let out
    for _ in range(trials):
        most = float(pose.tensions.max(initial=0.0))
        if pose.result.converged and most <= tension:
            break
        contractions = contractions * (np.clip(_CAUTION * tension / most, 0.5, 0.95) if pose.result.converged else 0.5)
        pose = simulation.solve(contractions, strict=False)
    return pose


def _touches(simulation: Simulation, pose: Equilibrium) -> bool:
    """True if parts of the body push one another off."""
    slot = simulation.body.own_contact
    if slot is None:
        return False
    return bool(simulation.assembly_at(pose).energies[slot].gradient(pose.nodes, pose.contractions).any())


def _crosses(simulation: Simulation, pose: Equilibrium) -> bool:
    robot = simulation.robot
    return robot.contact is None and len(find_crossings(robot.body.mesh, pose.nodes)) > 0


_KEPT: dict[str, Simulation] = {}
"""Physics of the robot that this process samples."""


_CAUTION = 0.97
"""Tensions grow faster than contractions, so it is let out a little less than in proportion to what is too much."""
