"""How fast the studio answers the pointer: from a pointer's event to the new shape on the screen.

    python benchmarks/studio.py [--robots starfish cupping_hand] [--modes cables muscles] [--seconds 20] [--minutes 0]
    python benchmarks/studio.py --propose ...   # the same while cables are proposed
    python benchmarks/studio.py --proposals [--robots starfish robot pig squid cupping_hand]   # no browser

A studio runs as a program of its own, and a Chromium with software rendering shows it, on the same machine. The view
is 800 x 500 pixels. The pointer takes hold of a marker and goes round an ellipse about where it was, an eighth of the
body wide, with 60 events a second. For each of them the page takes the time from the event until the first picture
that answers it or a later one is painted (after a read back from the canvas); those that are overtaken have no time.

With --minutes the same goes on for so long with one robot and mode, and every minute has a row: a queue would show as
times that grow, a leak as memory that does.

With --proposals each stored pose of a robot is held by muscles, two winches and six cables at most are wanted, and the
time until a network is proposed is taken, the median over the poses: CPU time of the search, wall time from the pose
until the network is in the stage, through the worker process. Winch trees are the proposals of Chang (2018).

It needs the extra `test` and a Chromium. Wall time, as that is what a person feels; other programs on the machine show.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import cos, pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from machine import machine

import numpy as np  # isort: skip
from playwright.sync_api import Page, sync_playwright

from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.studio import (
    Bell,
    Document,
    Jobs,
    MuscleMover,
    MusclePulls,
    Poser,
    ProposalInput,
    Proposer,
    held_of,
)

VIEW = (800, 500)
"""Of the view [pixels]."""

EVENTS = 60
"""Of the pointer in a second."""

FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader",
         "--enable-precise-memory-info", "--js-flags=--expose-gc"]  # fmt: skip

MARKERS = {"cupping_hand": "index", "starfish": "right"}
"""That is dragged; the first of others."""

DRAGGED, PROPOSED = ["starfish", "cupping_hand"], ["starfish", "robot", "pig", "squid", "cupping_hand"]
"""Robots that are dragged, and those that cables are proposed for, if none is named."""

PREPARED = 8.0
"""In which a worker process begins and prepares for a body [s]."""

PATIENCE = 120_000
"""For the page to be ready [ms]: the first time on a machine kernels are compiled."""


@contextmanager
def studio(robot: str, state: str) -> Iterator[tuple[str, int]]:
    """A studio that runs: its address and the number of its process."""
    command = [sys.executable, "-c", "from hydrostat.cli.main import main; main()", "studio"]
    command += [str(gallery_folder(robot)), "--no-browser"]
    environment = {**os.environ, "XDG_STATE_HOME": state}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        try:
            yield next(word for word in process.stdout.readline().split() if word.startswith("http://")), process.pid
        finally:
            process.terminate()


def memory(process: int) -> float:
    """What a process holds [MB]."""
    found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{process}/status").read_text())
    return int(found[1]) / 1024 if found else float("nan")


def ready(page: Page, address: str, mode: str) -> None:
    """Open the page, make the view as large as it shall be, choose a mode, and wait for the first pictures."""
    page.set_default_timeout(PATIENCE)
    page.set_viewport_size({"width": VIEW[0] + 348, "height": VIEW[1] + 52})
    page.add_init_script("localStorage.setItem('hydrostat-tour', '1')")
    page.goto(address)
    page.wait_for_function("window.__app && window.__app.painted > 0")
    page.get_by_role("button", name=mode.capitalize(), exact=True).click()


def marker(page: Page, robot: str) -> dict[str, float]:
    """Where the marker is that is dragged [pixels]."""
    items: list[dict[str, Any]] = page.evaluate("window.__app.items")
    markers = [item for item in items if item["key"].startswith("marker:")]
    named = [item for item in markers if item["key"] == f"marker:{MARKERS.get(robot)}"]
    return (named or markers)[0]


def drag(page: Page, start: dict[str, float], seconds: float) -> dict[str, float]:
    """Go round for a while; what the page has measured meanwhile."""
    wide, high = 0.06 * VIEW[0], 0.08 * VIEW[1]
    page.evaluate("() => { __app.latencies.length = 0; __app.paints.length = 0; window.__from = __app.painted; }")
    begun = time.perf_counter()
    sent = 0
    while (now := time.perf_counter() - begun) < seconds:
        angle = 2 * pi * now / 4.0
        page.mouse.move(start["x"] + wide * sin(angle), start["y"] + high * (1 - cos(angle)) / 2)
        sent += 1
        time.sleep(max(0.0, begun + sent / EVENTS - time.perf_counter()))
    took = time.perf_counter() - begun
    found = page.evaluate("() => ({times: __app.latencies, paints: __app.paints, count: __app.painted - __from})")
    times = np.array(found["times"])
    return {
        "events": sent / took,
        "median": float(np.median(times)),
        "p95": float(np.percentile(times, 95)),
        "worst": float(times.max()),
        "paint": float(np.median(found["paints"])),
        "frames": found["count"] / took,
    }


def proposal_row(name: str) -> str:
    """How long proposals for the poses of a robot take, and their errors as built, as cells."""
    robot = load_robot(gallery_folder(name))
    cells = [name, str(len(robot.body.mesh.nodes))]
    for method in ("trees", "routes"):
        wishes = Wishes.of(method=method)
        cpu, wall = search_times(robot, wishes), waiting_times(robot, wishes)
        for stage in (-1,) if method == "trees" else (0, -1):
            seconds, errors = ([found[stage][part] for found in cpu] for part in (0, 1))
            waits = [found[stage] for found in wall]
            error = "none" if np.isnan(errors).all() else f"{1e3 * np.nanmedian(errors):.1f}"
            cells += [f"{np.median(seconds):.2f}", f"{np.median(waits):.2f}", error]
    return f"| {' | '.join(cells)} |"


def settled_pulls(robot: Robot, name: str) -> MusclePulls:
    """Muscles that hold a pose."""
    mover, held = MuscleMover(robot), held_of(robot, name)
    while mover.update(held)[1]:
        pass
    nodes, tensions = mover.pulls
    return MusclePulls(nodes=nodes, tensions=tensions)


def search_times(robot: Robot, wishes: Wishes) -> list[list[tuple[float, float]]]:
    """CPU time until each network [s] and its error as built [m], NaN where there is none, for each pose."""
    proposer = Proposer(robot)
    list(proposer.propose(ProposalInput(held={}, wishes=wishes, markers=robot.markers)))
    times = []
    for name in robot.poses:
        pulls = settled_pulls(robot, name)
        moment = ProposalInput(held=held_of(robot, name), wishes=wishes, markers=robot.markers, muscles=pulls)
        began = time.process_time()
        times.append(
            [(time.process_time() - began, found.expected_error or float("nan")) for found in proposer.propose(moment)]
        )
    return times


def waiting_times(robot: Robot, wishes: Wishes) -> list[list[float]]:
    """Wall time from each pose until each network is in the stage [s]; the process has prepared for the body."""
    document, times = Document(Bell()), []
    document.open(Work(robot=robot, wishes=wishes))
    jobs = Jobs(document.bell)
    poser = Poser(document, jobs)
    poser.set_mode("muscles")
    poser.proposals.switch(True)
    begun = time.monotonic()
    while time.monotonic() - begun < PREPARED:
        poser.step(0.0)
        time.sleep(0.05)
    for name in robot.poses:
        poser.rest()
        poser.step(0.0)
        poser.show_pose(name)
        begun, seen, found = time.monotonic(), None, []
        is_done = False
        while not is_done:
            is_done = bool(found) and not poser.proposals.searching  # asked first, so that the last network counts
            poser.step(0.0)
            proposal = poser.proposals.latest_proposal(robot)
            if proposal is not None and proposal is not seen:
                seen = proposal
                found.append(time.monotonic() - begun)
            time.sleep(0.005)
        times.append(found)
    poser.proposals.close()
    jobs.close()
    return times


def heap(page: Page) -> float:
    """What the page's scripts hold [MB]."""
    return page.evaluate("() => { window.gc && window.gc(); return performance.memory.usedJSHeapSize / 1e6; }")


