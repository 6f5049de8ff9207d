"""Winches whose motors are parts of the body. Oracle: the same robot with parts of that box and density by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, mesh_body

from hydrostat.errors import InputError
from hydrostat.fabrication import Motor, PartOptions, unit_room
from hydrostat.fabrication.inserts import find_inserts
from hydrostat.fabrication.winch_bodies import winch_bodies
from hydrostat.robot import (
    Cable,
    Contact,
    Mount,
    Obstacle,
    Pin,
    Robot,
    Winch,
    fit_winch_bodies,
    load_robot,
    robot_text,
    save_robot,
    scaled_robot,
)
from hydrostat.simulation import ContractionProfile, Simulation


@pytest.fixture(scope="module")
def fitted() -> Robot:
    """The starfish with the motor of one winch in its body."""
    robot = gallery_robot("starfish")
    winches = [replace(winch, body=winch.name == "feet") for winch in robot.winches]
    return fit_winch_bodies(replace(robot.with_network(winches, robot.cables), motor="n20"))


def by_hand(robot: Robot) -> Robot:
    """The same with an ordinary part."""
    parts = [replace(part, winch="") for part in robot.body.parts]
    winches = [replace(winch, body=False) for winch in robot.winches]
    return replace(robot.with_network(winches, robot.cables), body=replace(robot.body, parts=tuple(parts)))


def test_a_winch_is_a_rigid_part_of_its_box_and_mass(fitted: Robot) -> None:
    (part,), motor = fitted.body.parts, Motor.choose("n20")
    room = unit_room(fitted, fitted.winch("feet"), PartOptions(), motor)
    sides = sorted(np.linalg.norm(np.diff([*part.points, part.points[0]], axis=0), axis=1).round(6))
    assert part.is_rigid
    assert {*sides} <= {round(1e-3 * side, 6) for side in room.size}
    own = fitted.body.element_materials == 1
    mass = float(fitted.body.element_masses[own].sum())
    assert mass == pytest.approx(winch_bodies(fitted)[0][1], rel=1e-9)
    assert mass == pytest.approx(0.0205, abs=0.002)  # 10 g of motor and what the kit's bill says of the prints


def test_poses_and_motions_are_those_of_a_part_by_hand(fitted: Robot) -> None:
    ball = Obstacle(name="ball", shape="sphere", at=(0.0, -0.11), radius=0.02)
    touching = replace(fitted, contact=Contact(), obstacles=(ball,), gravity=(0.0, -9.81))
    one, other = Simulation(touching), Simulation(by_hand(touching))
    pull = {"left": 0.01, "feet": 0.005}
    np.testing.assert_array_equal(one.solve(pull).nodes, other.solve(pull).nodes)
    profile = ContractionProfile.ramp(one.as_contractions(pull), 0.05)
    ends = [list(each.play(profile, 0.1, 0.02))[-1].nodes for each in (one, other)]
    np.testing.assert_array_equal(*ends)
    free = Simulation(gallery_robot("starfish")).body.masses.sum()
    assert one.body.masses.sum() > free + 0.01


def test_what_is_written_is_read_and_a_larger_robot_keeps_its_motors(fitted: Robot, tmp_path: Path) -> None:
    save_robot(fitted, tmp_path / "a")
    assert "[[body.part]]" not in robot_text(fitted)
    again = load_robot(tmp_path / "a")
    assert again.body.parts[0].points == fitted.body.parts[0].points
    assert again.winches == fitted.winches
    (large,) = scaled_robot(fitted, 2.0).body.parts
    spans = [np.ptp(np.array(part.points), axis=0).sum() for part in (large, fitted.body.parts[0])]
    assert spans[0] < 1.4 * spans[1]  # its spool is twice as wide, its motor is not
    assert find_inserts(fitted) == ()


def test_a_unit_in_space_lies_where_the_most_of_it_is_inside() -> None:
    """The body is 60 mm high and wide, and 200 mm long: only a unit that lies along it fits."""
    body = mesh_body(box_mesh((20, 6, 6), size=(0.2, 0.06, 0.06)))
    winch = Winch(name="w", at=(0.08, 0.03, 0.03), body=True)
    cable = Cable(winch="w", points=((0.08, 0.03, 0.03), (0.19, 0.03, 0.05)))
    pins = (Pin(box=((-1e-3, -1.0, -1.0), (1e-3, 1.0, 1.0))),)
    robot = Robot(name="bar", body=body, pins=pins, winches=(winch,), cables=(cable,), poses={}, motor="25d")
    (part,) = fit_winch_bodies(robot).body.parts
    assert part.at is not None
    assert part.to is not None
    assert np.abs(np.subtract(part.to, part.at)).argmax() == 0
    room = unit_room(robot, winch, PartOptions(), Motor.choose("25d"))
    assert sorted(np.subtract(part.to, part.at)) == pytest.approx(sorted(1e-3 * side for side in room.size))


def test_what_does_not_fit_is_told_in_one_line(fitted: Robot) -> None:
    with pytest.raises(InputError, match=r'winch "feet": body = true needs a motor. Set motor .* Available: n20,'):
        fit_winch_bodies(replace(fitted, motor="auto"))
    with pytest.raises(InputError, match='winch "feet": body = true needs a cable'):
        fit_winch_bodies(fitted.with_network(fitted.winches, [one for one in fitted.cables if one.winch != "feet"]))
    moved = [replace(each, at=(0.0, 0.05)) if each.body else each for each in fitted.winches]
    led = [replace(one, points=((0.0, 0.05), *one.points[1:])) for one in fitted.cables if one.winch == "feet"]
    with pytest.raises(InputError, match='winch "feet": its unit is no part of the body'):
        Simulation(fitted.with_network(moved, led))
    with pytest.raises(InputError, match='winch "feet": it has no body now'):
        Simulation(replace(fitted, winches=tuple(replace(each, body=False) for each in fitted.winches)))
    with pytest.raises(InputError, match="body = true is for a winch in the body"):
        Winch(name="w", at=(0.0, 0.0), mount=Mount.WORLD, body=True)


def test_another_network_takes_its_units_out_of_the_body(fitted: Robot) -> None:
    """Oracle: the body before; the same motors fitted into it by hand."""
    plain = fitted.with_network([replace(winch, body=False) for winch in fitted.winches], fitted.cables)
    assert plain.body == gallery_robot("starfish").body
    staying = [winch for winch in fitted.winches if winch.name != "left"]
    fewer = fitted.with_network(staying, [cable for cable in fitted.cables if cable.winch != "left"])
    assert fewer.body is fitted.body
    Simulation(plain)
    Simulation(fewer)
    both = fit_winch_bodies(replace(fitted, winches=tuple(replace(winch, body=True) for winch in fitted.winches)))
    (part,) = both.with_network(fitted.winches, fitted.cables).body.parts
    assert part.points == fitted.body.parts[0].points
    assert part.density == pytest.approx(fitted.body.parts[0].density, rel=0.01)
