"""What the physics of a body cost once, and each network on it; prints a table.

    python lab/shared_body/shared_body.py

CPU time on one thread, the least of several runs. A "network" is `Simulation(robot, body=...)`: its cables' energies;
"its analysis" is the order of elimination and the fronts of that network, made when it is first factorized.
"""

import os
import time
from collections.abc import Callable

os.environ["OPENBLAS_NUM_THREADS"] = "1"

from machine import machine

import hydrostat as hs
from hydrostat.robot import gallery_folder
from hydrostat.simulation import BodyPhysics


def least(work: Callable[[], object], runs: int) -> float:
    """CPU time of the quickest run [ms]."""
    best = float("inf")
    for _ in range(runs):
        before = time.process_time()
        work()
        best = min(best, time.process_time() - before)
    return 1e3 * best


def whole(robot: hs.Robot) -> BodyPhysics:
    """Physics of a body with all that is made when first asked for."""
    body = BodyPhysics(robot)
    _ = body.warp, body.rest_factors
    return body


def main() -> None:
    """Measure the flat starfish and two bodies in space."""
    print(machine())
    print("\n| robot | nodes | cables | body [ms] | network [ms] | its analysis [ms] | a solve from rest [ms] |")
    print("|---|---|---|---|---|---|---|")
    for name in ("starfish", "cupping_hand", "trunk"):
        robot = hs.load_robot(gallery_folder(name))
        body = whole(robot)
        pulled = {winch.name: 0.3 * winch.travel for winch in robot.winches[:1]}
        hs.Simulation(robot, body=body).solve(pulled)

        def fresh(robot: hs.Robot = robot, body: BodyPhysics = body) -> hs.Simulation:
            return hs.Simulation(robot, body=body)

        network = least(fresh, 20)
        analysis = least(lambda fresh=fresh: fresh().assembly.pattern.analysis, 10) - network
        ready = fresh()
        ready.solve(pulled)
        solve = least(lambda ready=ready, pulled=pulled: ready.solve(pulled), 10)
        made = least(lambda robot=robot: whole(robot), 5)
        print(
            f"| {name} | {len(robot.body.mesh.nodes)} | {len(robot.cables)} | {made:.1f} | {network:.2f} | "
            f"{analysis:.1f} | {solve:.1f} |"
        )


if __name__ == "__main__":
    main()
