"""`run_study`: the same comparison of ways to learn, for several robots, draws, numbers of samples and seeds."""

import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning import LearnOptions, SamplePlan, Samples, SamplingScheme, sample_robot, sample_shard
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat_lab.compare import METHODS, Compared, compare, way_of

SEEDED = ("thesis", "values", "inverse", "search")
"""Ways that begin at random; the others are the same for each seed."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """Comparison of learning methods.

    Attributes:
        draws: ways in which contractions are drawn, each for itself.
        counts: numbers of samples to learn from.
        seeds: number of random starts of the networks.
        targets: number of targets.
        methods: ways to learn, of `METHODS`.
        options: options of our networks.

    Raises:
        InputError: counts, seeds or targets below 1, nothing to compare, or a way that there is not.
    """

    draws: Sequence[SamplingScheme] = (SamplingScheme.BOX,)
    counts: Sequence[int] = (1000,)
    seeds: int = 1
    targets: int = 300
    methods: Sequence[str] = METHODS
    options: LearnOptions = field(default_factory=LearnOptions)

    def __post_init__(self) -> None:
        for name, numbers in (("counts", self.counts), ("seeds", [self.seeds]), ("targets", [self.targets])):
            if not numbers or min(numbers) < 1:
                raise InputError(f"{name} must be 1 or more")
        for name in self.methods:
            if name not in METHODS:
                raise InputError(f'unknown method "{name}". Available: {", ".join(METHODS)}.')


@dataclass(frozen=True, kw_only=True)
class StudyRow:
    """Result of one method; errors are over all markers of all targets that have an equilibrium [m].

    Attributes:
        robot: its name.
        physics: hash of its physics.
        size: size of its body [m].
        draw: distribution of the contractions.
        samples: number of samples that it learned from.
        seed: random seed.
        targets: number of requested targets.
        method: its name.
        options: options of the networks, as text.
        moved: mean distance of the targets from the mean place of their markers [m].
        markers: mean error of each marker by its name [m].
        errors: mean, deviation, median, p90, p99 and max [m].
        lost: targets without an equilibrium.
        sampling: CPU time of the samples that it learned from [s], by that of a few of them.
        learning: CPU time of learning [s].
        facts: more that is known.
        curve: learning curve, as in `ThesisNetwork`; empty for other methods.
        shown: contractions for the first targets [m].
    """

    robot: str
    physics: str
    size: float
    draw: str
    samples: int
    seed: int
    targets: int
    method: str
    options: str
    moved: float
    markers: Mapping[str, float]
    errors: Mapping[str, float]
    lost: int
    sampling: float
    learning: float
    facts: Mapping[str, float]
    curve: Sequence[Sequence[float]]
    shown: Sequence[Sequence[float]]


def run_study(
    study: Study, robot: Robot, folder: Path, *, jobs: int = 1, progress: Progress | None = None
) -> Iterator[StudyRow]:
    """Sample a robot, learn and roll out; what an earlier run has found in the folder is not found again.

    Args:
        study: comparison to run.
        robot: robot; with contact if samples are to include it.
        folder: folder for samples and rows; it may be that of other robots too.
        jobs: processes that sample; -1 for one on each core.
        progress: same as for `sample_robot`.

    Raises:
        InputError: as for `SamplePlan.of_robot` and `compare`, or a file of rows that is damaged.
    """
    file = folder / "rows.jsonl"
    known = read_rows_of(file) if file.exists() else []
    simulation = Simulation(robot)
    for draw in study.draws:
        train, test, each = _samples(study, robot, draw, folder, jobs, progress)
        for count in study.counts:
            some = train.first(min(count, len(train)))
            for seed in range(study.seeds):
                options = replace(study.options, seed=seed)
                want = _Wanted(study=study, samples=some, test=test, draw=draw, seed=seed, options=str(asdict(options)))
                rows = [row for row in known if want.has(row)]
                yield from rows
                left = [name for name in want.methods if name not in {row.method for row in rows}]
                for found in compare(simulation, some, test, left, options=options) if left else ():
                    row = want.row(found, each * count)
                    with file.open("a", encoding="utf-8") as stream:
                        stream.write(json.dumps(asdict(row)) + "\n")
                    yield row


def read_rows_of(file: Path) -> list[StudyRow]:
    """Rows that `run_study` has kept (InputError: they are damaged); one that was cut off at the end is left out."""
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    try:
        rows = [StudyRow(**json.loads(line)) for line in lines if line.endswith("\n")]
    except (ValueError, TypeError):
        raise InputError(f"{file}: is damaged; delete it, and its rows are found again") from None
    if lines and not lines[-1].endswith("\n"):
        file.write_text("".join(lines[:-1]), encoding="utf-8")
    return rows


@dataclass(frozen=True, kw_only=True)
class _Wanted:
    """Rows of one number of samples and one seed."""

    study: Study
    samples: Samples
    test: Samples
    draw: SamplingScheme
    seed: int
    options: str

    @property
    def methods(self) -> list[str]:
        """Ways to be tried with this seed."""
        return [name for name in self.study.methods if self.seed == 0 or way_of(name) in SEEDED]

    @property
    def key(self) -> dict[str, object]:
        facts = self.samples.facts
        return {
            "robot": facts["robot"],
            "physics": facts["physics"],
            "size": facts["size"],
            "draw": str(self.draw),
            "samples": len(self.samples),
            "seed": self.seed,
            "targets": len(self.test),
            "options": self.options,
        }

    def has(self, row: StudyRow) -> bool:
        """True if a row is one of these."""
        return all(getattr(row, name) == value for name, value in self.key.items()) and row.method in self.methods

    def row(self, found: Compared, sampling: float) -> StudyRow:
        """Figures of one way."""
        errors, places = found.found, self.samples.markers.mean(axis=0)
        names, means = self.samples.facts["markers"], errors.mean(axis=0).tolist() if len(errors) else []
        return StudyRow(
            **self.key,  # pyright: ignore[reportArgumentType]
            method=found.method,
            moved=float(np.linalg.norm(self.test.markers - places, axis=-1).mean()),
            markers=dict(zip(names, means or [math.nan] * len(names), strict=True)),
            errors=_errors(errors),
            lost=found.lost,
            sampling=sampling,
            learning=found.seconds,
            facts=dict(found.facts),
            curve=[] if found.curve is None else found.curve.tolist(),
            shown=found.contractions[:SHOWN].tolist(),
        )


def _errors(errors: np.ndarray) -> dict[str, float]:
    """Mean, deviation and quantiles; NaN where there is nothing."""
    names = ("mean", "deviation", *QUANTILES)
    if not errors.size:
        return dict.fromkeys(names, math.nan)
    quantiles = [float(np.quantile(errors, share)) for share in QUANTILES.values()]
    return dict(zip(names, [float(errors.mean()), float(errors.std()), *quantiles], strict=True))


def _samples(
    study: Study, robot: Robot, draw: SamplingScheme, folder: Path, jobs: int, progress: Progress | None
) -> tuple[Samples, Samples, float]:
    """Samples to learn from, and others to be asked for; CPU time of one [s]."""
    found: list[Samples] = []
    plan: SamplePlan | None = None
    for name, count, seed in (("train", max(study.counts), 0), ("test", study.targets, 1)):
        plan = SamplePlan.of_robot(robot, count, seed=seed, draws=(draw,))
        place = folder / f"{robot.name}-{draw}-{name}-{count}"
        sample_robot(plan, place, jobs=jobs, progress=progress)
        found.append(Samples.read(place))
    trial = replace(plan, count=min(_TIMED, study.targets), shard=_TIMED)
    sample_shard(replace(trial, count=1), 0)  # compiles
    began = time.process_time()
    made = len(sample_shard(trial, 0))
    return found[0], found[1], (time.process_time() - began) / made


QUANTILES = {"median": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}
"""Quantiles in tables, by their names."""

SHOWN = 4
"""So many targets are kept to be drawn."""

_TIMED = 8
"""So many samples tell how long one takes."""
