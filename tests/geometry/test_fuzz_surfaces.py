"""Files that are damaged in 324 ways: each gives a result or an error of one line, soon and in little memory."""

import resource
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from geometry.dirty import sphere
from geometry.surface_writers import archive, mesh_xml, model_xml, obj, off, ply_big, ply_text, stl, stl_text, threemf
from geometry.test_mesh_file import FORMATS, written

from hydrostat.errors import InputError
from hydrostat.geometry.files.mesh_file import read_labeled_mesh
from hydrostat.geometry.files.surface_file import read_surface, write_ply
from hydrostat.geometry.healing.heal import heal

_EACH = 17
_MOST_SECONDS = 10.0
_MOST_MEGABYTES = 400.0

_BALL = sphere(divisions=1)
_XML = model_xml(f'<object id="1">{mesh_xml(_BALL)}</object>', '<item objectid="1"/>')
_SURFACES = {
    "a.stl": stl(_BALL), "text.stl": stl_text(_BALL), "a.obj": obj(_BALL), "a.off": off(_BALL),
    "text.ply": ply_text(_BALL), "a.ply": write_ply(_BALL), "big.ply": ply_big(_BALL), "a.3mf": threemf(_BALL),
}  # fmt: skip

_NUMBERS = [b"nan", b"-1", b"4294967295", b"99999999999999999999", b"1e308", b"0", b"x", b""]
_BYTES = [b"\xff\xff\xff\x7f", b"\0\0\xc0\x7f", b"\xff" * 8, b"\0" * 8, b"\0\0\0\0\0\0\xf8\x7f", b"\0\x01"]


def _truncated(content: bytes, random: np.random.Generator) -> bytes:
    return content[: random.integers(len(content))]


def _flipped(content: bytes, random: np.random.Generator) -> bytes:
    spoiled = bytearray(content)
    for place in random.integers(len(content), size=random.integers(1, 9)):
        spoiled[place] ^= 1 << random.integers(8)
    return bytes(spoiled)


def _overwritten(content: bytes, random: np.random.Generator) -> bytes:
    """Bytes of counts that are huge, numbers that are none, or nothing."""
    new = _BYTES[random.integers(len(_BYTES))]
    place = random.integers(min(len(content), 300) if random.random() < 0.5 else len(content))
    return content[:place] + new + content[place + len(new) :]


def _renumbered(content: bytes, random: np.random.Generator) -> bytes:
    """One of the first or of all numbers in text is another: huge, negative, none."""
    import re

    numbers = list(re.finditer(rb"[-+0-9.]+", content))
    if not numbers:
        return content
    chosen = numbers[random.integers(min(len(numbers), 12) if random.random() < 0.6 else len(numbers))]
    return content[: chosen.start()] + _NUMBERS[random.integers(len(_NUMBERS))] + content[chosen.end() :]


def _shuffled(content: bytes, random: np.random.Generator) -> bytes:
    """A piece stands somewhere else, or twice."""
    one, two, three = np.sort(random.integers(len(content), size=3))
    piece = content[one:two]
    return content[: one if random.random() < 0.5 else two] + content[two:three] + piece + content[three:]


def _emptied(content: bytes, random: np.random.Generator) -> bytes:
    return [b"", b"\n \n", b"\0" * 200, content[:5]][random.integers(4)]


_WAYS = [_truncated, _flipped, _flipped, _overwritten, _renumbered, _renumbered, _shuffled, _emptied]


def _tried(read: Callable[[bytes], object], base: bytes, seed: int) -> int:
    """How many of the spoiled files could be read all the same; fails on any error but one of one line."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    good = 0
    for number in range(_EACH):
        random = np.random.default_rng([seed, number])
        content = _WAYS[number % len(_WAYS)](base, random)
        start, message = time.process_time(), ""
        try:
            read(content)
            good += 1
        except InputError as error:
            message = str(error)
        assert "\n" not in message
        assert len(message) < 400
        assert time.process_time() - start < _MOST_SECONDS
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert grown < _MOST_MEGABYTES
    return good


def _heal(content: bytes, name: str) -> None:
    surface = read_surface(content, name=name)
    healing = heal(surface, resolution=surface.size / 25)
    assert healing.volume_after > 0.0
    assert healing.lines()


@pytest.mark.slow
@pytest.mark.parametrize("name", _SURFACES)
def test_spoiled_surfaces(name: str) -> None:
    _heal(_SURFACES[name], name)
    _tried(lambda content: _heal(content, name), _SURFACES[name], sum(name.encode()))


def test_spoiled_xml_in_a_whole_archive() -> None:
    """What the checksums of an archive would catch does not hide what the XML would do."""

    def read(content: bytes) -> None:
        _heal(archive({"3D/3dmodel.model": content.decode("latin-1")}), "a.3mf")

    read(_XML.encode())
    _tried(read, _XML.encode(), 7)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("kind", FORMATS)
def test_spoiled_meshes(kind: str, tmp_path: Path) -> None:
    path = written(tmp_path, kind)

    def read(content: bytes) -> None:
        path.write_bytes(content)
        read_labeled_mesh(path)

    content = path.read_bytes()
    read(content)
    _tried(read, content, sum(kind.encode()))


def test_the_files_are_spoiled_indeed() -> None:
    """The check can fail: many of the spoiled files cannot be read, and a reader that raises anything else is told."""
    with pytest.raises(ZeroDivisionError):
        _tried(lambda content: 1 // 0, b"abc", 0)
    content = _SURFACES["a.stl"]
    assert _tried(lambda content: read_surface(content, name="a.stl"), content, 1) < _EACH - 4
