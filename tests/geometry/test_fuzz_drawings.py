"""Files that were damaged on the way: every one gives an outline, or one line that says what is wrong, in time."""

import time
from functools import cache
from typing import Any

import numpy as np
import pytest
from drawings import canvas, disc, dxf, fish, mutants, picture, shape, star

from hydrostat.errors import InputError
from hydrostat.geometry.files.outline_file import read_outline
from hydrostat.geometry.outline import Outline


def _all_kinds(space: Any, document: Any) -> None:
    """A body of lines and arcs with holes of every kind of curve, a block, and words."""
    space.add_line((0, 0), (100, 0))
    space.add_arc((100, 30), 30, -90, 90)
    space.add_line((100, 60), (0, 60))
    space.add_lwpolyline([(0, 60, 0.3), (0, 0, 0)], format="xyb")
    space.add_circle((20, 20), 5)
    space.add_ellipse((60, 20), (12, 3), 0.4)
    space.add_spline([(80, 40, 0), (90, 45, 0), (85, 50, 0), (80, 40, 0)])
    document.blocks.new("part").add_circle((0, 0), 3)
    space.add_blockref("part", (20, 45), dxfattribs={"column_count": 3, "column_spacing": 10, "xscale": 1.2})
    space.add_text("word")


@cache
def _good(name: str) -> bytes:
    if name.endswith(".dxf"):
        return dxf(_all_kinds)
    small = canvas(fish, size=(600, 600)).resize((150, 150))
    if name == "colors.png":
        return picture(canvas(shape(star(), "red"), disc("white", 60), ground=(0, 0, 0, 0)).resize((150, 150)))
    return picture(small, "JPEG", quality=60) if name.endswith(".jpg") else picture(small)


def _fate(content: bytes, name: str) -> str:
    """What became of a file: the line it was refused with, empty if it gave an outline; never anything else."""
    begin = time.process_time()
    try:
        found = read_outline(content, name=name, size=0.1)
        assert isinstance(found, Outline)
        line = ""
    except InputError as error:
        line = str(error)
        assert line.startswith(f"{name}: ")
        assert "\n" not in line
        assert len(line) < 400
    assert time.process_time() - begin < 10.0
    return line


@pytest.mark.parametrize("name", ["lines.dxf", "fish.png", "colors.png", "fish.jpg"])
def test_damaged(name: str) -> None:
    """Oracle: an outline or an InputError of one line within 10 s, for 25 damaged files of each kind."""
    good = _good(name)
    assert _fate(good, name) == ""
    if name.endswith(".dxf"):
        # The drawing itself is a small part of the file: damage that, not the tables of layers and styles.
        start = good.index(b"ENTITIES")
        bad = [good[:start] + part for part in mutants(good[start:], 25, seed=4)]
    else:
        bad = list(mutants(good, 25, seed=4))
    fates = [_fate(content, name) for content in bad]
    assert sum(fate != "" for fate in fates) >= 8


NUMBERS = ["nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "999999999999", "-1", "0", "x", ""]


@pytest.mark.parametrize("number", NUMBERS)
def test_bad_numbers_in_dxf(number: str) -> None:
    """Oracle: as above, where numbers of the drawing are replaced: coordinates, radii, angles, counts, flags, knots."""
    random = np.random.default_rng(7)
    lines = _good("lines.dxf").replace(b"\r\n", b"\n").split(b"\n")
    start = lines.index(b"ENTITIES")
    end = start + lines[start:].index(b"ENDSEC")
    codes = [index for index in range(start + 1, end - 1, 2) if lines[index].strip().isdigit()]
    codes = [index for index in codes if 10 <= int(lines[index]) < 100]
    for _ in range(4):
        bad = list(lines)
        for index in random.choice(codes, 2):
            bad[index + 1] = number.encode()
        _fate(b"\n".join(bad), "lines.dxf")


@pytest.mark.parametrize("name", ["a.dxf", "a.png", "a.jpg", "a.jpeg", "a.svg"])
@pytest.mark.parametrize("content", [b"", b"\0", b"\0" * 5000, b"\xff\xd8\xff", b"0\nSECTION\n" * 2000 + b"0\nEOF\n"])
def test_no_content(name: str, content: bytes) -> None:
    """Oracle: refused in one line."""
    assert _fate(content, name) != ""
