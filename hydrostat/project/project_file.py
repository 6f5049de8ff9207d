"""`read_project_file`, `write_project_file`: studio.json, which stands next to robot.toml."""

import json
from collections.abc import Sequence
from dataclasses import field, fields, make_dataclass
from pathlib import Path
from typing import Any, Literal, get_type_hints

from pydantic import ConfigDict, ValidationError, create_model

from hydrostat import units
from hydrostat.control import Timeline
from hydrostat.design import Constraints, RouteOptions, TreeSettings
from hydrostat.errors import InputError
from hydrostat.files import read_stranger, replace_file
from hydrostat.project.wishes import ELSEWHERE, Wishes

PROJECT_FILE = "studio.json"


KEYS = (
    "winches", "cables", "poses", "zones", "mirror", "tension", "clearance", "depth", "tolerance", "simplicity",
    "cables_per_winch", "slack", "stepped", "torque", "improve", "kept_winches", "kept_cables", "method",
    "threshold", "distance", "steps", "phi",
)  # fmt: skip
"""Wishes that are always written, in their order in the file."""

MORE = tuple(one.name for one in fields(Constraints) if one.name not in (*KEYS, *ELSEWHERE))
"""Constraints that are written only where they are not the usual ones."""


def _wishes_table() -> type:
    """Record with the wishes as they stand in the file, side by side; pydantic names it in complaints."""
    usual, hints = Wishes(), {"stepped": bool}
    for record in (RouteOptions, TreeSettings, Constraints, Wishes):
        hints |= get_type_hints(record)
    forms = [(name, hints[name], field(default=usual.value(name))) for name in (*KEYS, *MORE)]
    ratio = ("spool_ratio", float | None, field(default=None))  # None: as "stepped" says
    return make_dataclass("Wishes", [*forms, ratio], frozen=True, kw_only=True)


_TABLE = _wishes_table()

_FILE = create_model(
    "ProjectFile",
    __doc__="The whole file; a key that is unknown or a number that is not finite is an error.",
    __config__=ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False),
    format=(Literal[1], 1),
    timeline=(Timeline, ...),
    wishes=(_TABLE, ...),
)


def write_project_file(folder: Path, timeline: Timeline, wishes: Wishes) -> None:
    """Write keyframes and wishes whole or not at all (InputError: the file cannot be written)."""
    usual = Wishes()
    ratio = wishes.constraints.spool_ratio
    special = None if ratio in (1.0, Constraints.STEPPED) else ratio
    table = _TABLE(**{name: wishes.value(name) for name in (*KEYS, *MORE)}, spool_ratio=special)
    left_out = {name for name in MORE if wishes.value(name) == usual.value(name)}
    left_out |= {"spool_ratio"} if special is None else set()
    text = _FILE(timeline=timeline, wishes=table).model_dump_json(indent=2, exclude={"wishes": left_out})
    replace_file(folder / PROJECT_FILE, text.encode() + b"\n")


def read_project_file(folder: Path, cables: Sequence[str] = ()) -> tuple[Timeline, Wishes]:
    """Read a folder's file, if there is one (InputError: it is wrong); an old one may number the robot's cables."""
    file = folder / PROJECT_FILE
    if not file.exists():
        return Timeline(), Wishes()
    largest = 20_000_000  # maximum size of the file [bytes]
    content = read_stranger(file, name=PROJECT_FILE, most=largest)
    try:
        read: Any = _FILE.model_validate_json(_with_names(content, cables))
        values = dict(vars(read.wishes))
        if values["spool_ratio"] is None:
            del values["spool_ratio"]
        return read.timeline, Wishes.of(**values)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))[:80]
        raise InputError(units.printable(": ".join(filter(None, (PROJECT_FILE, place, first["msg"])))[:300])) from None
    except InputError as error:
        raise InputError(f"{PROJECT_FILE}: {error}") from None


def _with_names(content: bytes, cables: Sequence[str]) -> bytes:
    """Content with names of kept cables in place of numbers from 0, as old files have them."""
    try:
        read = json.loads(content)
        kept = read["wishes"]["kept_cables"]
        numbers = [one for one in kept if type(one) is int]
    except (ValueError, TypeError, LookupError, RecursionError):
        return content  # reading it reports the error
    if not numbers:
        return content
    read["wishes"]["kept_cables"] = [cables[one] for one in numbers if 0 <= one < len(cables)]
    return json.dumps(read).encode()
