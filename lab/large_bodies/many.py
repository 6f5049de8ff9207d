"""How many poses a second one simulation finds, by one thread and by two, and by two processes at the same time.

    python lab/large_bodies/many.py [--poses 200] [--rounds 3] [--bodies starfish,trunk,cupping_hand]

Contractions at random, 0 to a tenth of each cable's length, from rest, with the exact slopes of the markers. Wall
clock, the best of several rounds: two threads of one process share Python's lock; two processes with half of the poses
each, begun together, share only the machine, so they are what threads could reach at most.
"""

import argparse
import multiprocessing
import sys
import time
from typing import Any

from machine import machine

import numpy as np  # isort: skip

from hydrostat.robot import gallery_folder, load_robot
from hydrostat.simulation import Simulation


def prepared(body: str, poses: int) -> tuple[Simulation, np.ndarray]:
    """A simulation that has solved once, and contractions [m]."""
    robot = load_robot(gallery_folder(body))
    simulation = Simulation(robot)
    lengths = np.zeros(len(robot.winches))
    np.maximum.at(lengths, simulation.cables.winches, simulation.cables.rest_lengths)
    goals = np.random.default_rng(0).uniform(0.0, 0.1, (poses, len(lengths))) * lengths
    simulation.solve_batch(goals[:4], threads=2)
    return simulation, goals


def seconds(simulation: Simulation, goals: np.ndarray, threads: int) -> float:
    """Wall clock of all poses [s]."""
    began = time.perf_counter()
    found = simulation.solve_batch(goals, threads=threads)
    taken = time.perf_counter() - began
    lost = len(found) - int(found.converged.sum())
    if lost:
        print(f"{lost} of {len(found)} poses not found", file=sys.stderr)
    return taken


def half(body: str, poses: int, rounds: int, which: int, gate: Any) -> None:
    """Every other pose, in a process of its own; each round begins when all are ready."""
    simulation, goals = prepared(body, poses)
    for _ in range(rounds):
        gate.wait()
        seconds(simulation, goals[which::2], 1)
        gate.wait()


def by_processes(body: str, poses: int, rounds: int) -> float:
    """Wall clock of two processes with half of the poses each [s]."""
    context = multiprocessing.get_context("spawn")
    gate = context.Barrier(3)
    workers = [context.Process(target=half, args=(body, poses, rounds, which, gate)) for which in range(2)]
    for worker in workers:
        worker.start()
    best = np.inf
    for _ in range(rounds):
        gate.wait()
        began = time.perf_counter()
        gate.wait()
        best = min(best, time.perf_counter() - began)
    for worker in workers:
        worker.join()
    return best


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--bodies", default="starfish,trunk,cupping_hand")
    given = parser.parse_args()
    print(f"\n{machine()}\n")
    print("| robot | nodes | ms a pose, one thread | two threads | two processes | gain of threads | of processes |")
    print("|---|---|---|---|---|---|---|")
    for body in given.bodies.split(","):
        simulation, goals = prepared(body, given.poses)
        times = {1: np.inf, 2: np.inf}
        for _ in range(given.rounds):
            for threads, best in times.items():
                times[threads] = min(best, seconds(simulation, goals, threads))
        apart = by_processes(body, given.poses, given.rounds)
        each = [1e3 * taken / given.poses for taken in (times[1], times[2], apart)]
        print(
            f"| {body} | {len(simulation.robot.body.mesh.nodes)} | {each[0]:.2f} | {each[1]:.2f} | {each[2]:.2f} "
            f"| {each[0] / each[1]:.2f} | {each[0] / each[2]:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
