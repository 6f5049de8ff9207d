"""`SensorReader`: readings of a robot's sensors in poses and motions."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.mechanics import ContactForces, rod_points
from hydrostat.robot import Sensor, SensorKind
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.simulation import Simulation
from hydrostat.simulation.time.motion import Motion

Gradients = Float[np.ndarray, "places dim dim"]
Jacobian = Float[np.ndarray, "values moves"]
_State = tuple[Nodes, Nodes, Nodes, tuple[tuple[ContactForces, bool], ...]]
"""Nodes [m], velocities [m/s], accelerations [m/s^2], and contact forces, with True for those by obstacles."""


class SensorReader:
    """Readings of all sensors of a robot, for poses and states of motions.

    Attributes:
        simulation: physics of the robot.
        heads: name of each value of `read_vector`, such as "imu_x".
    """

    def __init__(self, simulation: Simulation) -> None:
        """Place the sensors in the body."""
        self.simulation, robot = simulation, simulation.robot
        mesh = robot.body.mesh
        self.heads = tuple(head for sensor in robot.sensors for head in sensor.heads(mesh.dim))
        self._gravity = np.zeros(mesh.dim) if robot.gravity is None else np.array(robot.gravity)
        self._functions = [self._prepare(sensor, mesh) for sensor in robot.sensors]
        self._presses = any(sensor.kind is SensorKind.PRESSURE for sensor in robot.sensors)

    def read(
        self, state: Equilibrium | Motion, *, random: np.random.Generator | None = None
    ) -> dict[str, float | Vector]:
        """Return the reading of each sensor by name, in SI units: a number, or an array for several axes.

        Args:
            state: pose, with zero velocities, or state of a motion.
            random: random generator for noise; no noise if left out.
        """
        found: dict[str, float | Vector] = {}
        given = self._state(state)
        for sensor, function in zip(self.simulation.robot.sensors, self._functions, strict=True):
            value = np.atleast_1d(function(given))
            if random is not None:
                value = value + sensor.noise * random.standard_normal(value.shape)
            found[sensor.name] = value if len(value) > 1 else float(value[0])
        return found

    def read_vector(self, state: Equilibrium | Motion, *, random: np.random.Generator | None = None) -> Vector:
        """Return all readings as one vector, in the order of `heads`; arguments as for `read`."""
        return np.concatenate([np.zeros(0), *map(np.atleast_1d, self.read(state, random=random).values())])

    def find_jacobians(
        self, pose: Equilibrium, moves: Float[np.ndarray, "moves nodes dim"]
    ) -> tuple[Jacobian, Jacobian]:
        """Return Jacobians of readings about a pose, by central differences: for node moves, and for velocities.

        Args:
            pose: pose to linearize about.
            moves: displacement of the nodes [m], or their velocity [m/s], for a change of 1.

        Raises:
            InputError: an accelerometer or a pressure sensor, because these measure accelerations and contact.
        """
        for sensor in self.simulation.robot.sensors:
            if sensor.kind in (SensorKind.ACCELEROMETER, SensorKind.PRESSURE):
                raise InputError(f'sensor "{sensor.name}": a linear model has no {sensor.kind} sensor. Remove it.')
        still, size = np.zeros_like(pose.nodes), 1e-5 * self.simulation.robot.body.mesh.size
        jacobians = np.zeros((2, len(self.heads), len(moves)))
        for index, move in enumerate(moves):
            step = size / float(np.abs(move).max())
            for way in (step, -step):
                states = (pose.nodes + way * move, still), (pose.nodes, way * move)
                for row, (nodes, velocities) in enumerate(states):
                    given: _State = (nodes, velocities, still, ())
                    read = [np.atleast_1d(function(given)) for function in self._functions]
                    jacobians[row, :, index] += np.concatenate([np.zeros(0), *read]) / (2 * way)
        return jacobians[0], jacobians[1]

    def _state(self, state: Equilibrium | Motion) -> _State:
        forces = self._contact_forces(state) if self._presses else ()
        if isinstance(state, Motion):
            return state.nodes, state.velocities, state.accelerations, forces
        return state.nodes, np.zeros_like(state.nodes), np.zeros_like(state.nodes), forces

    def _contact_forces(self, state: Equilibrium | Motion) -> tuple[tuple[ContactForces, bool], ...]:
        simulation = self.simulation
        if isinstance(state, Motion):
            energies, slots = simulation.dynamics.energies_at(state), simulation.dynamics.obstacles
            nodes = state.nodes if state.carried is None else np.concatenate([state.nodes, state.carried[0]])
        else:
            assembly = simulation.path.with_history(state) if simulation.assembly.has_history else simulation.assembly
            energies, slots, nodes = assembly.energies, simulation.body.obstacles, state.unknowns
        found = ((energy.contact_forces(nodes), slot in slots) for slot, energy in enumerate(energies))
        return tuple((forces, outside) for forces, outside in found if forces is not None)

    def _prepare(self, sensor: Sensor, mesh: Mesh) -> Callable[[_State], float | Vector]:
        """Function that reads a sensor."""
        kind = sensor.kind
        if kind is SensorKind.PRESSURE:
            return _prepare_pressure(sensor.face(mesh), mesh, self.simulation.body.thickness)
        if kind in (SensorKind.BEND, SensorKind.STRAIN, SensorKind.LENGTH):
            corners = np.array(sensor.points, dtype=float)
            if kind is SensorKind.BEND:
                return _prepare_bend(locate(mesh, _even_points(mesh, corners)), mesh, sensor.normal)
            anchors = locate(mesh, corners if kind is SensorKind.LENGTH else rod_points(mesh, corners))
            rest = _length(anchors, mesh.nodes)
            if kind is SensorKind.LENGTH:
                return lambda state: _length(anchors, state[0])
            return lambda state: _length(anchors, state[0]) / rest - 1.0
        return _prepare_inertial(kind, np.array(sensor.at), mesh, self._gravity)


def _length(anchors: Anchors, nodes: Nodes) -> float:
    return float(np.linalg.norm(np.diff(anchors.positions(nodes), axis=0), axis=1).sum())


def _even_points(mesh: Mesh, corners: Points) -> Points:
    """Points along a path, evenly spaced by about one and a half element edges, at least three [m].

    Pieces within one element would turn with the steps of its strain from one element to the next.
    """
    edge = float(np.linalg.norm(mesh.nodes[mesh.elements[:, 0]] - mesh.nodes[mesh.elements[:, 1]], axis=1).mean())
    ends = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1)))
    places = np.linspace(0.0, ends[-1], max(round(ends[-1] / (1.5 * edge)), 2) + 1)
    return np.stack([np.interp(places, ends, axis) for axis in corners.T], axis=1)


def _prepare_bend(anchors: Anchors, mesh: Mesh, normal: tuple[float, ...] | None) -> Callable[[_State], float]:
    """Turn along a path since rest [rad]: the sum over its joints.

    A joint turns from the middle of one straight piece to that of the next, so half a piece is missing at each end: the
    joints there count for it, too.
    """
    count = len(anchors.stencils)
    weights = np.ones(count - 2)
    weights[:1] += 0.5
    weights[-1:] += 0.5
    inner = anchors.select_points(range(1, count - 1))
    inverse = _inverse_spans(mesh.nodes, inner.stencils)

    def turn(nodes: Nodes) -> float:
        spans = np.diff(anchors.positions(nodes), axis=0)
        one, two = spans[:-1], spans[1:]
        if normal is None:
            sines = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
            return float(weights @ np.arctan2(sines, (one * two).sum(axis=1)))
        across = _gradients(nodes, inner.stencils, inverse) @ (np.array(normal) / np.linalg.norm(normal))
        axes = np.cross(one + two, across)  # about which the path turns to the normal
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        sines = (np.cross(one, two) * axes).sum(axis=1)
        return float(weights @ np.arctan2(sines, (one * two).sum(axis=1)))

    rest = turn(mesh.nodes)
    return lambda state: turn(state[0]) - rest


def _prepare_pressure(face: np.ndarray, mesh: Mesh, thickness: float | None) -> Callable[[_State], float]:
    """Normal contact force on a face of the skin by its area at rest [Pa]."""
    on_face = np.isin(np.arange(len(mesh.nodes)), face)
    area = float(np.linalg.norm(_facet_normals(mesh.nodes[face]), axis=1).sum()) * (thickness or 1.0)

    def press(state: _State) -> float:
        nodes, total = state[0], 0.0
        for found, by_obstacle in state[3]:
            if by_obstacle:
                own = on_face[found.stencils].all(axis=1)
                normals = _facet_normals(nodes[found.stencils[own]])
                forces = (found.forces[own] * normals).sum(axis=1) / np.linalg.norm(normals, axis=1)
                total -= float(forces.sum())
            else:  # normal forces; the first node is of one side, the last of the other
                sides = on_face[found.stencils[:, [0, -1]]].sum(axis=1)
                total += float(sides @ np.linalg.norm(found.forces, axis=1))
        return total / area

    return press


def _facet_normals(corners: Float[np.ndarray, "facets dim dim"]) -> Points:
    """Outward normals of facets, as long as their length [m] or area [m^2]."""
    one = corners[:, 1] - corners[:, 0]
    if corners.shape[2] == 2:
        return np.stack([one[:, 1], -one[:, 0]], axis=1)
    return 0.5 * np.cross(one, corners[:, 2] - corners[:, 0])


def _prepare_inertial(kind: SensorKind, at: Vector, mesh: Mesh, gravity: Vector) -> Callable[[_State], float | Vector]:
    """Reading of an orientation, a gyroscope or an accelerometer, from all elements around its place."""
    anchor = locate(mesh, at[None])
    around = mesh.elements[np.isin(mesh.elements, anchor.stencils).any(axis=1)]
    inverse = _inverse_spans(mesh.nodes, around)
    shares = 1.0 / np.abs(np.linalg.det(inverse))
    shares /= shares.sum()

    def mean_gradient(nodes: Nodes) -> Float[np.ndarray, "dim dim"]:
        return np.tensordot(shares, _gradients(nodes, around, inverse), axes=1)

    def read(state: _State) -> float | Vector:
        gradient = mean_gradient(state[0])
        left, _, right = np.linalg.svd(gradient)
        turn = left @ right
        if kind is SensorKind.ORIENTATION:
            return _rotation_vector(turn)
        if kind is SensorKind.ACCELEROMETER:
            return turn.T @ (anchor.positions(state[2])[0] - gravity)
        rates = mean_gradient(state[1]) @ np.linalg.inv(gradient)
        spin = turn.T @ (0.5 * (rates - rates.T)) @ turn
        return float(spin[1, 0]) if len(spin) == 2 else np.array([spin[2, 1], spin[0, 2], spin[1, 0]])

    return read


def _rotation_vector(turn: Float[np.ndarray, "dim dim"]) -> float | Vector:
    """Angle of a rotation in the plane, or its axis times its angle [rad]."""
    if len(turn) == 2:
        return float(np.arctan2(turn[1, 0], turn[0, 0]))
    from scipy.spatial.transform import Rotation  # Imported here: seldom needed.

    return Rotation.from_matrix(turn).as_rotvec()


def _inverse_spans(nodes: Nodes, stencils: np.ndarray) -> Gradients:
    """Inverse of the spans of simplices at rest [1/m]."""
    corners = nodes[stencils]
    return np.linalg.inv(corners[:, 1:] - corners[:, :1])


def _gradients(nodes: Nodes, stencils: np.ndarray, inverse: Gradients) -> Gradients:
    """Deformation gradient of simplices."""
    corners = nodes[stencils]
    return np.swapaxes(inverse @ (corners[:, 1:] - corners[:, :1]), 1, 2)
