"""What building a robot asks: the first page of a sheet, and its words as a text."""

from dataclasses import replace
from io import BytesIO
from types import SimpleNamespace
from typing import cast

import pytest
from kit_plans import FewParts
from pypdf import PdfReader
from sheet_inputs import foam, lists, plush

from hydrostat.design import BuildCost
from hydrostat.fabrication.lists.motors import power_plan
from hydrostat.fabrication.parts.motor import ALL_MOTORS
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.sheet_facts import sheet_facts
from hydrostat.fabrication.sheets.steps import stretch_steps
from hydrostat.fabrication.sheets.summary import all_steps, find_difficulty, summary_rows
from hydrostat.fabrication.sheets.text_sheet import sheet_text
from hydrostat.ik import IKResult


@pytest.mark.usefixtures("unchecked")
def test_the_first_page_says_what_building_asks():
    """Oracle: sums by hand: 8 items of 3 USD, 2 printed pieces a winch and 2 a cable; cost of a design."""
    plan = plush().plan
    rows = dict(summary_rows(plan, lists(2)))
    loads = SimpleNamespace(pose=SimpleNamespace(tensions=plan.demand.tensions))
    cost = BuildCost.of_robot(replace(plan.drawn, motor=plan.rigid.motor.key), [cast(IKResult, loads)])
    share = f"{cost.price:.0f} USD of them for 1 motor, power and cables."
    assert rows["Money"] == (f"About 24 USD in whole packs, 24 USD used up: {share}",)
    assert f", {cost.minutes:.0f} min of them on cables. No step was timed." in rows["Work"][0]
    assert rows["To print"][0].startswith("6 pieces, ")
    assert rows["To sew"] == ("2 cables.",)
    assert rows["Difficulty"] == ("Easy: one afternoon.",)
    assert "Screwdrivers" not in " ".join(rows["You must own"])
    first = " ".join(PdfReader(BytesIO(assembly_sheet(*plush()))).pages[0].extract_text().split())
    for title, lines in rows.items():
        assert f"{title} " in first
        assert all(line.partition(",")[0] in first for line in lines)


@pytest.mark.parametrize(
    ("robot", "hours", "motor", "level"),
    [
        (plush, 5, None, "Medium"),
        (plush, 5, "25d", "Medium"),
        (plush, 12, "25d", "Hard"),
        (foam, 3, "sts3215", "Medium"),
    ],
)
def test_difficulty_counts_hours_foam_and_wires(robot, hours, motor, level):
    """Oracle: its rule: an afternoon 1, days 2, foam 1, wires 1; hard from 3 on."""
    given = robot()
    chosen = [one for one in ALL_MOTORS if one.key == motor]
    power = power_plan({"pull 1": 40.0}, chosen[0]) if chosen else None
    told = find_difficulty(given.plan, lists(2, power=power), 60 * hours)
    assert told.startswith(level.lower())


def test_line_is_stretched_before_all_else():
    """Oracle: the rule: 5 L of water on the line of 80 lb, and a day of waiting on the first page; no line, no step."""
    for given in (plush(), foam()):
        first = all_steps(given.plan, given.lists)[0][0]
        assert first.title == "Stretch the line"
        assert "5 L of water" in first.text
        assert "Stretch the line: 24 h under this weight." in dict(summary_rows(given.plan, given.lists))["Waiting"]
        bare = replace(given.plan, robot=replace(given.plan.robot, cables=(), winches=()), rigid=FewParts())
        assert stretch_steps(bare) == ()


def test_the_words_of_a_sheet_are_a_text():
    """Oracle: the facts of the same sheet, a line each; a row of a table says its headings."""
    for make in (plush, foam):
        given = make()
        facts = sheet_facts(*given)
        text = sheet_text(facts).splitlines()
        steps = [step for page in facts["steps"] for step in page]
        for number, step in enumerate(steps, start=1):
            assert f"{number}. {step['title']} ({step['time']}). {step['text']}" in text
        assert {*facts["safety"], *facts["checklist"]} <= {*text}
        assert "C1, cut to 250, slack 1.5, spool mark 122" in text
        assert f"passed: {given.findings.checks[0].what}, 0.004 mm (allowed: 0.1 mm)" in text
