"""Rounding errors of thin rigid parts. Oracle: the number of Newton steps of the same body of one soft material."""

from dataclasses import replace

import numpy as np
from builders import box_mesh, mesh_body

from hydrostat.robot import BodyPart, Cable, Marker, Material, Mount, Pin, Robot, Winch
from hydrostat.simulation import Simulation


def test_newton_stops_where_forces_of_thin_plates_are_rounding() -> None:
    """Forces of stiff thin elements are rounded to more than the tolerance; it once took thousands of steps."""
    mesh = box_mesh((16, 2, 2), size=(0.32, 0.04, 0.04))
    planes = np.sort(np.concatenate([np.arange(0, 16, 2) * 0.02, HIGH]))
    stretch = np.interp(mesh.nodes[:, 0], np.linspace(0.0, 0.32, 17), planes)
    mesh = replace(mesh, nodes=np.column_stack([stretch, mesh.nodes[:, 1:]]))
    plates = tuple(
        BodyPart(name=f"plate {k}", shape="box", at=(low, -1.0, -1.0), to=(low + 0.003, 1.0, 1.0), density=1e3)
        for k, low in enumerate(np.unique(stretch)[1::2].tolist()[:8])
    )
    body = mesh_body(mesh)
    points = ((0.0, 0.01, 0.031), (0.16, 0.011, 0.031), (0.31, 0.01, 0.031))
    robot = Robot(
        name="plates",
        body=replace(body, material=Material(young=1e5, poisson=0.0, density=300.0), parts=plates),
        pins=(Pin(box=((-1e-4, -1.0, -1.0), (1e-4, 1.0, 1.0)), stiffness=1e6),),
        gravity=(9.81, 0.0, 0.0),
        winches=(Winch(name="one", at=points[0], mount=Mount.WORLD),),
        cables=(Cable(winch="one", points=points),),
        markers=(Marker(name="tip", at=(0.3, 0.02, 0.02)),),
        poses={},
    )
    soft = Simulation(replace(robot, body=replace(robot.body, parts=()))).solve([0.004])
    stiff = Simulation(robot).solve([0.004], strict=False, seconds=5.0)
    assert stiff.result.converged
    assert stiff.result.iterations <= 5 * soft.result.iterations


HIGH = np.append(np.arange(1, 16, 2) * 0.02 + 0.017, 0.32)
"""Upper sides of the plates [m]: each is 3 mm thick."""
