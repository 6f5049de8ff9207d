"""Files beside robot.toml that load_robot refuses: drawings, meshes, folders. Oracle: the message."""

import os
from pathlib import Path

import meshio
import numpy as np
import pytest
from robot_files import GOOD, RECTANGLE, SVG, edit, load, refusal, robot_folder

from hydrostat.errors import InputError
from hydrostat.robot import load_robot


@pytest.mark.parametrize(
    ("shapes", "fragment"),
    [
        (
            '<path fill="none" stroke="red" d="M0,0 h60 v9 h-30"/>',
            "body.svg: the outline is open between (0, 0) and (30, 9)",
        ),
        ('<path d="M0,0 L60,40 V0 L0,40 Z"/>', "body.svg: the outline crosses itself at (30, 20)"),
        ("", "body.svg: no closed shape"),
    ],
)
def test_bad_drawing(tmp_path: Path, shapes: str, fragment: str) -> None:
    """Oracle: the drawing's own complaint, at the line of its key."""
    assert f"robot.toml, line 6: body.outline: {fragment}" in refusal(tmp_path, GOOD, svg=SVG.format(shapes))


@pytest.mark.parametrize(
    ("content", "fragment"),
    [
        (b"", "robot.toml: the file is empty; begin with format = 1, or run hydrostat new"),
        (b" \r\n\t", "robot.toml: the file is empty"),
        (b"\xef\xbb\xbf", "robot.toml: the file is empty"),
        (
            GOOD.replace("small", "sm\xe4ll").encode("latin-1"),
            "robot.toml, line 3: not UTF-8 text; save the file again",
        ),
        (GOOD.encode("utf-16"), "robot.toml, line 1: not UTF-8 text"),
        (GOOD.encode().replace(b"small", b"sm\x00all"), "robot.toml, line 3: not TOML: "),
        (np.random.default_rng(0).bytes(5_000_000), "robot.toml: the file has 5 MB, at most 1 MB are read"),
        (np.random.default_rng(0).bytes(900_000), "not UTF-8"),
        (b"[" * 900_000, "robot.toml"),
        (b"[a]\n" * 200_000, "robot.toml, line 2: not TOML: Cannot declare"),
        (b"a={" * 300_000, "robot.toml"),
        (b"x" * 900_000, "robot.toml: not TOML: Expected '='"),
        (b'x="' + b"1" * 900_000, "robot.toml: not TOML: Unterminated string"),
        (b"".join(b"k%d=1\n" % index for index in range(60_000)), 'line 1: k0: unknown key "k0"'),
    ],
    ids=range(14),
)
def test_not_a_robot(tmp_path: Path, content: bytes, fragment: str) -> None:
    """Oracle: one line that names the file; no traceback, hang or flood, whatever the bytes."""
    assert fragment in refusal(tmp_path, content)


@pytest.mark.parametrize("change", [lambda text: text.replace("\n", "\r\n"), lambda text: "\ufeff" + text])
def test_windows_files(tmp_path: Path, change) -> None:
    """Oracle: the same robot from the same text with CRLF or with a byte order mark, and the same lines in errors."""
    assert load(tmp_path / "there", change(GOOD)) == load(tmp_path / "here")
    bad = edit(GOOD, 'name = "tip"', 'name = "t/p"')
    assert refusal(tmp_path / "there", change(bad)) == refusal(tmp_path / "here", bad)


def test_paths(tmp_path: Path) -> None:
    """Oracle: a folder, its robot.toml under any name, and a text path all give the same robot."""
    folder = robot_folder(tmp_path / "small")
    other = folder / "other.toml"
    other.write_text(GOOD)
    assert load_robot(folder) == load_robot(folder / "robot.toml") == load_robot(str(other))


@pytest.mark.parametrize(
    ("name", "fragment"),
    [
        ("nowhere", "nowhere/robot.toml: there is no such file"),
        ("nowhere.toml", "nowhere.toml: there is no such file"),
        ("small/body.svg", "body.svg: is neither the folder of a robot nor a robot.toml"),
        ("small/robot.toml/on", "robot.toml/on/robot.toml: cannot be read (Not a directory)"),
        ("folder.toml", "folder.toml/robot.toml: is not a file"),
        ("pipe.toml", "pipe.toml: is not a file"),
        ("x" * 300, "cannot be read (File name too long)"),
        ("a\0b", "cannot be read (embedded null byte)"),
    ],
)
def test_no_such_robot(tmp_path: Path, name: str, fragment: str) -> None:
    """Oracle: the message names the path that was tried; a pipe is not waited for."""
    robot_folder(tmp_path / "small")
    (tmp_path / "folder.toml" / "robot.toml").mkdir(parents=True)
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(InputError) as caught:
        load_robot(tmp_path / name)
    assert fragment in str(caught.value)
    assert str(caught.value).isprintable()


BOX = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], dtype=float)
MESHED = """\
format = 1
name = "m"
[body]
mesh = "m.vtk"
material = "polyester fibre"
{}[[pin]]
at = [2, 2{}]
radius = 99
"""


@pytest.mark.parametrize(
    ("points", "cells", "text", "fragment"),
    [
        (
            BOX,
            [("tetra", [[0, 1, 2, 3]])],
            MESHED.format('thickness = "9 mm"\n', ", 2"),
            "line 6: body.thickness is only",
        ),
        (
            BOX,
            [("triangle", [[0, 1, 2]])],
            MESHED.format("", ""),
            "line 3: body.thickness is missing; a flat body needs one",
        ),
        (
            BOX,
            [("triangle", [[0, 1, 3]])],
            MESHED.format('thickness = "9 mm"\n', ""),
            "line 4: body.mesh: m.vtk: its tri",
        ),
        (BOX, [("line", [[0, 1]])], MESHED.format("", ""), "line 4: body.mesh: m.vtk: holds neither tetrahedra nor"),
        (
            BOX[:3] * 0,
            [("triangle", [[0, 1, 2]])],
            MESHED.format('thickness = "9 mm"\n', ""),
            "body.mesh: 1 mesh elements",
        ),
    ],
    ids=range(5),
)
def test_bad_mesh(tmp_path: Path, points: np.ndarray, cells: list, text: str, fragment: str) -> None:
    """Oracle: the mesh's own complaint, at the line of its key."""
    robot_folder(tmp_path)
    meshio.write(tmp_path / "m.vtk", meshio.Mesh(points, [(kind, np.array(rows)) for kind, rows in cells]))
    assert fragment in refusal(tmp_path, text)


@pytest.mark.parametrize("content", [b"", b"garbage", b"# vtk DataFile Version 4.2\nx\nASCII\n", RECTANGLE.encode()])
@pytest.mark.parametrize("ending", ["vtk", "vtu", "msh", "xyz"])
def test_garbage_mesh(tmp_path: Path, content: bytes, ending: str) -> None:
    """Oracle: one line at the mesh's key, whatever stands in the file."""
    robot_folder(tmp_path)
    (tmp_path / f"m.{ending}").write_bytes(content)
    assert "line 4: body.mesh: " in refusal(tmp_path, MESHED.format("", "").replace("m.vtk", f"m.{ending}"))
