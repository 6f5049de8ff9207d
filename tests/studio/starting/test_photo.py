"""Photographs in Start. The oracle is the disc that was painted."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image, ImageDraw, ImageFilter

from hydrostat.errors import InputError
from hydrostat.geometry import Inner, read_outline
from hydrostat.robot import Robot
from hydrostat.studio.session import Session
from hydrostat.studio.starting.draft import BodyDraft, PhotoReading, new_draft
from hydrostat.studio.starting.photo import backdrop, cut_out, overlay
from hydrostat.studio.starting.sketch import Sketch, make_sketch

MIDDLE, RADIUS, WIDE, HIGH = (220.0, 160.0), 100.0, 480, 320
SIZE = 0.2


def photograph(*, shadow: bool = False) -> bytes:
    """A blue disc on grey paper, with a soft shadow on its lower right side."""
    image = Image.new("RGB", (WIDE, HIGH), (225, 225, 222))
    if shadow:
        dark = Image.new("L", (WIDE, HIGH), 0)
        ImageDraw.Draw(dark).ellipse((140, 80, 352, 285), fill=175)
        image.paste((70, 70, 72), mask=dark.filter(ImageFilter.GaussianBlur(6)))
    box = (*(value - RADIUS for value in MIDDLE), *(value + RADIUS for value in MIDDLE))
    ImageDraw.Draw(image).ellipse(box, fill=(30, 70, 190))
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()


def strayed(content: bytes) -> float:
    """How far the outline is from a circle about its middle, as a share of its radius."""
    ring = read_outline(content, name="p.png", size=SIZE).exterior
    middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    radii = np.linalg.norm(ring - middle, axis=1)
    return float(np.ptp(radii) / radii.mean())


def test_a_threshold_leaves_a_strong_shadow_out() -> None:
    content = photograph(shadow=True)
    loose, tight = (cut_out(content, PhotoReading(threshold=value)) for value in (40.0, 215.0))
    assert strayed(loose) > 0.05, "the shadow is in this one"
    assert strayed(tight) < 0.02


def test_smoothing_rounds_the_edge() -> None:
    image = Image.open(io.BytesIO(photograph()))
    draw = ImageDraw.Draw(image)
    for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False):
        x, y = np.array(MIDDLE) + RADIUS * np.array([np.cos(angle), np.sin(angle)])
        draw.ellipse((x - 3, y - 3, x + 3, y + 3), fill=(30, 70, 190))
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    bumpy, smooth = strayed(buffer.getvalue()), strayed(cut_out(buffer.getvalue(), PhotoReading(smoothing=10.0)))
    assert smooth < 0.5 * bumpy


def test_the_picture_lies_where_the_body_is() -> None:
    content = photograph()
    behind = backdrop(content, content, name="p.png", size=SIZE)
    scale = 1e3 * SIZE / (2 * RADIUS)
    assert behind.wide == pytest.approx(WIDE * scale, rel=0.01)
    assert behind.left == pytest.approx(-MIDDLE[0] * scale, abs=1.5 * scale)
    assert behind.top == pytest.approx(MIDDLE[1] * scale, abs=1.5 * scale)
    svg = overlay(behind, read_outline(content, name="p.png", size=SIZE))
    assert behind.address in svg
    assert svg.count("<path") == 2


@pytest.mark.parametrize(
    "wrong", [PhotoReading(threshold=1.0), PhotoReading(threshold=999.0), PhotoReading(smoothing=-1.0)]
)
def test_numbers_out_of_range_are_refused(wrong: PhotoReading) -> None:
    draft = new_draft("p.png", photograph())
    with pytest.raises(InputError, match=r"(threshold|smoothing): must be from"):
        replace(draft, reading=wrong)


class Quiet:
    def progress(self, stage: str, done: int, total: int) -> None:
        pass

    def part(self, value: object) -> None:
        pass

    def finish(self) -> None:
        pass


def sketch_of(draft: BodyDraft) -> Sketch:
    return make_sketch(Quiet(), draft)


def test_a_photograph_that_was_corrected_by_hand_becomes_the_robot() -> None:
    """Oracle: the corners that were drawn, and what was chosen before."""
    session = Session()
    starter, begun = session.starter, []
    session.jobs.start = lambda *arguments, **_: begun.append(arguments)  # type: ignore[method-assign]
    draft = replace(new_draft("fish.png", photograph(shadow=True)), reading=PhotoReading(threshold=215.0), name="fish")
    starter.draft, starter.sketch = draft, sketch_of(replace(draft, thickness=0.033))
    starter.draft = starter.sketch.draft
    assert starter.sketch.behind is not None
    assert starter.sketch.robot.body.file == "fish.png"
    starter.outline_correct()
    assert starter.outlining is not None
    assert starter.outlining.behind is starter.sketch.behind
    starter.outline_cancel()
    assert starter.sketch is not None, "going back loses nothing"
    starter.outline_correct()
    starter.outlining.take([[[-50, -30, False], [50, -30, False], [50, 30, False], [-50, 30, False]]])
    starter.outline_done()
    corrected = begun[-1][2]
    assert (corrected.name, corrected.thickness, corrected.file) == ("fish", 0.033, "fish.svg")
    robot: Robot = sketch_of(corrected).robot
    assert np.ptp(robot.body.mesh.nodes, axis=0) == pytest.approx([0.1, 0.06], rel=1e-3)
    session.close()


def test_shapes_within_a_drawing_are_holes_or_drawn_on_it() -> None:
    """Oracle: the outline of the body; words tell what to press, nothing of a command line."""
    page = b'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">%s</svg>'
    eye = new_draft("eye.svg", page % b'<rect width="100" height="60"/><circle cx="20" cy="20" r="6"/>')
    pierced = sketch_of(eye)
    assert pierced.robot.body.outline is not None
    assert len(pierced.robot.body.outline.holes) == 1
    assert any('choose "Surface lines"' in line and "--" not in line for line in pierced.lines)
    drawn = sketch_of(replace(eye, inner=Inner.DRAWN))
    assert drawn.robot.body.outline is not None
    assert len(drawn.robot.body.outline.holes) == 0
    assert len(drawn.robot.body.marks) == 1
