"""Constraints from a file. Oracles: records made by hand, the fields of `Constraints`, errors word by word."""

from dataclasses import fields, replace
from pathlib import Path

import pytest
from builders import box_robot, strip_robot

from hydrostat.design import BuildTolerances, Constraints, Zone
from hydrostat.design.constraints_file import (
    ZONES,
    BuiltTable,
    ConstraintsTable,
    cable_name,
    read_constraints,
    read_uncertainty,
)
from hydrostat.errors import HydrostatWarning, InputError
from hydrostat.robot import Mount

ALL = """
mount = "world"
cables_per_winch = 4
clearance = "4 mm"
winch_clearance = "1.5 cm"
winch_gap = "30 mm"
hole_gap = "3 mm"
cable_gap = "5 mm"
drawing_gap = "1 mm"
built_in = false
max_turn = "60 deg"
bend_radius = "8 mm"
max_length = "0.4 m"
tension = "15 N"
torque = "0.1 N m"
motor = "sts3215"
travel = "50 mm"
release = "5 mm"
spool_radius = "5 mm"
slack = "6 mm"
spool_ratio = 2.5
two_way = true
leads = false
mirror = "y"
locked_winches = ["down"]
locked_cables = ["down 1"]

[[winch_zone]]
box = [[0, -20], [40, 20]]

[[winch_zone]]
outline = [[50, -20], [90, -20], [70, 20]]

[[keep_out]]
at = [100, 0]
radius = 12.5

[[passive_zone]]
at = [20, 5]
radius = 10
"""

