"""The code of a class. Oracles: the file it is kept in, and codes of earlier lessons."""

import os
import time
from pathlib import Path

import pytest

from hydrostat.studio.face.class_code import KEPT, LETTERS, recall_code


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
    code = recall_code(tmp_path)
    assert (len(code), code == damage) == (8, False)
    assert recall_code(tmp_path) == code


def test_an_old_code_is_replaced(tmp_path: Path) -> None:
    code, file = recall_code(tmp_path), tmp_path / "class_code"
    os.utime(file, times=(time.time() - 0.99 * KEPT,) * 2)
    assert recall_code(tmp_path) == code
    os.utime(file, times=(time.time() - 1.01 * KEPT,) * 2)
    assert recall_code(tmp_path) != code


def test_without_a_folder_there_is_a_code(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert len(recall_code(tmp_path / "file")) == 8
