"""Ways to make the gallery's puppy walk, at equal cost: gaits by hand, by search, and policies learned by trial.

    python lab/hysteresis_and_walking/walk_learned.py [--budget 5000] [--seeds 2] [--draws 4] [--ways hand,search,...]

All are judged in `hydrostat/Walk-v0`: five seconds from standing still, on ground whose friction nobody has seen before
(0.6, up to 30 % more or less, the same draws for all), towards a place half a body away. A fall counts as no way at
all. Cost is in time steps of the simulator (20 ms each); judging costs nothing.

    hand      the keyframes of robot.toml, played in turn: amplitude 20 mm, lag 1/3, period 1 s
    found     the gait that lab/hysteresis_and_walking/walk.py found at friction 0.6 (24.1 mm, 0.35, 0.83 s), 40 tries
    search    the same search here, from `hand`, one episode each try, with friction drawn again
    gait      SAC with hindsight, actions are gaits for half a second
    steps     SAC with hindsight, actions are changes of contractions, each tenth of a second
    steps-tqc the same by TQC
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from machine import machine

import numpy as np  # isort: skip

from hydrostat.training import Gait, TrainMethod, TrainOptions, WalkEnv, WalkOptions, held_out_goals, judge, train

PUPPY = Path(__file__).parents[2] / "examples" / "puppy"
GAIT, STEPS = WalkOptions(), WalkOptions(actions="contractions", incremental=True)
HAND = Gait(amplitude=0.020, lag=1 / 3, period=1.0)
FOUND = Gait(amplitude=0.0241, lag=0.35, period=0.83)

Act = Callable[[dict[str, np.ndarray]], np.ndarray]
Draws = list[dict[str, object]]


class NotedWalk(WalkEnv):
    """Walk, with a note of how each episode ended; printed if the episodes have a name."""

    def __init__(self, options: WalkOptions, name: str = "") -> None:
        """The puppy."""
        super().__init__(str(PUPPY), options=options)
        self.ended: list[dict[str, object]] = []
        self.name = name

    def step(self, action: np.ndarray) -> tuple:
        """One step, and the note after the last."""
        told = super().step(action)
        if told[3]:
            self.ended.append(told[4])
            if self.name:
                end = "falls" if told[4]["fallen"] else f"{1e3 * told[4]['way']:.0f} mm"
                print(f"{self.name}: {self.equilibria} time steps, {end}", file=sys.stderr, flush=True)
        return told


def ways(env: NotedWalk, act: Act, draws: Draws) -> np.ndarray:
    """How far it goes in each draw [m]; none where it falls."""
    env.ended.clear()
    judge(env, act, draws)
    return np.array([0.0 if each["fallen"] else each["way"] for each in env.ended])


def hand(draws: Draws, budget: int, seed: int) -> tuple[np.ndarray, int, str]:
    """By hand."""
    del budget, seed
    return _played(HAND, draws), 0, ""


def found(draws: Draws, budget: int, seed: int) -> tuple[np.ndarray, int, str]:
    """By lab/hysteresis_and_walking/walk.py."""
    del budget, seed
    return _played(FOUND, draws), 0, ""


def search(draws: Draws, budget: int, seed: int) -> tuple[np.ndarray, int, str]:
    """Random steps that grow where one is better and shrink where not."""
    env, random = NotedWalk(GAIT, f"search {seed}"), np.random.default_rng(seed)
    best, reach = HAND.action(env.most), 0.3
    most = -np.inf
    while env.equilibria + env.steps * env.beat <= budget:
        drawn = best + reach * random.normal(size=3) if most > -np.inf else best
        action = np.clip(drawn, -1.0, 1.0)
        draw = {"goal": [0.0], "friction": env.sample_episode(random)["friction"]}
        counted = env.uncounted
        way = float(ways(env, lambda _, action=action: action, [draw])[0])
        env.uncounted = counted  # these are the cost
        reach = min(0.5, 1.5 * reach) if way > most else max(0.03, 0.9 * reach)
        if way > most:
            best, most = action, way
    gait = Gait.of_action(best, env.most)
    words = f"{1e3 * gait.amplitude:.1f} mm, {gait.lag:.2f}, {gait.period:.2f} s"
    return _played(gait, draws), env.equilibria, words


def learned(options: WalkOptions, method: TrainMethod) -> Callable[[Draws, int, int], tuple[np.ndarray, int, str]]:
    """By trial and error, in whole episodes."""

    def run(draws: Draws, budget: int, seed: int) -> tuple[np.ndarray, int, str]:
        env, judged = NotedWalk(options, f"{method} {seed}"), NotedWalk(options)
        short = WalkEnv(str(PUPPY), options=replace(options, steps=1))  # the curve on the way is not looked at
        actions = budget // env.beat
        asked = TrainOptions(
            method=method, steps=actions, seed=seed, layers=(64, 64), updates=2, eval_interval=actions, num_envs=1
        )
        with TemporaryDirectory() as out:
            model, curve = train(env, draws[:1], asked, Path(out), judge_in=short)
        found = ways(judged, lambda seen: model.predict(seen, deterministic=True)[0], draws)
        return found, curve[-1].equilibria, f"{curve[-1].steps} actions"

    return run


WAYS: dict[str, Callable[[Draws, int, int], tuple[np.ndarray, int, str]]] = {
    "hand": hand,
    "found": found,
    "search": search,
    "gait": learned(GAIT, TrainMethod.SAC),
    "steps": learned(STEPS, TrainMethod.SAC),
    "steps-tqc": learned(STEPS, TrainMethod.TQC),
}
SEEDLESS = ("hand", "found")


def _played(gait: Gait, draws: Draws) -> np.ndarray:
    env = NotedWalk(GAIT)
    return ways(env, lambda _: gait.action(env.most), draws)


def main() -> None:
    """Print a row for each way and seed, as soon as it is known."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--budget", type=int, default=5_000)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--ways", default=",".join(WAYS))
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    print(machine())
    env = WalkEnv(str(PUPPY))
    draws = [{**each, "goal": [0.5 * env.unit]} for each in held_out_goals(env, given.draws, 0)]
    print("friction of the draws: " + ", ".join(f"{each['friction']:.2f}" for each in draws))
    print("| way | seed | time steps | mm/s | of single draws | falls | what | CPU s |\n|" + 8 * "---|")
    for seed in range(given.first_seed, given.first_seed + given.seeds):
        for name in given.ways.split(","):
            if name in SEEDLESS and seed > given.first_seed:
                continue
            began = time.process_time()
            found, cost, words = WAYS[name](draws, given.budget, seed)
            speeds = 1e3 * found / (env.steps * env.beat * 0.02)
            print(
                f"| {name} | {seed} | {cost} | {speeds.mean():.1f} | {speeds.min():.1f} to {speeds.max():.1f} "
                f"| {int((found == 0).sum())} of {len(found)} | {words} | {time.process_time() - began:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
