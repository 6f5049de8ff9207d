"""Words while a person waits. Oracle: what has been printed when the work ends."""

import time

import pytest

from hydrostat.cli import waiting
from hydrostat.cli.waiting import patiently, progress_bar, report_progress


def test_what_takes_long_is_told_and_what_is_quick_is_not(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with patiently("quick ..."):
        pass
    monkeypatch.setattr("hydrostat.cli.waiting.NOTICE_DELAY", 0.01)
    told, end = "", time.monotonic() + 60.0
    with patiently("long ..."):
        while not told and time.monotonic() < end:
            time.sleep(0.01)
            told = capsys.readouterr().out
    assert told == "long ...\n"


def test_a_stage_that_comes_again_has_a_clock_of_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Oracle, by hand: ten in ten seconds; a hundred seconds later five of ten in one second, so one is left."""
    now = [0.0]
    monkeypatch.setattr(waiting.time, "monotonic", lambda: now[0])
    tell = report_progress()
    for at, done in ((0.0, 0), (10.0, 10), (110.0, 0), (111.0, 5), (131.0, 10)):
        now[0] = at
        tell("poses", done, 10)
    assert "poses: 10 of 10, 1/s" in (words := capsys.readouterr().err)
    assert words.endswith("poses: 10 of 10, 0.476/s\n")


def test_a_log_has_one_line_for_each_stage(capsys: pytest.CaptureFixture[str]) -> None:
    """Oracle: two stages, one of which comes three times."""
    with progress_bar() as progress:
        for stage, done in (("Drawing", 0), ("Drawing", 2), ("Refining", 1), ("Drawing", 0), ("Drawing", 2)):
            progress(stage, done, 2)
    assert capsys.readouterr().err == "Drawing ...\nRefining ...\n"
