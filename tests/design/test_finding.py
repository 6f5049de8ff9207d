"""Where sentences are about. Oracles: the robot's own numbers, middles of segments, a crossing worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.finding import Diagnostic, Severity, places_in
from hydrostat.design.region import Region
from hydrostat.fabrication import find_refusals
from hydrostat.robot import Robot, find_risks


@pytest.fixture(scope="module")
def strip() -> Robot:
    """Two winches, "up" and "down", a cable each of seven points from x = 10 to 190 mm, at y = 15 and -12 mm."""
    return strip_robot(columns=10, rows=3)


@pytest.mark.parametrize(
    ("text", "parts", "at"),
    [
        ("winch[1] down: pulls no cable", ["winch:down"], (10, -12)),
        ('winch "up": only 2 mm of the shaft', ["winch:up"], (10, 15)),
        (
            "cable[0].points[2]: turn too sharp (40 degrees). Maximum turn: 30 degrees. Move the point.",
            ["via:0:2"],
            (70, 15),
        ),
        ("cable[1].points[6] is 1 mm from it", ["via:1:6"], (190, -12)),
        (
            "cable[1] between points 1 and 2: inside keep_out[0] (3 mm deep). Allowed: outside. Reroute it.",
            ["cable:1"],
            (55, -12),
        ),
        ("cable[0]: leaves the body by 3 mm at [12, -7] mm; add a point", ["cable:0"], (12, -7)),
        ("cable[0] and cable[1]: only 2 mm inside the edge at [9, 8] mm (cable[1] is the worst)", ["cable:1"], (9, 8)),
        ('cable C2 of winch "down" pulls 90.0 N, but it breaks', ["cable:1", "winch:down"], (115, -12)),
        ("cable 1: its tube comes within 0.1 mm of the skin at [1, 2] mm, but needs", ["cable:0"], (1, 2)),
        ("cable[0].points[2] = [70, 15] mm is 0.4 mm from the seam", ["via:0:2"], (70, 15)),
        ("marker[0] tip: held by a pin, cannot move", ["marker:tip"], (200, 0)),
        ("body: a limb has only 2.4 elements across (18.5 mm thick at [2, -42] mm): too stiff", ["body"], (2, -42)),
        ('the units of winches "up" and "down" overlap in every tested place', ["winch:up", "winch:down"], (10, 15)),
    ],
)
def test_a_sentence_is_about_the_parts_that_it_names(strip: Robot, text: str, parts: list[str], at: tuple) -> None:
    found = places_in(text, strip)
    assert [place.part for place in found] == parts
    np.testing.assert_allclose(found[0].at, 1e-3 * np.array(at), atol=1e-9)


@pytest.mark.parametrize(
    "text", ["cable[7].points[1] turns", "winch[5] gone", 'winch "who"', "cable[0].points[70]", "the motor stalls"]
)
def test_what_is_not_there_has_no_place(strip: Robot, text: str) -> None:
    assert places_in(text, strip) == ()


def test_a_crossing_is_where_the_cables_cross(strip: Robot) -> None:
    """Two lines over the middle of (80, 0) mm."""
    one, other = ((0.06, -0.01), (0.1, 0.01)), ((0.06, 0.01), (0.1, -0.01))
    cables = [replace(strip.cables[0], points=one), replace(strip.cables[1], points=other)]
    text = "cable[1] between points 0 and 1: crosses cable[0] between points 0 and 1. Minimum cable_gap: 4 mm."
    winches = [replace(winch, at=cable.points[0]) for winch, cable in zip(strip.winches, cables, strict=True)]
    (place,) = places_in(text, strip.with_network(winches, cables))
    assert place.part == "cable:1"
    np.testing.assert_allclose(place.at, (0.08, 0.0), atol=1e-9)


@pytest.mark.parametrize("name", ["squid", "starfish", "puppy", "robot"])
def test_every_sentence_of_the_checks_that_names_a_part_has_a_place(name: str, unchecked: None) -> None:
    robot, limits = gallery_robot(name), Constraints()
    crowded = replace(robot, winches=tuple(replace(winch, spool_radius=0.02) for winch in robot.winches))
    said = [
        *violations(robot, limits, Region.of_body(robot.body, limits.clearance)),
        *(text for text in find_risks(robot) if not text.startswith(("body", "pose"))),
        *find_refusals(crowded),
    ]
    assert len(said) > 3
    assert [text for text in said if not places_in(text, robot)] == []


@pytest.mark.parametrize(("severity", "word"), [*zip(Severity, ("error", "note", "warning"), strict=True)])
def test_a_line_prints_as_check_prints_it(severity: Severity, word: str) -> None:
    """Oracle: parts count from 1 for people."""
    line = Diagnostic(text="cable[0]: only 2 mm inside the edge", severity=severity, places=())
    assert str(line) == f"{word}: cable 1: only 2 mm inside the edge"
