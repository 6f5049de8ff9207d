"""What a step in time costs, which scheme gives most for it, and how masses are best shared among nodes.

    python lab/time_integration/dynamics.py [--quick]

CPU time of one thread, after a step that is not counted.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from benchmark_bodies import hand_robot
from scipy.linalg import eigh

import hydrostat as hs
from hydrostat.geometry import Mesh
from hydrostat.mechanics import SCHEMES
from hydrostat.robot import Body, Material, Pin, PronyTerm, Robot, Source

GRAVITY = 9.80665
EXAMPLES = Path(__file__).parents[2] / "examples"
FOAM = Material(young=30e3, poisson=0.3, density=40)


def viscous(robot: Robot) -> Robot:
    """With a dashpot and two Maxwell branches."""
    branches = (PronyTerm(modulus=5e3, time=0.1), PronyTerm(modulus=5e3, time=1.0))
    return replace(
        robot, body=replace(robot.body, material=replace(robot.body.material, viscosity=50.0, relaxation=branches))
    )


def costs(quick: bool) -> Iterator[str]:
    """Time of a step while two winches take in cable."""
    robots = {"starfish": hs.load_robot(EXAMPLES / "starfish"), "hand": hand_robot()}
    for name, robot in robots.items():
        reach = np.zeros(len(robot.winches))
        reach[:2] = 0.02 if name == "starfish" else 0.008
        for kind, chosen in (("elastic", robot), ("viscous", viscous(robot))):
            simulation = hs.Simulation(chosen)
            for scheme in ("euler", "sdirk2", "sdirk3"):
                for dt in (0.005,) if quick else (0.02, 0.005, 0.001):
                    yield cost(simulation, name, kind, reach, scheme, dt, 10 if quick else 40)


def cost(simulation: hs.Simulation, name: str, kind: str, reach: np.ndarray, scheme: str, dt: float, count: int) -> str:
    options = hs.StepOptions(scheme=scheme)
    motions = simulation.play(hs.ContractionProfile.ramp(reach, 0.2), count * dt, dt, options=options)
    next(motions)
    next(motions)
    began, iterations = time.process_time(), 0
    for motion in motions:
        iterations += motion.result.iterations if motion.result else 0
    spent = (time.process_time() - began) / (count - 1)
    nodes = len(simulation.robot.body.mesh.nodes)
    row = f"| {name} | {nodes} | {kind} | {scheme} | {1e3 * dt:g} | {iterations / (count - 1):.1f} "
    return row + f"| {1e3 * spent:.1f} | {dt / spent:.2f} |"


def branches() -> Iterator[str]:
    """Time of a step of the starfish by how many Maxwell branches its material has."""
    robot = hs.load_robot(EXAMPLES / "starfish")
    for count in (0, 1, 3, 10):
        memory = tuple(PronyTerm(modulus=2e4 / count, time=10.0 ** (-2 + 0.3 * place)) for place in range(count))
        material = replace(robot.body.material, relaxation=memory)
        simulation = hs.Simulation(replace(robot, body=replace(robot.body, material=material)))
        reach = np.array([0.02, 0.02, 0.0])
        yield f"| {count} | {cost(simulation, '', '', reach, 'sdirk2', 0.005, 40).split('|')[-3].strip()} |"


def jumps(quick: bool) -> Iterator[str]:
    """Winches that jump to up to 40 % of their shortest cable within a step of 1 to 200 ms, and stay for another."""
    random = np.random.default_rng(0)
    for name in ("starfish", "pig", "squid", "letter_s"):
        robot = replace(hs.load_robot(EXAMPLES / name), gravity=(0.0, -GRAVITY))
        shortest = [min(c.length for c in robot.cables if c.winch == winch.name) for winch in robot.winches]
        for kind, chosen in (("elastic", robot), ("viscous", viscous(robot))):
            simulation = hs.Simulation(chosen, options=hs.NewtonOptions())
            motion, done, cut = simulation.motion_at_rest(), 0, 0
            for _ in range(5 if quick else 40):
                goal, dt = random.uniform(0, 0.4, len(shortest)) * shortest, 10 ** random.uniform(-3, -0.7)
                for _ in range(2):
                    try:
                        motion = simulation.step(motion, goal, dt, options=hs.StepOptions(halvings=0))
                    except hs.NotConvergedError:
                        motion, cut = simulation.motion_at_rest(), cut + 1
                    done += 1
            yield f"| {name} | {kind} | {done} | {cut} |"


def strip(columns: int, rows: int) -> Robot:
    """A flat strip 200 x 50 mm, held at its left end."""
    x, y = np.meshgrid(np.linspace(0, 0.2, columns + 1), np.linspace(-0.025, 0.025, rows + 1))
    elements = []
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            elements += [(a, b, c), (a, c, d)] if (row + column) % 2 == 0 else [(a, b, d), (b, c, d)]
    mesh = Mesh(np.column_stack([x.ravel(), y.ravel()]), np.array(elements))
    body = Body(source=Source.MESH, file="made.vtk", content=b"", material=FOAM, thickness=0.03, mesh=mesh)
    pin = Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=1e8)
    return Robot(name="strip", body=body, pins=(pin,), poses={})


def errors(quick: bool) -> Iterator[str]:
    """A viscous strip that is let go under gravity: how far nodes and velocities are off after 0.1 s."""
    robot = replace(viscous(strip(8, 2)), gravity=(0.0, -GRAVITY))
    simulation = hs.Simulation(robot)

    def end(count: int, scheme: str) -> hs.Motion:
        motion = simulation.motion_at_rest()
        for _ in range(count):
            motion = simulation.step(motion, np.zeros(0), 0.1 / count, options=hs.StepOptions(scheme=scheme))
        return motion

    fine = end(200 if quick else 600, "sdirk3")
    for minimizations in (12, 24, 48, 96):
        row = f"| {minimizations} "
        for scheme in ("euler", "sdirk2", "sdirk3"):
            motion = end(minimizations // len(SCHEMES[scheme].table), scheme)
            row += f"| {1e3 * np.abs(motion.nodes - fine.nodes).max():.2g} "
            row += f"| {1e3 * np.abs(motion.velocities - fine.velocities).max():.2g} "
        yield row + "|"


def oscillator() -> Iterator[str]:
    """A mass on a spring: loss of amplitude and lag of phase after ten periods, for minimizations a period."""
    for count in (30, 60, 120):
        row = f"| {count} "
        for scheme in ("euler", "bdf2", "sdirk2", "sdirk3"):
            solves = 1 if scheme == "bdf2" else len(SCHEMES[scheme].table)
            growth = amplification(scheme, 2j * np.pi * solves / count) ** (10 * count // solves)
            row += f"| {100 * (1 - abs(growth)):.2g} % | {abs(np.degrees(np.angle(growth))):.2g}° "
        yield row + "|"


def amplification(scheme: str, z: complex) -> complex:
    """By how much a step multiplies the solution of y' = z y; of BDF2 the root that is not spurious."""
    if scheme == "bdf2":
        roots = np.roots([1.5 - z, -2.0, 0.5])
        return complex(roots[np.argmin(abs(roots - np.exp(z)))])
    table = SCHEMES[scheme].table
    matrix = np.zeros((len(table), len(table)))
    for place, given in enumerate(table):
        matrix[place, : len(given)] = given
    one = np.ones(len(table))
    return complex(1 + z * matrix[-1] @ np.linalg.solve(np.eye(len(one)) - z * matrix, one))


