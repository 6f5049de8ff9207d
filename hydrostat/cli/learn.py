"""`hydrostat learn`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import require_writable
from hydrostat.cli.waiting import one_interrupt, report_progress
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.learning import LearnedModel


def learn(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Sample folder written by `hydrostat sample`.")],
    out: Annotated[Path, typer.Option(metavar="MODEL", help="Model file to write.")],
    count: Annotated[
        int | None, typer.Option("--max-samples", metavar="N", help="Use only the first N samples.", show_default="all")
    ] = None,
    members: Annotated[
        int | None,
        typer.Option(metavar="N", help="Ensemble size. The spread is reported as uncertainty.", show_default="3"),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Training steps. More steps take longer and are slightly more accurate.",
            show_default="6000, plus 3 per sample",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Random seed.")] = 0,
    start: Annotated[
        Path | None,
        typer.Option("--fine-tune", metavar="MODEL", help="Model of a coarser mesh, to fine-tune with the samples."),
    ] = None,
    threads: Annotated[int, typer.Option(metavar="N", help="Number of CPU cores for training.")] = 1,
) -> None:
    """Train a surrogate model from samples.

    The model predicts marker positions and solves inverse kinematics in microseconds; `hydrostat pose` also works
    without a model. Writes one file, which runs without the simulator and without PyTorch: hydrostat pose ROBOT --model
    MODEL, or in Python hydrostat.learning.LearnedModel.load(MODEL).solve(targets). Ctrl-C stops early and saves the
    best model so far.

    With --fine-tune, training continues from an existing model. Train on many samples of a coarse mesh first, then
    fine-tune with a few samples of a finer mesh of the same robot.

    Example: hydrostat learn build/samples --out build/starfish.model
    """
    from hydrostat.files import clear_unfinished
    from hydrostat.learning import LearnedModel, LearnOptions, Samples, correct_model, learn_model

    if out.is_dir() or not out.parent.is_dir():
        raise InputError(
            f"--out {out}: {'is a folder' if out.is_dir() else 'folder not found'}. Name a file in an existing folder."
        )
    require_writable(out.parent, f"--out {out}")
    clear_unfinished(out.parent)
    chosen = {"members": members, "steps": steps}
    options = LearnOptions(seed=seed, threads=threads, **{name: n for name, n in chosen.items() if n is not None})
    samples = Samples.read(data)
    samples = samples if count is None else samples.first(count)
    if start is not None:
        if chosen != {"members": None, "steps": None}:
            raise InputError("--fine-tune: not available with --members or --steps. Remove them.")
        known = LearnedModel.load(start)
        with one_interrupt("stopping: saving the best model so far ...", interrupt=True):
            model = correct_model(known, samples, progress=report_progress())
            model.save(out)
        print(f"expected marker error {1e3 * model.card.error:.3f} mm ({len(samples)} samples)")
        _end(model, out)
        return
    with one_interrupt("stopping: saving the best model so far ...", interrupt=True):
        model = learn_model(samples, options=options, progress=report_progress())
        model.save(out)
    moved, error = 1e3 * model.card.displacement, 1e3 * model.card.error
    inverse = model.card.inverse_error
    words = "" if inverse is None else f", inverse error {1e3 * inverse:.3f} mm"
    print(f"expected marker error {error:.3f} mm{words} (mean motion {moved:.1f} mm, {len(samples)} samples)")
    _end(model, out)


def _end(model: "LearnedModel", out: Path) -> None:
    """Say what was written, and whether it was stopped early; then the command ends with 130."""
    print(f"Wrote {out}")
    if model.card.stopped:
        lacks = "" if model.inverse else ", without an inverse network"
        print(f"interrupted: best model so far{lacks}")
        raise typer.Exit(130)
