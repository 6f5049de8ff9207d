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
    code, _, words = run("reproduce", "figure-5.4", "--methods", "search", "--out", tmp_path)
    assert (code, words) == (
        2,
        "hydrostat: error: --methods search: figures 5.3 and 5.4 show thesis and search. Add them.\n",
    )
    code, _, words = run("reproduce", "table-5.1", "--methods", "magic", "--out", tmp_path)
    assert code == 2
    assert words.startswith('hydrostat: error: unknown method "magic". Available: constant,')
    code, _, words = run("reproduce", "table-5.1")
    assert code == 2
    assert "Missing option '--out'" in words


def test_all_tables_are_listed(run: Run) -> None:
    """Oracle: the choices that an unknown name is told."""
    code, out, _ = run("reproduce", "list")
    assert code == 0
    _, _, words = run("reproduce", "table-9")
    for name in words.split("Available: all, ")[1].strip(". \n").split(", "):
        assert f"\n  {name} " in out
    assert "benchmarks/simulate.py" in out


def test_a_missing_package_is_named_before_anything_is_sampled(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run("reproduce", "list")  # the laboratory can be imported from now on
    monkeypatch.setattr("hydrostat_lab.catalog.find_spec", lambda name: None)
    code, _, words = run("reproduce", "table-5.1", "--out", tmp_path / "out")
    assert code == 2
    assert words.startswith("hydrostat: error: table-5.1: package torch not found. Install it: pip install")
    assert not (tmp_path / "out").exists()


def test_without_the_laboratory_one_line_says_where_to_get_it(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(entry, "find_spec", lambda name: None)
    monkeypatch.setattr(entry, "LAB", tmp_path)
    code, _, words = run("reproduce", "all", "--out", tmp_path)
    assert code == 2
    assert words == (
        "hydrostat: error: package hydrostat-lab not found. Clone hydrostat and run: pip install --editable lab\n"
    )
