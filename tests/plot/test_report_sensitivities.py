"""Table of sensitivities in a report. Oracle: poses solved again with a number that is changed by a little."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from builders import strip_robot

from hydrostat.ik import solve_ik
from hydrostat.mechanics import NewtonOptions
from hydrostat.plot.report_sensitivities import sensitivity_table
from hydrostat.robot import BodyPart, Load, Material, PoseTarget, Robot
from hydrostat.simulation import Simulation


def parted() -> Robot:
    robot = strip_robot(columns=10, rows=2)
    material = Material(young=60e3, poisson=0.2, density=80)
    part = BodyPart(name="knee", shape="box", at=(0.05, -1.0), to=(0.1, 1.0), material=material)
    return replace(robot, body=robot.body.with_parts([part]), gravity=(0.0, -9.81))


def change_poisson(robot: Robot, change: float) -> Robot:
    material = robot.body.material
    return replace(
        robot, body=replace(robot.body, material=replace(material, poisson=material.poisson + 0.05 * change))
    )


def change_part(robot: Robot, change: float) -> Robot:
    (part,) = robot.body.parts
    assert part.material is not None
    material = replace(part.material, young=part.material.young * (1 + 0.1 * change))
    return replace(robot, body=replace(robot.body, parts=(replace(part, material=material),)))


def change_thickness(robot: Robot, change: float) -> Robot:
    assert robot.body.thickness is not None
    return replace(robot, body=replace(robot.body, thickness=robot.body.thickness * (1 + 0.1 * change)))


def change_cables(robot: Robot, change: float) -> Robot:
    cables = [replace(cable, stiffness=cable.stiffness * (1 + 0.1 * change)) for cable in robot.cables]
    return robot.with_network(robot.winches, cables)


ROWS: dict[str, Callable[[Robot, float], Robot]] = {
    "Poisson's ratio": change_poisson,
    "Young's modulus of knee": change_part,
    "thickness": change_thickness,
    "stiffness of all cables": change_cables,
}


def test_markers_move_as_far_as_the_table_says() -> None:
    """A thousandth of each change, times a thousand, to the digits of the table."""
    robot = parted()
    reached = solve_ik(Simulation(robot), PoseTarget(name="up", targets={"tip": (0.17, 0.05)}))
    rows = re.findall(r"<tr>(.*?)</tr>", str(sensitivity_table(reached)), re.DOTALL)
    cells = [re.findall(r"<td[^>]*>(.*?)</td>", row, re.DOTALL) for row in rows]
    table = {re.sub("&#(x27|39);", "'", row[0]): row for row in cells if row}
    assert set(ROWS) < set(table)
    assert {"Young's modulus", "density", "Poisson's ratio of knee", "stiffness of all pins"} < set(table)
    for label, change in ROWS.items():
        ends = []
        for side in (1e-3, -1e-3):
            simulation = Simulation(change(robot, side), options=NewtonOptions(tolerance=1e-12))
            ends.append(simulation.solve(reached.pose.contractions, start=reached.pose).markers["tip"])
        told = 1e3 * np.linalg.norm(ends[0] - ends[1]) / 2e-3
        assert abs(float(table[label][2]) - told) <= 0.006, label
    pushed, forces = [], 1e-4 * np.array([[1.0, 0.0], [0.0, 1.0]])
    for force in (*forces, *-forces):
        loaded = replace(robot, loads=(Load(name="push", marker="tip", force=(float(force[0]), float(force[1]))),))
        simulation = Simulation(loaded, options=NewtonOptions(tolerance=1e-12))
        pushed.append(simulation.solve(reached.pose.contractions, start=reached.pose).markers["tip"])
    compliance = np.subtract(pushed[:2], pushed[2:]) / 2e-4
    told = float(table["force on each marker in its softest direction"][2])
    assert abs(told - 1e3 * 0.1 * np.linalg.norm(compliance, ord=2)) <= 0.006
