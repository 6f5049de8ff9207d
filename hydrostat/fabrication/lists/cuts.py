"""`CableCut` and `SheathCut`: how long each cable and each piece of PTFE tube is cut."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.fabrication.patterns.stitches import runs_of
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

KNOT = 120.0
"""Line for the knot at the spool [mm]: a doubled Palomar takes about this much in two hands. Assumed; trimmed after."""

STEP = 10.0
"""Cables are cut to full steps of this [mm]: a tape on a table is no more precise, and the rest goes to the knot."""

ALLOWED = 1.0
"""Lengths agree with the simulation within this [mm]: a ruler and a blade are no more exact. Where a body is meshed,
points on its surface lie a little outside the mesh, and the simulation holds them by the nearest element."""


@dataclass(frozen=True, kw_only=True)
class CableCut:
    """One cable, all in millimeters."""

    number: int  # number of the cable, from 1
    winch: str  # its name
    body: float  # rest length from the place of the winch to the stopper, sheaths included
    slack: float  # taken in before it is taut
    outside: float  # tube from motors outside to where the cable begins
    lead: float  # from the winch's exit to the spool
    wraps: float  # line that stays on the spool when all is let out
    release: float  # line on the spool that can be let out beyond the rest length
    knot: float = KNOT  # for the knot at the spool
    tail: float  # beyond the stopper
    reverse: bool = False  # True if it is wound the other way round

    @property
    def length(self) -> float:
        """All of it."""
        parts = (self.body, self.slack, self.outside, self.lead, self.wraps, self.release, self.knot, self.tail)
        return sum(parts)

    @property
    def cut_length(self) -> float:
        """The length to cut it to: the next full step."""
        return STEP * math.ceil(self.length / STEP - 1e-9)

    @property
    def spool_mark(self) -> float:
        """About where the cable meets the spool at rest, in the body its shaft, from the end with the stopper."""
        before = self.outside + self.lead if self.outside > 0 else 0.0
        return self.tail + self.slack + self.body + before


def cable_cuts(
    robot: Robot,
    *,
    leads: Mapping[int, float],
    outside: Mapping[int, float],
    spare_wraps: float,
    tail: float,
    coupled: bool = False,
) -> tuple[CableCut, ...]:
    """Find how long each cable of a robot is cut.

    `spare_wraps` are turns that stay on each spool, `tail` is beyond the stopper [mm].
    By cable index [mm]: `leads` from the winch's exit to its spool, 0 if left out, and tube `outside` the body, from
    the base with the motors to where the cable begins. Lines in two pieces, `coupled`, have two loops more to knot.
    """
    cuts = []
    for index, (cable, ratio) in enumerate(zip(robot.cables, robot.spool_ratios, strict=True)):
        winch = robot.winch(cable.winch)
        radius = cable.spool_radius or winch.spool_radius
        cuts.append(
            CableCut(
                number=index + 1,
                winch=cable.winch,
                body=1e3 * cable.length,
                slack=1e3 * cable.slack,
                outside=float(outside.get(index, 0.0)),
                knot=3 * KNOT if coupled and index in outside else KNOT,
                lead=float(leads.get(index, 0.0)),
                tail=tail,
                wraps=1e3 * spare_wraps * 2 * math.pi * radius,
                release=1e3 * abs(float(ratio)) * (winch.travel if cable.reverse else winch.release),
                reverse=cable.reverse,
            )
        )
    return tuple(cuts)


@dataclass(frozen=True, kw_only=True)
class CableRow:
    """Line of the cut list of cables; lengths in millimeters."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    body: Annotated[float, number_column("body", "mm")]
    slack: Annotated[float, number_column("slack", "mm")]
    outside: Annotated[float, number_column("outside", "mm")]
    lead: Annotated[float, number_column("lead", "mm")]
    wraps: Annotated[float, number_column("wraps", "mm")]
    release: Annotated[float, number_column("release", "mm")]
    knot: Annotated[float, number_column("knot", "mm")]
    tail: Annotated[float, number_column("tail", "mm")]
    total: Annotated[float, number_column("total", "mm")]
    cut: Annotated[float, number_column("cut to", "mm", decimals=0)]
    spool_mark: Annotated[float, number_column("spool mark from end", "mm", decimals=0)]


