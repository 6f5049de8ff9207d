"""Robots from drawings that are no SVG: saved and read again, with what was left out told by the command."""

import io
from pathlib import Path

import pytest
from PIL import Image, ImageDraw

from hydrostat.errors import OutlineError
from hydrostat.robot import find_risks, load_robot, save_robot, sketch_robot


def bar_png() -> bytes:
    """A bar with round ends, 600 x 150 pixels."""
    image = Image.new("RGB", (700, 250), "white")
    ImageDraw.Draw(image).rounded_rectangle([50, 50, 649, 199], 75, fill="teal")
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return stream.getvalue()


def bar_dxf() -> bytes:
    """The same in millimeters, 200 x 50, of two lines and two arcs."""
    import ezdxf

    document = ezdxf.new(units=4)
    space = document.modelspace()
    space.add_line((25, 0), (175, 0))
    space.add_arc((175, 25), 25, -90, 90)
    space.add_line((25, 50), (175, 50))
    space.add_arc((25, 25), 25, 90, 270)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


@pytest.mark.parametrize(("content", "file", "size"), [(bar_png(), "bar.png", 0.2), (bar_dxf(), "bar.dxf", None)])
@pytest.mark.slow
def test_sketch(content: bytes, file: str, size: float | None, tmp_path: Path) -> None:
    """Oracle: the robot itself, saved and read again; the size that was asked for or that the file has."""
    robot = sketch_robot(content, file=file, name="bar", size=size)
    again = load_robot(save_robot(robot, tmp_path))
    assert again == robot
    assert (tmp_path / file).read_bytes() == content
    assert find_risks(robot) == []
    assert robot.body.outline is not None
    assert robot.body.outline.size == pytest.approx(0.2, rel=1e-9)
    assert robot.body.outline.area == pytest.approx(0.15 * 0.05 + 3.14159 * 0.025**2, rel=5e-3)


def test_picture_without_size() -> None:
    """Oracle: the message asks for it."""
    with pytest.raises(OutlineError, match=r"bar.png: a picture has no physical size: give the longest side"):
        sketch_robot(bar_png(), file="bar.png", name="bar")
