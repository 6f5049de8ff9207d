"""`hydrostat measure` and `compare` without photographs. Oracle: the files, and what is missing."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from pypdf import PdfReader

from hydrostat.cli.compare import read_pose
from hydrostat.robot import load_robot

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_tags_are_printed_with_their_names(run: Run, tmp_path: Path, starfish: Path) -> None:
    file = tmp_path / "tags.pdf"
    assert run("measure", starfish, "--print", file, "--paper", "letter")[0] == 0
    pages = PdfReader(file).pages
    assert len(pages) == 6
    assert [float(side) for side in pages[0].mediabox[2:]] == pytest.approx([612, 792], abs=0.5)
    words = pages[-1].extract_text()
    assert all(name in words for name in ("top", "left_foot", "right_foot"))
    code, _, err = run("measure", starfish, "--print", file, "--tag", "2mm")
    assert (code, "must be 4 to 80 mm" in err) == (2, True)


def test_a_missing_extra_is_named(run: Run, tmp_path: Path, starfish: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    (tmp_path / "rest.jpg").touch()
    for command, *more in (("measure", "--out", tmp_path / "a.csv"), ("compare", "--out", tmp_path / "a")):
        code, _, err = run(command, starfish, tmp_path / "rest.jpg", *more)
        assert code == 2
        assert err.startswith("hydrostat: error: photographs need OpenCV")
        assert "[photos]" in err
        assert err.count("\n") == 1


def test_measure_says_what_it_needs(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, _, err = run("measure", starfish)
    assert (code, "give --out TABLE.csv" in err) == (2, True)
    code, _, err = run("measure", starfish, "--out", tmp_path / "a.csv")
    assert (code, "no photographs" in err) == (2, True)
    code, _, err = run("measure", starfish, "--print", tmp_path / "tags.txt")
    assert (code, "tags.txt: must end in .pdf" in err) == (2, True)
    code, _, err = run("measure", starfish, tmp_path / "b.jpg", "--out", tmp_path / "a.csv")
    assert (code, err) == (2, f"hydrostat: error: {tmp_path / 'b.jpg'}: there is no such file\n")
    for name in ("a.MP4", "a.mp4", "b.jpg", "wing=3mm.jpg"):
        (tmp_path / name).touch()
    code, _, err = run("compare", starfish, tmp_path / "wing=3mm.jpg", "--out", tmp_path / "compared")
    assert (code, 'wing=3mm.jpg: unknown winch "wing"' in err) == (2, True)
    code, _, err = run("measure", starfish, tmp_path / "a.MP4", "--out", tmp_path / "a.csv")
    assert (code, "a film needs --table with the moves that were played" in err) == (2, True)
    code, _, err = run("measure", starfish, tmp_path / "a.mp4", tmp_path / "b.jpg", "--out", tmp_path / "a.csv")
    assert (code, "measure one film at a time" in err) == (2, True)


def test_options_of_compare_replace_their_part_of_the_name_alone(starfish: Path) -> None:
    """The name holds a contraction and a mass. Oracle: what the options do not give stays."""
    robot = load_robot(starfish)
    marker, winch = robot.markers[0].name, robot.winches[0].name
    file = Path(f"{winch}=12mm,{marker}=50g.jpg")
    loaded = read_pose(robot, file, load=[f"{marker}=0,-1N"])
    assert loaded.contractions == {winch: 0.012}
    assert [load.force for load in loaded.loads_of_pose] == [(0.0, -1.0)]
    pulled = read_pose(robot, file, contract=[f"{winch}=5mm"])
    assert (pulled.contractions, pulled.masses) == ({winch: 0.005}, {marker: 0.05})
    assert read_pose(robot, Path("photo.jpg")).contractions == {}
    assert read_pose(robot, Path("photo_v=2.jpg"), contract=[f"{winch}=5mm"]).contractions == {winch: 0.005}
