"""`make_lists`: what to cut, to stitch and to buy, and whether motors and lines are strong enough."""

from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.bill import bill_table, cost_of
from hydrostat.fabrication.lists.cable_cuts import cable_cuts, cable_table, check_lengths
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.fabrication.lists.list_input import ListInput
from hydrostat.fabrication.lists.motor_sizing import motor_table, size_winches
from hydrostat.fabrication.lists.needs import all_needs
from hydrostat.fabrication.lists.sheath_cuts import sheath_cuts, sheath_table
from hydrostat.fabrication.lists.stitching import close_warnings, deep_warnings, depth_table, stitch_table
from hydrostat.fabrication.lists.table import Table
from hydrostat.fabrication.self_check import Check
from hydrostat.simulation import Simulation

_MOULD_COST = "For hands of foam the thesis gives about 100 USD for a silicone mould and a few dollars for each core"


@dataclass(frozen=True, kw_only=True)
class Lists:
    """The lists of a robot.

    Attributes:
        tables: in the order in which they are used.
        problems: why the robot cannot be built well.
        warnings: what a person should mind.
        checks: that the lists are true to the simulation.
    """

    tables: tuple[Table, ...]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]

    def table(self, name: str) -> Table:
        """The table of this name.

        Raises:
            InputError: there is none.
        """
        for table in self.tables:
            if table.name == name:
                return table
        raise InputError(f'there is no list "{name}"; the lists are: {", ".join(table.name for table in self.tables)}')


def make_lists(given: ListInput) -> Lists:
    """All lists of a robot.

    Raises:
        InputError: a demand of another robot, or lengths for cables that it does not have.
    """
    robot, options = given.robot, given.options
    cuts = cable_cuts(robot, leads=given.leads, outside=given.outside, spare_wraps=options.spare_wraps)
    tubes = sheath_cuts(robot, seats=given.seats, outside=given.outside)
    cables = cable_table(cuts)
    line = given.line or line_for(options.cable)
    strength = check_line(robot, given.demand.tensions, line)
    sizings = size_winches(robot, given.demand, given.motor)
    sewing, deep = _sewing(given)
    items = tuple(all_needs(given, line, cuts, tubes))
    notes = ()
    if given.foam is not None:
        core = sum(item.cost for item in items if item.what.startswith("foam"))
        mould = cost_of(items, "mould")
        notes = (f"The mould costs about {mould:.0f} USD, each core of foam {core:.2f} USD. {_MOULD_COST}.",)
    return Lists(
        tables=(
            bill_table(items, notes),
            cables,
            sheath_table(robot, tubes, bore=options.bore, tube=options.tube),
            *sewing,
            strength.table,
            motor_table(sizings, given.demand, given.motor),
        ),
        problems=strength.problems,
        warnings=(*strength.warnings, *(warning for sizing in sizings for warning in sizing.warnings), *deep),
        checks=(check_lengths(cables, Simulation(robot)),),
    )


def _sewing(given: ListInput) -> tuple[tuple[Table, ...], tuple[str, ...]]:
    """Where the cables are sewn, if it is known, and what to mind there."""
    if given.stitches:
        return (stitch_table(given.stitches),), ()
    if given.robot.body.mesh.dim == 3:
        table = depth_table(given.robot)
        return (table,), (*deep_warnings(table), *close_warnings(given.robot))
    return (), ()
