"""Where a winch can be built in. Oracle: the ways to lie, and the pockets, that the kit tries for a unit."""

import re
from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot, mesh_body, strip_mesh, strip_robot
from moulds.mould_robots import blob_body, foam_robot, slab_body
from plot.designs import plain_network

from hydrostat.design import DesignRequest, QuickSearch, draw_first_cable
from hydrostat.design.cable_design import design_cables
from hydrostat.design.constraints import Constraints
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.finalists import kit_fits
from hydrostat.design.winch_room import _example, built_in, find_holding_torque, find_no_room, limit_torque, winch_room
from hydrostat.design.zone import Zone
from hydrostat.errors import InputError
from hydrostat.fabrication import (
    COMPRESSION_SHARE,
    MOTORS,
    OVERLAP_TOLERANCE,
    KitOptions,
    Motor,
    PartOptions,
    UnitBox,
    build_kit,
    find_refusals,
    seam_of,
    unit_room,
)
from hydrostat.robot import Marker, Mount, Pin, PoseTarget, Robot


@pytest.mark.parametrize("name", ["starfish", "letter_e"])
def test_a_unit_lies_within_the_seam_wherever_there_is_room(name: str, unchecked: None) -> None:
    """Of the strongest motor that fits; and nowhere 8 mm outside the room: the kit slides a unit by 6.

    The pins, where no winch stands, are on the edge.
    """
    robot, limits = gallery_robot(name), Constraints()
    side = robot.body.mesh.nodes[robot.body.mesh.boundary[0]]
    robot = replace(robot, pins=tuple(Pin(at=tuple(end)) for end in side.tolist()))
    zones, motor = winch_room(robot, limits, 2)
    assert motor is MOTORS[-1]
    assert zones
    box = unit_room(*_example(robot, limits, 2), PartOptions(), MOTORS[-1])
    seam, thick = seam_of(robot.body), 1e3 * robot.body.thickness
    nodes = robot.body.mesh.nodes
    away = np.min([zone.distances(nodes) for zone in zones], axis=0)

    def fits(at: np.ndarray) -> bool:
        unit = UnitBox(winch="w", at=(1e3 * at[0], 1e3 * at[1]), low=box.low, high=box.high, along=0.0)
        return any(
            place.outside <= OVERLAP_TOLERANCE and place.depth <= (1 + COMPRESSION_SHARE) * thick
            for place in unit.ways_to_lie(seam)
        )

    inside, outside = nodes[away < -5e-4][::4], nodes[away > 8e-3][::6]
    assert len(inside) > 3
    assert all(map(fits, inside))
    assert not any(map(fits, outside))


def test_winches_stand_in_no_pin_and_on_no_eye(unchecked: None) -> None:
    """Oracle: distances from the pin and from the eye; elsewhere there is the room that there was without them."""
    robot, limits = gallery_robot("starfish"), Constraints()
    (pin,) = robot.pins
    assert pin.at is not None
    turns = np.linspace(0.0, 2 * np.pi, 40)
    eye = np.array([0.0, 0.06]) + 0.006 * np.column_stack([np.cos(turns), np.sin(turns)])
    drawn = replace(robot, body=replace(robot.body, marks=(eye,)))
    bare = replace(robot, pins=(Pin(at=(0.0, 0.2), radius=0.09),))
    places = robot.body.mesh.nodes
    found = [winch_room(each, limits, 3)[0] for each in (drawn, bare)]
    away, before = (np.min([zone.distances(places) for zone in zones], axis=0) for zones in found)
    free = before < 0
    taken = np.linalg.norm(places - pin.at, axis=1) < 0.99 * pin.radius
    on_eye = np.linalg.norm(places - eye.mean(axis=0), axis=1) < 0.006 + limits.spool_radius
    assert (free & taken).any()
    assert (free & on_eye).any()
    assert (away[taken | on_eye] >= 0).all()
    far = np.linalg.norm(places - pin.at, axis=1) > 2 * pin.radius
    far &= np.linalg.norm(places - eye.mean(axis=0), axis=1) > 0.02
    assert (away[far & (before < -1e-3)] <= 1e-4).all()
    assert (away >= before - 2e-4).all()


def test_zones_of_ones_own_count(unchecked: None) -> None:
    robot = gallery_robot("starfish")
    small = Zone(at=(0.0, 0.0), radius=0.02)
    zones, _ = winch_room(robot, Constraints(winch_zones=(small,)), 2)
    corners = np.array([corner for zone in zones for corner in zone.outline])
    assert np.linalg.norm(corners, axis=1).max() <= 0.0201


