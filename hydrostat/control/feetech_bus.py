"""`FeetechBus`: serial servos of Feetech's STS series (STS3215).

Source: Feetech's own client (ftservo-python-sdk 2.0.1, MIT) for packets and registers from 40 on; its memory table of
the STS3215 for the bounds of torque and of angle. A packet is header FF FF, number, length, instruction or error,
parameters, and the complement of the sum of all after the header. Nothing is stuffed, and the sum has 8 bits only, so
a filler before each packet ends what came damaged before it.

These servos have **no watchdog**: told nothing, they go on to their last goal. A `BusLink` therefore keeps goals so
close ahead that a dead host leaves them standing soon, and bounds of torque stay in the servo.

Their torque by current is not told: gears and windings of several kinds answer with the same number of model (777), so
no guard judges tensions of their cables.
"""

from collections import deque
from collections.abc import Iterable, Sequence
from itertools import accumulate
from math import pi
from typing import Any, ClassVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import MotorFacts, Port, Reading
from hydrostat.control.dynamixel_packets import ALL, READ, SYNC_READ, SYNC_WRITE, WRITE, Packet, PacketReader
from hydrostat.control.servo_bus import ServoBus
from hydrostat.errors import HydrostatError

HEADER = b"\xff\xff"


def pack(number: int, instruction: int, content: bytes = b"") -> bytes:
    """Bytes of a packet; of an answer the instruction is its error."""
    inner = bytes([number, len(content) + 2, instruction]) + content
    return HEADER + inner + bytes([_sum(inner)])


def find_filler(sent: Iterable[bytes]) -> bytes:
    """Return bytes to send before the next packet, so that no earlier one that lost bytes passes its sum.

    A packet that was cut short takes the bytes after it for its own. These complete it with a sum that is wrong,
    wherever it was cut and whichever byte it lost.
    """
    longest = max(map(len, sent), default=0)
    value = next(value for value in range(255) if all(_is_refused(packet, value) for packet in sent))
    return bytes([value]) * max(longest, value + 2)  # to its end, also where the filler is taken for the length


def _is_refused(packet: bytes, value: int) -> bool:
    """Return True if a packet without one byte or its end fails its sum when a repeated value follows it."""
    if value in packet:  # a lost byte, and the value in place of the sum
        return False
    cuts = [(packet[2] + value, value), (2 * value, value)]  # sum and number of missing bytes, cut in the head
    cuts += [(kept, len(packet) - 3 - place) for place, kept in enumerate(accumulate(packet[2:-1]))][1:]
    return all((kept + missing * value) % 256 != 255 for kept, missing in cuts)


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


MODEL, LOW, VOLTS, MODE, TORQUE, RISE, GOAL, BOUND, STATE = 3, 9, 14, 33, 40, 41, 42, 48, 56
"""Registers: model, least and greatest angle, greatest and least supply, mode, torque on, acceleration (then goal, time
and speed), goal, bound of torque, present angle (to current)."""
STATE_BYTES = 15
MODELS = {777: "STS3215", 1289: "STS3020"}
"""By the number of the model."""
TICK = 2 * pi / 4096  # angle of a step [rad]
AMPERE = 6.5e-3  # current of a step [A]
STALL = 2.7
"""Current at stall [A], that of the strongest variant: bounds are shares of the torque at stall."""
SMALL, LARGE, SMALL_LIMIT, LARGE_LEAST, LITHIUM, EMPTY = 7.4, 12.0, 10.0, 9.0, 8.4, 8.0
"""Supplies that STS3215 are sold for, the greatest limit in the memory of those for the smaller, the least supply that
we take for the larger (an empty pack of three lithium cells), two full lithium cells, eight empty NiMH cells [V]."""
MAX_VOLTAGE_12V = 14.0  # greatest supply of a servo for 12 V, whatever its memory allows [V]
FULL_TORQUE = 1000  # bound of torque that bounds nothing
STANDING = 2000  # speed at which they come back to where they shall stand [steps/s]
MAX_POSITION = 30719  # step that a servo without limits of angle may go to
FAULTS = {
    0x01: "supply voltage out of range",
    0x02: "encoder fault",
    0x04: "too hot",
    0x08: "current too large",
    0x20: "overloaded",
}


