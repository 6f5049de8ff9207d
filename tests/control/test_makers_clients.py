"""Emulated servos against the makers' own clients, over a pseudo-terminal; and our packets against theirs."""

import time
from collections.abc import Callable

import pytest

from hydrostat.control.dynamixel_bus import GOAL, PROFILE, STATE, TORQUE
from hydrostat.control.dynamixel_packets import PacketReader, pack
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_line import EmulatedLine
from hydrostat.control.emulated_servos import Ails, EmulatedChain, EmulatedServo


def answer(wanted: object, ask: Callable[[], object]) -> None:
    """Ask until the answer is the one that is wanted: their clients wait 34 ms by the wall clock, and machines are busy."""
    told = [ask()]
    while told[-1] != wanted and len(told) < 50:
        told.append(ask())
    assert told[-1] == wanted, told


class Captured:
    """A port that keeps what a client of ROBOTIS sends."""

    is_using = False

    def __init__(self) -> None:
        self.sent = b""

    def clearPort(self) -> None:  # noqa: N802 - theirs
        """Forget nothing."""

    def writePort(self, packet: list[int]) -> int:  # noqa: N802 - theirs
        """Keep a packet."""
        self.sent += bytes(packet)
        return len(packet)


@pytest.mark.parametrize(
    "content", [b"", b"\x74\x00\x10\x02\x00\x00", b"\x74\x00\xff\xff\xfd\x00", b"\xff\xff\xfd" * 4]
)
def test_packets_are_those_of_robotis(content: bytes) -> None:
    sdk = pytest.importorskip("dynamixel_sdk")
    port = Captured()
    packet = [0, 0, 0, 0, 7, (len(content) + 3) & 0xFF, 0, 3, *content, 0, 0]
    assert sdk.Protocol2PacketHandler().txPacket(port, packet) == sdk.COMM_SUCCESS
    assert port.sent == pack(7, 3, content)
    assert list(PacketReader().feed(port.sent)) == [(7, 3, content)]


def test_their_client_finds_our_servos_and_turns_them() -> None:
    sdk = pytest.importorskip("dynamixel_sdk")
    servos = [EmulatedServo(1, model=1200), EmulatedServo(2, model=1060, ails=Ails(hot=True))]
    with EmulatedLine(EmulatedChain(servos)) as line:
        port, packets = sdk.PortHandler(line.path), sdk.Protocol2PacketHandler()
        assert port.openPort()
        assert port.setBaudRate(57600)
        answer([(1200, 0), (1060, 0)], lambda: [packets.ping(port, number)[:2] for number in (1, 2)])
        assert packets.ping(port, 3)[1] == sdk.COMM_RX_TIMEOUT
        answer(0x80, lambda: packets.ping(port, 2)[2])  # it reports its heat
        answer((sdk.COMM_SUCCESS, 0), lambda: packets.write1ByteTxRx(port, 1, TORQUE, 1))
        answer((sdk.COMM_SUCCESS, 0), lambda: packets.write2ByteTxRx(port, 1, 102, 1000))
        goals = sdk.GroupSyncWrite(port, packets, GOAL, 4)
        assert goals.addParam(1, [0, 2, 0, 0])
        assert goals.txPacket() == sdk.COMM_SUCCESS
        now = line.chain.now
        while line.chain.now < now + 0.5:
            time.sleep(0.01)
        state = sdk.GroupSyncRead(port, packets, STATE, 21)
        assert state.addParam(1)
        assert state.addParam(2)
        answer(sdk.COMM_SUCCESS, lambda: state.txRxPacket())
        assert state.getData(1, STATE + 6, 4) == 512
        answer((sdk.COMM_SUCCESS, 0), lambda: packets.write4ByteTxRx(port, 1, PROFILE + 4, 100))
        answer((100, sdk.COMM_SUCCESS, 0), lambda: packets.read4ByteTxRx(port, 1, PROFILE + 4))
        port.closePort()


def test_feetechs_client_finds_our_servos_and_turns_them() -> None:
    sdk = pytest.importorskip("scservo_sdk")
    with EmulatedLine(EmulatedFeetechChain([EmulatedSts(1), EmulatedSts(2)])) as line:
        port = sdk.PortHandler(line.path)
        assert port.openPort()
        servos = sdk.sms_sts(port)
        answer((777, sdk.COMM_SUCCESS, 0), lambda: servos.ping(1))
        assert servos.ping(3)[1] == sdk.COMM_RX_TIMEOUT
        answer((sdk.COMM_SUCCESS, 0), lambda: servos.write1ByteTxRx(1, 40, 1))
        answer((sdk.COMM_SUCCESS, 0), lambda: servos.WritePosEx(1, 512, 2000, 0))
        now = line.chain.now
        while line.chain.now < now + 0.5:
            time.sleep(0.01)
        answer(512, lambda: servos.ReadPosSpeed(1)[0])
        group = sdk.GroupSyncRead(servos, 56, 8)
        assert group.addParam(1)
        assert group.addParam(2)
        answer(sdk.COMM_SUCCESS, lambda: group.txRxPacket())
        assert group.getData(1, 56, 2) == 512
        port.closePort()
