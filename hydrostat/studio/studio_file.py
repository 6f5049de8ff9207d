"""`studio.json`: what the studio keeps of a robot beside its robot.toml: keyframes and wishes."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from hydrostat import units
from hydrostat.control import Timeline
from hydrostat.errors import InputError
from hydrostat.robot import replace_file
from hydrostat.robot.tables_file import read_bytes
from hydrostat.studio.records.wishes import Wishes

FILE = "studio.json"

LARGEST = 20_000_000
"""The file may have this many bytes."""


class StudioFile(BaseModel):
    """The whole file; what it does not know is an error, and so is a number that is none.

    Attributes:
        format: of the file.
        timeline: keyframes.
        wishes: for a design.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    format: Literal[1] = 1
    timeline: Timeline
    wishes: Wishes


def write_studio_file(folder: Path, timeline: Timeline, wishes: Wishes) -> None:
    """Write the file whole or not at all.

    Raises:
        InputError: it cannot be written.
    """
    text = StudioFile(timeline=timeline, wishes=wishes).model_dump_json(indent=2)
    replace_file(folder / FILE, text.encode() + b"\n")


def read_studio_file(folder: Path) -> StudioFile:
    """What the file says; nothing special if there is none.

    Raises:
        InputError: it cannot be read or says something else, in one line.
    """
    file = folder / FILE
    if not file.exists():
        return StudioFile(timeline=Timeline(), wishes=Wishes())
    content = read_bytes(file, FILE, LARGEST)
    try:
        return StudioFile.model_validate_json(content)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))[:80]
        raise InputError(units.printable(": ".join(filter(None, (FILE, place, first["msg"])))[:300])) from None
    except InputError as error:
        raise InputError(f"{FILE}: {error}") from None
