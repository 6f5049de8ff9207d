"""`reproduce_trials`: the thesis's experiments with reinforcement learning, for `hydrostat reproduce`."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hydrostat.cli import report_progress
from hydrostat_lab.trial_tables import (
    drawn_runs,
    format_interval,
    is_finished,
    judged_claims,
    shared_table,
    trials_missing,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hydrostat.learning import LearnedModel
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation
    from hydrostat_lab.experiments import Experiment, Run
    from hydrostat_lab.run_experiment import Judged

TRIALS = (
    "figure-5.8",
    "figure-5.8-small",
    "figure-5.9",
    "figure-5.9-small",
    "figure-5.9-critic",
    "figure-5.10",
    "figure-5.12",
    "table-noise",
    "table-reward",
)
"""Experiments of the thesis that can be reproduced; figure-5.10 is figure 5.11 too."""

POLICIES, GRADIENT = "table-policies", "table-gradient"
"""Names of two tables: errors of other policy methods on equal actions and outcomes; the best alone, on more goals."""

CERTIFIED = "certified, no policy"
"""Row for inverse kinematics with the equilibria that networks were trained on: their search, then exact steps."""

SHARED = "figure-5.14-trial"
"""Trial and error beside others, of the pairs that it tried and of as many drawn evenly."""


class HowMuch(NamedTuple):
    """Size of trials, and settings that override it.

    Attributes:
        size: minutes, hour or full.
        seeds: number of random starts of each run; as many as the size has if left out, and so below.
        goals: number of goals that each policy is judged by in the simulator.
        epochs: number of epochs of 500 actions in a run.
    """

    size: str
    seeds: int | None = None
    goals: int | None = None
    epochs: int | None = None


def reproduce_trials(
    names: Sequence[str], robot: "Robot", out: Path, much: HowMuch, *, model: Path | None, jobs: int
) -> None:
    """Learn in networks of a robot, judge in the simulator, and say which claims of the thesis hold.

    Args:
        names: names out of `TRIALS`, `SHARED`, `POLICIES` or `GRADIENT`.
        robot: robot, with contact if its model knows it.
        out: folder for tables and pictures; the model too, if none is given.
        much: size of the runs.
        model: file that `hydrostat learn` wrote.
        jobs: processes that learn, and that sample where there is no model.
    """
    with trials_missing():
        from hydrostat_lab.experiments import EXPERIMENTS
    from hydrostat.simulation import Simulation
    from hydrostat_lab.run_experiment import judge_runs

    usual = _SIZES[much.size]
    usual = usual if much.goals is None else usual._replace(goals=much.goals)
    usual = usual if much.epochs is None else usual._replace(small=much.epochs, large=much.epochs)
    usual = usual if much.seeds is None else usual._replace(seeds=much.seeds)
    networks = _networks(robot, out, model, usual.samples, jobs)
    networks.check(robot)
    settings = {**usual._asdict(), "pairs": list(usual.pairs), "samples": networks.card.samples}
    settings |= {"robot": networks.card.physics, "error": networks.card.error}
    left = [name for name in names if not is_finished(out / f"{name}.json", settings)]
    experiments = {name: EXPERIMENTS[name] for name in left if name in TRIALS}
    wait_for = judge_runs(
        [run for experiment in experiments.values() for run in experiment.runs.values()],
        networks,
        robot,
        seeds=usual.seeds,
        epochs=lambda layer: usual.small if layer < _LARGE else usual.large,
        goals=usual.goals,
        jobs=jobs,
    )
    for name, experiment in experiments.items():
        _try(name, experiment, wait_for, networks, robot, out, settings=settings)
    for name in left:
        if name not in TRIALS:
            write = _write_shared if name == SHARED else _policies
            write(name, networks, Simulation(robot), out, usual=usual, settings=settings)


def _try(
    name: str,
    experiment: "Experiment",
    wait_for: "Callable[[Run], Judged]",
    networks: "LearnedModel",
    robot: "Robot",
    out: Path,
    *,
    settings: Mapping[str, object],
) -> None:
    """Tell what an experiment of the thesis gave, and judge its claims."""
    from hydrostat.files import replace_file
    from hydrostat.plot import save_png

    width = 1e3 * robot.body.mesh.size
    print(f"\n{name}: {experiment.title}")
    print(f"{robot.name}, {width:.0f} mm; networks of {networks.card.samples} equilibria;", end=" ")
    print(f"{settings['seeds']} seeds:\ninterquartile means and their 95 % intervals\n{_WORDS}")
    done: dict[str, Judged] = {}
    for way, run in experiment.runs.items():
        done[way] = wait_for(run)
        print(_line(way, done[way], width), flush=True)
    runs = {way: judged.ran for way, judged in done.items()}
    kept = {"settings": settings, **judged_claims(experiment, runs)}
    for way, judged in done.items():
        exact = np.where(np.isnan(judged.exact), -1.0, judged.exact)
        kept["runs"][way]["in the simulator [cm]"] = exact.tolist()
    replace_file(out / f"{name}.json", (json.dumps(kept, indent=1) + "\n").encode())
    print(f"Wrote {save_png(drawn_runs(experiment, runs), out / f'{name}.png')} and {name}.json")
    for way, judged in done.items():
        if experiment.runs[way].random_start:
            print(f"Wrote {save_png(_draw_episodes(robot, judged), out / f'{name}-poses.png')}")


def _draw_episodes(robot: "Robot", judged: "Judged") -> "Figure":
    """Starts, targets and reached poses of a few episodes (thesis, Fig 5.12)."""
    from hydrostat.simulation import Simulation
    from hydrostat_lab.learning_figures import draw_side_by_side

    simulation = Simulation(robot)
    return draw_side_by_side(
        robot,
        {name: [simulation.solve(row, strict=False).nodes for row in rows] for name, rows in judged.shown.items()},
    )


def _write_shared(
    name: str,
    networks: "LearnedModel",
    simulation: "Simulation",
    out: Path,
    *,
    usual: "_Trials",
    settings: Mapping[str, object],
) -> None:
    """Trial and error beside others, of the pairs that it tried and of pairs drawn evenly."""
    from hydrostat_lab.policies import Budget
    from hydrostat_lab.run_experiment import finger_pairs
    from hydrostat_lab.shared_data import compare_on_shared_data
    from hydrostat_lab.trials import NetworkReach

    budget = Budget(steps=max(2000, usual.steps // 6), epochs=usual.small)
    trials = NetworkReach(networks, groups=finger_pairs(networks))
    compared = compare_on_shared_data(
        trials, simulation, seeds=usual.seeds, goals=usual.goals, budget=budget, progress=report_progress()
    )
    shared_table(name, compared, out, 1e3 * simulation.robot.body.mesh.size, settings)


def _policies(
    table: str,
    networks: "LearnedModel",
    simulation: "Simulation",
    out: Path,
    *,
    usual: "_Trials",
    settings: Mapping[str, object],
) -> None:
    """Table and picture of ways to a policy of one action, over the equilibria that each has used."""
    from hydrostat.files import replace_file
    from hydrostat.plot import save_png
    from hydrostat_lab.learning_figures import draw_costs
    from hydrostat_lab.policies import PAIRS_ALONE, WAYS, Budget, drawn_pairs
    from hydrostat_lab.run_experiment import certified_distances, exact_distances, exact_goals, finger_pairs
    from hydrostat_lab.trials import NetworkReach
    from hydrostat_lab.verdict import interquartile

    trials, effort = (
        NetworkReach(networks, groups=finger_pairs(networks)),
        Budget(steps=usual.steps, epochs=usual.small, progress=report_progress()),
    )
    seeds, width = usual.seeds, 1e3 * simulation.robot.body.mesh.size
    every, known = drawn_pairs(trials, seeds, max(usual.pairs)), networks.card.samples
    print(f"\n{table}: policy methods with one action (T=1), {seeds} seeds, {usual.goals} goals in the simulator")
    print(f"{'method':24}{'pairs':>8}{'equilibria':>12}{'mean [mm]':>24}{'% size':>8}{'p99 [mm]':>10}{'lost':>6}")
    rows: list[dict[str, object]] = []

    def report(name: str, pairs: int, used: int, exact: np.ndarray) -> None:
        found, far = interquartile(np.nanmean(exact, axis=1)), float(np.nanquantile(exact, 0.99))
        row = {"way": name, "pairs": pairs, "equilibria": used, "seeds": np.nanmean(exact, axis=1).tolist()}
        rows.append({**row, "p99": far})
        text = f"{name:24}{pairs:8}{used:12}{format_interval(found, 3):>24}{100 * found.mean / width:8.3f}"
        print(f"{text}{far:10.3f}{int(np.isnan(exact).sum()):6}", flush=True)

    asked = exact_goals(simulation, trials, usual.goals, progress=report_progress())
    sure = certified_distances(simulation, networks, asked, progress=report_progress())
    report(CERTIFIED, known, known, 10.0 * sure)
    for name, way in list(WAYS.items())[: 1 if table == GRADIENT else None]:
        for many in usual.pairs if name in PAIRS_ALONE else usual.pairs[-1:]:
            act = way(trials, every.first(many), effort)
            exact = 10.0 * exact_distances(simulation, trials, act, seeds, asked, progress=report_progress())
            report(name, many, _count_equilibria(name, many, known, usual), exact)
    kept = {"settings": settings, "rows": rows}
    replace_file(out / f"{table}.json", (json.dumps(kept, indent=1) + "\n").encode())
    curves: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        curves.setdefault(str(row["way"]), []).append((float(row["equilibria"]), float(np.mean(row["seeds"]))))  # type: ignore[arg-type]
    print(f"Wrote {save_png(draw_costs(curves), out / f'{table}.png')} and {table}.json")


def _count_equilibria(name: str, pairs: int, known: int, usual: "_Trials") -> int:
    """Equilibria that a way would have cost in the simulator: its pairs, its own trials, or those of the networks."""
    from hydrostat_lab.policies import PAIRS_ALONE, UNFILLED

    tried = 500 * usual.small
    if name == "gradient":
        return known
    return pairs if name in PAIRS_ALONE else tried if name in UNFILLED else pairs + tried


def _networks(robot: "Robot", out: Path, file: Path | None, samples: int, jobs: int) -> "LearnedModel":
    """The model of a file, or one of samples in which one winch of each pair takes in."""
    from hydrostat.learning import LearnedModel, SamplePlan, Samples, SamplingScheme, learn_model, sample_robot

    if file is not None:
        return LearnedModel.load(file)
    kept = out / f"{robot.name}-{samples}.model"
    if not kept.exists():
        folder = out / f"{robot.name}-{SamplingScheme.ANTAGONIST}-train-{samples}"
        sample_robot(
            SamplePlan.of_robot(robot, samples, draws=(SamplingScheme.ANTAGONIST,)),
            folder,
            jobs=jobs,
            progress=report_progress(),
        )
        learn_model(Samples.read(folder), progress=report_progress()).save(kept)
    return LearnedModel.load(kept)


def _line(way: str, judged: "Judged", width: float) -> str:
    """A run in numbers."""
    from hydrostat_lab.experiments import final
    from hydrostat_lab.verdict import interquartile

    ran, exact = judged.ran, judged.exact
    seeds = interquartile(10.0 * np.nanmean(exact, axis=1))
    numbers = [
        format_interval(interquartile(final(ran)), 2),
        format_interval(interquartile(10.0 * ran.epochs.tolerance[-1]), 2),
        format_interval(interquartile(10.0 * ran.best[0].mean(axis=1)), 2),
        format_interval(interquartile(10.0 * ran.best[-1].mean(axis=1)), 2),
        format_interval(seeds, 2),
    ]
    lost = int(np.isnan(exact).sum())
    text = f"{way:18}{int(ran.epochs.actions[-1]):8}" + "".join(f"{number:>21}" for number in numbers)
    return f"{text}{100 * seeds.mean / width:8.2f}{lost:6}"


class _Trials(NamedTuple):
    """Default settings of trials of one size."""

    samples: int
    seeds: int
    small: int
    large: int
    goals: int
    pairs: tuple[int, ...]
    steps: int


_SIZES = {
    "minutes": _Trials(300, 3, 4, 1, 20, (100, 300), 500),
    "hour": _Trials(1000, 5, 30, 8, 60, (300, 10_000), 24_000),
    "full": _Trials(10_000, 10, 200, 50, 1000, (300, 3_000, 10_000), 48_000),
}
"""Equilibria that networks learn from, seeds, epochs of small and of large layers, goals in the simulator, pairs of
actions and outcomes, steps of gradients."""

_LARGE = 100
"""Layers of so many units are large."""

_WORDS = (
    f"{'method':18}{'actions':>8}{'final success':>21}{'tolerance [mm]':>21}{'1st action [mm]':>21}"
    f"{'last action [mm]':>21}{'simulator [mm]':>21}{'% size':>8}{'lost':>6}"
)
