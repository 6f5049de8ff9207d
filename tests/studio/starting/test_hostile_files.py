"""Broken, huge and tricky files: each ends in one line, within seconds, in little memory, and nothing is changed."""

import io
import struct
import threading
import time
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.starting.draft import MAX_BYTES, new_draft, safe_name
from hydrostat.studio.starting.sketch import make_sketch
from hydrostat.studio.starting.starter import Starter

SECONDS, MEGABYTES = 20.0, 600
"""What a file may take on a machine that is busy with other work; all but a few take well under a second."""

NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
SVG = f'<svg {NAMES} width="50mm" height="50mm" viewBox="0 0 50 50">%s</svg>'


class Silent:
    """A report that nobody reads."""

    def progress(self, stage: str, done: int, total: int) -> None: ...

    def part(self, value: object) -> None: ...

    def finish(self) -> None: ...


def binary_stl(count: int, triangles: np.ndarray) -> bytes:
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    records["v"] = triangles
    return b"\0" * 80 + struct.pack("<I", count) + records.tobytes()


def png(width: int, height: int, data: bytes) -> bytes:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def threemf(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def entity_bomb() -> str:
    lines = ['<!ENTITY a "aaaaaaaaaa">']
    lines += [f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)]
    return f"<!DOCTYPE svg [{''.join(lines)}]>" + SVG % "<text>&i;</text>"


CORNERS = np.array([[[0, 0, 0], [9, 0, 0], [0, 9, 0]], [[0, 0, 0], [0, 9, 0], [0, 0, 9]]], dtype=float)
NAN = np.full((4, 3, 3), np.nan)

FILES: dict[str, bytes | Callable[[], bytes]] = {
    "truncated.stl": binary_stl(200, np.repeat(CORNERS, 50, axis=0)),
    "claims.stl": binary_stl(4_000_000_000, CORNERS),
    "nan.stl": binary_stl(4, NAN),
    "infinite.obj": b"v 0 0 0\nv inf 0 0\nv 0 1e400 0\nf 1 2 3\n",
    "flat.stl": binary_stl(2, CORNERS),
    "point.stl": binary_stl(2, np.zeros((2, 3, 3))),
    "zeros.stl": b"\0" * 10_000,
    "text.stl": b"solid x\nfacet normal 0 0 0\nouter loop\nvertex 1 2\n",
    "text.png": b"this is no picture",
    "bomb.png": png(40_000, 40_000, zlib.compress(b"\0" * 1000)),
    "deep.png": lambda: png(20_000, 20_000, zlib.compress(b"\0" * 100_000_000)),
    "cut.png": png(300, 300, zlib.compress(b"\0" * 90_300)[:20]),
    "blank.jpg": b"\xff\xd8\xff\xe0" + b"\0" * 50,
    "entities.svg": entity_bomb().encode(),
    "outside.svg": ('<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>' + SVG % "<text>&x;</text>").encode(),
    "linked.svg": (SVG % '<image xlink:href="http://127.0.0.1:9/x.png" width="50" height="50"/>').encode(),
    "script.svg": (SVG % "<script>alert(1)</script>").encode(),
    "empty_shape.svg": (SVG % '<path d="M 0 0 L 0 0 Z"/>').encode(),
    "nested.svg": (SVG % ("<g>" * 100_000)).encode(),
    "uses.svg": (SVG % '<g id="a"><use xlink:href="#a"/><use xlink:href="#a"/></g>').encode(),
    "nan.svg": (SVG % '<path d="M nan 0 L 1e999 0 L 5 5 Z"/>').encode(),
    "cut.dxf": b"  0\nSECTION\n  2\nENTITIES\n  0\nLWPOLYLINE\n 90\n1000000000\n 10\n",
    "binary.dxf": b"AutoCAD Binary DXF\r\n\x1a\0" + b"\xff" * 300,
    "counts.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n"
    b"property float y\nproperty float z\nelement face 99999999999\nproperty list uint int vertex_indices\nend_header\n"
    + b"\0"
    * 100,
    "negative.ply": b"ply\nformat ascii 1.0\nelement vertex -5\nproperty float x\nend_header\n",
    "indices.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\nf -9 -8 -7\n",
    "many.off": b"OFF\n2000000000 2000000000 0\n0 0 0\n",
    "bomb.3mf": lambda: threemf(
        {"[Content_Types].xml": b"<a/>", "3D/3dmodel.model": b"<model>" + b"<v/>" * 20_000_000 + b"</model>"}
    ),
    "climbs.3mf": threemf({"../../../tmp/evil.model": b"<model/>", "_rels/.rels": b"<Relationships/>"}),
    "no_zip.3mf": b"PK\x03\x04" + b"\xff" * 200,
    "random.3mf": np.random.default_rng(0).bytes(4000),
}
"""What stands in each file; large ones are made when they are asked for."""


