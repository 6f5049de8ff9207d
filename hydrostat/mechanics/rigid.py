"""`RigidBodyDofs`, `RigidEnergy`, `GuideEnergy`: a moving rigid body, as a few extra rows of the unknowns."""

from copy import copy
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks
from hydrostat.mechanics.warp import StepMap

Matrix = Float[np.ndarray, "dim dim"]


class RigidBodyDofs(NamedTuple):
    """Unknowns of a moving rigid body: its position, then its axes times a length (affine body).

    A point at u in the frame of the obstacle is at place + sum of u_k x axis_k. Axes are unknowns of their own, which
    `RigidEnergy` keeps a rotation; so everything is a polynomial of the unknowns, and their inertia is constant
    (Lan et al. 2022).

    Attributes:
        row: row of the position among the unknowns; the next dim rows are the axes.
        length: factor of the axes in the unknowns [m].
        dim: space dimension.
    """

    row: int
    length: float
    dim: int

    @property
    def rows(self) -> np.ndarray:
        """Indices of all rows of this body among the unknowns."""
        return np.arange(self.row, self.row + 1 + self.dim)

    def place(self, unknowns: Nodes) -> Vector:
        """Position of the origin of its frame [m]."""
        return unknowns[self.row]

    def axes(self, unknowns: Nodes) -> Matrix:
        """Its axes, a row for each."""
        return unknowns[self.rows[1:]] / self.length

    def unknowns(self, place: Vector, axes: Matrix) -> Points:
        """Rows of a body at a position [m] with these axes."""
        return np.vstack([place, self.length * axes])


class RigidEnergy(Energy):
    """Stiffness/4 |A A^T - I|^2: penalty that keeps the axes A of a body a rotation."""

    convex: ClassVar[bool] = False

    def __init__(self, carriage: RigidBodyDofs, stiffness: float) -> None:
        """Take the unknowns of a body and the stiffness that holds its axes [J]."""
        self.carriage, self.stiffness = carriage, stiffness
        self.stencils = carriage.rows[None, 1:]

    def _axes(self, nodes: Nodes) -> tuple[Matrix, Matrix]:
        axes = self.carriage.axes(nodes)
        return axes, axes @ axes.T - np.eye(len(axes))

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(0.25 * self.stiffness * (self._axes(nodes)[1] ** 2).sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        axes, strain = self._axes(nodes)
        return (self.stiffness / self.carriage.length * strain @ axes)[None]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        axes, strain = self._axes(nodes)
        size, unit = axes.size, np.eye(len(axes))
        values, vectors = np.linalg.eigh(strain)
        strain = strain - share * (vectors * np.minimum(values, 0.0)) @ vectors.T
        inner = np.einsum("km,li,lj->kimj", unit, axes, axes)
        inner += np.einsum("mi,kj->kimj", axes, axes)
        inner += np.einsum("km,ij->kimj", strain, unit)
        return (self.stiffness / self.carriage.length**2 * inner).reshape(1, size, size)


class GuideEnergy(Energy):
    """Springs that hold a moving rigid body at a position and in an orientation."""

    has_constant_hessian: ClassVar[bool] = True

    def __init__(self, carriage: RigidBodyDofs, *, place: Vector, axes: Matrix, along: Matrix, turning: float) -> None:
        """Springs to a place [m] and to axes.

        Args:
            carriage: unknowns of the object.
            place: position at which its origin is held [m].
            axes: orientation in which its axes are held.
            along: stiffness of what holds its place [N/m], (dim, dim), positive semidefinite.
            turning: stiffness of what holds its axes [N/m], each at the length of the carriage from its place.
        """
        self.carriage = carriage
        self.stencils = carriage.rows[:, None]
        unit = np.eye(carriage.dim)
        self.stiffness = np.concatenate([along[None], np.repeat(turning * unit[None], carriage.dim, axis=0)])
        self.targets = carriage.unknowns(place, axes)
        self.stiffest = float(np.abs(self.stiffness).max())

    def with_target(self, place: Vector, axes: Matrix) -> "GuideEnergy":
        """Return the same springs to another position [m] and other axes."""
        other = copy(self)
        other.targets = self.carriage.unknowns(place, axes)
        return other

    def pull(self, nodes: Nodes) -> Vector:
        """Force of the springs on the origin of the body [N]."""
        return -self._forces(nodes)[0]

    def _forces(self, nodes: Nodes) -> Points:
        return np.einsum("rij,rj->ri", self.stiffness, nodes[self.carriage.rows] - self.targets)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(0.5 * np.vdot(nodes[self.carriage.rows] - self.targets, self._forces(nodes)))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._forces(nodes)[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.stiffness

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(np.abs(self.pull(nodes)).max())


class RigidBodyWarp:
    """Steps along arcs for a soft body and for rigid bodies, whose axes rotate with the initial spin of the step."""

    def __init__(self, body: StepMap, count: int, rigid_dofs: tuple[RigidBodyDofs, ...]) -> None:
        """Take the warp of a soft body, its number of nodes, and the rigid bodies whose rows follow."""
        self._body, self._count, self._rigid_dofs = body, count, rigid_dofs

    def __call__(self, nodes: Nodes, step: Nodes) -> Nodes:
        """Return the unknowns after a step [m]."""
        there = nodes + step
        there[: self._count] = self._body(
            np.ascontiguousarray(nodes[: self._count]), np.ascontiguousarray(step[: self._count])
        )
        for carriage in self._rigid_dofs:
            axes, rows = carriage.axes(nodes), carriage.rows[1:]
            there[rows] = carriage.length * _turn_axes(axes, step[rows] / carriage.length)
        return there


def _turn_axes(axes: Matrix, step: Matrix) -> Matrix:
    """Axes after a small change, the part of it that turns them as a rotation."""
    change = np.linalg.solve(axes, step)  # axes are rows: axes (I + change)
    spin = 0.5 * (change - change.T)
    return axes @ (np.eye(len(axes)) + change - spin) @ _rotation(spin)


def _rotation(spin: Matrix) -> Matrix:
    """Rotation, exp of an antisymmetric matrix (Rodrigues)."""
    angle = float(np.sqrt(0.5 * (spin**2).sum()))
    if angle < 1e-8:
        return np.eye(len(spin)) + spin + 0.5 * spin @ spin
    return np.eye(len(spin)) + np.sin(angle) / angle * spin + (1.0 - np.cos(angle)) / angle**2 * spin @ spin
