"""`CATALOG`: every table and figure that can be reproduced, what committed runs found, and what it needs."""

import csv
import re
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from hydrostat.errors import HydrostatError, InputError
from hydrostat.version import install_command

ROOT = Path(__file__).parents[2]
"""Folder of the clone: sources are named from here."""


class Finding(NamedTuple):
    """Verdict of runs on one claim, and the number behind it."""

    claim: str
    verdict: str
    number: str


class CatalogEntry(NamedTuple):
    """Table or figure.

    Attributes:
        name: name for `hydrostat reproduce`, or the command of a script.
        shows: subject of the comparison.
        thesis: statement of the thesis; empty if none.
        source: file of the clone with the largest run so far, its command beside it.
        claims: beginnings of rows "claim | verdict | number" in the source, in the order of the experiment's claims.
        line: text of the source that holds all numbers of `ours`, where it judges no claims.
        ours: result of the largest run, where it judges no claims.
        verdict: confirmed, contradicted, beaten, cannot be told, measured or drawn, where it judges no claims.
        extra: extra of the package that it needs; empty if none.
        dear: reason why `all` leaves it out in the smallest size; empty if it does not.
    """

    name: str
    shows: str
    thesis: str = ""
    source: str = "lab/reinforcement/README.md"
    claims: tuple[str, ...] = ()
    line: str = ""
    ours: str = ""
    verdict: str = "cannot be told"
    extra: str = "rl"
    dear: str = ""

    def read_findings(self) -> list[Finding]:
        """Return what the source says (HydrostatError: it says nothing of a claim, or is not there)."""
        if not self.claims:
            return [Finding(self.shows, self.verdict, self.ours)]
        file = ROOT / self.source
        if not file.is_file():
            raise HydrostatError(f"{self.source} not found. Run hydrostat reproduce from a clone.")
        text = file.read_text(encoding="utf-8")
        rows = {cells[0]: cells[1:] for cells in re.findall(r"^\| (.+?) \| (.+?) \| (.+?) \|$", text, re.MULTILINE)}
        missing = [claim for claim in self.claims if claim not in rows]
        if missing:
            raise HydrostatError(f'{self.source}: no row for "{missing[0]}".')
        return [Finding(claim, *rows[claim]) for claim in self.claims]


_LEARNED, _RESULTS = "lab/learned_ik/README.md", "docs/results.md"
_SEARCH = "10000    0  search                   0.101   0.058    0.074    0.189    0.479    2.452"
_DRAWN = CatalogEntry("", "", source=_LEARNED, line="figure-5.3 figure-5.4 figure-5.14", verdict="drawn", extra="learn")

_SPARSE = "2,000 actions with a sparse reward and T=5 master no tolerance; --size hour takes 15,000"

_LARGE_LAYERS = "3 x 256 takes a minute of a core for 500 actions, too few to tell; --size hour takes 4,000"


def _script(command: str, shows: str, verdict: str, ours: str, line: str, **more: str) -> CatalogEntry:
    entry = CatalogEntry(command, shows, source=_RESULTS, verdict=verdict, ours=ours, line=line, extra="")
    return entry._replace(**more)


