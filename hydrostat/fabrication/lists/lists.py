"""`make_lists`: what to cut, to stitch and to buy, and whether motors and lines are strong enough."""

from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.lists.bill import Item, bill_table, cost_of
from hydrostat.fabrication.lists.cuts import (
    cable_cuts,
    cable_table,
    check_lengths,
    check_sheaths,
    sheath_cuts,
    sheath_table,
)
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.fabrication.lists.list_input import ListInput
from hydrostat.fabrication.lists.motor_sizing import motor_table, motor_warnings, size_winches
from hydrostat.fabrication.lists.needs import all_needs
from hydrostat.fabrication.lists.power import PowerPlan, power_plan
from hydrostat.fabrication.lists.stitching import close_warnings, deep_warnings, depth_table, plane_table, stitch_table
from hydrostat.fabrication.lists.table import Table
from hydrostat.simulation import Simulation

_MOULD_COST = "For hands of foam the thesis gives about 100 USD for a silicone mould and a few dollars for each core"


@dataclass(frozen=True, kw_only=True)
class Lists:
    """The lists of a robot."""

    tables: tuple[Table, ...]  # in the order in which they are used
    problems: tuple[str, ...]  # why the robot cannot be built well
    warnings: tuple[str, ...]  # what a person should mind
    checks: tuple[Check, ...]  # that the lists are true to the simulation
    power: PowerPlan | None = None  # what feeds its motors

    @property
    def cost(self) -> tuple[float, float]:
        """Cost of all that is used up, and of all that is bought in whole packs [USD]."""
        bill = self.table("bill_of_materials")
        used, packs = (bill.column(title)[-1] for title in ("used up", "in whole packs"))
        return float(used or 0.0), float(packs or 0.0)

    def table(self, name: str) -> Table:
        """The table of this name (InputError: there is none)."""
        for table in self.tables:
            if table.name == name:
                return table
        raise InputError(f'unknown list "{name}". Available: {", ".join(table.name for table in self.tables)}.')


def make_lists(given: ListInput) -> Lists:
    """All lists of a robot (InputError: a demand of another robot, or lengths for cables that it does not have)."""
    robot, options, demand = given.robot, given.options, given.demand
    cuts = cable_cuts(robot, leads=given.leads, outside=given.outside, spare_wraps=options.spare_wraps)
    tubes = sheath_cuts(robot, seats=given.seats, outside=given.outside)
    cables, pieces = cable_table(cuts), sheath_table(robot, tubes, bore=options.bore, tube=options.tube)
    strength = check_line(robot, demand.tensions, given.line or line_for(options.cable), hold=given.stopper_hold)
    sizings = size_winches(robot, demand, given.motor)
    power = power_plan({each.winch: each.torque for each in sizings if each.cables}, given.motor)
    items = tuple(all_needs(given, strength.line, cuts, tubes, power))
    sewing, deep = _sewing(given)
    simulation = Simulation(robot)
    return Lists(
        tables=(
            bill_table(items, _bill_notes(given, items)),
            cables,
            pieces,
            *sewing,
            strength.table,
            motor_table(sizings, demand, given.motor),
            *([power.table] if power else []),
        ),
        problems=strength.problems,
        warnings=(
            *(f"not solved, so its loads are in no list: {missed}" for missed in demand.missed),
            *strength.warnings,
            *motor_warnings(sizings),
            *deep,
        ),
        checks=(check_lengths(cables, simulation), check_sheaths(pieces, simulation, outside=given.outside)),
        power=power,
    )


def _bill_notes(given: ListInput, items: tuple[Item, ...]) -> tuple[str, ...]:
    """What a mould costs against what comes out of it (N2)."""
    if given.foam is None:
        return ()
    core = sum(item.cost for item in items if ", part " in item.what)
    return (
        f"The mould costs about {cost_of(items, 'mould'):.0f} USD, each core of foam {core:.2f} USD. {_MOULD_COST}.",
    )


def _sewing(given: ListInput) -> tuple[tuple[Table, ...], tuple[str, ...]]:
    """Tables of where the cables are sewn, if it is known, and what to mind there."""
    if given.stitches:
        return (stitch_table(given.stitches),), ()
    if given.robot.body.mesh.dim == 3:
        table = depth_table(given.robot)
        return (table,), (*deep_warnings(table), *close_warnings(given.robot))
    if given.method is Method.FOAM and given.robot.cables:
        return (plane_table(given.robot),), close_warnings(given.robot)
    return (), ()
