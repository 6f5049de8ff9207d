"""`linearize`: linear state space of a robot about an equilibrium, for control."""

import warnings
from dataclasses import dataclass
from typing import SupportsIndex

import numpy as np
from numpy.typing import NDArray

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.errors import HydrostatWarning
from hydrostat.given import check_not_negative
from hydrostat.result_table import Columns, Tabular
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.linear_pose import LinearPose
from hydrostat.simulation.sensor_reader import SensorReader
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, kw_only=True, eq=False)
class StateSpace(Tabular):
    """Linear model dz/dt = A z + B u, y = C z of small motions about a pose.

    z holds modal displacements, modal velocities, then the displacements stored by each Maxwell branch of the material.
    SciPy takes the matrices: `scipy.signal.StateSpace(space.A, space.B, space.C, 0)`.

    Attributes:
        pose: equilibrium about which the model holds; z = 0, u = 0 and y = 0 there.
        A: state matrix [1/s].
        B: input matrix, (states, controls).
        C: output matrix, (outputs, states).
        inputs: name of each winch [m of contraction] and drive [rad or m].
        outputs: name of each output: displacement of each marker along each axis [m], such as "tip_x", then, with
            `sensors`, the change of each reading, in SI units.
        basis: displacement of each degree of freedom in each modal displacement [1/kg^0.5], (dofs, modes).
        masses: mass of each degree of freedom [kg].
    """

    pose: Equilibrium
    A: Float[np.ndarray, "states states"]
    B: Float[np.ndarray, "states controls"]
    C: Float[np.ndarray, "outputs states"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    basis: Float[np.ndarray, "dofs modes"]
    masses: Vector

    def columns(self) -> Columns:
        """Return a table of the poles, slowest first."""
        return {"pole_real_1/s": self.poles.real, "pole_imaginary_1/s": self.poles.imag}

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<StateSpace: {len(self.A)} states, inputs {', '.join(self.inputs)}; outputs {', '.join(self.outputs)}>"

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A [1/s], complex, by falling real part: the slowest first."""
        poles = np.linalg.eigvals(self.A).astype(np.complex128)
        return poles[np.lexsort((-poles.imag, -poles.real))]

    @property
    def gain(self) -> Float[np.ndarray, "outputs controls"]:
        """Static outputs per unit of each control: the Jacobian of the markers."""
        return -self.C @ np.linalg.solve(self.A, self.B)

    @property
    def settling_time(self) -> float:
        """Time after which the slowest pole has fallen to 2 % [s]; infinite without damping."""
        slowest = float(self.poles.real.max())
        return float(np.log(50) / -slowest) if slowest < -1e-9 * float(np.abs(self.A).max()) ** 0.5 else np.inf

    def project(self, nodes: Nodes, velocities: Nodes | None = None) -> Vector:
        """Return the state z of nodes [m], velocities [m/s] near the pose by least kinetic energy; relaxed branches."""
        count, modes = len(self.pose.nodes) * self.pose.nodes.shape[1], self.basis.shape[1]
        weighted = (self.basis * self.masses[:, None])[:count].T
        place = weighted @ (nodes - self.pose.nodes).ravel()
        speed = np.zeros(modes) if velocities is None else weighted @ velocities.ravel()
        return np.concatenate([place, speed, np.tile(place, len(self.A) // modes - 2)])


def linearize(
    simulation: Simulation,
    pose: Equilibrium | None = None,
    *,
    modes: SupportsIndex = 10,
    drag: float = 0.0,
    sensors: bool = False,
) -> StateSpace:
    """Compute a linear state space about an equilibrium, from its lowest modes and the static move of each control.

    Static moves make gains exact with few modes. Damping is that of the material and `drag`. Taut cables act as springs
    and slack ones are left out, as in the pose.

    Args:
        simulation: physics of the robot.
        pose: equilibrium; that without contractions if left out, with a warning about slack cables, which have no
            effect.
        modes: number of modes in addition to the static moves.
        drag: mass-proportional (Rayleigh) damping, alpha [1/s], as in `StepOptions`.
        sensors: True to add readings of the robot's sensors as outputs, after the markers.

    Raises:
        InputError: friction, a value out of range, or with `sensors` an accelerometer or a pressure sensor.
        NotConvergedError: the pose is not a stable equilibrium.
    """
    check_not_negative("drag", drag, "1/s")
    if pose is None:
        pose = simulation.rest
        _warn_slack(pose)
    linear, robot = LinearPose(simulation, pose), simulation.robot
    basis = linear.with_static_moves(linear.find_basis(modes))
    viscous, memory, count = linear.reduce_viscous(basis), simulation.dynamics.memory, basis.shape[1]
    slow = [(float(eta / tau), float(tau)) for eta, tau in zip(memory.viscosities, memory.times, strict=True) if tau]
    quick = float(memory.viscosities[memory.times == 0].sum())
    one = np.eye(count)
    stiff = linear.reduce_stiffness(basis) + sum(modulus for modulus, _ in slow) * viscous
    matrix = np.zeros(((2 + len(slow)) * count,) * 2)
    matrix[:count, count : 2 * count] = one
    matrix[count : 2 * count, : 2 * count] = np.hstack([-stiff, -quick * viscous - drag * one])
    for index, (modulus, time) in enumerate(slow, start=2):
        part = slice(index * count, (index + 1) * count)
        matrix[count : 2 * count, part] = modulus * viscous
        matrix[part, :count], matrix[part, part] = one / time, -one / time
    entry = np.zeros((len(matrix), robot.num_controls))
    entry[count : 2 * count] = basis.T @ linear.inputs
    names, rows = _outputs(simulation, pose, basis, sensors=sensors)
    return StateSpace(
        pose=pose,
        A=matrix,
        B=entry,
        C=np.hstack([rows, np.zeros((len(rows), len(matrix) - 2 * count))]),
        inputs=tuple(part.name for part in (*robot.winches, *robot.drives)),
        outputs=names,
        basis=basis,
        masses=linear.masses,
    )


def _outputs(
    simulation: Simulation, pose: Equilibrium, basis: Float[np.ndarray, "dofs modes"], *, sensors: bool
) -> tuple[tuple[str, ...], Float[np.ndarray, "outputs states"]]:
    """Names of the outputs, and their rows for modal displacements and velocities."""
    anchors, (_, dim), count = simulation.marker_anchors, simulation.assembly.shape, basis.shape[1]
    moves = basis.reshape(-1, dim, count)
    places = np.einsum("pc,pcdm->pdm", anchors.weights, moves[anchors.stencils]).reshape(-1, count)
    names = [f"{marker.name}_{axis}" for marker in simulation.robot.markers for axis in "xyz"[:dim]]
    rows = np.hstack([places, np.zeros_like(places)])
    if sensors:
        reader = SensorReader(simulation)
        jacobians = reader.find_jacobians(pose, np.moveaxis(moves[: len(pose.nodes)], 2, 0))
        names, rows = [*names, *reader.heads], np.vstack([rows, np.hstack(jacobians)])
    return tuple(names), rows


def _warn_slack(pose: Equilibrium) -> None:
    """Warn of cables that are slack in the pose taken by default: a small contraction of them moves nothing."""
    slack = [cable.name for cable, tension in zip(pose.robot.cables, pose.tensions, strict=True) if tension <= 0]
    if slack:
        words = f"slack at rest, so without gain: cables {', '.join(slack)}. Give a pose in which they are taut."
        warnings.warn(words, HydrostatWarning, stacklevel=3)
