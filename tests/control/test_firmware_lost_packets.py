"""Packets to Feetech servos that get lost: the board of an ESP32-S3 repeats them until each servo shows them."""

from collections.abc import Callable
from pathlib import Path

import pytest
from test_firmware_servos import is_torque_on, start, steps_of

from hydrostat.control.dynamixel_packets import ALL, WRITE
from hydrostat.control.feetech_bus import BOUND, FULL_TORQUE, TORQUE, SumReader, pack
from hydrostat.control.scs_bus import BOUND as SCS_BOUND
from hydrostat.control.scs_bus import LOCK

BUSES = ("feetech", "scs")
LOST = 3
"""Packets that are lost in a row."""


def lose(*registers: int) -> Callable[[bytes], bytes]:
    """Drop the first packets to all servos that write each of these registers."""
    left = dict.fromkeys(registers, LOST)
    reader = SumReader()

    def drop(data: bytes) -> bytes:
        kept = b""
        for packet in reader.feed(data):
            at = packet.content[0]
            if packet.number == ALL and left.get(at, 0):
                left[at] -= 1
            else:
                kept += pack(*packet)
        return kept

    return drop


def be_mute(chain: object) -> None:
    """Let servo 2 hear everything and say nothing."""
    chain.back = lambda data: b"" if data[2:3] == b"\x02" else data  # type: ignore[attr-defined]


def spoil_all(chain: object, fault: str, number: int = 0) -> None:
    """Give a fault to one servo, or to all."""
    for servo in chain.servos:  # type: ignore[attr-defined]
        if number in (0, servo.number):
            setattr(servo.ails, fault, True)


STOPS: dict[str, tuple[Callable, str]] = {
    "common supply": (lambda chain: spoil_all(chain, "sags"), "supply 0"),
    "one supply": (lambda chain: spoil_all(chain, "sags", 2), "supply 0"),
    "heat": (lambda chain: spoil_all(chain, "hot", 2), "heat 2"),
    "mute": (be_mute, "unheard 2"),
    "off": (lambda _: None, "off 0"),
}


@pytest.mark.parametrize("bus", BUSES)
@pytest.mark.parametrize(("fault", "told"), STOPS.values(), ids=STOPS)
def test_lost_packets_leave_no_torque_on(bus: str, fault: Callable, told: str, tmp_path: Path) -> None:
    """The first packets that switch torque off are lost; errors or silence of a servo keep none on."""
    board = start(bus, tmp_path)
    assert board.ask("A 400 400") == "ok"
    board.keep(0.2)
    assert is_torque_on(board) == [True, True]
    board.chain.towards = lose(TORQUE)
    fault(board.chain)
    if told == "off 0":
        assert board.ask("O") == "ok"
    assert board.keep(0.6).startswith(f"ok {told} ")
    assert is_torque_on(board) == [False, False]


@pytest.mark.parametrize("bus", BUSES)
@pytest.mark.parametrize("refuses", [False, True], ids=["lost", "not taken"])
def test_torque_waits_for_bounds(bus: str, refuses: bool, tmp_path: Path) -> None:
    """Each servo has its lock before its bound, and its bound before torque; one that takes no bound gets no torque."""
    board = start(bus, tmp_path)
    bound = BOUND if bus == "feetech" else SCS_BOUND
    wrong = list[str]()

    def watch(servo: object) -> None:
        take, table = servo.take, servo.table  # type: ignore[attr-defined]

        def look(at: int, data: bytes) -> int:
            if at == bound and bus == "scs" and not table[LOCK]:
                wrong.append("bound into lasting memory")
            if at == TORQUE and data[0]:
                order = "little" if bus == "feetech" else "big"
                if int.from_bytes(table[bound : bound + 2], order) >= FULL_TORQUE:
                    wrong.append("torque without bound")
            if refuses and at == bound and servo.number == 2:  # type: ignore[attr-defined]
                return 0
            return take(at, data)

        servo.take = look  # type: ignore[attr-defined]

    for servo in board.chain.servos:
        watch(servo)
    board.chain.towards = lose(TORQUE, bound, LOCK, 41, 42)  # goals too
    assert board.ask(f"M {steps_of(bus)}") == "ok"
    assert board.ask("A 400 400") == "ok"
    said = board.keep(0.8)
    assert wrong == []
    assert said.startswith("ok unheard 2 " if refuses else "ok armed 0 ")
    assert is_torque_on(board) == [not refuses] * 2


def test_packets_of_torque_off_go_on(tmp_path: Path) -> None:
    """While torque is off the board says so every 20 ms."""
    board = start("feetech", tmp_path)
    before = board.line.count(off := pack(ALL, WRITE, bytes([TORQUE, 0])))
    board.run(1.0)
    assert board.line.count(off) - before == pytest.approx(50, abs=2)
