"""Oracles: `ContractionProfile.read`, which the command line plays with; and what was written, read again."""

from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.control import Key, Timeline
from hydrostat.control.timeline import MAX_BYTES
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile

KEYS = (
    Key(time=0.5, contractions={"left": 0.01}),
    Key(time=1.5, contractions={"left": 0.03, "feet": 0.02}),
    Key(time=3.0, contractions={}),
)


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return gallery_robot("starfish")


@pytest.mark.parametrize("smooth", [False, True])
def test_the_command_line_plays_what_the_studio_plays(starfish: Robot, tmp_path: Path, smooth: bool) -> None:
    timeline = Timeline(keys=KEYS, smooth=smooth)
    path = tmp_path / "contractions.csv"
    path.write_bytes(timeline.table(starfish))
    played, shown = (
        ContractionProfile.read(path, starfish),
        timeline.profile([winch.name for winch in starfish.winches]),
    )
    # a line of 20 ms in the place of 3 s^2 - 2 s^3 is off by at most h^2/8 times its curvature, 6 x 30 mm / s^2
    allowed = 0.02**2 / 8 * 6 * 0.03 + 1e-9
    for time in np.linspace(0.0, 4.0, 401):
        assert played.at(time) == pytest.approx(shown.at(time), abs=allowed)
    assert played.times[-1] == timeline.seconds


def test_what_was_exported_is_imported(starfish: Robot) -> None:
    timeline = Timeline.read(starfish, "mine.csv", Timeline(keys=KEYS, length=3.0).table(starfish))
    assert [key.time for key in timeline.keys] == pytest.approx([0.0, 1.0, 2.5])
    assert timeline.keys[1].contractions == pytest.approx({"right": 0.0, "left": 0.03, "feet": 0.02})
    assert timeline.seconds == pytest.approx(2.5)


def test_rows_that_lie_on_lines_are_left_out(starfish: Robot) -> None:
    rows = [f"{time:g},{10 * min(time, 1.0):.6f}" for time in np.linspace(0, 2, 201)]
    timeline = Timeline.read(starfish, "dense.csv", "\n".join(["time_s,left", *rows]).encode())
    assert [key.time for key in timeline.keys] == pytest.approx([0.0, 1.0, 2.0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"", "mine.csv, line 1: not a table of moves"),
        (b"time_s,tail\n0,1\n", 'mine.csv, line 1: unknown winch "tail"'),
        (b"time_s,left\n0,much\n", "mine.csv, line 2, column left: write a number"),
        (b"time_s,left\n0,1\n0,2\n", "mine.csv, line 3, column time_s: the times must rise"),
        (b"time_s,left\n0,1\n700,2\n", "mine.csv: it lasts 700 s"),
        (b"time_s,left\n0,nan\n", "mine.csv, line 2, column left: write a number"),
        (b"\xff\xfe\x00time", "mine.csv: is no text in UTF-8"),
        (b"time_s,left\n", "mine.csv: has no row"),
    ],
)
def test_a_wrong_table_is_refused_by_its_own_name(starfish: Robot, text: bytes, words: str) -> None:
    with pytest.raises(InputError) as caught:
        Timeline.read(starfish, "../../mine.csv", text)
    assert str(caught.value).startswith(words)


def test_a_huge_table_is_refused_unread(starfish: Robot) -> None:
    with pytest.raises(InputError, match="may have 4 MB"):
        Timeline.read(starfish, "huge.csv", b"0" * (MAX_BYTES + 1))


def test_nothing_to_export_is_told(starfish: Robot) -> None:
    with pytest.raises(InputError, match="no keyframes to export"):
        Timeline().table(starfish)
