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
    image = Image.new("RGB", (200, 200), "white")
    ImageDraw.Draw(image).rectangle([40, 60, 160, 140], fill="black")
    image.save(tmp_path / "a.jpg")
    code, _, errors = run("new", tmp_path / "robot", "--from", tmp_path / "a.jpg")
    assert code == 2
    assert errors.count("\n") == 1
    assert "no physical size" in errors


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="60mm" viewBox="0 0 200 60">'
BAR = f'{SVG}<path d="M5 15H195V45H5Z"/></svg>'


@pytest.mark.slow
def test_the_example_of_a_cable_passes_the_check(run: Run, tmp_path: Path) -> None:
    """Oracle: `hydrostat check` of the robot file with the comment made to code."""
    (tmp_path / "bar.svg").write_text(BAR)
    run("new", tmp_path / "bar", "--from", tmp_path / "bar.svg")
    file = tmp_path / "bar" / "robot.toml"
    head, marked, rest = file.read_text().partition(" By hand:\n")
    example, empty, tail = rest.partition("\n\n")
    assert marked
    file.write_text(f"{head}{marked}{example.replace('# ', '').replace('#', '')}{empty}{tail}")
    code, out, _ = run("check", tmp_path / "bar")
    assert "1 winch, 1 cable" in out
    warned = [line for line in out.splitlines() if line.startswith("warning: ")]
    assert (code, out.splitlines()[-1]) == (0, "OK: 0 errors, 1 warning.")
    assert warned[0].startswith("warning: pose bend: target not reached"), "one cable of an example, no search"


def test_a_size_in_centimeters_is_named(run: Run, tmp_path: Path) -> None:
    """Oracle: 150 cm are 1.5 m."""
    (tmp_path / "bar.svg").write_text(BAR)
    out = run("new", tmp_path / "bar", "--from", tmp_path / "bar.svg", "--size", "150cm")[1]
    assert "note: the body is 1.5 m long. For a smaller one, give --size in mm" in out
    out = run("new", tmp_path / "small", "--from", tmp_path / "bar.svg", "--size", "150mm")[1]
    assert "note: the body is" not in out
    assert "warning: body: no room for the motor" in out  # its 20 mm are too thin
    made = ("--from", tmp_path / "bar.svg", "--size", "15mm", "--thickness", "0.2mm")
    out = run("new", tmp_path / "tiny", *made)[1]
    assert "warning: the body is 15 mm long, shorter than any motor. Give e.g. --size 150mm" in out
    assert "warning: the body is 0.2 mm thick, thinner than felt. Give e.g. --thickness 40mm" in out
