"""Damage that keeps most of a file's structure: in text by lines, numbers, words and tags; in bytes; in archives."""

import hashlib
import json
import re
import struct
from collections.abc import Callable
from io import BytesIO
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile

import numpy as np

Spoil = Callable[[bytes, np.random.Generator], bytes]

NUMBERS = [
    b"nan", b"inf", b"-inf", b"-1", b"0", b"1e308", b"-1e308", b"1e-320", b"4294967295", b"99999999999999999999",
    b"9" * 400, b"1e9", b"-1e9", b"0x10", b"x", b"", b"1e", b"true", b"[]", b'"12"', b"12 kg",
]  # fmt: skip
WORDS = [
    b"", b'"', b"'", b"\0", b"\xff\xfe", b"\xef\xbb\xbf", "🐙".encode(), b"../../x", b"/dev/zero", b"a" * 5000,
    b"[" * 3000, b"\r", b"\t", b"{}", b"[[pin]]", b"<!--", b"&lt;", b"%s%n", b"1e5 mm", b"-5 deg", b"null",
]  # fmt: skip
BYTES = [b"\xff\xff\xff\x7f", b"\0\0\xc0\x7f", b"\xff" * 8, b"\0" * 8, b"\0\0\0\0\0\0\xf8\x7f", b"\0\1", b"\n", b" "]
_NUMBER = re.compile(rb"(?<![\w.])[-+]?[0-9]+(?:\.[0-9]*)?(?:[eE][-+]?[0-9]+)?")
_WORD = re.compile(rb"[A-Za-z_][\w-]*")
_QUOTED = re.compile(rb'"[^"\n]*"')
_TAG = re.compile(rb"<[^<>]*>")


def _pick(choices: list[bytes], draw: np.random.Generator) -> bytes:
    return choices[int(draw.integers(len(choices)))]


def _replaced(pattern: re.Pattern[bytes], choices: list[bytes], content: bytes, draw: np.random.Generator) -> bytes:
    found = list(pattern.finditer(content))
    if not found:
        return content + _pick(choices, draw)
    chosen = found[int(draw.integers(len(found)))]
    return content[: chosen.start()] + _pick(choices, draw) + content[chosen.end() :]


def change_number(content: bytes, draw: np.random.Generator) -> bytes:
    """Write another number in place of one."""
    return _replaced(_NUMBER, NUMBERS, content, draw)


def change_word(content: bytes, draw: np.random.Generator) -> bytes:
    """Write another word of the file, or none of it, in place of one."""
    words = [*WORDS, *_WORD.findall(content)[:200]]
    return _replaced(_WORD, words, content, draw)


def change_text(content: bytes, draw: np.random.Generator) -> bytes:
    """Write something else in place of a quoted text."""
    texts = [b'"' + word + b'"' for word in WORDS if b'"' not in word] + NUMBERS
    return _replaced(_QUOTED, texts, content, draw)


def move_lines(content: bytes, draw: np.random.Generator) -> bytes:
    """Leave a line out, write it twice, or exchange it with another."""
    lines = content.split(b"\n")
    one, two = draw.integers(len(lines), size=2).tolist()
    kind = int(draw.integers(4))
    if kind == 0:
        del lines[one]
    elif kind == 1:
        lines.insert(two, lines[one])
    elif kind == 2:
        lines[one], lines[two] = lines[two], lines[one]
    else:
        low, high = sorted((one, two))
        lines[low:high] = []
    return b"\n".join(lines)


def move_tags(content: bytes, draw: np.random.Generator) -> bytes:
    """Leave a tag out, write it twice, or put one into another."""
    tags = list(_TAG.finditer(content))
    if len(tags) < 2:
        return move_lines(content, draw)
    one, two = (tags[int(index)] for index in draw.integers(len(tags), size=2))
    kept = [b"", one[0] * 2, one[0] + two[0], two[0]]
    return content[: one.start()] + kept[int(draw.integers(len(kept)))] + content[one.end() :]


