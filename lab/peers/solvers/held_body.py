"""A held body under dead loads, as every peer gets it, and how a peer is timed on it; needs NumPy alone.

A peer is a file beside this one with a function `prepare(body, variant)`. It returns a function that begins again from
the rest shape each time it is called and gives the nodes again and again, better each time. `main` runs it in a process
of its own: only the time between two answers counts.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

Answers = Callable[[], Iterator[np.ndarray]]
"""Begins at rest and gives the nodes [m], better each time; it ends where the method itself says that it is done."""


@dataclass(frozen=True)
class HeldBody:
    """Tetrahedra of one material, some nodes held where they are, a force that does not change at each other.

    Attributes:
        nodes: at rest [m], (nodes, 3).
        elements: corners, (elements, 4).
        held: whether a node is held, (nodes,).
        forces: on each node [N], (nodes, 3).
        mu: Lame's parameter of shear [Pa].
        lame: Lame's first parameter [Pa].
        masses: of the nodes [kg], (nodes,).
    """

    nodes: np.ndarray
    elements: np.ndarray
    held: np.ndarray
    forces: np.ndarray
    mu: float
    lame: float
    masses: np.ndarray

    @property
    def young(self) -> float:
        """Young's modulus [Pa]."""
        return self.mu * (3 * self.lame + 2 * self.mu) / (self.lame + self.mu)

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        return self.lame / (2 * (self.lame + self.mu))

    def save(self, path: Path) -> None:
        """Store it, so that another process can load it."""
        np.savez(path, **asdict(self))

    @classmethod
    def load(cls, path: Path) -> "HeldBody":
        """The body that was stored at `path`."""
        with np.load(path) as stored:
            arrays = {name: stored[name] for name in ("nodes", "elements", "held", "forces", "masses")}
            return cls(**arrays, mu=float(stored["mu"]), lame=float(stored["lame"]))


@dataclass(frozen=True)
class Trail:
    """What a peer gave.

    Attributes:
        seconds: CPU time from the rest shape to each answer [s], (answers,); of the quickest of several runs.
        answers: nodes [m], (answers, nodes, 3).
        ready: CPU time of the process until the first run that counts: imports, model, compiling, one answer [s].
        done: whether the method ended by itself, and not because its time was up.
    """

    seconds: np.ndarray
    answers: np.ndarray
    ready: float
    done: bool


def follow(begin: Answers, budget: float) -> tuple[list[float], list[np.ndarray], bool]:
    """CPU time [s] and nodes of all answers within a budget [s] of CPU time, and whether the method ended by itself."""
    seconds: list[float] = []
    answers: list[np.ndarray] = []
    spent = 0.0
    began = time.process_time()
    for nodes in begin():
        spent += time.process_time() - began
        seconds.append(spent)
        answers.append(np.array(nodes, dtype=float))
        if spent > budget or not np.isfinite(answers[-1]).all():
            return seconds, answers, False
        began = time.process_time()
    return seconds, answers, True


def at_rest(body: HeldBody, before: np.ndarray, nodes: np.ndarray, tolerance: float) -> bool:
    """Whether no node has moved by more than a share of the farthest way from the rest shape."""
    way = np.abs(nodes - body.nodes).max()
    return bool(np.abs(nodes - before).max() <= tolerance * way)


def measure(begin: Answers, *, budget: float, runs: int = 3) -> Trail:
    """The quickest of several runs, after one answer that is not counted."""
    follow(begin, 0.0)
    ready = time.process_time()
    found = [follow(begin, budget)]
    while len(found) < runs and found[0][2]:
        found.append(follow(begin, budget))
    seconds, answers, done = min(found, key=lambda run: run[0][-1])
    return Trail(np.array(seconds), np.array(answers), ready, done)


def main(prepare: Callable[[HeldBody, str], Answers]) -> None:
    """Time a peer: `python PEER.py BODY.npz VARIANT BUDGET TRAIL.npz`."""
    given, variant, budget, result = sys.argv[1:]
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    trail = measure(prepare(HeldBody.load(Path(given)), variant), budget=float(budget))
    np.savez(result, **asdict(trail))
