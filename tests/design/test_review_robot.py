"""One judgement for design and fabrication. Oracles: the kit's own refusals, networks that designs return."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import gallery_robot, gallery_texts

from hydrostat.design import Constraints, Network, RouteOptions, design_cables
from hydrostat.design.finding import Severity
from hydrostat.design.robot_review import review_robot
from hydrostat.design.skin_region import cable_region
from hydrostat.fabrication import ALL_MOTORS, Demand, KitOptions, UnbuildableError, build_kit
from hydrostat.robot import Robot, find_risks, robot_hash

SMALL = RouteOptions(starts=1, exchanges=0, refine_steps=2, trials=2, steps=2, max_edges=6)


@cache
def designed(name: str, winches: int, cables: int) -> Network:
    """A network for the first pose of a robot of the gallery."""
    robot = gallery_robot(name)
    return design_cables(robot, [next(iter(robot.poses.values()))], winches=winches, cables=cables, options=SMALL)


def refused(robot: Robot, **given: object) -> list[str]:
    found = review_robot(robot, **given)  # type: ignore[arg-type]
    return [finding.text for finding in found if finding.severity is Severity.REFUSED]


def crowded() -> Robot:
    """A starfish with a hole at the tip of an arm, and spools as large as a palm."""
    robot = gallery_robot("starfish")
    tip = robot.body.mesh.nodes[np.argmax(robot.body.mesh.nodes[:, 1])]
    edge = tuple((0.999 * tip).tolist())
    cables = (replace(robot.cables[0], points=(*robot.cables[0].points, edge)), *robot.cables[1:])
    return robot.with_network([replace(winch, spool_radius=0.03) for winch in robot.winches], cables)


@pytest.mark.slow
@pytest.mark.parametrize("motor", ["auto", "25d"])
def test_what_is_known_before_a_kit_is_made_is_what_refuses_it(motor: str, unchecked: None) -> None:
    robot, options = crowded(), KitOptions(motor=motor)
    known = refused(robot, demand=Demand.find(robot), options=options)
    assert len(known) >= 2
    with pytest.raises(UnbuildableError) as told:
        build_kit(robot, options=options)
    assert list(told.value.reasons) == known


def test_nothing_refuses_a_robot_of_the_gallery(unchecked: None) -> None:
    """All that are flat, and two in space, whose bodies tests/robot/test_gallery_bodies.py checks."""
    flat = [name for name, text in gallery_texts().items() if "outline" in text["body"]]
    assert len(flat) >= 6
    for name in (*flat, "fish_tail", "cupping_hand"):
        assert refused(gallery_robot(name)) == []


def test_one_sentence_for_each_kind_of_limit_with_all_places(unchecked: None) -> None:
    """Oracle: the holes of letter_e that turn by more than 30 degrees, from their coordinates."""
    robot = gallery_robot("letter_e")
    found = [one for one in review_robot(robot, constraints=Constraints()) if one.severity is Severity.LIMIT]
    (turns,) = [one for one in found if "turn too sharp" in one.text]
    sharp = set()
    for number, cable in enumerate(robot.cables):
        steps = np.diff(np.array(cable.points), axis=0)
        angles = np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))))
        sharp |= {f"via:{number}:{at + 1}" for at in np.flatnonzero(angles > 30.1)}
    assert {place.part for place in turns.places} == sharp
    cables = {name.split(":")[1] for name in sharp}
    where = f", on {len(cables)} cables" if len(cables) > 1 else ""
    assert turns.text.endswith(f" Move the point. {len(sharp) - 1} more such{where}.")
    assert review_robot(robot) == tuple(
        one for one in review_robot(robot, constraints=Constraints()) if one not in found
    )


def test_the_first_of_many_points_near_the_skin_is_the_shallowest_of_them(unchecked: None) -> None:
    """Oracle: distances of all points of the cables of the spine in its region."""
    robot = gallery_robot("spine")
    (shallow,) = [one for one in review_robot(robot, constraints=Constraints()) if "low clearance" in one.text]
    region = cable_region(robot.body, Constraints())
    depths = np.concatenate([region.depths(np.array(cable.points[2:])) for cable in robot.cables])
    assert f"({round(1e3 * float(depths.min()), 2):g} mm inside the surface" in shallow.text
    assert shallow.text.endswith(f" more such, on {len(robot.cables)} cables.")


def test_risks_are_told_last_as_they_are(unchecked: None) -> None:
    robot = gallery_robot("squid")
    found = review_robot(robot, constraints=Constraints())
    assert [one.text for one in found if one.severity is Severity.WARNING] == find_risks(robot)
    order = [list(Severity).index(one.severity) for one in found]
    assert order == sorted(order)


def test_the_motor_of_the_judgement_is_that_of_the_poses(unchecked: None) -> None:
    """Oracle: the strongest motor, asked for by its name."""
    robot = gallery_robot("squid")
    demand = Demand.find(replace(robot, poses=dict(list(robot.poses.items())[:1])))
    strong = replace(demand, torques=np.full(len(robot.winches), 10.0))
    strongest = max(ALL_MOTORS, key=lambda motor: motor.stall_torque)
    assert refused(robot, demand=strong) == refused(robot, options=KitOptions(motor=strongest.key))
    assert refused(robot, demand=strong) != []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "winches", "cables"),
    [("starfish", 2, 3), ("letter_s", 1, 2), ("puppy", 2, 2)],
)
def test_a_kit_never_refuses_what_a_design_returned(name: str, winches: int, cables: int, unchecked: None) -> None:
    robot = gallery_robot(name)
    pose = next(iter(robot.poses.values()))
    network = designed(name, winches, cables)
    made = replace(network.robot, poses={pose.name: pose})
    assert refused(made, demand=Demand.of_results(made, network.ik_results)) == []
    kit = build_kit(
        made, options=KitOptions(tension=network.constraints.tension_limit, torque=network.constraints.torque)
    )
    assert kit.problems == ()
    assert Demand.find(made, tension=network.constraints.tension_limit).tensions.max() <= 1.001 * 20.0


@pytest.mark.slow
def test_a_network_that_can_be_built_comes_before_a_better_one_that_cannot(
    monkeypatch: pytest.MonkeyPatch, unchecked: None
) -> None:
    """Oracle: the same search, whose best network is then said to be refused."""
    free = designed("letter_s", 1, 2)
    assert free.alternatives
    best = robot_hash(free.robot)
    monkeypatch.setattr(
        "hydrostat.design.routes.finalists.find_refusals",
        lambda made, demand, **_: ("no room",) if robot_hash(made) == best else (),
    )
    bound = designed.__wrapped__("letter_s", 1, 2)
    assert robot_hash(bound.robot) == robot_hash(min(free.alternatives, key=lambda other: other.expected_error).robot)
    assert best in {robot_hash(other.robot) for other in bound.alternatives}
