"""`ObstacleEnergy`: a body does not pass through a rigid obstacle."""

from copy import copy
from dataclasses import replace
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.geometry import DistanceField, Distances, Mesh
from hydrostat.kernel import native
from hydrostat.mechanics.energy import (
    Blocks,
    Compliance,
    ContactForces,
    Energy,
    HessianBlocks,
    Response,
    ScatterMap,
    Stencils,
    nearest_semidefinite,
)
from hydrostat.mechanics.obstacle_friction import ObstacleFriction
from hydrostat.mechanics.rigid import RigidBodyDofs


class ObstacleEnergy(Energy):
    """Barrier between samples of a body's boundary and a rigid obstacle, and Coulomb friction along it.

    A term is a sample: a node of the boundary, the middle of an edge, in space of a facet too. Its energy at distance d
    is W h^2 phi(d^2/h^2), phi(r) = -(r - 1)^2 ln r below r = 1, with h the distance at which it is felt.

    All that an obstacle does is a function of where a sample is in the frame of the obstacle. If that moves, its rows
    among the unknowns belong to the stencil of every sample. With friction its history is the anchors of its
    `ObstacleFriction`.
    """

    convex: ClassVar[bool] = False
    projects_first: ClassVar[bool] = True
    STICKS: ClassVar[float] = 10.0
    """Stiffness of a sample along the surface per area, in units of Young's modulus / distance."""

    def __init__(
        self,
        mesh: Mesh,
        field: DistanceField,
        *,
        distance: float,
        young: float,
        thickness: float | None = None,
        friction: float = 0.0,
        carriage: RigidBodyDofs | None = None,
    ) -> None:
        """Barrier of a body at rest.

        Args:
            mesh: mesh of the body.
            field: distance of points from the obstacle, in its frame.
            distance: distance at which contact forces start [m].
            young: pressure at half that distance: Young's modulus [Pa].
            thickness: thickness of a flat body [m].
            friction: Coulomb's coefficient mu.
            carriage: unknowns of its frame; None for a static obstacle.
        """
        self.field, self.distance, self.carriage = field, distance, carriage
        self._corners, self.shares, areas = _samples(mesh)
        areas = areas * (thickness or 1.0)
        self.weights = young * areas / (_HALF_WAY * distance)
        self.stencils = self._corners
        if carriage is not None:
            rows = np.broadcast_to(carriage.rows, (len(areas), len(carriage.rows)))
            self.stencils = np.concatenate([self._corners, rows], axis=1)
        self.has_history = friction > 0
        self._friction = friction, self.STICKS * young / distance * areas
        self.grip: ObstacleFriction | None = None
        self._seen: tuple[Nodes, Points, Vector] | None = None

    def places(self, nodes: Nodes) -> Points:
        """Positions of the samples in the frame of the obstacle [m]."""
        points = self._points(nodes)
        if self.carriage is None:
            return points
        return (points - self.carriage.place(nodes)) @ self.carriage.axes(nodes).T

    def gap(self, nodes: Nodes) -> float:
        """Distance of the nearest sample [m]; negative inside the obstacle."""
        return float(self._locate_samples(nodes)[1].min())

    def value(self, nodes: Nodes, controls: Vector) -> float:
        places, distances = self._locate_samples(nodes)
        if not distances.min() > 0:
            return np.inf
        some = np.flatnonzero(distances < self.distance)
        r = (distances[some] / self.distance) ** 2
        barrier = float(self.distance**2 * (self.weights[some] * (r - 1.0) ** 2) @ -np.log(r))
        if self.grip is None:
            return barrier
        held = np.flatnonzero(self.grip.limits)
        return barrier + self.grip.only(held).energy(places[held])

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.zeros((*self.stencils.shape, nodes.shape[1]))
        some, forces = self._forces(nodes)
        blocks[some] = self._by_unknowns(nodes, some, forces)
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        some, forces = self._forces(nodes)
        if len(some):
            native.add_vectors(self.stencils[some], self._by_unknowns(nodes, some, forces), total)

    def push(self, nodes: Nodes) -> Vector:
        """Force of the body on the obstacle [N]."""
        return self._forces_in_world(nodes)[1].sum(axis=0)

    def contact_forces(self, nodes: Nodes) -> ContactForces:
        some, forces = self._forces_in_world(nodes)
        felt = forces.any(axis=1)
        some = some[felt]
        return ContactForces(self._points(nodes)[some], -forces[felt], self._corners[some])

    def _points(self, nodes: Nodes) -> Points:
        """Positions of the samples [m]."""
        points = np.empty((len(self._corners), nodes.shape[1]))
        native.sample_places(nodes, self._corners, self.shares, points)
        return points

    def _locate_samples(self, nodes: Nodes) -> tuple[Points, Vector]:
        """Positions of the samples and their distances [m]; the last result is cached.

        Threads may share the energy, so all of what is kept is read and replaced at once.
        """
        seen = self._seen
        if seen is None or not np.array_equal(seen[0], nodes):
            places = self.places(nodes)
            self._seen = seen = nodes.copy(), places, self.field.values(places)
        return seen[1:]

    def _active_samples(self, nodes: Nodes) -> np.ndarray:
        """Samples in contact with the obstacle, or held by friction."""
        felt = self._locate_samples(nodes)[1] < self.distance
        return np.flatnonzero(felt if self.grip is None else felt | (self.grip.limits > 0))

    def _forces_in_world(self, nodes: Nodes) -> tuple[np.ndarray, Points]:
        some, forces = self._forces(nodes)
        return some, forces if self.carriage is None else forces @ self.carriage.axes(nodes)

    def _forces(self, nodes: Nodes) -> tuple[np.ndarray, Points]:
        """Samples on which forces act, and the derivative of the energy by the place of each in the frame [N]."""
        some = self._active_samples(nodes)
        places = self._locate_samples(nodes)[0][some]
        found = self.field(places)
        forces = self._derivatives(found, self.weights[some])[0][:, None] * found.normals
        return some, forces if self.grip is None else forces + self.grip.only(some).forces(places)

    def _by_unknowns(self, nodes: Nodes, some: np.ndarray, forces: Points) -> Blocks:
        """Derivatives by the unknowns of the stencils of some samples, of derivatives by their places."""
        if self.carriage is None:
            return self.shares[some, :, None] * forces[:, None, :]
        return np.einsum("tk,tkri->tri", forces, self._gap_jacobians(nodes, some))

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks, some = np.zeros((len(self.stencils), size, size)), self._active_samples(nodes)
        blocks[some] = self._blocks(nodes, some, share)
        return blocks

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        some = self._active_samples(nodes)
        if len(some):
            blocks = self._blocks(nodes, some, share)
            native.add_blocks(self.stencils[some], places.slots[some], places.strides, blocks, places.data)

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        """By conservative advancement: a sample cannot meet the obstacle before distance / speed."""
        distances = self._locate_samples(nodes)[1]
        speeds = self._speeds(nodes, move)
        kept = 0.1  # No step takes more than 1 less this share of the gap
        some = np.flatnonzero(((1.0 - kept) * distances < speeds) & (speeds > 0))
        distances, speeds = distances[some], speeds[some]
        least, done, going = kept * distances, np.zeros(len(some)), np.arange(len(some))
        advances = 200  # Steps of a conservative advancement
        for _ in range(advances):
            if not len(going):
                break
            done[going] += (distances[going] - least[going]) / speeds[going]
            distances[going] = self.field.values(self._on_the_way(nodes, move, some[going], done[going]))
            going = going[(done[going] < 1.0) & (distances[going] > 1.1 * least[going])]
        near = distances <= 1.1 * least
        near[going] = True
        least_step = 1e-12  # Steps are above 0
        return float(np.clip(done[near & (done > 0)].min(initial=1.0), least_step, 1.0))

    @property
    def history(self) -> Vector:
        """Anchor of each sample in the frame of the obstacle [m], one after another."""
        return np.zeros(0) if self.grip is None else self.grip.anchors.ravel()

    def with_friction_at_rest(self, nodes: Nodes) -> "ObstacleEnergy":
        """Return this energy with friction springs in their rest state."""
        return (
            self._gripping(ObstacleFriction.at_rest(*self._friction, self.places(nodes))) if self.has_history else self
        )

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> "ObstacleEnergy":
        if self.grip is None:
            return self
        still = replace(self.grip, anchors=history.reshape(self.grip.anchors.shape))
        return self._gripping(still.with_normal_forces(*self._pushes(nodes)))

    def history_residual(self, nodes: Nodes, controls: Vector) -> float:
        if self.grip is None:
            return 0.0
        some = self._active_samples(nodes)
        places, grip = self._locate_samples(nodes)[0][some], self.grip.only(some)
        pushes, normals = self._pushes(nodes)
        asked = grip.with_normal_forces(pushes[some], normals[some])
        return float(np.abs(asked.forces(places) - grip.forces(places)).max(initial=0.0))

    def with_corrected_history(
        self, nodes: Nodes, controls: Vector, compliance: Compliance | None, response: Response | None = None
    ) -> "ObstacleEnergy":
        if self.grip is None:
            return self
        places, grip = (
            self._locate_samples(nodes)[0],
            self.grip.with_adapted_relaxation(self.history_residual(nodes, controls)),
        )
        pushes, normals = self._pushes(nodes)
        some = np.flatnonzero((pushes > 0) | (grip.limits > 0))
        if response is None or not len(some):
            return self._gripping(grip.with_corrected_history(pushes, normals))
        found, there = self.field(places[some]), grip.only(some)
        fresh = there.limits == 0
        there = replace(there, share=grip.share, normals=np.where(fresh[:, None], found.normals, there.normals))
        curves = self._derivatives(found, self.weights[some])[1]
        derivatives = self._fixed_jacobians(some) if self.carriage is None else self._gap_jacobians(nodes, some)
        answer, stencils = response, self.stencils[some]

        def respond(limits: Vector, turns: Points) -> tuple[Vector, Points]:
            pulls, forces = there.force_changes(places[some], limits, turns), np.zeros_like(nodes)
            native.add_vectors(stencils, np.einsum("tk,tkri->tri", pulls, derivatives), forces)
            moves = np.einsum("tkri,tri->tk", derivatives, -answer(forces.ravel()).reshape(nodes.shape)[stencils])
            return -curves * (found.normals * moves).sum(axis=1), np.einsum("tkl,tl->tk", found.curvatures, moves)

        solved = there.with_joint_step(pushes[some], normals[some], respond)
        limits, after = grip.limits.copy(), normals.copy()
        limits[some], after[some] = solved.limits, solved.normals
        return self._gripping(replace(grip, limits=limits, normals=after, trail=()))

    def _fixed_jacobians(self, some: np.ndarray) -> Float[np.ndarray, "some dim rows dim"]:
        return np.einsum("tc,ki->tkci", self.shares[some], np.eye(self.shares.shape[1]))

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> "ObstacleEnergy":
        if self.grip is None:
            return self
        return self._gripping(
            self.grip.with_normal_forces(*self._pushes(nodes)).drag_anchors(self._locate_samples(nodes)[0])
        )

    def _gripping(self, grip: ObstacleFriction) -> "ObstacleEnergy":
        other = copy(self)
        other.grip = grip
        return other

    def _pushes(self, nodes: Nodes) -> tuple[Vector, Points]:
        """Normal force on each sample [N], and the normals where forces act."""
        some, pushes = self._active_samples(nodes), np.zeros(len(self._corners))
        normals = np.zeros((len(pushes), nodes.shape[1]))
        found = self.field(self._locate_samples(nodes)[0][some])
        pushes[some], normals[some] = -self._derivatives(found, self.weights[some])[0], found.normals
        return pushes, normals

    def _gap_jacobians(self, nodes: Nodes, some: np.ndarray) -> Float[np.ndarray, "some dim rows dim"]:
        """Derivatives of the place in the frame by the unknowns of the stencil; only of an obstacle that moves."""
        assert self.carriage is not None
        axes, dim = self.carriage.axes(nodes), self.carriage.dim
        spans = self._points(nodes)[some] - self.carriage.place(nodes)
        by_corner = np.einsum("tc,ki->tkci", self.shares[some], axes)
        by_place = np.broadcast_to(-axes[:, None, :], (len(some), dim, 1, dim))
        by_axes = np.einsum("km,ti->tkmi", np.eye(dim), spans) / self.carriage.length
        return np.concatenate([by_corner, by_place, by_axes], axis=2)

    def _speeds(self, nodes: Nodes, move: Nodes) -> Vector:
        """Bound of each sample's displacement in the obstacle's frame for a straight move of the unknowns [m]."""
        way = self._points(move)
        if self.carriage is None:
            return _lengths(way)
        begin, end = self.carriage.axes(nodes), self.carriage.axes(nodes + move)
        largest = max(np.linalg.norm(begin, 2), np.linalg.norm(end, 2))
        spans = self._points(nodes) - self.carriage.place(nodes)
        way = way - move[self.carriage.row]
        reach = np.maximum(_lengths(spans), _lengths(spans + way))
        return largest * _lengths(way) + np.linalg.norm(end - begin, 2) * reach

    def _on_the_way(self, nodes: Nodes, move: Nodes, some: np.ndarray, shares: Vector) -> Points:
        """Positions of some samples in the obstacle's frame, each after its own share of a straight move [m]."""
        corners = self._corners[some]
        moved = nodes[corners] + shares[:, None, None] * move[corners]
        points = np.einsum("tc,tcd->td", self.shares[some], moved)
        if self.carriage is None:
            return points
        begin, end = self.carriage.axes(nodes), self.carriage.axes(nodes + move)
        spans = points - self.carriage.place(nodes) - shares[:, None] * move[self.carriage.row]
        return spans @ begin.T + shares[:, None] * (spans @ (end - begin).T)

    def _derivatives(self, found: Distances, weights: Vector) -> tuple[Vector, Vector]:
        """First two derivatives of terms of these weights by their distances."""
        d = found.values
        r = (d / self.distance) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            log, below = -np.log(r), r - 1.0
            derivative = 2.0 * below * log - below**2 / r
            curve = 2.0 * log - 4.0 * below / r + (below / r) ** 2
        scale = weights * (r < 1.0)
        one = np.where(r < 1.0, 2.0 * scale * derivative * d, 0.0)
        two = np.where(r < 1.0, scale * (2.0 * derivative + 4.0 * r * curve), 0.0)
        return one, two

    def _blocks(self, nodes: Nodes, some: np.ndarray, share: float) -> HessianBlocks:
        """Hessian of some terms without a share of its negative part."""
        places = self._locate_samples(nodes)[0][some]
        found = self.field(places)
        derivative, curve = self._derivatives(found, self.weights[some])
        inner = curve[:, None, None] * (found.normals[:, :, None] * found.normals[:, None, :])
        kept = 1.0 - share if self.carriage is None else 1.0
        inner = inner + (kept * derivative)[:, None, None] * found.curvatures
        forces = derivative[:, None] * found.normals
        if self.grip is not None:
            grip = self.grip.only(some)
            inner = inner + grip.stiffness(places)
            forces = forces + grip.forces(places)
        dim, corners = inner.shape[1], self.shares.shape[1]
        if self.carriage is None:
            blocks = np.einsum("ta,tb,tij->taibj", self.shares[some], self.shares[some], inner)
            return blocks.reshape(len(some), corners * dim, corners * dim)
        derivatives = self._gap_jacobians(nodes, some).reshape(len(some), dim, dim * (corners + 1 + dim))
        blocks = np.einsum("tkr,tkl,tls->trs", derivatives, inner, derivatives)
        bends = blocks.reshape(len(some), corners + 1 + dim, dim, corners + 1 + dim, dim)
        by_point = np.concatenate([self.shares[some], -np.ones((len(some), 1))], axis=1)
        mixed = 1.0 / self.carriage.length * by_point[:, :, None] * forces[:, None, :]
        axis = np.arange(dim)
        bends[:, : corners + 1, axis, corners + 1 :, axis] += mixed[None]
        bends[:, corners + 1 :, axis, : corners + 1, axis] += np.swapaxes(mixed, 1, 2)[None]
        return blocks + share * (nearest_semidefinite(blocks) - blocks) if share else blocks


