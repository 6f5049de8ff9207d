"""Small designs made in code: a strip whose names are as bad as users can make them, and a box in space."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import meshio
import numpy as np
from builders import box_robot, strip_robot

from hydrostat.design import (
    Activation,
    Alternative,
    Certificate,
    DesignMethod,
    DesignRequest,
    DesignStage,
    Network,
    RouteTrace,
    TreeTrace,
    edge_fibres,
)
from hydrostat.ik import IKResult, IKStatus
from hydrostat.robot import Body, Cable, Marker, Mount, Pin, PoseTarget, Robot, Winch
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
        poses={"<b>": PoseTarget(name="<b>", targets={SCRIPT: (0.19, 0.03), FORMULA: (0.1, 0.03)})},
    )


def hostile_trace() -> TreeTrace:
    trace = hostile_network().trace
    assert isinstance(trace, TreeTrace)
    return trace


@cache
def hostile_network() -> Network:
    robot = hostile_robot()
    return _network(robot, robot.poses["<b>"], np.array([[0.02, 0.01], [0.1, 0.01], [0.15, 0.0]]))


@cache
def plain_network() -> Network:
    """The strip of the other tests, grown in stages, as it can be written and read."""
    pose = PoseTarget(name="up", targets={"tip": (0.19, 0.03)})
    robot = written(replace(strip_robot(columns=10, rows=3), poses={"up": pose}))
    return grown(_network(robot, pose, np.array([[0.02, 0.01], [0.1, 0.01]])))


def written(robot: Robot) -> Robot:
    """A robot whose body comes from a file."""
    mesh, body = robot.body.mesh, robot.body
    kind = "triangle" if mesh.dim == 2 else "tetra"
    with TemporaryDirectory() as folder:
        path = Path(folder) / "made.vtk"
        meshio.Mesh(np.pad(1e3 * mesh.nodes, [(0, 0), (0, 3 - mesh.dim)]), {kind: mesh.elements}).write(path)
        made = Body.from_mesh(path, unit=1e-3, material=body.material, thickness=body.thickness)
    return replace(robot, body=made)


def _network(robot: Robot, target: PoseTarget, tree: np.ndarray) -> Network:
    """A network as winch trees would have led to it, its first winch taken in by a centimeter."""
    pose = Simulation(robot).solve(np.array([0.01, 0.0]))
    errors = {name: float(np.linalg.norm(pose.markers[name] - np.array(at))) for name, at in target.targets.items()}
    fibres = edge_fibres(robot.body.mesh)
    tensions = np.linspace(0.0, 2.0, len(fibres))
    activation = Activation(target=target, fibres=fibres, tensions=tensions, nodes=pose.nodes, errors=errors)
    reached = IKResult(target=target, pose=pose, errors=errors, status=IKStatus.LOCAL_OPTIMUM, iterations=3, solves=5)
    return Network(
        robot=robot,
        source=robot,
        request=DesignRequest(poses=(target,), method=DesignMethod.TREES),
        ik_results=(reached,),
        expected_error=0.006,
        trace=TreeTrace(activations=(activation,), candidates=(np.argsort(-tensions)[:12],), trees=(tree,), score=0.5),
        num_evaluated=4,
        seconds=1.5,
    )


def grown(network: Network, stages: int = 11) -> Network:
    """The same network as if priced routes had led to it: stages, a certificate, alternatives of other sizes."""
    robot, (reached, *_) = network.robot, network.ik_results
    first, *_ = robot.cables
    begun = robot.with_network([winch for winch in robot.winches if winch.name == first.winch], [first])
    words = [SCRIPT, *(f"via points of {index} cables moved" for index in range(1, stages))]
    less = replace(reached, pose=Simulation(begun).solve(reached.pose.contractions[:1]))
    return replace(
        network,
        request=DesignRequest(poses=network.request.poses),
        trace=RouteTrace(
            stages=tuple(
                DesignStage(words=told, robot=begun if index < stages // 2 else robot, error=0.03 / (index + 1))
                for index, told in enumerate(words)
            ),
            certificate=Certificate(further=0.0021, paths=12345, descent_rate=0.0123),
        ),
        alternatives=(
            Alternative(robot=robot, ik_results=(replace(reached, errors={"tip": 0.0345}),), expected_error=0.0345),
            Alternative(robot=begun, ik_results=(replace(less, errors={"tip": 0.0456}),), expected_error=0.0456),
        ),
    )


def space_trace() -> TreeTrace:
    trace = space_network().trace
    assert isinstance(trace, TreeTrace)
    return trace


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
        poses={"nod": PoseTarget(name="nod", targets={"tip": (0.11, 0.03, 0.03)})},
    )
    return _network(robot, robot.poses["nod"], np.array([[0.02, 0.01, 0.02], [0.1, 0.01, 0.02], [0.11, 0.02, 0.03]]))
