"""`PowerPlan`: the supply, fuse, wire and battery for the motors of a robot."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from hydrostat.fabrication.lists.table import Table, text_column
from hydrostat.fabrication.parts.board import BOARDS, board_for
from hydrostat.fabrication.parts.motor import Motor

SPARE = 1.5
"""A supply gives so many times the current of all motors at their largest torque at once: bodies are stiffer than
assumed, and supplies sag at their limit."""

SUPPLIES = (2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0)  # what is sold [A]
FUSES = (1.0, 2.0, 3.0, 5.0, 7.5, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0)  # blade fuses, ISO 8820-3 [A]
WIRES = ((3.0, 0.5, 20), (7.5, 0.75, 18), (10.0, 1.0, 17), (15.0, 1.5, 16), (25.0, 2.5, 14), (40.0, 6.0, 10))
"""Fuse [A] at most, copper [mm^2], gauge (AWG) at least: short leads in free air. Our own table, thicker than what
single wires are rated at; of no standard."""

PLUG = 3.0
"""What one plug of a chain of servos bears [A]: JST EH, 3 A with wire of AWG 22. Told from memory."""

CELL, CELLS, USED = 1.2, 2.0, 0.8
"""A NiMH cell of size AA: volts, ampere hours, and the share of them that is used."""

RESTING = 1 / 3
"""Share of the largest currents that motors draw on average while a robot is shown. Assumed, measured on none."""


@dataclass(frozen=True, kw_only=True)
class PowerRow:
    """Part of the power supply, or a setting of it."""

    what: Annotated[str, text_column("what")]
    amount: Annotated[str, text_column("how much")]


@dataclass(frozen=True, kw_only=True)
class PowerPlan:
    """What feeds the motors of a robot.

    Attributes:
        motor: of all winches.
        winches: their names, in the order of the motors' numbers.
        largest: current of all motors at their largest torque at once [A].
    """

    motor: Motor
    winches: tuple[str, ...]
    largest: float

    @property
    def servos(self) -> bool:
        """Whether the motors are servos on a bus; else DC motors on boards."""
        return self.motor.horn is not None

    @property
    def supply(self) -> float:
        """Current of the supply [A]: with what is spare, and never below two motors that stall."""
        needed = max(SPARE * self.largest, min(2, len(self.winches)) * self.motor.stall_current)
        return next((size for size in SUPPLIES if size >= needed), SUPPLIES[-1])

    @property
    def fuse(self) -> float:
        """The largest fuse [A] that the supply can still blow."""
        return max(size for size in FUSES if size <= max(0.9 * self.supply, FUSES[0]))

    @property
    def wire(self) -> tuple[float, int]:
        """Copper [mm^2] and gauge (AWG) of the leads from the supply."""
        return next((area, gauge) for most, area, gauge in WIRES if self.fuse <= most)

    @property
    def feeds(self) -> int:
        """In how many places a chain of servos is fed, so that no plug carries more than it bears."""
        return max(1, math.ceil(min(self.fuse, len(self.winches) * self.motor.stall_current) / PLUG))

    @property
    def boards(self) -> tuple[str, ...]:
        """Boards for DC motors."""
        rest, found = len(self.winches), list[str]()
        while rest > 0:
            found.append(board_for(rest))
            rest -= BOARDS[found[-1]].motors
        return tuple(found)

    @property
    def cells(self) -> int:
        """NiMH cells in a row that come nearest to the motors' volts without going beyond."""
        return int(self.motor.volts / CELL + 1e-9)

    @property
    def hours(self) -> float:
        """About how long a set of cells lasts [h]."""
        return USED * CELLS / max(RESTING * self.largest, 1e-9)

    @property
    def table(self) -> Table[PowerRow]:
        """What to buy and set, as a list."""
        area, gauge = self.wire
        rows: list[tuple[str, str]] = [
            ("supply", f"{self.motor.volts:g} V, {self.supply:g} A or more"),
            ("all motors at their largest at once", f"{self.largest:.1f} A"),
            ("fuse, in the plus lead at the supply", f"{self.fuse:g} A"),
            ("leads from the supply", f"{area:g} mm^2 (AWG {gauge}) or thicker"),
            ("switch for the motors, in reach", f"in the plus lead, for {self.fuse:g} A"),
            ("without a wall socket", f"{self.cells} NiMH cells AA in a row, about {self.hours:.1f} h"),
        ]
        if self.servos:
            rows.append(("places to feed the chain at", str(self.feeds)))
        return Table(
            name="power",
            title="Power",
            row=PowerRow,
            rows=tuple(PowerRow(what=what, amount=amount) for what, amount in rows),
            notes=(
                f"Current rises evenly with torque, from {self.motor.free_current:g} A to "
                f"{self.motor.stall_current:g} A at stall. Spare: {SPARE:g} times. Battery: motors draw a third of "
                "their largest on average, which is assumed.",
            ),
        )


def power_plan(torques: Mapping[str, float], motor: Motor) -> PowerPlan | None:
    """What feeds a motor on each winch, by its name and largest torque [N mm]; None where there are none."""
    if not torques:
        return None
    spread = motor.stall_current - motor.free_current
    loads = (motor.free_current + spread * min(1.0, torque / motor.stall_torque) for torque in torques.values())
    return PowerPlan(motor=motor, winches=tuple(torques), largest=sum(loads))
