"""Dynamixel's protocol 2.0. Oracles: ROBOTIS' own client and its manual's examples."""

import os
import threading
import tty
from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrostat.control import DynamixelBus, EmulatedChain, EmulatedServo
from hydrostat.control.dynamixel_bus import STATE_BYTES, TORQUE, WATCH, WATCHDOG
from hydrostat.control.dynamixel_packets import HEADER, PING, READ, STATUS, Packet, PacketReader, crc, pack
from hydrostat.control.emulated_servos import InjectedFaults
from hydrostat.errors import HydrostatError

sdk = pytest.importorskip("dynamixel_sdk", reason="dynamixel-sdk is not installed")


def test_registers_of_an_emulated_servo_have_1_2_or_4_bytes() -> None:
    servo = EmulatedServo(1)
    for size in (1, 2, 4):
        servo.set(200, -1, size)
        assert servo.get(200, size) == -1
    for size in (0, 3, 8):
        with pytest.raises(ValueError, match=f"a register has 1, 2 or 4 bytes, not {size}"):
            servo.get(200, size)
        with pytest.raises(ValueError, match="a register has 1, 2 or 4 bytes"):
            servo.set(200, 0, size)


def test_packets_are_those_of_the_manual() -> None:
    assert pack(1, PING).hex() == "fffffd0001030001194e"
    assert pack(1, READ, bytes([0x84, 0, 4, 0])).hex() == "fffffd0001070002840004001d15"
    assert crc(bytes.fromhex("fffffd0001070002840004001d15")[:-2]) == 0x151D


@settings(deadline=None)
@given(st.binary(max_size=60), st.integers(0, 252))
def test_what_is_packed_is_found_among_rubbish(content: bytes, number: int) -> None:
    whole = pack(number, STATUS, content + b"\xff\xff\xfd\x00" + content)
    reader = PacketReader()
    found = [packet for data in (b"\xff\xfd", whole[:5], whole[5:], whole) for packet in reader.feed(data)]
    assert found == 2 * [Packet(number, STATUS, content + b"\xff\xff\xfd\x00" + content)]


@settings(deadline=None)
@given(st.integers(0, 400), st.integers(1, 255))
def test_a_flipped_byte_is_never_taken_for_an_answer(place: int, change: int) -> None:
    whole = bytearray(pack(7, STATUS, bytes(range(40))))
    whole[place % len(whole)] ^= change
    assert list(PacketReader().feed(bytes(whole))) == []


@pytest.fixture
def served() -> Iterator[tuple[str, EmulatedChain]]:
    """Emulated servos at the other end of a pseudo-terminal, in real time as far as bytes go."""
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    tty.setraw(ours)
    chain = EmulatedChain([EmulatedServo(1, angle=1.5), EmulatedServo(4, model=1060, angle=-2.0)])
    over = threading.Event()

    def serve() -> None:
        while not over.is_set():
            try:
                data = os.read(ours, 4096)
            except OSError:
                return
            with suppress(OSError):  # the other end is closed
                chain.write(data)
                chain.timeout = None
                os.write(ours, chain.read(4096))

    threading.Thread(target=serve, daemon=True).start()
    yield os.ttyname(theirs), chain
    over.set()
    chain.gone = True
    os.close(theirs)
    os.close(ours)