def cable_table(cuts: tuple[CableCut, ...]) -> Table[CableRow]:
    """The cut list."""
    return Table(
        name="cable_cuts",
        title="Cables to cut",
        row=CableRow,
        rows=tuple(
            CableRow(
                cable=f"C{cut.number}",
                winch=cut.winch,
                body=cut.body,
                slack=cut.slack,
                outside=cut.outside,
                lead=cut.lead,
                wraps=cut.wraps,
                release=cut.release,
                knot=cut.knot,
                tail=cut.tail,
                total=cut.length,
                cut=cut.cut_length,
                spool_mark=cut.spool_mark,
            )
            for cut in cuts
        ),
        notes=(
            "Body is the rest length from the place of the winch to the stopper as it was simulated, sheaths included; "
            "what is cut more than the total goes to the knot.",
            "Spool mark: about where the line meets the spool at rest, within a centimeter or so. Mark it with a pen "
            "before the line goes in, from the end that gets the stopper.",
            "The stopper is set on the robot: winch at zero, line pulled straight but not hard, stopper against the "
            "cloth or skin at the last hole. Where the list has a slack, it goes so far beyond the last hole.",
            *_reverse_notes(cuts),
        ),
    )


def _reverse_notes(cuts: tuple[CableCut, ...]) -> tuple[str, ...]:
    """Return a note below the table on cables that are wound the other way round, if there are any."""
    names = [f"C{cut.number}" for cut in cuts if cut.reverse]
    if not names:
        return ()
    return (
        f"Reversed: {', '.join(names)}. Wind them on the other way round: they pull when their winch turns back. Their "
        "release is the travel of the winch.",
    )


def check_lengths(table: Table[CableRow], simulation: Simulation) -> Check:
    """Check whether the lengths of the list are those that were simulated."""
    robot = simulation.robot
    sheathed = [float(cable.segments[~cable.bare].sum()) for cable in robot.cables]
    simulated = 1e3 * (simulation.cables.rest_lengths + np.array(sheathed))
    listed = np.array([float(text) for text in table.texts_of("body")])
    gap = float(np.abs(listed - simulated).max(initial=0.0))
    return Check(
        what="lengths in the cable cut list are the rest lengths of the simulation",
        measured=f"at most {gap:.3f} mm off, {len(listed)} cables",
        allowed=f"{ALLOWED:g} mm",
        passed=gap <= ALLOWED,
    )


@dataclass(frozen=True, kw_only=True)
class SheathCut:
    """One piece of tube, in millimeters."""

    cable: int  # number of its cable, from 1
    winch: str  # name of the winch of its cable
    start: int | None  # index of the cable point where it begins; None: at the base with the motors
    end: int  # index of the cable point where it ends
    run: float  # length of the cable in it
    seat: float  # length that is pushed into the housing or holder, at all of its ends

    @property
    def length(self) -> float:
        """To cut it to."""
        return self.run + self.seat


def sheath_cuts(robot: Robot, *, seats: Mapping[int, float], outside: Mapping[int, float]) -> tuple[SheathCut, ...]:
    """The pieces of tube of a robot; stretches that touch are one piece.

    By cable index [mm]: depth of the `seats` of tubes at winches, 0 if left out, and tube `outside`, from the base with
    the motors to where the cable begins; a sheath that begins there goes on from it in one piece.
    """
    cuts = []
    for index, cable in enumerate(robot.cables):
        seat, tube = float(seats.get(index, 0.0)), float(outside.get(index, 0.0))
        runs = [(points[0], points[-1]) for bare, points in runs_of(cable) if not bare]
        if tube > 0 and (not runs or runs[0][0] > 0):
            cuts.append(SheathCut(cable=index + 1, winch=cable.winch, start=None, end=0, run=tube, seat=seat))
        for start, end in runs:
            first = start == 0
            run = 1e3 * float(cable.segments[start:end].sum()) + (tube if first else 0.0)
            cuts.append(
                SheathCut(
                    cable=index + 1,
                    winch=cable.winch,
                    start=None if first and tube > 0 else start,
                    end=end,
                    run=run,
                    seat=seat if first else 0.0,
                )
            )
    return tuple(cuts)


