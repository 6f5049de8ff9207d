"""`hydrostat drive`. Oracles: a pseudo-terminal with keys, python-osc's own client, exit codes and what lines say."""

import os
import re
import select
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from own_time import PROGRAM

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
@pytest.mark.parametrize("port", [[], ["--motors", "emulated"]], ids=["simulated", "emulated"])
def test_keys_turn_winches_and_bars_are_shown(starfish: Path, port: list[str]) -> None:
    ours, theirs = os.openpty()
    words = [sys.executable, "-c", PROGRAM, "drive", str(starfish), *port]
    work = subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    told, pressed, asked, end = b"", False, False, time.monotonic() + 120.0
    while work.poll() is None:
        if select.select([ours], [], [], 0.05)[0]:
            try:
                told += os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
        if not pressed and b"tab next" in told:
            os.write(ours, b"\tDDdd")
            pressed = True
        there = re.search(rb"left  \[#+-+\] +7\.\d mm", told) or time.monotonic() > end
        if there and not asked:
            os.write(ours, b"q")
            asked = True
    assert work.wait(300) == 0
    os.close(ours)
    text = told.decode()
    last = re.findall(r"ended; motors holding at right (-?[0-9.]+) mm, left ([0-9.]+) mm", text)
    kind = "emulated" if port else "simulated"
    assert len(last) == 1
    assert float(last[0][1]) == pytest.approx(7.0, abs=0.4)
    assert re.search(kind + r": left  \[#+-+\] +7\.\d mm" + (r" +-?[0-9.]+ A" if port else ""), text)
    assert "\x1b[5A" in text  # three bars, a state and a help are drawn again


@pytest.mark.slow
def test_messages_move_fingertips(run: Run, starfish: Path) -> None:
    client = pytest.importorskip("pythonosc.udp_client")
    import hydrostat as hs

    hidden = hs.Simulation(hs.load_robot(starfish)).solve({"left": 0.01})
    sender, over = client.SimpleUDPClient("127.0.0.1", 9321), threading.Event()

    def tell() -> None:
        while not over.wait(0.05):
            for name, place in hidden.markers.items():
                sender.send_message(f"/marker/{name}", [1e3 * float(value) for value in place])

    thread = threading.Thread(target=tell)
    thread.start()
    try:
        code, out, err = run("drive", starfish, "--source", "osc:9321", "--markers", "--seconds", 2)
    finally:
        over.set()
        thread.join()
        sender._sock.close()
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == "simulated: driving fingertips of starfish with osc:9321"
    assert all(line.startswith("simulated: ") for line in lines)
    assert float(re.findall(r"left ([0-9.]+) mm", lines[-1])[0]) == pytest.approx(10.0, abs=0.2)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--source", "pedals"), "--source pedals: unknown source. Available: keys, gamepad:0"),
        (("--source", "glove:/dev/ttyUSB0"), "needs --map FILE; `hydrostat mimic` makes it"),
        (("--map", "none.json"), "none.json: cannot be read"),
        (("--model", "none.model"), "--model: needs --markers. Add it."),
        (("--motors", "nonsense"), "--motors nonsense: write emulated"),
        (("--seconds", -1), "--seconds -1: must not be negative"),
    ],
)
def test_one_clear_line(run: Run, starfish: Path, options: tuple[object, ...], told: str) -> None:
    code, out, err = run("drive", starfish, *options)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert told in err


def test_keys_need_a_terminal(run: Run, starfish: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull) as nothing:
        monkeypatch.setattr(sys, "stdin", nothing)
        code, out, err = run("drive", starfish)
    assert (code, out) == (1, "")
    assert "--source keys needs a terminal" in err
