"""How far one equilibrium is from the floor: beside a C++ trial of the same body and poses, at equal accuracy.

    python lab/solver_floor/floor.py TRIAL [--rounds 3] [--poses 30] [--steps 60] [--profile] [--parts]

TRIAL is a folder with the built trial: `hand.npz`, `sim.py` and `libcore.so`; its Python packages (pymetis, cvxopt) are
found with --packages. Both solve in turn, on one thread, the same poses: 30 from rest, and random walks of the
contractions whose steps have an rms of 0.2, 1 and 3 % of the length of each cable. CPU time is of the solve alone. The
error is that of the tips against a solve to 1e-12 of the force, each program by its own.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = "1"
import numpy as np
from machine import machine

import hydrostat as hs
from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Body, Cable, Material, Pin, Robot, Source, Winch

TOLERANCE = 1e-8
"""Norm of the forces [N] at which the trial stops: its tips are then as exact as ours, to a tenth of a nanometer."""

STEPS = (0.002, 0.01, 0.03)
"""Sizes of the steps of the walks, as shares of the length of each cable."""


@dataclass
class Row:
    """What one program took for one line of the table.

    Attributes:
        milliseconds: of each pose, round by round.
        iterations: of each pose of the last round.
        error: largest distance of a tip from where it should be [m].
    """

    milliseconds: list[float] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    error: float = 0.0


class Hydrostat:
    """The body of the trial as a robot of ours."""

    def __init__(self, folder: Path, accuracy: float | None = None) -> None:
        self.accuracy = accuracy
        data = np.load(folder / "hand.npz")
        mesh = Mesh(data["X"], data["T"])
        mu, lame = 35.7e3, 143e3
        poisson = lame / (2 * (lame + mu))
        body = Body(
            source=Source.MESH,
            file="hand.npz",
            content=b"",
            material=Material(young=2 * mu * (1 + poisson), poisson=poisson, density=1000.0),
            mesh=mesh,
        )
        points = np.einsum("pk,pkd->pd", data["cw"], mesh.nodes[data["cv"]])
        ends = data["cp"]
        self.count = len(ends) - 1
        cables = tuple(
            Cable(
                winch=f"w{index}",
                points=tuple(map(tuple, points[ends[index] : ends[index + 1]].tolist())),
                stiffness=2e4,
                smoothing=0.5e-3,
            )
            for index in range(self.count)
        )
        winches = tuple(Winch(name=f"w{index}", at=cable.points[0]) for index, cable in enumerate(cables))
        pins = tuple(Pin(at=tuple(mesh.nodes[node].tolist()), stiffness=1e4) for node in data["pins"])
        self.tips = data["tips"]
        robot = Robot(name="hand", body=body, pins=pins, winches=winches, cables=cables, markers=(), poses={})
        self.simulation = hs.Simulation(robot)
        self.exact = hs.Simulation(robot, options=NewtonOptions(tolerance=1e-12), body=self.simulation.body)
        self.lengths = self.simulation.cables.rest_lengths

    def solve(self, shares: np.ndarray, start: Any) -> tuple[Any, int]:
        """Pose at contractions that are shares of the cables' lengths, and its iterations."""
        pose = self.simulation.solve(self.lengths * shares, start=start, accuracy=self.accuracy)
        return pose, pose.result.iterations

    def wrong(self, pose: Any, shares: np.ndarray) -> float:
        """Largest distance of a tip from where it should be [m]."""
        exact = self.exact.solve(self.lengths * shares, start=pose)
        return float(np.linalg.norm(pose.nodes[self.tips] - exact.nodes[self.tips], axis=1).max())