AT_BODY = "where the cable begins"  # end of a tube from the base that does not go on in the body


@dataclass(frozen=True, kw_only=True)
class SheathRow:
    """Line of the cut list of tubes, or its total; lengths in millimeters."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    start: Annotated[str, text_column("from")] = ""
    end: Annotated[str, text_column("to")] = ""
    bore: Annotated[float, number_column("bore", "mm")]
    tube: Annotated[float, number_column("outside", "mm")]
    run: Annotated[float, number_column("run", "mm")]
    seat: Annotated[float, number_column("seat", "mm")]
    length: Annotated[float, number_column("cut to", "mm", decimals=0)]
    number: int | None = None  # number of its cable, from 1; None for the total


def sheath_table(robot: Robot, cuts: tuple[SheathCut, ...], *, bore: float, tube: float) -> Table[SheathRow]:
    """The cut list, with its total in the last row; bore and outer diameter of the tube in mm."""
    rows = [_sheath_row(robot, cut, bore, tube) for cut in cuts]
    if rows:
        run, seat = sum(cut.run for cut in cuts), sum(cut.seat for cut in cuts)
        pieces = f"{len(cuts)} pieces"
        rows.append(SheathRow(cable="total", winch=pieces, bore=bore, tube=tube, run=run, seat=seat, length=run + seat))
    return Table(
        name="sheath_cuts", title="PTFE tube to cut", row=SheathRow, rows=tuple(rows), notes=_sheath_notes(cuts)
    )


def _sheath_row(robot: Robot, cut: SheathCut, bore: float, tube: float) -> SheathRow:
    last = len(robot.cables[cut.cable - 1].points) - 1
    return SheathRow(
        cable=f"C{cut.cable}",
        winch=cut.winch,
        start="base" if cut.start is None else point_name(cut.start, last),
        end=AT_BODY if cut.end == 0 else point_name(cut.end, last),
        bore=bore,
        tube=tube,
        run=cut.run,
        seat=cut.seat,
        length=cut.length,
        number=cut.cable,
    )


def _sheath_notes(cuts: tuple[SheathCut, ...]) -> tuple[str, ...]:
    """Notes below the table: on cutting, and on tubes whose length is no matter of the simulation."""
    if not cuts:
        return ("No cable of this robot runs in a tube.",)
    found = [
        "Cut square with a sharp blade, not with scissors: a squeezed end rubs. The run is measured along straight "
        "stretches between the cable's points, as it was simulated.",
        "A tube keeps its cable's length however it lies: a longer one does no harm but friction.",
    ]
    if any(cut.start is None for cut in cuts):
        found.append("A tube from the base has to reach wherever the body stands in front of it, in gentle bends.")
    # Most that a tube takes from a side of a housing that looks away from it [mm]. Assumed, measured on none
    spare = 20.0
    if any(cut.start == 0 for cut in cuts):
        found.append(
            f"At a winch in the body the run counts from its shaft: cut {spare:g} mm more where it is turned away "
            "from its cable, and trim the tube in place."
        )
    return tuple(found)


def check_sheaths(table: Table[SheathRow], simulation: Simulation, *, outside: Mapping[int, float]) -> Check:
    """Check that the tubes of the list cover the sheathed parts of simulated cables, besides tube `outside` [mm]."""
    robot = simulation.robot
    listed = np.array([-outside.get(index, 0.0) for index in range(len(robot.cables))])
    for row in table.rows:
        if row.number is not None:
            listed[row.number - 1] += row.run
    lengths = np.array([cable.length for cable in robot.cables])
    gap = float(np.abs(listed - 1e3 * (lengths - simulation.cables.rest_lengths)).max(initial=0.0))
    pieces = max(0, len(table.rows) - 1)
    return Check(
        what="tubes in the cut list are the stretches that the simulation holds at their length",
        measured=f"at most {gap:.3f} mm off, {pieces} pieces",
        allowed=f"{ALLOWED:g} mm for each cable",
        passed=gap <= ALLOWED,
    )


def point_name(index: int, last: int) -> str:
    """Name of a point of a cable in the lists, by its index and that of the last; they count from 1 at the winch."""
    return f"{index + 1} (winch)" if index == 0 else f"{index + 1} (stopper)" if index == last else f"{index + 1}"
