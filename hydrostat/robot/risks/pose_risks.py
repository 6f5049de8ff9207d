"""Risks of poses."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_array

from hydrostat.arrays import Points
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.thickness import spacings
from hydrostat.robot.risks.words import Found, known_up_to, mm, told_together
from hydrostat.robot.robot import Robot

_SHORT = 2.0
"""Ways of fewer elements than this tell nothing of a stretch."""


def pose_risks(robot: Robot) -> Iterator[str]:
    """Targets that are too far, or so far from a pin that the material would have to stretch too much."""
    far = list(_far(robot))
    yield from told_together(far)
    told = {risk.part for risk in far}
    yield from told_together(risk for risk in _stretching(robot) if risk.part not in told)


def _far(robot: Robot) -> Iterator[Found]:
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    for pose in robot.poses.values():
        for name, target in pose.targets.items():
            moved = float(np.linalg.norm(places[name] - target))
            if moved > robot.body.mesh.size:
                text = f"{name} should move {mm(moved)}, farther than the body is long"
                yield Found(f"pose {pose.name}", moved, text)


def _stretching(robot: Robot) -> Iterator[Found]:
    """An estimate from below: the way through the body from a pin to a marker must grow to the straight line at least.

    At rest it is measured along edges, which makes it up to a tenth too long, never too short.
    """
    material, mesh = robot.body.material, robot.body.mesh
    held = np.flatnonzero(np.any([pin.holds(mesh) for pin in robot.pins], axis=0))
    if material.largest_stretch is None or not robot.poses or not len(held):
        return
    ways = _ways(mesh, np.array([marker.at for marker in robot.markers], dtype=float))[:, held]
    ways[ways < _SHORT * np.median(spacings(mesh))] = np.inf
    rows = {marker.name: row for row, marker in enumerate(robot.markers)}
    limit = known_up_to(material, f"{material.largest_stretch:g} times")
    for pose in robot.poses.values():
        for name, target in pose.targets.items():
            straight = np.linalg.norm(mesh.nodes[held] - target, axis=1)
            stretches = straight / ways[rows[name]]
            pin = int(np.argmax(stretches))
            stretch, before = float(stretches[pin]), float(ways[rows[name], pin])
            if stretch > material.largest_stretch:
                text = (
                    f"{name} should be {mm(float(straight[pin]))} from a pinned place, at rest it is {mm(before)} "
                    f"through the body: {stretch:.2f} times as long; {limit}"
                )
                yield Found(f"pose {pose.name}", stretch, text)


def _ways(mesh: Mesh, places: Points) -> Float[np.ndarray, "places nodes"]:
    """Length of the way from each place to each node [m], straight to the nearest node and on along edges."""
    from scipy.sparse.csgraph import dijkstra

    one, two = mesh.edges.T
    lengths = np.linalg.norm(mesh.nodes[one] - mesh.nodes[two], axis=1)
    graph = coo_array((lengths, (one, two)), shape=(len(mesh.nodes), len(mesh.nodes))).tocsr()
    gaps = np.linalg.norm(mesh.nodes[None] - places[:, None], axis=2)
    nearest = np.argmin(gaps, axis=1)
    return dijkstra(graph, directed=False, indices=nearest) + gaps[np.arange(len(places)), nearest][:, None]
