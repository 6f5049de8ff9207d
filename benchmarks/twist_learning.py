"""Turning a thing: keyframes by hand, keyframes that were searched, a learned policy, judged on draws none has seen.

    python benchmarks/twist_learning.py [--body flat|caging_gripper] [--draws 60] [--search 4000] [--learn 0]

A cycle is a few keyframes, after which the hand opens. For each cycle friction (+-30 %), radius (+-5 %) and start
(+-5 mm along each axis) are drawn. Costs are time steps of the exact simulator. The search (cross-entropy) begins at
the keyframes by hand and tries others on draws of its own; the policy (SAC with hindsight) adds to the best keyframes
what it sees fit.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from machine import machine

import numpy as np  # isort: skip

from flat_gripper import DRAG, flat_gripper

import hydrostat as hs
from hydrostat.robot import Obstacle
from hydrostat.training import ThingPhysics, TrainOptions, TwistEnv, TwistOptions, held_out_goals, train

TIED = (" a", " b")
BALL = Obstacle(name="ball", shape="sphere", at=(0.0, 0.0, 0.078), radius=33.5e-3, mass=0.03, friction=0.8)
KEYS = {
    "flat": ((10, 0), (35, 25), (0, 25)),
    "caging_gripper": ((14, 0), (24, 10), (10, 24), (0, 14)),
}
"""By hand: what all cables a and all cables b take in [mm]."""

TRAVEL, SPREAD, RESIDUAL = 45e-3, 4.0, 8.0
"""Most that is taken in [m], where the search begins [mm], and most that a policy adds [mm]."""

ENOUGH = 100.0
"""More counts for no more where keyframes are searched [degree]: all draws shall turn far, not one very far."""

Act = Callable[[dict[str, np.ndarray], int], np.ndarray]
"""What to do by what is seen and the number of the keyframe."""


class AddedTo(TwistEnv):
    """Twist where an action is added to keyframes."""

    keys: np.ndarray = np.zeros((0, 2))

    def contractions(self, action: np.ndarray) -> np.ndarray:
        """Those of the keyframe, and a share of what may be added [m]."""
        key = self.keys[min(self.taken_steps, self.steps) - 1]
        return super().contractions(as_action(key + RESIDUAL * np.asarray(action)))


def made(body: str, steps: int, kind: type[TwistEnv] = TwistEnv) -> TwistEnv:
    """The task on a body, with so many keyframes in a cycle."""
    options: dict[str, Any] = {"steps": steps, "tied": TIED, "travel": TRAVEL}
    if body == "flat":
        return kind(flat_gripper(), options=TwistOptions(**options, physics=ThingPhysics(drag=DRAG)))
    physics = ThingPhysics(hold=100.0)
    robot = hs.load_robot(f"gallery:{body}")
    return kind(robot, thing=BALL, options=TwistOptions(**options, physics=physics), contact=True)


def as_action(millimetres: np.ndarray) -> np.ndarray:
    """The action that takes in so much."""
    return np.clip(2e-3 * np.asarray(millimetres, dtype=float) / TRAVEL - 1.0, -1.0, 1.0)


def cycle(env: TwistEnv, act: Act, draw: dict[str, Any]) -> tuple[float, float]:
    """How far the thing turns in a cycle [degree], and how far it has moved [mm]."""
    seen, info = env.reset(options=draw)
    for number in range(env.steps):
        seen, _, _, _, info = env.step(act(seen, number))
    return float(np.rad2deg(info["turned"])), 1e3 * info["moved"]


def playing(keys: np.ndarray) -> Act:
    """Keyframes, whatever is seen."""
    return lambda _, number: as_action(keys[number])


def judged(name: str, env: TwistEnv, act: Act, draws: Sequence[dict[str, Any]], cost: int) -> None:
    """Print a row of a table."""
    if not draws:
        return
    began = time.process_time()
    rows = np.array([cycle(env, act, draw) for draw in draws])
    turned, moved = rows.T
    friction, kept = np.array([draw["friction"] for draw in draws]), turned >= 90.0
    low = np.mean(turned[friction < 0.9]) if (friction < 0.9).any() else np.nan
    high = np.mean(turned[friction > 1.1]) if (friction > 1.1).any() else np.nan
    print(
        f"| {name} | {cost} | {len(draws)} | {turned.mean():.1f} | {np.percentile(turned, 10):.1f}, "
        f"{np.median(turned):.1f}, {np.percentile(turned, 90):.1f} | {low:.1f}, {high:.1f} | "
        f"{100 * kept.mean():.0f} % | "
        f"{np.median(moved):.1f}, {moved.max():.1f} | {time.process_time() - began:.0f} |",
        flush=True,
    )


def searched(
    env: TwistEnv, keys: np.ndarray, budget: int, *, many: int, each: int, spread: float = SPREAD, seed: int = 0
) -> tuple[np.ndarray, int]:
    """Keyframes [mm] by the cross-entropy method, so many at a time on so many draws each, and what they cost."""
    random, before = np.random.default_rng([seed, 5]), env.equilibria
    middle, around = keys.astype(float), np.full(keys.shape, spread)
    while True:
        begun, draws = env.equilibria, held_out_goals(env, each, int(random.integers(1_000_000)))
        tried = np.clip(middle + around * random.normal(size=(many, *keys.shape)), 0.0, 1e3 * TRAVEL)
        tried[0] = middle
        turned = [np.mean([min(cycle(env, playing(one), draw)[0], ENOUGH) for draw in draws]) for one in tried]
        best = tried[np.argsort(turned)[::-1][: max(2, many // 3)]]
        middle, around = best.mean(axis=0), 0.5 * around + 0.5 * np.maximum(best.std(axis=0), 0.5)
        cost = env.equilibria - before
        print(
            f"  {cost} time steps: {max(turned):.1f}, {np.median(turned):.1f}; {np.round(middle, 1).tolist()}",
            flush=True,
        )
        if cost + (env.equilibria - begun) > budget:
            return middle, cost


def learned(body: str, keys: np.ndarray, actions: int, out: Path) -> tuple[Act, int]:
    """A policy that adds to keyframes, and the time steps that it cost."""
    env, judge_in = made(body, len(keys), AddedTo), made(body, len(keys), AddedTo)
    AddedTo.keys = keys
    few = held_out_goals(judge_in, 2, 1)
    options = TrainOptions(steps=actions, every=max(1, actions // 2), layers=(64, 64), rate=1e-3)
    model, curve = train(env, few, options, out, judge_in=judge_in, tell=lambda point: print(f"  {point}", flush=True))

    def act(seen: dict[str, np.ndarray], number: int) -> np.ndarray:
        return as_action(keys[number] + RESIDUAL * model.predict(seen, deterministic=True)[0])

    return act, curve[-1].equilibria


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--body", choices=KEYS, default="flat")
    parser.add_argument("--draws", type=int, default=60, help="that none has seen; 0: nothing is judged")
    parser.add_argument("--search", type=int, default=4000, help="time steps; 0: none")
    parser.add_argument("--many", type=int, nargs=2, default=(12, 4), help="tries at a time, draws of each")
    parser.add_argument("--learn", type=int, default=0, help="actions; 0: none")
    parser.add_argument("--keys", type=float, nargs="+", help="[mm], a and b in turn, any number")
    parser.add_argument("--spread", type=float, default=SPREAD, help="of the tries at first [mm]")
    parser.add_argument("--out", type=Path, default=Path("build/twist"))
    given = parser.parse_args()
    print(machine())
    keys = np.array(given.keys or KEYS[given.body], dtype=float).reshape(-1, 2)
    env = made(given.body, len(keys))
    draws = held_out_goals(env, given.draws, 0)
    print(f"{given.body}: {len(env.robot.body.mesh.nodes)} nodes, {env.options.physics.beats} time steps a keyframe")
    head = "| way | time steps | draws | degrees a cycle | 10 %, median, 90 % | friction low, high | 90 or more |"
    print(f"{head} moved mm, most | s |\n|{9 * '---|'}")
    judged("keyframes as given" if given.keys else "keyframes by hand", env, playing(keys), draws, 0)
    cost = 0
    if given.search:
        keys, cost = searched(env, keys, given.search, many=given.many[0], each=given.many[1], spread=given.spread)
        judged("keyframes that were searched", env, playing(keys), draws, cost)
    if given.learn:
        act, more = learned(given.body, keys, given.learn, given.out)
        judged("policy on these", env, act, draws, cost + more)


if __name__ == "__main__":
    main()
