"""All lists of small robots and of the gallery."""

import math
from dataclasses import replace

import pytest
from builders import gallery_robot
from shapely import transform
from small_inputs import box, demand_of, given, square

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import Cloth, FoamNeeds
from hydrostat.fabrication.lists.lists import make_lists
from hydrostat.fabrication.patterns.stitches import cable_stitches
from hydrostat.robot import Robot


def stitches(robot: Robot) -> tuple:
    assert robot.body.outline is not None
    return cable_stitches(robot, transform(robot.body.outline.polygon, lambda points: 1e3 * points))


def test_names_and_order() -> None:
    lists = make_lists(given(square(), cloth=Cloth(felt=1e5, seam=1e3), stitches=stitches(square())))
    names = ["bill_of_materials", "cable_cuts", "sheath_cuts", "stitching", "line_strength", "motor_sizing"]
    names.append("power")
    assert [table.name for table in lists.tables] == names
    assert lists.problems == lists.warnings == ()
    assert all(check.passed for check in lists.checks)
    assert lists.cables.rows[0].cable == "C1"
    assert lists.cost == (lists.bill.rows[-1].cost_used, lists.bill.rows[-1].cost_packs)
    assert [row.is_total for row in lists.bill.rows[-2:]] == [True, True]


def test_problems_and_warnings_come_through() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08), (0.15, 0.08, 0.08))
    lists = make_lists(given(robot, demand=demand_of(robot, 500.0), foam=FoamNeeds(volume=1e6, part_a=8.0, part_b=8.0)))
    assert len(lists.problems) == 1
    assert "breaks" in lists.problems[0]
    assert any("cannot reach" in warning for warning in lists.warnings)
    assert any("80 mm under the skin" in warning for warning in lists.warnings)
    assert "each core of foam" in lists.bill.notes[-1]


def test_a_pose_that_was_not_solved_is_told() -> None:
    demand = replace(demand_of(square()), missed=('pose "wave": no equilibrium',))
    assert 'pose "wave"' in make_lists(given(square(), demand=demand)).warnings[0]


def test_notes_of_the_lists_are_written() -> None:
    """Oracle: the notes that the tables hold, under the names of their files."""
    lists = make_lists(given(square(), cloth=Cloth(felt=1e5, seam=1e3), stitches=stitches(square())))
    lines = lists.notes_text.splitlines()
    for table in lists.tables:
        assert f"{table.name}.csv: {table.title}" in lines
        assert {f"- {note}" for note in table.notes} <= set(lines)
    assert "doubled Palomar" in lists.notes_text


def test_lengths_of_no_cable_are_refused() -> None:
    with pytest.raises(InputError, match=r"leads\[3\]: the robot has 1 cables"):
        given(square(), leads={3: 1.0})
    with pytest.raises(InputError, match=r"outside\[0\] must not be negative"):
        given(square(), outside={0: -1.0})


def test_the_same_bytes_twice() -> None:
    this = given(square(), cloth=Cloth(felt=1e5, seam=1e3))
    assert [table.csv for table in make_lists(this).tables] == [table.csv for table in make_lists(this).tables]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["starfish", "letter_s", "puppy", "squid", "bear", "trunk", "cupping_hand"])
def test_gallery_robots_have_sound_lists(name: str, unchecked: None) -> None:
    robot = gallery_robot(name)
    flat = robot.body.mesh.dim == 2
    every = range(len(robot.cables))
    lists = make_lists(
        given(
            robot,
            method=Method.PLUSH if flat else Method.FOAM,
            stitches=stitches(robot) if flat else (),
            cloth=Cloth(felt=2e5, seam=2e3, zipper=150.0) if flat else None,
            foam=None if flat else FoamNeeds(volume=4e5, part_a=32.0, part_b=32.0, silicone=3e6, silicone_mass=3540.0),
            leads=dict.fromkeys(every, 10.0),
            seats=dict.fromkeys(every, 5.0),
        )
    )
    assert all(check.passed for check in lists.checks), lists.checks
    for cable, row in zip(robot.cables, lists.cables.rows, strict=True):
        assert 1e3 * cable.length < row.total < 1e3 * cable.length + 320 + row.tail
    assert lists.stitching is not None
    assert len(lists.stitching.rows) == sum(len(cable.points) for cable in robot.cables)
    assert all(isinstance(row.length, float) and row.length > 0 for row in lists.tubes.rows)
    costs = {row.what: row.cost_used for row in lists.bill.rows}
    assert costs.pop("needles") == 0  # a tool
    assert all(isinstance(cost, float) and math.isfinite(cost) and cost > 0 for cost in costs.values())
    assert all(row.cost_used <= row.cost_packs + 1e-9 for row in lists.bill.rows)
    for table in lists.tables:
        assert table.csv.decode().count("\r\n") == len(table.rows) + 1