CATALOG = {
    "Chang (2018)": (
        CatalogEntry(
            "table-5.1",
            "mean error of the fingertips",
            "6.10 mm, 10,000 samples",
            _LEARNED,
            line=_SEARCH,
            ours="0.101 mm, 10000 samples",
            verdict="beaten",
            extra="learn",
        ),
        CatalogEntry(
            "table-5.2",
            "mean and largest error",
            "6.10 and 7.35 mm",
            _LEARNED,
            line=_SEARCH,
            ours="0.101 and 2.452 mm",
            verdict="beaten",
            extra="learn",
        ),
        _DRAWN._replace(name="figure-5.3", shows="learning curves of the network", thesis="loss below 0.02"),
        _DRAWN._replace(name="figure-5.4", shows="target and reached poses"),
        CatalogEntry(
            "figure-5.8",
            "episodes of 1, 5, 10 actions",
            "T=10 learns faster, both pass 0.9",
            claims=(
                "T=10 learns faster than T=1 (N13)",
                "T=1 ends above 0.9 (N13)",
                "T=10 ends above 0.9 (N13)",
                "T=10 arrives with its first action (N13)",
            ),
            dear=_LARGE_LAYERS,
        ),
        CatalogEntry(
            "figure-5.8-small",
            "the same in 4 x 30",
            claims=(
                "in 4 x 30: T=10 learns faster than T=1 (N13)",
                "in 4 x 30: T=1 ends above 0.9 (N13)",
                "in 4 x 30: T=10 ends above 0.9 (N13)",
            ),
        ),
        CatalogEntry(
            "figure-5.9",
            "curricula of the tolerance, 3 x 256",
            "b works, a and c get stuck",
            claims=(
                "in 3 x 256: b masters smaller tolerances than a (R83)",
                "in 3 x 256: c does not master 8.1 mm (R83)",
                "in 3 x 256: d masters smaller tolerances than b (F10, proposed)",
            ),
            dear=_LARGE_LAYERS,
        ),
        CatalogEntry(
            "figure-5.9-small",
            "the same in 4 x 30",
            "b works, a and c get stuck",
            claims=(
                "b masters smaller tolerances than a (R83)",
                "c does not master 8.1 mm (R83)",
                "d masters smaller tolerances than b (F10, proposed)",
            ),
            dear=_SPARSE,
        ),
        CatalogEntry(
            "figure-5.9-critic",
            "other readings of curriculum c",
            "stuck at 8.1 mm; begun there it reaches 0.9",
            claims=(
                "with its rate from the start, c does not master 8.1 mm (R83)",
                "with Adam's steps from 0, c does not master 8.1 mm (R83, E57)",
                "begun at 8.1 mm, c masters it (R83)",
            ),
            dear=_SPARSE,
        ),
        CatalogEntry(
            "figure-5.10",
            "tolerances and errors",
            "5.31 and 3.87 mm; 3.32 and 3.28 mm",
            claims=(
                "T=5 masters smaller tolerances than T=1 (N14)",
                "T=5 ends nearer than T=1 (N15)",
                "errors are below the tolerance in most epochs (N15)",
            ),
        ),
        CatalogEntry(
            "figure-5.12",
            "starts from anywhere",
            "poses shown, no number",
            claims=("from anywhere it comes as near as from rest, within 1 mm (R85)",),
        ),
        CatalogEntry(
            "table-noise",
            "noise of actions",
            "0.01, told as 5 % of the range",
            claims=("noise 0.1 ends nearer than 0.01 (E47)", "noise 0.2 ends nearer than 0.01 (E47)"),
        ),
        CatalogEntry(
            "table-reward",
            "shaped and sparse rewards",
            "shaped learns faster",
            claims=(
                "shaped learns faster than sparse (R87)",
                "without penalty and cut T=1 ends nearer (E54)",
                "then T=5 still ends nearer than T=1 (E54)",
            ),
        ),
        _DRAWN._replace(name="figure-5.14", shows="error over samples and time"),
        CatalogEntry(
            "figure-5.14-trial",
            "trial and error, same pairs",
            "1-NN, trial and error, network, ridge: best first",
            claims=(
                "the nearest neighbor ends nearer than trial and error (N16)",
                "trial and error ends nearer than a network of the same pairs (N16, R90)",
                "a network ends nearer than ridge regression (N16)",
                "trial and error ends nearer than a network of pairs drawn evenly (R90, E61)",
                "trial and error ends nearer than an equal network of the same pairs (R88)",
            ),
        ),
        CatalogEntry(
            "table-policies",
            "other policy methods",
            "3.28 mm, 100,000 actions",
            line="| cloned | 10,000 | 10,000 | 0.588 (0.568-0.615) |",
            ours="cloned: 0.588 mm, 10,000 pairs",
            verdict="beaten",
        ),
        CatalogEntry(
            "table-gradient",
            "the best of them",
            "3.28 mm, 100,000 actions",
            line="| **gradient**, 5,000 goals | 10,000 | 10,000 | **0.242 (0.241-0.244)** |",
            ours="0.242 mm, 10,000 equilibria",
            verdict="beaten",
        ),
        CatalogEntry(
            "figure-5.13",
            "the method in FetchReach",
            "curves of others",
            claims=(
                "sparse ends above 0.9, as published",
                "sparse is above 0.9 within 4,000 actions, as a user tells of the authors' code in one worker",
                "shaped learns faster than sparse (R78)",
            ),
        ),
        CatalogEntry(
            "figure-5.13-hand",
            "the method in HandReach",
            "curves of others",
            line="(`--size minutes`, 2 seeds, 5,000 actions) neither reward reaches a\n  goal: success 0.00",
            ours="success 0.00 after 5,000 actions",
            dear="5,000 actions reach no goal; published runs take millions",
        ),
    ),
    "README and docs/results.md": (
        _script(
            "python benchmarks/simulate.py",
            "time of an equilibrium",
            "measured",
            "14.6 ms, hand from rest",
            "| cupping hand: 10 random contractions, 0 to 30 %, from rest | 941 |  | 14.6 |",
        ),
        _script(
            "python benchmarks/ik_targets.py",
            "reachable targets that are reached",
            "measured",
            "96.5 to 100 %",
            "96.5 to 100 %",
        ),
        _script(
            "python benchmarks/design_robust.py",
            "error as built over that by hand or trees",
            "measured",
            "median 0.92 (0.6 was aimed at)",
            "Its median is 0.92, or 0.85 with median instead of 90th-percentile errors. The goals were a median of 0.6",
        ),
        _script(
            "python benchmarks/design_speed.py",
            "time of a design, starfish",
            "measured",
            "6.1 s",
            "| starfish | 0.7 | 6.1 |",
        ),
        _script(
            "python lab/hidden_twins/hidden_twins.py",
            "identified strip of 200 mm",
            "measured",
            "0.48 mm held out",
            "| long, 200 mm | 30 | 0.48 mm |",
        ),
        _script(
            "python benchmarks/real.py FOLDER",
            "OpenCR, its authors' MuJoCo model 8.60 mm",
            "beaten",
            "5.31 mm",
            "| hydrostat: rigid disks on a rod | 90, 42, 81 s of CPU | 4.63 | 4.16 | **5.31** |",
        ),
        _script(
            "python benchmarks/real.py FOLDER",
            "Emio, its makers' SOFA beam 2.25 mm",
            "measured",
            "2.54 mm",
            "| hydrostat, quadratic elements | 5,082 nodes, 28 s of CPU | 2.32 | 2.23 | **2.54** |",
        ),
        _script(
            "python benchmarks/motor_faults.py",
            "wrong runs, emulated motors, seeds 5 and 6",
            "measured",
            "0 of 12,935; one in each of two others",
            "in 12,935 runs, with a quarter of all packets damaged. 0 runs failed.",
        ),
        _script(
            "python lab/locking/bending.py",
            "sag less Timoshenko's, 2 quadratic elements",
            "measured",
            "0.1 and 0.8 %",
            "| 2 quadratic | 1,625 | 5.5 ms | 0.1 % | 0.8 % |",
        ),
        _script(
            "python lab/locking/bending.py",
            "the same, 4 linear elements",
            "measured",
            "−14.1 and −13.7 %",
            "| 4 linear, volume in patches | 1,625 | 8.2 ms | −14.1 % | −13.7 % |",
        ),
        _script(
            "python lab/peers/peers.py",
            "CPU time beside four programs",
            "measured",
            "fastest of five but for MuJoCo on one of four",
            "MuJoCo is faster than hydrostat on the hand under five weights.",
            source="docs/decisions/0023-peers.md",
        ),
        _script(
            "python lab/learned_ik/learned_ik.py",
            "errors of networks, hand",
            "measured",
            "0.096 mm, 5,000 targets",
            "| 0.207 | 0.096 (5,000 targets) |",
            extra="learn",
        ),
        _script("python docs/pictures.py", "pictures of the README", "drawn", "", "demo.gif", source="README.md"),
    ),
}
"""Tables and figures by where they stand."""


