"""Oracles: packets that ROBOTIS' own client sends; Feetech's own client, on emulated servos over a pseudo-terminal."""

import time
from collections.abc import Callable

import pytest

from hydrostat.control.dynamixel_packets import PacketReader, pack
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedLine, EmulatedSts


def answer(wanted: object, ask: Callable[[], object]) -> None:
    """Ask until the answer is the one that is wanted: their client waits 50 ms, and machines are busy."""
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
    packets = sdk.Protocol2PacketHandler()
    # their txPacket of 4.1.0 stuffs a copy, and sends the original; so it is given what they stuffed
    assert packets.txPacket(port, packets.addStuffing(packet)) == sdk.COMM_SUCCESS
    assert port.sent == pack(7, 3, content)
    assert list(PacketReader().feed(port.sent)) == [(7, 3, content)]


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
