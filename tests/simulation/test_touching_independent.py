"""Equilibria of bodies that touch. Oracle: barriers and step bound of ipctk, with SciPy's linear algebra."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve
from touching import fork_robot

from hydrostat.arrays import Nodes, Vector
from hydrostat.robot import Contact, Robot
from hydrostat.simulation import Simulation

ipctk = pytest.importorskip("ipctk")

pytestmark = pytest.mark.usefixtures("unchecked")


class Independent:
    """Newton on elastic energy and cables of ours and contact of theirs: projected, dense, with their step bound."""

    def __init__(self, robot: Robot, distance: float) -> None:
        mesh = robot.body.mesh
        self.assembly, self.distance = Simulation(replace(robot, contact=None)).assembly, distance
        facets = mesh.boundary
        self.outer, mapped = np.unique(facets, return_inverse=True)
        mapped = mapped.reshape(facets.shape)
        edges, faces = (mapped, np.zeros((0, 3), int)) if mesh.dim == 2 else (ipctk.edges(mapped), mapped)
        self.mesh = ipctk.CollisionMesh(mesh.nodes[self.outer], edges, faces)
        thickness = robot.body.thickness or 1.0
        self.barrier = ipctk.BarrierPotential(distance, robot.body.material.young * thickness, True)
        self.dofs = (self.outer[:, None] * mesh.dim + np.arange(mesh.dim)).ravel()

    def collisions(self, nodes: Nodes):
        found = ipctk.NormalCollisions()
        found.use_area_weighting = True
        found.build(self.mesh, nodes[self.outer], self.distance)
        return found

    def value(self, nodes: Nodes, controls: Vector) -> float:
        skin = nodes[self.outer]
        return self.assembly.value(nodes, controls) + self.barrier(self.collisions(nodes), self.mesh, skin)

    def solve(self, nodes: Nodes, controls: Vector) -> Nodes:
        for _ in range(200):
            met, skin = self.collisions(nodes), nodes[self.outer]
            gradient = self.assembly.gradient(nodes, controls)
            gradient[self.dofs] += self.barrier.gradient(met, self.mesh, skin)
            if np.abs(gradient).max() < 1e-7:
                return nodes
            springs = self.assembly.low_rank_hessian(nodes, controls)
            hessian = self.assembly.hessian(nodes, controls, projection=1.0).toarray()
            hessian += springs.columns @ springs.weights @ springs.columns.T
            psd = ipctk.PSDProjectionMethod.CLAMP
            hessian[np.ix_(self.dofs, self.dofs)] += self.barrier.hessian(met, self.mesh, skin, psd).toarray()
            step = -cho_solve(cho_factor(hessian), gradient).reshape(nodes.shape)
            share = min(1.0, 0.9 * ipctk.compute_collision_free_stepsize(self.mesh, skin, (nodes + step)[self.outer]))
            before = self.value(nodes, controls)
            while not self.value(nodes + share * step, controls) <= before + 1e-14:
                share *= 0.5
                if share < 1e-10:
                    return nodes
            nodes = nodes + share * step
        raise AssertionError("no minimum found")


@pytest.mark.slow
@pytest.mark.parametrize("dim", [2, 3])
def test_an_independent_program_ends_where_we_do(dim: int) -> None:
    """Both keep a gap of their own law, below the distance at which they feel; so they differ by less than that."""
    far = {}
    for distance in (1e-3, 2.5e-4):
        robot = replace(fork_robot(dim, columns=8), contact=Contact(distance=distance))
        simulation, goal = Simulation(robot), np.array([0.012, 0.01])
        ours = simulation.solve(goal)
        nodes, other = robot.body.mesh.nodes, Independent(robot, distance)
        for share in np.linspace(0, 1, 4)[1:]:
            nodes = other.solve(nodes, share * goal)
        free = Simulation(replace(robot, contact=None)).solve(goal).nodes
        far[distance] = np.abs(ours.nodes - nodes).max()
        assert np.abs(free - nodes).max() > 4e-3  # contact holds the prongs back by so much
        assert far[distance] < 0.5 * distance
    assert far[2.5e-4] < 0.5 * far[1e-3]
