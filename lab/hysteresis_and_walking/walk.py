"""A plush puppy that no pin holds walks on the ground: way per cycle of its keyframes, and the gait that goes furthest.

    python lab/hysteresis_and_walking/walk.py [--tries 40] [--seed 0] [--cycles 6] [--friction 0.6] [--film FILE.gif]

The puppy of the gallery stands upright in its plane, on paws, under its weight, without its pins; nothing keeps it from
tilting. Its three winches follow the three keyframes of its walk (reach, gather, push) as raised cosines, each later
than the one before by the same lag. Amplitude, lag and period are searched: from the keyframes as they are played in
turn (lag 1/3) by random steps that grow where one is better and shrink where not. The way is that of the middle of
mass, from cycle 3 to the last. A gait counts by its shortest cycle, so that none is good by one stumble; one that tilts
the body by more than 20 degrees has fallen and counts for nothing. The best is told again with half the time step, with
twice the cycles, and with other friction: the figures hold as far as these agree.

Assumed: shear viscosity 400 Pa s (a tenth to a third of the stiffness is lost at 1 to 3 Hz), Coulomb friction.
"""

import argparse
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.errors import NotConvergedError
from hydrostat.plot import Frame, save_gif
from hydrostat.robot import Contact, Obstacle, Robot
from hydrostat.simulation import Motion, Simulation, StepOptions

PUPPY = Path(__file__).parents[2] / "examples" / "puppy"
VISCOSITY = 400.0
MOST_TILT = np.deg2rad(20.0)
STEP = 0.02


@dataclass(frozen=True)
class Gait:
    """Contractions that repeat."""

    amplitude: float  # the most that each winch takes in [m]
    lag: float  # of each winch behind the one before, in cycles
    period: float  # of a cycle [s]

    def at(self, time: float, winches: int) -> np.ndarray:
        """Contractions at a time [s], begun gently in the first cycle."""
        cycles = time / self.period - self.lag * np.arange(winches)
        return self.amplitude * min(1.0, time / self.period) * 0.5 * (1.0 - np.cos(2 * np.pi * cycles))

    def words(self) -> str:
        """What it is, in a row of a table."""
        return f"{1e3 * self.amplitude:5.1f} | {self.lag:5.2f} | {self.period:5.2f}"


def puppy(friction: float) -> Robot:
    """The gallery's puppy on the ground, with nothing else that holds it."""
    robot = hs.load_robot(PUPPY)
    low = float(robot.body.mesh.nodes[:, 1].min())
    ground = Obstacle(name="ground", shape="plane", at=(0.0, low - 1e-3), normal=(0.0, 1.0), friction=friction)
    material = replace(robot.body.material, viscosity=VISCOSITY)
    body = replace(robot.body, material=material)
    return replace(robot, body=body, pins=(), poses={}, gravity="-y", contact=Contact(), obstacles=(ground,))


def walk(simulation: Simulation, gait: Gait, cycles: int, step: float = STEP) -> list[Motion]:
    """The motion at the end of every step; it ends early where the puppy has fallen."""
    motion, motions = simulation.motion_at_rest(), []
    count = max(1, round(gait.period / step))
    for number in range(1, cycles * count + 1):
        goal = gait.at(number * gait.period / count, len(simulation.robot.winches))
        motion = simulation.step(motion, goal, gait.period / count, options=StepOptions(scheme="euler"))
        motions.append(motion)
        if abs(tilt(simulation, motion)) > MOST_TILT:
            break
    return motions


def tilt(simulation: Simulation, motion: Motion) -> float:
    """How far the body as a whole has turned [rad]."""
    masses = simulation.body.masses[:, None]
    rest, now = (
        nodes - (masses * nodes).sum(axis=0) / masses.sum() for nodes in (simulation.body.rest_unknowns, motion.nodes)
    )
    spread = (masses * rest).T @ now
    return float(np.arctan2(spread[0, 1] - spread[1, 0], spread[0, 0] + spread[1, 1]))


