"""Packets of Feetech's serial servos: how they are made, and found among bytes that may be damaged.

Source: Feetech's own client (ftservo-python-sdk 2.0.1, MIT): header FF FF, number, length, instruction or error,
parameters, and the complement of the sum of all after the header. Nothing is stuffed, and the sum has 8 bits only.
"""

from hydrostat.control.dynamixel_packets import Packet, PacketReader

HEADER = b"\xff\xff"


def pack(number: int, instruction: int, content: bytes = b"") -> bytes:
    """Bytes of a packet; of an answer the instruction is its error."""
    inner = bytes([number, len(content) + 2, instruction]) + content
    return HEADER + inner + bytes([_sum(inner)])


def pad_bytes(packet: bytes) -> bytes:
    """Return the bytes followed by one that does not occur in them, so that no lost byte goes unnoticed.

    If a byte is lost on the way, the first byte after the packet is taken for its sum, and is right exactly where it
    is the byte that was lost.
    """
    return packet + bytes([next(value for value in range(256) if value not in packet)])


class SumReader(PacketReader):
    """Finds packets in a stream of bytes; what is damaged is left out, and counted.

    The instruction of an answer is its error.
    """

    def _next(self) -> Packet | None:
        while (start := self._kept.find(HEADER)) >= 0:
            self._kept = self._kept[start:]
            if len(self._kept) < 4:
                return None
            number, length = self._kept[2], self._kept[3]
            if number > 0xFE or length < 2:
                self._skip()
            elif len(self._kept) < 4 + length:
                return None
            elif _sum(self._kept[2 : 3 + length]) != self._kept[3 + length]:
                self._skip()
            else:
                packet = Packet(number, self._kept[4], self._kept[5 : 3 + length])
                self._kept = self._kept[4 + length :]
                return packet
        self._kept = self._kept[-1:]
        return None


def _sum(data: bytes) -> int:
    return ~sum(data) & 0xFF
