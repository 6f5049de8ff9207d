"""The code of a class. Oracles: the file it is kept in, and codes of earlier lessons."""

import os
import time
from datetime import date
from pathlib import Path

import pytest

from hydrostat.errors import InputError
from hydrostat.studio.face.class_code import CODE_LIFETIME, LETTERS, find_code_date, forget_code, recall_code


def test_the_next_lesson_has_the_same_code(tmp_path: Path) -> None:
    state = tmp_path / "not" / "there"
    code = recall_code(state)
    assert len(code) == 8
    assert set(code) <= set(LETTERS)
    assert recall_code(state) == code
    assert recall_code(tmp_path / "other") != code
    assert recall_code(None) != code
    if os.name == "posix":
        assert (state / "class_code").stat().st_mode & 0o077 == 0, "other people on this computer cannot read it"


@pytest.mark.parametrize("damage", ["", "abc", "abcdefgO", "abcdefg\n", "é" * 8, "<script>"])
def test_a_damaged_code_is_replaced(tmp_path: Path, damage: str) -> None:
    (tmp_path / "class_code").write_text(damage, encoding="utf-8")
    (tmp_path / "class_code").chmod(0o600)
    code = recall_code(tmp_path)
    assert (len(code), code == damage) == (8, False)
    assert recall_code(tmp_path) == code


def test_an_old_code_is_replaced(tmp_path: Path) -> None:
    code, file = recall_code(tmp_path), tmp_path / "class_code"
    os.utime(file, times=(time.time() - 0.99 * CODE_LIFETIME,) * 2)
    assert recall_code(tmp_path) == code
    os.utime(file, times=(time.time() - 1.01 * CODE_LIFETIME,) * 2)
    assert recall_code(tmp_path) != code


def test_without_a_folder_there_is_a_code(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert len(recall_code(tmp_path / "file")) == 8


def test_a_folder_in_place_of_the_code_does_not_stop_the_class(tmp_path: Path) -> None:
    (tmp_path / "class_code").mkdir()
    assert len(recall_code(tmp_path)) == 8
    with pytest.raises(InputError, match=r"--new-code: .* cannot be removed"):
        forget_code(tmp_path)


@pytest.mark.skipif(os.name != "posix", reason="Windows has no bits of rights")
def test_no_other_person_can_read_the_code_at_any_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the rights of the unfinished file when it gets its name, with a umask that takes none away."""
    rights, replace = list[int](), os.replace

    def look(part: Path, path: Path) -> None:
        rights.append(part.stat().st_mode & 0o777)
        replace(part, path)

    monkeypatch.setattr("os.replace", look)
    before = os.umask(0)
    try:
        code = recall_code(tmp_path / "state")
    finally:
        os.umask(before)
    assert (rights, (tmp_path / "state").stat().st_mode & 0o777) == ([0o600], 0o700)
    (tmp_path / "state" / "class_code").chmod(0o640)
    assert recall_code(tmp_path / "state") != code, "others may have read it"
    assert (tmp_path / "state" / "class_code").stat().st_mode & 0o777 == 0o600


def test_a_code_has_a_day_and_can_be_forgotten(tmp_path: Path) -> None:
    assert find_code_date(tmp_path) is None
    code = recall_code(tmp_path)
    os.utime(tmp_path / "class_code", times=(time.time() - 3 * 24 * 3600,) * 2)
    assert find_code_date(tmp_path) == date.fromtimestamp(time.time() - 3 * 24 * 3600)
    forget_code(tmp_path)
    forget_code(tmp_path)
    assert recall_code(tmp_path) != code
