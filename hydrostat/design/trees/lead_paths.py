"""`LeadPaths`: where winches of trees may stand, and the ways from there to where routes begin (R14, R41)."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.design.constraints import Constraints
from hydrostat.design.polyline import Route
from hydrostat.design.region import Region
from hydrostat.errors import InputError
from hydrostat.robot import Mount, Robot


@dataclass(frozen=True, eq=False)
class LeadPaths:
    """Points inside a body joined by straight runs that keep clear of its edge; then winches fixed in the world.

    A run to a winch in the world goes that way only, so that no lead passes through one.
    """

    points: Points  # in the body, then in the world [m]
    within: int  # how many of them are in the body
    places: Int[np.ndarray, " places"]  # points where a winch may stand
    runs: csr_array  # length of each run [m]
    region: Region  # that the runs keep to

    def outside(self, place: int) -> bool:
        """True if a point is in the world."""
        return place >= self.within

    def door(self, point: Vector) -> int:
        """Nearest point in sight of a place in the body that has a way on, or just the nearest."""
        points, ways = self.points[: self.within], np.diff(self.runs.indptr)[: self.within]
        order = np.argsort(np.linalg.norm(points - point, axis=1), kind="stable")[:_NEAREST]
        order = order[ways[order] > 0] if ways[order].any() else order
        seen = self.region.sees(np.tile(point, (len(order), 1)), points[order])
        return int(order[np.argmax(seen)])

    def lengths(self, ends: Points) -> Float[np.ndarray, "ends places"]:
        """Length of the way from each end in the body to every place; infinite where there is none [m]."""
        doors = [self.door(end) for end in ends]
        away = dijkstra(self.runs, indices=doors)[:, self.places]
        return away + np.linalg.norm(self.points[doors] - ends, axis=1)[:, None]

    def path(self, place: int, end: Vector) -> Route:
        """Points from a winch towards an end in the body, which is left out, with as few bends as the body allows."""
        _, before = dijkstra(self.runs.T, indices=place, return_predecessors=True)
        path = [self.door(end)]
        while path[-1] != place and before[path[-1]] >= 0:
            path.append(int(before[path[-1]]))
        way = np.vstack([self.points[path[::-1]], end])
        if path[-1] != place:
            way = np.vstack([self.points[place], way])
        kept = [0]
        while kept[-1] < len(way) - 1:
            ahead = np.arange(len(way) - 1, kept[-1], -1)
            seen = self.region.sees(np.repeat(way[kept[-1] : kept[-1] + 1], len(ahead), axis=0), way[ahead])
            kept.append(int(ahead[np.argmax(seen)]) if seen.any() else kept[-1] + 1)
        return way[kept[:-1]]


_NEAREST = 12  # so many points are looked at for one in sight


def find_lead_paths(robot: Robot, region: Region, constraints: Constraints) -> LeadPaths:
    """The ways of a body: mesh nodes and the mesh edges that keep clear; in space, nodes are moved inside first.

    Few nodes of a body in space lie off its surface. Where all winches of the robot are fixed in the world, winches
    stand there, each joined to the points nearest the part that is held, where cables enter the body (R54); else they
    stand wherever the body is deep enough. Raises InputError if it is nowhere.
    """
    mesh = robot.body.mesh
    points = mesh.nodes if mesh.dim == 2 else region.push_inside(mesh.nodes)
    edges = mesh.edges[region.sees(*np.swapaxes(points[mesh.edges], 0, 1))]
    pairs = np.concatenate([edges, edges[:, ::-1]])
    if robot.winches and all(winch.mount is Mount.WORLD for winch in robot.winches):
        winches = np.array([winch.at for winch in robot.winches], dtype=float)
        places = np.arange(len(points), len(points) + len(winches))
        pairs = np.concatenate([pairs, _entries(robot, region, points, places)])
        points = np.concatenate([points, winches])
    else:
        places = np.flatnonzero(region.depths(points) >= constraints.winch_clearance)
        if not len(places):
            raise InputError(
                f"no place of the body is {1e3 * constraints.winch_clearance:g} mm from its edge: no winch fits; "
                "lower the winch clearance"
            )
    lengths = np.linalg.norm(points[pairs[:, 1]] - points[pairs[:, 0]], axis=1)
    runs = csr_array((lengths, (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    return LeadPaths(points, len(mesh.nodes), places, runs, region)


def _entries(
    robot: Robot, region: Region, points: Points, winches: Int[np.ndarray, " winches"]
) -> Int[np.ndarray, "pairs 2"]:
    """From points in or nearest the part that is held, and deep enough, to each winch."""
    mesh = robot.body.mesh
    held = np.concatenate([pin.anchors(mesh).positions(mesh.nodes) for pin in robot.pins])
    away = np.linalg.norm(points[:, None] - held[None], axis=2).min(axis=1)
    deep: Bool[np.ndarray, " points"] = region.depths(points) >= region.clearance
    away[~deep] = np.inf
    spacing = float(mesh.edge_lengths.mean())
    near = np.flatnonzero(away <= max(spacing, float(away.min())) * (1 + 1e-9))
    return np.column_stack([np.tile(near, len(winches)), np.repeat(winches, len(near))])
