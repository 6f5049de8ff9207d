"""`reproduce`: tables and figures of the thesis; `app` is the command line that `hydrostat reproduce` runs."""

import csv
import io
import os
import time
from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from hydrostat.cli import report_progress, require_folder
from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat_lab import catalog
from hydrostat_lab.reproduced_page import write_page

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hydrostat.robot import Robot
    from hydrostat_lab.study import Study, StudyRow


app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Size(StrEnum):
    """Size of the study: number of samples, by the time it takes."""

    MINUTES = "minutes"
    HOUR = "hour"
    FULL = "full"


Methods = Annotated[
    str | None,
    typer.Option(
        metavar="NAME,NAME", help="Learning methods, without a correction step, e.g. thesis,search.", show_default="all"
    ),
]
Epochs = Annotated[
    int | None,
    typer.Option(
        metavar="N", min=1, help="Epochs of 500 actions for reinforcement learning.", show_default="by --size"
    ),
]


@app.command()
def reproduce(
    what: Annotated[
        list[str],
        typer.Argument(metavar="TABLE...", help="Tables and figures: table-5.1, ..., or all. `list` prints them."),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder (created if missing).", show_default=False)
    ] = None,
    size: Annotated[str, typer.Option(metavar="minutes|hour|full", help="Sampling effort.")] = "minutes",
    sampling: Annotated[
        str, typer.Option(metavar="WAY,WAY", help="Sampling strategies: box, antagonist, faces.")
    ] = "box",
    robots: Annotated[
        str | None,
        typer.Option(metavar="NAME,NAME", help="Gallery robots or robot folders.", show_default="by --size"),
    ] = None,
    counts: Annotated[
        str | None, typer.Option(metavar="N,N", help="Numbers of training samples.", show_default="by --size")
    ] = None,
    targets: Annotated[
        int | None, typer.Option(metavar="N", help="Number of targets.", show_default="by --size")
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(metavar="N", help="Number of random seeds.", show_default="by --size")
    ] = None,
    methods: Methods = None,
    jobs: Annotated[int, typer.Option(metavar="N", help="Number of processes. -1 = one per core.")] = -1,
    epochs: Epochs = None,
    model: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL", help="Model for reinforcement learning.", show_default="trained from new samples"
        ),
    ] = None,
) -> None:
    """Reproduce tables and figures of Chang (2018).

    Uses the hand and the simulator of hydrostat, and adds newer methods.

    Supervised learning: table-5.1 (mean error of each fingertip), table-5.2 (mean, deviation, maximum and quantiles),
    figure-5.3 (learning curves), figure-5.4 (target and reached poses) and figure-5.14 (error over samples and over CPU
    time). The simulator checks each answer. Samples and results are cached in DIR. The thesis used another hand with
    another range of motion.

    Reinforcement learning (section 5.4): figure-5.8 (one, five or ten actions) and figure-5.9 (curricula), each also
    with -small appended for small networks, figure-5.9-critic (three readings of one curriculum), figure-5.10
    (tolerances and errors), figure-5.12 (random starts), table-noise and table-reward. figure-5.14-trial compares it
    with methods that train on the same pairs. table-policies compares other policy methods on the same outcomes,
    table-gradient only the best one. Training runs in networks of the hand, with one action per finger and several
    seeds in parallel. The output lists the claims that hold. Needs the extra rl.

    figure-5.13 runs the same method in FetchReach, figure-5.13-hand in HandReach (both gymnasium-robotics), and
    compares it with published curves.

    `list` prints all tables and figures, also those of the README, with the results so far. reproduced.md in DIR sets
    the thesis, the largest runs and those of DIR side by side. Repeat the command to resume it: finished tables are
    kept. `all` skips tables that --size minutes cannot judge, with the reason.

    Example: hydrostat reproduce table-5.1 figure-5.14 --out build/thesis
    """
    from hydrostat_lab.reproduce_reference import REFERENCE_TABLES, reproduce_reference
    from hydrostat_lab.reproduce_trials import GRADIENT, POLICIES, SHARED, TRIALS, HowMuch, reproduce_trials

    began = time.monotonic()
    if what == ["list"]:
        print("\n".join(catalog.catalog_lines()))
        return
    trials, chosen = (*TRIALS, SHARED, POLICIES, GRADIENT), parse_choice(Size, size, what="--size")
    asked = _choose(what, (*THINGS, *trials, *REFERENCE_TABLES), chosen)
    if out is None:
        raise InputError("Missing option '--out'. Write a folder, e.g. --out build/thesis.")
    study, bodies = _study(chosen, sampling, robots, counts, targets, seeds)
    study = study if methods is None else _only(study, methods, asked)
    catalog.require_extras(asked)
    require_folder(out)
    out.mkdir(parents=True, exist_ok=True)
    if tables := [name for name in asked if name in THINGS]:
        _compare(tables, study, bodies, out, jobs)
    if names := [name for name in asked if name in trials]:
        much = HowMuch(size=size, seeds=seeds, goals=targets, epochs=epochs)
        reproduce_trials(names, _robot(bodies[0]), out, much, model=model, jobs=jobs)
    reproduce_reference([name for name in asked if name in REFERENCE_TABLES], out, size=size, seeds=seeds)
    print(f"Wrote {write_page(out)} after {(time.monotonic() - began) / 60:.1f} min on {os.cpu_count()} cores")


