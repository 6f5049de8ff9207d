"""`activate`: which muscle fibres, pulled how hard, bring a body into a pose (R36 to R38, E21)."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.mechanics import FibreEnergy, NewtonOptions, NewtonResult, minimize
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import BodyPhysics


class FibreKind(StrEnum):
    """Kind of candidate muscles: along mesh edges, or within elements (E21)."""

    EDGES = "edges"
    ELEMENTS = "elements"


@dataclass(frozen=True, eq=False)
class Fibres:
    """Straight fibres between two points of the material each."""

    stencils: Int[np.ndarray, "fibres corners"]  # nodes that each fibre depends on, (fibres, corners)
    start: Float[np.ndarray, "fibres corners"]  # weights of those nodes at its first end, rows sum to one
    end: Float[np.ndarray, "fibres corners"]  # weights at its second end

    def __len__(self) -> int:
        """Number of fibres."""
        return len(self.stencils)

    def ends(self, nodes: Nodes) -> Float[np.ndarray, "fibres 2 dim"]:
        """Both end points of every fibre when the nodes are at `nodes` [m]."""
        corners = nodes[self.stencils]
        return np.stack([np.einsum("fc,fcd->fd", weights, corners) for weights in (self.start, self.end)], axis=1)

    def around_nodes(self, tensions: Vector, count: int) -> Vector:
        """Mean tension of the fibres that depend on each of so many nodes [N]; 0 for a node without any."""
        corners = self.stencils.shape[1]
        total = np.bincount(self.stencils.ravel(), np.repeat(tensions, corners), count)
        return total / np.maximum(np.bincount(self.stencils.ravel(), minlength=count), 1)

    def energy(self) -> FibreEnergy:
        """The physics of the fibres; control f is the tension of fibre f."""
        return FibreEnergy(stencils=self.stencils, weights=self.end - self.start)


def edge_fibres(mesh: Mesh) -> Fibres:
    """One fibre on every edge of the mesh."""
    count = len(mesh.edges)
    return Fibres(mesh.edges, np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1)))


def element_fibres(mesh: Mesh, directions: Float[np.ndarray, "elements dim"]) -> Fibres:
    """One fibre through the centroid of every element, along `directions`, from face to face."""
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    local = np.einsum("eij,ej->ei", inverse, directions)
    sensitivities = np.column_stack([-local.sum(axis=1), local])
    center = 1.0 / (mesh.dim + 1)
    with np.errstate(divide="ignore"):
        reach = center / np.abs(sensitivities)
    forward = np.where(sensitivities < 0, reach, np.inf).min(axis=1)
    backward = np.where(sensitivities > 0, reach, np.inf).min(axis=1)
    return Fibres(mesh.elements, center - backward[:, None] * sensitivities, center + forward[:, None] * sensitivities)


def wanted_directions(
    robot: Robot, pose: PoseTarget, *, body: BodyPhysics | None = None
) -> Float[np.ndarray, "elements dim"]:
    """Unit vectors along which a fibre of each element lowers the pose error most (E21a).

    At rest, with the adjoint field w = H^-1 dO/dx of the marker error O, a small tension t along d in an element
    changes O by t times the strain of w along d; the best d is the eigenvector of the largest strain of w.
    """
    mesh = robot.body.mesh
    body = body or BodyPhysics(robot)
    body.check(robot)
    places = {marker.name: marker.at for marker in robot.markers}
    anchors = locate(mesh, np.array([places[name] for name in pose.targets]))
    miss = anchors.positions(mesh.nodes) - np.array(list(pose.targets.values()), dtype=float)
    sensitivity = anchors.matrix(len(mesh.nodes)).T @ miss
    field = body.rest_factors.solve(-sensitivity.ravel()).reshape(mesh.nodes.shape)
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    moved = field[mesh.elements]
    gradient = inverse @ (moved[:, 1:] - moved[:, :1])
    strain = 0.5 * (gradient + np.swapaxes(gradient, 1, 2))
    return np.linalg.eigh(strain)[1][:, :, 0]


@dataclass(frozen=True, kw_only=True, eq=False)
class Activation:
    """The muscle fibres that bring a body into a pose (R36, R38)."""

    target: PoseTarget  # the pose asked for
    fibres: Fibres  # all candidate muscles
    tensions: Vector  # of each fibre [N], not negative
    nodes: Nodes  # positions of the nodes in the activated pose [m]
    errors: Mapping[str, float]  # distance of each targeted marker from its target [m]

    @property
    def rms_error(self) -> float:
        """Root of the mean squared distance over the targeted markers [m]."""
        return float(np.sqrt(np.mean(np.square(list(self.errors.values())))))


def activate(
    robot: Robot,
    target: PoseTarget,
    fibres: Fibres,
    *,
    effort: float = 1e-4,
    stages: int = 5,
    body: BodyPhysics | None = None,
) -> Activation:
    """Tensions t >= 0 of least effort that bring the markers near their targets.

    Minimizes 1/2 |markers - targets|^2 + rho/2 |t|^2 by Gauss-Newton while the target moves from rest to where it
    should be. The thesis leaves the regularizer open (E26, M8): squared tensions make the answer unique and spread it
    over many fibres; a sum of tensions instead would be sparse, but folds a limb at one hinge and misses the pose.

    Args:
        robot: robot with the body.
        target: target positions of the markers.
        fibres: the muscles.
        effort: weight of squared tensions: the larger, the weaker the muscles and the error left.
        stages: steps in which the target is approached.
        body: the physics of the body, if they are at hand.
    """
    return _Activation(robot, target, fibres, effort, stages, body).run()


class _Activation:
    """One run: body and fibres assembled, markers located."""

    def __init__(
        self, robot: Robot, target: PoseTarget, fibres: Fibres, effort: float, stages: int, body: BodyPhysics | None
    ) -> None:
        mesh = robot.body.mesh
        self.robot, self.target, self.fibres = robot, target, fibres
        self.effort, self.stages = effort, stages
        body = body or BodyPhysics(robot)
        body.check(robot)
        self.assembly = body.assembly.with_added_energies([fibres.energy()], control_count=len(fibres))
        places = {marker.name: marker.at for marker in robot.markers}
        self.anchors = locate(mesh, np.array([places[name] for name in target.targets]))
        self.goals = np.array(list(target.targets.values()), dtype=float)
        self.round_off = body.round_off()

    def run(self) -> Activation:
        """Approach the target in stages, two Gauss-Newton steps each, and a few more at the end."""
        nodes = self.robot.body.mesh.nodes
        tensions = np.zeros(len(self.fibres))
        start = self.anchors.positions(nodes)
        rho = self._weight(nodes, tensions)
        for stage in range(1, self.stages + 1):
            goals = start + (self.goals - start) * stage / self.stages
            for _ in range(2 if stage < self.stages else 6):
                nodes, tensions, moved = self._step(nodes, tensions, goals, rho)
                if not moved:
                    break
        errors = np.linalg.norm(self.anchors.positions(nodes) - self.goals, axis=1)
        return Activation(
            target=self.target,
            fibres=self.fibres,
            tensions=tensions,
            nodes=nodes,
            errors={name: float(error) for name, error in zip(self.target.targets, errors, strict=True)},
        )

    def _weight(self, nodes: Nodes, tensions: Vector) -> float:
        """Rho [m^2/N^2], measured by what the strongest fibre can do at rest."""
        return self.effort * float((self._jacobian(nodes, tensions) ** 2).sum(axis=0).max())

    def _jacobian(self, nodes: Nodes, tensions: Vector) -> Float[np.ndarray, "rows fibres"]:
        """D markers / d tensions by the adjoint: one solve for each marker coordinate, none for each fibre."""
        rows = anchor_jacobian(self.anchors, nodes)
        adjoint = self.assembly.stiffness(nodes, tensions).solve(rows)
        return -(self.assembly.control_derivative(nodes, tensions).T @ adjoint).T

    def _step(self, nodes: Nodes, tensions: Vector, goals: Points, rho: float) -> tuple[Nodes, Vector, bool]:
        """One Gauss-Newton step, shortened until the objective falls; whether it moved."""
        jacobian = self._jacobian(nodes, tensions)
        miss = (goals - self.anchors.positions(nodes)).ravel()
        wanted = least_effort(jacobian, miss + jacobian @ tensions, rho)
        before = self._objective(nodes, tensions, goals, rho)
        for length in (1.0, 0.5, 0.25, 0.1):
            trial = tensions + length * (wanted - tensions)
            solved = self._rest(nodes, trial)
            if solved.converged and self._objective(solved.nodes, trial, goals, rho) < before * (1 - 1e-6):
                return solved.nodes, trial, True
        return nodes, tensions, False

    def _rest(self, nodes: Nodes, tensions: Vector) -> NewtonResult:
        return minimize(
            self.assembly,
            nodes,
            tensions,
            round_off=self.round_off,
            options=NewtonOptions(tolerance=1e-7, iterations=60),
        )

    def _objective(self, nodes: Nodes, tensions: Vector, goals: Points, rho: float) -> float:
        miss = self.anchors.positions(nodes) - goals
        return float(0.5 * (miss**2).sum() + 0.5 * rho * tensions @ tensions)


def anchor_jacobian(held: Anchors, nodes: Nodes) -> Float[np.ndarray, "dofs rows"]:
    """Sensitivities of the places of held points by the nodes, a column for each of their coordinates."""
    points, dim = len(held.stencils), nodes.shape[1]
    rows = np.zeros((nodes.size, points * dim))
    for point in range(points):
        for axis in range(dim):
            rows[held.stencils[point] * dim + axis, point * dim + axis] = held.weights[point]
    return rows


def least_effort(
    jacobian: Float[np.ndarray, "rows fibres"],
    wanted: Float[np.ndarray, " rows"],
    rho: float,
    *,
    most: float | Vector = np.inf,
) -> Vector:
    """Minimizer 0 <= t <= most of 1/2 |J t - b|^2 + rho/2 |t|^2.

    There are few rows and many fibres, so the dual is solved: t = J^T y / rho within its bounds with y = b - J t, by
    semismooth Newton with a line search on the dual's value, which is smooth and concave.
    """
    y = np.zeros_like(wanted)
    full = rho * most
    value = _dual(jacobian, wanted, rho, full, y)
    for _ in range(200):
        asked = jacobian.T @ y
        pull = np.clip(asked, 0.0, full)
        active = jacobian[:, (asked > 0) & (asked < full)]
        sensitivity = wanted - y - jacobian @ pull / rho
        if np.abs(sensitivity).max(initial=0.0) <= 1e-12 * np.abs(wanted).max(initial=0.0):
            break
        step = np.linalg.solve(np.eye(len(y)) + active @ active.T / rho, sensitivity)
        length = 1.0
        while (
            trial := _dual(jacobian, wanted, rho, full, y + length * step)
        ) < value + 1e-4 * length * sensitivity @ step:
            length *= 0.5
            if length < 1e-8:
                return pull / rho
        y, value = y + length * step, trial
    return np.clip(jacobian.T @ y, 0.0, full) / rho


def _dual(jacobian: np.ndarray, wanted: np.ndarray, rho: float, full: float | Vector, y: np.ndarray) -> float:
    """The dual's value; a fibre at its bound adds what its tension is worth there."""
    asked = np.maximum(jacobian.T @ y, 0.0)
    pull = np.minimum(asked, full)
    return float(wanted @ y - 0.5 * y @ y - (pull @ (asked - 0.5 * pull)) / rho)
