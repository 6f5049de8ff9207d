"""`hydrostat animate`; oracle: the library called directly, and what Pillow and the files say."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot
from PIL import Image

import hydrostat as hs
from hydrostat.robot import save_robot

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_a_pose_and_back(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the time of all frames; the last target of the scene is the pose that inverse kinematics finds."""
    options = ("--pose", "wave", "--seconds", "1", "--width", "240", "--out", tmp_path / "out")
    code, out, _ = run("animate", starfish, *options)
    assert code == 0
    assert "wave: rms error" in out
    assert "12 frames, 1 s: rest, wave, rest" in out
    with Image.open(tmp_path / "out" / "animation.gif") as image:
        times = []
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            times.append(image.info["duration"])
    assert sum(times) == 1000
    whole = (tmp_path / "out" / "animation.glb").read_bytes()
    length = int(np.frombuffer(whole, "<u4", 1, 12)[0])
    document = json.loads(whole[20 : 20 + length])
    robot = hs.load_robot(starfish)
    reached = hs.solve_ik(hs.Simulation(robot), robot.poses["wave"]).pose.nodes
    bounds = [
        (document["accessors"][target["POSITION"]]["min"], document["accessors"][target["POSITION"]]["max"])
        for target in document["meshes"][0]["primitives"][0]["targets"]
    ]
    moved = reached - robot.body.mesh.nodes
    off = [np.abs(np.array(low)[:2] - moved[robot.body.mesh.boundary_nodes].min(axis=0)).max() for low, _ in bounds]
    assert min(off) < 1e-4


def test_without_poses_one_winch_after_the_other(run: Run, tmp_path: Path) -> None:
    """Oracle: as many stops as winches."""
    folder = tmp_path / "strip"
    save_strip(folder)
    code, out, _ = run("animate", folder, "--seconds", "1.2", "--format", "glb", "--out", tmp_path / "out")
    assert code == 0
    assert "rest, up 30 mm, down 30 mm, rest" in out
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["animation.glb"]


def save_strip(folder: Path) -> None:
    from dataclasses import replace

    from hydrostat.geometry import write_vtu

    folder.mkdir()
    robot = strip_robot(columns=8, rows=2)
    file = folder / "strip.vtu"
    file.write_bytes(write_vtu(robot.body.mesh, robot.body.mesh.nodes, {}))
    body = replace(robot.body, file=file.name, content=file.read_bytes())
    save_robot(replace(robot, body=body, length_unit="m"), folder)


@pytest.mark.parametrize(
    ("options", "fragments"),
    [
        (("--pose", "none"), ("none", "wave")),
        (("--seconds", "0"), ("--seconds 0", "above 0")),
        (("--seconds", "61"), ("--seconds 61", "60")),
        (("--seconds", "nan"), ("--seconds nan",)),
        (("--seconds", "0.2", "--pose", "wave"), ("too short", "at least")),
        (("--width", "5"), ("--width 5", "160")),
        (("--format", "mp4"), ("ffmpeg", "apt-get install ffmpeg")),
    ],
)
def test_one_clear_line(
    run: Run,
    starfish: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: tuple[str, ...],
    fragments: tuple[str, ...],
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    code, _, err = run("animate", starfish, *options, "--out", tmp_path / "out")
    assert code == 2
    last = err.strip().splitlines()[-1]
    assert last.startswith("hydrostat: error: ")
    for fragment in fragments:
        assert fragment in last
    assert not (tmp_path / "out").exists()
