"""`make_lists`: what to cut, to stitch and to buy, and whether motors and lines are strong enough."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

from hydrostat.fabrication.inserts import Insert, InsertKind, insert_title
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.bill import BillGroup, BillRow, Item, bill_table, cost_of
from hydrostat.fabrication.lists.cuts import (
    CableRow,
    SheathRow,
    cable_cuts,
    cable_table,
    check_lengths,
    check_sheaths,
    sheath_cuts,
    sheath_table,
)
from hydrostat.fabrication.lists.line import LineRow, check_line, line_for
from hydrostat.fabrication.lists.motors import (
    MotorRow,
    PowerPlan,
    motor_table,
    motor_warnings,
    power_plan,
    size_winches,
)
from hydrostat.fabrication.lists.needs import all_needs
from hydrostat.fabrication.lists.stitching import (
    Stitching,
    close_warnings,
    deep_warnings,
    depth_table,
    plane_table,
    stitch_table,
)
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.simulation import Simulation

_MOULD_COST = "For hands of foam Chang (2018) gives about 100 USD for a silicone mold and a few dollars for each core"


@dataclass(frozen=True, kw_only=True)
class Lists:
    """The lists of a robot."""

    bill: Table[BillRow]  # bill of materials
    cables: Table[CableRow]  # to cut
    tubes: Table[SheathRow]  # to cut
    stitching: Stitching | None  # stitching of the cables; None if it is unknown
    strength: Table[LineRow]  # strength of the line
    motors: Table[MotorRow]  # and what the winches ask of them
    power: PowerPlan | None  # power supply of the motors; None without motors
    inserts: "Table[InsertRow] | None" = None  # parts and rods in the body; None without any
    problems: tuple[str, ...] = ()  # why the robot cannot be built well
    warnings: tuple[str, ...] = ()  # warnings for the builder
    checks: tuple[Check, ...] = ()  # comparisons of the lists with the simulation

    @property
    def tables(self) -> tuple[Table, ...]:
        """All of them, in the order in which they are used."""
        found = (self.bill, self.cables, self.tubes, self.stitching, self.inserts, self.strength, self.motors)
        return (*(table for table in found if table is not None), *([self.power.table] if self.power else []))

    @property
    def notes_text(self) -> str:
        """Notes on the lists, each under the name of its file."""
        found = [
            "\n".join([f"{table.name}.csv: {table.title}", *(f"- {note}" for note in table.notes)])
            for table in self.tables
            if table.notes
        ]
        return "\n\n".join(found) + "\n"

    @property
    def cost(self) -> tuple[float, float]:
        """Cost of all that is used up, and of all that is bought in whole packs [USD]."""
        total = self.bill.rows[-1]
        return float(total.cost_used), float(total.cost_packs)


def make_lists(plan: KitPlan) -> Lists:
    """All lists of a robot (InputError: a demand of another robot, or lengths for cables that it does not have)."""
    robot, options, demand, rigid = plan.robot, plan.options.parts, plan.demand, plan.rigid
    cuts = cable_cuts(
        robot,
        leads=rigid.leads,
        outside=rigid.outside,
        spare_wraps=options.spare_wraps,
        tail=rigid.stopper.tail if rigid.stopper else 0.0,
        coupled=options.swap,
    )
    pieces = sheath_cuts(robot, seats=rigid.seats, outside=rigid.tubes)
    cables, tubes = cable_table(cuts), sheath_table(robot, pieces, bore=options.bore, tube=options.tube)
    strength = check_line(robot, demand.tensions, line_for(options.cable), hold=rigid.stopper_hold)
    sizings = size_winches(robot, demand, rigid.motor)
    torques = {each.winch: each.torque for each in sizings if each.cables}
    power = power_plan(torques, rigid.motor, plan.options.board)
    items = tuple(all_needs(plan, strength.line, cuts, pieces, power))
    stitching, minded = _sewing(plan)
    simulation = Simulation(robot)
    return Lists(
        bill=bill_table(items, _bill_notes(plan, items)),
        cables=cables,
        tubes=tubes,
        stitching=stitching,
        strength=strength.table,
        motors=motor_table(sizings, demand, rigid.motor),
        power=power,
        inserts=insert_table(plan.inserts, insert_title(plan.inserts)) if plan.inserts else None,
        problems=strength.problems,
        warnings=(
            *(f"pose not solved, its loads are missing from the lists: {missed}" for missed in demand.missed),
            *strength.warnings,
            *motor_warnings(sizings),
            *minded,
        ),
        checks=(check_lengths(cables, simulation), check_sheaths(tubes, simulation, outside=rigid.tubes)),
    )


def _bill_notes(plan: KitPlan, items: tuple[Item, ...]) -> tuple[str, ...]:
    """Cost of a mold against that of the bodies that come out of it (N2)."""
    if plan.work.foam is None:
        return ()
    core, mould = sum(item.cost for item in items if item.is_poured), cost_of(items, BillGroup.MOULD)
    return (f"The mold costs about {mould:.0f} USD, each core of foam {core:.2f} USD. {_MOULD_COST}.",)


def _sewing(plan: KitPlan) -> tuple[Stitching | None, tuple[str, ...]]:
    """Table of where the cables are sewn, if it is known, and warnings about it."""
    if plan.work.stitches:
        return stitch_table(plan.work.stitches), ()
    if plan.robot.body.mesh.dim == 3:
        table = depth_table(plan.robot)
        return table, (*deep_warnings(table), *close_warnings(plan.robot))
    if plan.method is Method.FOAM and plan.robot.cables:
        return plane_table(plan.robot), close_warnings(plan.robot)
    return None, ()


@dataclass(frozen=True, kw_only=True)
class InsertRow:
    """Part or rod in the body."""

    mark: Annotated[str, text_column("mark")]
    name: Annotated[str, text_column("name")]
    kind: Annotated[str, text_column("kind")]
    material: Annotated[str, text_column("material")]
    size: Annotated[str, text_column("size")]
    where: Annotated[str, text_column("place")]
    length: Annotated[float | None, number_column("length", "mm")]
    diameter: Annotated[float | None, number_column("diameter", "mm", decimals=2)]
    volume: Annotated[float | None, number_column("volume", "cm^3", decimals=2)]
    mass: Annotated[float | None, number_column("mass", "g")]
    step: Annotated[str, text_column("step")]


def insert_table(inserts: Iterable[Insert], step: str) -> Table[InsertRow]:
    """Table of parts and rods, all of which one step puts in, and of sheets."""
    rows = [
        InsertRow(
            mark=insert.mark,
            name=insert.name,
            kind=insert.kind,
            material=insert.material,
            size=insert.size,
            where=insert.where,
            length=insert.length,
            diameter=insert.diameter,
            volume=None if insert.volume is None else 1e-3 * insert.volume,
            mass=insert.mass,
            step=f"Fix sheet {insert.mark}" if insert.kind is InsertKind.SHEET else step,
        )
        for insert in inserts
    ]
    return Table(
        name="inserts",
        title="Parts, rods and sheets",
        row=InsertRow,
        rows=tuple(rows),
        notes=(
            "Sizes are as drawn, volumes and masses those of the simulated mesh.",
            "The kit has files for sheets of flat bodies alone: print, cut or cast the rest.",
        ),
    )
