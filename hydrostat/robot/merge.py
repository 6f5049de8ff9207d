"""`merged_text`: a robot put into the text of a robot.toml that was there, so that its comments and its form stay."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import MISSING, dataclass, fields, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot.body import Body
from hydrostat.robot.cable import Cable
from hydrostat.robot.contact import Contact, Obstacle
from hydrostat.robot.load import Load
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.pin import Pin
from hydrostat.robot.pin_drive import PinDrive
from hydrostat.robot.read import RobotReader, read_material
from hydrostat.robot.robot import Robot
from hydrostat.robot.rod import Rod
from hydrostat.robot.sensor import Sensor
from hydrostat.robot.sheet import Membrane
from hydrostat.robot.winch import Winch
from hydrostat.robot.write import robot_text

_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|\#[^\n]*|[\[\]{}\n]|[^"\'#\[\]{}\n]+',
    re.DOTALL,
)


@dataclass(frozen=True, kw_only=True)
class TomlBlock:
    """One table with its sub-tables, or the text before the first table."""

    name: str  # first part of its key; "" for what stands before the first table
    whole: bool = True  # True if it begins with the table itself, not with a sub-table
    free: str = ""  # detached text before it: blank lines, and comments followed by a blank line
    lead: str = ""  # comments directly above its header
    text: str = ""  # from its header to the last line of its own


def split_blocks(text: str) -> tuple[list[TomlBlock], str]:
    """Split a TOML file that tomllib can read into its blocks and the text after the last, without loss."""
    starts = [(0, "", True), *_headers(text)]
    blocks: list[TomlBlock] = []
    free = lead = ""
    for (start, name, whole), (end, _, _) in zip(starts, [*starts[1:], (len(text), "", True)], strict=True):
        own, apart, above = _split_block(text[start:end], last=end == len(text))
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
    """Find the start of each header's line, the first part of its key, and whether that is the whole key."""
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


def _split_block(text: str, *, last: bool) -> tuple[str, str, str]:
    """Split a text into the part of a block, detached text after it, and the comments right above the next one."""
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


_RECORDS = {
    "body": Body,
    "contact": Contact,
    "pin": Pin,
    "drive": PinDrive,
    "winch": Winch,
    "cable": Cable,
    "marker": Marker,
    "pose": PoseTarget,
    "obstacle": Obstacle,
    "load": Load,
    "rod": Rod,
    "sheet": Membrane,
    "sensor": Sensor,
}
_LISTS = ("pin", "drive", "winch", "cable", "marker", "pose", "obstacle", "load", "rod", "sheet", "sensor")
_SINGLE = ("body", "contact")
_ORDER = ("", *_SINGLE, *_LISTS)


def merged_text(text: str, robot: Robot) -> str:
    """Text of a robot.toml that describes a robot, as near as can be to a text that described another state of it.

    Comments, order and form of all that did not change stay, and tables that are no longer wanted go with their own
    comments (`lost_comments` tells which). A text that is no robot.toml is replaced.
    """
    fresh = robot_text(robot)
    try:
        merged = _merge_text(text if text.endswith("\n") else text + "\n", fresh)
        if merged is not None and _Check(merged, robot.body, fresh).robot() == robot:
            return text if merged == text + "\n" else merged
    except InputError:
        pass
    return fresh


def lost_comments(before: str, after: str) -> list[str]:
    """Comments of one text that another no longer has, in order."""
    kept = comments(after)
    lost = []
    for comment in comments(before):
        if comment in kept:
            kept.remove(comment)
        else:
            lost.append(comment)
    return lost


class _Check(RobotReader):
    """Reader of a robot that does not mesh its body again: the body must be the same."""

    def __init__(self, text: str, body: Body, fresh: str) -> None:
        super().__init__(Path("robot.toml"), text)
        self._given, self._wanted = body, RobotReader(Path("robot.toml"), fresh).table.body

    def _body(self) -> Body:
        if _effective("body", self.table.body, Decimal(1)) != _effective("body", self._wanted, Decimal(1)):
            raise InputError("the body is another one")
        return self._given


@dataclass(frozen=True, eq=False)
class _Side:
    """Text with its contents: entries of each kind as text and as parsed values."""

    blocks: list[TomlBlock]
    tail: str
    data: dict[str, Any]
    means: dict[str, list[dict[str, Any]]]

    def blocks_of(self, kind: str) -> list[int]:
        return [number for number, block in enumerate(self.blocks) if block.name == kind]


