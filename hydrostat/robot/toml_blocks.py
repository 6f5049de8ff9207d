"""`split_blocks`: the text of a TOML file as its tables, each with the comments that belong to it."""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass

_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|\#[^\n]*|[\[\]{}\n]|[^"\'#\[\]{}\n]+',
    re.DOTALL,
)


@dataclass(frozen=True, kw_only=True)
class TomlBlock:
    """One table with its sub-tables, or what stands before the first."""

    name: str  # first part of its key; "" for what stands before the first table
    whole: bool = True  # whether it begins with the table itself and not with a sub-table
    free: str = ""  # what stands before it, apart: blank lines, and comments with a blank line after them
    lead: str = ""  # comments directly above its header
    text: str = ""  # from its header to the last line of its own


def split_blocks(text: str) -> tuple[list[TomlBlock], str]:
    """The blocks of a TOML file that tomllib can read, in order, and what is after the last; together all the text."""
    starts = [(0, "", True), *_headers(text)]
    blocks: list[TomlBlock] = []
    free = lead = ""
    for (start, name, whole), (end, _, _) in zip(starts, [*starts[1:], (len(text), "", True)], strict=True):
        own, apart, above = _parted(text[start:end], last=end == len(text))
        if blocks and not whole and name == blocks[-1].name:
            before = blocks.pop()
            own = before.text + free + lead + own
            blocks.append(TomlBlock(name=name, whole=before.whole, free=before.free, lead=before.lead, text=own))
        else:
            blocks.append(TomlBlock(name=name, whole=whole, free=free, lead=lead, text=own))
        free, lead = apart, above
    return blocks, free + lead


def comments(text: str) -> list[str]:
    """All comments of a TOML file, in order."""
    return [token.rstrip() for _, token, _ in _tokens(text) if token.startswith("#")]


def _tokens(text: str) -> Iterator[tuple[int, str, int]]:
    """Place, text and depth of brackets of each token."""
    depth = 0
    for match in _TOKEN.finditer(text):
        token = match[0]
        yield match.start(), token, depth
        if token in ("[", "{"):
            depth += 1
        elif token in ("]", "}"):
            depth -= 1


def _headers(text: str) -> Iterator[tuple[int, str, bool]]:
    """Find where each header's line begins, the first part of its key, and whether that is all of it."""
    fresh, line = True, 0
    for place, token, depth in _tokens(text):
        if token == "\n":
            if depth == 0:
                fresh, line = True, place + 1
        elif token.strip():
            if token == "[" and fresh and depth == 0:
                end = text.find("\n", place)
                header = text[place : len(text) if end < 0 else end]
                name, inner = next(iter(tomllib.loads(header.strip()).items()))
                yield line, name, not (inner[0] if isinstance(inner, list) else inner)
            fresh = False


def _parted(text: str, *, last: bool) -> tuple[str, str, str]:
    """Part a text: what belongs to a block, what stands apart after it, and the comments right above the next one."""
    end = 0
    for place, token, _ in _tokens(text):
        if token.strip() and not token.startswith("#"):
            end = place + len(token)
    stop = text.find("\n", end) + 1
    if stop == 0:
        return text, "", ""
    own, lines = text[:stop] if end else "", text[stop if end else 0 :].splitlines(keepends=True)
    blanks = [number for number, line in enumerate(lines) if not line.strip()]
    if not blanks:
        rest = "".join(lines)
        return (own + rest, "", "") if last else (own, "", rest)
    first, final = (blanks[0] if end else 0), blanks[-1] + 1
    return own + "".join(lines[:first]), "".join(lines[first:final]), "".join(lines[final:])
