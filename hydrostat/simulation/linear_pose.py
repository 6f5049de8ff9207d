"""`LinearPose`: stiffness, masses, viscosity and inputs of small motions about an equilibrium."""

from operator import index
from typing import TYPE_CHECKING, SupportsIndex

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.mechanics import Assembly
from hydrostat.simulation.equilibrium import Equilibrium, check_pose
from hydrostat.simulation.simulation import Simulation

if TYPE_CHECKING:
    from scipy.sparse import csc_array


class LinearPose:
    """Matrices of small motions about an equilibrium: stiffness, masses, viscous matrix, inputs.

    Attributes:
        assembly: energies that count at the pose.
        masses: mass of each degree of freedom [kg].
        inputs: force on each degree of freedom per unit of each control, -d2E/dx da.
        viscous: Hessian of the viscous branches for a modulus of 1 Pa [m]; None for an elastic body.
    """

    def __init__(self, simulation: Simulation, pose: Equilibrium) -> None:
        """Linearize at a pose.

        Raises:
            InputError: physics that remember the way, or no pose of this robot.
            NotConvergedError: the pose is no stable equilibrium.
        """
        check_pose(pose, simulation.robot.body.mesh.nodes.shape, simulation.robot.num_controls, what="the pose")
        if simulation.robot.body.has_hysteresis:
            raise InputError("hysteresis has no linear model: remove it from the material")
        if simulation.assembly.has_history:
            raise InputError("friction has no linear model: set the friction of cables, contact and obstacles to 0")
        self.simulation, self.pose = simulation, pose
        self.assembly = simulation.assembly_at(pose)
        state = (pose.unknowns, pose.controls)
        self.stiffness = self.assembly.stiffness(*state)
        if self.stiffness.singular or not pose.result.converged or not pose.result.stable:
            raise NotConvergedError("no vibration: the pose is no stable equilibrium", pose.result)
        self.masses = np.repeat(simulation.body.inertias, self.assembly.shape[1])
        self.inputs = -self.assembly.control_derivative(*state).toarray()
        memory = simulation.dynamics.memory
        self.viscous: csc_array | None = None
        if len(memory):
            energy, nodes = memory.energy(memory.relax_fully(pose.unknowns), 1.0), pose.unknowns
            alone = Assembly([energy], rest=simulation.body.rest_unknowns, control_count=0)
            self.viscous = alone.hessian(nodes, np.zeros(0)) / memory.modulus(1.0)

    def find_basis(self, count: SupportsIndex) -> Float[np.ndarray, "dofs modes"]:
        """Lowest modes, with unit modal mass; the sign is that of their largest entry."""
        from scipy.sparse.linalg import LinearOperator, eigsh  # Imported here: seldom needed.

        root, size = np.sqrt(self.masses), len(self.masses)
        if isinstance(count, bool | np.bool) or not isinstance(count, SupportsIndex):
            raise InputError(f"the number of modes must be a whole number, not {count!r:.60}")
        count = index(count)
        if not 1 <= count < size:
            raise InputError(f"the number of modes must be from 1 to {size - 1}, not {count}")

        def solve_scaled(forces: Vector) -> Vector:
            return root * self.stiffness.solve(root * forces)

        inverse = LinearOperator((size, size), matvec=solve_scaled, dtype=float)  # pyright: ignore[reportCallIssue]
        start = np.random.default_rng(0).standard_normal(size)
        values, vectors = eigsh(inverse, k=count, which="LA", v0=start)  # pyright: ignore[reportArgumentType]
        basis = vectors[:, np.argsort(-values)] / root[:, None]
        return basis * np.sign(basis[np.abs(basis).argmax(axis=0), np.arange(count)])

    def with_static_moves(self, basis: Float[np.ndarray, "dofs modes"]) -> Float[np.ndarray, "dofs vectors"]:
        """Basis with the static displacements under each control, so that a reduced model has exact gains."""
        vectors = list(basis.T)
        for move in self.stiffness.solve(self.inputs).T:
            rest = move
            for _ in range(2):  # twice is enough (Kahan)
                rest = rest - sum((vector * (vector @ (self.masses * rest)) for vector in vectors), np.zeros_like(move))
            size = np.sqrt(rest @ (self.masses * rest))
            if size > 1e-6 * np.sqrt(move @ (self.masses * move)):
                vectors.append(rest / size)
        every = np.array(vectors).T
        _, turned = np.linalg.eigh(self.reduce_stiffness(every))
        return every @ turned

    def reduce_stiffness(self, basis: Float[np.ndarray, "dofs vectors"]) -> Float[np.ndarray, "vectors vectors"]:
        """Stiffness in a basis [1/s^2 at unit modal mass]."""
        state = (self.pose.unknowns, self.pose.controls)
        springs = self.assembly.low_rank_hessian(*state)
        along = springs.columns.T @ basis
        reduced = basis.T @ (self.assembly.hessian(*state) @ basis) + along.T @ springs.weights @ along
        return (reduced + reduced.T) / 2

    def reduce_viscous(self, basis: Float[np.ndarray, "dofs vectors"]) -> Float[np.ndarray, "vectors vectors"]:
        """Viscous matrix in a basis, for a modulus of 1 Pa; 0 for an elastic body."""
        if self.viscous is None:
            return np.zeros((basis.shape[1], basis.shape[1]))
        return basis.T @ (self.viscous @ basis)
