"""Risks of pins, markers and poses."""

from collections.abc import Iterator

import numpy as np

from hydrostat.arrays import Float, Points
from hydrostat.geometry import Mesh, locate
from hydrostat.robot.risks.words import Risk, known_up_to, merge_risks, mm
from hydrostat.robot.robot import Robot
from hydrostat.units import plural


def pin_risks(robot: Robot) -> Iterator[str]:
    """Pins that hold all or hardly anything. None at all is an error, which `Robot` raises."""
    mesh = robot.body.mesh
    held = [pin.holds(mesh) for pin in robot.pins]
    if np.any(held, axis=0).all():
        yield "pin: every node of the body is held, nothing can move; make a radius or a box smaller"
    reach = 1.5 * float(np.median(mesh.spacings))
    found = []
    for index, nodes in enumerate(held):
        count = int(nodes.sum())
        if count < mesh.dim:
            grip = f"holds only {plural(count, 'node')}" if count else "reaches no node and holds a single point"
            text = f"{grip}, about which the body can turn and tear; a radius of {mm(reach)} would grip it"
            found.append(Risk(f"pin[{index}]", -count, text))
    yield from merge_risks(found)


def marker_risks(robot: Robot) -> Iterator[str]:
    """Find markers that cannot move, and markers that the mesh resolves badly."""
    if not robot.markers:
        return
    mesh = robot.body.mesh
    places = np.array([marker.at for marker in robot.markers], dtype=float)
    anchors = locate(mesh, places)
    held = np.any([np.zeros(len(mesh.nodes), bool), *(pin.holds(mesh) for pin in robot.pins)], axis=0)
    stuck = (held[anchors.stencils] | (anchors.weights < 1e-6)).all(axis=1) & ~held.all()
    yield from merge_risks(
        Risk(f"marker[{index}] {robot.markers[index].name}", 0.0, "held by a pin, cannot move")
        for index in np.flatnonzero(stuck)
    )
    usual = float(np.median(mesh.spacings))
    gaps = np.linalg.norm(mesh.nodes[None] - places[:, None], axis=2).min(axis=1)
    far = 1.5  # a marker is far from any node at this many times the usual length of an element
    yield from merge_risks(
        Risk(
            f"marker[{index}] {robot.markers[index].name}",
            float(gaps[index]),
            f"{mm(float(gaps[index]))} from the nearest node, where elements are {mm(usual)} long elsewhere: it moves "
            f"only as a coarse mesh does; make the mesh finer there",
        )
        for index in np.flatnonzero(gaps > far * usual)
    )


def pose_risks(robot: Robot) -> Iterator[str]:
    """Targets that are too far, or so far from a pin that the material would have to stretch too much."""
    far = list(_far(robot))
    yield from merge_risks(far)
    told = {risk.part for risk in far}
    yield from merge_risks(risk for risk in _stretching(robot) if risk.part not in told)


def _far(robot: Robot) -> Iterator[Risk]:
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    for pose in robot.poses.values():
        for name, target in pose.targets.items():
            moved = float(np.linalg.norm(places[name] - target))
            if moved > robot.body.mesh.size:
                text = f"{name} should move {mm(moved)}, farther than the body is long"
                yield Risk(f"pose {pose.name}", moved, text)


def _stretching(robot: Robot) -> Iterator[Risk]:
    """Estimate the minimum stretch: the path through the body from a pin to a marker must reach the straight distance.

    At rest it is measured along edges, which makes it up to a tenth too long, never too short.
    """
    material, mesh = robot.body.material, robot.body.mesh
    held = np.flatnonzero(np.any([np.zeros(len(mesh.nodes), bool), *(pin.holds(mesh) for pin in robot.pins)], axis=0))
    if material.largest_stretch is None or not robot.poses or not len(held):
        return
    places = np.array([marker.at for marker in robot.markers], dtype=float)
    rows = {marker.name: row for row, marker in enumerate(robot.markers)}
    short = 2.0 * float(np.median(mesh.spacings))  # ways of fewer elements than this tell nothing of a stretch
    direct = np.maximum(np.linalg.norm(mesh.nodes[held] - places[:, None], axis=2), short)  # no way is shorter
    most = max(
        (
            float((np.linalg.norm(mesh.nodes[held] - target, axis=1) / direct[rows[name]]).max())
            for pose in robot.poses.values()
            for name, target in pose.targets.items()
        ),
        default=0.0,
    )
    if most <= material.largest_stretch:  # of most robots: thus they need no search for ways
        return
    ways = _ways(mesh, places)[:, held]
    ways[ways < short] = np.inf
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
                yield Risk(f"pose {pose.name}", stretch, text)


def _ways(mesh: Mesh, places: Points) -> Float[np.ndarray, "places nodes"]:
    """Path length from each point to each node [m], straight to the nearest node and on along edges."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    one, two = mesh.edges.T
    lengths = np.linalg.norm(mesh.nodes[one] - mesh.nodes[two], axis=1)
    graph = coo_array((lengths, (one, two)), shape=(len(mesh.nodes), len(mesh.nodes))).tocsr()
    gaps = np.linalg.norm(mesh.nodes[None] - places[:, None], axis=2)
    nearest = np.argmin(gaps, axis=1)
    return dijkstra(graph, directed=False, indices=nearest) + gaps[np.arange(len(places)), nearest][:, None]
