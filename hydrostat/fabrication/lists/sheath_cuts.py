"""`SheathCut`: how long each piece of PTFE tube is cut."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from hydrostat.fabrication.lists.cable_cuts import ALLOWED
from hydrostat.fabrication.lists.table import Align, Column, Table
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Cable, Robot
from hydrostat.simulation import Simulation

SPARE = 20.0
"""What a tube takes at most from a side of a housing that looks away from it [mm]. Assumed, measured on none."""


@dataclass(frozen=True, kw_only=True)
class SheathCut:
    """One piece of tube, in millimetres.

    Attributes:
        cable: number of its cable, from 1.
        winch: name of the winch of its cable.
        start: index of the cable point where it begins; None: at the base with the motors.
        end: index of the cable point where it ends.
        run: length of the cable in it.
        seat: what is pushed into the housing or holder, at all of its ends.
    """

    cable: int
    winch: str
    start: int | None
    end: int
    run: float
    seat: float

    @property
    def length(self) -> float:
        """To cut it to."""
        return self.run + self.seat


def sheath_cuts(robot: Robot, *, seats: Mapping[int, float], outside: Mapping[int, float]) -> tuple[SheathCut, ...]:
    """The pieces of tube of a robot; stretches that touch are one piece.

    Args:
        robot: whose cables.
        seats: depth of the seat of the tube at its winch, by cable index [mm]; none if left out.
        outside: tube from the base with the motors to where the cable begins, by cable index [mm]; a sheath that begins
            there goes on from it in one piece.
    """
    cuts = []
    for index, cable in enumerate(robot.cables):
        seat, tube = float(seats.get(index, 0.0)), float(outside.get(index, 0.0))
        runs = _runs(cable)
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


def _runs(cable: Cable) -> list[tuple[int, int]]:
    """Stretches of sheathed segments, as indices of their first and last points."""
    runs = []
    for bare, places in groupby(range(len(cable.segments)), key=lambda place: bool(cable.bare[place])):
        covered = list(places)
        if not bare:
            runs.append((covered[0], covered[-1] + 1))
    return runs


def sheath_table(robot: Robot, cuts: tuple[SheathCut, ...], *, bore: float, tube: float) -> Table:
    """The cut list, with its total in the last row.

    Args:
        robot: whose cables.
        cuts: its pieces of tube.
        bore: inner diameter [mm].
        tube: outer diameter [mm].
    """
    rows = [(f"C{cut.cable}", cut.winch, *_ends(robot, cut), bore, tube, cut.run, cut.seat, cut.length) for cut in cuts]
    if rows:
        run, seat = sum(cut.run for cut in cuts), sum(cut.seat for cut in cuts)
        rows.append(("total", f"{len(cuts)} pieces", "", "", bore, tube, run, seat, run + seat))
    return Table(
        name="sheath_cuts",
        title="PTFE tube to cut",
        columns=(
            *(Column(title=title, align=Align.LEFT) for title in ("cable", "winch", "from", "to")),
            *(Column(title=title, unit="mm") for title in ("bore", "outside", "run", "seat", "cut to")),
        ),
        rows=tuple(rows),
        notes=_notes(cuts),
    )


def _notes(cuts: tuple[SheathCut, ...]) -> tuple[str, ...]:
    """What is said below the table: of cutting, and of tubes whose length is no matter of the simulation."""
    if not cuts:
        return ("No cable of this robot runs in a tube.",)
    found = [
        "Cut square with a sharp blade, not with scissors: a squeezed end rubs. The run is measured along straight "
        "stretches between the cable's points, as it was simulated.",
        "A tube keeps its cable's length however it lies: a longer one does no harm but friction.",
    ]
    if any(cut.start is None for cut in cuts):
        found.append("A tube from the base has to reach wherever the body stands in front of it, in gentle bends.")
    if any(cut.start == 0 for cut in cuts):
        found.append(
            f"At a winch in the body the run counts from its shaft: cut {SPARE:g} mm more where it is turned away "
            "from its cable, and trim the tube in place."
        )
    return tuple(found)


def check_sheaths(table: Table, simulation: Simulation, *, outside: Mapping[int, float]) -> Check:
    """Whether the tubes of the list cover what the simulation leaves out of the lengths of the cables.

    Args:
        table: the cut list.
        simulation: of the robot.
        outside: tube from the base with the motors, which no simulation knows, by cable index [mm].
    """
    robot = simulation.robot
    listed = np.array([-outside.get(index, 0.0) for index in range(len(robot.cables))])
    for cable, run in zip(table.column("cable"), table.column("run"), strict=True):
        if cable != "total" and isinstance(run, float):
            listed[int(str(cable).removeprefix("C")) - 1] += run
    lengths = np.array([cable.length for cable in robot.cables])
    gap = float(np.abs(listed - 1e3 * (lengths - simulation.cables.rest_lengths)).max(initial=0.0))
    pieces = max(0, len(table.rows) - 1)
    return Check(
        what="tubes in the cut list are the stretches that the simulation holds at their length",
        measured=f"at most {gap:.3f} mm off, {pieces} pieces",
        allowed=f"{ALLOWED:g} mm for each cable",
        passed=gap <= ALLOWED,
    )


def _ends(robot: Robot, cut: SheathCut) -> tuple[str, str]:
    last = len(robot.cables[cut.cable - 1].points) - 1
    begin = "base" if cut.start is None else point_name(cut.start, last)
    return begin, "where the cable begins" if cut.end == 0 else point_name(cut.end, last)


def point_name(index: int, last: int) -> str:
    """What the lists call a point of a cable, by its index and that of the last one; they count from 1 at the winch."""
    return f"{index + 1} (winch)" if index == 0 else f"{index + 1} (stopper)" if index == last else f"{index + 1}"
