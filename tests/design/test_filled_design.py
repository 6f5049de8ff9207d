"""Designs on the filled body. Oracles: the inflated body solved by hand, counting by hand, networks worse by a lot."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.design import (
    BuildCost,
    DesignRequest,
    Network,
    RouteTrace,
    assign_cable_sides,
    describe_uncounted_motion,
    design_cables,
    find_stuffed_motion,
    score_card,
)
from hydrostat.design.cable_design import evaluate_stuffed
from hydrostat.design.network import Alternative
from hydrostat.design.stuffed_results import solve_stuffed
from hydrostat.errors import InputError
from hydrostat.ik import IKResult, Limits, solve_ik
from hydrostat.progress import no_progress
from hydrostat.robot import CableSide, Robot, get_material, inflated_robot
from hydrostat.simulation import Simulation, solve_stuffed_motion


@pytest.fixture(scope="module")
def robot() -> Robot:
    starfish = assign_cable_sides(gallery_robot("starfish"))
    return replace(starfish, poses={"wave": starfish.pose("wave")})


@pytest.fixture(scope="module")
def reached(robot: Robot) -> tuple[IKResult, ...]:
    return tuple(solve_ik(Simulation(robot), pose) for pose in robot.poses.values())


def network(robot: Robot, reached: tuple[IKResult, ...], *others: Alternative) -> Network:
    return Network(
        robot=robot,
        source=robot,
        request=DesignRequest(poses=tuple(robot.poses.values()), winches=3, cables=5, stuffed=True),
        ik_results=reached,
        expected_error=0.01,
        alternatives=others,
        trace=RouteTrace(stages=(), certificate=None),
        num_evaluated=1,
        seconds=0.0,
    )


def test_motion_of_the_stuffed_body_is_named_where_the_as_built_error_is_smaller(
    robot: Robot, reached: tuple[IKResult, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: the motion found without a network, which is solved once for each network; none for a cast body."""
    own, calls = solve_stuffed_motion(robot, [one.pose.contractions for one in reached]), []
    monkeypatch.setattr(
        "hydrostat.design.stuffed_motion.solve_stuffed_motion", lambda *given: calls.append(given) or own
    )
    largest = max(own.out, own.aside)
    for error, words in ((0.9 * largest, f"{own}, at the worst marker. The as-built error does not"), (largest, "")):
        found = replace(network(robot, reached), expected_error=error)
        assert describe_uncounted_motion(found).startswith(words)
        assert bool(describe_uncounted_motion(found)) == bool(words)
        assert find_stuffed_motion(found) is own
    assert len(calls) == 2
    cast = replace(robot, body=replace(robot.body, material=get_material("flexfoam-it x")))
    assert describe_uncounted_motion(replace(network(cast, reached), expected_error=0.0)) == ""


def test_new_networks_run_where_a_builder_would_want_them() -> None:
    starfish, trunk = gallery_robot("starfish"), gallery_robot("trunk")
    assert assign_cable_sides(starfish).face is CableSide.PAIRS
    assert assign_cable_sides(trunk) is trunk
    front = replace(starfish, face=CableSide.FRONT)
    assert assign_cable_sides(front) is front
    foam = replace(starfish, body=replace(starfish.body, material=get_material("flexfoam-it x")))
    assert assign_cable_sides(foam).face is CableSide.MIDDLE


def test_craft_of_pairs_is_sewn_twice_by_the_same_motors() -> None:
    """Oracle: the craft of the same network on one face, doubled but for its motors."""
    starfish = gallery_robot("starfish")
    one, both = BuildCost.of_robot(starfish, []), BuildCost.of_robot(assign_cable_sides(starfish), [])
    assert (both.holes, both.motors, both.motor) == (2 * one.holes, one.motors, one.motor)
    assert both.minutes == pytest.approx(2 * one.minutes)
    assert both.length == pytest.approx(2 * one.length)
    assert one.price < both.price < one.price + 1.0


@pytest.mark.slow
def test_commands_are_found_on_the_filled_body(robot: Robot, reached: tuple[IKResult, ...]) -> None:
    """Oracle: statics of the inflated robot at both commands; its own are no worse than those of the flat model."""
    filled = solve_stuffed(robot, reached, limits=Limits(tension=20.0))
    solid = Simulation(inflated_robot(robot, "pairs"))
    assert filled.face is CableSide.PAIRS
    squares = {"flat": [], "own": []}
    for flat, own in zip(reached, filled.reached, strict=True):
        for name, pose in (("flat", flat), ("own", own)):
            markers = solid.solve(pose.pose.contractions).markers
            squares[name] += [np.sum((markers[m] - [*at, 0]) ** 2) for m, at in flat.pose_target.targets.items()]
    assert filled.played == pytest.approx(np.sqrt(np.mean(squares["flat"])), rel=1e-6)
    assert filled.rms_error == pytest.approx(np.sqrt(np.mean(squares["own"])), rel=1e-4)
    assert filled.rms_error <= 1.01 * filled.played
    assert filled.out < 1e-3
    card = score_card(replace(network(robot, reached), stuffed=filled), version="x")["filled"]
    assert card["face"] == "pairs"
    assert card["poses"]["wave"]["rms_error"] == filled.reached[0].rms_error
    assert set(card["poses"]["wave"]["contractions"]) == {winch.name for winch in robot.winches}


@pytest.mark.slow
def test_the_finalist_that_is_best_when_filled_is_chosen(robot: Robot, reached: tuple[IKResult, ...]) -> None:
    """Oracle: cables that end half-way reach less; they give way to whole ones, and never the reverse."""
    short = tuple(replace(cable, points=cable.points[: len(cable.points) // 2 + 1]) for cable in robot.cables)
    stunted = robot.with_network(robot.winches, short)
    solved = tuple(solve_ik(Simulation(stunted), pose) for pose in robot.poses.values())
    whole, poor = (
        Alternative(robot=r, ik_results=p, expected_error=0.01) for r, p in ((robot, reached), (stunted, solved))
    )
    found = evaluate_stuffed(network(stunted, solved, whole), progress=no_progress)
    assert found.robot is robot
    assert found.stuffed is not None
    assert found.stuffed.finalists == 2
    assert [one.robot for one in found.alternatives] == [stunted]
    kept = evaluate_stuffed(network(robot, reached, poor), progress=no_progress)
    assert kept.robot is robot
    assert kept.stuffed is not None
    assert kept.stuffed.rms_error == pytest.approx(found.stuffed.rms_error)
    assert [one.robot for one in kept.alternatives] == [stunted]


def test_what_cannot_be_filled_is_told_before_the_search() -> None:
    trunk = gallery_robot("trunk")
    with pytest.raises(InputError, match="filled: only for flat robots with a drawing"):
        design_cables(trunk, trunk.poses.values(), stuffed=True)
