"""`hydrostat new` from pictures."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image, ImageDraw

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_notes_are_printed(run: Run, tmp_path: Path) -> None:
    """Oracle: what is in the picture: a ring of line, and a speck."""
    image = Image.new("RGB", (400, 400), "white")
    draw = ImageDraw.Draw(image)
    draw.ellipse([50, 50, 350, 350], outline="black", width=6)
    draw.ellipse([380, 380, 388, 388], fill="black")
    image.save(tmp_path / "ring.png")
    code, out, _ = run("new", tmp_path / "robot", "--from", tmp_path / "ring.png", "--size", "150 mm")
    assert code == 0
    assert "drawing: a drawing of lines: filled to its outer line" in out
    assert re.search(
        r"drawing: left out 1 speck beside the body, the largest 4.5 mm across at \(9\d.\d, -9\d.\d\) mm", out
    )
    assert (tmp_path / "robot" / "ring.png").is_file()


def test_size_is_asked_for(run: Run, tmp_path: Path) -> None:
    """Oracle: exit code 2 and one line."""
    Image.new("RGB", (40, 40)).save(tmp_path / "a.jpg")
    code, _, errors = run("new", tmp_path / "robot", "--from", tmp_path / "a.jpg")
    assert code == 2
    assert errors.count("\n") == 1
    assert "no physical size" in errors
