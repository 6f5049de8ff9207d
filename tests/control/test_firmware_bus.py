"""`FirmwareBus` on the firmware of two boards. Oracle: where the emulated motors are, and the time of the chip."""

import numpy as np
import pytest
from firmware_bench import FIRMWARE, Board

from hydrostat.control.firmware_bus import FirmwareBus, line_of
from hydrostat.control.restart_motors import fault_words
from hydrostat.errors import HydrostatError

TURN = 1000.0  # counts in a turn


@pytest.fixture(params=["atmega328p", "esp32s3"])
def board(request: pytest.FixtureRequest) -> Board:
    """An Uno, and an ESP32-S3, with two winches."""
    return Board(request.param)


@pytest.fixture
def bus(board: Board) -> FirmwareBus:
    """Motors on it."""
    return FirmwareBus(board, [TURN, TURN], clock=board.clock, wait=board.run)


def test_motors_are_known_driven_and_stopped(board: Board, bus: FirmwareBus) -> None:
    """The deadline is seen to stop them; half a turn is reached; a stop stops on the way."""
    facts, name = bus.identify(), board.ask("I").split()[3]
    assert [(fact.number, fact.model, fact.watchdog) for fact in facts] == [
        (1, f"{name} (trial)", True),
        (2, f"{name} (trial)", True),
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


class LatePort:
    """A board that answers at once, on a computer that is held up for a second at each line that it sends."""

    def __init__(self) -> None:
        self.now, self._answers = 0.0, b""
        self.timeout: float | None = None

    def write(self, line: bytes) -> None:
        """Answer, and let the time for answers pass."""
        self._answers, self.now = line_of(f"{int(line.split()[0])} ok armed 0 500 20 0 10"), self.now + 1.0

    def read(self, count: int) -> bytes:
        """Bytes that have come."""
        found, self._answers = self._answers[:count], self._answers[count:]
        return found

    @property
    def in_waiting(self) -> int:
        """Number of bytes that have come."""
        return len(self._answers)

    def close(self) -> None:
        """Nothing to let go."""


def test_a_late_computer_reads_the_answer_that_has_come() -> None:
    """It took the board for silent. Oracle: half a turn, as the answer says."""
    port = LatePort()
    bus = FirmwareBus(port, [TURN, TURN], clock=lambda: port.now, wait=lambda _: None)
    assert bus.read().angles == pytest.approx([np.pi, 0.0])


def test_a_battery_that_sags_is_told() -> None:
    """Volts of the divider with every reading; below the minimum, a fault of all motors, and no arming."""
    settings = (FIRMWARE / "settings.h").read_text() + "#define MIN_SUPPLY 9600\n"
    board = Board(settings=settings)
    bus = FirmwareBus(board, [TURN, TURN], clock=board.clock, wait=board.run)
    bus.identify()
    bus.arm(np.array([1.0, 1.0]))
    assert bus.read().volts == pytest.approx([12.0, 12.0], abs=0.04)
    board.feed(9.0)
    for _ in range(20):
        bus.write(np.zeros(2), np.ones(2))
        board.run(0.04)
    words = fault_words("left", bus.read(), 0)
    assert words.startswith("the motor of left reports: supply voltage too low (9.0 V measured). Charge its battery")
    with pytest.raises(HydrostatError, match=r"supply was too low\. Charge or feed it, then reset"):
        bus.arm(np.array([1.0, 1.0]))
