"""`FishingLine`: braided fishing lines, and the check that they withstand the cable tensions."""

import math
from dataclasses import dataclass
from typing import Annotated

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.robot import Robot

KNOT = 0.5
"""Share of its strength that a line keeps at a knot. Tests of braided lines ("Braid knots: some clear winners and
losers", Sport Fishing, August 2006): common knots cost up to half and more, a doubled Palomar almost nothing."""

SAFETY = 0.5
"""Share of the strength at the knot that is used: the rest is for wear at pinholes and edges, and because polyethylene
creeps under lasting loads. Assumed; no source."""


STRETCH = 5.0
"""Mass that stretches a line before it is cut, at most [kg]. A kite builder hangs one or two gallons of water from a
line of polyethylene and reports that it gets no longer after 24 to 48 h (M. Eason, "Line preparation", 1996)."""

SOURCE = (
    "Diameters and strengths of modern braided lines by their PE number: line diameter chart of Tasline (Australia); "
    "labels of makers differ, read yours."
)


@dataclass(frozen=True, kw_only=True)
class FishingLine:
    """A braided line of polyethylene."""

    name: str  # its PE number and strength, as on the label
    diameter: float  # [mm]
    pounds: float  # nominal strength without a knot [lb]

    @property
    def strength(self) -> float:
        """Load at which it breaks without a knot [N]."""
        pound = 4.448222  # newtons in a pound of force: lines are sold by these
        return pound * self.pounds

    @property
    def at_knot(self) -> float:
        """Load at which it breaks at a knot [N]."""
        return KNOT * self.strength

    @property
    def working_load(self) -> float:
        """Continuous working load [N]."""
        return SAFETY * self.at_knot

    @property
    def stretch_mass(self) -> float:
        """Mass that stretches it before it is cut [kg], in steps of 0.5 kg within its working load."""
        gravity = 9.81  # [m/s^2]
        return min(STRETCH, max(0.5, math.floor(2 * self.working_load / gravity) / 2))


LINES = tuple(
    FishingLine(name=f"PE {number:g}, {pounds:g} lb", diameter=diameter, pounds=pounds)
    for number, diameter, pounds in (
        (1, 0.165, 15.0),
        (1.5, 0.205, 20.0),
        (2, 0.235, 25.0),
        (3, 0.285, 35.0),
        (4, 0.330, 50.0),
        (5, 0.370, 60.0),
        (6, 0.405, 80.0),
        (10, 0.520, 120.0),
        (14, 0.620, 160.0),
    )
)
"""The thinnest first."""


def line_for(diameter: float) -> FishingLine:
    """The thickest line that is not thicker than a diameter [mm]; the thinnest if all are."""
    tolerance = 0.01  # a line may be so much thicker than asked for [mm]: labels are no more precise
    fitting = [line for line in LINES if line.diameter <= diameter + tolerance]
    return fitting[-1] if fitting else LINES[0]


@dataclass(frozen=True, kw_only=True)
class LineRow:
    """Strength of the line of one cable against its largest tension; loads in newtons."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    tension: Annotated[float, number_column("largest tension", "N")]
    line: Annotated[str, text_column("line")]
    strength: Annotated[float, number_column("breaks at", "N", decimals=0)]
    at_knot: Annotated[float, number_column("at a knot", "N", decimals=0)]
    working_load: Annotated[float, number_column("working load", "N", decimals=0)]
    hold: Annotated[float | None, number_column("stopper holds", "N", decimals=0)]
    verdict: Annotated[str, text_column("verdict")]


@dataclass(frozen=True, kw_only=True)
class LineCheck:
    """Verdict on one line for all cables."""

    line: FishingLine  # line of the cables
    table: Table[LineRow]  # strength of each cable's line against its tension
    problems: tuple[str, ...]  # cables that would break
    warnings: tuple[str, ...]  # cables above the working load


def check_line(robot: Robot, tensions: Vector, line: FishingLine, *, hold: float | None = None) -> LineCheck:
    """Check that a line and its stopper, which slips at `hold` [N], withstand the largest tension of each cable [N]."""
    if len(tensions) != len(robot.cables):
        raise InputError(f"{len(tensions)} tensions given for {len(robot.cables)} cables")
    problems: list[str] = []
    warnings: list[str] = []
    rows: list[LineRow] = []
    for number, (cable, tension) in enumerate(zip(robot.cables, map(float, tensions), strict=True), start=1):
        pulls = f'cable C{number} of winch "{cable.winch}" pulls {tension:.1f} N'
        verdict = "holds"
        if tension > line.at_knot:
            problems.append(f"{pulls}, but {line.name} breaks at its knot at {line.at_knot:.0f} N. {_remedy(tension)}")
            verdict = "breaks"
        elif tension > line.working_load:
            load = f"above the working load of {line.name}, {line.working_load:.0f} N"
            warnings.append(f"{pulls}, {load}. {_remedy(tension)}")
            verdict = "above the working load"
        if hold is not None and tension > hold:
            warnings.append(
                f"{pulls}, but its stopper may slip at {hold:.0f} N (estimated). Tie a knot behind the stopper "
                "after you set it"
            )
            verdict = f"{verdict}; knot the stopper"
        rows.append(
            LineRow(
                cable=f"C{number}",
                winch=cable.winch,
                tension=tension,
                line=line.name,
                strength=line.strength,
                at_knot=line.at_knot,
                working_load=line.working_load,
                hold=hold,
                verdict=verdict,
            )
        )
    table = _line_table(tuple(rows), line, largest=float(max(tensions, default=0.0)), hold=hold)
    return LineCheck(line=line, table=table, problems=tuple(problems), warnings=tuple(warnings))


def _line_table(rows: tuple[LineRow, ...], line: FishingLine, *, largest: float, hold: float | None) -> Table[LineRow]:
    """Strength of a line against the tension of each cable, and the line for the largest tension [N]."""
    enough = next((each for each in LINES if each.working_load >= largest), None)
    return Table(
        name="line_strength",
        title="Strength of the line",
        row=LineRow,
        rows=rows,
        notes=(
            f"At a knot a line keeps {KNOT:g} of its strength, if badly tied; tie a doubled Palomar (Sport Fishing, "
            f"August 2006). Working load: {SAFETY:g} of that.",
            *_list_first_failure(line, hold),
            *(
                [f"{enough.name} ({enough.diameter:g} mm) is strong enough, but thin lines cut into felt and foam."]
                if enough and enough.diameter < line.diameter
                else []
            ),
            SOURCE,
        ),
    )


def _remedy(tension: float) -> str:
    """Name a line that withstands a tension [N]."""
    for line in LINES:
        if line.working_load >= tension:
            return f"Use {line.name} ({line.diameter:g} mm) or thicker, or lower the tension"
    return f"No listed line is strong enough (maximum {LINES[-1].working_load:.0f} N). Split the load over more cables"


def _list_first_failure(line: FishingLine, hold: float | None) -> tuple[str, ...]:
    """A sentence on what gives way first under overload; none without stoppers or if the line breaks first."""
    if hold is None or hold >= line.at_knot:
        return ()
    return (
        f"Under overload the stopper slips first, at about {hold:.0f} N (estimated), before the line breaks at its "
        f"knot, at {line.at_knot:.0f} N. Set a slipped stopper again. Nobody has measured when cloth or skin tears at "
        "a hole.",
    )