MADE = Constraints(
    winch_zones=(
        Zone(box=((0.0, -0.02), (0.04, 0.02))),
        Zone(outline=((0.05, -0.02), (0.09, -0.02), (0.07, 0.02))),
    ),
    keep_out=(Zone(at=(0.1, 0.0), radius=0.0125),),
    passive_zones=(Zone(at=(0.02, 0.005), radius=0.01),),
    mount=Mount.WORLD,
    cables_per_winch=4,
    clearance=0.004,
    winch_clearance=0.015,
    winch_gap=0.03,
    hole_gap=0.003,
    cable_gap=0.005,
    drawing_gap=0.001,
    built_in=False,
    max_turn=60.0,
    bend_radius=0.008,
    max_length=0.4,
    tension=15.0,
    torque=0.1,
    motor="sts3215",
    travel=0.05,
    release=0.005,
    spool_radius=0.005,
    slack=0.006,
    spool_ratio=2.5,
    two_way=True,
    leads=False,
    mirror="y",
    locked_winches=("down",),
    locked_cables=("down 1",),
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "limits.toml"


def test_every_field_can_stand_in_the_file(file: Path) -> None:
    keys = set(ConstraintsTable.model_fields) - {"tolerances"}
    assert {ZONES.get(key, key) for key in keys} == {field.name for field in fields(MADE)}
    for field in fields(MADE):
        if field.name == "depth":  # for bodies in space
            continue
        assert getattr(MADE, field.name) != getattr(Constraints(), field.name), field.name
    file.write_text(ALL)
    assert read_constraints(file, strip_robot()) == MADE


def test_a_depth_is_for_bodies_in_space(file: Path) -> None:
    box = box_robot()
    robot = replace(box, winches=tuple(replace(winch, mount=Mount.WORLD) for winch in box.winches))
    for text, depth in (("0 mm", 0.0), ("3 mm", 0.003)):
        file.write_text(f'depth = "{text}"')
        assert read_constraints(file, robot) == Constraints(depth=depth)
        with pytest.raises(InputError, match="depth: a flat body"):
            read_constraints(file, strip_robot())


def test_what_is_left_out_is_as_ever(file: Path) -> None:
    for text, changed in (("", {}), ('tension = "3 N"', {"tension": 3.0}), ("leads = true", {"leads": True})):
        file.write_text(text)
        assert read_constraints(file, strip_robot()) == replace(Constraints(), **changed)


BUILT = """
clearance = "4 mm"
[tolerances]
sewing = "1 mm"
friction = [0.1, 0.3]
young = 0.1
thickness = 0.05
stiffness = 0.15
pins = 0.25
slack = "0.5 mm"
spool = 0.01
"""


def test_tolerances_stand_in_the_same_file(file: Path) -> None:
    assert set(BuiltTable.model_fields) == {field.name for field in fields(BuildTolerances)}
    file.write_text(BUILT)
    assert read_uncertainty(file, strip_robot()) == BuildTolerances(
        sewing=1e-3, friction=(0.1, 0.3), young=0.1, thickness=0.05, stiffness=0.15, pins=0.25, slack=5e-4, spool=0.01
    )
    assert read_constraints(file, strip_robot()).clearance == 4e-3
    file.write_text("[tolerances]\nspool = 0.01")
    for robot in (strip_robot(), box_robot()):
        assert read_uncertainty(file, robot) == replace(BuildTolerances.of(robot.body), spool=0.01)
    file.write_text("")
    assert read_uncertainty(file, strip_robot()) == BuildTolerances()


def test_keys_of_older_files_are_read_and_named_anew(file: Path) -> None:
    file.write_text('turn = "60 deg"\nlongest = "1 m"\n[[still]]\nat = [20, 5]\nradius = 10\n[built]\nspool = 0.01')
    with pytest.warns(HydrostatWarning, match="turn is now max_turn, longest is now max_length, still is now"):
        read = read_constraints(file, strip_robot())
    assert (read.max_turn, read.max_length, len(read.passive_zones)) == (60.0, 1.0, 1)
    with pytest.warns(HydrostatWarning, match="built is now tolerances"):
        assert read_uncertainty(file, strip_robot()).spool == 0.01
    file.write_text('\nturn = "200 deg"')
    with pytest.warns(HydrostatWarning), pytest.raises(InputError, match="line 2: max_turn must be"):
        read_constraints(file, strip_robot())
    file.write_text('\'longest\' = "1 m"\n"built" = { spool = 0.01 }\nstill = [{ at = [20, 5], radius = 10 }]')
    with pytest.warns(HydrostatWarning, match="longest is now max_length, built is now tolerances, still is now"):
        read = read_constraints(file, strip_robot())
    assert (read.max_length, len(read.passive_zones)) == (1.0, 1)
    file.write_text('[["still"]]\nat = [20, 5]\nradius = 10\n[["still"]]\nat = [20, 5]\nradius = "wide"')
    with pytest.raises(InputError, match=r"line 6: passive_zone\[1\]\.radius"):
        read_constraints(file, strip_robot())
    file.write_text('max_turn = "60 deg"\nturn = "50 deg"')
    with pytest.raises(InputError, match=r"line 2: turn: is now max_turn, which is there too\. Remove one\."):
        read_constraints(file, strip_robot())


@pytest.mark.parametrize(
    ("text", "message"),
    {
        "sewing = 2": 'tolerances.sewing: 2 has no unit; write a length as text: "12 mm"',
        "young = -0.1": "tolerances.young must be at least 0 and at most 1, not -0.1",
        "friction = [0.3, 0.1]": "tolerances.friction must rise from at least 0 to at most 1, not (0.3, 0.1)",
    }.items(),
)
def test_a_wrong_tolerance_is_one_line(text: str, message: str, file: Path) -> None:
    file.write_text(f"[tolerances]\n{text}")
    with pytest.raises(InputError) as caught:
        read_uncertainty(file, strip_robot())
    assert str(caught.value) == f"{file}, line 2: {message}"


def test_zones_are_in_the_unit_of_the_robots_file(file: Path) -> None:
    for zone in ("at = [3, 0, 1]\nradius = 0.5", 'at = ["30 mm", 0, "0.01 m"]\nradius = "5 mm"'):
        file.write_text(f"[[keep_out]]\n{zone}")
        zones = read_constraints(file, replace(box_robot(), length_unit="cm")).keep_out
        assert zones == (Zone(at=(0.03, 0.0, 0.01), radius=0.005),)


ERRORS = {
    "clearance = 5": 'line 1: clearance: 5 has no unit; write a length as text: "12 mm"',
    '\nclearance = "-5 mm"': "line 2: clearance must be above 0 and at most 1 m, not -0.005; in meters: 5 mm is 0.005",
    'tension = "3 mm"': 'line 1: tension: "mm" does not measure a force; write for example "20 N"',
    'torque = "3 N"': 'line 1: torque: "N" does not measure a torque; write for example "0.1 N m"',
    "max_turn = 75": 'line 1: max_turn: 75 has no unit; write an angle as text: "75 deg"',
    'max_turn = "200 deg"': "line 1: max_turn must be above 0 and at most 180 degrees, not 200.0",
    "spool_ratio = 9": "line 1: spool_ratio must be at least 1 and at most 4, not 9.0",
    'mount = "air"': 'line 1: mount: "air" is not known; allowed are: body or world',
    'mirror = "w"': 'line 1: mirror: "w" is not known; allowed are: x, y or z',
    "leads = 1": "line 1: leads: 1 is neither true nor false; write one of them without quotes",
    "cables_per_winch = 2.5": "line 1: cables_per_winch: 2.5 is not a whole number; "
    "write for example cables_per_winch = 4",
    "locked_cables = [1, 3]": 'line 1: locked_cables[1]: unknown cable "3". Available: up 1, down 1.',
    "locked_cables = [0]": 'line 1: locked_cables[0]: unknown cable "0". Available: up 1, down 1.',
    'locked_cables = ["up"]': 'line 1: locked_cables[0]: unknown cable "up". Available: up 1, down 1. '
    + 'Did you mean "up 1"?',
    "locked_cables = [true]": "line 1: locked_cables[0]: neither a name nor a number that counts from 1",
    'locked_winches = "up"': 'line 1: locked_winches: "up" is not a list; write for example locked_winches = ["left"]',
    'locked_winches = ["bob"]': 'line 1: locked_winches[0]: unknown winch "bob". Available: up, down.',
    "[[keep_out]]\nat = [1, 2]": "line 1: keep_out[0]: a zone about a point needs both at and radius; "
    "give the other too",
    "[[passive_zone]]\nat = [1, 2]\nradius = 0": "line 3: passive_zone[0].radius "
    "of a zone must be finite and above 0 m, not 0.0",
    "[[passive_zone]]\nat = [1, 2, 3]\nradius = 1": "line 1: passive_zone[0]: wrong dimension "
    "of its points (3). Body: 2.",
    "[[passive_zone]]\noutline = [[0, 0], [1, 1]]": "line 2: passive_zone[0].outline: "
    "has 2 entries, at least 3 are needed",
    "[[keep_out]]\nat = [1, 2]\nradius = 3\n[[keep_out]]\nradios = 3": "line 5: keep_out[1].radios: unknown key "
    '"radios", did you mean radius? allowed here are: at, radius, box, outline',
    "keep_out = 3": "line 1: keep_out: begin each with [[keep_out]], in two pairs of brackets",
    "winch_zones = []": 'line 1: winch_zones: unknown key "winch_zones", did you mean winch_zone? allowed here are: '
    + ", ".join(ConstraintsTable.model_fields),
    "x = = 3": "line 1: not TOML: Invalid value",
    "x = " + 500 * "[": "not TOML of constraints: brackets are nested too deep",
}


@pytest.mark.parametrize("text", ERRORS)
def test_what_is_wrong_is_one_line(text: str, file: Path) -> None:
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_constraints(file, strip_robot())
    place = ", " if ERRORS[text].startswith("line") else ": "
    assert str(caught.value) == f"{file}{place}{ERRORS[text]}"


def test_a_robot_without_cables_has_none_to_lock(file: Path) -> None:
    file.write_text("locked_cables = [1]")
    with pytest.raises(InputError, match="unknown cable"):
        read_constraints(file, strip_robot().with_network((), ()))


def test_cables_by_name_or_by_number_from_1(file: Path) -> None:
    """A name comes first: a cable may be called "1"."""
    robot = strip_robot()
    file.write_text('locked_cables = [2, "up 1"]')
    assert read_constraints(file, robot).locked_cables == ("down 1", "up 1")
    one, two = robot.cables
    renamed = robot.with_network(robot.winches, [one, replace(two, name="1")])
    assert [cable_name(given, renamed) for given in ("1", 1, "2", "up 1")] == ["1", "1", "1", "up 1"]
    with pytest.raises(InputError, match='unknown cable "3"'):
        cable_name("3", renamed)


def test_no_such_file(file: Path) -> None:
    with pytest.raises(InputError, match=r"limits.toml: there is no such file"):
        read_constraints(file, strip_robot())
