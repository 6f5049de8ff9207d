"""Whatever becomes of a robot.toml, it loads or is refused in one line."""

import re
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from robot_files import GOOD, MAXIMAL_IN, mesh_once, robot_folder

from hydrostat.errors import InputError
from hydrostat.robot import Robot, load_robot, robot_text

SEEDS = [GOOD, MAXIMAL_IN["in"]]
ODD = [
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "=",
    '"',
    "'",
    "\\",
    ",",
    ".",
    "#",
    "'" * 3,
    '"' * 3,
    "\0",
    "\ufeff",
    "\u202e",
    "\r",
]
ODD += [
    "0",
    "-1",
    "1e9",
    "1e-9",
    "1e400",
    "nan",
    "-inf",
    "true",
    "0x10",
    "1979-05-27",
    "07:32:00",
    "[]",
    "[0]",
    "[0,0,0]",
]
ODD += [
    '""',
    '"x"',
    '"5"',
    '"1 mm"',
    '"-1 kPa"',
    '"0 mm"',
    '"\\u0000"',
    "{}",
    "{a=1}",
    "a.b.c",
    "[body]",
    "[[pin]]",
    "at",
]
ODD += ["[pose.targets]", "size", "mesh", "surface", "friction"]
ODD += ["gravity", '"-y"', '"1 m/s^2"', "viscosity", '"1 Pa s"', "relaxation", "modulus", "time", '"2 s"', "volume"]
ODD += ["face", '"pairs"']
TOKEN = re.compile(r"\"[^\"\n]*\"|[\w.+-]+|\s+|.")


@st.composite
def spoiled(draw: st.DrawFn) -> str:
    """A good text of which some tokens are deleted, doubled, swapped or replaced, or the rest is cut off."""
    tokens = TOKEN.findall(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(tokens) - 1))
        match draw(st.sampled_from(["delete", "double", "swap", "replace", "odd", "cut"])):
            case "delete":
                tokens[place] = ""
            case "double":
                tokens[place] *= 2
            case "swap":
                other = draw(st.integers(0, len(tokens) - 1))
                tokens[place], tokens[other] = tokens[other], tokens[place]
            case "replace":
                tokens[place] = draw(st.sampled_from(tokens))
            case "odd":
                tokens[place] = draw(st.sampled_from(ODD) | st.text(max_size=5))
            case "cut" if place:
                tokens = tokens[:place]
    return "".join(tokens)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        mesh_once(patch)
        yield robot_folder(tmp_path_factory.mktemp("fuzz"))


@settings(max_examples=300, deadline=60_000, suppress_health_check=list(HealthCheck), derandomize=True)
@given(text=spoiled())
@example(text=GOOD)
@example(text=MAXIMAL_IN["in"])
@pytest.mark.slow
def test_spoiled_text(text: str, folder: Path) -> None:
    """Oracle: a robot that can be written again, or one printable line that names the file; within seconds."""
    (folder / "robot.toml").write_bytes(text.encode("utf-8", errors="surrogatepass"))
    try:
        robot = load_robot(folder)
    except InputError as error:
        line = str(error)
        assert line.isprintable()
        assert line.startswith(f"{folder}/robot.toml")
        assert len(line) < 600
        number = re.search(r"robot.toml, line (\d+)", line)
        assert number is None or 1 <= int(number[1]) <= text.count("\n") + 1
    else:
        assert isinstance(robot, Robot)
        assert robot_text(robot)


@pytest.mark.slow
def test_memory(folder: Path) -> None:
    """Oracle: the most that was held while reading numbers stays below 400 bytes for each of their characters."""
    text = "points = [" + ",".join(["[1,2]"] * 20_000) + "]"
    (folder / "robot.toml").write_text(text)
    tracemalloc.start()
    with pytest.raises(InputError, match="unknown key"):
        load_robot(folder)
    assert tracemalloc.get_traced_memory()[1] < 400 * len(text)
    tracemalloc.stop()