def ways(simulation: Simulation, motions: list[Motion], cycles: int) -> np.ndarray:
    """How far the middle of mass goes in each cycle after the second [m]; none where the puppy fell."""
    if abs(tilt(simulation, motions[-1])) > MOST_TILT:
        return np.zeros(0)
    count = len(motions) // cycles
    masses = simulation.body.masses
    places = np.array([masses @ motion.nodes[:, 0] / masses.sum() for motion in motions[2 * count - 1 :: count]])
    return np.diff(places)


def judged(simulation: Simulation, gait: Gait, cycles: int, step: float = STEP) -> tuple[float, str]:
    """The shortest way of a cycle [m], 0 where some go forward and some back; and a row of a table."""
    try:
        found = ways(simulation, walk(simulation, gait, cycles, step), cycles)
    except NotConvergedError as error:
        return 0.0, f"| {gait.words()} | {error} |||"
    if not len(found):
        return 0.0, f"| {gait.words()} | falls |||"
    mean, least, most = (1e3 * value for value in (found.mean(), found.min(), found.max()))
    steady = float(np.abs(found).min()) if abs(np.sign(found).sum()) == len(found) else 0.0
    return steady, f"| {gait.words()} | {mean:6.1f} | {least:.1f} to {most:.1f} | {mean / gait.period:.1f} |"


def search(simulation: Simulation, tries: int, seed: int, cycles: int) -> Gait:
    """Print each gait that is better than all before; the best."""
    random = np.random.default_rng(seed)
    best = Gait(0.02, 1 / 3, 1.0)
    low, high = np.array([0.005, -0.5, 0.3]), np.array([0.05, 0.5, 2.0])
    most, row = judged(simulation, best, cycles)
    print(row, flush=True)
    reach = 0.3
    for _ in range(tries):
        at = np.array([best.amplitude, best.lag, best.period])
        drawn = np.clip(at + reach * random.normal(size=3) * 0.5 * (high - low), low, high)
        gait = Gait(*map(float, drawn))
        way, row = judged(simulation, gait, cycles)
        reach = min(0.5, 1.5 * reach) if way > most else max(0.03, 0.9 * reach)
        if way > most:
            best, most = gait, way
            print(row, flush=True)
    return best


def film(simulation: Simulation, gait: Gait, cycles: int, file: Path) -> None:
    """Write a film of a gait."""
    motions = walk(simulation, gait, cycles)
    stride = max(1, round(0.04 / (motions[1].time - motions[0].time)))
    frames = [Frame.of(motion, words=f"{motion.time:.1f} s") for motion in motions[::stride]]
    print(f"wrote {save_gif(simulation.robot, frames, file, step=0.04, width=480)}")


def main() -> None:
    """Print a table, and write a film if asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--tries", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cycles", type=int, default=6)
    parser.add_argument("--friction", type=float, default=0.6)
    parser.add_argument("--film", type=Path)
    given = parser.parse_args()
    print(machine())
    began = time.process_time()
    simulation = Simulation(puppy(given.friction))
    print("| amplitude mm | lag, cycles | period s | mm a cycle | of single cycles | mm/s |\n|" + 6 * "---|")
    best = search(simulation, given.tries, given.seed, given.cycles)
    print("the best, with half the step, and with twice the cycles:")
    print(judged(simulation, best, given.cycles, 0.5 * STEP)[1])
    print(judged(simulation, best, 2 * given.cycles)[1])
    for friction in (0.3, 0.9):
        print(f"with friction {friction}: {judged(Simulation(puppy(friction)), best, given.cycles)[1]}")
    print(f"{time.process_time() - began:.0f} s CPU, {given.tries} gaits tried")
    if given.film:
        film(simulation, best, given.cycles, given.film)
    sys.exit(0 if judged(simulation, best, given.cycles)[0] else 1)


if __name__ == "__main__":
    main()
