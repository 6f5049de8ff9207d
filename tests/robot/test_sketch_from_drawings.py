"""Robots from drawings that are no SVG: saved and read again, with what was left out told by the command."""

import io
from math import cos, dist, pi, sin
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from hydrostat.errors import OutlineError
from hydrostat.geometry import Inner
from hydrostat.robot import Plane, find_mirror, find_risks, load_robot, save_robot, sketch_robot


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


@pytest.mark.parametrize(("thickness", "plane"), [(0.03, Plane.STRESS), (0.09, Plane.STRESS), (0.12, Plane.STRAIN)])
def test_a_body_at_most_twice_as_thick_as_wide_is_in_plane_stress(thickness: float, plane: Plane) -> None:
    """Oracle: the bar's own width of 50 mm."""
    robot = sketch_robot(bar_png(), file="bar.png", name="bar", size=0.2, thickness=thickness)
    assert robot.body.plane is plane


def test_picture_without_size() -> None:
    """Oracle: the message asks for it."""
    with pytest.raises(OutlineError, match=r"bar.png: a picture has no physical size: give the longest side"):
        sketch_robot(bar_png(), file="bar.png", name="bar")


def test_each_thin_arm_has_a_marker_at_its_own_tip() -> None:
    """Eight arms that taper to 3 mm, too thin for nodes inside: markers are within 12 mm of the tips as drawn."""
    turns = [(cos(pi * (k + 0.5) / 4), sin(pi * (k + 0.5) / 4)) for k in range(8)]
    profile = [(34.0, -9.5), (85.0, -5.0), (112.0, -1.5), (112.0, 1.5), (85.0, 5.0), (34.0, 9.5)]
    corners = " L ".join(f"{130 + r * x - w * y:.1f},{130 + r * y + w * x:.1f}" for x, y in turns for r, w in profile)
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="260mm" height="260mm" viewBox="0 0 260 260">'
    svg = f'{head}<path d="M {corners} Z"/></svg>'
    robot = sketch_robot(svg.encode(), file="octopus.svg", name="octopus")
    spots = np.array([marker.at for marker in robot.markers])
    away = np.linalg.norm(spots[:, None] - 0.112 * np.array(turns), axis=2)
    assert sorted(away.argmin(axis=1)) == list(range(8))
    assert away.min(axis=1).max() < 0.012


def test_the_first_pin_covers_no_face() -> None:
    """Eyes in the middle of an ellipse, where the pin would be. Oracle: distances of their centers from the pin."""
    eyes = "".join(f'<circle cx="{x}" cy="90" r="4"/>' for x in (140, 160))
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="200mm" viewBox="0 0 300 200">'
    svg = f'{page}<ellipse cx="150" cy="100" rx="140" ry="60"/>{eyes}</svg>'.encode()
    (pin,) = sketch_robot(svg, file="face.svg", name="face", inner=Inner.DRAWN).pins
    assert pin.at is not None
    assert min(dist(pin.at, (x, 0.010)) for x in (-0.010, 0.010)) >= pin.radius


def test_a_pin_that_gives_way_to_a_drawing_stays_on_the_mirror_line() -> None:
    """Oracle: the line x = 0 of an ellipse with a mouth in its middle, where the pin would be."""
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="200mm" viewBox="0 0 300 200">'
    svg = f'{page}<ellipse cx="150" cy="100" rx="140" ry="60"/><circle cx="150" cy="100" r="4"/></svg>'.encode()
    robot = sketch_robot(svg, file="face.svg", name="face", inner=Inner.DRAWN)
    (pin,) = robot.pins
    assert find_mirror(robot.body) == 0
    assert pin.at is not None
    assert pin.at[0] == 0
    assert abs(pin.at[1]) >= pin.radius + 0.004
