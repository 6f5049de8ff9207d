"""Faults on several boards at once, and bugs that they must catch. Oracles: emulated motors; firmware in simavr."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from emulated_board import BoardMotor, EmulatedBoard
from firmware_bench import Board
from several_boards import COUNTS, HARMS, Boards, BoardsCampaign

from hydrostat.control import bus_link
from hydrostat.control.bus import Reading
from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import Calibration
from hydrostat.control.firmware_bus import ANEW, FirmwareBus, line_of
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.errors import HydrostatError

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.mark.slow
def test_faults_on_several_boards_leave_motors_within_limits_standing_in_time_and_told() -> None:
    campaign = BoardsCampaign(np.random.default_rng(24), seconds=1.0, share=0.25)
    while campaign.injected < 3000:
        campaign.run()
    assert not campaign.wrong
    assert min(campaign.count[kind] for kind in (*HARMS, "host dies", "host sleeps")) > 2


def broken(monkeypatch: pytest.MonkeyPatch, bug: str) -> None:
    if bug == "goals far ahead":
        monkeypatch.setattr(bus_link, "MAX_LEAD_TIME", 5.0)
    elif bug == "no limits":
        initialize: Callable = BusLink.__init__

        def without_limits(self: BusLink, *args: object, **more: object) -> None:
            initialize(self, *args, **more)
            self._low, self._high = self._low - 1.0, self._high + 1.0

        monkeypatch.setattr(BusLink, "__init__", without_limits)
    elif bug == "boards without names":
        monkeypatch.setattr(Calibration, "labels", property(lambda self: tuple(motor.winch for motor in self.motors)))
    elif bug == "an unplugged board is hushed up":
        read = JoinedBus._each

        def hushed(self: JoinedBus, ask: Callable) -> list:
            def last(bus: FirmwareBus, places: np.ndarray) -> Reading:
                try:
                    return ask(bus, places)
                except HydrostatError:
                    return bus._last

            return read(self, last)

        monkeypatch.setattr(JoinedBus, "_each", hushed)
    elif bug == "motors of a board mixed up":

        def mixed(self: JoinedBus, angles: np.ndarray, speeds: np.ndarray) -> None:
            self._each(lambda bus, places: bus.write(angles[places[::-1]], speeds[places]))

        monkeypatch.setattr(JoinedBus, "write", mixed)
    else:
        told: Callable = FirmwareBus.read

        def blind(self: FirmwareBus) -> Reading:
            reading = told(self)
            return replace(reading, faults=tuple("" if ANEW in fault else fault for fault in reading.faults))

        monkeypatch.setattr(FirmwareBus, "read", blind)
        monkeypatch.setattr(FirmwareBus, "_see_that_it_counts_on", lambda self, marked: None)
        monkeypatch.setattr(
            FirmwareBus, "lost_position", property(lambda self: False, lambda self, told: None), raising=False
        )


@pytest.mark.parametrize(
    ("bug", "caught"),
    [
        ("goals far ahead", "still turning"),
        ("no limits", "beyond limits"),
        ("boards without names", "told as"),
        ("an unplugged board is hushed up", "told as"),
        ("motors of a board mixed up", "without cause"),
        ("a board that was reset is armed again", "beyond limits"),
    ],
)
def test_a_bug_is_caught(bug: str, caught: str, monkeypatch: pytest.MonkeyPatch) -> None:
    broken(monkeypatch, bug)
    campaign = BoardsCampaign(np.random.default_rng(12), seconds=0.4)
    for _ in range(60):
        campaign.run()
        if any(caught in word for word in campaign.wrong):
            return
    pytest.fail(f"not caught: {campaign.wrong}")


def test_the_guard_names_board_and_cause_of_a_servo_that_lost_power_within_one_turn() -> None:
    """Oracle: the injected fault. Its count does not jump, so only its cable reports it."""
    rig = Boards(np.random.default_rng(1), "dynamixel")
    rig.pull([0.03] * rig.count)
    rig.begin()
    goal = np.full(rig.count, 0.015)
    rig.go(goal, 1.0, speed=0.06)
    rig.chains[1].servos[0].begin_anew()
    with pytest.raises(HydrostatError, match=r"the motor of winch \d \(board 2\) lost power and restarted"):
        rig.go(goal, 3.0, speed=0.06)


def test_a_line_damaged_before_arming_is_no_fault_after_it() -> None:
    """Oracle: the emulated board. It refuses the damaged line, then arms; later refusals are still reported."""
    board = EmulatedBoard([BoardMotor(low=-200, high=4000)])
    bus = FirmwareBus(board, [COUNTS], clock=board.clock, wait=board.wait)
    bus.identify()
    board.write(b"7 G 12 ")
    bus.arm(np.array([0.1]))
    assert bus.read().faults == ("",)
    bus.write(np.array([1e3]), np.array([1.0]))
    board.wait(0.01)
    assert bus.read().faults == ("refused: limit",)


def test_the_emulated_board_answers_as_the_firmware_does() -> None:
    real = Board()
    emulated = EmulatedBoard([BoardMotor(low=-200, high=4000) for _ in range(2)])

    def answer(line: bytes) -> str:
        emulated.write(line)
        emulated.wait(0.015)
        return emulated.read(999).decode().rpartition("*")[0].partition(" ")[2]

    lines = ["3 I", "4 R", "5 G 1 1 1 1", "6 A 100 9999", "7 A 100 100", "8 R", "9 G 0 1 9999 1", "9 R", "1 G 0 1 0 1"]
    lines += ["10 G 0 9 0 9", "2 S", "11 S", "12 M", "13 I", "14 X", "15 O", "16 R", "17 A 100 100", "x R", "18"]
    for text in lines:
        assert answer(line_of(text)) == real.ask_bytes(line_of(text)), text
    assert answer(b"19 R*0000\n") == real.ask_bytes(b"19 R*0000\n")
    real.run(0.4)
    emulated.wait(0.4)
    assert answer(line_of("20 R")) == real.ask_bytes(line_of("20 R")) == "ok silent 0 0 0 0 0"
