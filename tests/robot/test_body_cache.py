"""The cache of bodies: the same bytes with and without it, whatever lies in its folder."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrostat import geometry
from hydrostat.robot import Body, inflated_robot, load_robot
from hydrostat.robot.body_cache import keep_body

STARFISH = Path(__file__).parents[2] / "examples" / "starfish"
FINGER = Path(__file__).parents[2] / "examples" / "caging_gripper"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("HYDROSTAT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def _numbers(body: Body) -> list[bytes]:
    arrays = [body.mesh.nodes, body.mesh.elements, *body.marks]
    if body.outline is not None:
        arrays += body.outline.rings
    if body.healing is not None:
        arrays += [body.healing.surface.vertices, body.healing.surface.triangles]
    return [np.ascontiguousarray(array).tobytes() for array in arrays]


@pytest.mark.parametrize("robot", [STARFISH, FINGER])
def test_a_kept_body_is_the_same_body(robot: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the same robot read without a cache."""
    first, again = load_robot(robot).body, load_robot(robot).body
    assert len(list(folder.iterdir())) == 1
    monkeypatch.setenv("HYDROSTAT_CACHE", "")
    alone = load_robot(robot).body
    assert _numbers(first) == _numbers(again) == _numbers(alone)
    if alone.healing is not None:
        assert again.healing is not None
        assert again.healing.lines() == alone.healing.lines()
        assert again.healing.removed == alone.healing.removed


def test_a_kept_body_is_not_meshed_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a mesher that fails."""
    load_robot(STARFISH)
    monkeypatch.setattr(geometry, "triangulate", None)
    load_robot(STARFISH)
    monkeypatch.setenv("HYDROSTAT_CACHE", "")
    with pytest.raises(TypeError):
        load_robot(STARFISH)


@pytest.mark.slow
def test_a_kept_inflated_body_is_the_same_and_not_made_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the first one, which was made, and an inflation that fails."""
    robot = load_robot(STARFISH)
    first = inflated_robot(robot)
    monkeypatch.setattr(geometry, "inflate", None)
    assert _numbers(inflated_robot(robot).body) == _numbers(first.body)
    with pytest.raises(TypeError):
        inflated_robot(replace(robot, body=replace(robot.body, thickness=0.02)))


@pytest.mark.parametrize("damage", ["empty", "cut", "flipped"])
def test_a_damaged_entry_is_made_again(damage: str, folder: Path) -> None:
    """Oracle: the body before."""
    before = _numbers(load_robot(STARFISH).body)
    (entry,) = folder.iterdir()
    data = bytearray(entry.read_bytes())
    whole = bytes(data)
    data[len(data) // 2] ^= 1
    entry.write_bytes({"empty": b"", "cut": whole[:-100], "flipped": bytes(data)}[damage])
    assert _numbers(load_robot(STARFISH).body) == before
    assert entry.read_bytes() == whole


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a folder that is a file."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("HYDROSTAT_CACHE", str(tmp_path / "file" / "cache"))
    load_robot(STARFISH)
    assert (tmp_path / "file").read_text() == ""


def test_the_entries_read_longest_ago_make_room(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a bound that holds two entries of three."""
    arrays = {"numbers": np.zeros(1000)}
    keep_body(("size",), b"", lambda: arrays)
    (entry,) = folder.iterdir()
    monkeypatch.setattr("hydrostat.robot.body_cache.MAX_BYTES", int(2.5 * entry.stat().st_size))
    os.utime(entry, (1, 1))
    for number in range(2):
        keep_body((number,), b"", lambda: arrays)
    assert len(list(folder.iterdir())) == 2
    assert not entry.exists()


def test_two_processes_share_a_cache(folder: Path) -> None:
    """Oracle: both read the same body, and nothing half-written is left."""
    code = "import sys, hydrostat; print(hydrostat.load_robot(sys.argv[1]).body.mesh.nodes.sum().hex())"
    command = [sys.executable, "-c", code, str(STARFISH)]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    sums = {process.communicate()[0] for process in running}
    assert len(sums) == 1
    assert [file.suffix for file in folder.iterdir()] == [".npz"]
