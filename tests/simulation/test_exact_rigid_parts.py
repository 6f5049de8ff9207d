"""Rigid parts against exact ones. Oracle: Newton's method on the free nodes and the six unknowns of the part alone."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
from builders import box_mesh, gallery_robot, mesh_body, strip_mesh

from hydrostat.robot import BodyPart, Cable, Marker, Material, Pin, Robot, Winch
from hydrostat.simulation import Simulation, find_modes

LENGTH, WIDTH = 0.2, 0.05
SPINS = {
    2: [np.array([[0.0, -1.0], [1.0, 0.0]])],
    3: [np.cross(np.eye(3), axis) for axis in np.eye(3)],
}


def bent(dim: int, poisson: float) -> Robot:
    """A bar with a bone in its middle third, which a cable near its upper side bends."""
    height = 0.02 if dim == 2 else 0.045
    points = tuple((x, height, 0.02)[:dim] for x in (0.005, 0.06, 0.14, 0.195))
    mesh = strip_mesh(16, 4) if dim == 2 else box_mesh((8, 2, 2), size=(LENGTH, WIDTH, WIDTH))
    bone = BodyPart(name="bone", shape="box", at=(0.07, -1.0, -1.0)[:dim], to=(0.13, 1.0, 1.0)[:dim], density=1e3)
    return Robot(
        name="bent",
        body=replace(mesh_body(mesh, material=Material(young=30e3, poisson=poisson, density=40.0)), parts=(bone,)),
        pins=(Pin(box=((-1e-3, -1.0, -1.0)[:dim], (1e-3, 1.0, 1.0)[:dim]), stiffness=1e6),),
        winches=(Winch(name="pull", at=points[0]),),
        cables=(Cable(winch="pull", points=points, stiffness=4e3),),
        markers=(Marker(name="tip", at=(LENGTH, 0.0, WIDTH / 2)[:dim]),),
        poses={},
    )


class Exact:
    """Nodes whose parts are exactly rigid: places and turns of these and the free nodes are all that moves."""

    def __init__(self, simulation: Simulation, nodes: np.ndarray) -> None:
        body, self.simulation, self.nodes = simulation.robot.body, simulation, nodes.copy()
        rest, kinds = body.mesh.nodes, range(1, len(body.parts) + 1)
        self.parts = [np.unique(body.mesh.elements[body.element_materials == kind]) for kind in kinds]
        self.free = np.setdiff1d(np.arange(len(rest)), np.concatenate(self.parts))
        for own in self.parts:
            arms = rest[own] - rest[own].mean(axis=0)
            turn = scipy.linalg.polar((nodes[own] - nodes[own].mean(axis=0)).T @ arms)[0]
            self.nodes[own] = nodes[own].mean(axis=0) + arms @ turn.T

    def columns(self) -> scipy.sparse.csr_array:
        """Derivative of all coordinates by the unknowns."""
        count, dim = self.nodes.shape
        loose = (dim * self.free[:, None] + np.arange(dim)).ravel()
        blocks = [scipy.sparse.csc_array(scipy.sparse.eye_array(count * dim))[:, loose]]
        for own in self.parts:
            arms = self.nodes[own] - self.nodes[own].mean(axis=0)
            rigid = np.zeros((count, dim, dim + len(SPINS[dim])))
            rigid[own, :, :dim] = np.eye(dim)
            for index, spin in enumerate(SPINS[dim]):
                rigid[own, :, dim + index] = arms @ spin.T
            blocks.append(scipy.sparse.csc_array(rigid.reshape(count * dim, -1)))
        return scipy.sparse.csr_array(scipy.sparse.hstack(blocks))

    def derivatives(self, controls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gradient and Hessian by the unknowns, with the curvature of the turns."""
        (count, dim), columns, assembly = self.nodes.shape, self.columns(), self.simulation.assembly
        forces, springs = assembly.gradient(self.nodes, controls), assembly.low_rank_hessian(self.nodes, controls)
        pulled, spins, first = columns.T @ springs.columns, SPINS[dim], dim * len(self.free) + dim
        hessian = (columns.T @ assembly.hessian(self.nodes, controls) @ columns).toarray()
        hessian += pulled @ springs.weights @ pulled.T
        for begin, part in enumerate(self.parts):
            arms, own = self.nodes[part] - self.nodes[part].mean(axis=0), forces.reshape(count, dim)[part]
            at = first + begin * (dim + len(spins))
            for i, one in enumerate(spins):
                for j, other in enumerate(spins):
                    hessian[at + i, at + j] += np.vdot(own, arms @ (0.5 * (one @ other + other @ one)).T)
        return columns.T @ forces, hessian

    def solve(self, controls: np.ndarray) -> None:
        """Move to the equilibrium."""
        dim, size = self.nodes.shape[1], 1.0
        while size > 1e-11:
            gradient, hessian = self.derivatives(controls)
            step = -np.linalg.solve(hessian, gradient)
            size, rigid = float(np.abs(step).max()), step[dim * len(self.free) :].reshape(len(self.parts), -1)
            self.nodes[self.free] += step[: dim * len(self.free)].reshape(-1, dim)
            for own, change in zip(self.parts, rigid, strict=True):
                middle = self.nodes[own].mean(axis=0)
                turn = scipy.linalg.expm(np.tensordot(change[dim:], SPINS[dim], axes=1))
                self.nodes[own] = middle + change[:dim] + (self.nodes[own] - middle) @ turn.T


