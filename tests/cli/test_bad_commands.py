"""Bad input ends with code 2 and one clear line; oracle: exit code, one line, no traceback, nothing written."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partialmethod
from pathlib import Path

import pytest
from builders import strip_robot

from hydrostat.cli.options import check_contraction, loads
from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonOptions
from hydrostat.simulation import Simulation

Run = Callable[..., tuple[int, str, str]]


OPEN = b'<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm">'
OPEN += b'<path fill="none" stroke="red" d="M0 0H60V40"/></svg>'


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (("check", "nowhere"), ("nowhere", "no such file")),
        (
            ("studio", "http://127.0.0.1/#robot=AAAA", "--rooms"),
            ("--rooms, --class: not available with a link.",),
        ),
        (("studio", "--new-code"), ("--new-code: only a class has a code.", "Add --class.")),
        (("simulate", "STARFISH", "--contract", "left=12", "--out", "OUT"), ("left=12", "no unit")),
        (
            ("simulate", "STARFISH", "--contract", "left=2mm", "--contract", "left=3mm", "--out", "OUT"),
            ("left", "twice"),
        ),
        (("simulate", "STARFISH", "--pull", "left=2N", "--pull", "left=3N", "--out", "OUT"), ("left", "twice")),
        (("simulate", "STARFISH", "--pull", "left=-3N", "--out", "OUT"), ("--pull left=-3N", "only pulls")),
        (("simulate", "STARFISH", "--contract", "left", "--out", "OUT"), ("WINCH=LENGTH",)),
        (("simulate", "STARFISH", "--contract", "up=12mm", "--out", "OUT"), ('"up"', "right, left, feet")),
        (("pose", "STARFISH", "--pose", "dance", "--out", "OUT"), ("--pose dance: unknown", "wave")),
        (("animate", "STARFISH", "--pose", "dance", "--out", "OUT"), ("--pose dance: unknown", "wave")),
        (("trajectory", "STARFISH", "--poses", "dance", "--out", "OUT"), ("--poses dance: unknown", "wave")),
        (("design", "STARFISH", "--pose", "dance", "--out", "OUT"), ("--pose dance: unknown", "wave")),
        (("design", "STARFISH", "--winches", "0", "--out", "OUT"), ("--winches must be a whole number", "not 0")),
        (("simulate", "STARFISH", "--duration", "1s", "--out", "OUT"), ("error: --duration: needs --dynamic",)),
        (("simulate", "STARFISH", "--contract", "left=500mm", "--out", "OUT"), ("takes in the whole cable",)),
        (("animate", "STARFISH", "--format", "avi", "--out", "OUT"), ("error: --format: 'avi' is not one of",)),
        (("grasp", "STARFISH", "--object", "sphere:3", "--out", "OUT"), ("--object sphere:3:", "no unit")),
        (("grasp", "STARFISH", "--friction", "-1", "--out", "OUT"), ("--friction must be from 0 to 3",)),
        (
            ("design", "STARFISH", "--winches", "3", "--cables", "2", "--method", "trees", "--out", "OUT"),
            ("3 winches", "3 cables", "got 2"),
        ),
        (("design", "STARFISH", "--fibres", "hairs", "--out", "OUT"), ("hairs", "edges", "elements")),
        (("export", "gallery:emio", "--mjcf", "--out", "OUT"), ('drives, such as "front",', "and it has no cables.")),
        (("animate", "gallery:emio", "--out", "OUT"), ('drives, such as "front", are not available in films,',)),
        (("new", "OUT", "--from", "gallery:whale"), ("whale", "starfish")),
        (("new", "OUT", "--from", "drawing.bmp"), ("drawing.bmp", ".svg", ".stl", ".vtu")),
        (("new", "OUT", "--from", "missing.svg"), ("missing.svg", "no such file")),
        (("new", "OUT", "--from", "OPEN", "--size", "90"), ("--size", "no unit")),
        (("new", "OUT", "--from", "OPEN"), ("open.svg", "open")),
        (("new", "STARFISH", "--from", "gallery:pig"), ("already exists",)),
    ],
)
def test_one_clear_line(
    run: Run, starfish: Path, tmp_path: Path, arguments: tuple[str, ...], fragments: tuple[str, ...]
) -> None:
    drawing = tmp_path / "open.svg"
    drawing.write_bytes(OPEN)
    places = {"STARFISH": starfish, "OUT": tmp_path / "out", "OPEN": drawing}
    code, out, err = run(*(places.get(argument, argument) for argument in arguments))
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("hydrostat: error: ")
    for fragment in fragments:
        assert fragment in err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_robot_that_cannot_be_cut_is_refused_with_the_reason(run: Run, starfish: Path, tmp_path: Path) -> None:
    folder = tmp_path / "bad"
    assert run("new", folder, "--from", "gallery:starfish")[0] == 0
    text = (folder / "robot.toml").read_text()
    (folder / "robot.toml").write_text(text.replace('element_size = "12 mm"', 'element_size = "12 bananas"'))
    code, _, err = run("check", folder)
    assert code == 2
    assert "line" in err
    assert "element_size" in err
    assert "bananas" in err


def test_a_file_in_the_way_of_the_results_is_told_before_the_work(run: Run, starfish: Path, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    for command in ("simulate", "pose", "design", "fabricate"):
        code, _, err = run(command, starfish, "--out", tmp_path / "out")
        assert code == 2
        assert "is a file" in err
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.slow
def test_a_solve_that_does_not_converge_ends_with_code_1(
    run: Run, starfish: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: Newton allowed no iteration; pose.json says that it is no equilibrium, and no fields show one."""
    (tmp_path / "pose.vtu").write_text("of an earlier pose")
    monkeypatch.setattr(Simulation, "__init__", partialmethod(Simulation.__init__, options=NewtonOptions(iterations=0)))
    code, out, _ = run("simulate", starfish, "--contract", "left=12mm", "--out", tmp_path)
    assert code == 1
    assert "iteration limit" in out
    facts = json.loads((tmp_path / "pose.json").read_text())
    assert (facts["converged"], facts["status"]) == (False, "iteration limit reached")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pose.json", "pose.png"]


