"""Parts and rods in bill, list and steps. Oracle: areas, lengths and densities by hand."""

import math
from dataclasses import replace

import pytest
from kit_plans import change_plan
from shapely import Polygon
from small_inputs import given, square
from test_bill import needs

from hydrostat.fabrication.inserts import find_inserts, insert_title, rod_problems
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import Cloth
from hydrostat.fabrication.lists.lists import insert_table
from hydrostat.fabrication.lists.needs import filling_mass
from hydrostat.fabrication.patterns.sheet_pieces import sheet_pieces
from hydrostat.fabrication.refusals import find_refusals
from hydrostat.fabrication.sheets.steps import insert_steps
from hydrostat.robot import BodyPart, Membrane, Robot, Rod, get_material

BONE = BodyPart(name="bone", shape="box", at=(-0.04, -0.04), to=(0.0, -0.02), density=1200.0)
PAD = BodyPart(name="pad", shape="box", at=(0.02, -0.04), to=(0.04, -0.02), material=get_material("flexfoam-it x"))
WIRE = Rod(name="wire", points=((-0.04, 0.03), (0.0, 0.0), (0.03, 0.04)), diameter=1e-3, young=200e9)
STRIP = Rod(name="strip", points=((0.0, 0.0), (0.0, 0.04)), axial_stiffness=500.0, bending_stiffness=2.5e-3)


def with_inserts() -> Robot:
    """The square of 100 x 100 x 30 mm with two parts and two rods."""
    robot = square()
    return replace(robot, body=robot.body.with_parts((BONE, PAD)), rods=(WIRE, STRIP))


def test_what_is_put_in_is_bought_listed_and_told() -> None:
    robot = with_inserts()
    plan = change_plan(given(robot), cloth=Cloth(felt=1e4, seam=100.0))
    body, (pad, filling) = robot.body, (float(robot.body.element_masses[one].sum()) for one in _own(robot))
    bought = needs(plan)
    assert filling_mass(plan) == pytest.approx(1e3 * filling)
    assert bought["fiber filling"].mass == pytest.approx(1e3 * filling)
    assert sum(
        item.mass or 0.0 for name, item in bought.items() if name.startswith(("fiber", "part"))
    ) == pytest.approx(1e3 * body.mass)
    assert bought["part P2 pad"].quantity == pytest.approx(pad)
    assert bought["rod R1 wire"].quantity == pytest.approx(0.1)  # 50 mm twice
    assert bought["rod R1 wire"].mass == pytest.approx(7.85e-3 * math.pi / 4 * 100)
    assert "spring steel or alike (200 GPa), 1 mm thick, 100 mm long" in bought["rod R1 wire"].specification
    assert bought["rod R2 strip"].specification == "EA 500 N, EI 2500 N mm^2, 40 mm long"
    inserts = find_inserts(robot)
    rows = insert_table(inserts, insert_title(inserts)).rows
    assert [(row.mark, row.size, row.where) for row in rows[:3]] == [
        ("P1", "40 × 20 × 30 mm", "middle at [-20, -30] mm"),
        ("P2", "20 × 20 × 30 mm", "middle at [30, -30] mm"),
        ("R1", "1 mm thick, 100 mm long", "[-40, 30] to [0, 0] to [30, 40] mm"),
    ]
    (plush,), (cast,) = (insert_steps(change_plan(plan, method=method)) for method in (Method.PLUSH, Method.FOAM))
    assert plush.title == cast.title == rows[0].step == "Put parts and rods in"
    assert "channel" in plush.text
    assert "through the wall" in cast.text
    assert insert_steps(given(square())) == ()


def test_a_sheet_on_the_skin_is_cut_and_fixed() -> None:
    """The left half of the square: two faces of 50 x 100 mm, and 200 mm of its outline, 30 mm wide, cut by elements."""
    felt = get_material("ecoflex 00-30")
    half = {"shape": "box", "at": (-0.1, -0.1), "to": (0.0, 0.1)}
    sheet = Membrane(name="glove", material=felt, thickness=1e-3, wrinkles=True, **half)
    robot = replace(square(), sheets=(sheet,))
    plan = change_plan(given(robot), method=Method.PLUSH)
    (row,) = insert_table(plan.inserts, "").rows
    area = 1e6 * sheet.find_area(robot.body.mesh, robot.body.thickness)
    assert area == pytest.approx(2 * 50 * 100 + 200 * 30, rel=0.2)
    assert (row.mark, row.size, row.step) == ("S1", f"1 mm thick, {area / 100:.0f} cm²", "Fix sheet S1")
    assert row.mass == pytest.approx(1e-6 * felt.density * area, rel=1e-6)
    assert needs(plan)["sheet S1 glove"].quantity == pytest.approx(1e-6 * area)
    (step,) = insert_steps(plan)
    assert "pattern/sheet_S1.svg or .dxf, which has no seam allowance; the face twice, once turned over" in step.text
    assert "Sew its rim on, so that it can wrinkle, middle at [-19, 0] mm" in step.text
    pieces = sheet_pieces(robot, sheet)
    assert pieces is not None
    areas = [Polygon(line.points).area for line in pieces.panels[0].shapes]
    assert areas == pytest.approx([50 * 100, 200 * 30])
    rim = replace(sheet, on="outline", shape="sphere", at=(0.05, 0.05), to=None, radius=0.02)
    (strip,) = sheet_pieces(robot, rim).panels[0].shapes  # type: ignore[union-attr]
    assert Polygon(strip.points).area == pytest.approx(40 * 30, rel=1e-3)


def _own(robot: Robot) -> tuple[object, object]:
    """Masks of the elements of the pad, and of the filling."""
    return robot.body.element_materials == 2, robot.body.element_materials == 0


def test_a_rod_thicker_than_the_body_is_refused() -> None:
    robot = replace(square(), rods=(replace(WIRE, diameter=0.031), replace(WIRE, name="thin")))
    told = ("rod[0] wire is 31 mm thick, the body only 30 mm. Take a thinner rod or a thicker body",)
    assert rod_problems(robot) == told
    assert set(told) <= set(find_refusals(robot))
