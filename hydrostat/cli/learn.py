"""`hydrostat learn`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import require_writable
from hydrostat.cli.waiting import one_interrupt, told
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.learning import LearnedModel


def learn(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Folder of samples that hydrostat sample has written.")],
    out: Annotated[Path, typer.Option(metavar="MODEL", help="The file to write.")],
    count: Annotated[int | None, typer.Option(metavar="N", help="Learn from the first N samples; default all.")] = None,
    members: Annotated[
        int | None, typer.Option(metavar="N", help="Networks; their disagreement is the model's doubt.")
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(metavar="N", help="Of training the forward networks; more take longer and err a little less."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of all that is drawn at random.")] = 0,
    start: Annotated[
        Path | None,
        typer.Option("--from", metavar="MODEL", help="A model of a coarser mesh, to be corrected by the samples."),
    ] = None,
    threads: Annotated[int, typer.Option(metavar="N", help="Cores to train on.")] = 1,
) -> None:
    """Learn from samples where a robot's markers go, and how to bring them somewhere.

    Writes one file that needs no simulator and no PyTorch to be used: hydrostat pose ROBOT --model MODEL, or in Python
    hydrostat.learning.load_model(MODEL).solve(targets). Ctrl-C ends it early; the file then holds the best so far.

    With --from the networks of a model learn on: a model of many samples of a coarse mesh, and a few samples of the
    same robot with a finer one, make a model of the finer one.

    Example: hydrostat learn build/samples --out build/starfish.model
    """
    from hydrostat.learning import LearnOptions, correct_model, learn_model, load_model, read_samples, save_model
    from hydrostat.robot import clear_unfinished

    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"--out {out}: {'is a folder' if out.is_dir() else 'its folder is not there'}; name a file")
    require_writable(out.parent, f"--out {out}")
    clear_unfinished(out.parent)
    chosen = {"members": members, "steps": steps}
    options = LearnOptions(seed=seed, threads=threads, **{name: n for name, n in chosen.items() if n is not None})
    samples = read_samples(data)
    samples = samples if count is None else samples.first(count)
    if start is not None:
        if chosen != {"members": None, "steps": None}:
            raise InputError("--from keeps the networks of its model: leave out --members and --steps")
        known = load_model(start)
        with one_interrupt("stopping; what was learned so far is kept"):
            model = correct_model(known, samples, tell=told())
            save_model(model, out)
        print(f"{len(samples)} samples: markers are expected within {1e3 * model.facts['error']:.3f} mm")
        _end(model, out)
        return
    with one_interrupt("stopping; what was learned so far is kept"):
        model = learn_model(samples, options=options, tell=told())
        save_model(model, out)
    facts = model.facts
    moved, error = 1e3 * facts["displacement"], 1e3 * facts["error"]
    print(f"{len(samples)} samples: markers that move {moved:.1f} mm are expected within {error:.3f} mm", end="")
    print("" if facts["inverse_error"] is None else f", brought back within {1e3 * facts['inverse_error']:.3f} mm")
    _end(model, out)


def _end(model: "LearnedModel", out: Path) -> None:
    """Say what was written, and whether it was stopped early; then the command ends with 130."""
    print(f"Wrote {out}")
    if model.facts["stopped"]:
        lacks = "" if model.inverse else ", without an inverse network"
        print(f"It was stopped early: this is the best so far{lacks}")
        raise typer.Exit(130)
