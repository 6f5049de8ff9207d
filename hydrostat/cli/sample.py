"""`hydrostat sample`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder
from hydrostat.cli.options import parse_optional
from hydrostat.cli.waiting import one_interrupt, read_robot, report_progress
from hydrostat.errors import InputError

if TYPE_CHECKING:
    import numpy as np


def sample(
    robot: RobotFolder,
    out: OutFolder,
    count: Annotated[int, typer.Option(metavar="N", help="Total number of samples over all runs.")] = 1000,
    contact: Annotated[
        bool, typer.Option("--contact", help="Enable self-contact even if robot.toml has no [contact].")
    ] = False,
    sampling: Annotated[
        str,
        typer.Option(
            metavar="WAY,WAY",
            help="Sampling strategies, alternated: box (all winches), antagonist (one of two opposed winches), faces "
            "(half of the winches), tension (up to --tension).",
        ),
    ] = "box",
    tension: Annotated[
        str | None, typer.Option(metavar="FORCE", help="Maximum cable tension for --sampling tension.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Random seed.")] = 0,
    nodes: Annotated[bool, typer.Option("--save-nodes", help="Also save all node positions.")] = False,
    shard: Annotated[
        str | None,
        typer.Option(metavar="I/N", help="Run part I of N, counted from 1, e.g. in a job array.", show_default="1/1"),
    ] = None,
    jobs: Annotated[int, typer.Option(metavar="N", help="Number of processes. -1 = one per core.")] = -1,
    backend: Annotated[
        str, typer.Option(metavar="loky|ray", help="Backend: loky = this machine, ray = Ray cluster (RAY_ADDRESS).")
    ] = "loky",
    file_size: Annotated[
        int, typer.Option(metavar="N", help="Samples per file. An interruption loses unfinished files.")
    ] = 64,
    export: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write all samples to one .parquet or .zarr file.")
    ] = None,
) -> None:
    """Sample a robot to train surrogate models.

    Each sample holds contractions, markers, exact Jacobians and tensions. Writes the settings to samples.json and the
    samples to .npy files. Run the same command again to resume, or with a larger --count to add samples. Results do not
    depend on the number of processes. Read the samples in Python with hydrostat.learning.Samples.read.

    Example: hydrostat sample gallery:starfish --count 200 --contact --out build/samples
    """
    from hydrostat.closed_set import parse_choice
    from hydrostat.learning import SamplePlan, Samples, SamplingScheme, check_export, export_samples, sample_robot
    from hydrostat.units import FORCE

    require_folder(out, shared=True)  # shards of one plan write side by side
    if export is not None:
        check_export(export)
    part = _part(shard)
    draws = tuple(parse_choice(SamplingScheme, each.strip(), what="--sampling") for each in sampling.split(","))
    most = parse_optional("--tension", tension, FORCE)
    loaded = read_robot(robot)
    plan = SamplePlan.of_robot(
        loaded, count, contact=contact, seed=seed, draws=draws, shard=file_size, nodes=nodes, tension=most
    )
    try:
        with one_interrupt("", interrupt=True):
            sample_robot(plan, out, part=part, jobs=jobs, backend=backend, progress=report_progress())
    except KeyboardInterrupt:
        line_end = "\n" if sys.stderr.isatty() else ""  # of the line with the progress
        print(f"{line_end}interrupted: run the same command again to resume", file=sys.stderr, flush=True)
        raise
    found = Samples.read(out)
    words = f"{len(found) + found.lost} of {count} samples in {out}"
    words += f", {found.lost} without a stable equilibrium" if found.lost else ""
    print(
        f"{words}; {100 * found.touches.mean():.0f} % in contact"
        if plan.robot.contact
        else f"{words}{_crossing_text(found.crosses)}"
    )
    if export is not None:
        print(f"Wrote {export_samples(out, export)}")


def _crossing_text(crosses: "np.ndarray") -> str:
    share = crosses.mean()
    return f"; {100 * share:.0f} % self-intersect. Add --contact to prevent this" if share else ""


def _part(text: str | None) -> tuple[int, int]:
    """Part i of n, counted from 0, of "2/8", which counts from 1."""
    if text is None:
        return 0, 1
    one, slash, many = text.partition("/")
    if not (slash and one.isdecimal() and many.isdecimal() and 1 <= int(one) <= int(many)):
        raise InputError(f"--shard {text}: not a part. Write I/N with I from 1 to N, e.g. 2/8.")
    return int(one) - 1, int(many)
