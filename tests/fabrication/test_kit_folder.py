"""A kit as a folder: whole, and without leftovers."""

import hashlib
import json
from errno import ENOSPC
from pathlib import Path

import pytest

from hydrostat.errors import InputError
from hydrostat.fabrication.kit import write_files


def _files(**content: str) -> dict[str, bytes]:
    files = {f"parts/{name}.stl": text.encode() for name, text in content.items()}
    told = {path: {"sha256": hashlib.sha256(data).hexdigest()} for path, data in files.items()}
    return {**files, "manifest.json": json.dumps({"files": told}).encode()}


def _seen(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_all_files_are_written(tmp_path):
    paths = write_files(_files(spool="s", lid="l"), tmp_path / "kit")
    assert _seen(tmp_path / "kit") == ["manifest.json", "parts/lid.stl", "parts/spool.stl"]
    assert all(path.is_file() for path in paths)
    assert (tmp_path / "kit" / "parts" / "lid.stl").read_bytes() == b"l"


def test_what_an_earlier_kit_left_is_removed(tmp_path):
    write_files(_files(spool="s", lid="l"), tmp_path)
    write_files(_files(spool="t"), tmp_path)
    assert _seen(tmp_path) == ["manifest.json", "parts/spool.stl"]


def test_a_file_that_was_changed_since_stays(tmp_path):
    write_files(_files(spool="s", lid="l"), tmp_path)
    (tmp_path / "parts" / "lid.stl").write_bytes(b"mine")
    (tmp_path / "notes.txt").write_text("mine too")
    write_files(_files(spool="t"), tmp_path)
    assert _seen(tmp_path) == ["manifest.json", "notes.txt", "parts/lid.stl", "parts/spool.stl"]


def test_a_manifest_cannot_remove_what_lies_outside(tmp_path):
    outside = tmp_path / "precious.txt"
    outside.write_bytes(b"p")
    (tmp_path / "kit").mkdir()
    told = {"files": {"../precious.txt": {"sha256": hashlib.sha256(b"p").hexdigest()}}}
    (tmp_path / "kit" / "manifest.json").write_text(json.dumps(told))
    write_files(_files(spool="s"), tmp_path / "kit")
    assert outside.is_file()


@pytest.mark.parametrize("text", ["", "[]", '{"files": 3}', '{"files": {"a": 1}}', "\x00"])
def test_a_broken_manifest_removes_nothing(tmp_path, text):
    (tmp_path / "manifest.json").write_text(text)
    (tmp_path / "mine.txt").write_text("m")
    write_files(_files(spool="s"), tmp_path)
    assert "mine.txt" in _seen(tmp_path)


def test_a_file_in_the_way_is_said(tmp_path):
    (tmp_path / "parts").write_text("no folder")
    with pytest.raises(InputError, match="parts: cannot be written"):
        write_files(_files(spool="s"), tmp_path)


def test_a_full_disk_leaves_the_earlier_kit_or_no_folder(tmp_path, monkeypatch):
    """Oracle: the bytes that were there before."""
    write_files(_files(spool="s", lid="l"), tmp_path / "old")
    before = {name: (tmp_path / "old" / name).read_bytes() for name in _seen(tmp_path / "old")}
    write = Path.write_bytes

    def fail_on_the_last(path, content):
        if "manifest" in path.name:
            raise OSError(ENOSPC, "No space left on device")
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", fail_on_the_last)
    for folder in ("old", "new"):
        with pytest.raises(InputError, match=r"manifest.json: cannot be written \(No space left on device\)"):
            write_files(_files(spool="t"), tmp_path / folder)
    assert {name: (tmp_path / "old" / name).read_bytes() for name in _seen(tmp_path / "old")} == before
    assert not (tmp_path / "new").exists()
