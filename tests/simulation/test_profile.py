"""Contractions in time."""

from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.simulation import ContractionProfile, ProfileTable


def test_a_profile_goes_through_its_values() -> None:
    """Oracle: numpy.interp."""
    times, values = np.array([0.0, 0.5, 2.0]), np.array([[0.0, 0.0], [0.01, -0.004], [0.002, 0.0]])
    profile = hs.ContractionProfile(times=times, values=values)
    for time in (-1.0, 0.0, 0.2, 0.5, 1.7, 2.0, 9.0):
        expected = [np.interp(time, times, column) for column in values.T]
        assert profile.at(time) == pytest.approx(expected, abs=1e-15)
    one = hs.ContractionProfile(times=times[:1], values=values[1:2])
    assert (one.at(3.0) == values[1]).all()


def test_a_ramp_begins_and_ends_gently() -> None:
    """Oracle: 3 s^2 - 2 s^3, differences at both ends."""
    ramp = hs.ContractionProfile.ramp(np.array([0.01]), 2.0)
    assert ramp.at(1.0)[0] == pytest.approx(0.005)
    assert ramp.at(0.5)[0] == pytest.approx(0.01 * (3 / 16 - 2 / 64))
    assert ramp.at(0.002)[0] < 1e-7
    assert ramp.at(1.998)[0] > 0.01 - 1e-7


def test_a_table_is_read(tmp_path: Path) -> None:
    """Oracle: the numbers that stand in it."""
    path = tmp_path / "wave.csv"
    path.write_text("time_s, down\n0, 0\n0.5, 12\n\n1.5, 4.5\n")
    profile = ContractionProfile.read(path, strip_robot(columns=4, rows=2))
    assert profile.times.tolist() == [0.0, 0.5, 1.5]
    assert profile.values == pytest.approx(np.array([[0, 0], [0, 0.012], [0, 0.0045]]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "",
            "line 1: not a table of moves. Name the columns, each once: time_s and winches, as in time_s,up_mm,down_mm",
        ),
        ("down\n1\n", "line 1: not a table of moves"),
        ("#!/bin/sh\nplay ${ROBOT}\n", "time_s,up_mm,down_mm$"),
        ("run() {\n", "time_s,up_mm,down_mm$"),
        ("time_s,down,down\n0,1,1\n", "each once"),
        ("time_s;down\n0;1,5\n", "down_mm; commas part them, not semicolons"),
        ("time_s\tdown\n0\t1\n", "down_mm; commas part them, not tabs"),
        ('{"times": [0.0, 1.0]}', "down_mm; this is JSON: hydrostat trajectory writes trajectory.csv"),
        ("time_s,sideways\n0,1\n", 'line 1: unknown winch "sideways". Available: up, down.'),
        ("time_s,down\n0,1\n1,much\n", 'line 3, column down: write a number of millimeters, not "much"'),
        ("time_s,down\n0,1\n\nsoon,1\n", 'line 4, column time_s: write a number of seconds, not "soon"'),
        ("time_s,down\n0,1\n1\n", "line 3: write a number in each of the 2 columns, not 1 of them"),
        ("time_s,down\n0,1\n0,2\n", "line 3, column time_s: the times must rise from row to row; 0 comes after 0"),
        ("time_s,down\n0,1\n1,nan\n", 'line 3, column down: write a number of millimeters, not "nan"'),
        ("time_s,down\n1,-inf\n", 'line 2, column down: write a number of millimeters, not "-inf"'),
        ("time_s,down\n", "has no row of numbers"),
    ],
)
def test_a_table_that_is_none_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "wave.csv"
    path.write_text(text)
    with pytest.raises(hs.InputError, match=message) as refused:
        ContractionProfile.read(path, strip_robot(columns=4, rows=2))
    assert str(path) in str(refused.value)
    with pytest.raises(hs.InputError, match="there is no such file"):
        ContractionProfile.read(tmp_path / "none.csv", strip_robot(columns=4, rows=2))


def test_each_row_knows_its_line(tmp_path: Path) -> None:
    """Oracle: the lines counted by eye; line ends of all systems, a mark at the beginning, a line within quotes."""
    for end in ("\n", "\r\n", "\r"):
        text = end.join(["time_s,down", "0,0", "", "1,2", ' ,"', '"', "2,3"])
        table = ProfileTable.read(b"\xef\xbb\xbf" + text.encode(), strip_robot(columns=4, rows=2), name="wave.csv")
        assert table.lines == (2, 4, 7)
        assert table.profile.times.tolist() == [0.0, 1.0, 2.0]


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    robot = strip_robot(columns=4, rows=2)
    profile = hs.ContractionProfile(
        times=np.array([0.0, 0.25, 1.0]), values=np.array([[0.0, 0.01], [0.0123456, -0.0], [0.02, 0.0]])
    )
    path = profile.write(tmp_path / "way.csv", robot)
    assert path.read_text().splitlines()[:2] == ["time_s,up_mm,down_mm", "0,0,10"]
    again = ContractionProfile.read(path, robot)
    assert again.times == pytest.approx(profile.times)
    assert again.values == pytest.approx(profile.values, abs=1e-11)


def test_a_step_is_sudden(unchecked: None) -> None:
    """Oracle: the contractions before and after it; names and times below 0 get one line."""
    profile = ContractionProfile.step(np.array([0.01, 0.0]), begin=0.2)
    assert (profile.at(0.0)[0], profile.at(0.2)[0], profile.at(0.2 + 2e-6)[0], profile.at(9.0)[0]) == (0, 0, 0.01, 0.01)
    for make in (ContractionProfile.step, ContractionProfile.ramp):
        with pytest.raises(InputError, match=r"a profile needs an array: simulation.as_contractions"):
            make({"left": 0.01}, 1.0)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="begin must be"):
        ContractionProfile.step(np.array([0.01]), begin=-1.0)