COSTS = ROOT / "lab" / "costs.csv"
"""Times of runs in the smallest size: name, minutes on an idle machine, what was run."""


def read_costs() -> dict[str, str]:
    """Return minutes of a run in the smallest size by the name of its entry, as text (HydrostatError: no file)."""
    if not COSTS.is_file():
        raise HydrostatError("lab/costs.csv not found. Run hydrostat reproduce from a clone.")
    rows = csv.DictReader(COSTS.read_text(encoding="utf-8").splitlines())
    return {row["name"]: f"{row['minutes']} min" if row["minutes"] else row["run"] for row in rows}


def catalog_lines() -> list[str]:
    """Return the catalog as text: a row for each finding of a table or figure."""
    lines, costs = [], read_costs()
    for source, entries in CATALOG.items():
        lines += ["", source, f"  {'table or figure':36}{'needs':7}{'cost':16}{'result so far':16}finding"]
        for entry in entries:
            for place, found in enumerate(entry.read_findings()):
                cost = costs.get(entry.name, "not measured")
                head = f"{entry.name:36}{entry.extra or '-':7}{cost:16}" if place == 0 else " " * 59
                word, _, when = found.verdict.partition(", ")
                number = ", ".join(part for part in (found.number, when) if part)
                lines.append(f"  {head}{word:16}{found.claim}{': ' * bool(number)}{number}")
    note = (
        "The robot of the thesis was another hand. Largest runs so far; their files are in CATALOG and reproduced.md."
    )
    return [
        *lines[1:],
        "",
        note,
        "Cost: --size minutes on two idle cores (lab/costs.csv). `all` runs those of Chang (2018).",
        "Sizes: --size minutes, hour or full.",
    ]


def require_extras(names: Sequence[str]) -> None:
    """Check that PyTorch, which all of them need, is there before anything is sampled (HydrostatError: it is not)."""
    for entry in CATALOG["Chang (2018)"]:
        if entry.name in names and find_spec("torch") is None:
            raise InputError(f"{entry.name}: package torch not found. Install it: {install_command(entry.extra)}")
