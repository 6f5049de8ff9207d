"""Pictures of a robot in space: the same calls as for flat bodies."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image
from plot.designs import grown, space_network, space_trace

from hydrostat import plot
from hydrostat.drawing import Color
from hydrostat.plot import activation_figures, robot_figures
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.report import report_text
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Winch

FIGURES = (
    "draw_rest", "draw_target", "draw_network", "draw_pose", "draw_reached", "draw_activation", "draw_candidates",
    "draw_trees", "draw_portrait",
)  # fmt: skip


TWICE = ("draw_pose", "draw_activation", "draw_portrait")
"""Figures that are drawn a second time: with cables and targets, with lines of muscles, without axes."""


@cache
def figure(kind: str) -> Figure:
    network, trace = space_network(), space_trace()
    activation, reached = trace.activations[0], network.ik_results[0]
    arguments = {
        "draw_target": (reached.target,),
        "draw_pose": (reached.pose,),
        "draw_reached": (reached,),
        "draw_activation": (activation,),
        "draw_candidates": (activation, trace.candidates[0]),
        "draw_trees": (trace.trees,),
        "draw_portrait": (reached.pose.nodes,),
    }
    room = next(room for room in (plot, robot_figures, activation_figures) if hasattr(room, kind))
    return getattr(room, kind)(network.robot, *arguments.get(kind, ()))


@pytest.mark.parametrize("kind", FIGURES)
@pytest.mark.slow
def test_png_and_svg_twice_the_same_with_all_words_inside(kind: str, tmp_path: Path) -> None:
    """Oracle: a second figure; and matplotlib's own measure of every text."""
    drawn = figure(kind)
    one = plot.save_png(drawn, tmp_path / "one.png", dpi=60)
    text = plot.inline_svg(drawn, name="it", label="a box")
    if kind in TWICE:
        other = figure.__wrapped__(kind)
        assert plot.save_png(other, tmp_path / "two.png", dpi=60).read_bytes() == one.read_bytes()
        assert plot.inline_svg(other, name="it", label="a box") == text
    with Image.open(one) as image:
        assert min(image.size) > 50
        assert len(image.convert("RGB").getcolors(1 << 20) or []) > 100
    root = ElementTree.fromstring(text)
    names = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(names) == len(set(names))
    assert any(element.tag.endswith("image") for element in root.iter())
    check_words(drawn)


@pytest.mark.slow
def test_all_words_lie_within_a_narrow_picture() -> None:
    """Oracle: matplotlib's own measure of every text."""
    network = space_network()
    check_words(plot.draw_reached(network.robot, network.ik_results[0], width=4.9))


def check_words(drawn: Figure) -> None:
    """Check that every text lies within the picture."""
    drawn.canvas.draw()  # pyright: ignore[reportAttributeAccessIssue]
    page = drawn.bbox
    for text in drawn.findobj(Text):
        if text.get_text() and text.get_visible():
            box = text.get_window_extent()
            assert box.x0 >= page.x0 - 1, text
            assert box.y0 >= page.y0 - 1, text
            assert box.x1 <= page.x1 + 1, text
            assert box.y1 <= page.y1 + 1, text


@pytest.mark.slow
def test_cables_wear_the_colors_of_their_tension() -> None:
    """Oracle: the tension scale; where the body covers a cable, the same color mixed with felt."""
    network = space_network()
    pose = network.ik_results[0].pose
    scale = TensionScale.of(pose.tensions)
    lines = figure("draw_pose").axes[0].lines
    colors = {to_hex(line.get_color()) for line in lines}  # pyright: ignore[reportArgumentType]
    for tension in pose.tensions:
        full = scale.color(float(tension))
        assert full in colors
        assert any(Color.mix(full, Color.FELT, share / 10000) in colors for share in range(2000, 7000, 25))


@pytest.mark.slow
def test_a_wire_in_front_is_drawn_over_one_behind() -> None:
    network = space_network()
    pose = network.ik_results[0].pose
    full = TensionScale.of(pose.tensions).color(float(pose.tensions[0]))
    lines = figure("draw_pose").axes[0].lines
    solid = [line.get_zorder() for line in lines if to_hex(line.get_color()) == full and len(line.get_xdata()) > 2]  # pyright: ignore
    rest = [line.get_zorder() for line in lines if to_hex(line.get_color()) != full and len(line.get_xdata()) > 40]  # pyright: ignore
    assert solid
    assert rest
    assert min(solid) > 3
    assert max(solid) > max(rest)