def _choose(what: "Sequence[str]", there: tuple[str, ...], size: Size) -> tuple[str, ...]:
    """Return the names of tables and figures (InputError: an unknown one).

    `all` leaves out those that miss a package, and in the smallest size those that such a run cannot tell.
    """
    for name in what:
        if name not in ("all", *there):
            raise InputError(f'unknown table or figure "{name}". Available: all, {", ".join(there)}.')
    if "all" not in what:
        return tuple(what)
    reasons = {entry.name: entry.dear for entry in catalog.CATALOG["Chang (2018)"] if entry.dear}
    reasons = reasons if size == Size.MINUTES else {}
    if find_spec("gymnasium_robotics") is None:
        missing = "package gymnasium-robotics not found"
        reasons |= {name: missing for name in there if name.startswith("figure-5.13")}
    for name, reason in reasons.items():
        print(f"note: {name} left out: {reason}.")
    return tuple(name for name in there if name not in reasons)


def _compare(asked: "Sequence[str]", study: "Study", bodies: "Sequence[str]", out: Path, jobs: int) -> None:
    """Tables and figures of supervised learning."""
    from hydrostat_lab.study import run_study

    loaded, rows = [_robot(name) for name in bodies], list["StudyRow"]()
    for robot in loaded:
        for row in run_study(study, robot, out, jobs=jobs, progress=report_progress()):
            if not rows or _group(rows[-1]) != _group(row):
                print(f"\n{_head(row)}\n{_WORDS}")
            print(_line(row), flush=True)
            rows.append(row)
    if study.seeds > 1:
        print("\n".join(_over_seeds(rows)))
    for name in asked:
        _write(name, rows, {robot.name: robot for robot in loaded}, out)


def _study(
    size: Size, sampling: str, robots: str | None, counts: str | None, targets: int | None, seeds: int | None
) -> "tuple[Study, list[str]]":
    """Return the methods to compare, as a study, and the names of the robots."""
    from hydrostat.learning import LearnOptions, SamplingScheme
    from hydrostat_lab.study import Study

    usual, draws = (
        _SIZES[size],
        tuple(parse_choice(SamplingScheme, each.strip(), what="--sampling") for each in sampling.split(",")),
    )
    if SamplingScheme.TENSION in draws:
        raise InputError("--sampling tension: only for hydrostat sample. Allowed here: box, antagonist, faces.")
    study = Study(
        draws=draws,
        counts=tuple(usual.counts if counts is None else _numbers(counts)),
        targets=usual.targets if targets is None else targets,
        seeds=usual.seeds if seeds is None else seeds,
        options=LearnOptions(steps=usual.steps, inverse_steps=usual.inverse_steps),
    )
    return study, list(usual.robots) if robots is None else [name.strip() for name in robots.split(",")]


def _only(study: "Study", methods: str, asked: Sequence[str]) -> "Study":
    """Return the study with some methods (InputError: an unknown one, or a figure shows another)."""
    study = replace(study, methods=tuple(name.strip() for name in methods.split(",")))
    if {"figure-5.3", "figure-5.4"} & {*asked} and not {"thesis", "search"} <= {*study.methods}:
        raise InputError(f"--methods {methods}: figures 5.3 and 5.4 show thesis and search. Add them.")
    return study


