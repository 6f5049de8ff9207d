"""`TablesFile`: the text of a TOML file and its tables; every complaint names the file, the line and the key."""

import re
import tomllib
from abc import ABC, abstractmethod
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from hydrostat import units
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.toml_schema import TomlTable


_PLACE = re.compile(r"([a-z_]+)(?:\[\d+\])*(?:\.[a-z_]+(?:\[\d+\])*)*(?=[ :.])")
_LONG_KEY = re.compile(r"""(?<![\w-])(?:["']?[\w-]*["']?[ \t]*\.[ \t]*){30}""")
_Record = TypeVar("_Record")


class TablesFile(ABC):
    """Turns the text of one file into records."""

    kind = "a robot"  # what the file describes, in complaints

    empty: str | None = "the file is empty; begin with format = 1, or run hydrostat new"
    """Complaint of a file without text; None: it may have none."""

    unit = "mm"  # unit of coordinates

    def __init__(self, file: Path, text: str) -> None:
        self.file = file
        self.text = text
        self.table = self._parse()

    @abstractmethod
    def form(self) -> "type[TomlTable]":
        """Tables and keys that the file may have."""

    def records(self, key: str, make: Callable[[Any], _Record]) -> tuple[_Record, ...]:
        """Record of each table under a key."""
        entries = getattr(self.table, key)
        return tuple(self.at(f"{key}[{index}]", lambda entry=entry: make(entry)) for index, entry in enumerate(entries))

    def point(self, coordinates: list[Decimal]) -> tuple[float, ...]:
        """Coordinates [m]."""
        return tuple(units.scale_up(value, self.unit, units.LENGTH) for value in coordinates)

    def at(self, key: str, make: Callable[[], _Record], *, otherwise: str | None = None) -> _Record:
        """Call `make`; its complaint is located at the field it begins with, else at `otherwise`."""
        from hydrostat.robot.schema_errors import allowed_keys

        try:
            return make()
        except InputError as error:
            message = str(error)
            if message.startswith((f"{self.file},", f"{self.file}:")):  # its place is told already
                raise
            place = _PLACE.match(message)
            if place and place[1] in allowed_keys(key, self.form()):
                self.fail(f"{key}.{place[0]}".removeprefix("."), message[place.end() :])
            self.fail(key if otherwise is None else otherwise, message)

    def written_key(self, key: str) -> str:
        """The key as the file has it."""
        return key

    def fail(self, key: str, message: str, line: int | None = None) -> NoReturn:
        """Complain of a key (InputError: always)."""
        line = line or find_line(self.text, self.written_key(key))
        where = f"{self.file}{f', line {line}' if line else ''}"
        told = key + message if message.startswith((" ", ":")) else f"{key}: {message}" if key else message
        longest = 440  # characters of a complaint, its file and line not counted
        told = told if len(told) <= longest else told[: longest - 3] + "..."
        raise InputError(units.printable(f"{where}: {told}")) from None

    def _parse(self) -> Any:
        from pydantic import ValidationError

        from hydrostat.robot.schema_errors import first_complaint

        if self.empty is not None and not self.text.strip():
            self.fail("", self.empty)
        try:
            return self.form().model_validate(self._data())
        except ValidationError as error:
            self.fail(*first_complaint(error, self.form()))

    def _data(self) -> dict[str, Any]:
        """File as tomllib reads it, which takes time in the square of a key's parts."""
        if _LONG_KEY.search(self.text):
            self.fail("", f"not TOML of {self.kind}: a key has more than 30 parts")
        try:
            return tomllib.loads(self.text, parse_float=Decimal)
        except tomllib.TOMLDecodeError as error:
            what, _, place = str(error).partition(" (at line ")
            line = re.match(r"\d+", place)
            number = int(line[0]) if line else None
            hint = _hint_at(what, self.text.split("\n")[number - 1] if number else "")
            self.fail("", f"not TOML: {what}{hint}", number)
        except RecursionError:
            self.fail("", f"not TOML of {self.kind}: brackets are nested too deep")
        except (ValueError, ArithmeticError):
            self.fail("", f"not TOML of {self.kind}: a number is too large or has too many digits")


