"""Files that commands make and change: comments, names, sizes, how parts are counted."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from hydrostat.cli.folders import note_others
from hydrostat.errors import in_words
from hydrostat.robot import comments, find_risks, load_robot

Run = Callable[..., tuple[int, str, str]]
WHALE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="160mm" viewBox="0 0 300 160"><path d="M20,90 '
    "C20,30 120,20 190,60 C220,75 240,70 260,40 L285,30 C285,60 275,80 262,90 C285,105 290,120 288,140 C265,135 "
    '250,120 240,108 C200,140 120,150 70,140 C35,130 20,115 20,90 Z"/></svg>'
)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("cable[0].points[2] turns by 40 degrees", "cable 1, point 3 turns by 40 degrees"),
        ("cable[1] between points 2 and 3 crosses cable[0]", "cable 2 between points 3 and 4 crosses cable 1"),
        ("winch[0] left: pulls no cable", "winch left: pulls no cable"),
        ("pin[0]: holds nothing; element_size[m]", "pin 1: holds nothing; element_size[m]"),
        ("line 13: pin[1].radius must be above 0", "line 13: pin 2, radius must be above 0"),
        ("obstacle[0]: the body stands in it", "obstacle 1: the body stands in it"),
        ("line 13: pin[0].radios: unknown key", "line 13: pin 1, radios: unknown key"),
        ("pose[0].targets.tip: must be finite", "pose 1, targets.tip: must be finite"),
        ("sheet[0]: overlaps sheet[1].", "sheet 1: overlaps sheet 2."),
        ("body.part[0].at: is outside", "part 1, at: is outside"),
        ('body.part[1] "bone": overlaps (cable[0])', 'part 2 "bone": overlaps (cable 1)'),
    ],
)
def test_parts_are_counted_from_one(said: str, words: str) -> None:
    assert in_words(said) == words


@pytest.mark.parametrize(
    "said",
    [
        "rod[1].dir: there is no such file. Begin a robot: hydrostat new 'rod[1].dir' --from gallery:starfish",
        "../rod[1]/winch[0].toml: there is no such file",
        "my.pin[0]: is a folder",
        'stands in "winch[0] left", not in "rod[1].at"',
        "'load[0]' is a folder",
    ],
)
def test_paths_and_quotes_stay(said: str) -> None:
    assert in_words(said) == said


def test_a_missing_folder_keeps_its_name(run: Run) -> None:
    code, _, err = run("check", "rod[1].dir")
    assert code == 2
    assert "hydrostat new 'rod[1].dir' " in err


def test_a_new_robot_is_commented_and_not_risky(run: Run, tmp_path: Path) -> None:
    """Oracle: the reader of comments, and the risks themselves."""
    (tmp_path / "whale.svg").write_text(WHALE)
    code, out, _ = run("new", tmp_path / "moby", "--from", tmp_path / "whale.svg")
    assert code == 0
    assert "risky" not in out
    robot = load_robot(tmp_path / "moby")
    assert find_risks(robot) == []
    told = comments((tmp_path / "moby" / "robot.toml").read_text())
    assert told[0] == "# moby, made from whale.svg. Change anything."
    assert sum(line.startswith(("# The body", "# The pin", "# Markers", "# A pose")) for line in told) == 4
    assert "# [[winch]]" in told


def test_a_robot_of_the_gallery_gets_its_new_name(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Its comments stay."""
    assert run("new", tmp_path / "mine", "--from", "gallery:starfish")[0] == 0
    text = (tmp_path / "mine" / "robot.toml").read_text()
    assert tomllib.loads(text)["name"] == "mine"
    assert text == (starfish / "robot.toml").read_text().replace('name = "starfish"', 'name = "mine"')