def _side(text: str, unit: str | None = None) -> _Side:
    table = RobotReader(Path("robot.toml"), text).table
    factor = units.unit_factor(unit or table.length_unit, units.LENGTH)
    means = {kind: [_effective(kind, entry, factor) for entry in getattr(table, kind)] for kind in _LISTS}
    for kind in _SINGLE:
        entry = getattr(table, kind)
        means[kind] = [] if entry is None else [_effective(kind, entry, factor)]
    means[""] = [{key: getattr(table, key) for key in ("name", "length_unit", "gravity", "face")}]
    blocks, tail = split_blocks(text)
    return _Side(blocks, tail, tomllib.loads(text, parse_float=Decimal), means)


def _effective(kind: str, entry: Any, factor: Decimal) -> dict[str, Any]:
    """Meaning of each key of a table, in SI; a key that is left out means the record's default."""
    defaults = {field.name: field.default for field in fields(_RECORDS[kind]) if field.default is not MISSING}
    given = {key: getattr(entry, key) for key in type(entry).model_fields}
    values = {key: defaults.get(key) if value is None else _meters(value, factor) for key, value in given.items()}
    if kind == "body":
        values["material"] = read_material(entry.material)
        values["part"] = tuple(entry.part)
    return values


def _meters(value: Any, factor: Decimal) -> Any:
    """Bare numbers as lengths [m], lists as tuples."""
    if isinstance(value, Decimal):
        return float(value * factor) + 0.0
    if isinstance(value, list):
        return tuple(_meters(entry, factor) for entry in value)
    return {key: _meters(entry, factor) for key, entry in value.items()} if isinstance(value, dict) else value


def _merge_text(text: str, fresh: str) -> str | None:
    """Merge new values into the old text; None if its form is too unusual."""
    new = _side(fresh)
    old = _side(text, RobotReader(Path("robot.toml"), fresh).table.length_unit)
    counts = {kind: len(old.means[kind]) for kind in _ORDER}
    if any(counts[kind] != len(old.blocks_of(kind)) for kind in _ORDER) or not all(b.whole for b in old.blocks):
        return None
    blocks: list[tuple[TomlBlock, int] | None] = [None] * len(old.blocks)
    added: list[tuple[str, int]] = []
    for kind in _ORDER:
        places, wanted = old.blocks_of(kind), new.blocks_of(kind)
        pairs = match_entries(old.means[kind], new.means[kind])  # old number by new number
        slots = sorted(places[before] for before in pairs.values())
        for slot, number in zip(slots, sorted(pairs), strict=True):
            before = old.blocks[places[pairs[number]]]
            own = _update_table(before, old, new, kind, pairs[number], number)
            blocks[slot] = (replace(before, text=own), number)
        added += [(kind, number) for number in range(len(wanted)) if number not in pairs]
    laid = _kept_blocks(old.blocks, blocks)
    for kind, number in added:
        block = TomlBlock(name=kind, free="\n", text=new.blocks[new.blocks_of(kind)[number]].text)
        laid.insert(_place(laid, kind, number), (block, number))
    tail = "".join(_remarks(block.free) for block, kept in zip(old.blocks, blocks, strict=True) if kept is None)
    whole = "".join(block.free + block.lead + block.text for block, _ in laid)
    return whole + tail + old.tail


def _kept_blocks(
    before: Sequence[TomlBlock], blocks: Sequence[tuple[TomlBlock, int] | None]
) -> list[tuple[TomlBlock, int]]:
    """Blocks that stay; comments above the first of a kind apply to all and stay with the next one."""
    laid: list[tuple[TomlBlock, int]] = []
    seen: set[str] = set()
    inherited: dict[str, str] = {}
    for old, kept in zip(before, blocks, strict=True):
        first = old.name not in seen
        seen.add(old.name)
        if kept is None:
            if first and any(entry is not None and entry[0].name == old.name for entry in blocks):
                inherited[old.name] = old.lead
            continue
        block, number = kept
        # free text and what is said of all belong to the place in the file, not to the table that is there now
        laid.append((replace(block, free=old.free, lead=inherited.pop(old.name, "") + block.lead), number))
    return laid


def _remarks(free: str) -> str:
    """Comments that stood apart before a table that is gone."""
    return free if "#" in free else ""


def _place(laid: Sequence[tuple[TomlBlock, int]], kind: str, number: int) -> int:
    """Find the place of a new table: after the one before it, else before the one after it, else in its order."""
    before = [place for place, (block, other) in enumerate(laid) if block.name == kind and other < number]
    if before:
        return before[-1] + 1
    after = [place for place, (block, _) in enumerate(laid) if block.name == kind]
    if after:
        return after[0]
    earlier = _ORDER[: _ORDER.index(kind)]
    return max(place for place, (block, _) in enumerate(laid) if block.name in earlier) + 1