def frequencies() -> Iterator[str]:
    """Lowest frequency of the strip, with masses at the nodes and with those of linear fields, beside a fine mesh."""
    finest = frequency(64, 16, lumped=True), frequency(64, 16, lumped=False)
    limit = sum(finest) / 2
    for columns in (8, 16, 32):
        found = frequency(columns, columns // 4, lumped=True), frequency(columns, columns // 4, lumped=False)
        row = f"| {columns} x {columns // 4} | {found[0]:.3f} | {100 * (found[0] / limit - 1):+.2f} % "
        yield row + f"| {found[1]:.3f} | {100 * (found[1] / limit - 1):+.2f} % |"


def frequency(columns: int, rows: int, *, lumped: bool) -> float:
    simulation = hs.Simulation(strip(columns, rows))
    mesh, masses = simulation.robot.body.mesh, simulation.dynamics.masses
    stiffness = simulation.assembly.hessian(mesh.nodes, np.zeros(0)).toarray()
    mass = np.diag(masses)
    if not lumped:
        shares = FOAM.density * 0.03 * mesh.volumes / 12
        mass = np.zeros_like(mass)
        for element, share in zip(mesh.elements, shares, strict=True):
            mass[np.ix_(element, element)] += share * (1 + np.eye(3))
    values = eigh(stiffness, np.kron(mass, np.eye(2)), eigvals_only=True, subset_by_index=[0, 0])
    return float(np.sqrt(values[0]) / (2 * np.pi))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few steps")
    quick = parser.parse_args().quick
    print(machine())
    print("\n| robot | nodes | body | scheme | dt ms | iterations | CPU ms a step | times real time |")
    print("|---|---|---|---|---|---|---|---|")
    for row in costs(quick):
        print(row, flush=True)
    schemes = "euler", "sdirk2", "sdirk3"
    print("\n| Maxwell branches | CPU ms a step |\n|---|---|")
    for row in branches():
        print(row, flush=True)
    print("\n| jumps of the winches | body | steps | not converged at once |\n|---|---|---|---|")
    for row in jumps(quick):
        print(row, flush=True)
    print("\nviscous strip let go, after 0.1 s: nodes mm, velocities mm/s")
    print("| minimizations | " + " | ".join(f"{name}: mm | mm/s" for name in schemes) + " |\n|" + 7 * "---|")
    for row in errors(quick):
        print(row, flush=True)
    print("\noscillator after ten periods: amplitude lost, phase off")
    names = " | ".join(f"{name}: lost | off" for name in ("euler", "bdf2", "sdirk2", "sdirk3"))
    print(f"| minimizations a period | {names} |\n|" + 9 * "---|")
    print(*oscillator(), sep="\n")
    print("\nlowest frequency of the strip [Hz]; the limit is the mean of both on a mesh of 64 x 16")
    print("| cells | at the nodes | off | of linear fields | off |\n|---|---|---|---|---|")
    for row in frequencies():
        print(row, flush=True)


if __name__ == "__main__":
    main()
