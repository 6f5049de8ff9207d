"""`ScsBus`: serial servos of Feetech's SCS series (SCS0009), which turn by 300 degrees.

Source: LeRobot's table of registers (huggingface/lerobot, motors/feetech/tables.py), which names Feetech's manual of
the SCSCL series: model 1284, words with the high byte first, 1024 steps, no register of current, no common reading.
A potentiometer gives the angle, so no count is lost with the power. Sign of the load in bit 10, and that the lock of
the lasting memory keeps a bound of torque from being kept: from memory of that manual. Tried on no servo.
"""

from collections.abc import Sequence
from math import pi
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import MotorFacts, Reading
from hydrostat.control.dynamixel_packets import ALL, READ, SYNC_WRITE
from hydrostat.control.feetech_bus import FAULTS, FULL_TORQUE, GOAL, TORQUE, VOLTS, FeetechBus
from hydrostat.errors import HydrostatError

MODEL, LOW, BOUND, LOCK, STATE, STATE_BYTES = 3, 9, 16, 48, 56, 8
"""Registers: model, least and greatest angle, bound of torque, lock, present angle (speed, load, supply, heat)."""
NUMBER = 1284  # of the model
SCS_STEPS = 1024  # of its 300 degrees
SCS_TICK = 300.0 / SCS_STEPS * pi / 180  # angle of a step [rad]
KIT_STEP = 34  # from its end, where kits let mount the spool with all cable paid out
SCS_STALL = 1.0  # current at stall [A], of Waveshare's SC09: load is reported as a share, torque limited by one


class ScsBus(FeetechBus):
    """SCS servos in position mode within their 300 degrees, with a torque limit; they report load, not current."""

    kind: ClassVar[str] = "scs"
    tick: ClassVar[float] = SCS_TICK

    def arm(self, currents: Vector) -> None:
        """Switch torque on at present positions; a current limit becomes a share of the stall torque."""
        with self._lock:
            for number, most in zip(self._numbers, currents.tolist(), strict=True):
                self._set(number, LOCK, b"\x01", "its lock")
                share = max(1, round(FULL_TORQUE * min(most / SCS_STALL, 1.0)))
                self._set(number, BOUND, share.to_bytes(2, "big"), "its bound of torque")
            self._switch_on()

    def _ask_state(self) -> Reading:
        last = {name: getattr(self._last, name).copy() for name in ("angles", "currents", "temperatures", "volts")}
        stamps, faults = self._last.stamps.copy(), list(self._last.faults)
        for index, number in enumerate(self._numbers):
            self._send(number, READ, bytes([STATE, STATE_BYTES]))
            for packet in self._answers(1, STATE_BYTES):
                if packet.number != number:
                    continue
                told, load = packet.content, int.from_bytes(packet.content[4:6], "big")
                last["angles"][index] = SCS_TICK * int.from_bytes(told[0:2], "big")
                last["currents"][index] = SCS_STALL * (load & 0x3FF) / FULL_TORQUE * (-1 if load >> 10 & 1 else 1)
                last["volts"][index], last["temperatures"][index] = 0.1 * told[6], told[7]
                stamps[index] = self._clock()
                faults[index] = ", ".join(word for bit, word in FAULTS.items() if packet.instruction & bit)
        return Reading(**last, stamps=stamps, faults=tuple(faults))

    def _go(self, steps: Sequence[int], rates: Sequence[int], numbers: Sequence[int]) -> None:
        content = bytes([GOAL, 6])
        for number, step, rate in zip(numbers, np.clip(steps, 0, 1023).tolist(), rates, strict=True):
            content += bytes([number, *step.to_bytes(2, "big"), 0, 0, *min(rate, 1023).to_bytes(2, "big")])
        with self._lock:
            self._send(ALL, SYNC_WRITE, content)

    def _fact(self, index: int, number: int) -> MotorFacts:
        """Who a servo is, its torque off, and the angles that it may go to."""
        told = self._get(number, 0, 13)
        if told is None:
            raise self._silent(number)
        model, low, high = (int.from_bytes(told[place : place + 2], "big") for place in (MODEL, LOW, LOW + 2))
        if model != NUMBER:
            raise HydrostatError(f"motor {number} is a servo of number {model}; known is SCS0009 ({NUMBER})")
        if not low < high:
            raise HydrostatError(
                f"motor {number} turns without end (limits of angle {low} and {high}). Set its registers {LOW} to 0 "
                f"and {LOW + 2} to 1023."
            )
        self._set(number, TORQUE, b"\x00", "its torque switch")
        self._low[index], self._high[index] = low, high
        return MotorFacts(number=number, model="SCS0009", firmware=100 * told[0] + told[1], watchdog=False)

    def _check_supply(self) -> None:
        """Refuse servos on a supply that their memory does not allow (HydrostatError)."""
        for number in self._numbers:
            told, state = self._get(number, VOLTS, 2), self._get(number, STATE + 6, 1)
            if told is None or state is None:
                raise self._silent(number)
            least, most, volts = 0.1 * told[1], 0.1 * told[0], 0.1 * state[0]
            if not least <= volts <= most:
                raise HydrostatError(
                    f"motor {number} measures {volts:.1f} V. Its memory allows {least:.1f} to {most:.1f} V. Switch the "
                    "power off, then connect such a supply."
                )

    def _tell_beyond(self, index: int, step: float) -> HydrostatError:
        return HydrostatError(
            f"motor {self._numbers[index]} turns from step {self._low[index]:.0f} to {self._high[index]:.0f} (300 "
            f"degrees) and was asked for {step:.0f}. Turn its spool on the shaft so that the travel fits, or use a "
            "larger spool."
        )
