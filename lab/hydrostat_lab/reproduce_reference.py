"""`reproduce_reference`: reinforcement learning in tasks with published curves, for `hydrostat reproduce`."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.cli import report_progress
from hydrostat_lab.trial_tables import drawn_runs, format_interval, is_finished, judged_claims, trials_missing

if TYPE_CHECKING:
    from hydrostat_lab.experiments import Ran

REFERENCE_TABLES = ("figure-5.13", "figure-5.13-hand")
"""Experiments in environments of gymnasium-robotics."""


def reproduce_reference(names: Sequence[str], out: Path, *, size: str, seeds: int | None) -> None:
    """Learn in FetchReach or HandReach, and say whether the published curves are met.

    Args:
        names: names out of `REFERENCE_TABLES`.
        out: folder for numbers and pictures.
        size: minutes, hour or full.
        seeds: number of random starts of each run.

    Raises:
        HydrostatError: torch, gymnasium-robotics or a fitting MuJoCo is missing.
    """
    if not names:
        return
    with trials_missing():
        from hydrostat_lab.reference import REFERENCES, run_reference
    from hydrostat.files import replace_file
    from hydrostat.plot import save_png

    many, epochs = _SIZES[size]
    count = many if seeds is None else seeds
    settings = {"seeds": count, "epochs": epochs}
    for name in names:
        if is_finished(out / f"{name}.json", settings):
            continue
        reference = REFERENCES[name]
        print(f"\n{name}: {reference.experiment.title}")
        print(f"{reference.task}, {count} seeds: interquartile means and their 95 % intervals\n{_WORDS}", flush=True)
        done: dict[str, Ran] = {}
        for way, ran in run_reference(reference, seeds=count, epochs=epochs, progress=report_progress()):
            print(_line(way, ran), flush=True)
            done[way] = ran
        kept = {"settings": settings, **judged_claims(reference.experiment, done)}
        replace_file(out / f"{name}.json", (json.dumps(kept, indent=1) + "\n").encode())
        print(f"Wrote {save_png(drawn_runs(reference.experiment, done), out / f'{name}.png')} and {name}.json")


def _line(name: str, ran: "Ran") -> str:
    """A run in numbers."""
    from hydrostat_lab.experiments import final
    from hydrostat_lab.reference import none_missed_from
    from hydrostat_lab.verdict import interquartile

    success = format_interval(interquartile(final(ran)), 2)
    left = format_interval(interquartile(10.0 * ran.best[-1].mean(axis=1)), 1)
    sure = f"{none_missed_from(ran):.0f}".replace("inf", "never")
    return f"{name:10}{int(ran.epochs.actions[-1]):8}{success:>20}{left:>24}{sure:>18}"


_SIZES = {"minutes": (2, 5), "hour": (5, 10), "full": (10, 50)}
"""Seeds, and epochs of 1,000 actions."""

_WORDS = f"{'reward':10}{'actions':>8}{'final success':>20}{'best error [mm]':>24}{'all reached from':>18}"
