"""Small robots, loads and motors for the lists."""

from dataclasses import replace
from typing import Any

import numpy as np
from builders import box_mesh, mesh_body
from kit_plans import make_plan
from plush_robots import SQUARE, drawn_body

from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.parts.motor import MOTORS
from hydrostat.robot import Cable, Mount, Pin, Robot, Winch

PLAIN = replace(
    MOTORS[0], title="plain motor", stall_torque=200.0, rated_torque=80.0, speed=60.0, mass=10.0, price=20.0
)
"""A motor in round numbers."""


def square(*cables: Cable, spool_radius: float = 0.006, travel: float = 0.06, release: float = 0.0) -> Robot:
    """A flat square of 100 mm, 30 mm thick, with a winch "pull" at (-20, -10) mm."""
    at = (-0.02, -0.01)
    return Robot(
        name="square",
        body=drawn_body(SQUARE),
        pins=(Pin(at=(0.0, 0.0), radius=0.02),),
        winches=(Winch(name="pull", at=at, spool_radius=spool_radius, travel=travel, release=release),),
        cables=cables or (Cable(winch="pull", points=(at, (0.01, 0.03), (0.04, 0.03))),),
        poses={},
    )


def box(*points: tuple[float, float, float], sheathed: tuple[tuple[int, int], ...] = ()) -> Robot:
    """A box of 200 x 160 x 160 mm of foam, in the corner of the axes, with one cable from a winch in the world."""
    return Robot(
        name="box",
        body=mesh_body(box_mesh((5, 4, 4), size=(0.2, 0.16, 0.16))),
        pins=(Pin(box=((0.0, 0.0, 0.0), (0.001, 0.16, 0.16))),),
        winches=(Winch(name="pull", at=points[0], mount=Mount.WORLD),),
        cables=(Cable(winch="pull", points=points, sheathed=sheathed),),
        poses={},
    )


def demand_of(robot: Robot, *tensions: float) -> Demand:
    """One pose with such tensions [N]; 3 N if none are given."""
    pulls = np.array(tensions or [3.0] * len(robot.cables))
    radii = {winch.name: winch.spool_radius for winch in robot.winches}
    torques = np.zeros(len(robot.winches))
    for cable, pull in zip(robot.cables, pulls, strict=True):
        place = [winch.name for winch in robot.winches].index(cable.winch)
        torques[place] += pull * (cable.spool_radius or radii[cable.winch])
    taken = np.array([[0.0, winch.travel] for winch in robot.winches])
    return Demand(poses=('pose "test"',), tensions=pulls, torques=torques, taken=taken)


def given(robot: Robot, **facts: Any) -> KitPlan:
    """Plan of a robot with plain loads and a plain motor; facts by their names."""
    return make_plan(robot, **({"demand": demand_of(robot), "motor": PLAIN} | facts))