class FeetechBus(ServoBus):
    """Feetech servos in position mode, with a torque limit."""

    kind: ClassVar[str] = "feetech"
    packets = SumReader
    tick: ClassVar[float] = TICK

    def __init__(self, port: Port, numbers: Sequence[int], **rest: Any) -> None:
        """Servos on a port, by their numbers; the rest is as a `ServoBus` has it."""
        super().__init__(port, numbers, **rest)
        self._sent = deque[bytes](maxlen=3)  # packets of which one may still wait for its end in a servo
        self._low, self._high = np.zeros(len(self._numbers)), np.zeros(len(self._numbers))  # steps they may go to

    def identify(self) -> tuple[MotorFacts, ...]:
        """Read the data of the servos; they have no watchdog, and their permanent memory is not written."""
        with self._lock:
            facts = tuple(self._fact(index, number) for index, number in enumerate(self._numbers))
            self._check_supply()
            self._known, self._holding = True, False
            return facts

    def arm(self, currents: Vector) -> None:
        """Switch torque on at present positions; a current limit becomes a share of the stall torque."""
        with self._lock:
            for number, most in zip(self._numbers, currents.tolist(), strict=True):
                share = max(1, round(FULL_TORQUE * min(most / STALL, 1.0)))
                self._set(number, BOUND, share.to_bytes(2, "little"), "its bound of torque")
            self._switch_on()

    def _switch_on(self) -> None:
        """Switch torque on where they stand."""
        self._stand(all_heard=True)
        for number in self._numbers:
            self._set(number, TORQUE, b"\x01", "its torque switch")
        self._holding = True

    def _ask_state(self) -> Reading:
        last = {name: getattr(self._last, name).copy() for name in ("angles", "currents", "temperatures", "volts")}
        stamps, faults = self._last.stamps.copy(), list(self._last.faults)
        self._send(ALL, SYNC_READ, bytes([STATE, STATE_BYTES, *self._numbers]))
        for packet in self._answers(len(self._numbers), STATE_BYTES):
            index, told = self._numbers.index(packet.number), packet.content
            last["angles"][index] = TICK * _to_signed(told[0:2], 15)
            last["currents"][index] = AMPERE * _to_signed(told[13:15], 15)
            last["volts"][index], last["temperatures"][index] = 0.1 * told[6], told[7]
            stamps[index] = self._clock()
            faults[index] = ", ".join(word for bit, word in FAULTS.items() if packet.instruction & bit)
        return Reading(**last, stamps=stamps, faults=tuple(faults))

    def write(self, angles: Vector, speeds: Vector) -> None:
        """Send goals and speeds to all servos at once, without answers."""
        steps = np.rint(angles / self.tick)
        if beyond := np.flatnonzero((steps < self._low) | (steps > self._high)).tolist():
            raise self._tell_beyond(beyond[0], float(steps[beyond[0]]))
        rates = np.clip(np.rint(np.abs(speeds) / self.tick), 1, 32767).astype(int).tolist()
        with self._lock:
            self._goals, self._speeds = angles.copy(), np.abs(speeds)
            self._go(steps.astype(int).tolist(), rates, self._numbers)

    def restart(self, place: int) -> None:
        """Switch its torque off, which clears an overload fault (not yet tested on a servo); it keeps its count."""
        with self._lock:
            self._set(self._numbers[place], TORQUE, b"\x00", "its torque switch")

    def _has_torque(self, number: int) -> bool | None:
        told = self._get(number, TORQUE, 1)
        return None if told is None else told == b"\x01"

    def _hold(self, angles: dict[int, float]) -> None:
        steps = [round(angle / self.tick) for angle in angles.values()]
        self._go(steps, [STANDING] * len(steps), tuple(angles))

    def _go(self, steps: Sequence[int], rates: Sequence[int], numbers: Sequence[int]) -> None:
        content = bytes([RISE, 7])
        for number, step, rate in zip(numbers, steps, rates, strict=True):  # 0: no bound of acceleration, to stop soon
            content += bytes([number, 0, *_magnitude(step), 0, 0, *rate.to_bytes(2, "little")])
        with self._lock:
            self._send(ALL, SYNC_WRITE, content)

    def _tell_beyond(self, index: int, step: float) -> HydrostatError:
        """Error on a motor that is asked to go beyond its limits of angle."""
        return HydrostatError(
            f"motor {self._numbers[index]} turns from step {self._low[index]:.0f} to {self._high[index]:.0f} and "
            f"was asked for {step:.0f}; set both its limits of angle to 0, so that it counts its turns"
        )

    def _fact(self, index: int, number: int) -> MotorFacts:
        """Who a servo is, its torque off, and the angles that it may go to."""
        told = self._get(number, 0, 13)
        if told is None:
            raise self._silent(number)
        model = int.from_bytes(told[MODEL : MODEL + 2], "little")
        if model not in MODELS:
            raise HydrostatError(f"motor {number} is a servo of number {model}; known are {', '.join(MODELS.values())}")
        mode = self._get(number, MODE, 1)
        if mode != b"\x00":
            raise HydrostatError(f"motor {number} is not in position mode; set its register {MODE} to 0")
        self._set(number, TORQUE, b"\x00", "its torque switch")
        low, high = _to_signed(told[LOW : LOW + 2], 15), _to_signed(told[LOW + 2 : LOW + 4], 15)
        self._low[index], self._high[index] = (low, high) if low < high else (-MAX_POSITION, MAX_POSITION)
        return MotorFacts(number=number, model=MODELS[model], firmware=100 * told[0] + told[1], watchdog=False)

    def _check_supply(self) -> None:
        """Refuse servos on a supply that is not theirs, and servos of two supplies on one bus (HydrostatError).

        Variants for 7.4 V and 12 V look alike and answer with one model number. They differ in the greatest supply
        that their memory allows: 8.0 V (python-st3215, issue 1) and 14.0 V (ROAR-QUTRC's table of registers).
        """
        found = dict[int, tuple[float, float, float]]()
        for number in self._numbers:
            told, state = self._get(number, VOLTS, 2), self._get(number, STATE + 6, 1)
            if told is None or state is None:
                raise self._silent(number)
            least, most, volts = found[number] = (0.1 * told[1], 0.1 * told[0], 0.1 * state[0])
            if least >= most:
                raise HydrostatError(
                    f"motor {number} allows supplies from {least:.1f} V up to {most:.1f} V, which is reversed. Set its "
                    f"registers {VOLTS} (greatest) and {VOLTS + 1} (least) by its label, in 0.1 V."
                )
            if volts > min(most, LITHIUM if _read_rating(most) == SMALL else MAX_VOLTAGE_12V):
                raise _tell_supply(number, *found[number])
        kinds = {_read_rating(most): number for number, (_, most, _) in found.items()}
        if len(kinds) > 1:
            raise HydrostatError(
                f"motor {kinds[SMALL]} is a servo for {SMALL:g} V, motor {kinds[LARGE]} one for {LARGE:g} V. Use "
                "servos of one voltage on a bus: read their labels."
            )
        for number, (least, most, volts) in found.items():
            if volts < max(least, LARGE_LEAST if _read_rating(most) == LARGE else 0.0):
                raise _tell_supply(number, least, most, volts)

    def _set(self, number: int, place: int, value: bytes, name: str) -> None:
        """Write a register, and read that it was taken: an answer does not tell which question it is to."""
        for _ in range(5):
            self._send(number, WRITE, bytes([place]) + value)
            self._answers(1, 0)
            if self._get(number, place, len(value)) == value:
                return
        raise HydrostatError(f"motor {number} did not take {name}; look at its power and cable")

    def _get(self, number: int, place: int, size: int) -> bytes | None:
        for _ in range(3):
            self._send(number, READ, bytes([place, size]))
            for packet in self._answers(1, size):
                if packet.number == number:
                    return packet.content
        return None

    def _send(self, number: int, instruction: int, content: bytes = b"") -> None:
        packet = pack(number, instruction, content)
        self._send_packet(find_filler(self._sent) + packet)
        self._sent.append(packet)

    def _answers(self, count: int, size: int) -> list[Packet]:
        """Answers of such a size from servos that are ours."""
        return self._receive(count, lambda packet: packet.number in self._numbers and len(packet.content) == size)


