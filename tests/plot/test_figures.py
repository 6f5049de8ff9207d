import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from builders import box_robot, strip_robot
from matplotlib.figure import Figure
from PIL import Image
from plot.designs import FORMULA, SCRIPT, hostile_network, hostile_robot, hostile_trace

from hydrostat import plot
from hydrostat.errors import InputError
from hydrostat.geometry import Outline, triangulate
from hydrostat.ik import IKStatus
from hydrostat.plot import reached_title
from hydrostat.plot.activation_figures import draw_candidates, draw_trees
from hydrostat.plot.motion import motion_frames, motion_svg
from hydrostat.plot.robot_figures import draw_target
from hydrostat.plot.sheet import new_sheet
from hydrostat.plot.skin import FlatSkin
from hydrostat.robot import Mount, PoseTarget

FIGURES: dict[str, Callable[..., Figure]] = {
    draw.__name__: draw
    for draw in (
        plot.draw_rest,
        draw_target,
        plot.draw_network,
        plot.draw_pose,
        plot.draw_reached,
        plot.draw_activation,
        draw_candidates,
        draw_trees,
        plot.draw_portrait,
    )
}


def figure(kind: str) -> Figure:
    """A new picture of each kind, of the robot with hostile names."""
    network = hostile_network()
    trace = hostile_trace()
    robot, activation, reached = network.robot, trace.activations[0], network.ik_results[0]
    arguments = {
        "draw_rest": (),
        "draw_target": (reached.target,),
        "draw_network": (),
        "draw_pose": (reached.pose,),
        "draw_reached": (reached,),
        "draw_activation": (activation,),
        "draw_candidates": (activation, trace.candidates[0]),
        "draw_trees": (trace.trees,),
        "draw_portrait": (reached.pose.nodes,),
    }
    return FIGURES[kind](robot, *arguments[kind])


@pytest.mark.parametrize("kind", FIGURES)
def test_png(kind: str, tmp_path: Path) -> None:
    one = plot.save_png(figure(kind), tmp_path / "one.png", dpi=60)
    two = plot.save_png(figure(kind), tmp_path / "two.png", dpi=60)
    with Image.open(one) as image:
        assert image.format == "PNG"
        assert min(image.size) > 50
        assert len(image.convert("RGB").getcolors(1 << 20) or []) > 20
    assert one.read_bytes() == two.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.png", "two.png"]


@pytest.mark.parametrize("kind", FIGURES)
def test_svg(kind: str) -> None:
    text = plot.inline_svg(figure(kind), name="it", label=SCRIPT)
    assert text == plot.inline_svg(figure(kind), name="it", label=SCRIPT)
    root = ElementTree.fromstring(text)
    assert root.get("aria-label") == SCRIPT
    names = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(names) == len(set(names))
    assert "<script" not in text


def test_inner_references_differ_between_pictures() -> None:
    ids = [
        {
            element.get("id")
            for element in ElementTree.fromstring(plot.inline_svg(figure("draw_rest"), name=name, label="")).iter()
        }
        - {None}
        for name in ("one", "two")
    ]
    assert ids[0]
    assert not ids[0] & ids[1]


def test_names_are_shown_as_they_are() -> None:
    words = "".join(ElementTree.fromstring(plot.inline_svg(figure("draw_rest"), name="it", label="")).itertext())
    assert SCRIPT in words
    assert FORMULA in words


def test_quiet_colors_follow_the_page() -> None:
    text = plot.inline_svg(figure("draw_rest"), name="it", label="")
    assert "var(--ink, #" in text
    assert "var(--grid, #" in text


def test_a_robot_without_cables_or_markers() -> None:
    from dataclasses import replace

    bare = replace(strip_robot(columns=4, rows=2).with_network((), ()), markers=())
    assert plot.inline_svg(plot.draw_rest(bare), name="it", label="").endswith("</svg>")


def test_a_winch_in_the_world() -> None:
    figure = plot.draw_network(strip_robot(columns=4, rows=2, mount=Mount.WORLD))
    assert figure.axes[0].get_xlim()[0] < -50  # mm; it stands beyond the body


def test_skin_is_of_flat_bodies_only() -> None:
    with pytest.raises(InputError, match="space"):
        FlatSkin.of(box_robot().body)


