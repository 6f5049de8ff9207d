"""`train`: reinforcement learning of a policy by stable-baselines3, with progress, checkpoints and resumption."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat.progress import Progress, no_progress
from hydrostat.simulation import ContractionProfile
from hydrostat.training.checkpoint import drop_others, name_damage, restore_checkpoint, save_checkpoint
from hydrostat.training.goal_env import GoalEnv
from hydrostat.version import install_command


class TrainMethod(StrEnum):
    """Learning algorithm; all use hindsight experience replay (HER)."""

    DDPG = "ddpg-her"  # the thesis's
    TD3 = "td3-her"
    SAC = "sac-her"
    TQC = "tqc-her"  # of sb3-contrib


@dataclass(frozen=True, kw_only=True)
class TrainOptions:
    """Options for training a policy.

    Attributes:
        method: learning algorithm.
        steps: number of actions; each action and each drawn goal costs one equilibrium.
        seed: random seed.
        layers: units in each hidden layer of actor and critic.
        batch: number of transitions in an update.
        updates: gradient steps after each action.
        learning_rate: step size of the Adam optimizer.
        noise: standard deviation of the action noise (DDPG, TD3).
        eval_interval: number of actions between evaluations; a few more if an episode has to end first.
        num_envs: number of parallel episodes; each update uses the actions of all.

    Raises:
        InputError: a value out of range.
    """

    method: TrainMethod = TrainMethod.SAC
    steps: int = 10_000
    seed: int = 0
    layers: tuple[int, ...] = (256, 256, 256)
    batch: int = 256
    updates: int = 1
    learning_rate: float = 1e-3
    noise: float = 0.1
    eval_interval: int = 1_000
    num_envs: int = 4

    def __post_init__(self) -> None:
        for name in ("steps", "batch", "updates", "eval_interval", "num_envs"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} must be 1 or more, not {getattr(self, name)}")
        if not 0 <= self.noise <= 1:
            raise InputError(f"noise must be from 0 to 1, not {self.noise:g}")


@dataclass(frozen=True, kw_only=True)
class CurvePoint:
    """Evaluation of a policy; distances are in the unit of the task: [m], or [rad] for twisting.

    Attributes:
        steps: number of actions so far.
        equilibria: equilibria that the exact simulator has solved so far, goals included; or time steps in dynamic
            tasks.
        mean: mean final distance from goals that were not used in training.
        median: median of these distances.
        worst: largest of these distances.
        success: share of goals reached within the tolerance.
    """

    steps: int
    equilibria: int
    mean: float
    median: float
    worst: float
    success: float


def _no_point(point: CurvePoint) -> None:
    """Drop the point."""


@dataclass(frozen=True, kw_only=True)
class Listener:
    """Callbacks for the progress of training.

    Attributes:
        point: callback after each evaluation.
        progress: callback for the number of actions taken, and of goals evaluated.
    """

    point: Callable[[CurvePoint], None] = _no_point
    progress: Progress = no_progress


def held_out_goals(env: GoalEnv, count: int, seed: int, *, progress: Progress = no_progress) -> list[dict[str, Any]]:
    """Draw goals that training never uses, by a separate generator: `options` for `reset`. Adds nothing to the cost."""
    before, goals = env.equilibria, []
    random = np.random.default_rng([seed, 77])
    while len(goals) < count:
        progress("unseen goals drawn", len(goals), count)
        goal = env.sample_episode(random)
        if goal is not None:
            goals.append(goal)
    env.uncounted += env.equilibria - before
    return goals


def judge(
    env: GoalEnv,
    act: Callable[[dict[str, Vector]], np.ndarray],
    goals: Sequence[Mapping[str, Any]],
    *,
    progress: Progress = no_progress,
) -> Vector:
    """Return the final distance for each goal, in the unit of the task. Adds nothing to the cost."""
    before, left = env.equilibria, []
    for goal in goals:
        progress("judged by unseen goals", len(left), len(goals))
        observation, info = env.reset(options=dict(goal))
        over = False
        while not over:
            observation, _, _, over, info = env.step(act(observation))
        left.append(info["distance"])
    env.uncounted += env.equilibria - before  # what judges a policy is no cost of learning it
    return np.array(left)


def moves_of(
    env: GoalEnv, act: Callable[[dict[str, Vector]], np.ndarray], goal: Mapping[str, Any]
) -> ContractionProfile:
    """Return the commands of an episode: contractions in time. Adds nothing to the cost."""
    judge(env, act, [goal])
    times, values = zip(*env.moves, strict=True)
    return ContractionProfile(times=np.array(times), values=np.array(values))


def train(
    env: GoalEnv,
    goals: Sequence[Mapping[str, Any]],
    options: TrainOptions,
    out: Path,
    *,
    resume: bool = False,
    processes: int = 1,
    judge_in: GoalEnv | None = None,
    listener: Listener | None = None,
) -> tuple[Any, list[CurvePoint]]:
    """Train a policy; write curve.json and a checkpoint to `out` after each evaluation, each atomically.

    If tensorboard is installed, write logs to `out`/tensorboard.

    Args:
        env: environment for training.
        goals: goals for evaluation, from `held_out_goals`.
        options: training options.
        out: output folder, created if missing.
        judge_in: environment for evaluation, such as the exact simulator; `env` if left out.
        resume: continue from the checkpoint in `out`; the curve is the same as without a break.
        processes: number of processes that share the episodes; the curve does not depend on it.
        listener: callbacks for progress.

    Returns:
        The stable-baselines3 model and the learning curve.

    Raises:
        InputError: stable-baselines3 is missing, or sb3-contrib if the method needs it.
        InputError: no checkpoint to resume, or one of other options; more processes than episodes.
    """
    if not 1 <= processes <= options.num_envs:
        raise InputError(f"processes must be 1 to {options.num_envs}, the episodes side by side, not {processes}")
    curve, listener = begun_curve(out, options, resume=resume), listener or Listener()
    with _copies(env, options, processes) as copies:
        learner = _learner(env, copies, options)
        if resume:
            restore_checkpoint(learner, _checkpoint(curve, out))
        out.mkdir(parents=True, exist_ok=True)
        learner.tensorboard_log = str(out / "tensorboard") if find_spec("tensorboard") else None
        while learner.num_timesteps < options.steps:
            _stretch(learner, options, env.steps * options.num_envs, listener.progress)
            act = lambda seen: learner.predict(seen, deterministic=True)[0]  # noqa: E731
            left = judge(judge_in or env, act, goals, progress=listener.progress)
            point = CurvePoint(
                steps=learner.num_timesteps,
                equilibria=copies.equilibria,
                mean=float(left.mean()),
                median=float(np.median(left)),
                worst=float(left.max()),
                success=float((left < env.tolerance).mean()),
            )
            curve.append(point)
            _record(learner, point)
            _keep(learner, options, curve, out)
            listener.point(point)
    return learner, curve


def begun_curve(out: Path, options: TrainOptions, *, resume: bool) -> list[CurvePoint]:
    """Return the learning curve of a folder to resume; without `resume`, an empty curve.

    Raises:
        InputError: no checkpoint to resume, a checkpoint of other options, or an earlier run that would be overwritten.
    """
    if not resume:
        if list(out.glob("checkpoint-*")):
            raise InputError(f"{out}: holds a run already; go on with --resume, or name another folder")
        return []
    if not (out / "curve.json").exists():
        raise InputError(f"{out}: no checkpoint to resume from. Start without --resume.")
    with name_damage(out / "curve.json"):
        kept = json.loads((out / "curve.json").read_text())
        curve = [CurvePoint(**each) for each in kept["curve"]]
        made = {_RENAMED.get(name, name): value for name, value in kept["options"].items()}
    for name, value in json.loads(json.dumps(asdict(options))).items():
        was = made.get(name)
        if was != value and name not in ("steps", "eval_interval"):
            raise InputError(f"{out}: this was begun with {name} = {was}, not {value}; go on with the same")
    if not curve:
        raise InputError(f"{out}: no checkpoint to resume from. Start without --resume.")
    return curve


@contextmanager
def _copies(env: GoalEnv, options: TrainOptions, processes: int) -> Iterator[Any]:
    """Episodes side by side, until no more are needed (InputError: stable-baselines3 is not installed)."""
    from hydrostat.training.side_by_side import SideBySide

    copies = SideBySide(env, options.num_envs, processes=processes)
    try:
        yield copies
    finally:
        copies.close()


def _stretch(model: Any, options: TrainOptions, whole: int, progress: Progress) -> None:
    """Learn from as many actions as are due until the next evaluation, in whole episodes of so many together."""
    due = min(options.eval_interval, options.steps - model.num_timesteps)
    model._last_obs = None  # each stretch begins with episodes of its own

    def report_progress(*_: object) -> bool:
        progress("actions", min(model.num_timesteps, options.steps - 1), options.steps)
        return True

    model.learn(whole * math.ceil(due / whole), callback=report_progress, reset_num_timesteps=False)


def _learner(env: GoalEnv, copies: Any, options: TrainOptions) -> Any:
    """Return the model before its first step."""
    made = _algorithm(options.method)
    import torch
    from stable_baselines3 import HerReplayBuffer
    from stable_baselines3.common.noise import NormalActionNoise
    from stable_baselines3.common.vec_env import VecMonitor

    torch.set_num_threads(1)
    whole, size = env.steps * options.num_envs, env.action_space.shape[0]  # type: ignore[index]
    more: dict[str, Any] = {}
    if options.method in (TrainMethod.DDPG, TrainMethod.TD3):
        more["action_noise"] = NormalActionNoise(np.zeros(size), np.full(size, options.noise))
    return made(
        "MultiInputPolicy",
        VecMonitor(copies),
        replay_buffer_class=HerReplayBuffer,
        replay_buffer_kwargs={"n_sampled_goal": 4, "goal_selection_strategy": "future"},
        policy_kwargs={"net_arch": list(options.layers), "activation_fn": torch.nn.SiLU},
        learning_rate=options.learning_rate,
        batch_size=options.batch,
        gamma=max(1.0 - 1.0 / env.steps, 0.0),
        gradient_steps=options.updates * options.num_envs,
        learning_starts=max(100, 2 * whole),
        buffer_size=max(options.steps, 1_000),
        seed=options.seed,
        device="cpu",
        **more,
    )


def _algorithm(method: TrainMethod) -> Any:
    """The class that learns by a method (InputError: its library is not installed)."""
    try:
        if method is TrainMethod.TQC:
            from sb3_contrib import TQC

            return TQC
        import stable_baselines3
    except ModuleNotFoundError as error:
        raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None
    return getattr(stable_baselines3, method.name)


def _record(model: Any, point: CurvePoint) -> None:
    """Tell TensorBoard how good the policy is, and close the file of this stretch."""
    for name, value in asdict(point).items():
        if name != "steps":
            model.logger.record(f"unseen goals/{name}", value)
    model.logger.dump(point.steps)
    model.logger.close()


def _checkpoint(curve: list[CurvePoint], out: Path) -> Path:
    """The folder of the last evaluation's checkpoint."""
    return out / f"checkpoint-{curve[-1].steps}"


def _keep(model: Any, options: TrainOptions, curve: list[CurvePoint], out: Path) -> None:
    """Write a checkpoint, then the curve that ends there, and drop the checkpoint before."""
    folder = _checkpoint(curve, out)
    save_checkpoint(model, folder)
    told = {"options": asdict(options), "curve": [asdict(each) for each in curve]}
    replace_file(out / "curve.json", (json.dumps(told, indent=1) + "\n").encode())
    drop_others(folder)


_RENAMED = {"rate": "learning_rate", "every": "eval_interval", "together": "num_envs"}
"""Options that runs of before wrote by other names."""
