"""SVG elements, and the camera and canvas that drawings are made with. Oracles: an XML reader, geometry."""

from xml.etree import ElementTree

import numpy as np
import pytest

from hydrostat.drawing.camera import Camera
from hydrostat.drawing.canvas import NAMESPACE, Canvas, CanvasFrame, number, path, safe, shape, tag

HARD = "<script>\"&'"


@pytest.mark.parametrize(
    ("value", "digits", "words"),
    [(-0.0004, 3, "0"), (10.0, 2, "10"), (0.105, 1, "0.1"), (-2.5, 3, "-2.5"), (1234567.25, 3, "1234567.25")],
)
def test_numbers_are_short_and_keep_their_value(value, digits, words):
    assert number(value, digits) == words
    assert float(words) == pytest.approx(value, abs=0.51 * 10**-digits)


@pytest.mark.parametrize("digits", [0, 1, 2, 3])
@pytest.mark.parametrize("value", [100.0, 0.0, -0.2, -30.0, 1050.0, 0.05, 7.25])
def test_a_number_is_the_same_alone_and_in_a_path(value: float, digits: int) -> None:
    """Oracle: the plain formatter of Python."""
    words = number(value, digits)
    assert float(words) == float(f"{value:.{digits}f}")
    assert path([[(value, value), (1.0, value)]], digits=digits) == f"M{words} {words}L1 {words}"


def test_what_a_user_writes_stays_text():
    """Oracle: an XML reader finds the very words again, in an attribute and as content."""
    read = ElementTree.fromstring(tag("g", HARD, shape("circle", id=HARD), font_size=2, class_=None))
    assert read.text == HARD
    assert read[0].attrib == {"id": HARD}
    assert read.attrib == {"font-size": "2"}
    assert safe([HARD, tag("b")]).endswith("<b></b>")


def test_paths_are_closed_or_not():
    lines = [[(0.0, 1.0), (2.25, -0.001)], np.array([[3.0, 4.0], [5.0, 6.0]])]
    assert path(lines, digits=2) == "M0 1L2.25 0M3 4L5 6"
    assert path(lines[:1], digits=1, closed=True) == "M0 1L2.2 0Z"


@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 0.0), (-45.0, 35.0), (130.0, -20.0)])
def test_a_camera_by_its_angles_is_one_by_its_direction(azimuth, elevation):
    turn, rise = np.radians([azimuth, elevation])
    eye = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    assert Camera.at(azimuth, elevation).axes == pytest.approx(Camera.towards(eye).axes, abs=1e-12)
    up = np.array([0.2, -0.5, 0.7])
    leaning = Camera.at(azimuth, elevation, up=up)
    assert leaning.axes @ leaning.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert leaning.sky == pytest.approx([0, np.cos(rise), np.sin(rise)], abs=1e-12)


def test_an_isometric_camera_shortens_all_axes_alike():
    lengths = np.linalg.norm(Camera.isometric().see(np.eye(3))[:, :2], axis=1)
    assert lengths == pytest.approx(np.full(3, np.sqrt(2 / 3)))


def test_a_canvas_shows_a_thing_in_its_room_the_right_way_up():
    frame = CanvasFrame.fit(np.array([[0.0, 0.0], [20.0, 10.0]]), (5.0, 5.0, 25.0, 45.0))
    assert frame.on((0.0, 10.0)) == pytest.approx((5.0, 20.0))
    assert frame.on((20.0, 0.0)) == pytest.approx((25.0, 30.0))
    canvas = Canvas(30.0, 50.0)
    canvas.box((5, 20, 25, 30), grey=0.5)
    canvas.text((10.0, 10.0), HARD, halo=True)
    picture = ElementTree.fromstring(canvas.svg)
    assert picture.attrib["viewBox"] == "0 0 30 50"
    assert picture[0].attrib == {"d": "M5 20L25 20L25 30L5 30Z", "fill": "#808080", "fill-rule": "evenodd"}
    assert picture.find(f"{{{NAMESPACE}}}text").text == HARD
