"""Motors against loads, by closed forms and by integration."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from small_inputs import PLAIN, demand_of, square

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.motors import MARGIN, WinchSizing, motor_table, motor_warnings, size_winches
from hydrostat.robot import Cable

START = (-0.02, -0.01)


def sizing(
    *tensions: float, stall_torque: float = 200.0, rated_torque: float = 80.0, speed: float = 60.0
) -> WinchSizing:
    """Of a spool of 6 mm with a travel of 60 mm and a release of 6 mm."""
    cables = [Cable(winch="pull", points=(START, (0.01, 0.01 * index))) for index in range(len(tensions))]
    robot = square(*cables, spool_radius=0.006, travel=0.06, release=0.006)
    motor = replace(PLAIN, stall_torque=stall_torque, rated_torque=rated_torque, speed=speed)
    return size_winches(robot, demand_of(robot, *tensions), motor)[0]


def test_loads_of_two_cables_on_one_spool() -> None:
    found = sizing(5.0, 7.0)
    assert found.torque == pytest.approx(6 * 12)
    assert found.torque_with_margin == pytest.approx(MARGIN * 72)
    assert found.tension == 7.0
    assert found.cables == 2
    assert found.turns == pytest.approx(66 / (12 * math.pi))


def test_speed_falls_evenly_to_none_at_stall() -> None:
    assert sizing(10.0, stall_torque=240.0, speed=60.0).loaded_speed == pytest.approx(45)  # 60 of 240 N mm
    assert sizing(10.0, stall_torque=240.0, speed=60.0).pull == pytest.approx(2 * math.pi * 6 * 0.75)
    assert sizing(40.0, stall_torque=240.0).loaded_speed == 0
    assert sizing(50.0, stall_torque=240.0).loaded_speed == 0


@pytest.mark.parametrize("tension", [0.0, 1e-9, 1.0, 10.0, 39.0])
def test_time_for_the_travel_is_the_integral_of_slowness(tension: float) -> None:
    free = 2 * math.pi * 6 * 60 / 60  # mm/s
    slowness, _ = quad(lambda share: 1 / (free * (1 - share * 6 * tension / 240)), 0, 1)
    assert sizing(tension, stall_torque=240.0, speed=60.0).time == pytest.approx(60 * slowness)


def test_a_motor_that_stalls_never_gets_there() -> None:
    found = sizing(40.0, stall_torque=240.0)
    assert found.time is None
    assert "cannot reach" in motor_warnings((found,))[0]
    assert '"pull"' in motor_warnings((found,))[0]
    assert "240 N mm" in motor_warnings((found,))[0]


@pytest.mark.parametrize(
    ("tension", "words"),
    [
        (6.6, []),
        (6.7, ["continuous rating"]),
        (16.6, ["continuous rating"]),
        (16.7, ["may stall before"]),
        (34.0, ["cannot reach"]),
    ],
)
def test_what_is_warned_of(tension: float, words: list[str]) -> None:
    warnings = motor_warnings((sizing(tension, stall_torque=200.0, rated_torque=80.0),))
    assert len(warnings) == len(words)
    assert all(word in warning for word, warning in zip(words, warnings, strict=True))


def test_a_slow_winch_is_called_slow() -> None:
    assert " s for its travel of" in motor_warnings((sizing(1.0, speed=1.0),))[0]


def test_a_winch_without_cables_asks_for_nothing() -> None:
    robot = square(Cable(winch="pull", points=(START, (0.01, 0.0))))
    demand = demand_of(robot, 0.0)
    table = motor_table(size_winches(robot, demand, PLAIN), demand, PLAIN)
    assert tuple(row.verdict for row in table.rows) == ("good",)
    assert tuple(row.torque for row in table.rows) == (0.0,)


def test_a_demand_of_another_robot_is_refused() -> None:
    robot = square()
    with pytest.raises(InputError, match="the demand is of 1 winches and 2 cables"):
        size_winches(robot, demand_of(square(*robot.cables, replace(robot.cables[0], name="again")), 1.0, 1.0), PLAIN)
    with pytest.raises(InputError, match="stall_torque of plain motor must be above 0"):
        size_winches(robot, demand_of(robot), replace(PLAIN, stall_torque=0.0))
    assert np.isfinite(sizing(1.0).time or np.nan)


def test_winches_alike_share_a_sentence() -> None:
    one, other = (sizing(tension, stall_torque=200.0, rated_torque=80.0) for tension in (10.0, 12.0))
    (warning,) = motor_warnings((replace(one, winch="left"), replace(other, winch="right")))
    assert warning.startswith('winches "left", "right" need up to 72 N mm, 144 N mm with the margin of 2')
