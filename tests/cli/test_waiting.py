"""Words while a person waits. Oracle: what has been printed when the work ends."""

import time

import pytest

from hydrostat.cli.waiting import patiently


def test_what_takes_long_is_told_and_what_is_quick_is_not(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with patiently("quick ..."):
        pass
    monkeypatch.setattr("hydrostat.cli.waiting.PATIENCE", 0.01)
    told, end = "", time.monotonic() + 60.0
    with patiently("long ..."):
        while not told and time.monotonic() < end:
            time.sleep(0.01)
            told = capsys.readouterr().out
    assert told == "long ...\n"