def _numbers(text: str) -> list[int]:
    from hydrostat.learning import MIN_SAMPLES

    parts = [part.strip() for part in text.split(",")]
    if not all(part.isdecimal() and int(part) for part in parts):
        raise InputError(f"--counts {text}: not a list of numbers above 0. Write e.g. 100,1000.")
    counts = [int(part) for part in parts]
    if min(counts) < MIN_SAMPLES:
        raise InputError(f"--counts {text}: too few samples. The minimum is {MIN_SAMPLES}.")
    return counts


def _robot(name: str) -> "Robot":
    """A robot of the gallery or of a folder, which feels itself."""
    from hydrostat.robot import GALLERY, Contact, gallery_folder, load_robot

    robot = load_robot(Path(name) if Path(name).is_dir() else gallery_folder(name.removeprefix(GALLERY)))
    return robot if robot.contact is not None else replace(robot, contact=Contact())


def _group(row: "StudyRow") -> tuple[str, str]:
    return row.robot, row.draw


def _head(row: "StudyRow") -> str:
    return (
        f"{row.robot}, sampled by {row.draw}: {row.targets} targets, {1e3 * row.moved:.1f} mm from the mean marker\n"
        f"position; errors in mm, and in % of the body size ({1e3 * row.size:.0f} mm)"
    )


def _line(row: "StudyRow") -> str:
    """A row as text."""
    mean = row.errors["mean"]
    numbers = "".join(f"{1e3 * row.errors[name]:9.3f}" for name in ("median", "p90", "p99", "max"))
    text = f"{row.samples:7}{row.seed:5}  {row.method:22}{1e3 * mean:8.3f}{100 * mean / row.size:8.3f}{numbers}"
    return f"{text}{row.lost:6}{row.sampling:9.0f}{row.learning:9.1f}"


def _over_seeds(rows: "Sequence[StudyRow]") -> list[str]:
    """The mean errors of ways that begin at random: mean over seeds, least and largest, in one table for all robots."""
    groups: dict[tuple[str, str, int, str], list[StudyRow]] = {}
    for row in rows:
        groups.setdefault((row.robot, row.draw, row.samples, row.method), []).append(row)
    table = ["", f"{'mean error over seeds':54}{'mean':>8}{'%':>8}{'min':>8}{'max':>8}  seeds  [mm]"]
    for (robot, draw, samples, method), some in groups.items():
        if len(some) > 1:
            means = [1e3 * row.errors["mean"] for row in some]
            mean, name = sum(means) / len(means), f"{robot}, {draw}, {samples:>6} samples"
            share = 0.1 * mean / some[0].size
            table.append(
                f"{name:36}  {method:16}{mean:8.3f}{share:8.3f}{min(means):8.3f}{max(means):8.3f}{len(some):7}"
            )
    return table


def _write(name: str, rows: "Sequence[StudyRow]", robots: "dict[str, Robot]", out: Path) -> None:
    """A table as CSV, a figure as PNG for each robot and draw."""
    from hydrostat.files import replace_file
    from hydrostat.plot import save_png
    from hydrostat_lab.learning_figures import draw_errors, draw_losses

    if name.startswith("table"):
        replace_file(out / f"{name}.csv", _csv(_per_marker(rows) if name == "table-5.1" else _spread(rows)))
        print(f"Wrote {out / name}.csv")
        return
    groups = dict.fromkeys(_group(row) for row in rows)
    for group in groups:
        some = [row for row in rows if _group(row) == group]
        file = out / (f"{name}.png" if len(groups) == 1 else f"{name}-{group[0]}-{group[1]}.png")
        if name == "figure-5.3":
            figure = draw_losses([row for row in some if row.curve and row.seed == 0])
        elif name == "figure-5.14":
            figure = draw_errors(some)
        else:
            figure = _poses(some, robots[group[0]], out)
        print(f"Wrote {save_png(figure, file)}")


def _per_marker(rows: "Sequence[StudyRow]") -> list[list[str]]:
    """Mean errors of each marker, and of all [cm]."""
    table: list[list[str]] = []
    for place, row in enumerate(rows):
        if place == 0 or row.robot != rows[place - 1].robot:
            table.append(["robot", "sampled by", "samples", "seed", "method", *row.markers, "mean", "lost"])
            table += [list(line) for line in _THESIS] if row.robot == _HAND else []
        means = [*row.markers.values(), row.errors["mean"]]
        numbers = [f"{100 * mean:.4f}" for mean in means]
        table.append([row.robot, row.draw, str(row.samples), str(row.seed), row.method, *numbers, str(row.lost)])
    return table


