"""Motors of drives. Oracles: angles by hand, the emulated servo's own angle."""

from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.control import (
    EMULATED,
    Calibration,
    Motors,
    SimulatedLink,
    arm_motors,
    list_moved_loads,
    motor_stand,
    stand_table,
    stand_tensions,
)
from hydrostat.errors import InputError
from hydrostat.robot import Load, LoadDrive, PinDrive, Robot
from hydrostat.simulation import ProfileTable

TABLE = b"time_s,up_mm,base_deg,stage_mm\n0,0,0,0\n1,2,10,-3\n"


@pytest.fixture
def robot() -> Robot:
    """The strip on a servo and on a stage, with a push that no motor makes."""
    strip = strip_robot(columns=8, rows=2)
    servo = PinDrive(name="base", at=(0.0, 0.0), min=-0.5, max=1.0)
    stage = PinDrive(name="stage", slide=(0.0, 1.0), min=-0.01, max=0.02)
    other = replace(strip.pins[0], box=((0.199, -1.0), (0.201, 1.0)), drive="stage")
    return replace(
        strip,
        pins=(replace(strip.pins[0], drive="base"), other),
        loads=(Load(name="push", marker="tip", force=(0.0, -0.1), drive="thumb"),),
        drives=(LoadDrive(name="thumb", min=0.0, max=1.0), servo, stage),
    )


def test_a_degree_counts_as_a_millimeter(robot: Robot) -> None:
    stand, table = motor_stand(robot), stand_table(ProfileTable.read(TABLE, robot, name="m.csv"), robot)
    assert [winch.name for winch in stand.winches] == ["up", "down", "base", "stage"]
    assert not stand.drives
    np.testing.assert_allclose(table.profile.values[1], [2e-3, 0.0, 10e-3, -3e-3], rtol=1e-12)
    motors = Motors(stand.winches, SimulatedLink(np.zeros(4)))
    np.testing.assert_allclose(1e3 * motors.high[2:], [np.degrees(1.0), 20.0])
    np.testing.assert_allclose(1e3 * motors.low[2:], [-np.degrees(0.5), -10.0])
    assert motors.ask(np.array([0.0, 0.0, 0.07, 0.0])) == "base is at its limit of 57.3 deg and was asked for 70.0 deg"
    angles = Calibration.usual(stand).assume_zeros(stand).angles(table.profile.values[1])
    assert angles[2] == pytest.approx(radians(10))


def test_a_share_of_a_load_is_left_to_a_person(robot: Robot) -> None:
    pushed = ProfileTable.read(b"time_s,up_mm,thumb_share\n0,0,0\n1,2,0.5\n", robot, name="m.csv")
    assert list_moved_loads(pushed, robot) == ["thumb_share"]
    assert not list_moved_loads(ProfileTable.read(TABLE, robot, name="m.csv"), robot)
    np.testing.assert_allclose(stand_table(pushed, robot).profile.values, [[0.0] * 4, [2e-3, 0.0, 0.0, 0.0]])


def test_a_winch_with_a_spool_as_large_as_a_degree_takes_in_millimeters(robot: Robot) -> None:
    winch = replace(robot.winches[0], spool_radius=motor_stand(robot).winches[2].spool_radius)
    assert Motors([winch], SimulatedLink(np.zeros(1))).units == ("mm",)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 1 / 3, 57.2957795 / 12, 0.2])
def test_a_radius_of_a_spool_turns_no_pin(robot: Robot, tmp_path: Path, ratio: float) -> None:
    stand = motor_stand(robot)
    motors = Calibration.usual(stand).motors
    geared = replace(motors[2], radius=round(57.2957795e-3 / ratio, 4))
    Calibration((*motors[:2], geared, *motors[3:])).write(tmp_path)
    if 0.3 < ratio < 3.1:
        assert Calibration.read(tmp_path, stand).motors[2] == geared
        return
    with pytest.raises(InputError, match=r'motors\.toml: \[\[motor\]\] of "base": radius .* Write "57\.2957795 mm"'):
        Calibration.read(tmp_path, stand)


@pytest.mark.slow
def test_an_emulated_servo_turns_a_pin(robot: Robot, tmp_path: Path) -> None:
    table = ProfileTable.read(TABLE, robot, name="m.csv")
    pulls, known = stand_tensions(robot, table)
    goal = stand_table(table, robot).profile.values[1]
    assert pulls(goal)[0] > 0
    assert np.isnan(known(goal)[2:]).all()
    motors = arm_motors(tmp_path, motor_stand(robot), EMULATED, pulls, known=known)
    try:
        motors.ask(goal)
        until = motors.clock() + 5.0
        while motors.is_moving or not motors.places.any():
            motors.drive(now := motors.clock())
            assert now < until
        np.testing.assert_allclose(motors.places, goal, atol=4e-4)
    finally:
        motors.link.close()