def test_a_robot_is_scaled_in_its_file(run: Run, tmp_path: Path) -> None:
    run("new", tmp_path / "mine", "--from", "gallery:starfish")
    before = (tmp_path / "mine" / "robot.toml").read_text()
    code, out, _ = run("scale", tmp_path / "mine", "1.5")
    assert code == 0
    assert "279 mm to 419 mm" in out
    after = (tmp_path / "mine" / "robot.toml").read_text()
    assert comments(after) == comments(before)
    assert 'size = "420 mm"' in after
    assert "studio.json" not in out
    assert run("scale", tmp_path / "mine", "2", "--out", tmp_path / "big")[0] == 0
    assert 'size = "840 mm"' in (tmp_path / "big" / "robot.toml").read_text()
    (tmp_path / "mine" / "studio.json").write_text("{}")
    assert "note: keyframes and limits in studio.json are not scaled" in run("scale", tmp_path / "mine", "1.1")[1]
    for factor, words in (("x", "not a number"), ("0", "must be from 0.01 to 100")):
        code, _, errors = run("scale", tmp_path / "mine", factor)
        assert (code, errors.count("\n")) == (2, 1)
        assert words in errors


def test_columns_of_moves_tell_their_unit(starfish: Path) -> None:
    """Written with it, read with and without."""
    import numpy as np

    from hydrostat.simulation import ContractionProfile, ProfileTable

    robot = load_robot(starfish)
    profile = ContractionProfile(times=np.array([0.0, 1.0]), values=np.array([[0.0, 0.0, 0.0], [0.01, 0.02, 0.0]]))
    text = profile.text(robot)
    assert text.splitlines()[0] == b"time_s,right_mm,left_mm,feet_mm"
    for content in (text, text.replace(b"_mm", b"")):
        np.testing.assert_array_equal(ProfileTable.read(content, robot, name="a.csv").profile.values, profile.values)


@pytest.mark.parametrize(("answer", "holes"), [("y\n", 0), ("n\n", 1)])
def test_at_a_terminal_it_asks_what_an_eye_is(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: str, holes: int
) -> None:
    import io
    import sys

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    (tmp_path / "whale.svg").write_text(WHALE.replace("</svg>", '<circle cx="70" cy="80" r="6"/></svg>'))
    monkeypatch.setattr(sys, "stdin", Terminal(answer))
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    code, out, _ = run("new", tmp_path / "moby", "--from", tmp_path / "whale.svg")
    assert code == 0
    assert "1 closed shape inside the body" in out
    outline = load_robot(tmp_path / "moby").body.outline
    assert outline is not None
    assert len(outline.rings) == 1 + holes


def test_robots_of_the_gallery_are_read_by_their_names_and_not_written(run: Run, tmp_path: Path) -> None:
    code, out, err = run("sample", "gallery:letter_e", "--count", 2, "--jobs", 1, "--out", tmp_path / "samples")
    assert (code, err) == (0, "samples: 2 of 2\n")
    assert "2 of 2 samples" in out
    code, _, err = run("train", "gallery:nobody", "--out", tmp_path / "policy")
    assert code == 2
    assert 'unknown gallery robot "nobody". Available: bear, ' in err
    for command in (("scale", "gallery:starfish", 2), ("calibrate", "gallery:starfish", "--motors", "emulated")):
        code, _, err = run(*command)
        assert code == 2
        assert "hydrostat new my_starfish --from gallery:starfish" in err


def test_a_folder_is_not_named_like_a_file(run: Run, tmp_path: Path) -> None:
    code, _, err = run("animate", "gallery:starfish", "--out", tmp_path / "film.gif")
    assert (code, "film.gif: .gif is the ending of a file. Name a folder" in err) == (2, True)
    assert not (tmp_path / "film.gif").exists()


def test_files_of_others_in_an_output_folder_are_noted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    note_others(tmp_path, ("score.json",))
    (tmp_path / "letter.txt").touch()
    note_others(tmp_path, ("score.json",))
    assert capsys.readouterr().err == f"note: {tmp_path} holds other files (1). They stay\n"
    (tmp_path / "score.json").touch()
    note_others(tmp_path, ("score.json",))
    assert capsys.readouterr().err == ""
