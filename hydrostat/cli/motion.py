"""The part of `hydrostat simulate` that moves in time."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.cli.contractions import check_contraction
from hydrostat.cli.places import print_places
from hydrostat.cli.progress import progress_bar
from hydrostat.errors import InputError
from hydrostat.units import counted

if TYPE_CHECKING:
    from hydrostat.simulation import Motion, Profile, Simulation


def move(
    simulation: "Simulation",
    contractions: Mapping[str, float],
    out: Path,
    *,
    duration: str | None,
    step: str,
    ramp: str,
    play: Path | None,
) -> list[Path]:
    """Move a robot from where it rests at first, print how it ended, and write all files; returns their paths."""
    from hydrostat import __version__
    from hydrostat.plot import draw_motion, draw_pose, save_png
    from hydrostat.simulation import write_motion, write_pose

    profile = _profile(simulation, contractions, ramp, play)
    seconds = max(float(profile.times[-1]), 1.0) if duration is None else _seconds("--duration", duration)
    dt = _seconds("--step", step)
    start = simulation.still(simulation.solve(profile.at(0.0)))
    began = time.process_time()
    with progress_bar() as tell:
        motions = _told(simulation.play(profile, seconds, dt, start=start), seconds, tell)
        files, table, last = write_motion(simulation.robot, motions, out)
    spent = time.process_time() - began
    extra = {"time": last.time, "kinetic": last.kinetic, "seconds": spent, "version": __version__}
    files += write_pose(simulation, last.pose, out, extra=extra)
    files.append(
        save_png(
            draw_pose(simulation.robot, last.pose, note=f"after {last.time:g} s of motion"),
            out / "pose.png",
        )
    )
    files.append(save_png(draw_motion(simulation.robot, table), out / "motion.png"))
    print_places(last, simulation.robot)
    fastest = 1e3 * float((last.velocities**2).sum(axis=1).max() ** 0.5)
    print(
        f"{counted(len(table.times) - 1, 'step')} to {last.time:g} s, {spent:.1f} s of work; no node is faster than",
        end=" ",
    )
    print(f"{fastest:.2g} mm/s at the end")
    return files


def _profile(simulation: "Simulation", contractions: Mapping[str, float], ramp: str, play: Path | None) -> "Profile":
    from hydrostat.simulation import Profile, read_profile

    if play is None:
        return Profile.ramp(simulation.contractions(contractions), _seconds("--ramp", ramp))
    if contractions:
        raise InputError("--play and --contract: give one of them")
    profile = read_profile(play, simulation.robot)
    for extreme in (profile.values.max(axis=0), profile.values.min(axis=0)):
        for winch, most in zip(simulation.robot.winches, extreme, strict=True):
            check_contraction(simulation.robot, winch.name, float(most), option=f"--play {play}:")
    return profile


def _seconds(option: str, text: str) -> float:
    from hydrostat.units import TIME, parse_quantity

    try:
        value = parse_quantity(text, TIME)
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    if not value > 0:
        raise InputError(f"{option} {text}: must be above 0 s")
    return value


def _told(motions: "Iterable[Motion]", seconds: float, tell: Callable[[str, int, int], None]) -> "Iterator[Motion]":
    """The same motions, told to the progress bar in milliseconds."""
    for motion in motions:
        tell("moving [ms]", round(1e3 * motion.time), round(1e3 * seconds))
        yield motion
