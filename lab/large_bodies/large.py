"""One equilibrium of large bodies from rest: where its time goes, and what its arithmetic alone would take.

    python lab/large_bodies/large.py [--sizes 4.7,3.5,3.0,4.2/2] [--threads 1,2] [--share 0.1]

The cupping hand by element size [mm]; "/2" cuts each edge of that mesh in two, for bodies larger than our mesher makes.
All cables take in random contractions up to a share of their length. Wall clock of the second of two solves, for the
first one touches memory that the system still has to find. Arithmetic: factorizations x operations at the rate of BLAS
(dgemm of 2000, one thread) x threads; operations are multiplications and additions of a Cholesky factorization on these
fronts, zeros from merged fronts included. Each size and number of threads has a process of its own.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from typing import Any

from machine import machine

import numpy as np  # isort: skip

from benchmark_bodies import hand_robot

from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonStatus
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation


def body_of(size: str) -> tuple[Robot, float]:
    """The hand, and the wall clock of its mesh [s]."""
    began = time.perf_counter()
    name, _, cut = size.partition("/")
    robot = hand_robot(1e-3 * float(name))
    if cut:
        robot = replace(robot, body=replace(robot.body, mesh=halved(robot.body.mesh)))
    return robot, time.perf_counter() - began


def halved(mesh: Mesh) -> Mesh:
    """Each tetrahedron as eight: its corners, and four within the octahedron of its edges' middles."""
    pairs = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
    edges = np.sort(mesh.elements[:, pairs], axis=2)
    keys, places = np.unique(edges[..., 0] * len(mesh.nodes) + edges[..., 1], return_inverse=True)
    one, other = np.divmod(keys, len(mesh.nodes))
    middles = places.reshape(-1, 6) + len(mesh.nodes)
    corners = np.concatenate([mesh.elements, middles], axis=1)  # 4: 01, 5: 02, 6: 03, 7: 12, 8: 13, 9: 23
    parts = [
        (0, 4, 5, 6),
        (4, 1, 7, 8),
        (5, 7, 2, 9),
        (6, 8, 9, 3),
        (4, 5, 6, 8),
        (4, 5, 8, 7),
        (5, 6, 8, 9),
        (5, 7, 9, 8),
    ]
    nodes = np.concatenate([mesh.nodes, 0.5 * (mesh.nodes[one] + mesh.nodes[other])])
    elements = corners[:, np.array(parts)].reshape(-1, 4)
    sides = nodes[elements[:, 1:]] - nodes[elements[:, :1]]
    wrong = np.linalg.det(sides) < 0
    elements[wrong] = elements[wrong][:, [0, 1, 3, 2]]
    return Mesh(nodes, elements)


def gemm_rate() -> float:
    """Operations a second of BLAS, one thread."""
    matrix = np.asfortranarray(np.random.default_rng(0).random((2000, 2000)))
    best = np.inf
    for _ in range(3):
        began = time.perf_counter()
        _ = matrix @ matrix
        best = min(best, time.perf_counter() - began)
    return 2 * 2000**3 / best


def measured(size: str, share: float) -> dict[str, Any]:
    """What one size takes, in this process."""
    robot, mesh_seconds = body_of(size)
    began = time.perf_counter()
    simulation = Simulation(robot)
    analysis = simulation.assembly.pattern.analysis
    analyzed = time.perf_counter() - began
    tree = analysis.tree
    dim = robot.body.mesh.dim
    columns, below = dim * np.diff(tree.first).astype(float), dim * np.diff(tree.starts).astype(float)
    operations = float((columns * (columns * columns / 3 + columns * below + below * below)).sum())
    counted = [0, 0.0]
    plain = analysis.factorize

    def factorize(data: np.ndarray) -> Any:
        began = time.perf_counter()
        factors = plain(data)
        counted[0] += 1
        counted[1] += time.perf_counter() - began
        return factors

    analysis.factorize = factorize
    lengths = simulation.cables.rest_lengths
    goal = np.zeros(len(robot.winches))
    goal[simulation.cables.winches] = np.random.default_rng(0).uniform(0.0, share, len(lengths)) * lengths
    taken, pose = [], None
    for _ in range(2):
        counted[:], pose, began = [0, 0.0], None, time.perf_counter()
        pose = simulation.solve(goal, strict=False)
        taken.append(time.perf_counter() - began)
    assert pose is not None
    import resource

    return {
        "nodes": len(robot.body.mesh.nodes),
        "elements": len(robot.body.mesh.elements),
        "mesh": mesh_seconds,
        "analysis": analyzed,
        "operations": operations,
        "entries": float((columns * (columns + below)).sum()),
        "first": taken[0],
        "solve": taken[1],
        "iterations": pose.result.iterations,
        "converged": pose.result.status is NewtonStatus.CONVERGED,
        "factorizations": counted[0],
        "factorizing": counted[1],
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def row(size: str, threads: int, share: float, rate: float) -> str:
    """A line of the table."""
    command = [sys.executable, __file__, "--measure", size, "--share", str(share), "--threads", str(threads)]
    given = {**os.environ, "HYDROSTAT_THREADS": str(threads)}
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=given)
    if ended.returncode:
        return f"| {size} | {threads} | failed: {ended.stderr.strip().splitlines()[-1:]} |"
    found = json.loads(ended.stdout.splitlines()[-1])
    arithmetic = found["factorizations"] * found["operations"] / (rate * threads)
    gigaflop, megabytes = found["operations"] / 1e9, 8e-6 * found["entries"]
    each = found["factorizing"] / max(found["factorizations"], 1)
    return (
        f"| {found['nodes']} | {threads} | {found['mesh']:.1f} | {found['analysis']:.2f} | {gigaflop:.1f} "
        f"| {megabytes:.0f} | {each:.3f} | {gigaflop / each:.0f} | {found['first']:.2f} "
        f"| {found['solve']:.2f} | {found['iterations']}{'' if found['converged'] else ', not converged'} "
        f"| {found['factorizations']} | {found['solve'] / arithmetic:.2f} | {found['memory']:.2f} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="4.7,3.5,3.0,4.2/2")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--share", type=float, default=0.1)
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        print(json.dumps(measured(given.measure, given.share)))
        return
    rate = gemm_rate()
    print(f"\n{machine()}; BLAS {rate / 1e9:.0f} Gflop/s\n")
    heads = "nodes, threads, mesh s, analysis s, Gflop, L MB, factors s, Gflop/s, first solve s, solve s, iterations, "
    heads += "factorizations, solve / arithmetic, peak GB"
    print(f"| {heads.replace(', ', ' | ')} |\n{'|---' * 14}|")
    for size in given.sizes.split(","):
        for threads in given.threads.split(","):
            print(row(size, int(threads), given.share, rate), flush=True)


if __name__ == "__main__":
    main()
