"""Eyes and mouths: holes through a body, or drawn on it. Oracles: areas and places of circles that are drawn."""

import re
from pathlib import Path

import numpy as np
import pytest
import shapely

from hydrostat.errors import InputError
from hydrostat.fabrication import plush_pattern
from hydrostat.fabrication.patterns.shape import Layer, PatternPart
from hydrostat.geometry import Inner, read_drawing
from hydrostat.ik import new_robot
from hydrostat.robot import Cable, Robot, Winch, load_robot, save_robot, scaled_robot

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">'
BODY = '<ellipse cx="100" cy="50" rx="90" ry="40"/>'
EYE = '<circle cx="40" cy="40" r="6" fill="black"/>'
PUPIL = '<circle cx="40" cy="40" r="2"/>'
MOUTH = '<path d="M20,60 Q40,70 60,62" fill="none" stroke="black"/>'
TOUCHING = '<circle cx="188" cy="50" r="8" fill="none" stroke="black"/>'


def drawing(*parts: str) -> bytes:
    return (HEAD + "".join(parts) + "</svg>").encode()


def test_a_closed_shape_is_a_hole_and_that_is_told() -> None:
    found = read_drawing(drawing(BODY, EYE, MOUTH), name="a.svg")
    assert len(found.outline.rings) == 2
    assert found.marks == ()
    left, hole = found.notes
    assert left.startswith("left out 1 open line")
    assert hole.startswith("1 closed shape is a hole through the body (12 mm across at (-60, 10) mm); for shapes drawn")
    assert "--inner drawn" in hole


def test_drawn_it_is_kept_and_no_hole() -> None:
    """Even with what a hole could not have in it, and what crosses the edge."""
    content = drawing(BODY, EYE, PUPIL, MOUTH, TOUCHING)
    found = read_drawing(content, name="a.svg", inner=Inner.DRAWN)
    assert found.outline.area == pytest.approx(np.pi * 0.09 * 0.04, rel=1e-3)
    assert found.notes == ("4 lines drawn on the body, not cut",)
    lengths = sorted(1e3 * np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in found.marks)
    assert lengths[0] == pytest.approx(2 * np.pi * 2, rel=1e-3)
    assert lengths[-1] < 2 * np.pi * 8  # what crosses the edge is cut there
    body = found.outline.polygon.buffer(1e-9)
    assert all(body.covers(shapely.LineString(line)) for line in found.marks)
    beside = read_drawing(drawing(BODY, '<circle cx="195" cy="5" r="3"/>'), name="a.svg", inner=Inner.DRAWN)
    assert beside.notes == ("left out 1 closed shape beside the body, the largest at (198, 5)",)


def test_it_is_kept_in_the_file_and_printed_on_the_front(tmp_path: Path) -> None:
    (tmp_path / "fish.svg").write_bytes(drawing(BODY, EYE, MOUTH))
    robot = new_robot(tmp_path / "fish.svg", inner="drawn")
    save_robot(robot, tmp_path / "fish")
    assert 'inner = "drawn"' in (tmp_path / "fish" / "robot.toml").read_text()
    again = load_robot(tmp_path / "fish")
    assert again == robot
    for one, other in zip(again.body.marks, robot.body.marks, strict=True):
        np.testing.assert_array_equal(one, other)
    pattern = plush_pattern(robot)
    drawn = {panel.name: [s for s in panel.shapes if s.part is PatternPart.DECORATION] for panel in pattern.panels}
    assert {name: len(shapes) for name, shapes in drawn.items() if shapes} == {"front": 2}
    eye = max(drawn["front"], key=lambda line: line.closed)
    front = pattern.panel("front")
    np.testing.assert_allclose(np.mean(eye.points, axis=0), front.on_sheet((-0.06, 0.01)), atol=0.05)
    large = scaled_robot(robot, 2.0)
    np.testing.assert_allclose(large.body.marks[0], 2 * robot.body.marks[0], atol=1e-9)


@pytest.fixture
def fish(tmp_path: Path) -> Robot:
    (tmp_path / "fish.svg").write_bytes(drawing(BODY, EYE))
    return new_robot(tmp_path / "fish.svg", inner="drawn")


@pytest.mark.parametrize(
    ("route", "told"),
    [
        (((0.0, -0.02), (-0.03, 0.01), (-0.06, 0.01)), r"C1 \(hole 3 and its stopper, at x -60, y 10 mm\)\. Move"),
        (((-0.04, 0.01), (-0.075, 0.01), (-0.075, -0.01)), r"C1 \(a run outside, at x -\d+, y 10 mm\)\. Move"),
        (((0.0, -0.02), (-0.03, -0.02), (-0.06, -0.02)), ""),
    ],
)
def test_a_cable_through_an_eye_is_warned_of(fish: Robot, route: tuple[tuple[float, float], ...], told: str) -> None:
    """Oracle: the eye of 6 mm about [-60, 10]; of three holes the first leads out, the second in."""
    robot = fish.with_network([Winch(name="pull", at=route[0])], [Cable(winch="pull", points=route)])
    words = " ".join(f"{text}." for text in plush_pattern(robot).warnings if "drawn shapes" in text)
    assert re.search(told, words) if told else not words


def test_what_would_show_on_the_toy_is_a_layer_of_its_own(fish: Robot) -> None:
    """Oracle: the seam: what is engraved within it is the drawing, the opening and nothing else."""
    route = ((0.0, -0.02), (-0.03, -0.02), (-0.06, -0.02))
    robot = fish.with_network([Winch(name="pull", at=route[0])], [Cable(winch="pull", points=route)])
    for panel in plush_pattern(robot).panels[:2]:
        (seam,) = (shapely.Polygon(s.points) for s in panel.shapes if s.part is PatternPart.SEAM)
        inside = [s for s in panel.shapes if s.layer is Layer.MARK and seam.buffer(-0.5).intersects(s.geometry)]
        assert {shape.part for shape in inside} <= {PatternPart.DECORATION, PatternPart.OPENING, PatternPart.ZIPPER}
        letters = [shape.layer for shape in panel.shapes if shape.part is PatternPart.TEXT]
        assert {*letters} == {Layer.MARK, Layer.GUIDE}  # notches, and names


def test_it_follows_a_pose(tmp_path: Path) -> None:
    """Oracle: a body that is moved as a whole takes its eye along."""
    (tmp_path / "fish.svg").write_bytes(drawing(BODY, EYE))
    body = new_robot(tmp_path / "fish.svg", inner="drawn").body
    (anchors,) = body.mark_anchors
    np.testing.assert_allclose(
        anchors.positions(body.mesh.nodes + np.array([0.01, 0.02])), body.marks[0] + [0.01, 0.02], atol=1e-9
    )


def test_only_drawings_have_them(tmp_path: Path) -> None:
    (tmp_path / "fish.svg").write_bytes(drawing(BODY, EYE))
    with pytest.raises(InputError, match="inner must be one of holes, drawn"):
        new_robot(tmp_path / "fish.svg", inner="painted")
    save_robot(load_robot("gallery:fish_tail"), tmp_path / "tail")
    file = tmp_path / "tail" / "robot.toml"
    file.write_text(file.read_text().replace("[body]\n", '[body]\ninner = "drawn"\n'))
    with pytest.raises(InputError, match="is for bodies with an outline"):
        load_robot(tmp_path / "tail")
