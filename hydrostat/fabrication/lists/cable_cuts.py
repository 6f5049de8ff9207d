"""`CableCut`: how long each cable is cut, and about where it meets its spool."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.fabrication.lists.table import Align, Column, Table
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

KNOT = 120.0
"""Line for the knot at the spool [mm]: a doubled Palomar takes about this much in two hands. Assumed; trimmed after."""

TAIL = 80.0
"""Line beyond the stopper [mm]: to hold while the stopper is set, and to let out when it is adjusted (R13). Assumed."""

STEP = 10.0
"""Cables are cut to full steps of this [mm]: a tape on a table is no more precise, and the rest goes to the knot."""

ALLOWED = 0.1
"""Lengths agree with the simulation within this [mm]."""


@dataclass(frozen=True, kw_only=True)
class CableCut:
    """One cable, all in millimetres.

    Attributes:
        number: of the cable, from 1.
        winch: its name.
        body: rest length from the place of the winch to the stopper, sheaths included.
        slack: taken in before it is taut.
        outside: tube from motors outside to where the cable begins.
        lead: from the winch's exit to the spool.
        wraps: line that stays on the spool when all is let out.
        release: line on the spool that can be let out beyond the rest length.
        knot: for the knot at the spool.
        tail: beyond the stopper.
    """

    number: int
    winch: str
    body: float
    slack: float
    outside: float
    lead: float
    wraps: float
    release: float
    knot: float = KNOT
    tail: float = TAIL

    @property
    def length(self) -> float:
        """All of it."""
        parts = (self.body, self.slack, self.outside, self.lead, self.wraps, self.release, self.knot, self.tail)
        return sum(parts)

    @property
    def cut(self) -> float:
        """The length to cut it to: the next full step."""
        return STEP * math.ceil(self.length / STEP - 1e-9)

    @property
    def spool_mark(self) -> float:
        """About where the cable meets the spool at rest, from the end with the stopper.

        In the body it is counted from the shaft, round which the spool is; outside from the housing of the winch.
        """
        before = self.outside + self.lead if self.outside > 0 else 0.0
        return self.tail + self.slack + self.body + before


def cable_cuts(
    robot: Robot, *, leads: Mapping[int, float], outside: Mapping[int, float], spare_wraps: float
) -> tuple[CableCut, ...]:
    """How long each cable of a robot is cut.

    Args:
        robot: whose cables.
        leads: line from the winch's exit to its spool, by cable index [mm]; none if left out.
        outside: tube from the base with the motors to where the cable begins, by cable index [mm].
        spare_wraps: turns that stay on each spool.
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
                lead=float(leads.get(index, 0.0)),
                wraps=1e3 * spare_wraps * 2 * math.pi * radius,
                release=1e3 * float(ratio) * winch.release,
            )
        )
    return tuple(cuts)


def cable_table(cuts: tuple[CableCut, ...]) -> Table:
    """The cut list."""
    lengths = ("body", "slack", "outside", "lead", "wraps", "release", "knot", "tail", "total", "cut to")
    whole = ("cut to", "spool mark from end")
    return Table(
        name="cable_cuts",
        title="Cables to cut",
        columns=(
            Column(title="cable", align=Align.LEFT),
            Column(title="winch", align=Align.LEFT),
            *(Column(title=title, unit="mm", decimals=int(title not in whole)) for title in (*lengths, whole[1])),
        ),
        rows=tuple(
            (
                f"C{cut.number}",
                cut.winch,
                *(cut.body, cut.slack, cut.outside, cut.lead, cut.wraps, cut.release, cut.knot, cut.tail),
                *(cut.length, cut.cut, cut.spool_mark),
            )
            for cut in cuts
        ),
        notes=(
            "Body is the rest length from the place of the winch to the stopper as it was simulated, sheaths included; "
            "what is cut more than the total goes to the knot.",
            "Spool mark: about where the line meets the spool at rest, within a centimetre or so. Mark it with a pen "
            "before the line goes in, from the end that gets the stopper.",
            "The stopper is set on the robot: winch at zero, line pulled straight but not hard, stopper against the "
            "cloth or skin at the last hole. Where the list has a slack, it goes so far beyond the last hole.",
        ),
    )


def check_lengths(table: Table, simulation: Simulation) -> Check:
    """Whether the lengths of the list are those that were simulated."""
    robot = simulation.robot
    sheathed = [float(cable.segments[~cable.bare].sum()) for cable in robot.cables]
    simulated = 1e3 * (simulation.cables.rest_lengths + np.array(sheathed))
    place = table.headings.index("body [mm]")
    listed = np.array([float(texts[place]) for texts in table.texts])
    gap = float(np.abs(listed - simulated).max(initial=0.0))
    return Check(
        what="lengths in the cable cut list are the rest lengths of the simulation",
        measured=f"at most {gap:.3f} mm off, {len(listed)} cables",
        allowed=f"{ALLOWED:g} mm",
        passed=gap <= ALLOWED,
    )
