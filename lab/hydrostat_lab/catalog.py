"""`CATALOG`: every table and figure that can be reproduced, what it showed so far, and what it needs."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from hydrostat.errors import HydrostatError
from hydrostat.files import replace_file
from hydrostat.version import install_command


class CatalogEntry(NamedTuple):
    """Table or figure.

    Attributes:
        name: name for `hydrostat reproduce`, or the command of a script.
        shows: subject of the comparison.
        verdict: result of the largest runs so far, as `lab/*/README.md` and docs/results.md have it.
        extra: extra of the package that it needs; empty if none.
    """

    name: str
    shows: str
    verdict: str
    extra: str = ""


_HAND = "another hand than the thesis's"

CATALOG = {
    "Chang (2018)": (
        CatalogEntry("table-5.1", "mean error of each fingertip", f"beaten: 0.1 mm to 5.8 mm; {_HAND}", "learn"),
        CatalogEntry("table-5.2", "mean, deviation, largest error", f"beaten; {_HAND}", "learn"),
        CatalogEntry("figure-5.3", "learning curves of the network", "drawn, no claim", "learn"),
        CatalogEntry("figure-5.4", "target and reached poses", "drawn, no claim", "learn"),
        CatalogEntry("figure-5.8", "episodes of 1, 5, 10 actions", "contradicted: ten learn faster", "rl"),
        CatalogEntry("figure-5.8-small", "the same in 4 x 30", "confirmed: one ends above 0.9", "rl"),
        CatalogEntry("figure-5.9", "curricula of the tolerance", "confirmed: b below a", "rl"),
        CatalogEntry("figure-5.9-small", "the same in 4 x 30", "cannot be told: c stays above 8.1 mm", "rl"),
        CatalogEntry("figure-5.10", "tolerances and errors", "cannot be told: five before one", "rl"),
        CatalogEntry("figure-5.12", "starts from anywhere", "confirmed: within 1 mm", "rl"),
        CatalogEntry("table-noise", "noise of actions", "contradicted: more noise ends nearer", "rl"),
        CatalogEntry("table-reward", "shaped and sparse rewards", "confirmed: shaped is faster", "rl"),
        CatalogEntry("figure-5.14", "error over samples and time", "drawn, no claim", "learn"),
        CatalogEntry("figure-5.14-trial", "trial and error, same pairs", "contradicted: trial wins", "rl"),
        CatalogEntry("table-policies", "other policy methods", "ours, not in the thesis", "rl"),
        CatalogEntry("table-gradient", "the best of them", "ours, not in the thesis", "rl"),
        CatalogEntry("figure-5.13", "the method in FetchReach", "confirmed: sparse above 0.9", "rl"),
        CatalogEntry("figure-5.13-hand", "the method in HandReach", "cannot be told: too short a run", "rl"),
    ),
    "README and docs/results.md": (
        CatalogEntry("python benchmarks/simulate.py", "time of an equilibrium", "measured"),
        CatalogEntry("python benchmarks/ik_targets.py", "targets reached", "measured"),
        CatalogEntry("python benchmarks/design_robust.py", "errors as built", "better than by hand; three ties"),
        CatalogEntry("python benchmarks/design_speed.py", "time of a design", "measured"),
        CatalogEntry("python benchmarks/hidden_twins.py", "identification", "measured"),
        CatalogEntry("python benchmarks/real.py FOLDER", "a built robot of others", "better than its MuJoCo model"),
        CatalogEntry("python benchmarks/motor_faults.py", "faults of emulated motors", "none beyond a limit"),
        CatalogEntry("python lab/locking/bending.py", "bending of elements", "within 2 % of Timoshenko"),
        CatalogEntry("python lab/peers/peers.py", "other programs", "faster than two; MuJoCo wins one of two"),
        CatalogEntry("python lab/learned_ik/learned_ik.py", "errors of networks", "0.096 mm", "learn"),
        CatalogEntry("python docs/pictures.py", "pictures of the README", "drawn"),
    ),
}
"""Tables and figures by where they stand."""


def catalog_lines() -> list[str]:
    """Return the catalog as text."""
    lines = []
    for source, entries in CATALOG.items():
        lines += ["", f"{source}", f"  {'table or figure':36}{'shows':32}{'needs':7}result so far"]
        lines += [f"  {entry.name:36}{entry.shows:32}{entry.extra or '-':7}{entry.verdict}" for entry in entries]
    return [*lines[1:], "", "Sizes: --size minutes, hour or full. `all` runs those of Chang (2018)."]


def require_extras(names: Sequence[str]) -> None:
    """Check that PyTorch, which all of them need, is there before anything is sampled (HydrostatError: it is not)."""
    for entry in CATALOG["Chang (2018)"]:
        if entry.name in names and find_spec("torch") is None:
            raise HydrostatError(f"{entry.name}: package torch not found. Install it: {install_command(entry.extra)}")


def write_page(folder: Path) -> Path:
    """Write one page, reproduced.md, on all tables and figures that a folder has, and return its path."""
    lines = [
        "# Chang (2018) and hydrostat",
        "",
        "Verdicts are those of the largest runs so far, not of these files.",
        "",
    ]
    for entry in CATALOG["Chang (2018)"]:
        files = sorted(path.name for path in folder.glob(f"{entry.name}*") if _belongs(path.stem, entry.name))
        if files:
            lines += [f"## {entry.name}: {entry.shows}", "", f"Result so far: {entry.verdict}.", ""]
            lines += [f"{'!' * name.endswith('.png')}[{name}]({name})" for name in files] + [""]
    return replace_file(folder / "reproduced.md", "\n".join(lines).encode())


def _belongs(stem: str, name: str) -> bool:
    """Return True if a file is of this entry, not of one whose name is longer."""
    longer = [entry.name for entry in CATALOG["Chang (2018)"] if entry.name.startswith(f"{name}-")]
    return not any(stem == other or stem.startswith(f"{other}-") for other in longer)