def test_their_client_works_with_our_servos(served: tuple[str, EmulatedChain], monkeypatch: pytest.MonkeyPatch) -> None:
    """Its timeout is by the clock of the day: far more than its 16 ms, on a busy computer, where an answer comes."""
    monkeypatch.setattr(sdk.port_handler, "LATENCY_TIMER", 60_000)
    name, chain = served
    port, handler = sdk.PortHandler(name), sdk.PacketHandler(2.0)
    assert port.openPort()
    try:
        assert handler.ping(port, 1) == (1200, sdk.COMM_SUCCESS, 0)
        assert handler.ping(port, 4) == (1060, sdk.COMM_SUCCESS, 0)
        with monkeypatch.context() as short:
            short.setattr(sdk.port_handler, "LATENCY_TIMER", 100)
            assert handler.ping(port, 3)[1] == sdk.COMM_RX_TIMEOUT
        assert handler.write1ByteTxRx(port, 1, 64, 1) == (sdk.COMM_SUCCESS, 0)
        assert handler.read4ByteTxRx(port, 1, 132)[0] == round(1.5 / (2 * np.pi / 4096))
        group = sdk.GroupSyncWrite(port, handler, 116, 4)
        assert group.addParam(1, (3000).to_bytes(4, "little"))
        assert group.txPacket() == sdk.COMM_SUCCESS
        assert handler.read4ByteTxRx(port, 1, 116)[0] == 3000
        several = sdk.GroupSyncRead(port, handler, 132, 4)
        assert several.addParam(1)
        assert several.addParam(4)
        assert several.txRxPacket() == sdk.COMM_SUCCESS
        assert several.getData(4, 132, 4) == 2**32 - round(2.0 / (2 * np.pi / 4096))
    finally:
        port.closePort()
    assert chain.servos[0].table[64] == 1


def test_our_client_works_on_a_serial_line(served: tuple[str, EmulatedChain]) -> None:
    serial = pytest.importorskip("serial", reason="pyserial is not installed")
    name, chain = served
    line = serial.Serial(name, 57600, timeout=0.1)
    bus = DynamixelBus(line, [1, 4], wait=chain.wait, answer=2.0)
    facts = bus.identify()
    assert [(fact.number, fact.model) for fact in facts] == [(1, "XL330-M288"), (4, "XL430-W250")]
    bus.arm(np.array([0.3, 0.3]))
    assert bus.read().angles == pytest.approx([servo.angle for servo in chain.servos], abs=2e-3)
    bus.close()
    with pytest.raises(HydrostatError, match="the line to the motors is gone"):
        bus.write(np.zeros(2), np.ones(2))


def test_another_model_is_refused() -> None:
    chain = EmulatedChain([EmulatedServo(1)])
    chain.servos[0].set(0, 350, 2)
    bus = DynamixelBus(chain, [1], clock=chain.clock, wait=chain.wait)
    with pytest.raises(HydrostatError, match="motor 1 is a servo of number 350; known are XL330-M077, XL330-M288"):
        bus.identify()


@pytest.mark.parametrize("model", [1200, 1060])
def test_the_bound_of_the_current_bounds_the_pull(model: int) -> None:
    servo = EmulatedServo(1, model=model, load=lambda angle: 0.05 * max(angle, 0.0))
    chain = EmulatedChain([servo])
    bus = DynamixelBus(chain, [1], clock=chain.clock, wait=chain.wait)
    bus.identify()
    bus.arm(np.array([0.2]))
    for _ in range(200):
        bus.write(np.array([3.0]), np.array([2.0]))
        chain.wait(0.01)
    assert servo.torque == pytest.approx(0.35 * 0.2, rel=0.05)
    assert servo.torque < 1.05 * 0.35 * 0.2


def test_every_watchdog_waits_when_all_are_armed_however_long_that_took() -> None:
    """Arming takes longer than a watchdog waits, as every second answer is lost."""
    servos = [EmulatedServo(number) for number in range(1, 9)]
    chain = EmulatedChain(servos)
    bus = DynamixelBus(chain, range(1, 9), clock=chain.clock, wait=chain.wait)
    bus.identify()
    turns = iter(range(10_000))
    chain.back = lambda data: data if not data or next(turns) % 2 else b""
    begin = chain.now
    bus.arm(np.full(8, 0.3))
    assert chain.now - begin > 0.02 * WATCH
    assert [servo.get(WATCHDOG, 1) for servo in servos] == [WATCH] * 8


def test_an_answer_that_comes_late_is_not_taken_for_another() -> None:
    servo = EmulatedServo(1)
    chain = EmulatedChain([servo])
    bus = DynamixelBus(chain, [1], clock=chain.clock, wait=chain.wait)
    bus.identify()
    late, lasting = b"", servo.take

    def delayed(data: bytes) -> bytes:
        nonlocal late
        data, late = late, data
        return data

    def refuses(place: int, data: bytes) -> int:
        return 0x07 if place == TORQUE and data == b"\x01" else lasting(place, data)

    chain.back = delayed
    servo.take = refuses
    with pytest.raises(HydrostatError, match="motor 1 did not take"):
        bus.arm(np.full(1, 0.3))


