"""`hydrostat mimic`, and driving by what it has learned. Oracles: files read back, an emulated person, exit codes."""

import csv
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from own_time import PROGRAM

Run = Callable[..., tuple[int, str, str]]


def rows(out: Path) -> list[list[str]]:
    with (out / "poses.csv").open() as file:
        return list(csv.reader(file))


@pytest.mark.slow
def test_a_lesson_with_an_emulated_glove_and_a_drive_by_it(run: Run, starfish: Path, tmp_path: Path) -> None:
    out = tmp_path / "glove"
    code, told, err = run("mimic", starfish, "--glove", "emulated", "--out", out, "--count", 4)
    assert (code, err) == (0, "")
    assert len(rows(out)) == 1 + 4
    assert rows(out)[0][:2] == ["pose", "time_s"]
    assert rows(out)[0][-3:] == ["right", "left", "feet"]
    assert re.search(
        r"simulated: 4 poses; cross-validation error: leave-one-out \d+\.\d+ mm \(\d\.\d+\), five-fold .*from -1 to 1",
        told,
    )
    assert json.loads((out / "map.json").read_text())["poses"] == 4
    code, told, err = run("mimic", starfish, "--glove", "emulated", "--out", out, "--count", 5, "--worn")
    assert (code, err) == (0, "")
    assert told.startswith("simulated: 4 poses")
    assert len(rows(out)) == 1 + 5
    if (out / "poses.mcap").exists():
        assert (out / "poses.mcap").read_bytes()[1:5] == b"MCAP"
    options = ("--source", "glove:emulated", "--map", out / "map.json", "--seconds", 1.5)
    code, told, err = run("drive", starfish, *options)
    assert (code, err) == (0, "")
    moved = [float(word) for word in re.findall(r"right (-?\d+\.\d) mm", told)]
    assert max(moved) > 1.0  # the emulated hand closes by itself
    code, _, err = run("drive", starfish, *options, "--markers")
    assert code == 2
    assert "--map: it was learned of starfish for right, left, feet" in err


@pytest.mark.slow
def test_a_person_presses_enter_and_sees_the_pose(starfish: Path, tmp_path: Path) -> None:
    """With landmarks of a hand that holds still; q ends, and what was taken stays."""
    import socket

    out, sender = tmp_path / "camera", socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    words = ["mimic", str(starfish), "--glove", "camera:9377", "--out", str(out)]
    work = subprocess.Popen([sys.executable, "-uc", PROGRAM, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert work.stdin is not None
    assert work.stdout is not None
    os.set_blocking(work.stdout.fileno(), False)
    hand = json.dumps({"landmarks": [[0.1 * n, 0.01 * n * n, 0.0] for n in range(21)]}).encode()
    told, entered, end = b"", 0, time.monotonic() + 300.0
    while work.poll() is None and time.monotonic() < end:
        sender.sendto(hand, ("127.0.0.1", 9377))
        told += work.stdout.read() or b""
        if told.count(b"press Enter") > entered:
            entered += 1
            work.stdin.write(b"\n" if entered < 3 else b"q\n")
            work.stdin.flush()
        time.sleep(0.02)
    told += work.stdout.read() or b""
    sender.close()
    assert work.wait(300) == 0
    work.stdin.close()
    work.stdout.close()
    assert b"too few poses for a map (2, minimum 4)" in told
    assert len(rows(out)) == 1 + 2
    assert (out / "pose.png").read_bytes()[1:4] == b"PNG"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--glove", "emulated", "--count", 2), "--count 2: must be at least 4"),
        (("--glove", "camera:x"), "a camera needs MediaPipe's model file"),
        (("--glove", "emulated", "--motors", "nonsense"), "--motors nonsense: write emulated"),
    ],
)
def test_one_clear_line(run: Run, starfish: Path, tmp_path: Path, options: tuple[object, ...], told: str) -> None:
    code, out, err = run("mimic", starfish, "--out", tmp_path / "out", *options)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert told in err


def test_a_glove_that_is_not_there(run: Run, starfish: Path, tmp_path: Path) -> None:
    pytest.importorskip("serial")
    code, _, err = run("mimic", starfish, "--glove", "/dev/no_glove", "--out", tmp_path / "out")
    assert code == 1
    assert "cannot open /dev/no_glove" in err