def _samples(mesh: Mesh) -> tuple[Stencils, Float[np.ndarray, "terms corners"], Vector]:
    """Samples of the boundary: corners of a facet that has each, their shares, the area that it stands for [m^dim-1].

    Areas are the weights of Simpson's rule in the plane, and of the rule of seven points of degree 3 in space.
    """
    dim, areas = mesh.dim, mesh.facet_areas()[0]
    rules = [(np.eye(dim), 1 / 6 if dim == 2 else 1 / 20)]
    if dim == 3:
        rules.append((0.5 * (1 - np.eye(3)), 2 / 15))
    rules.append((np.full((1, dim), 1 / dim), 2 / 3 if dim == 2 else 9 / 20))
    points, shares = np.concatenate([rule for rule, _ in rules]), np.concatenate([[w] * len(r) for r, w in rules])
    facets = np.sort(mesh.boundary, axis=1)
    stencils = np.repeat(facets, len(points), axis=0)
    weights = np.tile(points, (len(facets), 1))
    used = np.where(weights > 0, stencils, -1)  # what two facets share is one sample
    _, firsts, whose = np.unique(np.sort(used, axis=1), axis=0, return_index=True, return_inverse=True)
    area = np.bincount(whose.ravel(), np.outer(areas, shares).ravel())
    return np.ascontiguousarray(stencils[firsts]), np.ascontiguousarray(weights[firsts]), area


_HALF_WAY = 4.329
"""Force of the barrier phi at half its distance, where its factor and distance are 1: 2 phi'(1/4) x 1/2."""


def _lengths(vectors: Points) -> Vector:
    return np.sqrt(np.einsum("pd,pd->p", vectors, vectors))