@pytest.mark.slow
def test_a_pose_that_is_not_found_in_time_tells_what_is_in_the_way(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, out, _ = run("simulate", starfish, "--contract", "left=12mm", "--timeout", "0.001ms", "--out", tmp_path)
    assert code == 1
    assert "time limit reached" in out
    assert "not converged: highest tension" in out
    code, _, err = run("simulate", starfish, "--dynamic", "--timeout", "1s", "--out", tmp_path)
    assert code == 2
    assert "--timeout" in err


def test_no_command_takes_in_all_of_a_cable() -> None:
    """Oracle: a cable of 180 mm on a spool of its own, 2.5 times as large."""
    robot = strip_robot()
    winches = [replace(robot.winches[0], travel=0.3), robot.winches[1]]
    robot = robot.with_network(winches, [replace(robot.cables[0], spool_radius=0.015), robot.cables[1]])
    check_contraction(robot, "up", 0.0719)
    with pytest.raises(InputError, match=r"up: 72.1 mm at spool ratio 2.5 takes in the whole cable \(180 mm\)"):
        check_contraction(robot, "up", 0.0721)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("tip=-0.3N", "a single force has no direction"),
        ("tip=0,-0.3", "missing unit"),
        ("tip=0N,-0.3", "missing unit"),
        ("tip=0,0,-1N", "3 values for a body with 2 axes"),
        ("tip=0,-1g", '"g" does not measure a force'),
        ("tip=,-1N", '" N" is not a force'),
        ("tip=5", '"5" has no unit'),
        ("tip=-5g", "a mass must be above 0"),
    ],
)
def test_a_load_that_is_none_is_told_with_its_right_form(text: str, told: str) -> None:
    right = "Write one force for each axis, e.g. tip=0,-1N, or a mass, e.g. tip=100g."
    with pytest.raises(InputError) as caught:
        loads(strip_robot(), [text])
    assert str(caught.value) == f"--load {text}: {told}. {right}"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("tip=moment", 'missing unit. Write "tip=moment 0.01Nm".'),
        ("tip=moment 0,0,1Nm", '3 values for a moment with 1 component. Write "tip=moment 0.01Nm".'),
        ("tip=moment 1N", '"N" does not measure a torque. Write "tip=moment 0.01Nm".'),
        ("tip=moment 0Nm", "moment must not be 0; remove this load"),
    ],
)
def test_a_moment_that_is_none(text: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        loads(strip_robot(), [text])
    assert str(caught.value) == f"--load {text}: {told}"


def test_loads_are_read_in_their_units() -> None:
    robot = loads(strip_robot(), ["tip=0,-300mN", "tip=1e-1,0N", "tip=1 N,-200 mN", "tip=moment -10Nmm"])
    assert [load.force for load in robot.loads] == [(0.0, -0.3), (0.1, 0.0), (1.0, -0.2), None]
    assert robot.loads[-1].moment == (-0.01,)
