"""Risks of markers."""

from collections.abc import Iterator

import numpy as np

from hydrostat.geometry.anchors import locate
from hydrostat.geometry.thickness import spacings
from hydrostat.robot.risks.words import Found, mm, told_together
from hydrostat.robot.robot import Robot

FAR = 1.5
"""A marker is far from any node at this many times the usual length of an element."""


def marker_risks(robot: Robot) -> Iterator[str]:
    """Markers that cannot move, and markers that the mesh knows badly."""
    if not robot.markers:
        return
    mesh = robot.body.mesh
    places = np.array([marker.at for marker in robot.markers], dtype=float)
    anchors = locate(mesh, places)
    held = np.any([pin.holds(mesh) for pin in robot.pins], axis=0)
    stuck = (held[anchors.stencils] | (anchors.weights < 1e-6)).all(axis=1) & ~held.all()
    yield from told_together(
        Found(f"marker[{index}] {robot.markers[index].name}", 0.0, "held by a pin, cannot move")
        for index in np.flatnonzero(stuck)
    )
    usual = float(np.median(spacings(mesh)))
    gaps = np.linalg.norm(mesh.nodes[None] - places[:, None], axis=2).min(axis=1)
    yield from told_together(
        Found(
            f"marker[{index}] {robot.markers[index].name}",
            float(gaps[index]),
            f"{mm(float(gaps[index]))} from the nearest node, where elements are {mm(usual)} long elsewhere: it moves "
            f"only as a coarse mesh does; make the mesh finer there",
        )
        for index in np.flatnonzero(gaps > FAR * usual)
    )