HEAD = "median ms | 95 % | worst | painting ms | frames a second | events a second"


def row(found: dict[str, float]) -> str:
    """Figures of a drag as cells."""
    times = " | ".join(f"{found[name]:.0f}" for name in ("median", "p95", "worst"))
    return f"{times} | {found['paint']:.1f} | {found['frames']:.0f} | {found['events']:.0f}"


def print_proposals(robots: list[str]) -> None:
    """Print the table of proposals."""
    print(machine(), end="\n\n")
    print("| robot | nodes | trees: CPU s | wall s | built mm | first: CPU s | wall s | built mm | last: CPU s |"
          " wall s | built mm |")  # fmt: skip
    print("|---" * 11 + "|")
    for robot in robots:
        print(proposal_row(robot), flush=True)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--robots", nargs="+", default=None)
    parser.add_argument("--proposals", action="store_true")
    parser.add_argument("--propose", action="store_true")
    parser.add_argument("--modes", nargs="+", default=["cables", "muscles"], choices=["cables", "muscles"])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--minutes", type=int, default=0)
    asked = parser.parse_args()
    if asked.proposals:
        print_proposals(asked.robots or PROPOSED)
        return
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        raise SystemExit("benchmarks/studio.py needs a Chromium; install Debian's package chromium")
    print(f"{machine()}; Chromium with software rendering, view {VIEW[0]} x {VIEW[1]}\n")
    long = asked.minutes > 0
    print(f"| robot | mode | {'minute | ' if long else ''}{HEAD} |{' studio MB | page MB |' if long else ''}")
    print("|---" * (8 + 3 * long) + "|")
    with sync_playwright() as playwright:
        for robot in asked.robots or DRAGGED:
            for mode in asked.modes:
                with TemporaryDirectory() as state, studio(robot, state) as (address, process):
                    browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
                    page = browser.new_page()
                    ready(page, address, mode)
                    if asked.propose:
                        page.get_by_text("Propose cables while dragging").click()
                    start = marker(page, robot)
                    page.mouse.move(start["x"], start["y"])
                    page.mouse.down()
                    drag(page, start, 5.0)  # to be warm
                    for minute in range(asked.minutes or 1):
                        found = drag(page, start, 60.0 if long else asked.seconds)
                        extra = f" {memory(process):.0f} | {heap(page):.1f} |" if long else ""
                        number = f"{minute + 1} | " if long else ""
                        print(f"| {robot} | {mode} | {number}{row(found)} |{extra}", flush=True)
                    page.mouse.up()
                    browser.close()


if __name__ == "__main__":
    main()
