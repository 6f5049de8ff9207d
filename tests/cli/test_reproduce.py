"""`hydrostat reproduce` passes its arguments on to the laboratory. Oracles: its help and errors, a path without it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from hydrostat.cli import reproduce as entry

Run = Callable[..., tuple[int, str, str]]


def test_help_is_that_of_the_laboratory(run: Run) -> None:
    code, out, _ = run("reproduce", "--help")
    assert code == 0
    assert "hydrostat reproduce [OPTIONS] {TABLE...}..." in out
    assert "--seeds" in out


def test_errors_of_the_laboratory_arrive(run: Run, tmp_path: Path) -> None:
    code, _, words = run("reproduce", "table-9", "--out", tmp_path)
    assert code == 2
    assert words.startswith('hydrostat: error: unknown table or figure "table-9". Available: all, table-5.1,')
    code, _, words = run("reproduce", "table-5.1")
    assert code == 2
    assert "Missing option '--out'" in words


def test_without_the_laboratory_one_line_says_where_to_get_it(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(entry, "find_spec", lambda name: None)
    monkeypatch.setattr(entry, "LAB", tmp_path)
    code, _, words = run("reproduce", "all", "--out", tmp_path)
    assert code == 1
    assert words == (
        "hydrostat: error: package hydrostat-lab not found. Clone hydrostat and run: pip install --editable lab\n"
    )
