"""Where a sample may begin: from rest, from the nearest pose known, or from nodes that a network expects.

    hydrostat sample examples/cupping_hand --contact --count 1024 --out build/train
    python lab/learned_ik/sample_starts.py examples/cupping_hand build/train [--known 512]
                       [--targets 500] [--steps 2000]

The first samples are solved from rest; their nodes and exact slopes are what is known. A network learns from them the
principal components of all nodes. The next samples are solved from each start; where Newton's method does not arrive,
from hydrostat.progress import no_progress
from rest. Columns: targets of a kind, of which a marker ends more than 0.1 mm from where it ends from rest (with the
upper bound of this share at 95 %), iterations, CPU time of a pose with slopes, and poses a second. Kinds: whether parts
of the body touch in the pose found from rest, and whether the expected nodes cross the body itself.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip
from scipy.stats import beta

import hydrostat as hs
from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry import find_crossings
from hydrostat.learning import LearnOptions, Samples, TrainingSet, linear_map, train_forward
from hydrostat.progress import no_progress

COMPONENTS = 100
ELSEWHERE = 1e-4
"""A marker so far from where it ends from rest is on another branch [m]."""

Begin = Callable[[Vector], Nodes]


def learned(samples: Samples, nodes: np.ndarray, slopes: np.ndarray, steps: int) -> Begin:
    """Nodes as a network expects them, from poses that are known and their slopes."""
    low, high = samples.limits
    inputs, middle = 2 * (samples.contractions - low) / (high - low) - 1, nodes.reshape(len(nodes), -1).mean(axis=0)
    moved = nodes.reshape(len(nodes), -1) - middle
    slopes = slopes.reshape(*moved.shape, -1) * (0.5 * (high - low))
    seen = np.vstack([moved, *(0.3 * slopes[:, :, winch] for winch in range(slopes.shape[2]))])
    axes = np.linalg.eigh(seen.T @ seen)[1][:, -COMPONENTS:]
    unit = float(np.sqrt(np.square(moved @ axes).sum(axis=1).mean()))
    outputs = moved @ axes / unit
    training_set = TrainingSet(
        low=low,
        high=high,
        middle=np.zeros(COMPONENTS),
        unit=np.ones(COMPONENTS),
        inputs=inputs,
        outputs=outputs,
        jacobians=np.einsum("sxw,xc->scw", slopes, axes) / unit,
        coordinates=COMPONENTS,
        linear=linear_map(inputs, outputs),
    )
    network = train_forward(training_set, COMPONENTS, LearnOptions(members=1, steps=steps), no_progress).networks

    def expected(contractions: Vector) -> Nodes:
        scaled = 2 * (contractions - low) / (high - low) - 1
        return (middle + axes @ (unit * network.values(scaled)[0])).reshape(nodes.shape[1:])

    return expected


def tried(simulation: hs.Simulation, samples: Samples, begin: Begin | None) -> np.ndarray:
    """For each sample: iterations, CPU time [s], and whether it ends elsewhere than from rest."""
    rows = []
    for contractions, markers in zip(samples.contractions, samples.markers, strict=True):
        began, pose, spent = time.process_time(), None, 0
        if begin is not None:
            result = simulation.solver.relax(begin(contractions), contractions)
            pose, spent = simulation.make_pose(contractions, result), result.iterations
        if pose is None or not (pose.result.converged and pose.result.stable):
            pose = simulation.solve(contractions)
            spent += pose.result.iterations
        simulation.marker_jacobian(pose)
        seconds = time.process_time() - began
        away = np.linalg.norm(simulation.marker_anchors.positions(pose.nodes) - markers, axis=1).max()
        rows.append((spent, seconds, away > ELSEWHERE))
    return np.array(rows, dtype=float)


def line(way: str, kind: str, rows: np.ndarray) -> str:
    """A row of the table."""
    elsewhere, count = int(rows[:, 2].sum()), len(rows)
    bound = beta.ppf(0.95, elsewhere + 1, max(count - elsewhere, 0.5))
    milliseconds = 1e3 * rows[:, 1].mean()
    figures = f"{rows[:, 0].mean():12.1f}{milliseconds:9.0f}{1e3 / milliseconds:10.1f}"
    return f"{way:10}{kind:18}{count:8}{elsewhere:11}{bound:9.1%}{figures}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("samples", type=Path)
    parser.add_argument("--known", type=int, default=512)
    parser.add_argument("--targets", type=int, default=500)
    parser.add_argument("--steps", type=int, default=2000)
    given = parser.parse_args()
    samples, robot = Samples.read(given.samples).first(given.known + given.targets), hs.load_robot(given.robot)
    if samples.facts["contact"] and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    known, targets = samples.first(given.known), samples.only(np.arange(given.known, len(samples)))
    simulation, began = hs.Simulation(robot), time.process_time()
    poses = [simulation.solve(contractions) for contractions in known.contractions]
    nodes = np.array([pose.nodes for pose in poses])
    slopes = np.array([simulation.jacobian(pose) for pose in poses])
    spans, solved = known.limits[1] - known.limits[0], time.process_time()
    expected = learned(known, nodes, slopes, given.steps)
    print(machine())
    took = solved - began, time.process_time() - solved
    print(f"{robot.name}: {len(known)} poses known, {took[0]:.0f} s; network {took[1]:.0f} s")

    def nearest(contractions: Vector) -> Nodes:
        return nodes[np.linalg.norm((known.contractions - contractions) / spans, axis=1).argmin()]

    crossing = np.array([len(find_crossings(robot.body.mesh, expected(each))) > 0 for each in targets.contractions])
    kinds = {
        "all": np.ones(len(targets), bool),
        "touch": targets.touches,
        "touch nowhere": ~targets.touches,
        "expected to cross": crossing,
        "not to cross": ~crossing,
    }
    print(f"{'start':10}{'targets':18}   count  elsewhere    below  iterations   CPU ms  a second")
    ways: dict[str, Begin | None] = {"rest": None, "nearest": nearest, "network": expected}
    for way, begin in ways.items():
        rows = tried(simulation, targets, begin)
        for kind, which in kinds.items():
            if which.any():
                print(line(way, kind, rows[which]), flush=True)


if __name__ == "__main__":
    main()