class Trial:
    """The C++ trial, through its own wrapper."""

    def __init__(self, folder: Path, single: bool) -> None:
        os.environ["CORELIB"] = str(folder / "libcore.so")
        sys.path.insert(0, str(folder))
        import ctypes

        import sim  # pyright: ignore[reportMissingImports]

        self.lib, self.ptr, self.double = sim.lib, sim.ptr, ctypes.c_double
        self.model = sim.Model(str(folder / "hand.npz"))
        self.sim = sim.CSim(self.model, True, "amd", f32=True, c0=100, a_f=0.025, a_e=0.3).setlap()
        self.rest = self.sim.to(self.model.X).copy()
        self.single, dim = int(single), self.model.d
        self.dofs = (self.sim.cu[:, None] * dim + np.arange(dim)).ravel()
        self.cables = np.repeat(np.arange(self.model.nc), np.diff(self.sim.cup) * dim)
        self.tips = (self.sim.pos[self.model.tips][:, None] * dim + np.arange(dim)).ravel()

    def solve(self, shares: np.ndarray, start: Any) -> tuple[Any, int]:
        """Nodes at contractions that are shares of the cables' lengths, and its iterations."""
        if start is None:
            nodes = self.rest.copy()
            self.sim.rest(self.model.L0 * (1 - shares))
        else:
            nodes = self._predicted(*start, shares)
        found = self.sim.newton(nodes, tol=TOLERANCE, maxit=600, f32=self.single, mode=6, warp=1, sticky=1)
        if not found.ok:
            raise RuntimeError("the trial did not converge")
        return (nodes, shares.copy()), found.it

    def _predicted(self, nodes: np.ndarray, before: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """Prediction dx/da from the pose before, as the trial's own walk makes it."""
        count, size = self.model.nc, len(nodes)
        forces, lengths, slopes, springs = np.zeros(len(self.dofs)), np.zeros(count), np.zeros(count), np.zeros(count)
        self.lib.sim_grad(self.sim.h, self.ptr(nodes), self.ptr(np.zeros(size)))
        pointers = map(self.ptr, (lengths, slopes, springs, forces))
        self.lib.sim_cableinfo(self.sim.h, *pointers)
        step = np.zeros(size)
        np.add.at(step, self.dofs, forces * (springs * (-self.model.L0 * (shares - before)))[self.cables])
        self.sim.solve(step, self.single)
        self.sim.rest(self.model.L0 * (1 - shares))
        bent = np.empty_like(nodes)
        self.lib.sim_warp(self.sim.h, self.ptr(nodes), self.ptr(step), self.double(1.0), self.ptr(bent))
        return min((nodes, nodes + step, bent), key=self.sim.energy).copy()

    def wrong(self, pose: Any, shares: np.ndarray) -> float:
        """Largest distance of a tip from where it should be [m]."""
        self.sim.rest(self.model.L0 * (1 - shares))
        exact = pose[0].copy()
        self.sim.newton(exact, tol=1e-11, maxit=20, f32=0, mode=6, warp=0, sticky=1)
        return float(np.linalg.norm((pose[0] - exact)[self.tips].reshape(-1, self.model.d), axis=1).max())


def from_rest(count: int, cables: int) -> np.ndarray:
    """Poses with one of each pair of antagonists taken in, 0 to 30 % of its length; those of the trial."""
    random = np.random.default_rng(1)
    poses = np.zeros((count, cables))
    for pose in poses:
        for pair in range(cables // 2):
            pose[2 * pair + random.integers(2)] = random.uniform(0, 0.3)
    return poses


def walk(size: float, count: int, cables: int) -> Iterator[np.ndarray]:
    """A random walk of pairs of antagonists that turns back at 30 %: that of the trial, its first pose before it."""
    random = np.random.default_rng(5)
    at, speed = random.uniform(-0.15, 0.15, cables // 2), random.normal(size=cables // 2)
    for _ in range(count + 1):
        yield np.stack([np.maximum(at, 0.0), np.maximum(-at, 0.0)], axis=1).ravel()
        speed = 0.9 * speed + 0.44 * random.normal(size=speed.size)
        at = at + size * speed / np.sqrt((speed * speed).mean())
        at = np.where(at > 0.3, 0.6 - at, np.where(at < -0.3, -0.6 - at, at))
        speed = np.where(np.abs(at) > 0.295, -speed, speed)


def measure(program: Any, poses: list[np.ndarray], row: Row, *, onwards: bool, judged: bool) -> None:
    """Solve all poses, from rest or each from the one before; the first of a walk is not counted."""
    pose, row.iterations = None, []
    for index, shares in enumerate(poses):
        began = time.process_time()
        pose, iterations = program.solve(shares, pose if onwards else None)
        spent = 1e3 * (time.process_time() - began)
        if index or not onwards:
            row.milliseconds.append(spent)
            row.iterations.append(iterations)
            if judged:
                row.error = max(row.error, program.wrong(pose, shares))


def compare(title: str, poses: list[np.ndarray], programs: dict[str, Any], rounds: int, *, onwards: bool) -> None:
    """Measure all programs in turn and print their lines."""
    rows = {name: Row() for name in programs}
    for turn in range(rounds):
        for name, program in programs.items():
            measure(program, poses, rows[name], onwards=onwards, judged=turn == rounds - 1)
    floor = next(iter(rows.values()))
    for name, row in rows.items():
        spent = np.array(row.milliseconds)
        ratio = np.median(spent) / np.median(floor.milliseconds), spent.mean() / np.mean(floor.milliseconds)
        print(
            f"| {title} | {name} | {np.median(spent):.2f} | {spent.mean():.2f} | {spent.max():.1f} "
            f"| {ratio[0]:.2f} | {ratio[1]:.2f} | {np.mean(row.iterations):.1f}, {max(row.iterations)} "
            f"| {1e6 * row.error:.2g} |",
            flush=True,
        )


def print_parts(program: Hydrostat) -> None:
    """Print what each part of an iteration of ours takes, mean of 30 calls in a row."""
    simulation, taken = program.simulation, np.full(program.count, 0.01)
    assembly, nodes = simulation.assembly, simulation.solve(taken).nodes
    data = assembly.hessian(nodes, taken).data
    factors = assembly.pattern.analysis.factorize(data)
    sides = np.random.default_rng(0).random((assembly.size, program.count))
    parts: dict[str, Callable[[], Any]] = {
        "energy": lambda: assembly.value(nodes, taken),
        "gradient": lambda: assembly.gradient(nodes, taken),
        "Hessian": lambda: assembly.hessian(nodes, taken),
        "Hessian, projected": lambda: assembly.hessian(nodes, taken, projection=1.0),
        "factorization": lambda: assembly.pattern.analysis.factorize(data),
        "one right-hand side": lambda: factors.solve(sides[:, 0]),
        f"{program.count} right-hand sides": lambda: factors.solve(sides),
        "step along arcs": lambda: simulation.body.warp(nodes, 1e-3 * sides[:, 0].reshape(nodes.shape)),
    }
    print("| part | us |\n|---|---|")
    for name, part in parts.items():
        part()
        began = time.process_time()
        for _ in range(30):
            part()
        print(f"| {name} | {1e6 * (time.process_time() - began) / 30:.0f} |")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trial", type=Path)
    parser.add_argument("--packages", type=Path, help="folder of Python packages that the trial needs")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--poses", type=int, default=30)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--accuracies", type=float, nargs="*", default=[1e-4, 1e-5], help="of rough solves [m]")
    parser.add_argument("--profile", action="store_true", help="ours alone, without the trial")
    parser.add_argument("--parts", action="store_true", help="print what the parts of an iteration of ours take")
    given = parser.parse_args()
    if given.packages:
        sys.path.append(str(given.packages))
    exact = Hydrostat(given.trial)
    if given.parts:
        print(f"\n{machine()}\n")
        print_parts(exact)
        return
    programs: dict[str, Any] = {}
    if not given.profile:
        programs = {"trial, f32": Trial(given.trial, True), "trial, f64": Trial(given.trial, False)}
    programs |= {"exact": exact}
    for accuracy in given.accuracies:
        programs[f"within {1e6 * accuracy:g} um"] = Hydrostat(given.trial, accuracy)
    print(f"\n{machine()}\n")
    print("| poses | program | median ms | mean | max | median / first | mean / first | iterations, most | error um |")
    print("|---|---|---|---|---|---|---|---|---|")
    exact.solve(from_rest(1, exact.count)[0], None)
    compare("from rest", list(from_rest(given.poses, exact.count)), programs, given.rounds, onwards=False)
    for size in STEPS:
        poses = list(walk(size, given.steps, exact.count))
        compare(f"steps of {100 * size:g} %", poses, programs, given.rounds, onwards=True)


if __name__ == "__main__":
    main()
