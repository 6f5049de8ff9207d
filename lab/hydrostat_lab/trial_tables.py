"""Tables, verdicts and pictures of learning by trial, for `hydrostat reproduce`."""

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.version import install_command

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hydrostat_lab.experiments import Experiment, Ran
    from hydrostat_lab.shared_data import OfPairs


def format_interval(found: object, digits: int) -> str:
    """Format an interval as text."""
    mean, low, high = (getattr(found, name) for name in ("mean", "low", "high"))
    return f"{mean:.{digits}f} ({low:.{digits}f}{' to ' if low < 0 else '-'}{high:.{digits}f})"


@contextmanager
def trials_missing() -> Iterator[None]:
    """Say which library is missing for reinforcement learning (HydrostatError)."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise InputError(f"package {error.name} not found. Install it: {install_command('rl')}") from None


def is_finished(file: Path, settings: Mapping[str, object]) -> bool:
    """Return True if a file of numbers is of a finished run with these settings; say so."""
    try:
        same = json.loads(file.read_text(encoding="utf-8"))["settings"] == settings
    except (OSError, ValueError, KeyError, TypeError):
        return False
    if same:
        print(f"\n{file.stem}: finished before, see {file.name}", flush=True)
    return same


def judged_claims(experiment: "Experiment", ran: "Mapping[str, Ran]") -> dict[str, Any]:
    """Say what the claims come to; all numbers of the runs, for a file."""
    from hydrostat_lab.verdict import interquartile, verdict

    claims = list[dict[str, object]]()
    for claim in experiment.claims:
        values = claim.measure(ran)
        actions = max(int(run.epochs.actions[-1]) for run in ran.values())
        word = f"{verdict(values, claim.above)}, at {actions:,} actions"
        number = f"{format_interval(interquartile(values), 3)} {claim.unit}".rstrip()
        print(f"  {claim.text}: {word}, {number} (claim: above {claim.above:g})")
        claims.append({"claim": claim.text, "verdict": word, "number": number, "seeds": values.tolist()})
    runs = {
        name: {
            "actions": run.epochs.actions.tolist(),
            "success": run.epochs.success.tolist(),
            "distance [cm]": run.epochs.distance.tolist(),
            "tolerance [cm]": run.epochs.tolerance.tolist(),
        }
        for name, run in ran.items()
    }
    return {"title": experiment.title, "claims": claims, "runs": runs}


def drawn_runs(experiment: "Experiment", ran: "Mapping[str, Ran]") -> "Figure":
    """Curves of all runs: interquartile means over the seeds, and what lies between the seeds."""
    from hydrostat.plot import draw_curves

    words = {
        "success": ("success rate", 1.0),
        "distance": ("mean distance [mm]", 10.0),
        "tolerance": ("tolerance [mm]", 10.0),
    }
    panes = {}
    for shown in experiment.shown:
        label, unit = words[shown]
        panes[label] = {name: (run.epochs.actions, unit * getattr(run.epochs, shown)) for name, run in ran.items()}
    return draw_curves(panes)


def shared_table(
    name: str, compared: "Iterable[OfPairs]", out: Path, width: float, settings: Mapping[str, object] | None = None
) -> None:
    """Tell what each way leaves after so many pairs, which claims hold at the end, and draw it; size in mm."""
    from hydrostat.files import replace_file
    from hydrostat.plot import save_png
    from hydrostat_lab.learning_figures import draw_costs
    from hydrostat_lab.shared_data import ORDERS
    from hydrostat_lab.verdict import interquartile, verdict

    print(f"\n{name}: trial and error (T=1, 4 x 30, shaped, goal only) compared with other methods")
    print(f"{'method':24}{'pairs':>8}{'in networks [mm]':>24}{'in the simulator [mm]':>24}{'% size':>8}{'lost':>6}")
    ends, rows, curves = dict[str, np.ndarray](), list[dict[str, Any]](), dict[str, list[tuple[float, float]]]()
    for each in compared:
        expected = 10.0 * each.expected.mean(axis=1)
        row, found = {"way": each.way, "pairs": each.pairs, "in networks": expected.tolist()}, interquartile(expected)
        text = f"{each.way:24}{each.pairs:8}{format_interval(found, 3):>24}"
        curves.setdefault(each.way, []).append((each.pairs, found.mean))
        if each.exact is not None:
            ends[each.way] = seeds = 10.0 * np.nanmean(each.exact, axis=1)
            found, row["in the simulator"] = interquartile(seeds), seeds.tolist()
            lost = int(np.isnan(each.exact).sum())
            text = f"{text}{format_interval(found, 3):>24}{100 * found.mean / width:8.3f}{lost:6}"
        print(text, flush=True)
        rows.append(row)
    claims = []
    for order in ORDERS:
        lead = ends[order.farther] - ends[order.nearer]
        word = verdict(lead, 0.0)
        number = f"{format_interval(interquartile(lead), 3)} mm"
        print(f"  {order.text}: {word}, by {number}")
        claims.append({"claim": order.text, "verdict": word, "number": number, "seeds": lead.tolist()})
    kept = {"settings": settings, "claims": claims, "rows": rows}
    replace_file(out / f"{name}.json", (json.dumps(kept, indent=1) + "\n").encode())
    axes = "action-outcome pairs", "mean error in networks [mm]"
    print(f"Wrote {save_png(draw_costs(curves, *axes), out / f'{name}.png')} and {name}.json")
