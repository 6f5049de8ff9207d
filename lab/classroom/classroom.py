"""Pupils of a class who all drag at the same time, as programs without a screen: frames a second, times, who waits.

Each pupil enters a room of its own in `hydrostat studio --class`, drags a marker of the starfish round, 30 moves a
second, and takes frames as a browser does. A frame is counted if it answers a newer move. `waits` is the share of
frames that tell the pupil how many drags come first, `least` that of the pupil who gets the fewest. The pupils
share the machine with the studio, or with several (`--studios`), each a process of its own. `CPU` is the processor
time of the studios for each answer: other programs on the machine do not change it much.
"""

import argparse
import asyncio
import json
import os
import re
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from math import cos, pi, sin
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory

import numpy as np
from machine import machine
from websockets.asyncio.client import ClientConnection, connect

MOVES = 30
"""Of a pointer in a second."""

WARM = 6.0
"""Seconds before any frame is counted."""


@dataclass
class Pupil:
    """What a pupil has seen."""

    answered: int = 0
    latencies: list[float] = field(default_factory=list)
    waits: int = 0
    frames: int = 0


@contextmanager
def studio() -> Iterator[tuple[int, int]]:
    """A class that runs; its port and process."""
    command = [sys.executable, "-c", "from hydrostat.cli.main import main; main()", "studio", "gallery:starfish"]
    command += ["--class", "--host", "127.0.0.1", "--no-browser"]
    with (
        TemporaryDirectory() as state,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**os.environ, "XDG_STATE_HOME": state}
        ) as process,
    ):
        assert process.stdout is not None
        found = None
        while found is None:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/class/", process.stdout.readline())
        yield int(found[1]), process.pid
        process.terminate()


async def drag(socket: ClientConnection, begun: float, seconds: float) -> None:
    """Go round with a marker."""
    await socket.send(json.dumps({"kind": "grab", "key": "marker:top", "world": [0.0, 0.13, 0.0], "stamp": 1.0}))
    turn = np.random.default_rng().uniform(0, 2 * pi)
    while (now := time.monotonic() - begun) < seconds:
        angle = turn + 2 * pi * now / 4
        world = [0.02 * sin(angle), 0.12 + 0.01 * cos(angle), 0.0]
        await socket.send(json.dumps({"kind": "drag", "world": world, "stamp": 1e3 * time.monotonic()}))
        await asyncio.sleep(1 / MOVES)


async def watch(socket: ClientConnection, pupil: Pupil, since: float) -> None:
    """Take frames."""
    latest = 0.0
    while True:
        message = await socket.recv()
        assert isinstance(message, bytes)
        (length,) = struct.unpack_from("<I", message)
        head = json.loads(message[4 : 4 + length])
        if head["kind"] != "frame":
            continue
        await socket.send('{"kind": "seen"}')
        now = time.monotonic()
        if now < since:
            continue
        pupil.frames += 1
        pupil.waits += bool(head.get("before"))
        if head["stamp"] > latest:
            latest = head["stamp"]
            pupil.answered += 1
            pupil.latencies.append(now - latest / 1e3)


async def take_part(port: int, number: int, seconds: float) -> Pupil:
    """A pupil, from the first frame to the last."""
    pupil, own = Pupil(), f"127.0.0.1:{port}"
    headers = {"Cookie": f"hydrostat_name_{port}=Pupil{number}"}
    address = f"ws://{own}/stream/{token_urlsafe(18)}"
    async with connect(address, origin=f"http://{own}", additional_headers=headers, max_size=None) as socket:  # type: ignore[arg-type]
        begun = time.monotonic()
        watching = asyncio.create_task(watch(socket, pupil, begun + WARM))
        await drag(socket, begun, WARM + seconds)
        watching.cancel()
        with suppress(asyncio.CancelledError):
            await watching
    return pupil


def processor_time(processes: list[int]) -> float:
    """Processor time that processes have taken so far [s]."""
    told = [Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split() for process in processes]
    return sum(int(words[11]) + int(words[12]) for words in told) / os.sysconf("SC_CLK_TCK")


async def run_class(ports: list[int], processes: list[int], pupils: int, seconds: float) -> tuple[list[Pupil], float]:
    """All pupils at once, spread over the studios, and the processor time of these [s]."""

    async def follow_processors() -> float:
        await asyncio.sleep(WARM)
        before = processor_time(processes)
        await asyncio.sleep(seconds)
        return processor_time(processes) - before

    following = asyncio.create_task(follow_processors())
    parts = (take_part(ports[number % len(ports)], number, seconds) for number in range(pupils))
    return await asyncio.gather(*parts), await following


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--pupils", type=int, nargs="+", default=[1, 10, 30])
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--studios", type=int, default=1, help="studios among which the pupils are spread")
    asked = parser.parse_args()
    print(f"{machine()}; load {os.getloadavg()[0]:.1f} at the start\n")
    print(
        "| pupils | frames a second: slowest | median | all | ms to the answer: median | 95 % | waits | least "
        "| CPU, ms an answer | load |"
    )
    print("|---" * 10 + "|")
    for count in asked.pupils:
        with ExitStack() as stack:
            ports, processes = zip(*(stack.enter_context(studio()) for _ in range(asked.studios)), strict=True)
            found, spent = asyncio.run(run_class(list(ports), list(processes), count, asked.seconds))
        rates = np.array([pupil.answered for pupil in found]) / asked.seconds
        times = 1e3 * np.concatenate([pupil.latencies for pupil in found])
        waits = np.array([pupil.waits / max(pupil.frames, 1) for pupil in found])
        print(
            f"| {count} | {rates.min():.1f} | {np.median(rates):.1f} | {rates.sum():.0f} | {np.median(times):.0f} | "
            f"{np.percentile(times, 95):.0f} | {100 * waits.mean():.0f} % | {100 * waits.min():.0f} % | "
            f"{1e3 * spent / max(1, sum(pupil.answered for pupil in found)):.1f} | {os.getloadavg()[0]:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
