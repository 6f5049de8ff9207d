"""Winches that are too large for the zipper."""

from dataclasses import replace

import pytest
from kit_plans import FewParts
from sheet_inputs import plush

from hydrostat.fabrication import MOTORS, PartOptions, PatternOptions, plush_pattern
from hydrostat.fabrication.parts.winch_unit import winch_units
from hydrostat.fabrication.passage import find_passage_problems
from hydrostat.fabrication.sheets.plush_steps import plush_steps


def test_a_winch_too_large_for_the_zipper_comes_in_through_the_seam(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a slit of 20 mm, through which no unit passes; then one of 200 mm, through which all pass."""
    given = plush(winches=2)
    units = winch_units(given.plan.robot, PartOptions(), MOTORS[0])
    plan = replace(given.plan, rigid=FewParts(units=units))
    for slit, is_open in ((20.0, True), (200.0, False)):
        monkeypatch.setattr("hydrostat.fabrication.passage._slit", lambda _plan, length=slit: length)
        text = " ".join(step.text for step in plush_steps(plan))
        assert ("sew twice along the seam line but for" in text) == is_open
        assert ("Bring W1 and W2 in through the open seam." in text) == is_open
        assert ("Close the open seam by hand" in text) == is_open
        assert f"screw the housing on: {units[0].housing.screw.title.partition(' mm')[0]} mm" in text


@pytest.mark.parametrize("winches", [0, 2])
def test_a_body_without_a_zipper_has_no_step_for_one(monkeypatch: pytest.MonkeyPatch, winches: int) -> None:
    """Oracle: no reach of the opening, so the pattern has none; the seam stays open until the body is stuffed."""
    given = plush(winches=2)
    robot = given.plan.drawn if winches else given.plan.drawn.with_network((), ())
    pattern = plush_pattern(robot, options=PatternOptions(opening_reach=0.0))
    units = winch_units(robot, PartOptions(), MOTORS[0]) if winches else ()
    work = replace(given.plan.work, pattern=pattern)
    plan = replace(given.plan, drawn=robot, robot=robot, rigid=FewParts(units=units), work=work)
    steps = plush_steps(plan)
    assert pattern.opening is None
    assert not any("zipper" in (step.title + step.text).lower() for step in steps)
    (sewn,) = [step.text for step in steps if step.title == "Sew the body"]
    assert "seam line but for" in sewn
    assert "right side out through the open seam." in sewn
    assert steps[-1].text.startswith("Close the open seam by hand with ladder stitch")
    assert (", the wires led out at its end." in steps[-1].text) == bool(winches)
    assert find_passage_problems(plan) == ()
    monkeypatch.setattr("hydrostat.fabrication.passage._seam_lengths", lambda _plan: [20.0, 12.0])
    refused = find_passage_problems(plan)
    assert ["longest seam (20 mm, minimum" in words for words in refused] == [True] * bool(winches)