def _read_rating(most: float) -> float:
    """Supply that a servo is sold for, by the greatest that its memory allows [V]."""
    return SMALL if most <= SMALL_LIMIT else LARGE


def _tell_supply(number: int, least: float, most: float, volts: float) -> HydrostatError:
    """Error on a servo that measures another supply than its own, with what to connect [V]."""
    rated, advice = _read_rating(most), ""
    if rated == SMALL and most < volts <= LITHIUM + 0.2:
        advice = f" Two full lithium cells give {LITHIUM:g} V: put a regulator behind them."
    elif rated == LARGE and volts <= SMALL_LIMIT:
        charge = " Charge a battery of eight NiMH cells." if volts >= EMPTY else ""
        advice = f"{charge} If its label says {SMALL:g} V, set its register {VOLTS} to 80 instead."
    return HydrostatError(
        f"motor {number} is a servo for {rated:g} V (its memory allows {least:.1f} to {most:.1f} V) and measures "
        f"{volts:.1f} V. Switch the power off, then connect a supply of {rated:g} V.{advice}"
    )


def _to_signed(data: bytes, bit: int) -> int:
    """A number with its sign in a bit of its own."""
    value = int.from_bytes(data, "little")
    return -(value & ~(1 << bit)) if value >> bit & 1 else value


def _magnitude(value: int) -> bytes:
    """A number with its sign in bit 15."""
    return (abs(value) | (0x8000 if value < 0 else 0)).to_bytes(2, "little")