def _update_table(block: TomlBlock, old: _Side, new: _Side, kind: str, before: int, number: int) -> str:
    """Update the text of a table with new values."""
    was, now = old.means[kind][before], new.means[kind][number]
    changed = [key for key in dict.fromkeys([*was, *now]) if was.get(key) != now.get(key)]
    if not changed:
        return block.text
    import tomlkit

    document = tomlkit.parse(block.text)
    source = tomlkit.parse(new.blocks[new.blocks_of(kind)[number]].text)
    table, fresh = (_entry(found, kind) for found in (document, source))
    for key in changed:
        if key not in fresh:
            table.pop(key, None)
        elif key == "targets":
            _update_targets(table["targets"], fresh["targets"], was["targets"], now["targets"])
        elif key == "points" and key in table:
            _update_points(table[key], fresh[key], was[key], now[key])
        else:
            _set(table, key, fresh[key])
    return tomlkit.dumps(document)


def _entry(document: Any, kind: str) -> Any:
    if not kind:
        return document
    return document[kind] if kind in _SINGLE else document[kind][0]


def _set(table: Any, key: str, item: Any) -> None:
    """Give a key a value; a sub-table in its place is removed first, so that it is not mistaken for that."""
    from tomlkit.items import Table

    if isinstance(table.get(key), Table):
        table.pop(key)
    table[key] = deepcopy(item)


def _update_targets(targets: Any, fresh: Any, was: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Only the targets that changed."""
    for name in was:
        if name not in now:
            targets.pop(name)
    for name in now:
        if was.get(name) != now[name]:
            targets[name] = deepcopy(fresh[name])


def _update_points(points: Any, fresh: Any, was: Sequence[Any], now: Sequence[Any]) -> None:
    """Update only the points that changed, so that comments next to the others stay."""
    start = 0
    while start < min(len(was), len(now)) and was[start] == now[start]:
        start += 1
    end = 0
    while end < min(len(was), len(now)) - start and was[-1 - end] == now[-1 - end]:
        end += 1
    old, new = len(was) - end - start, len(now) - end - start
    for place in range(start, start + min(old, new)):
        if was[place] != now[place]:
            points[place] = deepcopy(fresh[place])
    for _ in range(old - new):
        points.pop(start + new)
    for place in range(start + old, start + new):
        points.insert(place, deepcopy(fresh[place]))


def match_entries(old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]]) -> dict[int, int]:
    """Return the index of the old entry of each new one: by name, else an equal one, else the most similar one."""
    pairs: dict[int, int] = {}
    for likeness in (_same_name, _same, _alike):
        ranked = sorted(_rank_pairs(old, new, pairs, likeness))
        for _, _, after, before in ranked:
            if after not in pairs and before not in pairs.values():
                pairs[after] = before
    return pairs


def _rank_pairs(
    old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]], pairs: Mapping[int, int], likeness: Any
) -> Iterator[tuple[float, int, int, int]]:
    """Pairs that may belong together, the most likely and then the nearest in order first."""
    taken = set(pairs.values())
    for after, entry in enumerate(new):
        for before, other in enumerate(old):
            if after not in pairs and before not in taken:
                share = likeness(other, entry)
                if share > 0:
                    yield -share, abs(after - before), after, before


def _same_name(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    return float(bool(new.get("name")) and old["name"] == new["name"])


def _same(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    return float(old == new)


def _alike(old: Mapping[str, Any], new: Mapping[str, Any]) -> float:
    """Share of equal values of two entries; positions weigh most, as many entries share other values."""
    both = [key for key in new if new[key] is not None and old.get(key) is not None]
    places = [key for key in both if key in ("at", "box", "points", "targets")]
    if not places:
        return 0.0 if ("at" in new or "box" in new) else 1.0
    common = [_overlap(old[key], new[key]) for key in places]
    others = [key for key in new if key not in places]
    equal = sum(old.get(key) == new[key] for key in others) / max(len(others), 1)
    return sum(common) / len(common) + 0.1 * equal


def _overlap(old: Any, new: Any) -> float:
    """Share of the numbers or points of two values that are the same."""
    if isinstance(new, Mapping):
        return sum(old.get(key) == value for key, value in new.items()) / max(len(old), len(new), 1)
    if old == new:
        return 1.0
    return sum(entry in old for entry in new) / max(len(old), len(new), 1)
