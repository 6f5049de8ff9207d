"""Oracles: the robot that was packed, and a folder into which nothing may be written."""

import io
import stat
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import gallery_folder, robot_text
from hydrostat.studio.session import Session
from hydrostat.studio.starting import starter
from hydrostat.studio.starting.starter import unpack_robot

TOML = (gallery_folder("starfish") / "robot.toml").read_bytes()


def packed(files: Mapping[str, bytes | zipfile.ZipInfo]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, told in files.items():
            archive.writestr(*((told, b"x") if isinstance(told, zipfile.ZipInfo) else (name, told)))
    return buffer.getvalue()


@pytest.mark.parametrize("name", ["starfish", "cupping_hand"])
def test_what_is_taken_home_comes_back(name: str) -> None:
    session = Session()
    robot = gallery_robot(name)
    session.document.open(Work(robot=replace(robot, name="mine")), saved=False)
    assert not session.document.is_saved
    home = session.take_home()
    assert session.document.is_saved
    session.starter.open_zip("mine.zip", home.content)
    assert robot_text(session.document.robot) == robot_text(replace(robot, name="mine"))
    assert session.document.robot.body.content == robot.body.content
    assert session.document.folder is None
    session.close()


LINK = zipfile.ZipInfo("robot/outline.svg")
LINK.external_attr = (stat.S_IFLNK | 0o777) << 16


@pytest.mark.parametrize(
    ("files", "why"),
    [
        ({"robot/robot.toml": TOML, "../../evil": b"x"}, "outside"),
        ({"robot/robot.toml": TOML, "/tmp/evil": b"x"}, "outside"),
        ({"robot/robot.toml": TOML, "..\\evil": b"x"}, "outside"),
        ({"robot/robot.toml": TOML, "C:evil": b"x"}, "outside"),
        ({"robot/robot.toml": TOML, "link": LINK}, "outside"),
        ({"a/b/c/d/robot.toml": TOML}, "outside"),
        ({"kit/sheet.html": b"x"}, "no robot.toml"),
        ({"a/robot.toml": TOML, "b/robot.toml": TOML}, "2 robots"),
        ({f"{k}.txt": b"x" for k in range(starter.MAX_FILES + 1)}, "201 files"),
        ({"robot/robot.toml": b"\xff"}, "robot"),
        ({"robot/robot.toml": TOML, "robot/studio.json": b"{"}, "studio.json"),
    ],
)
def test_what_is_refused(files: dict[str, bytes], why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=why):
        unpack_robot("x.zip", packed(files))
    assert not list(tmp_path.iterdir())


def test_a_bomb_is_refused_before_it_is_unpacked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(starter, "_write", lambda *_: pytest.fail("it was unpacked"))
    bomb = packed({"robot/robot.toml": TOML, "robot/outline.svg": bytes(starter.MAX_BYTES)})
    assert len(bomb) < 1_000_000
    with pytest.raises(InputError, match="200 MB unpacked, at most 200 MB are read"):
        unpack_robot("bomb.zip", bomb)


CUT = packed({"robot/robot.toml": TOML})[:30] + packed({"robot/robot.toml": TOML})[38:]  # its list lies before 0


@pytest.mark.parametrize("content", [b"", b"PK", b"no archive", packed({"robot/robot.toml": TOML})[:-40], CUT])
def test_what_is_no_archive_is_told(content: bytes) -> None:
    with pytest.raises(InputError, match="cannot be unpacked"):
        unpack_robot("x.zip", content)


def test_an_entry_that_lies_about_its_size_is_refused() -> None:
    """The sizes in both headers say 5 bytes; what follows is more."""
    whole = packed({"robot/robot.toml": TOML})
    size = len(TOML).to_bytes(4, "little")
    assert whole.count(size) == 2
    with pytest.raises(InputError, match=r"cannot be unpacked|larger than it says"):
        unpack_robot("x.zip", whole.replace(size, (5).to_bytes(4, "little")))


@pytest.mark.parametrize("way", [zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_bytes_that_cannot_be_unpacked_are_told(way: int) -> None:
    """Oracle: none of the errors of zlib, lzma and bz2 comes through; the sizes in the archive stay true."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", way) as archive:
        archive.writestr("robot.toml", TOML)
    whole = bytearray(buffer.getvalue())
    begin = 30 + len("robot.toml")
    whole[begin : begin + 40] = bytes([7]) * 40
    with pytest.raises(InputError, match=r'^"x.zip": cannot be unpacked'):
        unpack_robot("x.zip", bytes(whole))


def test_a_complaint_does_not_name_the_scratch_folder() -> None:
    with pytest.raises(InputError, match=r'^"x.zip": robot.toml, line 8: body.outline: file "starfish'):
        unpack_robot("x.zip", packed({"robot/robot.toml": TOML}))
