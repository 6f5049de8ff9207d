"""`SheetInput`: all that the assembly sheet tells."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hydrostat.fabrication.kit_options import Method, Paper
from hydrostat.fabrication.lists.table import Table
from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.self_check import Check
from hydrostat.fabrication.solids.assembly import PartAssembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot


@dataclass(frozen=True, eq=False, kw_only=True)
class SheetInput:
    """What the sheet is made of.

    Attributes:
        robot: that is built.
        method: how.
        paper: of the pages.
        motor: what its motors are, in words.
        winch: the unit that is drawn apart; of several, that with the most cables.
        base: with the winches that stand outside the body.
        stopper: drawn apart.
        printed: all that comes from the printer.
        tables: lists by name; told are "bill_of_materials", "cable_cuts" and "sheath_cuts", if they are there.
        stitches: of each cable of a plush robot.
        gusset: whether strips between front and back make a plush body thick.
        mould: of a robot of foam.
        checks: of the kit on itself.
        problems: why the robot cannot be built well, if it is built all the same.
        warnings: what to mind.
    """

    robot: Robot
    method: Method
    paper: Paper
    motor: str = "geared motor"
    winch: PartAssembly | None = None
    base: PartAssembly | None = None
    stopper: PartAssembly | None = None
    printed: tuple[Printed, ...] = ()
    tables: Mapping[str, Table] = field(default_factory=dict)
    stitches: tuple[CableStitches, ...] = ()
    gusset: bool = False
    mould: Mould | None = None
    checks: tuple[Check, ...] = ()
    problems: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def print_hours(self) -> float:
        """About how long one printer is busy with all parts.

        Assumed: a third of their volume is plastic, the rest the air of the infill, and 15 cm^3 are laid an hour.
        """
        return sum(part.count * part.volume for part in self.printed) / 3 / 15e3
