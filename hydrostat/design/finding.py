"""`Diagnostic`, `places_in`: lines of a design review, and the places that they name."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.design.polyline import nearest_shares
from hydrostat.errors import in_words
from hydrostat.given import Point
from hydrostat.robot import Robot


class Severity(StrEnum):
    """Severity of a finding."""

    REFUSED = "refused"  # a kit is refused
    LIMIT = "limit"  # a limit that designs keep is not kept
    WARNING = "warning"  # it may fail later

    @property
    def word(self) -> str:
        """Beginning of its line in a command's output."""
        return {Severity.REFUSED: "error", Severity.LIMIT: "note", Severity.WARNING: "warning"}[self]


@dataclass(frozen=True, kw_only=True)
class Place:
    """Place that a line of a review names."""

    part: str  # "winch:left", "cable:0", "via:0:2" (cable and point), "pin:0", "marker:tip" or "body"
    at: Point  # in the rest shape [m]


@dataclass(frozen=True, kw_only=True)
class Diagnostic:
    """Line of a design review. `str` gives the line that `hydrostat check` prints.

    Attributes:
        text: sentence; parts are named by their path in robot.toml, with numbers from 0.
        severity: its severity.
        places: places that it names; none if it concerns the whole robot.
    """

    text: str
    severity: Severity
    places: tuple[Place, ...]

    def __str__(self) -> str:
        return f"{self.severity.word}: {in_words(self.text)}"


def places_in(text: str, robot: Robot) -> tuple[Place, ...]:
    """The places of all parts that a sentence names, each once, in its order.

    All checks name parts in the same few ways: `winch[0] left`, `winch "left"`, `cable[1]`, `cable C2` or `cable 2`
    (from 1), `cable[1].points[2]`, `cable[1] between points 2 and 3`, `pin[0]`, `marker[0] tip`. Of two runs the place
    is where they come nearest. A sentence that gives a place, as in `at [12, 30] mm`, is about that one alone.
    """
    runs = [tuple(map(int, match.groups())) for match in _RUN.finditer(text)]
    if len(runs) == 2 and all(_is_run(robot, *run) for run in runs):
        return (_nearest(robot, *runs),)
    found = {place.part: place for place in _find_named_parts(text, robot)}
    given = _GIVEN.search(text)
    if given:
        at = tuple(1e-3 * float(value) for value in given[1].split(","))
        worst = _WORST.search(text)
        parts = [*(_find_named_parts(worst[1], robot) if worst else ()), *found.values()]
        return (Place(part=parts[0].part if parts else "body", at=at),)
    return tuple(found.values())


_RUN = re.compile(r"cable\[(\d+)\] between points (\d+) and \d+")
_GIVEN = re.compile(r"(?:\bat|=) \[([-\d., e]+)\] mm")
_WORST = re.compile(r"\((\w+\[\d+\])[^()]* is the worst\)")
_QUOTED = re.compile(r'\bwinch(?:es)? ((?:"[^"]+"(?:, | and )?)+)')
_PART = re.compile(
    r"\b(?:(?P<kind>winch|pin|marker)\[(?P<number>\d+)\]"
    r"|cable\[(?P<cable>\d+)\](?:\.points\[(?P<point>\d+)\]| between points (?P<first>\d+) and \d+)?"
    r"|cable C?(?P<counted>\d+)\b)"
)


def _find_named_parts(text: str, robot: Robot) -> Iterator[Place]:
    """Yield a place for each named part, where it is known."""
    winches = {winch.name: winch for winch in robot.winches}
    for match in _PART.finditer(text):
        place = _part(robot, {name: value for name, value in match.groupdict().items() if value is not None})
        if place is not None:
            yield place
    for match in _QUOTED.finditer(text):
        for name in re.findall(r'"([^"]+)"', match[1]):
            if name in winches:
                yield Place(part=f"winch:{name}", at=winches[name].at)


def _part(robot: Robot, said: dict[str, str]) -> Place | None:
    """The place of one part that is named by its number; None where there is none."""
    kind = said.get("kind")
    if kind is not None:
        number = int(said["number"])
        parts = {"winch": robot.winches, "pin": robot.pins, "marker": robot.markers}[kind]
        if number >= len(parts):
            return None
        if kind == "pin":
            pin = robot.pins[number]
            middle = pin.at if pin.at is not None else tuple(np.mean(pin.box or (), axis=0).tolist())
            return Place(part=f"pin:{number}", at=middle)
        part = robot.winches[number] if kind == "winch" else robot.markers[number]
        return Place(part=f"{kind}:{part.name}", at=part.at)
    cable = int(said["cable"]) if "cable" in said else int(said["counted"]) - 1
    if not 0 <= cable < len(robot.cables):
        return None
    points = robot.cables[cable].points
    if "point" in said:
        point = int(said["point"])
        return Place(part=f"via:{cable}:{point}", at=points[point]) if point < len(points) else None
    first = int(said["first"]) if "first" in said else (len(points) - 1) // 2
    if not _is_run(robot, cable, first):
        return None
    middle = np.mean(points[first : first + 2], axis=0)
    return Place(part=f"cable:{cable}", at=tuple(middle.tolist()))


def _is_run(robot: Robot, cable: int, first: int) -> bool:
    return cable < len(robot.cables) and first + 1 < len(robot.cables[cable].points)


def _nearest(robot: Robot, one: tuple[int, ...], other: tuple[int, ...]) -> Place:
    """Point where two runs, each a cable and its first point, come nearest: the middle between them."""
    ends = [np.array(robot.cables[cable].points[first : first + 2]) for cable, first in (one, other)]
    shares = nearest_shares(ends[0][None], ends[1][None])
    places = [run[0] + share[0] * (run[1] - run[0]) for run, share in zip(ends, shares, strict=True)]
    return Place(part=f"cable:{one[0]}", at=tuple(np.mean(places, axis=0).tolist()))
