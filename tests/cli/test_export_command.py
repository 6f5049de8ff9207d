"""`hydrostat export`: files that other programs read; tests/export has what is in them."""

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

Run = Callable[..., tuple[int, str, str]]


def test_export_writes_both_files(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, out, _ = run("export", starfish, "--mjcf", "--usd", "--trials", "0", "--out", tmp_path / "made")
    assert code == 0
    assert "MuJoCo model: error not measured" in out
    assert "error not measured" in (tmp_path / "made" / "robot.xml").read_text()
    assert ElementTree.parse(tmp_path / "made" / "robot.xml").getroot().get("model") == "starfish"
    assert (tmp_path / "made" / "robot.usda").read_text().startswith("#usda 1.0")


def test_export_needs_a_format_and_parts_that_it_can_write(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, _, told = run("export", starfish, "--out", tmp_path / "made")
    assert (code, told) == (2, "hydrostat: error: export needs --mjcf or --usd, or both\n")
    code, _, told = run("export", "gallery:spine", "--mjcf", "--out", tmp_path / "made")
    assert code == 2
    assert "not available in MJCF. Remove it." in told
    assert not (tmp_path / "made").exists()
