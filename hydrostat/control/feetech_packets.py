"""Packets of Feetech's serial servos: how they are made, and found among bytes that may be damaged.

Source: Feetech's own client (ftservo-python-sdk 2.0.1, MIT): header FF FF, number, length, instruction or error,
parameters, and the complement of the sum of all after the header. Nothing is stuffed, and the sum has 8 bits only.
"""

from collections.abc import Iterator

from hydrostat.control.dynamixel_packets import Packet

HEADER = b"\xff\xff"


def pack(number: int, instruction: int, content: bytes = b"") -> bytes:
    """Bytes of a packet; of an answer the instruction is its error."""
    inner = bytes([number, len(content) + 2, instruction]) + content
    return HEADER + inner + bytes([_sum(inner)])


def padded(packet: bytes) -> bytes:
    """The same with a byte after it that is nowhere in it, so that no single byte can be lost unseen.

    If a byte is lost on the way, the first byte after the packet is taken for its sum, and is right exactly where it
    is the byte that was lost.
    """
    return packet + bytes([next(value for value in range(256) if value not in packet)])


class SumReader:
    """Finds packets in a stream of bytes; what is damaged is left out, and counted."""

    def __init__(self) -> None:
        self._kept = b""
        self.damaged = 0

    def clear(self) -> None:
        """Forget what has come of a packet that is not whole."""
        self._kept = b""

    def feed(self, data: bytes) -> Iterator[Packet]:
        """Give each whole packet that these bytes complete; its instruction is the error of an answer."""
        self._kept += data
        while (start := self._kept.find(HEADER)) >= 0:
            self._kept = self._kept[start:]
            if len(self._kept) < 4:
                return
            number, length = self._kept[2], self._kept[3]
            if number > 0xFE or length < 2:
                self._skip()
            elif len(self._kept) < 4 + length:
                return
            elif _sum(self._kept[2 : 3 + length]) != self._kept[3 + length]:
                self._skip()
            else:
                packet = Packet(number, self._kept[4], self._kept[5 : 3 + length])
                self._kept = self._kept[4 + length :]
                yield packet
        self._kept = self._kept[-1:]

    def _skip(self) -> None:
        self.damaged += 1
        self._kept = self._kept[1:]


def _sum(data: bytes) -> int:
    return ~sum(data) & 0xFF