def test_skin_follows_the_drawing_and_an_affine_motion() -> None:
    """Oracle: an affine map of the nodes maps the drawing itself, and evening out moves no straight line."""
    from dataclasses import replace

    angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    drawing = Outline(0.1 * np.column_stack([np.cos(angles), np.sin(angles)]))
    body = strip_robot().body
    body = replace(body, mesh=triangulate(drawing, 0.03), outline=drawing)
    shear = np.array([[1.2, 0.3], [0.0, 0.9]])
    skin = FlatSkin.of(body)
    ring = skin.shape(body.mesh.nodes)[0]
    np.testing.assert_allclose(np.linalg.norm(ring, axis=1), 0.1, atol=1e-4)
    np.testing.assert_allclose(skin.shape(body.mesh.nodes @ shear)[0], ring @ shear, atol=1e-12)


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import hydrostat, hydrostat.robot, hydrostat.simulation, hydrostat.design", "matplotlib"),
        ("import hydrostat", "hydrostat.plot"),
        ("import hydrostat.plot", "matplotlib.pyplot"),
    ],
)
@pytest.mark.slow
def test_imports_stay_light(statement: str, absent: str) -> None:
    code = f"{statement}\nimport sys\nsys.exit({absent!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_drawing_needs_no_pyplot_and_changes_no_settings() -> None:
    import matplotlib

    before = matplotlib.rcParams.copy()
    plot.inline_svg(figure("draw_reached"), name="it", label="")
    assert "matplotlib.pyplot" not in sys.modules
    assert matplotlib.rcParams.copy() == before


def test_every_public_name_exists() -> None:
    assert all(hasattr(plot, name) for name in plot.__all__)


def test_motion_begins_and_ends_at_rest() -> None:
    robot = hostile_robot()
    frames = motion_frames(robot, [np.array([0.005, 0.0])], steps=3)
    assert frames[0] is robot.body.mesh.nodes
    assert frames[-1] is robot.body.mesh.nodes
    root = ElementTree.fromstring(motion_svg(robot, frames, label=SCRIPT))
    values = [len(element.get("values", "").split(";")) for element in root.iter() if element.get("values")]
    assert set(values) == {len(frames)}


def test_what_is_drawn_on_a_body_moves_with_it() -> None:
    """Oracle: a line between two nodes is drawn between their places, in millimeters."""
    robot = hostile_robot()
    nodes = robot.body.mesh.nodes
    marked = replace(robot, body=replace(robot.body, marks=(nodes[[3, 7]],)))
    moved = nodes + np.array([0.01, 0.02])
    root = ElementTree.fromstring(motion_svg(marked, [nodes, moved], label=SCRIPT))
    wanted = [[1e3 * one[index] * [1, -1] for index in (3, 7)] for one in (nodes, moved)]
    shown = [
        np.array(re.findall(r"-?[\d.]+", value), dtype=float).reshape(-1, 2)
        for element in root.iter()
        for value in element.get("values", "").split(";")
        if element.get("attributeName") == "d" and len(re.findall(r"-?[\d.]+", value)) == 4
    ]
    assert all(any(np.allclose(one, two, atol=0.06) for one in shown) for two in wanted)


@pytest.mark.parametrize(
    ("status", "name", "title"),
    [
        (IKStatus.REACHED, None, "Reached: wave"),
        (IKStatus.LOCAL_OPTIMUM, None, "Closest to wave"),
        (IKStatus.LOCAL_OPTIMUM, "drawing", "Closest to drawing"),
    ],
)
def test_a_title_says_reached_where_the_target_is(status: IKStatus, name: str | None, title: str) -> None:
    found = hostile_network().ik_results[0]
    wave = PoseTarget(name="wave", targets={"tip": (0.1, 0.0)})
    assert reached_title(replace(found, status=status, target=wave), name) == title


def test_the_short_side_of_a_picture_may_hold_no_round_number() -> None:
    """Oracle: by hand: lines every 20 mm along 100 mm, and none between 3 and 4 mm."""
    sheet = new_sheet(np.array([[0.0, 3.0], [100.0, 4.0]]), room=0.0)
    numbers = [words.get_text() for words in sheet.axes.texts]
    assert numbers == ["0", "20", "40", "60", "80", "100", "mm"]
