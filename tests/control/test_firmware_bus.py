"""`FirmwareBus` on the firmware in simavr. Oracle: where the emulated motors are, and the time of the chip."""

import numpy as np
import pytest
from firmware_bench import Board

from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.errors import HydrostatError

TURN = 1000.0  # counts in a turn


@pytest.fixture
def board() -> Board:
    """An Uno with two winches."""
    return Board()


@pytest.fixture
def bus(board: Board) -> FirmwareBus:
    """Motors on it."""
    return FirmwareBus(board, [TURN, TURN], clock=board.clock, wait=board.run)


def test_motors_are_known_driven_and_stopped(board: Board, bus: FirmwareBus) -> None:
    """The deadline is seen to stop them; half a turn is reached; a stop stops on the way."""
    facts = bus.identify()
    assert [(fact.number, fact.model, fact.watchdog) for fact in facts] == [
        (1, "uno (trial)", True),
        (2, "uno (trial)", True),
    ]
    bus.arm(np.array([1.0, 1.0]))
    reading = bus.read()
    for _ in range(25):
        bus.write(np.array([np.pi, 1.0]), np.array([10.0, 10.0]))
        board.run(0.02)
        reading = bus.read()
    assert reading.angles == pytest.approx([np.pi, 1.0], abs=0.03)
    assert board.winches[0].angle == pytest.approx(0.5 * TURN, abs=5)
    assert reading.faults == ("", "")
    assert reading.stamps == pytest.approx([board.clock()] * 2, abs=1e-3)
    bus.write(np.array([20.0, 1.0]), np.array([10.0, 10.0]))
    board.run(0.1)
    bus.stop()
    bus.stop()
    board.run(0.1)
    where = board.winches[0].angle
    assert 0.5 * TURN < where < 1.2 * TURN
    board.run(0.4)
    assert board.winches[0].angle == pytest.approx(where, abs=10)
    assert bus.read().faults == ("", "")  # who was told to stand may be silent


def test_what_the_board_refuses_is_told(board: Board, bus: FirmwareBus) -> None:
    """Too much current at once; a goal beyond the limits with the next reading."""
    bus.identify()
    with pytest.raises(HydrostatError, match="bounds of current; it says: no current"):
        bus.arm(np.array([1.0, 2.0]))
    bus.arm(np.array([1.0, 1.0]))
    bus.write(np.array([100.0, 0.0]), np.array([10.0, 10.0]))
    assert bus.read().faults == ("refused: limit",) * 2
    assert bus.read().faults == ("", "")
    board.run(0.05)
    assert board.winches[0].angle < 3
    bus.close()
    bus.close()


def test_strangers_are_named(board: Board) -> None:
    """A board for other motors, and a line where nobody answers."""
    with pytest.raises(HydrostatError, match="built for 2 motors, and 3 are asked for"):
        FirmwareBus(board, [TURN] * 3, clock=board.clock, wait=board.run).identify()
    board.write = lambda data: len(data)  # type: ignore[method-assign]
    with pytest.raises(HydrostatError, match="does not answer"):
        FirmwareBus(board, [TURN] * 2, clock=board.clock, wait=board.run).identify()
