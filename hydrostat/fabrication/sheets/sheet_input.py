"""`SheetInput`: all that the assembly sheet tells."""

from dataclasses import dataclass

from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import Method, Paper
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.solids.assembly import PartAssembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot


@dataclass(frozen=True, eq=False, kw_only=True)
class SheetInput:
    """What the sheet is made of."""

    robot: Robot  # that is built
    method: Method  # how
    paper: Paper  # of the pages
    lists: Lists  # of what is bought and cut
    motor: str = "geared motor"  # what its motors are, in words
    winch: PartAssembly | None = None  # the unit that is drawn apart; of several, that with the most cables
    base: PartAssembly | None = None  # with the winches that stand outside the body
    seat: PartAssembly | None = None  # of the body, where one is made
    stopper: PartAssembly | None = None  # drawn apart
    printed: tuple[Printed, ...] = ()  # all that comes from the printer
    stitches: tuple[CableStitches, ...] = ()  # of each cable of a plush robot
    gusset: bool = False  # whether strips between front and back make a plush body thick
    mould: Mould | None = None  # of a robot of foam
    checks: tuple[Check, ...] = ()  # of the kit on itself
    problems: tuple[str, ...] = ()  # why the robot cannot be built well, if it is built all the same
    warnings: tuple[str, ...] = ()  # what to mind

    @property
    def panels(self) -> tuple[str, ...]:
        """Panels of a flat plush robot that cables are sewn on, by their names."""
        return tuple(dict.fromkeys(sewn.panel for sewn in self.stitches))

    @property
    def pairs(self) -> int:
        """How many cables have a twin on the other panel; 0 where cables are sewn on one alone."""
        return len(self.robot.cables) // 2 if len(self.panels) > 1 else 0

    @property
    def print_hours(self) -> float:
        """About how long one printer is busy with all parts.

        Assumed: a third of their volume is plastic, the rest the air of the infill, and 15 cm^3 are laid an hour.
        """
        return sum(part.count * part.volume for part in self.printed) / 3 / 15e3