def test_a_pocket_fits_wherever_there_is_room_in_foam(unchecked: None) -> None:
    """Oracle: the pockets that the kit makes by booleans of solids; none fits 8 mm outside the room."""
    body = blob_body((0.15, 0.09, 0.08))
    robot = foam_robot(body, (0.0, 0.0, 0.0))
    zones, motor = winch_room(robot.with_network((), ()), Constraints(), 1)
    assert motor is MOTORS[-1]
    options = KitOptions(motor=motor.key)

    def fits(at: np.ndarray) -> bool:
        return not find_refusals(foam_robot(body, tuple(at.tolist())), options=options)

    middles = np.array([zone.at for zone in zones])
    rims = np.array([np.add(zone.at, (0.0, 0.0, 0.9 * zone.radius)) for zone in zones])
    assert all(map(fits, [*middles, *rims]))
    places = 0.9 * body.mesh.nodes
    away = np.min([zone.distances(places) for zone in zones], axis=0)
    assert (away > 8e-3).sum() > 20
    assert not any(map(fits, places[away > 8e-3][::8]))


def test_a_motor_of_choice_decides_room_and_torque() -> None:
    """Oracle: the motor's own rating; a strip too narrow for it says what size would do."""
    wide = strip_robot(columns=4, rows=1)
    wide = replace(wide, body=replace(wide.body, thickness=0.05))
    own = Constraints(motor="sts3215")
    servo = Motor.choose("sts3215")
    held = built_in(wide, own, winches=1, cables=1)
    assert held.torque == pytest.approx(servo.largest_torque(), rel=0.1)
    assert built_in(wide, Constraints(motor="n20"), winches=1, cables=1).torque < 0.5 * held.torque
    outside = limit_torque(replace(own, mount=Mount.WORLD))
    assert outside.torque == held.torque
    assert limit_torque(Constraints(torque=0.1)).torque == 0.1
    thin = replace(wide, body=replace(wide.body, thickness=0.01))
    with pytest.raises(InputError, match=r"no room for the motor .*STS3215"):
        built_in(thin, own, winches=1, cables=1)
    with pytest.raises(InputError, match="motor must be one of auto, n20"):
        Constraints(motor="servo")


def test_the_motor_of_a_robot_decides_too() -> None:
    """Oracle: refusals of a kit with that motor: none for its own first cable, some for that of a small motor."""
    robot = replace(gallery_robot("starfish"), motor="sts3215")
    assert find_refusals(draw_first_cable(robot)) == ()
    assert find_refusals(replace(draw_first_cable(replace(robot, motor="auto")), motor="sts3215"))
    pose = robot.poses["wave"]
    quick = QuickSearch(robot, DesignRequest(poses=(pose,), winches=1, cables=1))
    assert (quick.robot.motor, quick.constraints.motor) == ("sts3215", "sts3215")
    given = QuickSearch(robot, DesignRequest(poses=(pose,), winches=1, cables=1, constraints=Constraints(motor="n20")))
    assert given.robot.motor == "n20"
    assert given.constraints.torque < quick.constraints.torque


def test_torque_to_hold_is_asked_for_where_a_motor_holds_for_seconds_only() -> None:
    """Oracle: the smallest motor bears 49 N mm for long and half of 196 N mm for seconds, each with a margin of 2."""
    network = plain_network()
    (arm,) = {winch.spool_radius for winch in network.robot.winches}

    def asked(torque: float) -> float | None:
        tensions = np.array([torque / arm, 0.0])
        reached = [replace(one, pose=replace(one.pose, tensions=tensions)) for one in network.ik_results]
        return find_holding_torque(network.robot, reached)

    assert asked(0.0244) is None
    assert asked(0.04) == pytest.approx(0.0245, rel=3e-3)
    outside = [replace(winch, mount=Mount.WORLD) for winch in network.robot.winches]
    assert find_holding_torque(network.robot.with_network(outside, network.robot.cables), network.ik_results) is None


