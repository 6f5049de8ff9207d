"""Pushing a disc to a place: known tries, tries that are bettered, ridge regression, a learned policy.

    python lab/push_and_twist/push_learning.py [--draws 24] [--tries 100] [--better 5] [--learn 200] [--updates 4]

Four soft fingers in the plane stand about a disc of 20 mm with room of 16 mm on each side; one cable bends each of them
inwards. Two keyframes push, then the hand opens. Friction (+-30 %), radius (+-5 %) and start (+-5 mm along each axis)
are drawn and goals too; a way sees where the disc begins and its goal. Costs are time steps of the exact simulator. The
gripper looks alike after a quarter turn, so each try is known four times.
"""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from machine import machine

import numpy as np  # isort: skip

from hydrostat.robot import Robot
from hydrostat.training import (
    Listener,
    ManipulationPhysics,
    PushEnv,
    PushOptions,
    TrainMethod,
    TrainOptions,
    held_out_goals,
    train,
)

sys.path.append(str(Path(__file__).parents[2] / "tests" / "training"))
from flat_gripper import DISC, flat_gripper

RADIUS, MASS, TRAVEL, DRAG = 10e-3, 0.05, 12e-3, 30.0
KEYFRAMES = 2

Act = Callable[[dict[str, np.ndarray], int], np.ndarray]
"""What to do by what is seen and the number of the keyframe."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tries:
    """Episodes with actions drawn evenly: where the disc began, what was done, where it came to [m]."""

    began: np.ndarray
    done: np.ndarray
    ended: np.ndarray


def pushers() -> Robot:
    """The flat gripper with the cables that bend inwards, and a disc with room about it."""
    robot = flat_gripper(cells=6)
    kept = tuple(winch for winch in robot.winches if winch.name.endswith(" a"))
    names = {winch.name for winch in kept}
    return replace(
        robot,
        name="pushers",
        winches=tuple(replace(winch, travel=TRAVEL) for winch in kept),
        cables=tuple(cable for cable in robot.cables if cable.winch in names),
        obstacles=(replace(DISC, radius=RADIUS, mass=MASS),),
    )


def made(far: float) -> PushEnv:
    """The task, with goals so far away at most [m]."""
    return PushEnv(pushers(), options=PushOptions(steps=KEYFRAMES, far=far, physics=ManipulationPhysics(drag=DRAG)))


def pushed(env: PushEnv, act: Act, draw: dict[str, Any]) -> np.ndarray:
    """Where the disc comes to in an episode, from its usual place [m]."""
    seen, _ = env.reset(options=draw)
    for number in range(KEYFRAMES):
        seen, *_ = env.step(act(seen, number))
    return env.unit * seen["achieved_goal"]


def asked(env: PushEnv, seen: dict[str, np.ndarray]) -> np.ndarray:
    """Where the disc is and where it shall be [m], 4 numbers."""
    return env.unit * np.concatenate([seen["achieved_goal"], seen["desired_goal"]])


def tried(env: PushEnv, many: int) -> Tries:
    """So many tries on draws of their own."""
    random = np.random.default_rng(5)
    draws = held_out_goals(env, many, 5)
    done = random.uniform(-1.0, 1.0, (many, KEYFRAMES, env.action_space.shape[0]))  # type: ignore[index]
    ended = [
        pushed(env, lambda _, number, acts=acts: acts[number], draw) for acts, draw in zip(done, draws, strict=True)
    ]
    return Tries(began=np.array([draw["start"] for draw in draws]), done=done, ended=np.array(ended))


def turned_round(tries: Tries) -> Tries:
    """The same tries after none to three quarter turns: the gripper is alike then, and fingers do what the next did."""
    quarter = np.array([[0.0, 1.0], [-1.0, 0.0]])  # of rows
    parts = [tries]
    for _ in range(3):
        last = parts[-1]
        done = np.roll(last.done, 1, axis=-1)
        parts.append(Tries(began=last.began @ quarter, done=done, ended=last.ended @ quarter))
    began, done, ended = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("began", "done", "ended")
    )
    return Tries(began=began, done=done, ended=ended)


def nearest(tries: Tries, wanted: np.ndarray) -> np.ndarray:
    """What was done in the try whose begin and end are nearest."""
    known = np.column_stack([tries.began, tries.ended])
    return tries.done[np.linalg.norm(known - wanted, axis=1).argmin()]


def ridge(tries: Tries) -> Callable[[np.ndarray], np.ndarray]:
    """Actions by ridge regression on where the disc was and came to, and on products of these."""

    def seen(rows: np.ndarray) -> np.ndarray:
        rows = np.atleast_2d(rows) / 1e-2
        pairs = [rows[:, i] * rows[:, j] for i in range(4) for j in range(i, 4)]
        return np.column_stack([np.ones(len(rows)), rows, *pairs])

    known = seen(np.column_stack([tries.began, tries.ended]))
    flat = tries.done.reshape(len(known), -1)
    linear = np.linalg.solve(known.T @ known + np.eye(known.shape[1]), known.T @ flat)
    return lambda wanted: np.clip((seen(wanted) @ linear).reshape(tries.done.shape[1:]), -1.0, 1.0)


def bettered(env: PushEnv, acts: np.ndarray, draw: dict[str, Any], many: int) -> np.ndarray:
    """The best of what is given and tries about it, with the usual disc from where it is; each step about the best."""
    usual = {"goal": draw["goal"], "start": draw["start"]}
    random, spread, goal = np.random.default_rng(7), 0.4, env.unit * np.asarray(draw["goal"])

    def left(tries: np.ndarray) -> float:
        return float(np.linalg.norm(pushed(env, lambda _, number: tries[number], usual) - goal))

    best, least = acts, left(acts)
    for _ in range(many - 1):
        other = np.clip(best + spread * random.normal(size=acts.shape), -1.0, 1.0)
        found = left(other)
        spread *= 1.2 if found < least else 0.9
        best, least = (other, found) if found < least else (best, least)
    return best


def of_whole(env: PushEnv, plan: Callable[[np.ndarray], np.ndarray]) -> Act:
    """What a plan of both keyframes does, by what is seen at the beginning."""
    kept: dict[str, np.ndarray] = {}

    def act(seen: dict[str, np.ndarray], number: int) -> np.ndarray:
        if number == 0:
            kept["plan"] = plan(asked(env, seen))
        return kept["plan"][number]

    return act


def judged(name: str, env: PushEnv, acts: Sequence[Act], draws: Sequence[dict[str, Any]], cost: str) -> None:
    """Print a row of a table; each draw has an act of its own."""
    began = time.process_time()
    ended = np.array([pushed(env, act, draw) for act, draw in zip(acts, draws, strict=True)])
    left = 1e3 * np.linalg.norm(ended - env.unit * np.array([draw["goal"] for draw in draws]), axis=1)
    sure = 1.96 * left.std(ddof=1) / len(left) ** 0.5
    print(
        f"| {name} | {cost} | {len(draws)} | {left.mean():.1f} +- {sure:.1f} | {np.median(left):.1f} | "
        f"{np.percentile(left, 90):.1f} | {100 * (left < 5).mean():.0f} % | {time.process_time() - began:.0f} |",
        flush=True,
    )


def learned(far: float, actions: int, updates: int, out: Path) -> tuple[Act, int]:
    """A policy by TQC with hindsight, and the time steps that it cost."""
    env, judge_in = made(far), made(far)
    options = TrainOptions(
        method=TrainMethod.TQC,
        steps=actions,
        eval_interval=max(1, actions // 2),
        layers=(64, 64),
        updates=updates,
        learning_rate=1e-3,
    )
    few = held_out_goals(judge_in, 4, 1)
    model, curve = train(
        env,
        few,
        options,
        out,
        judge_in=judge_in,
        listener=Listener(point=lambda point: print(f"  {point}", flush=True)),
    )
    return lambda seen, _: model.predict(seen, deterministic=True)[0], curve[-1].equilibria


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--draws", type=int, default=24, help="that none has seen")
    parser.add_argument("--tries", type=int, default=100, help="episodes at random that are known; 0: none")
    parser.add_argument("--better", type=int, default=5, help="tries for each goal from the nearest on; 0: none")
    parser.add_argument("--learn", type=int, default=200, help="actions; 0: none")
    parser.add_argument("--updates", type=int, default=4, help="of networks after each action")
    parser.add_argument("--far", type=float, default=15.0, help="goals are within this [mm]")
    parser.add_argument("--out", type=Path, default=Path("build/push"))
    given = parser.parse_args()
    env = made(1e-3 * given.far)
    draws, many = held_out_goals(env, given.draws, 0), given.draws
    print(machine())
    print(f"pushers: {len(env.robot.body.mesh.nodes)} nodes, goals within {given.far:g} mm, {KEYFRAMES} keyframes")
    print(f"| way | time steps | draws | mean mm | median | 90 % | below 5 mm | s |\n|{8 * '---|'}")
    still = -np.ones((KEYFRAMES, env.action_space.shape[0]))  # type: ignore[index]
    judged("nothing done", env, [of_whole(env, lambda _: still)] * many, draws, "0")
    cost, tries = 0, None
    if given.tries:
        before = env.equilibria
        tries = tried(env, given.tries)
        cost = env.equilibria - before
        away = 1e3 * np.linalg.norm(tries.ended - tries.began, axis=1)
        print(f"  tries move the disc by {np.median(away):.1f} mm, {np.percentile(away, 90):.1f} at 90 %", flush=True)
        tries = turned_round(tries)
        near, fitted = of_whole(env, lambda wanted: nearest(tries, wanted)), of_whole(env, ridge(tries))
        judged("nearest known try", env, [near] * many, draws, f"{cost}")
        judged("ridge regression of the tries", env, [fitted] * many, draws, f"{cost}")
    if given.learn:
        act, spent = learned(1e-3 * given.far, given.learn, given.updates, given.out)
        judged("TQC with hindsight", env, [act] * many, draws, f"{spent}")
    if given.better and tries is not None:
        plans = []
        for draw in draws:
            wanted = np.concatenate([draw["start"], env.unit * np.asarray(draw["goal"])])
            plans.append(bettered(env, nearest(tries, wanted), draw, given.better))
        acts = [of_whole(env, lambda _, plan=plan: plan) for plan in plans]
        judged("nearest, bettered for each goal", env, acts, draws, f"{cost}, {15 * given.better} a goal")


if __name__ == "__main__":
    main()
