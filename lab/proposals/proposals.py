"""What proposing cables costs a person who drags by muscles, and how long a proposal takes (X1).

    python lab/proposals/proposals.py [--robots starfish cupping_hand trunk] [--rounds 4]

A marker goes from rest to its place in the robot's first pose in 60 moves, with proposals off and on in turn. A step is
what the stage "pose" does for a move; wall time, as another process works beside it, and CPU time of the thread alone.
A proposal is timed in this process, at four places of the way, by CPU time until the last network: the median, and the
longest. `python benchmarks/studio.py --proposals` prints times through the worker process, and errors as built.
"""

import argparse
import time
from dataclasses import replace
from statistics import median

from machine import machine

import numpy as np  # isort: skip
from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.studio import (
    Bell,
    Document,
    HeldPoint,
    Hit,
    Jobs,
    Mode,
    MuscleMover,
    MusclePulls,
    Poser,
    ProposalInput,
    Proposer,
    held_of,
)

MOVES, PAUSE, START = 60, 0.005, 5.0  # moves of a drag, between two of them [s], until the process has begun [s]
SHARES = (0.1, 0.3, 0.6, 1.0)  # of the way, where a proposal is timed


def wanted(robot: Robot) -> dict[str, HeldPoint]:
    """What the robot's first pose holds."""
    return held_of(robot, next(iter(robot.poses)))


def part_way(held: dict[str, HeldPoint], share: float) -> dict[str, HeldPoint]:
    """The same targets, so far on the way to them."""
    return {
        name: replace(point, target=tuple((np.array(point.at) * (1 - share) + np.array(point.target) * share).tolist()))
        for name, point in held.items()
    }


def drag(poser: Poser, held: dict[str, HeldPoint]) -> list[tuple[float, float]]:
    """Wall and CPU time of each step [s], of the marker that goes farthest."""
    name = max(held, key=lambda one: float(np.linalg.norm(np.subtract(held[one].at, held[one].target))))
    poser.rest()
    poser.step(0.0)
    poser.grab(Hit(key=f"marker:{name}", world=held[name].at))
    times = []
    for share in np.linspace(0, 1, MOVES):
        poser.drag(Hit(world=part_way(held, float(share))[name].target))
        wall, cpu = time.perf_counter(), time.thread_time()
        poser.step(0.0)
        times.append((time.perf_counter() - wall, time.thread_time() - cpu))
        time.sleep(PAUSE)
    poser.release()
    return times


def steps(robot: Robot, rounds: int) -> dict[bool, list[tuple[float, float]]]:
    """Times of steps with proposals off and on."""
    document = Document(Bell())
    document.open(Work(robot=robot))
    jobs, times = Jobs(document.bell), {False: [], True: []}
    poser = Poser(document, jobs)
    poser.set_mode(Mode.MUSCLES)
    drag(poser, wanted(robot))
    for _ in range(rounds):
        for on in (False, True):
            poser.proposals.switch(on)
            time.sleep(START if on else 0.0)
            times[on] += drag(poser, wanted(robot))
    poser.proposals.close()
    jobs.close()
    return times


def proposals(robot: Robot) -> list[float]:
    """CPU time of each proposal on the way [s]."""
    mover, proposer, times = MuscleMover(robot), Proposer(robot), []
    for share in SHARES:
        held = part_way(wanted(robot), share)
        for _ in range(MOVES):
            if not mover.update(held)[1]:
                break
        nodes, tensions = mover.pulls
        began = time.process_time()
        muscles = MusclePulls(nodes=nodes, tensions=tensions)
        list(proposer.propose(ProposalInput(held=held, wishes=Wishes(), markers=robot.markers, muscles=muscles)))
        times.append(time.process_time() - began)
    return times


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", nargs="+", default=["starfish", "cupping_hand", "trunk"])
    parser.add_argument("--rounds", type=int, default=4)
    given = parser.parse_args()
    print(machine(), end="\n\n")
    print("| robot | step, off: wall, CPU | step, on: wall, CPU | proposal: median, longest |\n|---|---|---|---|")
    for name in given.robots:
        robot = load_robot(gallery_folder(name))
        cells = [
            ", ".join(f"{1e3 * median(times):.1f}" for times in zip(*found, strict=True)) + " ms"
            for found in steps(robot, given.rounds).values()
        ]
        took = proposals(robot)
        print(f"| {name} | {' | '.join(cells)} | {median(took):.2f}, {max(took):.2f} s |", flush=True)


if __name__ == "__main__":
    main()
