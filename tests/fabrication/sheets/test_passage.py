"""Winches that are too large for the zipper."""

from dataclasses import replace

import pytest
from kit_plans import FewParts
from sheet_inputs import plush

from hydrostat.fabrication import MOTORS, PartOptions
from hydrostat.fabrication.parts.winch_unit import winch_units
from hydrostat.fabrication.sheets.steps import plush_steps


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