def test_watchdogs_are_proved_on_a_slow_line() -> None:
    """Of eight servos, as slow as at 57,600 baud, the third does not stop by itself."""
    servos = [EmulatedServo(number, ails=InjectedFaults(deaf_watchdog=number == 3)) for number in range(1, 9)]
    chain = EmulatedChain(servos)
    bus = DynamixelBus(chain, range(1, 9), clock=chain.clock, wait=chain.wait, answer=0.1)

    def slowly(data: bytes) -> bytes:
        chain.wait(len(data) * 10 / 57_600 + 5e-4)
        return data

    chain.towards = chain.back = slowly
    assert [fact.watchdog for fact in bus.identify()] == [number != 3 for number in range(1, 9)]


def dead_after(packets: int) -> tuple[bool, float, float]:
    """Whether a host lives to the end of identify; how long motors turn after its end [s]; how far they were [rad]."""
    servos = [EmulatedServo(1, angle=1.0, ails=InjectedFaults(deaf_watchdog=True)), EmulatedServo(2, angle=1.0)]
    chain, died, left, farthest, moved = EmulatedChain(servos), False, packets, 1.0, 0.0

    def towards(data: bytes) -> bytes:
        nonlocal left
        left -= 1
        if left < 0:
            raise KeyboardInterrupt
        return data

    def look() -> None:
        nonlocal farthest, moved
        farthest = max(farthest, *(servo.angle for servo in servos))
        moved = chain.now if any(servo.speed for servo in servos) else moved

    chain.towards, chain.watch = towards, look
    try:
        DynamixelBus(chain, [1, 2], clock=chain.clock, wait=chain.wait).identify()
    except KeyboardInterrupt:
        died = True
    end = chain.now
    chain.wait(0.6)
    return not died, moved - end, farthest - 1.0


def test_a_host_that_dies_while_it_tries_watchdogs_leaves_motors_standing() -> None:
    """After any of its packets: all stand 250 ms later, a cable on 8 mm moved by less than 1 mm."""
    lives, packets, farthest = False, 0, 0.0
    while not lives:
        lives, turned, farthest = dead_after(packets)
        assert turned < 0.25, f"dead after {packets} packets"
        assert 8.0 * farthest < 1.0
        packets += 1
    assert packets > 40
    assert farthest > 0.05  # the trial itself was among them


def proved_without(lost: int) -> tuple[list[bool], int]:
    """Watchdogs of a deaf one and one that works, proved or not, where one answer on places is lost; how many came."""
    chain, seen = EmulatedChain([EmulatedServo(1, ails=InjectedFaults(deaf_watchdog=True)), EmulatedServo(2)]), 0

    def back(data: bytes) -> bytes:
        nonlocal seen
        head, *packets = data.split(HEADER)
        kept = [head]
        for packet in packets:
            if len(packet) < STATE_BYTES or seen != lost:
                kept.append(packet)
            seen += len(packet) >= STATE_BYTES
        return HEADER.join(kept)

    chain.back = back
    facts = DynamixelBus(chain, [1, 2], clock=chain.clock, wait=chain.wait).identify()
    return [fact.watchdog for fact in facts], seen


def test_a_lost_answer_makes_no_watchdog_proved_and_none_doubted() -> None:
    """Each answer to a question of where they are is lost in turn: what counts is whose watchdog is deaf."""
    proved, seen = proved_without(-1)
    assert (proved, seen >= 8) == ([False, True], True)
    for lost in range(seen):
        assert proved_without(lost)[0] == [False, True], f"answer {lost} lost"


def test_a_motor_that_its_cable_holds_has_not_proved_its_watchdog() -> None:
    """It stands by itself, told nothing: but it does not go on either when it is told again."""
    servo = EmulatedServo(1, load=lambda angle: 1.0 if angle > 0.03 else 0.0, ails=InjectedFaults(deaf_watchdog=True))
    chain = EmulatedChain([servo])
    assert not DynamixelBus(chain, [1], clock=chain.clock, wait=chain.wait).identify()[0].watchdog
