"""Poses of small robots. Oracles: statics (balances of force and moment), the rest pose, and the solver's promises."""

from collections.abc import Callable
from dataclasses import replace
from gc import collect
from typing import Any
from weakref import ref

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonOptions, NewtonStatus
from hydrostat.robot import Mount, Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.simulation.route_points import hold_markers

ROBOTS = {
    "strip": strip_robot,
    "world": lambda: strip_robot(mount=Mount.WORLD),
    "sheathed": lambda: strip_robot(sheathed=((1, 3),)),
    "box": box_robot,
}
PULL = np.array([0.02, 0.008])


def pin_forces(simulation: Simulation, pose: Equilibrium) -> tuple[np.ndarray, np.ndarray]:
    """Points where the pins hold, and their forces on the body [N]."""
    pins = simulation.assembly.energies[1]
    forces = -pins.gradient(pose.nodes, pose.contractions).reshape(-1, pose.nodes.shape[1])
    return pose.nodes[pins.stencils].reshape(forces.shape), forces


@pytest.mark.parametrize("name", ROBOTS)
def test_without_a_command_the_robot_rests(name: str) -> None:
    """E2: no stress at rest, so the rest pose is the answer, at once."""
    robot = ROBOTS[name]()
    pose = Simulation(robot).solve({})
    assert np.abs(pose.nodes - robot.body.mesh.nodes).max() < 1e-12 * robot.body.mesh.size
    assert not pose.tensions.any()
    assert pose.result.iterations == 0


@pytest.mark.parametrize("name", ROBOTS)
def test_a_slack_cable_leaves_the_body_untouched(name: str) -> None:
    robot = ROBOTS[name]()
    pose = Simulation(robot).solve(np.array([-0.01, -1e-6]))
    assert np.abs(pose.nodes - robot.body.mesh.nodes).max() < 1e-12 * robot.body.mesh.size
    assert not pose.tensions.any()


@pytest.mark.parametrize("name", ["strip", "sheathed", "box"])
def test_pins_of_a_robot_with_winches_inside_carry_nothing_in_sum(name: str) -> None:
    """Forces inside a body have neither a resultant nor a moment."""
    simulation = Simulation(ROBOTS[name]())
    pose = simulation.solve(PULL)
    places, forces = pin_forces(simulation, pose)
    tension = float(pose.tensions.max())
    assert tension > 1.0
    assert np.abs(forces.sum(axis=0)).max() < 1e-8 * tension
    moments = np.einsum("pi,pj->ij", places, forces)
    assert np.abs(moments - moments.T).max() < 1e-8 * tension * simulation.robot.body.mesh.size


def test_pins_balance_the_cable_that_comes_from_the_world() -> None:
    """The world pulls with T along the first segment; the pins answer with its opposite, force and moment."""
    simulation = Simulation(strip_robot(mount=Mount.WORLD))
    pose = simulation.solve(PULL)
    cable = simulation.robot.cables[0]
    weights = simulation.robot.body.mesh.nodes
    nearest = int(np.argmin(np.linalg.norm(weights - cable.points[1], axis=1)))
    assert np.linalg.norm(weights[nearest] - cable.points[1]) > 0
    places, forces = pin_forces(simulation, pose)
    first = _anchor(simulation.robot, np.array(cable.points[1]), pose.nodes)
    direction = np.array(cable.points[0]) - first
    pull = pose.tensions[0] * direction / np.linalg.norm(direction)
    assert forces.sum(axis=0) == pytest.approx(-pull, abs=1e-6 * pose.tensions[0])
    moment = float(np.sum(places[:, 0] * forces[:, 1] - places[:, 1] * forces[:, 0]))
    assert moment == pytest.approx(-float(first[0] * pull[1] - first[1] * pull[0]), abs=1e-7 * pose.tensions[0])


