"""`RoutePoints`: points of all cables of a robot, and their motion with their rest positions."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Points
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.given import Point
from hydrostat.robot import Mount, Robot

RouteGradient = Float[np.ndarray, "_ dim"]
"""A row for each point of one cable; cables differ in how many they have."""


@dataclass(frozen=True, eq=False)
class RoutePoints:
    """Via points, cable after cable.

    In an element x(X) is linear, so a point that is moved in the rest shape moves by F in the pose. On the border of
    elements F jumps; it is then that of the element by which the point is held. A point outside the body is held at
    the nearest place of it, which moves only along the facet, the edge or not at all where it is a corner.

    Attributes:
        places: requested positions in the rest shape [m].
        rests: positions in the rest shape at which they are held [m]: the requested ones, projected onto the body if
            outside.
        mesh: mesh of the body.
        anchors: nodes and weights that hold the points.
        world: mask of the points fixed in space.
        starts: first point of each bare segment, in the order of the terms of a `CableEnergy`.
        cables: index of the cable that each bare segment belongs to.
        counts: number of points of each cable.
    """

    places: Points
    rests: Points
    mesh: Mesh
    anchors: Anchors
    world: Bool[np.ndarray, " points"]
    starts: Int[np.ndarray, " segments"]
    cables: Int[np.ndarray, " segments"]
    counts: tuple[int, ...]

    @cached_property
    def shape_gradients(self) -> Float[np.ndarray, "points corners dim"]:
        """Gradients of the weights in the rest shape [1/m]."""
        corners = self.mesh.nodes[self.anchors.stencils]
        inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
        return np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)

    @cached_property
    def projections(self) -> Float[np.ndarray, "points dim dim"]:
        """Derivative of the position that holds a point by the point: the identity inside the body.

        Outside it is the projection onto the plane or line of the corners that carry a weight.
        """
        projections = np.tile(np.eye(self.mesh.dim), (len(self.anchors.stencils), 1, 1))
        for outside in np.flatnonzero(~self.anchors.inside):
            corners = self.mesh.nodes[self.anchors.stencils[outside][self.anchors.weights[outside] > 0]]
            along = np.linalg.qr((corners[1:] - corners[0]).T)[0]
            projections[outside] = along @ along.T
        return projections

    def segments(
        self, starts: Int[np.ndarray, " segments"]
    ) -> tuple[
        Int[np.ndarray, "segments corners"], Float[np.ndarray, "segments corners"], Float[np.ndarray, "segments dim"]
    ]:
        """Stencils, signed weights and fixed offsets [m] of the segments that begin at these points."""
        weights = np.where(self.world[:, None], 0.0, self.anchors.weights)
        offsets = np.where(self.world[:, None], self.places, 0.0)
        ends, stencils = starts + 1, self.anchors.stencils
        return (
            np.concatenate([stencils[starts], stencils[ends]], axis=1),
            np.concatenate([-weights[starts], weights[ends]], axis=1),
            offsets[ends] - offsets[starts],
        )

    def positions(self, nodes: Nodes) -> Points:
        """Positions of the points [m] for given node positions [m]."""
        return np.where(self.world[:, None], self.places, self.anchors.positions(nodes))

    def values(self, field: Float[np.ndarray, "*rows nodes dim"]) -> Float[np.ndarray, "*rows points dim"]:
        """Fields of displacements at the points; 0 where they are fixed in space."""
        there = np.einsum("pc,...pcd->...pd", self.anchors.weights, field[..., self.anchors.stencils, :])
        return np.where(self.world[:, None], 0.0, there)

    def pulled_back(
        self, nodes: Nodes, sensitivities: Float[np.ndarray, "*rows points dim"]
    ) -> Float[np.ndarray, "*rows points dim"]:
        """Sensitivities to positions in the pose, turned into those to places in the rest shape: F^T times them."""
        back = self._through(nodes, sensitivities)
        return np.where(self.world[:, None], sensitivities, back)

    def values_pulled_back(
        self, field: Float[np.ndarray, "*rows nodes dim"], sensitivities: Points
    ) -> Float[np.ndarray, "*rows points dim"]:
        """Sensitivities by `values` of fields, as sensitivities by the places in the rest shape."""
        return np.where(self.world[:, None], 0.0, self._through(field, sensitivities))

    def held_back(self, sensitivities: Float[np.ndarray, "*rows points dim"]) -> Float[np.ndarray, "*rows points dim"]:
        """Convert derivatives by the held rest positions to derivatives by the requested positions."""
        held = np.einsum("pij,...pi->...pj", self.projections, sensitivities)
        return np.where(self.world[:, None], sensitivities, held)

    def spans(self, positions: Float[np.ndarray, "*rows points dim"]) -> Float[np.ndarray, "*rows segments dim"]:
        """From end to end of each bare segment."""
        return positions[..., self.starts + 1, :] - positions[..., self.starts, :]

    def gather_gradients(
        self, sensitivities: Float[np.ndarray, "*rows segments dim"]
    ) -> Float[np.ndarray, "*rows points dim"]:
        """Sensitivities to spans, turned into those to points; a point ends one segment at most, and begins one."""
        total = np.zeros((*sensitivities.shape[:-2], len(self.places), sensitivities.shape[-1]))
        total[..., self.starts + 1, :] += sensitivities
        total[..., self.starts, :] -= sensitivities
        return total

    def by_cable(self, rows: Points) -> tuple[RouteGradient, ...]:
        """Split rows by cable."""
        return tuple(np.split(rows, np.cumsum(self.counts)[:-1])) if self.counts else ()

    def _through(
        self, field: Float[np.ndarray, "*some nodes dim"], sensitivities: Float[np.ndarray, "*others points dim"]
    ) -> Float[np.ndarray, "*rows points dim"]:
        gradients = np.einsum("...pci,pcj->...pij", field[..., self.anchors.stencils, :], self.shape_gradients)
        back = np.einsum("...pij,...pi->...pj", gradients, sensitivities)
        return np.einsum("...pj,pjk->...pk", back, self.projections)


def route_points(robot: Robot) -> RoutePoints:
    """Points of all cables of a robot."""
    mesh, cables = robot.body.mesh, robot.cables
    counts = tuple(len(cable.points) for cable in cables)
    first = np.cumsum([0, *counts])[:-1]
    places = np.array([point for cable in cables for point in cable.points]).reshape(-1, mesh.dim)
    anchors = locate(mesh, places)
    world = np.zeros(len(places), dtype=bool)
    for start, cable in zip(first, cables, strict=True):
        world[start] = robot.winch(cable.winch).mount is Mount.WORLD
    bare = [np.flatnonzero(cable.bare) for cable in cables]
    none = np.zeros(0, dtype=np.int64)
    return RoutePoints(
        places=places,
        rests=np.where(world[:, None], places, anchors.positions(mesh.nodes)),
        mesh=mesh,
        anchors=anchors,
        world=world,
        starts=np.concatenate([none, *(start + own for start, own in zip(first, bare, strict=True))]),
        cables=np.repeat(np.arange(len(cables)), [len(own) for own in bare]),
        counts=counts,
    )


_held: WeakKeyDictionary[Mesh, tuple[tuple[tuple[float, ...], ...], Anchors]] = WeakKeyDictionary()
"""Markers of each mesh that lives: the places that were asked for last, and their anchors."""


def hold_markers(mesh: Mesh, places: Iterable[Point]) -> Anchors:
    """Read-only anchors of markers at rest positions [m]; the last are kept: networks on a body share its markers."""
    asked = tuple(tuple(float(number) for number in place) for place in places)
    known, anchors = _held.get(mesh, (None, None))
    if anchors is None or known != asked:
        anchors = locate(mesh, np.array(asked).reshape(-1, mesh.dim))
        for kept in (anchors.stencils, anchors.weights, anchors.distances):
            kept.setflags(write=False)
        _held[mesh] = asked, anchors
    return anchors
