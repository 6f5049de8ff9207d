"""Where a winch can be built in. Oracle: the ways to lie that the kit tries for a unit."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot, mesh_body, strip_mesh, strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.winch_room import _example, built_in, winch_room
from hydrostat.design.zone import Zone
from hydrostat.fabrication import (
    GIVES,
    MOTORS,
    TOUCHES,
    PartOptions,
    UnitBox,
    choose_motor,
    seam_of,
    unit_room,
    ways_to_lie,
)


@pytest.mark.parametrize("name", ["starfish", "letter_e"])
def test_a_unit_lies_within_the_seam_wherever_there_is_room(name: str, unchecked: None) -> None:
    """Of the strongest motor that fits; and nowhere 8 mm outside the room: the kit slides a unit by 6."""
    robot, limits = gallery_robot(name), Constraints()
    zones, motor = winch_room(robot, limits, 2)
    assert motor is MOTORS[-1]
    assert zones
    box = unit_room(*_example(robot, limits, 2), PartOptions(), MOTORS[-1])
    seam, thick = seam_of(robot.body), 1e3 * robot.body.thickness
    nodes = robot.body.mesh.nodes
    away = np.min([zone.distances(nodes) for zone in zones], axis=0)

    def fits(at: np.ndarray) -> bool:
        unit = UnitBox(winch="w", at=(1e3 * at[0], 1e3 * at[1]), low=box.low, high=box.high, along=0.0)
        return any(place.outside <= TOUCHES and place.depth <= (1 + GIVES) * thick for place in ways_to_lie(unit, seam))

    inside, outside = nodes[away < -5e-4][::4], nodes[away > 8e-3][::6]
    assert len(inside) > 3
    assert all(map(fits, inside))
    assert not any(map(fits, outside))


def test_zones_of_ones_own_count(unchecked: None) -> None:
    robot = gallery_robot("starfish")
    small = Zone(at=(0.0, 0.0), radius=0.02)
    zones, _ = winch_room(robot, Constraints(winch_zones=(small,)), 2)
    corners = np.array([corner for zone in zones for corner in zone.outline])
    assert np.linalg.norm(corners, axis=1).max() <= 0.0201


def test_in_space_zones_are_left_as_they_are(unchecked: None) -> None:
    assert winch_room(gallery_robot("cupping_hand"), Constraints(), 2) == ((), None)


def test_a_small_body_gives_the_torque_of_the_motor_that_fits() -> None:
    """Oracle: the choice of the kit, which takes this motor up to that torque and a stronger one beyond."""
    body = mesh_body(strip_mesh(8, 4, size=(0.08, 0.04)), thickness=0.03)
    robot = replace(strip_robot(), cables=(), winches=(), markers=(), body=body)
    _, motor = winch_room(robot, Constraints(), 2)
    assert motor is not None
    limits = built_in(robot, Constraints(), winches=1, cables=2)
    assert limits.torque is not None
    assert choose_motor("auto", [limits.torque], inside=True) is motor
    assert choose_motor("auto", [1.01 * limits.torque], inside=True) is not motor
    assert limits.cables_per_winch == 2
    assert limits.tension_limit == pytest.approx(limits.torque / (2 * limits.spool_radius))
    assert built_in(robot, Constraints(torque=0.01), winches=1, cables=2).torque == 0.01


def test_where_the_strongest_motor_fits_tensions_are_as_asked(unchecked: None) -> None:
    robot = gallery_robot("starfish")
    limits = built_in(robot, Constraints(), winches=2, cables=6)
    assert (limits.torque, limits.tension_limit) == (None, Constraints().tension_limit)
