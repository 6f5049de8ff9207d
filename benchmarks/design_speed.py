"""How soon a search for cable routes has a network, and how good it is as time goes on.

    HYDROSTAT_THREADS=1 python benchmarks/design_speed.py [--bodies starfish,puppy] [--copies 9] [--plot speed.png]

Columns: CPU seconds of one thread until the first network and to the end, the error expected as built [mm] of the
first network, after 2 and 5 s, and of the network that is returned, and its counts. `--copies` designs each body so
many times more with its nodes moved by 1e-9 of its size, and prints the median and the worst of their errors as
built: a search whose choices turn on rounding shows there. Another checkout is measured by PYTHONPATH. The variable
keeps the search in one process: the times of networks on the way leave out those of a second one.
"""

import argparse
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import matplotlib as mpl

mpl.use("agg")
import matplotlib.pyplot as plt
import numpy as np
from design_bodies import BODIES, body_robot
from machine import machine
from matplotlib.ticker import LogLocator, NullFormatter

from hydrostat.design import DesignRequest, DesignStage, Network, find_network
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot

FLAT = ("starfish", "starfish_3", "robot", "pig", "letter_e", "letter_s", "puppy", "squid")


@dataclass
class Course:
    """Networks of one search as they came."""

    began: float = field(default_factory=time.process_time)
    seconds: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)  # expected as built [m]

    def __call__(self, stage: DesignStage) -> None:
        """Hear of a network."""
        self.seconds.append(time.process_time() - self.began)
        self.errors.append(stage.error)

    def at(self, seconds: float) -> float:
        """The error of the best network by then [m]; NaN before the first."""
        found = [error for when, error in zip(self.seconds, self.errors, strict=True) if when <= seconds]
        return min(found, default=np.nan)


def designed(name: str, robot: Robot) -> tuple[Network | None, Course]:
    """The network of a body, and how the search went; None where there is none."""
    body, course = BODIES[name], Course()
    request = DesignRequest(
        poses=tuple(robot.poses.values()), winches=body.winches, cables=body.cables, constraints=body.constraints
    )
    try:
        return find_network(robot, request, watch=course), course
    except HydrostatError as error:
        print(f"{name}: {error}")
        return None, course


def moved(robot: Robot, seed: int) -> Robot:
    """The robot with nodes moved by 1e-9 of its size."""
    mesh = robot.body.mesh
    noise = 1e-9 * mesh.size * np.random.default_rng(seed).standard_normal(mesh.nodes.shape)
    return replace(robot, body=replace(robot.body, mesh=replace(mesh, nodes=mesh.nodes + noise)))


def row(name: str, copies: int) -> tuple[str, Course]:
    """One line of the table, and the course of the search."""
    robot = body_robot(name)
    network, course = designed(name, robot)
    if network is None:
        return f"| {name} | none found |", course
    others = [designed(name, moved(robot, seed))[0] for seed in range(copies)]
    errors = [1e3 * one.expected_error for one in (network, *others) if one is not None]
    luck = f"{np.median(errors):.2f} | {max(errors):.2f}" if copies else " | "
    on_the_way = " | ".join(f"{1e3 * course.at(when):.2f}" for when in (course.seconds[0], 2.0, 5.0))
    counts = f"{len(network.robot.winches)}/{len(network.robot.cables)}"
    ends = f"{course.seconds[0]:.1f} | {network.seconds:.1f}"
    return f"| {name} | {ends} | {on_the_way} | {1e3 * network.expected_error:.2f} | {counts} | {luck} |", course


def draw(courses: dict[str, Course], file: Path) -> None:
    """Draw the error as built over time, one line a body."""
    figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
    worst_first = sorted(courses.items(), key=lambda pair: -min(pair[1].errors, default=0.0))
    for name, course in worst_first:
        if course.seconds:
            best = np.minimum.accumulate(1e3 * np.array(course.errors))
            axes.step(course.seconds, best, where="post", label=name, marker=".")
    axes.set(xscale="log", yscale="log", xlabel="CPU time [s]", ylabel="error expected as built [mm]")
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.spines[["top", "right"]].set_visible(False)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(f"Drawn: {file}")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", default=",".join(FLAT))
    parser.add_argument("--copies", type=int, default=0)
    parser.add_argument("--plot", type=Path, default=Path("build/design_speed.png"))
    arguments = parser.parse_args()
    print(machine())
    print("| body | first s | end s | first mm | 2 s | 5 s | built mm | winches/cables | median | worst of copies |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    courses = {}
    for name in arguments.bodies.split(","):
        line, courses[name] = row(name, arguments.copies)
        print(line, flush=True)
    draw(courses, arguments.plot)


if __name__ == "__main__":
    main()
