"""Reaching with cables that rub: what a model without friction leaves, and what feedback and policies make of it.

    python lab/hysteresis_and_walking/hysteresis.py [ROBOT] [--friction 0.2] [--goals 60] [--steps 5]
                       [--learn 1500] [--seeds 3]

Each goal and each start is drawn as in `hydrostat/ReachWithHysteresis-v0`; all ways have the same ones. The model is
the robot without friction. Ways:

    model       contractions by inverse kinematics of the model, kept for all actions
    by rest     the same, after a first action that lets all cable out
    feedback    the model's contractions, then after each look at the markers a bounded least-squares step by the
                model's Jacobian at the present contractions towards what is still missing
    policy      learned by trial with hindsight (SAC) in the robot with friction, from as many actions as --learn says

Columns: actions of an episode; interquartile mean of what is left at its end in mm, over goals, or of policies over
the means of seeds; the mean, which alone compares both; the 90 % quantile, share within 5 mm, equilibria of the robot
with friction that each policy used to learn, CPU time.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from machine import machine

import numpy as np  # isort: skip

from scipy.optimize import lsq_linear

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.learning import TANH_SCALE
from hydrostat.training import HysteresisEnv, ReachOptions, TrainOptions, held_out_goals, judge, train
from hydrostat_lab.verdict import interquartile

Act = Callable[[dict[str, Vector]], np.ndarray]


class Model:
    """The robot without friction, as a way to act: it sees what a policy sees."""

    def __init__(self, env: HysteresisEnv, *, by_rest: bool = False, feedback: bool = False) -> None:
        smooth = [replace(cable, friction=0.0) for cable in env.robot.cables]
        self.simulation = hs.Simulation(env.robot.with_network(env.robot.winches, smooth))
        self.env, self.by_rest, self.feedback = env, by_rest, feedback
        winches = env.robot.winches
        self.low, self.high = (np.array(part) for part in zip(*((-w.release, w.travel) for w in winches), strict=True))

    def __call__(self, seen: dict[str, Vector]) -> np.ndarray:
        """The action for an observation."""
        if self.env.taken_steps == 0:
            self.taken = self.inverted(seen["desired_goal"])
            return self.action(np.zeros(len(self.low)) if self.by_rest else self.taken)
        if self.feedback:
            self.taken = self.corrected(seen)
        return self.action(self.taken)

    def inverted(self, goal: Vector) -> Vector:
        """Contractions of the model for a goal as it is observed."""
        places = (self.env.unit * goal + self.env.rest).reshape(len(self.env.robot.markers), -1)
        names = [marker.name for marker in self.env.robot.markers]
        targets = dict(zip(names, map(tuple, places.tolist()), strict=True))
        return hs.solve_ik(self.simulation, targets).pose.contractions

    def corrected(self, seen: dict[str, Vector]) -> Vector:
        """Contractions a step nearer, by the slopes of the model."""
        pose = self.simulation.solve(self.taken, strict=False)
        slopes = self.simulation.marker_jacobian(pose).reshape(-1, len(self.low))
        missing = self.env.unit * (seen["desired_goal"] - seen["achieved_goal"])
        reach = 0.25 * (self.high - self.low)
        low, high = np.maximum(self.low - self.taken, -reach), np.minimum(self.high - self.taken, reach)
        damping = 1e-2 * np.linalg.norm(slopes, 2) * np.eye(len(self.low))
        rows, sides = np.concatenate([slopes, damping]), np.concatenate([missing, np.zeros(len(self.low))])
        return self.taken + lsq_linear(rows, sides, bounds=(low - 1e-12, high + 1e-12)).x

    def action(self, taken: Vector) -> np.ndarray:
        """The action that takes in so much."""
        return (2.0 * (taken - self.low) / (self.high - self.low) - 1.0) / TANH_SCALE


def policies(make: Callable[[], HysteresisEnv], actions: int, seeds: int) -> tuple[list[Act], int]:
    """Policies learned by trial, and how many equilibria each has used."""
    found: list[Act] = []
    used = 0
    for seed in range(seeds):
        env = make()
        few = held_out_goals(make(), 2, seed + 100)
        options = TrainOptions(steps=actions, seed=seed, eval_interval=actions)
        with TemporaryDirectory() as folder:
            learner, curve = train(env, few, options, Path(folder))
        used = curve[-1].equilibria
        found.append(lambda seen, learner=learner: learner.predict(seen, deterministic=True)[0])
    return found, used


def row(name: str, env: HysteresisEnv, acts: list[Act], goals: list, used: int, began: float) -> None:
    """Judge a way and print what it left."""
    left = np.array([1e3 * judge(env, act, goals) for act in acts])
    mean = interquartile(left.mean(axis=0) if len(acts) == 1 else left.mean(axis=1))
    print(
        f"{name:10}{env.steps:8}   {mean.mean:6.2f} ({mean.low:.2f}-{mean.high:.2f})".ljust(44)
        + f"{left.mean():8.2f}{np.quantile(left, 0.9):8.2f}{100 * (left < 5.0).mean():7.0f} %{used:8}"
        f"{time.process_time() - began:8.0f}",
        flush=True,
    )


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", nargs="?", default="gallery:starfish")
    parser.add_argument("--friction", type=float, nargs="+", default=[0.2])
    parser.add_argument("--goals", type=int, default=60)
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--learn", type=int, nargs="*", default=[1500])
    parser.add_argument("--seeds", type=int, default=3)
    given = parser.parse_args()
    print(machine())
    for friction in given.friction:
        table(given, friction)


def table(given: argparse.Namespace, friction: float) -> None:
    """Print the table of one friction."""

    def make(steps: int = given.steps) -> HysteresisEnv:
        return HysteresisEnv(given.robot, friction=friction, options=ReachOptions(steps=steps))

    env = make()
    goals = held_out_goals(env, given.goals, 0)
    print(f"{env.robot.name}, {1e3 * env.unit:.0f} mm, friction {friction:g}; {len(goals)} goals, from poses at random")
    print(
        f"{'way':10}{'actions':>8}   {'left, mm (95 %)':25}{'mean':>6}{'p90':>8}{'< 5 mm':>9}{'learned':>8}{'CPU s':>8}"
    )
    for name, steps, more in (
        ("model", 1, {}),
        ("by rest", 2, {"by_rest": True}),
        ("feedback", given.steps, {"feedback": True}),
    ):
        began, of = time.process_time(), make(steps)
        row(name, of, [Model(of, **more)], goals, 0, began)
    for actions in given.learn:
        began = time.process_time()
        learned, used = policies(make, actions, given.seeds)
        row("policy", env, learned, goals, used, began)


if __name__ == "__main__":
    main()