def _anchor(robot: Robot, point: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """A material point in the pose, from a 3 x 3 solve in the element that holds it."""
    for element in robot.body.mesh.elements:
        corners = np.column_stack([robot.body.mesh.nodes[element], np.ones(3)])
        weights = np.linalg.solve(corners.T, [*point, 1.0])
        if weights.min() > -1e-9:
            return weights @ nodes[element]
    raise AssertionError("the point is outside")


def test_a_sheathed_run_exerts_nothing_inside() -> None:
    """E11. Statics of each via point: T times the directions of its bare segments, nothing where all is sheathed."""
    simulation = Simulation(strip_robot(columns=20, rows=5, sheathed=((1, 4),)))
    pose = simulation.solve(PULL)
    cables, robot = simulation.cables, simulation.robot
    route = robot.cables[0]
    points = np.array([_anchor(robot, np.array(point), pose.nodes) for point in route.points])
    expected = np.zeros_like(points)
    for segment in (0, 4, 5):
        direction = points[segment + 1] - points[segment]
        direction /= np.linalg.norm(direction)
        expected[segment] += pose.tensions[0] * direction
        expected[segment + 1] -= pose.tensions[0] * direction
    assert not expected[2:4].any()
    forces = np.zeros_like(pose.nodes)
    own = cables.cables == 0
    np.add.at(forces, cables.stencils[own], -cables.gradient(pose.nodes, pose.contractions)[own])
    spread = np.zeros_like(forces)
    for point, force in zip(route.points, expected, strict=True):
        for node, weight in _weights(robot, np.array(point)):
            spread[node] += weight * force
    assert forces == pytest.approx(spread, abs=1e-6 * pose.tensions[0])


def _weights(robot: Robot, point: np.ndarray) -> list[tuple[int, float]]:
    nodes = np.eye(len(robot.body.mesh.nodes))
    row = _anchor(robot, point, nodes)
    return [(int(node), float(row[node])) for node in np.flatnonzero(np.abs(row) > 1e-12)]


def test_a_sheathed_cable_of_rest_length_does_not_feel_its_run() -> None:
    """Its length changes only by the bare segments."""
    simulation = Simulation(strip_robot(sheathed=((1, 4),)))
    nodes = simulation.robot.body.mesh.nodes
    assert simulation.cables.lengths(nodes) == pytest.approx([3 * 0.03, 6 * 0.03])
    assert simulation.robot.cables[0].length == pytest.approx(6 * 0.03)


def test_slack_is_taken_in_first() -> None:
    """E12: a cable with slack s at contraction a is one without at a - s."""
    slack = Simulation(strip_robot(slack=0.005)).solve(np.array([0.02, 0.0]))
    tight = Simulation(strip_robot()).solve(np.array([0.015, 0.0]))
    assert np.abs(slack.nodes - tight.nodes).max() < 1e-9
    assert slack.tensions == pytest.approx(tight.tensions, rel=1e-7)
    assert not Simulation(strip_robot(slack=0.005)).solve(np.array([0.0049, 0.0])).tensions.any()


def test_contractions_may_be_a_dict_or_an_array() -> None:
    simulation = Simulation(strip_robot())
    by_name = simulation.solve({"down": 0.01})
    by_order = simulation.solve(np.array([0.0, 0.01]))
    assert (by_name.nodes == by_order.nodes).all()
    assert by_name.contractions.tolist() == [0.0, 0.01]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"sideways": 0.01}, 'unknown winch "sideways"'),
        (np.array([0.01]), "1 contractions given for 2 winches"),
        (np.array([0.01, np.nan]), "not a finite number"),
        ({"up": float("inf")}, "not a finite number"),
    ],
)
def test_contractions_that_do_not_fit_are_refused(given: dict | np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Simulation(strip_robot()).solve(given)


def test_a_solve_that_stops_early_raises_or_says_why() -> None:
    simulation = Simulation(strip_robot(), options=NewtonOptions(iterations=1))
    with pytest.raises(NotConvergedError, match="iteration limit reached") as caught:
        simulation.solve(PULL)
    assert not caught.value.result.converged  # type: ignore[attr-defined]
    pose = simulation.solve(PULL, strict=False)
    assert pose.result.status is NewtonStatus.ITERATION_LIMIT
    assert np.isfinite(pose.nodes).all()


def test_what_is_too_far_for_one_go_is_reached_in_steps() -> None:
    """One step of Newton less than it takes at once: smaller loads one after the other lead to the same pose."""
    far = np.array([0.08, 0.0])
    at_once = Simulation(strip_robot()).solve(far)
    limit = at_once.result.iterations - 1
    simulation = Simulation(strip_robot(), options=NewtonOptions(iterations=limit))
    pose = simulation.solve(far)
    assert pose.result.converged
    assert pose.result.iterations > limit
    assert np.abs(pose.nodes - at_once.nodes).max() < 1e-8 * simulation.robot.body.mesh.size
    assert np.abs(simulation.assembly.gradient(pose.nodes, far)).max() <= pose.result.allowed


@pytest.mark.parametrize("name", ROBOTS)
def test_the_predicted_start_gives_the_same_equilibrium_sooner(name: str) -> None:
    """From a pose 2 % away; oracle: the pose found from rest."""
    simulation = Simulation(ROBOTS[name]())
    from_rest = simulation.solve(PULL)
    near = simulation.solve(0.98 * PULL)
    predicted = simulation.solve(PULL, start=near)
    assert np.abs(predicted.nodes - from_rest.nodes).max() < 1e-8 * simulation.robot.body.mesh.size
    assert predicted.result.iterations < from_rest.result.iterations
    again = simulation.solve(PULL, start=from_rest)
    assert again.result.iterations == 0


def test_markers_and_tensions_belong_to_the_pose() -> None:
    simulation = Simulation(strip_robot())
    pose = simulation.solve(PULL)
    assert pose.markers["tip"] == pytest.approx(_anchor(simulation.robot, np.array([0.2, 0.0]), pose.nodes))
    assert pose.tensions.shape == (2,)
    assert pose.energy == simulation.assembly.value(pose.nodes, PULL)


@pytest.mark.parametrize("make", [list, np.array])
def test_markers_may_be_given_as_a_list_or_an_array(make: Callable[[tuple[float, ...]], Any], unchecked: None) -> None:
    """Oracle: the same place as a tuple. Simulations on one mesh share the anchors, so nobody may write to them."""
    robot = strip_robot()
    (tip,) = robot.markers
    anchors = Simulation(robot).marker_anchors
    asked = Simulation(replace(robot, markers=(replace(tip, at=make(tip.at)),))).marker_anchors
    for name in ("stencils", "weights", "distances"):
        found = getattr(asked, name)
        assert np.array_equal(found, getattr(anchors, name))
        with pytest.raises(ValueError, match="read-only"):
            found[:] = 0


def test_anchors_of_markers_are_shared_and_go_with_their_mesh() -> None:
    robot = strip_robot()
    one, other = Simulation(robot), Simulation(replace(robot, gravity=robot.gravity))
    assert one.marker_anchors is other.marker_anchors
    moved = replace(robot, markers=(replace(robot.markers[0], at=(0.1, 0.0)),))
    assert Simulation(moved).marker_anchors is not one.marker_anchors
    anchors = ref(hold_markers(mesh := Mesh(robot.body.mesh.nodes, robot.body.mesh.elements), [(0.1, 0.0)]))
    assert anchors() is not None
    del mesh
    collect()
    assert anchors() is None


def test_the_upper_cable_bends_the_strip_up() -> None:
    """Signs: E1. A contraction pulls, the strip bends to the side of its cable."""
    simulation = Simulation(strip_robot())
    assert simulation.solve({"up": 0.02}).markers["tip"][1] > 0.01
    assert simulation.solve({"down": 0.02}).markers["tip"][1] < -0.01


def test_a_point_pulled_up_to_its_winch_has_an_equilibrium() -> None:
    """A plain norm has a kink there, at which no gradient vanishes: Newton stopped without a descent."""
    strip = strip_robot(mount=Mount.WORLD)
    winch = replace(strip.winches[0], at=(0.19, 0.045))
    robot = replace(strip, winches=(winch,), cables=(replace(strip.cables[0], points=((0.19, 0.045), (0.19, 0.015))),))
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.05]))
    gap = np.linalg.norm(_anchor(robot, np.array([0.19, 0.015]), pose.nodes) - winch.at)
    assert gap < 0.01 * 0.03
    assert pose.tensions[0] > 10
    assert pose.result.stable
    _, forces = pin_forces(simulation, pose)
    assert np.linalg.norm(forces.sum(axis=0)) < pose.tensions[0]
