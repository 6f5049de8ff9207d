"""`sensitivity_table`: how far the markers of a pose move if a number of the robot changes."""

from collections.abc import Iterator

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.drawing import Html
from hydrostat.geometry import locate
from hydrostat.ik import IKResult
from hydrostat.plot.report_tables import number, table
from hydrostat.robot import Robot
from hydrostat.simulation import Sensitivity, Simulation, marker_compliance
from hydrostat.units import MILLIMETERS

CHANGE, POISSON_CHANGE, FORCE = 0.1, 0.05, 0.1
"""Change of a number, as a share, that of a Poisson's ratio, and a force on a marker [N]."""


def sensitivity_table(reached: IKResult) -> Html:
    """Root mean square of the way of the targeted markers for a change of each number, to first order."""
    robot, names = reached.pose.robot, list(reached.pose_target.targets)
    sensitivities = _marker_sensitivities(robot, reached, names)
    ways = [reached.pose.markers[name] - np.array(robot.marker(name).at) for name in names]
    travel = _rms(np.concatenate(ways), names)
    rows = []
    for label, change, moves in (*_changes(robot, sensitivities), *_pushes(reached, names)):
        moved = _rms(moves, names)
        share = f"{100 * moved / travel:.1f} %" if travel > 0 else ""
        rows.append((label, change, number(MILLIMETERS * moved, 2), share))
    return table(("number", "change", "markers move [mm]", "of their way"), rows, numbers=(1, 2, 3))


def _rms(moves: Vector, names: list[str]) -> float:
    return float(np.sqrt((moves**2).sum() / max(len(names), 1)))


def _marker_sensitivities(robot: Robot, reached: IKResult, names: list[str]) -> list[Sensitivity]:
    """Sensitivities of each coordinate of the markers."""
    simulation, mesh = Simulation(robot), robot.body.mesh
    anchors = locate(mesh, np.array([robot.marker(name).at for name in names]))
    found = []
    for stencil, weights in zip(anchors.stencils, anchors.weights, strict=True):
        for axis in range(mesh.dim):
            coordinate = np.zeros(mesh.nodes.shape)
            coordinate[stencil, axis] = weights
            found.append(simulation.adjoint(reached.pose, coordinate))
    return found


def _changes(robot: Robot, sensitivities: list[Sensitivity]) -> Iterator[tuple[str, str, Vector]]:
    """Each number that is changed, by how much, and how far that moves each coordinate [m]."""
    body, share, poisson = robot.body, f"+{100 * CHANGE:.0f} %", f"+{POISSON_CHANGE:g}"

    def of(name: str) -> Float[np.ndarray, "coordinates numbers"]:
        return np.array([np.atleast_1d(getattr(each, name)) for each in sensitivities], dtype=float)

    yield "Young's modulus", share, CHANGE * body.material.young * of("young")[:, 0]
    yield "Poisson's ratio", poisson, POISSON_CHANGE * of("poisson")[:, 0]
    if robot.gravity is not None:
        yield "density", share, CHANGE * body.material.density * of("density")[:, 0]
    for index, part in enumerate(body.parts):
        if part.material is not None:
            yield f"Young's modulus of {part.name}", share, CHANGE * part.material.young * of("part_young")[:, index]
            yield f"Poisson's ratio of {part.name}", poisson, POISSON_CHANGE * of("part_poisson")[:, index]
    if body.thickness is not None:
        yield "thickness", share, CHANGE * body.thickness * of("thickness")[:, 0]
    cables = np.array([cable.stiffness for cable in robot.cables])
    yield "stiffness of all cables", share, CHANGE * of("cable_stiffness") @ cables
    yield "stiffness of all pins", share, CHANGE * of("pin_stiffness") @ np.array([pin.stiffness for pin in robot.pins])


def _pushes(reached: IKResult, names: list[str]) -> Iterator[tuple[str, str, Vector]]:
    """Force on each marker in its softest direction; none where physics remember the way."""
    simulation = Simulation(reached.pose.robot)
    if simulation.assembly.has_history:
        return
    compliances = marker_compliance(simulation, reached.pose)
    chosen = [index for index, marker in enumerate(simulation.robot.markers) if marker.name in names]
    softest = np.linalg.norm(compliances[chosen], ord=2, axis=(1, 2))
    yield "force on each marker in its softest direction", f"{FORCE:g} N", FORCE * softest