def cut(content: bytes, draw: np.random.Generator) -> bytes:
    """Keep the beginning, or leave bytes out in the middle."""
    low, high = sorted(draw.integers(len(content) + 1, size=2).tolist())
    return content[:low] if draw.random() < 0.5 else content[:low] + content[min(high, low + 40) :]


def change_bytes(content: bytes, draw: np.random.Generator) -> bytes:
    """Flip bits, or write bytes of huge and of no numbers, mostly near the beginning."""
    spoiled = bytearray(content)
    end = min(len(content), 200) if draw.random() < 0.5 else len(content)
    for _ in range(int(draw.integers(1, 6))):
        place = int(draw.integers(max(end, 1)))
        if draw.random() < 0.5 and place < len(spoiled):
            spoiled[place] ^= 1 << int(draw.integers(8))
        else:
            new = _pick(BYTES, draw)
            spoiled[place : place + len(new)] = new
    return bytes(spoiled)


TEXT: list[Spoil] = [change_number, change_number, change_word, change_text, move_lines, move_lines, move_tags, cut]
BINARY: list[Spoil] = [change_bytes, change_bytes, change_number, cut]


def spoil_text(content: bytes, draw: np.random.Generator) -> bytes:
    """Damage text in one way, or in two."""
    for _ in range(1 + int(draw.random() < 0.3)):
        content = TEXT[int(draw.integers(len(TEXT)))](content, draw)
    return content


def spoil_bytes(content: bytes, draw: np.random.Generator) -> bytes:
    """Damage bytes in one way."""
    return BINARY[int(draw.integers(len(BINARY)))](content, draw)


def spoil_archive(content: bytes, draw: np.random.Generator) -> bytes:
    """Damage a member of an archive, its name, or the archive itself."""
    if draw.random() < 0.25:
        return spoil_bytes(content, draw)
    try:
        with ZipFile(BytesIO(content)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
    except BadZipFile:
        return content
    names = sorted(members)
    name = names[int(draw.integers(len(names)))]
    kind = int(draw.integers(8))
    if kind == 0:
        del members[name]
    elif kind == 1:
        other = ["../" + name, "/" + name, name + "\0", "a/" * 6 + name, name.upper(), ""]
        members[other[int(draw.integers(len(other)))]] = members.pop(name)
    elif kind == 2:
        members[name] = members[names[int(draw.integers(len(names)))]]
    else:
        text = name.endswith((".toml", ".json", ".svg", ".xml", ".model", ".rels"))
        members[name] = (spoil_text if text else spoil_bytes)(members[name], draw)
    stream = BytesIO()
    with ZipFile(stream, "w", ZIP_DEFLATED) as archive:
        for each, data in members.items():
            archive.writestr(each or "x", data)
    return stream.getvalue()


def spoil_portable(content: bytes, draw: np.random.Generator) -> bytes:
    """Damage the header or the numbers of a portable file, mostly with a checksum that is right again."""
    if draw.random() < 0.2:
        return spoil_bytes(content, draw)
    length = struct.unpack("<Q", content[8:16])[0]
    header, rest = content[16 : 16 + length], content[16 + length : -32]
    if draw.random() < 0.7:
        header = _spoiled_json(header, draw) if draw.random() < 0.5 else spoil_text(header, draw)
    else:
        rest = change_bytes(rest, draw)
    body = content[:8] + struct.pack("<Q", len(header)) + header + rest
    return body + hashlib.sha256(body).digest()


def _spoiled_json(content: bytes, draw: np.random.Generator) -> bytes:
    """One value of a JSON text is another, of another kind."""
    found = json.loads(content)
    here = found
    while True:
        keys = list(here) if isinstance(here, dict) else list(range(len(here)))
        if not keys:
            return json.dumps(found).encode()
        key = keys[int(draw.integers(len(keys)))]
        if isinstance(here[key], dict | list) and here[key] and draw.random() < 0.8:
            here = here[key]
            continue
        others = [None, True, -1, 0, 10**30, 1e308, "", "x" * 3000, [], {}, [[]], float("nan"), [1, "a"]]
        here[key] = others[int(draw.integers(len(others)))]
        return json.dumps(found).encode()
