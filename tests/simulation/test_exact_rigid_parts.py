"""Rigid parts against exact ones. Oracle: Newton's method on the free nodes and the six unknowns of the part alone."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from builders import box_mesh, mesh_body, strip_mesh

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
    """Nodes whose part is exactly rigid: its place, turn and the free nodes are all that moves."""

    def __init__(self, simulation: Simulation, nodes: np.ndarray) -> None:
        mesh, self.simulation = simulation.robot.body.mesh, simulation
        self.own = np.unique(mesh.elements[simulation.robot.body.element_materials == 1])
        self.free = np.setdiff1d(np.arange(len(mesh.nodes)), self.own)
        self.nodes, rest = nodes.copy(), mesh.nodes[self.own] - mesh.nodes[self.own].mean(axis=0)
        turn = scipy.linalg.polar(nodes[self.own].T @ rest)[0]
        self.nodes[self.own] = nodes[self.own].mean(axis=0) + rest @ turn.T

    def columns(self) -> np.ndarray:
        """Derivative of all coordinates by the unknowns."""
        count, dim = self.nodes.shape
        arms = self.nodes[self.own] - self.nodes[self.own].mean(axis=0)
        rigid = np.zeros((count, dim, dim + len(SPINS[dim])))
        rigid[self.own, :, :dim] = np.eye(dim)
        for index, spin in enumerate(SPINS[dim]):
            rigid[self.own, :, dim + index] = arms @ spin.T
        free = np.zeros((count, dim, len(self.free), dim))
        free[self.free, :, np.arange(len(self.free))] = np.eye(dim)
        return np.hstack([free.reshape(count * dim, -1), rigid.reshape(count * dim, -1)])

    def derivatives(self, controls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gradient and Hessian by the unknowns, with the curvature of the turn."""
        (count, dim), columns, assembly = self.nodes.shape, self.columns(), self.simulation.assembly
        forces, springs = assembly.gradient(self.nodes, controls), assembly.coupling(self.nodes, controls)
        whole = assembly.hessian(self.nodes, controls) + springs.columns @ springs.weights @ springs.columns.T
        hessian, spins = columns.T @ whole @ columns, SPINS[dim]
        arms, own = self.nodes[self.own] - self.nodes[self.own].mean(axis=0), forces.reshape(count, dim)[self.own]
        for i, one in enumerate(spins, start=-len(spins)):
            for j, other in enumerate(spins, start=-len(spins)):
                hessian[i, j] += np.vdot(own, arms @ (0.5 * (one @ other + other @ one)).T)
        return columns.T @ forces, hessian

    def solve(self, controls: np.ndarray) -> None:
        """Move to the equilibrium."""
        dim, size = self.nodes.shape[1], 1.0
        while size > 1e-12:
            gradient, hessian = self.derivatives(controls)
            step = -np.linalg.solve(hessian, gradient)
            size, rigid = float(np.abs(step).max()), step[dim * len(self.free) :]
            self.nodes[self.free] += step[: dim * len(self.free)].reshape(-1, dim)
            middle = self.nodes[self.own].mean(axis=0)
            turn = scipy.linalg.expm(np.tensordot(rigid[dim:], SPINS[dim], axes=1))
            self.nodes[self.own] = middle + rigid[:dim] + (self.nodes[self.own] - middle) @ turn.T


@pytest.mark.parametrize(("dim", "poisson"), [(2, 0.3), (3, 0.49)])
def test_a_rigid_part_is_nearly_an_exact_one(dim: int, poisson: float) -> None:
    """Within the figures of docs/robot_toml.md: tip, Jacobian, tension, frequencies at rest."""
    simulation, controls = Simulation(bent(dim, poisson)), np.array([0.02])
    pose, anchors, rest = simulation.solve(controls), simulation.marker_anchors, simulation.robot.body.mesh.nodes
    exact = Exact(simulation, pose.nodes)
    exact.solve(controls)
    tip, travel = anchors.positions(exact.nodes)[0], np.linalg.norm(anchors.positions(exact.nodes - rest))
    assert np.linalg.norm(pose.markers["tip"] - tip) < 1.4e-4 * travel
    assert pose.tensions == pytest.approx(simulation.tensions(exact.nodes, controls), rel=2.7e-4)
    columns, mixed = exact.columns(), simulation.assembly.control_derivative(exact.nodes, controls).toarray()
    moves = -columns @ np.linalg.solve(exact.derivatives(controls)[1], columns.T @ mixed)
    slope = anchors.positions(moves.reshape(rest.shape))[0]
    assert np.linalg.norm(simulation.marker_jacobian(pose)[0, :, 0] - slope) < 2.1e-4 * np.linalg.norm(slope)
    still = Exact(simulation, rest)
    columns, masses = still.columns(), np.repeat(simulation.body.masses, dim)
    mass = columns.T @ (masses[:, None] * columns)
    squares = scipy.linalg.eigh(still.derivatives(np.zeros(1))[1], mass, eigvals_only=True)[:4]
    assert find_modes(simulation, count=4).frequencies == pytest.approx(np.sqrt(squares) / 2 / np.pi, rel=1.1e-4)
