"""Small designs made in code: a strip whose names are as bad as users can make them, and a box in space."""

from dataclasses import replace
from functools import cache

import numpy as np
from builders import box_robot, strip_robot

from hydrostat.design.muscles.fibres import edge_fibres
from hydrostat.design.network import Activation, Network
from hydrostat.ik import InverseReason, ReachedPose
from hydrostat.robot import Cable, Marker, Mount, Pin, Pose, Robot, Winch
from hydrostat.simulation import Simulation

SCRIPT = "<script>alert(1)</script>"
FORMULA = '$\\frac{1}{0}$ & "so" on'


@cache
def hostile_robot() -> Robot:
    robot = strip_robot(columns=10, rows=3, sheathed=((0, 1),))
    up, down = robot.winches
    return replace(
        robot,
        name="</title>" + SCRIPT,
        pins=(*robot.pins, Pin(at=(0.01, 0.0), radius=0.01)),
        winches=(Winch(name=SCRIPT, at=up.at), Winch(name=FORMULA, at=down.at)),
        cables=tuple(
            Cable(winch=name, points=cable.points, sheathed=cable.sheathed)
            for name, cable in zip((SCRIPT, FORMULA), robot.cables, strict=True)
        ),
        markers=(Marker(name=SCRIPT, at=(0.2, 0.0)), Marker(name=FORMULA, at=(0.1, 0.025))),
        poses={"<b>": Pose(name="<b>", targets={SCRIPT: (0.19, 0.03), FORMULA: (0.1, 0.03)})},
    )


@cache
def hostile_network() -> Network:
    robot = hostile_robot()
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.01, 0.0]))
    target = robot.poses["<b>"]
    errors = {name: float(np.linalg.norm(pose.markers[name] - np.array(at))) for name, at in target.targets.items()}
    fibres = edge_fibres(robot.body.mesh)
    tensions = np.linspace(0.0, 2.0, len(fibres))
    return Network(
        robot=robot,
        activations=(Activation(target=target, fibres=fibres, tensions=tensions, nodes=pose.nodes, errors=errors),),
        candidates=(np.argsort(-tensions)[:12],),
        trees=(np.array([[0.02, 0.01], [0.1, 0.01], [0.15, 0.0]]),),
        reached=(
            ReachedPose(target=target, pose=pose, errors=errors, reason=InverseReason.OPTIMAL, iterations=3, solves=5),
        ),
        score=0.5,
        tried=4,
        seconds=1.5,
    )


@cache
def space_network() -> Network:
    """A box in space with two cables along it, one winch in the world, a marker and every stage of a design."""
    robot = box_robot()
    one, two = robot.cables
    outside = (-0.03, 0.05, 0.02)
    robot = replace(
        robot,
        pins=(*robot.pins, Pin(at=(0.02, 0.0, 0.0), radius=0.001)),
        winches=(Winch(name="one", at=outside, mount=Mount.WORLD), robot.winches[1]),
        cables=(Cable(winch="one", points=(outside, *one.points)), replace(two, sheathed=((0, 1),))),
        poses={"nod": Pose(name="nod", targets={"tip": (0.11, 0.03, 0.03)})},
    )
    pose = Simulation(robot).solve(np.array([0.01, 0.0]))
    target = robot.poses["nod"]
    errors = {"tip": float(np.linalg.norm(pose.markers["tip"] - np.array(target.targets["tip"])))}
    fibres = edge_fibres(robot.body.mesh)
    tensions = np.linspace(0.0, 2.0, len(fibres))
    return Network(
        robot=robot,
        activations=(Activation(target=target, fibres=fibres, tensions=tensions, nodes=pose.nodes, errors=errors),),
        candidates=(np.argsort(-tensions)[:12],),
        trees=(np.array([[0.02, 0.01, 0.02], [0.1, 0.01, 0.02], [0.11, 0.02, 0.03]]),),
        reached=(
            ReachedPose(target=target, pose=pose, errors=errors, reason=InverseReason.OPTIMAL, iterations=3, solves=5),
        ),
        score=0.5,
        tried=4,
        seconds=1.5,
    )
