"""`read_project_file`, `write_project_file`: studio.json, which stands next to robot.toml."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from hydrostat import units
from hydrostat.control import Timeline
from hydrostat.errors import InputError
from hydrostat.geometry import read_stranger
from hydrostat.project.wishes import Wishes
from hydrostat.robot import replace_file

PROJECT_FILE = "studio.json"

LARGEST = 20_000_000  # maximum size of the file [bytes]


class ProjectFile(BaseModel):
    """The whole file; a key that is unknown or a number that is not finite is an error."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    format: Literal[1] = 1  # of the file
    timeline: Timeline  # keyframes
    wishes: Wishes  # for a design


def write_project_file(folder: Path, timeline: Timeline, wishes: Wishes) -> None:
    """Write the file whole or not at all (InputError: it cannot be written)."""
    text = ProjectFile(timeline=timeline, wishes=wishes).model_dump_json(indent=2)
    replace_file(folder / PROJECT_FILE, text.encode() + b"\n")


def read_project_file(folder: Path, cables: Sequence[str] = ()) -> ProjectFile:
    """Read a folder's file, if there is one (InputError: it is wrong); an old one may number the robot's cables."""
    file = folder / PROJECT_FILE
    if not file.exists():
        return ProjectFile(timeline=Timeline(), wishes=Wishes())
    content = read_stranger(file, name=PROJECT_FILE, most=LARGEST)
    try:
        return ProjectFile.model_validate_json(_with_names(content, cables))
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
