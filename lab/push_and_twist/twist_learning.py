"""Turning an object: keyframes by hand, keyframes that were searched, a learned policy, judged on draws none has seen.

    python lab/push_and_twist/twist_learning.py [--body flat|caging_gripper] [--draws 60] [--search 4000]
                       [--feel 0] [--learn 0]

A cycle is a few keyframes, after which the hand opens. For each cycle friction (+-30 %), radius (+-5 %) and start
(+-5 mm along each axis) are drawn. Costs are time steps of the exact simulator. The search (cross-entropy) begins at
the keyframes by hand and tries others on draws of its own. Two policies add to the best keyframes what they see fit:
a linear one of what was seen, found by the same search (`--feel`), and networks by TQC with hindsight (`--learn`).
"""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from machine import machine

import numpy as np  # isort: skip

from twist_feedback import corrected, rule, seen_by, usual_turns

import hydrostat as hs
from hydrostat.robot import Obstacle
from hydrostat.training import (
    Listener,
    ManipulationPhysics,
    TrainMethod,
    TrainOptions,
    TwistEnv,
    TwistOptions,
    held_out_goals,
    train,
)

sys.path.append(str(Path(__file__).parents[2] / "tests" / "training"))
from flat_gripper import DRAG, flat_gripper

TIED = (" a", " b")
BALL = Obstacle(name="ball", shape="sphere", at=(0.0, 0.0, 0.078), radius=33.5e-3, mass=0.03, friction=0.8)
KEYS = {
    "flat": ((10, 0), (35, 25), (0, 25)),
    "caging_gripper": ((14, 0), (24, 10), (10, 24), (0, 14)),
}
"""By hand: what all cables a and all cables b take in [mm]."""

TRAVEL, SPREAD, RESIDUAL = 45e-3, 4.0, 3.0
"""Most that is taken in [m], where the search begins [mm], and most that a policy adds [mm]."""

ENOUGH = 100.0
"""More counts for no more where keyframes are searched [degree]: all draws shall turn far, not one very far."""

ASKED = 140.0
"""What a policy is asked for [degree]: so far that more is always better."""

Act = Callable[[dict[str, np.ndarray], int], np.ndarray]
"""What to do by what is seen and the number of the keyframe."""


class AddedTo(TwistEnv):
    """Twist where an action is added to keyframes."""

    keys: np.ndarray = np.zeros((0, 2))

    def contractions(self, action: np.ndarray) -> np.ndarray:
        """Those of the keyframe, and a share of what may be added [m]."""
        key = self.keys[min(self.taken_steps, self.steps) - 1]
        return super().contractions(as_action(key + RESIDUAL * np.asarray(action)))


def made(body: str, steps: int, kind: type[TwistEnv] = TwistEnv, **more: Any) -> TwistEnv:
    """The task on a body, with so many keyframes in a cycle."""
    options: dict[str, Any] = {"steps": steps, "tied": TIED, "travel": TRAVEL, **more}
    if body == "flat":
        return kind(flat_gripper(), options=TwistOptions(**options, physics=ManipulationPhysics(drag=DRAG)))
    physics = ManipulationPhysics(hold=100.0)
    robot = hs.load_robot(f"gallery:{body}")
    return kind(robot, obstacle=BALL, options=TwistOptions(**options, physics=physics), contact=True)


def as_action(millimeters: np.ndarray) -> np.ndarray:
    """The action that takes in so much."""
    return np.clip(2e-3 * np.asarray(millimeters, dtype=float) / TRAVEL - 1.0, -1.0, 1.0)


def cycle(env: TwistEnv, act: Act, draw: dict[str, Any]) -> tuple[float, float]:
    """How far the obstacle turns in a cycle [degree], and how far it has moved [mm]."""
    seen, info = env.reset(options=draw)
    for number in range(env.steps):
        seen, _, _, _, info = env.step(act(seen, number))
    return float(np.rad2deg(info["turned"])), 1e3 * info["moved"]


def playing(keys: np.ndarray) -> Act:
    """Keyframes, whatever is seen."""
    return lambda _, number: as_action(keys[number])


def feeling(env: TwistEnv, usual: np.ndarray, numbers: np.ndarray) -> Act:
    """Keyframes that give way to what is seen, by a rule."""

    def act(seen: dict[str, np.ndarray], number: int) -> np.ndarray:
        return as_action(corrected(numbers[number], *seen_by(env, seen, usual[number])).ravel())

    return act


def judged(
    name: str, env: TwistEnv, act: Act, draws: Sequence[dict[str, Any]], cost: int, beside: np.ndarray | None = None
) -> np.ndarray:
    """Print a row of a table, and what is won over others on the same draws; turns are given back [degree]."""
    if not draws:
        return np.zeros(0)
    began = time.process_time()
    rows = np.array([cycle(env, act, draw) for draw in draws])
    turned, moved = rows.T
    friction, kept = np.array([draw["friction"] for draw in draws]), turned >= 90.0
    low = np.mean(turned[friction < 0.9]) if (friction < 0.9).any() else np.nan
    high = np.mean(turned[friction > 1.1]) if (friction > 1.1).any() else np.nan
    print(
        f"| {name} | {cost} | {len(draws)} | {turned.mean():.1f} | {np.percentile(turned, 10):.1f}, "
        f"{np.median(turned):.1f}, {np.percentile(turned, 90):.1f} | {low:.1f}, {high:.1f} | "
        f"{100 * kept.mean():.0f} % | {100 * (turned >= ENOUGH).mean():.0f} % | "
        f"{np.median(moved):.1f}, {moved.max():.1f} | {time.process_time() - began:.0f} |",
        flush=True,
    )
    if beside is not None:
        won = turned - beside
        around = 1.96 * won.std(ddof=1) / len(won) ** 0.5
        print(f"  {won.mean():+.1f} +- {around:.1f} degrees beside the first row, draw by draw", flush=True)
    return turned