@pytest.mark.parametrize(("dim", "poisson"), [(2, 0.3), (3, 0.49)])
def test_a_rigid_part_is_an_exact_one(dim: int, poisson: float) -> None:
    """Within the figures of docs/robot_toml.md: tip, Jacobian, tension, frequencies at rest."""
    simulation, controls = Simulation(bent(dim, poisson)), np.array([0.02])
    pose, anchors, rest = simulation.solve(controls), simulation.marker_anchors, simulation.robot.body.mesh.nodes
    exact = Exact(simulation, pose.nodes)
    exact.solve(controls)
    tip, travel = anchors.positions(exact.nodes)[0], np.linalg.norm(anchors.positions(exact.nodes - rest))
    assert np.linalg.norm(pose.markers["tip"] - tip) < 5e-6 * travel
    assert pose.tensions == pytest.approx(simulation.tensions(exact.nodes, controls), rel=5e-6)
    columns, mixed = exact.columns(), simulation.assembly.control_derivative(exact.nodes, controls).toarray()
    moves = -columns @ np.linalg.solve(exact.derivatives(controls)[1], columns.T @ mixed)
    slope = anchors.positions(moves.reshape(rest.shape))[0]
    assert np.linalg.norm(simulation.marker_jacobian(pose)[0, :, 0] - slope) < 5e-6 * np.linalg.norm(slope)
    still = Exact(simulation, rest)
    columns, masses = still.columns(), np.repeat(simulation.body.masses, dim)
    mass = (columns.T @ scipy.sparse.diags_array(masses) @ columns).toarray()
    squares = scipy.linalg.eigh(still.derivatives(np.zeros(1))[1], mass, eigvals_only=True)[:4]
    assert find_modes(simulation, count=4).frequencies == pytest.approx(np.sqrt(squares) / 2 / np.pi, rel=5e-6)


def test_thin_disks_on_a_wire_are_rigid() -> None:
    """gallery:spine, pulled by one tendon of its tip: each marker within 0.1 % of its travel."""
    simulation = Simulation(gallery_robot("spine"))
    pose = simulation.solve({"c1": 0.006})
    exact = Exact(simulation, pose.nodes)
    exact.solve(pose.contractions)
    anchors, rest = simulation.marker_anchors, simulation.robot.body.mesh.nodes
    places, travels = anchors.positions(exact.nodes), np.linalg.norm(anchors.positions(exact.nodes - rest), axis=1)
    errors = np.linalg.norm(anchors.positions(pose.nodes) - places, axis=1) / travels
    assert (errors < 1e-3).all()
    assert pose.result.iterations <= 8  # as many as parts 100 times softer take: arcs turn stiff parts as a whole


def test_steps_in_time_turn_stiff_parts_as_a_whole() -> None:
    """gallery:spine, pulled at once: 45 iterations in five steps, where straight ones took 670."""
    simulation = Simulation(gallery_robot("spine"))
    motion, iterations = simulation.motion_at_rest(), 0
    for _ in range(5):
        motion = simulation.step(motion, {"c1": 0.006}, 0.005)
        iterations += motion.result.iterations
    assert iterations < 90
