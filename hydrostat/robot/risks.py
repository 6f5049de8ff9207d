"""`find_risks`: what is allowed but may disappoint, in plain words."""

from collections.abc import Iterator

import numpy as np

from hydrostat.geometry.quality import smallest_angle
from hydrostat.robot.body import Volume
from hydrostat.robot.cable import Cable
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Mount

LEAST_ANGLE = 20.0
"""Triangles with a smaller angle [degrees] make the simulation less exact."""

LOCKING_POISSON = 0.35
"""From this Poisson's ratio on, what locking adds to the bending stiffness of linear elements is worth a word."""

LOCKING = {
    2: {0.35: 0.14, 0.4: 0.20, 0.43: 0.27, 0.45: 0.35, 0.47: 0.54, 0.49: 1.4},
    3: {0.35: 0.12, 0.4: 0.20, 0.43: 0.31, 0.45: 0.45, 0.47: 0.77, 0.49: 2.4},
}
"""What it adds with 4 elements across a limb, a fraction, in the plane and in space (`benchmarks/locking.py`)."""

LEAST_COVER = 0.003
"""A cable nearer to the edge than this [m] tears out of the cloth."""


def find_risks(robot: Robot) -> list[str]:
    """One line for each risk; none if all is well."""
    return [*_body(robot), *_pins(robot), *_winches(robot), *_cables(robot), *_poses(robot)]


def _body(robot: Robot) -> Iterator[str]:
    mesh = robot.body.mesh
    if mesh.dim == 2 and smallest_angle(mesh) < LEAST_ANGLE:
        yield f"body: the mesh has an angle of {smallest_angle(mesh):.0f} degrees; try another element_size"
    poisson = robot.body.material.poisson
    if poisson >= LOCKING_POISSON and robot.body.volume is Volume.ELEMENT:
        added = max(part for ratio, part in LOCKING[mesh.dim].items() if ratio <= poisson)
        yield (
            f"body.material: Poisson's ratio {poisson:g}: linear elements lock; with 4 of them across a limb it can be "
            f'{100 * added:.0f} % too stiff in bending for that alone; try volume = "patch"'
        )


def _pins(robot: Robot) -> Iterator[str]:
    if np.any([pin.holds(robot.body.mesh) for pin in robot.pins], axis=0).all():
        yield "pin: every node of the body is held, nothing can move; make a radius or a box smaller"


def _winches(robot: Robot) -> Iterator[str]:
    for index, winch in enumerate(robot.winches):
        cables = [cable for cable in robot.cables if cable.winch == winch.name]
        if not cables:
            yield f"winch[{index}] {winch.name}: pulls no cable"
        for cable in cables:
            bare = float(cable.segments[cable.bare].sum())
            if winch.travel > bare:
                yield (
                    f"winch[{index}] {winch.name}: its travel of {_mm(winch.travel)} is longer than a cable it pulls "
                    f"({_mm(bare)} outside sheaths)"
                )
                break
        for other in robot.winches[:index]:
            gap = float(np.linalg.norm(np.subtract(winch.at, other.at)))
            if gap < winch.spool_radius + other.spool_radius:
                yield f"winch[{index}] {winch.name}: only {_mm(gap)} from winch {other.name}, their spools collide"


def _cables(robot: Robot) -> Iterator[str]:
    outline = robot.body.outline
    if outline is None:
        return
    from shapely import LineString, contains, distance, points

    for index, cable in enumerate(robot.cables):
        inside = _points_in_body(robot, cable)
        cover = distance(outline.polygon.boundary, points(inside))
        if cover.min() < LEAST_COVER:
            yield f"cable[{index}]: a point is only {_mm(float(cover.min()))} inside the edge and may tear out"
        if len(inside) > 1 and not contains(outline.polygon, LineString(inside)):
            yield f"cable[{index}]: it leaves the body between two of its points; add a point to lead it round"


def _points_in_body(robot: Robot, cable: Cable) -> np.ndarray:
    outside = robot.winch(cable.winch).mount is Mount.WORLD
    return np.array(cable.points[1:] if outside else cable.points)


def _poses(robot: Robot) -> Iterator[str]:
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    for pose in robot.poses.values():
        for name, target in pose.targets.items():
            moved = float(np.linalg.norm(places[name] - target))
            if moved > robot.body.mesh.size:
                yield f"pose {pose.name}: {name} should move {_mm(moved)}, farther than the body is long"


def _mm(length: float) -> str:
    return f"{1e3 * length:.3g} mm"