def test_a_sheath_inside_the_body_does_not_hide_its_cable() -> None:
    """Oracle: the sheathed cable runs inside all the way, so all of its pipe lies beneath all of its line."""
    from hydrostat.drawing import Color

    robot = space_network().robot
    lines = plot.draw_network(robot).axes[0].lines
    pipes = [line.get_zorder() for line in lines if line.get_linewidth() > 5.5 and len(line.get_xdata()) == 2]  # pyright: ignore
    cables = [line.get_zorder() for line in lines if len(line.get_xdata()) > 40 and line.get_color() != Color.LIGHT]  # pyright: ignore
    assert pipes
    assert max(pipes) < min(cables)


def test_two_views_to_one_scale_that_do_not_meet() -> None:
    """Oracle: 10 mm along x are 10 mm times the share of x in the view; the bodies' boxes are disjoint."""
    robot = space_network().robot
    nodes = robot.body.mesh.nodes
    sheet, panes = open_sheet(robot, [nodes])
    assert len(panes) == 2
    boxes = []
    for pane in panes:
        places = pane.places(nodes)
        assert (places.min(axis=0) > sheet.low).all()
        assert (places.max(axis=0) < sheet.high).all()
        boxes.append((places.min(axis=0), places.max(axis=0)))
    (low, high), (other_low, other_high) = boxes
    assert (high < other_low).any() or (other_high < low).any()
    step = panes[1].places(np.array([[0.0, 0, 0], [0.01, 0, 0]]))
    assert np.linalg.norm(step[1] - step[0]) == pytest.approx(10)


def test_one_view_where_there_are_no_rules() -> None:
    robot = space_network().robot
    assert len(open_sheet(robot, [robot.body.mesh.nodes], ruled=False)[1]) == 1


@pytest.mark.slow
def test_the_ghost_is_there_only_where_the_body_moved() -> None:
    """Oracle: the rest pose itself covers its ghost; a bent one leaves pixels of the ghost's fill."""
    from hydrostat.drawing import Color

    network = space_network()
    robot, pose = network.robot, network.ik_results[0].pose
    fill = tuple(int(Color.GHOST_FILL[start : start + 2], 16) for start in (1, 3, 5))
    counts = []
    for shown in (pose, replace(pose, nodes=robot.body.mesh.nodes)):
        drawn = plot.draw_pose(robot, shown)
        drawn.canvas.draw()  # pyright: ignore[reportAttributeAccessIssue]
        pixels = np.asarray(drawn.canvas.buffer_rgba())[..., :3]  # pyright: ignore[reportAttributeAccessIssue]
        counts.append(int((pixels == fill).all(axis=2).sum()))
    assert counts[0] > 200
    assert counts[1] < 0.02 * counts[0]


@pytest.mark.slow
def test_a_robot_without_cables_or_markers() -> None:
    bare = replace(space_network().robot.with_network((), ()), markers=(), poses={})
    assert plot.inline_svg(plot.draw_rest(bare), name="it", label="").endswith("</svg>")


@pytest.mark.slow
def test_winches_far_away_are_on_the_picture() -> None:
    robot = space_network().robot
    far = replace(robot, winches=(*robot.winches, Winch(name="far", at=(0.11, 0.03, 0.03))))
    drawn = plot.draw_network(far)
    assert "far" in {text.get_text() for text in drawn.axes[0].texts}


@pytest.mark.slow
def test_the_report_of_a_body_in_space() -> None:
    text = report_text(grown(space_network()))
    assert "tetrahedra" in text
    assert "How it grew" in text
    assert "<animate" not in text
    assert text.count("data:image/png;base64,") >= 10


@pytest.mark.slow
def test_a_page_holds_the_body_pixel_by_pixel() -> None:
    """Oracle: the image as it was rendered, once per view, in the order of the views."""
    import base64
    import io
    import re

    drawn = figure("draw_rest")
    rendered = [image.get_array() for image in drawn.axes[0].images]
    text = plot.inline_svg(drawn, name="it", label="")
    held = re.findall(r'"data:image/png;base64,\s*([^"]+)"', text)
    assert len(held) == len(rendered) == 2
    for code, image in zip(held, rendered, strict=True):
        with Image.open(io.BytesIO(base64.b64decode(code))) as picture:
            assert picture.size == (image.shape[1], image.shape[0])  # pyright: ignore[reportOptionalMemberAccess]
    assert all(image.get_interpolation() != "none" for image in drawn.axes[0].images)
