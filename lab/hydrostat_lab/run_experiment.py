"""`judge_runs`: runs of experiments with several seeds, and what the simulator makes of the best policies."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import torch
from joblib import Parallel, delayed

from hydrostat.learning import LearnedModel, antagonists, verify
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat_lab.experiments import Ran, Run
from hydrostat_lab.hindsight_ddpg import HindsightDdpg
from hydrostat_lab.policies import Act
from hydrostat_lab.trials import NetworkReach

Groups = tuple[tuple[int, ...], ...]
Asked = tuple[torch.Tensor, torch.Tensor]


@dataclass(frozen=True, kw_only=True, eq=False)
class Judged:
    """Result of a run, and what the simulator makes of it.

    Attributes:
        ran: epochs and distances in the networks.
        exact: distances of the best policies after the last action [cm], (seeds, goals); NaN without an equilibrium.
        shown: contractions of starts, targets and last actions of a few episodes [m], for pictures.
    """

    ran: Ran
    exact: np.ndarray
    shown: Mapping[str, np.ndarray]


def finger_pairs(model: LearnedModel) -> Groups:
    """Winches that work against one another, by the slopes that a model expects at rest; the others alone."""
    rest = np.clip(np.zeros(len(model.low)), model.low, model.high)
    return antagonists(model.jacobian(rest).T)


def judge_runs(
    runs: Sequence[Run],
    model: LearnedModel,
    robot: Robot,
    *,
    seeds: int,
    epochs: Callable[[int], int],
    goals: int,
    jobs: int = 1,
) -> Callable[[Run], Judged]:
    """Learn in the networks of a model in several processes, and judge the best policies in the simulator.

    Args:
        runs: runs to learn, in the order in which they begin; equal ones are learned once.
        model: networks of the robot.
        robot: robot of the simulator.
        seeds: number of random starts of each run.
        epochs: epochs of a run, by the width of its widest layer.
        goals: drawn evenly among actions, simulated, and asked for; nothing is learned from them.
        jobs: processes; -1 for one on each core.

    Returns:
        A function that waits for the result of one of the runs.
    """
    unlike = list(dict.fromkeys(runs))
    options: dict[str, Any] = {"batch_size": 1, "pre_dispatch": "all"}
    work = Parallel(n_jobs=jobs, return_as="generator", **options)
    parent = os.getpid() if jobs != 1 else None
    many = [epochs(max(run.options.layers)) for run in unlike]
    tasks = (
        delayed(_judge)(run, model, robot, seeds, each, goals, parent) for run, each in zip(unlike, many, strict=True)
    )
    coming, found = zip(unlike, work(tasks), strict=True), dict[Run, Judged]()

    def wait_for(run: Run) -> Judged:
        while run not in found:
            other, judged = next(coming)
            found[other] = cast(Judged, judged)
        return found[run]

    return wait_for


def _judge(
    run: Run, model: LearnedModel, robot: Robot, seeds: int, epochs: int, goals: int, parent: int | None
) -> Judged:
    def watch(_at: int, _of: int) -> None:
        if parent not in (None, os.getppid()) and os.name == "posix":
            os._exit(1)  # its parent was killed

    trials = NetworkReach(model, groups=finger_pairs(model), horizon=run.horizon, random_start=run.random_start)
    simulation, learner = Simulation(robot), HindsightDdpg(trials, run.options, seeds=seeds, epochs=epochs)
    ran = Ran(run=run, epochs=learner.learn(progress=watch), best=learner.test(learner.best, _TESTS))
    asked = exact_goals(simulation, trials, goals)
    exact = exact_distances(simulation, trials, learner.best, seeds, asked)
    return Judged(ran=ran, exact=exact, shown=_show_episodes(trials, learner.best, seeds, asked))


def _show_episodes(trials: NetworkReach, policy: Act, seeds: int, asked: Asked) -> dict[str, np.ndarray]:
    """Contractions [m] in a few episodes of the first seed, as the networks see them."""
    draw, shape = torch.Generator().manual_seed(_GOALS), (1, asked[1].shape[1])
    starts = trials.draw_acts(draw, shape)[1]
    wanted, _ = trials.draw_acts(draw, shape)
    seen, goal = (torch.nan_to_num(part).expand(seeds, -1, -1) for part in asked)
    acts = torch.empty(0)
    with torch.no_grad():
        for _ in range(trials.horizon):
            acts = policy(seen, goal)
            seen, _ = trials.act(acts)
    nothing = torch.zeros_like(trials.contractions(wanted))
    shown = {"start": nothing if starts is None else trials.contractions(starts), "target": trials.contractions(wanted)}
    shown["reached"] = trials.contractions(acts)
    return {name: rows[0, :_SHOWN].double().numpy() for name, rows in shown.items()}


def exact_goals(simulation: Simulation, trials: NetworkReach, goals: int, *, progress: Progress = no_progress) -> Asked:
    """Compute starts and goals of episodes in the simulator [cm], (1, goals, size) each; NaN without an equilibrium."""
    draw = torch.Generator().manual_seed(_GOALS)
    begun, _, _ = trials.begin(draw, (1, goals))
    wanted = trials.contractions(2.0 * torch.rand(1, goals, trials.actions, generator=draw) - 1.0)
    return begun, _places(simulation, wanted, "goals in the simulator", progress)


def exact_distances(
    simulation: Simulation,
    trials: NetworkReach,
    policy: Act,
    seeds: int,
    asked: Asked,
    *,
    progress: Progress = no_progress,
) -> np.ndarray:
    """Distances [cm] after the last action of episodes in the simulator, (seeds, goals); asked: `exact_goals`."""
    begun, goal = (part.expand(seeds, -1, -1) for part in asked)
    seen = begun
    with torch.no_grad():
        for _ in range(trials.horizon):
            acts = policy(torch.nan_to_num(seen), torch.nan_to_num(goal))
            seen = _places(simulation, trials.contractions(acts), "in the simulator", progress)
    return trials.distances(seen, goal).numpy()


def certified_distances(
    simulation: Simulation, model: LearnedModel, asked: Asked, *, steps: int = 3, progress: Progress = no_progress
) -> np.ndarray:
    """Distances [cm] that the same goals are left with by the networks' search and exact steps from there, (1, goals).

    What inverse kinematics does with the equilibria that the networks have learned from; it moves each winch alone. No
    more steps are taken than needed for 0.01 mm. NaN where a goal, or the answer to it, is no equilibrium.
    """
    names, dim = model.card.markers, model.card.dim
    rows, found = asked[1][0].double().numpy(), []
    for number, row in enumerate(rows):
        progress("certified", number, len(rows))
        if not np.isfinite(row).all():
            found.append(np.nan)
            continue
        target = dict(zip(names, map(tuple, (0.01 * row).reshape(-1, dim).tolist()), strict=True))
        answer = verify(simulation, model, model.solve(target), steps=steps, enough=1e-5)
        found.append(np.nan if answer.certified is None else 100.0 * answer.error)
    return np.array(found)[None]


def _places(simulation: Simulation, taken: torch.Tensor, stage: str, progress: Progress) -> torch.Tensor:
    """Coordinates of the markers [cm] at contractions [m], (many, goals, winches), in the simulator; NaN where none.

    The first of many begins from rest; the others, which want the same, each from the pose before: eight times faster
    where they differ little.
    """
    rows = taken.double().numpy()
    found = np.full((*rows.shape[:2], len(simulation.robot.markers), simulation.robot.body.mesh.dim), np.nan)
    for goal in range(rows.shape[1]):
        progress(stage, goal, rows.shape[1])
        pose = None
        for one in range(rows.shape[0]):
            pose = simulation.solve(rows[one, goal], start=pose, strict=False)
            if not pose.result.converged:
                pose = None
                continue
            found[one, goal] = simulation.marker_anchors.positions(pose.nodes)
    return torch.tensor(100.0 * found.reshape(*rows.shape[:2], -1), dtype=torch.float32)


_SHOWN = 4
"""Episodes of a picture."""

_TESTS = 300
"""Goals that the best policies are tried on in the networks."""

_GOALS = 31_415
"""Seed of the goals in the simulator."""
