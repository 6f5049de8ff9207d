"""`find_line`: where a key of robot.toml stands, for errors."""

import re

_HEADER = re.compile(r"\s*\[\[?\s*([A-Za-z_][\w.]*)\s*\]")
_KEY = re.compile(r"(\w+)(?:\[(\d+)\])?(?:\.(\w+))?(?:\[\d+\])*(?:\.(\w+))?(?:\[(\d+)\])?")


def find_line(text: str, key: str) -> int | None:
    """Line of a key such as cable[1].points[0], as near as headers and names of keys tell; None if it stands nowhere.

    A key that is missing from its table stands at the table's header.
    """
    match = _KEY.match(key)
    if not match:
        return None
    table, index, entry, inner = match[1], int(match[2] or 0), match[3], match[4]
    lines = text.split("\n")
    headers = [(number, found[1]) for number, line in enumerate(lines) if (found := _HEADER.match(line))]
    starts = [number for number, name in headers if name == table]
    if len(starts) <= index:
        top = range(headers[0][0] if headers else len(lines))
        return _find(lines, top, rf"{table}\s*\.\s*{entry}") or _find(lines, top, table)
    start = starts[index]
    later = (number for number, name in headers if number > start and not name.startswith(f"{table}."))
    block = range(start + 1, next(later, len(lines)))
    inside = [(number, name) for number, name in headers if number in block]
    own = range(start + 1, inside[0][0] if inside else block.stop)
    deep = [number for number, name in inside if name == f"{table}.{entry}.{inner}"]
    if deep:
        return deep[min(int(match[5] or 0), len(deep) - 1)] + 1
    line = _find(lines, own, rf"{entry}(?:\s*\.\s*{inner})?") if entry else None
    for number, name in inside:
        if line is None and name == f"{table}.{entry}":
            line = _find(lines, range(number + 1, block.stop), str(inner)) or number + 1
    return line or start + 1


def _find(lines: list[str], places: range, key: str) -> int | None:
    pattern = re.compile(rf"""\s*["']?{key}["']?\s*[=.]""")
    return next((number + 1 for number in places if pattern.match(lines[number])), None)
