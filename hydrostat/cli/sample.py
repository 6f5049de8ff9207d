"""`hydrostat sample`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder
from hydrostat.cli.options import asked
from hydrostat.cli.waiting import read_robot, told
from hydrostat.errors import InputError

if TYPE_CHECKING:
    import numpy as np


def sample(
    robot: RobotFolder,
    out: OutFolder,
    count: Annotated[int, typer.Option(metavar="N", help="How many samples, of all runs together.")] = 1000,
    contact: Annotated[
        bool, typer.Option("--contact", help="The body feels itself, even if robot.toml is silent.")
    ] = False,
    draw: Annotated[
        str,
        typer.Option(
            metavar="WAY,WAY",
            help="How contractions are drawn, one sample each in turn: box, antagonist, faces, tension.",
        ),
    ] = "box",
    tension: Annotated[
        str | None, typer.Option(metavar="FORCE", help="The most that a cable pulls in samples drawn by tension.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the draws.")] = 0,
    nodes: Annotated[bool, typer.Option("--nodes", help="Keep the places of all nodes, too.")] = False,
    shard: Annotated[
        str | None, typer.Option(metavar="I/N", help="Make part I of N, counted from 1, as in an array of jobs.")
    ] = None,
    jobs: Annotated[int, typer.Option(metavar="N", help="Processes; -1: one on each core.")] = -1,
    backend: Annotated[
        str, typer.Option(metavar="loky|ray", help="This machine, or a Ray cluster (RAY_ADDRESS).")
    ] = "loky",
    file_size: Annotated[
        int, typer.Option(metavar="N", help="Samples in each file: what an interruption may cost.")
    ] = 64,
    export: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write all as one .parquet, or as .zarr.")
    ] = None,
) -> None:
    """Sample a robot for learning: contractions, markers, exact slopes, tensions.

    Writes samples.json, which says what was sampled, and a .npy file for each few samples. The same command goes on
    where it ended, and with a larger --count to that; the bytes do not depend on how many work. Python reads them by
    hydrostat.learning.read_samples.

    Example: hydrostat sample examples/starfish --count 200 --contact --out build/samples
    """
    from hydrostat.closed_set import parse_choice
    from hydrostat.learning import (
        SamplingScheme,
        check_export,
        export_samples,
        plan_samples,
        read_samples,
        sample_robot,
    )
    from hydrostat.units import FORCE

    require_folder(out)
    if export is not None:
        check_export(export)
    part = _part(shard)
    draws = tuple(parse_choice(SamplingScheme, each.strip(), what="--draw") for each in draw.split(","))
    most = asked("--tension", tension, FORCE)
    loaded = read_robot(robot)
    plan = plan_samples(
        loaded, count, contact=contact, seed=seed, draws=draws, shard=file_size, nodes=nodes, tension=most
    )
    try:
        sample_robot(plan, out, part=part, jobs=jobs, backend=backend, tell=told())
    except KeyboardInterrupt:
        line_end = "\n" if sys.stderr.isatty() else ""  # of the line with the progress
        print(f"{line_end}the same command goes on from here", file=sys.stderr, flush=True)
        raise
    found = read_samples(out)
    words = f"{len(found) + found.lost} of {count} samples in {out}"
    words += f", {found.lost} of them without a stable equilibrium" if found.lost else ""
    print(f"{words}; {found.touches.mean():.0%} touch" if plan.robot.contact else f"{words}{_crossed(found.crosses)}")
    if export is not None:
        print(f"Wrote {export_samples(out, export)}")


def _crossed(crosses: "np.ndarray") -> str:
    share = crosses.mean()
    return f"; {share:.0%} of the bodies pass through themselves: --contact keeps them apart" if share else ""


def _part(text: str | None) -> tuple[int, int]:
    """Part i of n, counted from 0, of "2/8", which counts from 1."""
    if text is None:
        return 0, 1
    one, slash, many = text.partition("/")
    if not (slash and one.isdecimal() and many.isdecimal() and 1 <= int(one) <= int(many)):
        raise InputError(f"--shard {text}: write I/N, for example 2/8, with I from 1 to N")
    return int(one) - 1, int(many)
