"""`hydrostat reproduce`."""

import csv
import io
from collections.abc import Iterable, Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, require_folder
from hydrostat.cli.sample import told
from hydrostat.closed_set import member
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.learning import Compared


class Size(StrEnum):
    """How much is sampled."""

    MINUTES = "minutes"
    HOUR = "hour"
    FULL = "full"


def reproduce(
    what: Annotated[str, typer.Argument(metavar="TABLE", help="What to reproduce: table-5.1.")],
    out: OutFolder,
    size: Annotated[str, typer.Option(metavar="minutes|hour|full", help="How much is sampled.")] = "minutes",
    draw: Annotated[str, typer.Option(metavar="WAY", help="How contractions are drawn: box, antagonist.")] = "box",
    jobs: Annotated[int, typer.Option(metavar="N", help="Processes; -1: one on each core.")] = -1,
) -> None:
    """Make a table of the thesis again, on our hand and with our simulator, and add ours.

    Table 5.1 is the mean error of each fingertip after contractions by a network were rolled out in the simulator.
    Samples go to DIR and are used again; the table is written there as CSV. The thesis had another hand, and another
    range of motion.

    Example: hydrostat reproduce table-5.1 --out build/table
    """
    from dataclasses import replace

    from hydrostat.learning import Draw, compare, plan_samples, read_samples, sample_robot
    from hydrostat.robot import Contact, load_robot, replace_file
    from hydrostat.robot.gallery import gallery_folder
    from hydrostat.simulation import Simulation

    if what not in TABLES:
        raise InputError(f"there is no {what!r}; there is: {', '.join(TABLES)}")
    counts, targets = _SIZES[member(Size, size, what="--size")]
    way = member(Draw, draw, what="--draw")
    require_folder(out)
    robot = replace(load_robot(gallery_folder("cupping_hand")), contact=Contact())
    folders = {"train": (max(counts), 0), "test": (targets, 1)}
    for name, (count, seed) in folders.items():
        plan = plan_samples(robot, count, seed=seed, draws=(way,))
        sample_robot(plan, out / f"{name}-{way}-{count}", jobs=jobs, tell=told())
    train, test = (read_samples(out / f"{name}-{way}-{count}") for name, (count, _) in folders.items())
    simulation, names = Simulation(robot), train.facts["markers"]
    rows = [list(row) for row in _THESIS]
    _print(["", *names, "mean"], rows)
    for count in counts:
        for found in compare(simulation, train.first(min(count, len(train))), test, _WAYS):
            rows.append(_row(found))
            _print([], rows[-1:])
    replace_file(out / f"{what}.csv", _csv(["way", *names, "mean"], rows))
    print(f"Wrote {out / what}.csv")


def _row(found: "Compared") -> list[str]:
    """Mean errors of each finger, and of all [cm]."""
    means = 100 * found.found.mean(axis=0)
    title = f"{found.method}, {found.samples}" + (f", {found.lost} lost" if found.lost else "")
    return [title, *(f"{mean:.4f}" for mean in means), f"{means.mean():.4f}"]


def _print(head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    for row in [head, *rows] if head else rows:
        print(f"{row[0]:24}" + "".join(f"{text:>9}" for text in row[1:]), flush=True)


def _csv(head: Sequence[str], rows: Iterable[Sequence[str]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *rows])
    return text.getvalue().encode()


TABLES = ("table-5.1",)
"""What can be reproduced."""

_SIZES = {Size.MINUTES: ((300,), 60), Size.HOUR: ((1000, 3000), 500), Size.FULL: ((1000, 10_000, 100_000), 5000)}
"""Samples to learn from, and targets."""

_WAYS = ("constant", "thesis", "ridge", "1-NN", "inverse", "search", "search, step")

_THESIS = (
    ("in the thesis, 10000", "0.4559", "0.5780", "0.5498", "0.8395", "0.6245", "0.6095"),
    ("in the thesis, 100000", "0.4438", "0.5878", "0.5213", "0.7869", "0.5848", "0.5849"),
)
"""Table 5.1 as it stands there: thumb, index, middle, ring, pinky, mean [cm] (N9)."""