def content(name: str) -> bytes:
    """What stands in a file."""
    found = FILES[name]
    return found if isinstance(found, bytes) else found()


@pytest.fixture(scope="module", autouse=True)
def _warm() -> None:
    """Libraries are loaded and compiled before anything is timed."""
    make_sketch(Silent(), new_draft("a.svg", (SVG % '<rect width="50" height="30"/>').encode()))


@pytest.mark.parametrize("name", FILES)
def test_a_wrong_file_ends_in_one_line(name: str) -> None:
    """Oracle: InputError of one line that begins with the file's name; time and memory as they are said above."""
    import resource

    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    with pytest.raises(InputError) as error:
        make_sketch(Silent(), new_draft(name, content(name)))
    text = str(error.value)
    assert "\n" not in text
    assert 10 < len(text) < 400
    assert time.process_time() - start < SECONDS
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024 < MEGABYTES


@pytest.mark.parametrize(
    "name",
    [
        "virus.exe",
        "",
        ".",
        "svg",
        "a.svg.exe",
        "a" * 5000,
        "\0",
        "../../etc/passwd",
        "a.iges",
        "a.svg\0.png.sh",
        "..",
        "/",
    ],
)
def test_a_wrong_ending_is_refused(name: str) -> None:
    """Oracle: InputError of one short line."""
    with pytest.raises(InputError) as error:
        new_draft(name, b"x")
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("../../etc/passwd.svg", "passwd.svg"),
        ("C:\\boot\\x.STL", "x.stl"),
        ("a\0b.svg", "a_b.svg"),
        ("x" * 5000 + ".png", "x" * 40 + ".png"),
        (".svg", "body.svg"),
        ("...svg", "body.svg"),
        ("robot.toml.svg", "robot_toml.svg"),
        ("a b\n<c>.dxf", "a_b_c.dxf"),
        ("Käfer.svg", "Käfer.svg"),
        ("\u202egvs.svg", "gvs.svg"),
    ],
)
def test_names_become_plain(name: str, safe: str) -> None:
    """Oracle: names written down by hand; each is a plain file name, and a robot can be called after it."""
    assert safe_name(name) == safe
    assert Path(safe).name == safe
    assert new_draft(name, b"x").file == safe


def test_too_large_and_empty_files_are_refused() -> None:
    """Oracle: InputError."""
    with pytest.raises(InputError, match="at most 190 MB"):
        new_draft("a.stl", bytes(MAX_BYTES + 1))
    with pytest.raises(InputError, match="empty"):
        new_draft("a.stl", b"")


@pytest.mark.slow
def test_the_session_stays_as_it_was(tmp_path: Path) -> None:
    """Oracle: the open robot, its undo and the files around it; then a good file still works."""
    bell = Bell()
    document, jobs = Document(bell), Jobs(bell)
    starter = Starter(document, jobs, tmp_path)
    document.open(Work(robot=gallery_robot("letter_e")))
    serial, robot = document.serial, document.robot
    rung = threading.Event()
    bell.listen(lambda topic: rung.set())

    def settle() -> None:
        while starter.is_meshing:
            assert rung.wait(60)
            rung.clear()

    try:
        for name in ("claims.stl",):
            starter.bring("../" + name, content(name))
            settle()
            assert starter.problem.startswith(name)
            assert starter.sketch is None
            with pytest.raises(InputError):
                starter.make()
        assert (document.serial, document.robot) == (serial, robot)
        assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
        starter.bring("good.svg", (SVG % '<rect width="50" height="30"/>').encode())
        settle()
        assert starter.problem == ""
        starter.make()
    finally:
        jobs.close()
    assert document.robot.name == "good"