@pytest.mark.slow
def test_a_design_in_foam_can_be_built(unchecked: None) -> None:
    """Oracle: the whole kit, which raises for every reason not to build it."""
    body = slab_body((0.2, 0.06, 0.06))
    robot = replace(
        foam_robot(body, (0.0, 0.0, 0.0)).with_network((), ()),
        markers=(Marker(name="tip", at=(0.095, 0.0, 0.0)),),
        poses={"bend": PoseTarget(name="bend", targets={"tip": (0.08, 0.0, 0.04)})},
    )
    quick = RouteOptions(starts=1, trials=2, refine_steps=5, exchanges=0)
    network = design_cables(robot, robot.poses.values(), winches=1, cables=1, options=quick)
    limits = network.constraints
    assert network.robot.max_tension == pytest.approx(limits.tension_limit, rel=1e-3)
    assert network.robot.max_torque == pytest.approx(limits.torque, rel=1e-3)
    kit = build_kit(network.robot)
    assert kit.problems == ()
    assert all(check.passed for check in kit.checks)
    assert kit_fits(network)


def test_winches_need_room_next_to_each_other(unchecked: None) -> None:
    """Six of the smallest unit do not fit into a body that holds one; more room is asked for than for one."""
    robot = foam_robot(slab_body((0.09, 0.045, 0.045)), (0.0, 0.0, 0.0), at=(0.0, 0.0, 0.01)).with_network((), ())
    assert winch_room(robot, Constraints(), 1)[1] is not None
    with pytest.raises(InputError, match=r"body: no room for 6 motors .* Make it at least \d+ mm long"):
        built_in(robot, Constraints(), winches=6, cables=6)


@pytest.mark.parametrize("thickness", [0.01, 0.03])
def test_a_body_of_the_size_that_an_error_names_has_room(thickness: float) -> None:
    """Oracle: the same search for room in the larger body; none in one 10 % smaller."""

    def body_of(scale: float) -> Robot:
        mesh = strip_mesh(12, 2, size=(0.12 * scale, 0.02 * scale))
        body = mesh_body(mesh, thickness=thickness * scale)
        return replace(strip_robot(), cables=(), winches=(), markers=(), body=body)

    with pytest.raises(InputError, match=r"no room for the motor \(smallest: Pololu micro") as caught:
        built_in(body_of(1.0), Constraints(), winches=1, cables=1)
    scale = float(re.search(r"at least (\d+) mm long", str(caught.value))[1]) / 120
    assert winch_room(body_of(scale), Constraints(), 1)[1] is not None
    assert winch_room(body_of(0.9 * scale), Constraints(), 1)[1] is None
    assert find_no_room(body_of(1.0)) == str(caught.value)
    assert find_no_room(body_of(scale)) is None


def test_a_thin_body_with_room_otherwise_need_only_be_thicker() -> None:
    """Oracle: the same search for room in the thicker body; none in one 10 % thinner."""

    def body_of(thickness: float) -> Robot:
        body = mesh_body(strip_mesh(8, 4, size=(0.2, 0.1)), thickness=thickness)
        return replace(strip_robot(), cables=(), winches=(), markers=(), body=body)

    found = re.search(r"Make it at least (\d+) mm thick\.", find_no_room(body_of(0.008)) or "")
    assert found is not None
    thick = 1e-3 * float(found[1])
    assert find_no_room(body_of(thick)) is None
    assert find_no_room(body_of(0.9 * thick)) is not None


def test_winches_outside_need_no_room(unchecked: None) -> None:
    assert find_no_room(gallery_robot("cupping_hand")) is None


def test_a_small_body_gives_the_torque_that_the_motor_that_fits_holds() -> None:
    """Oracle: the catalog, by which this motor holds that torque for long with the margin, and not more."""
    body = mesh_body(strip_mesh(8, 4, size=(0.08, 0.04)), thickness=0.03)
    robot = replace(strip_robot(), cables=(), winches=(), markers=(), body=body)
    _, motor = winch_room(robot, Constraints(), 2)
    assert motor is not None
    limits = built_in(robot, Constraints(), winches=1, cables=2)
    assert limits.torque is not None
    assert 2 * limits.torque < 1e-3 * motor.rated_torque < 2 * 1.01 * limits.torque
    assert limits.tension_limit == pytest.approx(min(limits.torque / limits.spool_radius, limits.tension))
    assert built_in(robot, Constraints(torque=0.01), winches=1, cables=2).torque == 0.01


def test_where_the_strongest_motor_fits_a_cable_pulls_as_asked(unchecked: None) -> None:
    limits = built_in(gallery_robot("starfish"), Constraints(), winches=2, cables=6)
    assert limits.torque == pytest.approx(MOTORS[-1].largest_torque(), rel=3e-3)
    assert limits.torque < MOTORS[-1].largest_torque()
    assert limits.tension_limit == Constraints().tension
