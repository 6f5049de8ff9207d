"""Oracle: closed form: a motor at the speed it is told is where speed times time says."""

import numpy as np
import pytest

from hydrostat.control import SimulatedLink
from hydrostat.control.link import WATCHDOG_TIMEOUT


def link() -> SimulatedLink:
    return SimulatedLink(np.array([0.0, 0.02]))


def test_it_goes_no_faster_than_its_largest_speed_and_stops_at_its_goal() -> None:
    motors = link()
    motors.send(np.array([0.03, 0.0]), 10.0, speed=0.1)
    assert motors.read(10.0) == pytest.approx([0.0, 0.02])
    assert motors.read(10.1) == pytest.approx([0.01, 0.01])
    assert motors.read(10.25) == pytest.approx([0.025, 0.0])
    assert motors.read(10.4) == pytest.approx([0.03, 0.0])


def test_it_goes_at_the_speed_of_the_newest_command() -> None:
    motors = link()
    motors.send(np.array([0.05, 0.02]), 0.0, speed=0.1)
    motors.send(np.array([0.05, 0.02]), 0.1, speed=0.02)
    assert motors.read(0.3) == pytest.approx([0.014, 0.02])


def test_the_newest_command_counts() -> None:
    motors = link()
    motors.send(np.array([0.05, 0.02]), 0.0, speed=0.1)
    motors.send(np.array([0.0, 0.02]), 0.1, speed=0.1)
    assert motors.read(0.1) == pytest.approx([0.01, 0.02])
    assert motors.read(0.2) == pytest.approx([0.0, 0.02])


def test_told_nothing_it_stops_after_the_silence() -> None:
    motors = link()
    motors.send(np.array([1.0, 0.02]), 0.0, speed=0.1)
    assert motors.read(60.0) == pytest.approx([0.1 * WATCHDOG_TIMEOUT, 0.02])
    motors.send(np.array([1.0, 0.02]), 60.0, speed=0.1)
    assert motors.read(60.1) == pytest.approx([0.1 * (WATCHDOG_TIMEOUT + 0.1), 0.02])


@pytest.mark.parametrize("end", [SimulatedLink.stop, SimulatedLink.close])
def test_stopped_it_stays_where_it_was_read_last(end) -> None:
    motors = link()
    motors.send(np.array([1.0, 0.02]), 0.0, speed=0.1)
    here = motors.read(0.1)
    end(motors)
    end(motors)
    assert motors.read(0.3) == pytest.approx(here)


def test_a_clock_that_jumps_back_moves_nothing() -> None:
    motors = link()
    motors.send(np.array([1.0, 0.02]), 5.0, speed=0.1)
    here = motors.read(5.1)
    assert motors.read(4.0) == pytest.approx(here)
