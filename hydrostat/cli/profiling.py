"""Time of each part of the work, for `--profile`."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pstats import Stats

FILES = {
    "elements": "neo_hookean patch_dilatation energy",
    "assembly": "assembly",
    "factorization": "factorization supernodal factorized_hessian",
    "symbolic analysis": "ordering symbolic",
    "arcs": "warp",
    "cables": "cable cable_friction capstan loading_path tension_law",
    "viscous branches": "viscous",
    "inertia": "inertia",
    "pins and weight": "nodal_energies",
    "Newton": "newton",
    "motion": "dynamics",
    "files": "motion_file mesh_file",
    "pictures": "picture_file motion_figures robot_figures",
    "anchors": "anchors",
    "mesh": "mesh",
    "robot.toml": "read schema",
}
PARTS = {file: part for part, files in FILES.items() for file in files.split()}
"""Parts of the work by the files of hydrostat; the time of anything else counts to the parts that called for it."""

Place = tuple[str, int, str]  # file, line and name of a function


@contextmanager
def print_profile(wanted: bool, work: str) -> Iterator[None]:
    """Print a table of the CPU time of the work done inside, if that is wanted."""
    if not wanted:
        yield
        return
    import cProfile
    import pstats

    watch = cProfile.Profile()
    watch.enable()
    try:
        yield
    finally:
        watch.disable()
        _report(work, pstats.Stats(watch))


def _report(work: str, stats: "Stats") -> None:
    """Time by part: the own time of its functions, and of the library functions that work for it."""
    entries = stats.stats  # pyright: ignore[reportAttributeAccessIssue]
    known: dict[Place, dict[str, float]] = {}
    times: dict[str, float] = {}
    calls: dict[str, int] = {}
    for place, (_, count, own, _, _) in entries.items():
        for name, share in _owners(place, entries, known).items():
            times[name] = times.get(name, 0.0) + share * own
        if part := _part(place):
            calls[part] = calls.get(part, 0) + count
    whole = sum(times.values()) or 1.0
    print(f"{work:<26}{'ms':>9}{'share':>8}{'calls':>9}")
    for name, seconds in sorted(times.items(), key=lambda item: -item[1]):
        if seconds >= 0.005 * whole:
            print(f"{name:<26}{1e3 * seconds:>9.1f}{seconds / whole:>8.0%}{calls.get(name, 0) or '':>9}")
    print(f"{'sum (with profiler)':<26}{1e3 * whole:>9.1f}\n")


def _owners(place: Place, entries: dict, known: dict[Place, dict[str, float]]) -> dict[str, float]:
    """Shares of the parts for which a function works: its own, or those of its callers by the time they spend in it."""
    if part := _part(place):
        return {part: 1.0}
    if place in known:
        return known[place]
    known[place] = {"other": 1.0}  # for functions that call themselves
    callers = entries[place][4]
    whole = sum(cumulative for _, _, _, cumulative in callers.values())
    shares: dict[str, float] = {}
    for caller, (_, _, _, cumulative) in callers.items():
        for name, share in _owners(caller, entries, known).items():
            shares[name] = shares.get(name, 0.0) + share * (cumulative / whole if whole else 1.0 / len(callers))
    known[place] = shares or {"other": 1.0}
    return known[place]


def _part(place: Place) -> str | None:
    path = Path(place[0])
    return PARTS.get(path.stem) if "hydrostat" in path.parts else None
