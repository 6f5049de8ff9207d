"""`write_page`: the thesis, the largest runs and the runs of a folder side by side, with their pictures."""

import csv
import json
from collections.abc import Callable, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat_lab.catalog import CATALOG, CatalogEntry, Finding

_HEAD = (
    "# Chang (2018) and hydrostat",
    "",
    "The robot of the thesis was another hand: millimeters compare roughly. *Largest run* is what the named file",
    "has, *here* is of the files beside this page. A short run cannot tell what a long one can.",
    "",
    "| table or figure | claim or subject | thesis | largest run | verdict | here | verdict here |",
    "|---|---|---|---|---|---|---|",
)


def write_page(folder: Path) -> Path:
    """Write reproduced.md on all tables and figures of the thesis, with the files that a folder has; return its path.

    Raises:
        InputError: a file of the folder is damaged.
    """
    lines, pictures = list[str](_HEAD), list[str]()
    for entry in CATALOG["Chang (2018)"]:
        files = sorted(path.name for path in folder.glob(f"{entry.name}*") if _belongs(path.stem, entry.name))
        here = read_findings_of(folder, entry)
        for place, (told, new) in enumerate(zip_longest(entry.read_findings(), here)):
            first, found = place == 0, told or Finding(new.claim, "", "not judged")
            new = new or Finding(
                "", "", "" if files else f"not run{': ' * bool(first and entry.dear)}{entry.dear * first}"
            )
            cells = [f"[{entry.name}](#{_anchor(entry.name)})" if first and files else entry.name * first]
            cells += [found.claim, entry.thesis * first, found.number, found.verdict, new.number, new.verdict]
            lines.append(f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |")
        if files:
            pictures += [f"## {entry.name}", "", f"{entry.shows[:1].upper()}{entry.shows[1:]}. Source: {entry.source}."]
            pictures += ["", *(f"{'!' * name.endswith('.png')}[{name}]({name})" for name in files), ""]
    return replace_file(folder / "reproduced.md", "\n".join([*lines, "", *pictures]).encode())


def read_findings_of(folder: Path, entry: CatalogEntry) -> list[Finding]:
    """Return what the runs in a folder say, in the order of the entry's claims; none if there is no run."""
    for file, read in ((folder / f"{entry.name}.json", _read_json), (folder / f"{entry.name}.csv", _read_csv)):
        if file.exists():
            return _read(file, read)
    return []


def _read(file: Path, read: Callable[[str], list[Finding]]) -> list[Finding]:
    try:
        return read(file.read_text(encoding="utf-8"))
    except (ValueError, KeyError, TypeError, IndexError) as error:
        raise InputError(f"{file}: damaged ({error}). Delete it and reproduce it again.") from None


def _read_json(text: str) -> list[Finding]:
    kept = json.loads(text)
    if "claims" in kept:
        return [Finding(each["claim"], each["verdict"], each["number"]) for each in kept["claims"]]
    rows: Sequence[dict[str, Any]] = [row for row in kept["rows"] if "certified" not in row["way"]]
    best = min(rows, key=lambda row: sum(row["seeds"]) / len(row["seeds"]))
    mean = sum(best["seeds"]) / len(best["seeds"])
    return [Finding(best["way"], "", f"{best['way']}: {mean:.3f} mm, {best['pairs']} pairs")]


def _read_csv(text: str) -> list[Finding]:
    """The search on our networks with the most samples; tables have [cm] or [mm] as the thesis has."""
    head, *rows = csv.reader(text.splitlines())
    mean, unit = ("mean [mm]", 1.0) if "mean [mm]" in head else ("mean", 10.0)
    found = [row for row in rows if row[head.index("method")] == "search"]
    if not found:
        return []
    most = max(found, key=lambda row: int(row[head.index("samples")]))
    number = f"{unit * float(most[head.index(mean)]):.3f}"
    number += f" and {float(most[head.index('max [mm]')]):.3f}" if "max [mm]" in head else ""
    return [Finding("", "", f"{number} mm, {most[head.index('samples')]} samples")]


def _belongs(stem: str, name: str) -> bool:
    """Return True if a file is of this entry, not of one whose name is longer."""
    longer = [entry.name for entry in CATALOG["Chang (2018)"] if entry.name.startswith(f"{name}-")]
    return not any(stem == other or stem.startswith(f"{other}-") for other in longer)


def _anchor(name: str) -> str:
    """Return the link that GitHub and MyST make of a heading."""
    return name.replace(".", "")