_BARE_TEXT = re.compile(r"""\s*([\w.-]+)\s*=\s*([^\W\d][^"'#\[\]{}]*?|\d[^"'#\[\]{},]*?[^\W\d]\w*)\s*(?:#.*)?""")
_AFTER_TEXT = re.compile(r"""\s*([\w.-]+)\s*=\s*("[^"]*"|'[^']*')\s*([^\s#].*)""")


_SPACED_KEY = re.compile(r"(?:^|[{,])\s*([\w-]+(?: +[\w-]+)+)\s*=")


def _hint_at(what: str, line: str) -> str:
    """Fix for a line that is no TOML; empty if none is known."""
    if what.startswith("Expected '='") and len(line) <= 200 and (spaced := _SPACED_KEY.search(line)):
        return f'; a key with a space needs quotes: "{spaced[1]}" = ...'
    if what == r"Illegal character '\n'":
        return '; a text on this line is not closed, " is missing'
    if what == "Cannot overwrite a value":
        return "; the key is there twice. Remove one"
    if len(line) > 200 or not what.startswith(("Invalid value", "Expected newline")):
        return ""
    if bare := _BARE_TEXT.fullmatch(line):
        if (small := bare[2].lower()) in ("true", "false", "inf", "nan"):
            return f"; write {bare[1]} = {small}"
        return f'; write text in quotes: {bare[1]} = "{bare[2]}"'
    if after := _AFTER_TEXT.fullmatch(line):
        return f"; remove {units.quote(after[3].strip())} after the quotes: {after[1]} = {after[2]}"
    return ""


_HEADER = re.compile(r"""\s*\[\[?\s*["']?([A-Za-z_][\w.]*)["']?\s*\]""")
_STEP = re.compile(r"(\w+)(?:\[(\d+)\])?(?:\[\d+\])*(?:\.|(?=\W|$))")


def find_line(text: str, key: str) -> int | None:
    """Find the line of a key such as cable[1].points[0], as near as headers and key names allow; None if absent.

    A key that is missing from its table stands at the table's header.
    """
    steps = _key_steps(key)
    if not steps:
        return None
    lines = text.split("\n")
    headers = [(number, found[1]) for number, line in enumerate(lines) if (found := _HEADER.match(line))]
    block, name, depth, single = range(-1, len(lines)), "", 0, True
    for number, (step, index) in enumerate(steps):
        name = f"{name}.{step}".removeprefix(".")
        starts = [line for line, other in headers if other == name and (line in block or single)]
        if number == 0 and len(starts) <= index:
            break
        if starts:
            start, depth = starts[min(index, len(starts) - 1)], number + 1
            later = (line for line, other in headers if line > start and not other.startswith(f"{name}."))
            block, single = range(start, next(later, len(lines))), single and len(starts) == 1
    own = range(block.start + 1, next((number for number, _ in headers if number in block[1:]), block.stop))
    names = [re.escape(step) for step, _ in steps[depth:]]
    for count in range(len(names), 0, -1):
        if line := _find(lines, own, r"\s*\.\s*".join(names[:count])):
            return line
    return block.start + 1 or None


def _key_steps(key: str) -> list[tuple[str, int]]:
    """Names and indices of a key, its first 6 at most."""
    steps, place = [], 0
    while len(steps) < 6 and (found := _STEP.match(key, place)):
        steps.append((found[1], int(found[2] or 0)))
        place = found.end()
    return steps


def _find(lines: list[str], places: range, key: str) -> int | None:
    pattern = re.compile(rf"""\s*["']?{key}["']?\s*[=.]""")
    return next((number + 1 for number in places if pattern.match(lines[number])), None)