def _spread(rows: "Sequence[StudyRow]") -> list[list[str]]:
    """Mean, deviation, quantiles and largest error [mm], shares of the size, CPU times [s]."""
    names = list(rows[0].errors)
    head = ["robot", "sampled by", "samples", "seed", "method", *(f"{name} [mm]" for name in names)]
    table = [[*head, "mean [% of size]", "targets", "lost", "sampling [s]", "learning [s]"]]
    for words, mean, deviation, largest in _EARLIER:
        told = {"mean": mean, "deviation": deviation, "max": largest}
        table.append([words, "", "", "", "", *(told.get(name, "") for name in names)])
    for row in rows:
        numbers = [f"{1e3 * error:.4f}" for error in row.errors.values()]
        ends = [f"{100 * row.errors['mean'] / row.size:.4f}", str(row.targets), str(row.lost)]
        ends += [f"{row.sampling:.1f}", f"{row.learning:.1f}"]
        table.append([row.robot, row.draw, str(row.samples), str(row.seed), row.method, *numbers, *ends])
    return table


def _poses(rows: "Sequence[StudyRow]", robot: "Robot", out: Path) -> "Figure":
    """Targets, and where two networks bring the hand, from the most samples."""
    from hydrostat.learning import Samples
    from hydrostat.simulation import Simulation
    from hydrostat_lab.learning_figures import draw_side_by_side

    most = max(row.samples for row in rows)
    best = {row.method: row for row in rows if row.samples == most and row.seed == 0}
    test = Samples.read(out / f"{robot.name}-{rows[0].draw}-test-{rows[0].targets}")
    count = len(best["thesis"].shown)
    shown = {"target": test.contractions[:count].tolist(), "Chang (2018)": best["thesis"].shown}
    shown |= {"hydrostat": best["search"].shown}
    simulation = Simulation(robot)
    columns = {name: [simulation.solve(row, strict=False).nodes for row in some] for name, some in shown.items()}
    return draw_side_by_side(robot, columns)


def _csv(rows: Sequence[Sequence[str]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


class _Usual(NamedTuple):
    """Default settings of a study size."""

    robots: tuple[str, ...]
    counts: tuple[int, ...]
    targets: int
    seeds: int
    steps: int | None
    inverse_steps: int


_HAND = "cupping_hand"

_SIZES = {
    Size.MINUTES: _Usual((_HAND,), (100, 300), 24, 1, 2000, 1500),
    Size.HOUR: _Usual((_HAND,), (100, 300, 1000, 3000), 300, 1, None, 4000),
    Size.FULL: _Usual((_HAND, "extended_hand", "trunk"), (100, 300, 1000, 3000, 10_000, 100_000), 5000, 5, None, 4000),
}
"""Robots, numbers of samples, targets, seeds, and how long our networks learn."""

THINGS = ("table-5.1", "table-5.2", "figure-5.3", "figure-5.4", "figure-5.14")
"""Names of the tables and figures that can be reproduced."""

_WORDS = (
    f"{'samples':>7}{'seed':>5}  {'method':22}{'mean':>8}{'%':>8}"
    f"{'median':>9}{'p90':>9}{'p99':>9}{'max':>9}{'lost':>6}{'sampling':>9}{'learning':>9}  [CPU s]"
)

_THESIS = (
    ["Chang (2018)", "", "10000", "", "thesis", "0.4559", "0.5780", "0.5498", "0.8395", "0.6245", "0.6095", ""],
    ["Chang (2018)", "", "100000", "", "thesis", "0.4438", "0.5878", "0.5213", "0.7869", "0.5848", "0.5849", ""],
)
"""Table 5.1 as it stands there: thumb, index, middle, ring, pinky, mean [cm] (N9)."""

_EARLIER = (
    ("ref. 20 (different robot)", "7.35", "4.72", "22.22"),
    ("ref. 19 (different robot)", "4.2", "2.8", "12.3"),
    ("Chang (2018)", "6.095", "0.607", "7.352"),
)
"""Table 5.2 as it stands there: mean, deviation, largest [mm] (N11); grouped in a way that is not told (E37)."""
