"""Packets of Dynamixel's protocol 2.0: how they are made, and found among bytes that may be damaged.

Source: ROBOTIS, DYNAMIXEL Protocol 2.0 (e-Manual): header FF FF FD 00, number, length, instruction, parameters, CRC-16
with the polynomial 8005; FD is doubled where FF FF FD would stand in a packet's middle (byte stuffing).
"""

from collections.abc import Iterator
from typing import NamedTuple

HEADER = b"\xff\xff\xfd\x00"
PING, READ, WRITE, REBOOT, STATUS, SYNC_READ, SYNC_WRITE = 0x01, 0x02, 0x03, 0x08, 0x55, 0x82, 0x83
ALL = 0xFE
"""Number that all motors hear."""


class Packet(NamedTuple):
    """A whole packet.

    Attributes:
        number: motor number.
        instruction: kind of packet; `STATUS` for an answer.
        content: parameters without stuffing; an answer begins with its error.
    """

    number: int
    instruction: int
    content: bytes


def pack(number: int, instruction: int, content: bytes = b"") -> bytes:
    """Bytes of a packet."""
    inner = bytes([instruction]) + content
    stuffed = inner.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    packet = HEADER + bytes([number]) + (len(stuffed) + 2).to_bytes(2, "little") + stuffed
    return packet + crc(packet).to_bytes(2, "little")


class PacketReader:
    """Finds packets in a stream of bytes; what is damaged is left out, and counted."""

    def __init__(self) -> None:
        self._kept = b""
        self.damaged = 0

    def clear(self) -> None:
        """Forget what has come of a packet that is not whole."""
        self._kept = b""

    def feed(self, data: bytes) -> Iterator[Packet]:
        """Give each whole packet that these bytes complete."""
        self._kept += data
        while (packet := self._next()) is not None:
            yield packet

    def _next(self) -> Packet | None:
        while True:
            start = self._kept.find(HEADER)
            if start < 0:
                self._kept = self._kept[-len(HEADER) + 1 :]
                return None
            self._kept = self._kept[start:]
            if len(self._kept) < 7:
                return None
            length = int.from_bytes(self._kept[5:7], "little")
            if not 3 <= length <= _MAX_BYTES:
                self._skip()
                continue
            if len(self._kept) < 7 + length:
                if self._kept.find(HEADER, 1) > 0:  # half a packet, and another begins
                    self._skip()
                    continue
                return None
            whole = self._kept[: 7 + length]
            if crc(whole[:-2]) != int.from_bytes(whole[-2:], "little"):
                self._skip()
                continue
            self._kept = self._kept[len(whole) :]
            inner = whole[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
            return Packet(whole[4], inner[0], inner[1:])

    def _skip(self) -> None:
        self.damaged += 1
        self._kept = self._kept[1:]


def crc(data: bytes) -> int:
    """CRC-16 of bytes, polynomial 8005, from 0."""
    value = 0
    for byte in data:
        value = (value << 8 & 0xFF00) ^ _TABLE[value >> 8 ^ byte]
    return value


def _table() -> tuple[int, ...]:
    values = []
    for index in range(256):
        value = index << 8
        for _ in range(8):
            value = value << 1 ^ (0x8005 if value & 0x8000 else 0)
        values.append(value & 0xFFFF)
    return tuple(values)


_TABLE = _table()
_MAX_BYTES = 1024
"""No packet is longer [bytes]."""
