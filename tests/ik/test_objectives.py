"""All objectives in one conformance suite. Oracles: central differences of sharp solves, closed forms."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from wishes import BEFORE, BENT, BODIES, FLAT, PLANE, SPACE, arc, box

from hydrostat.errors import InputError
from hydrostat.geometry import Outline, Surface
from hydrostat.ik.ik_result import IKStatus
from hydrostat.ik.inverse_kinematics import solve_ik
from hydrostat.ik.objectives.center_of_mass_target import CenterOfMassTarget
from hydrostat.ik.objectives.effort import Effort
from hydrostat.ik.objectives.marker_target import MarkerTarget
from hydrostat.ik.objectives.objective import EquilibriumState, Objective, checked_objectives
from hydrostat.ik.objectives.pose_regularizer import PoseRegularizer
from hydrostat.ik.objectives.shape_target import ShapeTarget
from hydrostat.simulation import Simulation
from hydrostat.testing import check_objective


@pytest.mark.parametrize("name", PLANE)
def test_objectives_in_the_plane_conform(name: str) -> None:
    check_objective(PLANE[name], FLAT, BENT[2])


@pytest.mark.parametrize("name", BODIES)
def test_objectives_in_space_conform(name: str) -> None:
    check_objective(BODIES[name], SPACE, BENT[3])


def test_the_suite_sees_a_taut_and_a_slack_cable() -> None:
    elongations = EquilibriumState.at(FLAT, FLAT.solve(BENT[2])).elongations
    assert elongations[0] > 1e-3
    assert elongations[1] < -1e-3


def at_rest(simulation: Simulation) -> EquilibriumState:
    return EquilibriumState.at(simulation, simulation.solve({}))


PAD = 0.006


def padded(simulation: Simulation) -> tuple[ShapeTarget, float, float]:
    """The body's box, larger by a pad on every side; mean squares of the distances of nodes to it, of it to the body.

    All nodes are as far away as the pad, as are places beside a face. Beyond an edge, t away from it, p^2 + t^2 counts.
    """
    p, nodes = PAD, simulation.robot.body.mesh.nodes
    low, sides = nodes.min(axis=0), np.ptp(nodes, axis=0)
    if len(sides) == 2:
        corners = low - p + (sides + 2 * p) * np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        rim = 2 * sides.sum()
        return ShapeTarget(outline=Outline(corners), samples=4000), p**2, (rim * p**2 + 32 / 3 * p**3) / (rim + 8 * p)
    x, y, z = sides
    area, edges = 2 * (x * y + y * z + z * x), 8 * (x + y + z)
    total = area * p**2 + edges * 4 / 3 * p**3 + 40 * p**4
    goal = ShapeTarget(surface=box(tuple(low - p), tuple(sides + 2 * p)), samples=20000)
    return goal, p**2, total / (area + edges * p + 24 * p**2)


@pytest.mark.parametrize("simulation", [FLAT, SPACE], ids=["plane", "space"])
def test_a_larger_box_is_as_far_away_as_its_pad(simulation: Simulation) -> None:
    goal, nodes, places = padded(simulation)
    rest, count = at_rest(simulation), len(simulation.robot.body.mesh.boundary_nodes)
    residual = goal.bind(simulation).residual(rest)
    assert (residual[:count] < 0).all()
    assert (residual[count:] > 0).all()
    assert (residual[:count] ** 2).sum() == pytest.approx(nodes / 2, rel=1e-12)
    assert (residual[count:] ** 2).sum() == pytest.approx(places / 2, rel=2e-4)
    error = np.sqrt((nodes + places) / 2)
    assert list(goal.bind(simulation).errors(rest).values()) == [pytest.approx(error, rel=2e-4)]
    heavy = replace(goal, weight=3.0).bind(simulation)
    np.testing.assert_allclose(heavy.residual(rest), 3.0 * residual, rtol=1e-14)
    assert heavy.errors(rest) == goal.bind(simulation).errors(rest)


@pytest.mark.parametrize("simulation", [FLAT, SPACE], ids=["plane", "space"])
def test_a_shape_moves_the_residual_by_the_way_along_its_normal(simulation: Simulation) -> None:
    """A body shifted by v inside a larger box: a node near a face comes nearer by what of v is normal to it."""
    goal, _, _ = padded(simulation)
    mesh, rest = simulation.robot.body.mesh, at_rest(simulation)
    shift = np.array([0.001, -0.002, 0.0015])[: mesh.dim]
    moved = replace(rest, nodes=rest.nodes + shift)
    term, rim = goal.bind(simulation), mesh.nodes[mesh.boundary_nodes]
    low, high = mesh.nodes.min(axis=0) - PAD, mesh.nodes.max(axis=0) + PAD
    gaps = np.minimum(rim + shift - low, high - rim - shift).min(axis=1)
    share = term.residual(rest)[: len(rim)] / -PAD
    np.testing.assert_allclose(term.residual(moved)[: len(rim)], -share * gaps, rtol=1e-9, atol=1e-12)


def test_a_body_lies_on_its_own_boundary() -> None:
    mesh = SPACE.robot.body.mesh
    used, triangles = np.unique(mesh.boundary, return_inverse=True)
    own = ShapeTarget(surface=Surface(mesh.nodes[used], triangles.reshape(-1, 3)))
    strip = ShapeTarget(outline=Outline(np.array([[0.0, -0.025], [0.2, -0.025], [0.2, 0.025], [0.0, 0.025]])))
    for goal, simulation in ((own, SPACE), (strip, FLAT)):
        assert max(goal.bind(simulation).errors(at_rest(simulation)).values()) < 1e-15


def test_values_of_the_others() -> None:
    """By hand: weighted offsets, the middle of a box, loose cable, contractions by the travel of their winches."""
    rest, robot = at_rest(FLAT), FLAT.robot
    term = PLANE["weighted markers"].bind(FLAT)
    np.testing.assert_allclose(term.residual(rest), [0.0, 3 * -0.06, 0.0, 0.0], atol=1e-12)
    assert term.errors(rest) == {"tip": pytest.approx(0.06)}
    whole = PLANE["markers"].bind(FLAT).errors(rest)
    assert whole == {"tip": pytest.approx(np.hypot(0.03, 0.06)), "top": pytest.approx(np.hypot(0.01, 0.025))}
    center = BODIES["center"].bind(SPACE)
    np.testing.assert_allclose(center.residual(at_rest(SPACE)), [0.01, 0.0, -0.01], atol=1e-12)
    slack = Effort(of="slack", weight=1.0, scale=0.2).bind(FLAT)
    np.testing.assert_allclose(slack.residual(rest), [0.0, -0.005], atol=1e-12)
    posture = EquilibriumState.at(FLAT, FLAT.solve(BENT[2]))
    contraction = Effort(weight=1.0).bind(FLAT).residual(posture)
    np.testing.assert_allclose(contraction, 0.2 * BENT[2] / [winch.travel for winch in robot.winches])
    tension = Effort(of="tension", weight=1.0, scale=2.0).bind(FLAT).residual(posture)
    np.testing.assert_allclose(tension, 0.2 * posture.tensions / 2.0)
    assert posture.tensions[0] > 0.1
    same = PoseRegularizer(pose=BEFORE[2], of="nodes").bind(FLAT).residual(EquilibriumState.at(FLAT, BEFORE[2]))
    assert not same.any()
    shifted = replace(EquilibriumState.at(FLAT, BEFORE[2]), nodes=BEFORE[2].nodes + np.array([0.003, 0.004]))
    assert np.linalg.norm(
        PoseRegularizer(pose=BEFORE[2], of="nodes", weight=2.0).bind(FLAT).residual(shifted)
    ) == pytest.approx(2 * 0.005)
    top = PoseRegularizer(pose=BEFORE[2], of="markers", markers=("top",), weight=2.0).bind(FLAT).residual(shifted)
    np.testing.assert_allclose(top, [0.006, 0.008])


WRONG: Mapping[str, tuple[Simulation, Objective, str]] = {
    "no such marker": (FLAT, MarkerTarget(targets={"toe": (0.0, 0.0)}), 'unknown marker "toe". Available: tip, top'),
    "marker in space": (FLAT, MarkerTarget(targets={"tip": (0.0, 0.0, 0.0)}), "target tip has 3 coordinates"),
    "marker nowhere": (FLAT, MarkerTarget(targets={"tip": (0.0, np.nan)}), "target tip is not finite"),
    "marker's weight": (FLAT, MarkerTarget(targets={"tip": (0, 0)}, weights={"tip": -1.0}), "weight of marker tip"),
    "weight of no target": (
        FLAT,
        MarkerTarget(targets={"tip": (0, 0)}, weights={"top": 1.0}),
        'marker "top" has a weight',
    ),
    "marker's axes": (FLAT, MarkerTarget(targets={"tip": (0, 0)}, free={"tip": "z"}), 'must be of "xy", not "z"'),
    "center in space": (
        FLAT,
        CenterOfMassTarget(target=(0, 0, 0)),
        "center of mass has 3 coordinates, the body 2 dimensions",
    ),
    "center nowhere": (
        SPACE,
        CenterOfMassTarget(target=(0, 0, np.inf)),
        "center of mass is not finite: (0.0, 0.0, inf)",
    ),
    "center's weight": (FLAT, CenterOfMassTarget(target=(0, 0), weight=np.nan), "weight of the center of mass"),
    "effort's weight": (FLAT, Effort(weight=-1e-3), "weight of an effort must be 0 or more, not -0.001"),
    "effort's scale": (FLAT, Effort(scale=0.0), "scale of an effort must be a number above 0, not 0"),
    "closeness's weight": (FLAT, PoseRegularizer(pose=BEFORE[2], weight=np.inf), "weight of a closeness"),
    "another robot's pose": (SPACE, PoseRegularizer(pose=BEFORE[2]), "is one of another robot"),
    "no shape": (FLAT, ShapeTarget(), "either an outline"),
    "two shapes": (FLAT, ShapeTarget(outline=arc(), surface=box()), "either an outline"),
    "outline in space": (SPACE, ShapeTarget(outline=arc()), "give a surface"),
    "surface in the plane": (FLAT, ShapeTarget(surface=box()), "give an outline"),
    "shape's weight": (FLAT, ShapeTarget(outline=arc(), weight=-1.0), "weight of a shape must be 0 or more, not -1"),
    "few samples": (FLAT, ShapeTarget(outline=arc(), samples=2), "samples of a shape must be a whole number from 3"),
    "millimeters": (FLAT, ShapeTarget(outline=Outline(1e3 * arc().exterior)), "the body 200 mm; give it in meters"),
    "open surface": (SPACE, ShapeTarget(surface=box().part(np.arange(11))), "surface is not closed; heal it"),
    "flat triangle": (
        SPACE,
        ShapeTarget(surface=Surface(box().vertices, np.concatenate([box().triangles, [[0, 1, 1]]]))),
        "1 triangles without area",
    ),
}

TIP: dict[str, Any] = {"targets": {"tip": (0.1, 0.0)}}
MISTYPED: Mapping[str, tuple[type[Objective], dict[str, Any], str]] = {
    "name of a pose": (
        MarkerTarget,
        {"targets": "wave"},
        'places by name, not "wave"; those of a pose are robot.pose(',
    ),
    "list of targets": (
        MarkerTarget,
        {"targets": [1, 2]},
        'targets must be given by name, such as {"tip": (0.1, 0.02)}',
    ),
    "number of targets": (MarkerTarget, {"targets": 3}, "targets must be given by name"),
    "no targets": (MarkerTarget, {"targets": {}}, "targets must name at least one marker"),
    "number for a place": (MarkerTarget, {"targets": {"tip": 0.1}}, "target tip must be 2 coordinates [m], not 0.1"),
    "nothing for a place": (MarkerTarget, {"targets": {"tip": None}}, "target tip must be 2 coordinates [m], not None"),
    "words for a place": (MarkerTarget, {"targets": {"tip": ("a", "b")}}, "2 coordinates [m], not ('a', 'b')"),
    "word for a place": (MarkerTarget, {"targets": {"tip": "ab"}}, "target tip must be 2 coordinates [m], not 'ab'"),
    "complex place": (MarkerTarget, {"targets": {"tip": (1j, 0)}}, "target tip must be 2 coordinates [m], not (1j, 0)"),
    "uneven place": (MarkerTarget, {"targets": {"tip": (0, (1, 2))}}, "must be 2 coordinates [m], not (0, (1, 2))"),
    "target in millimeters": (MarkerTarget, {"targets": {"tip": (190, 30)}}, "meters in Python"),
    "words for a weight": (MarkerTarget, {**TIP, "weights": {"tip": "1"}}, "marker tip must be 0 or more, not '1'"),
    "one weight": (MarkerTarget, {**TIP, "weights": 2.0}, "weights of markers must be given by name"),
    "number of an axis": (MarkerTarget, {**TIP, "free": {"tip": 0}}, 'marker tip must be of "xy", not 0'),
    "one free axis": (MarkerTarget, {**TIP, "free": "x"}, "free axes of markers must be given by name"),
    "file of an outline": (ShapeTarget, {"outline": "a.svg"}, "not 'a.svg'; drawn_pose(robot, file) reads one"),
    "array for an outline": (
        ShapeTarget,
        {"outline": np.zeros((40, 2))},
        "outline must be an Outline [m], not a ndarray",
    ),
    "many samples": (ShapeTarget, {"outline": arc(), "samples": 10**12}, "from 3 to 1000000, not 1e+12"),
    "broken samples": (ShapeTarget, {"outline": arc(), "samples": 5.5}, "must be a whole number from 3"),
    "number for a center": (CenterOfMassTarget, {"target": 0.0}, "center of mass must be 2 coordinates [m], not 0"),
    "word for a center": (CenterOfMassTarget, {"target": "ab"}, "center of mass must be 2 coordinates [m], not 'ab'"),
    "nothing for a center": (
        CenterOfMassTarget,
        {"target": None},
        "center of mass must be 2 coordinates [m], not None",
    ),
    "center in millimeters": (CenterOfMassTarget, {"target": (90, 20)}, "meters in Python"),
    "word for a scale": (Effort, {"scale": "1"}, "scale of an effort must be a number above 0, not '1'"),
    "effort of nothing": (Effort, {"of": None}, "contraction, tension, slack"),
    "kind of effort": (Effort, {"of": "power"}, 'an effort must be one of contraction, tension, slack, not "power"'),
    "kind of closeness": (
        PoseRegularizer,
        {"pose": BEFORE[2], "of": "time"},
        'one of nodes, markers, contractions, not "time"',
    ),
    "marker that is none": (
        PoseRegularizer,
        {"pose": BEFORE[2], "of": "markers", "markers": ("nose",)},
        "a closeness names 'nose', which is no marker of the robot",
    ),
    "near nothing": (PoseRegularizer, {"pose": None}, "must be an Equilibrium, not None"),
    "near an answer": (
        PoseRegularizer,
        {"pose": solve_ik(FLAT, {"tip": (0.19, 0.02)})},
        "must be an Equilibrium, not an IKResult, give its .pose",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_one_clear_line(name: str) -> None:
    simulation, objective, message = WRONG[name]
    with pytest.raises(InputError) as caught:
        objective.bind(simulation)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", MISTYPED)
def test_a_wrong_type_is_one_clear_line(name: str, unchecked: None) -> None:
    kind, given, message = MISTYPED[name]
    with pytest.raises(InputError) as caught:
        kind(**given).bind(FLAT)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (Effort(), "objectives must be a list, such as [Effort()], not an Effort"),
        ("effort", "objectives must be a list, such as [Effort()], not 'effort'"),
        (None, "objectives must be a list, such as [Effort()], not None"),
        (["effort"], "MarkerTarget(...) or Effort(), not 'effort'"),
        ([Effort(), Effort], "got the class Effort. Pass an instance: Effort(...)"),
    ],
)
def test_objectives_are_a_list_of_them(given: object, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        checked_objectives(given)


def test_no_weight_no_goal() -> None:
    rest = at_rest(FLAT)
    for goal in (CenterOfMassTarget(target=(0.0, 0.0)), ShapeTarget(outline=arc())):
        assert goal.bind(FLAT).errors(rest)
        assert replace(goal, weight=0.0).bind(FLAT).errors(rest) == {}


def test_a_free_axis_may_hold_any_number() -> None:
    goal = MarkerTarget(targets={"tip": (1e9, 0.0)}, free={"tip": "x"})
    assert goal.bind(FLAT).errors(at_rest(FLAT)) == {"tip": pytest.approx(0.0, abs=1e-12)}


def test_a_marker_without_weight_is_not_missed() -> None:
    """One marker within reach, another far away that does not count: the search must say that it has reached all."""
    targets = {"tip": tuple(BEFORE[2].markers["tip"].tolist()), "top": (0.1, 0.2)}
    reached = solve_ik(FLAT, objectives=[MarkerTarget(targets=targets, weights={"top": 0.0})])
    assert reached.status is IKStatus.REACHED
    assert list(reached.errors) == ["tip"]