def searched(
    env: TwistEnv,
    begin: np.ndarray,
    spread: np.ndarray,
    playing: Callable[[np.ndarray], Act],
    budget: int,
    *,
    many: int,
    each: int,
    enough: float,
) -> tuple[np.ndarray, int]:
    """Numbers of a policy by the cross-entropy method, so many tries at a time on so many draws, and what they cost."""
    random, before = np.random.default_rng([0, 5]), env.equilibria
    middle, around = begin.astype(float), np.broadcast_to(spread, begin.shape)
    while True:
        begun, draws = env.equilibria, held_out_goals(env, each, int(random.integers(1_000_000)))
        tried = middle + around * random.normal(size=(many, *begin.shape))
        tried = np.clip(tried, 0.0, 1e3 * TRAVEL) if begin.ndim == 2 else tried
        tried[0] = middle
        turned = [np.mean([min(cycle(env, playing(one), draw)[0], enough) for draw in draws]) for one in tried]
        best = tried[np.argsort(turned)[::-1][: max(2, many // 3)]]
        middle, around = best.mean(axis=0), 0.5 * around + 0.5 * np.maximum(best.std(axis=0), 0.5)
        cost = env.equilibria - before
        print(
            f"  {cost} time steps: {max(turned):.1f}, {np.median(turned):.1f}; {np.round(middle, 1).tolist()}",
            flush=True,
        )
        if cost + (env.equilibria - begun) > budget:
            return middle, cost


def learned(body: str, keys: np.ndarray, actions: int, out: Path, *, again: bool) -> tuple[Act, int]:
    """A policy that adds to keyframes, asked for `ASKED`, and the time steps that it cost; again: as it is in `out`."""
    asked = (np.deg2rad(ASKED), np.deg2rad(ASKED))
    env, judge_in = (made(body, len(keys), AddedTo, turn=asked) for _ in range(2))
    AddedTo.keys = keys
    few = held_out_goals(judge_in, 4, 1)
    options = TrainOptions(
        method=TrainMethod.TQC,
        steps=actions,
        eval_interval=max(1, actions // 4),
        layers=(64, 64),
        updates=4,
        learning_rate=1e-3,
    )

    def tell(point: object) -> None:
        print(f"  {point}", flush=True)

    model, curve = train(env, few, options, out, judge_in=judge_in, resume=again, listener=Listener(point=tell))

    def act(seen: dict[str, np.ndarray], number: int) -> np.ndarray:
        seen = {**seen, "desired_goal": np.array([ASKED / 180.0])}
        return as_action(keys[number] + RESIDUAL * model.predict(seen, deterministic=True)[0])

    return act, curve[-1].equilibria


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--body", choices=KEYS, default="flat")
    parser.add_argument("--draws", type=int, default=60, help="that none has seen; 0: nothing is judged")
    parser.add_argument("--search", type=int, default=4000, help="time steps; 0: none")
    parser.add_argument("--enough", type=float, default=ENOUGH, help="more counts for no more in a search [degree]")
    parser.add_argument("--feel", type=int, default=0, help="time steps to search a rule that sees; 0: none")
    parser.add_argument("--many", type=int, nargs=2, default=(12, 4), help="tries at a time, draws of each")
    parser.add_argument("--learn", type=int, default=0, help="actions; 0: none")
    parser.add_argument("--keys", type=float, nargs="+", help="[mm], a and b in turn, any number")
    parser.add_argument("--spread", type=float, default=SPREAD, help="of the tries at first [mm]")
    parser.add_argument("--again", action="store_true", help="judge the policy in OUT, which was learned before")
    parser.add_argument("--out", type=Path, default=Path("build/twist"))
    given = parser.parse_args()
    print(machine())
    keys = np.array(given.keys or KEYS[given.body], dtype=float).reshape(-1, 2)
    env = made(given.body, len(keys))
    draws = held_out_goals(env, given.draws, 0)
    print(f"{given.body}: {len(env.robot.body.mesh.nodes)} nodes, {env.options.physics.beats} time steps a keyframe")
    head = "| way | time steps | draws | degrees a cycle | 10 %, median, 90 % | friction low, high | 90 or more |"
    print(f"{head} {ENOUGH:.0f} or more | moved mm, most | s |\n|{10 * '---|'}")
    first = judged("keyframes as given" if given.keys else "keyframes by hand", env, playing(keys), draws, 0)
    tries: dict[str, Any] = {"many": given.many[0], "each": given.many[1], "enough": given.enough}
    cost = 0
    if given.search:
        keys, cost = searched(env, keys, np.array(given.spread), playing, given.search, **tries)
        judged("keyframes that were searched", env, playing(keys), draws, cost, first)
    if given.feel:
        apart = made(given.body, len(keys), tied=())
        usual = usual_turns(apart, keys, lambda key: as_action(key.ravel()))

        def obeying(numbers: np.ndarray) -> Act:
            return feeling(apart, usual, numbers)

        spread = np.array([given.spread, 1.0, 1.0, 1.0])
        numbers, more = searched(apart, rule(keys), spread, obeying, given.feel, **tries)
        judged("a rule that sees, on these", apart, obeying(numbers), draws, cost + more, first)
    if given.learn:
        act, more = learned(given.body, keys, given.learn, given.out, again=given.again)
        judged("networks that see, on these", env, act, draws, cost + more, first)


if __name__ == "__main__":
    main()
