"""The page of a toy in a browser. Oracles: Python's answers to the same questions, and a search by other code."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.learning import Perceptrons
from hydrostat.plot import Attachments, FlatSkin
from hydrostat.robot import PinDrive, Robot, gallery_folder, load_robot
from hydrostat.simulation import Simulation
from hydrostat.toy import LearnedShape, learn_shape, sample_shapes, toy_page
from hydrostat.toy.toy_page import ToyPose

if TYPE_CHECKING:
    from playwright.sync_api import Page

Open = Callable[..., "Page"]
ROWS = [[0.0, 0.0, 0.0], [0.03, -0.01, 0.06], [0.011, 0.027, 0.004]]
"""Contractions at which answers are compared [m]."""


def _data(page_text: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="toy">(.*)</script>\n<script type="module">', page_text)
    assert found is not None
    assert "<" not in found[1]
    return json.loads(found[1])


def _first(data: dict[str, Any], kind: str) -> int:
    return next(first for name, first, _ in data["groups"] if name == kind)


def _wait(page: "Page", truth: str) -> None:
    """Wait until an expression is true; Playwright's own way to wait needs eval, which the page's policy forbids."""
    for _ in range(200):
        if page.evaluate(truth):
            return
        page.wait_for_timeout(50)
    pytest.fail(f"never true: {truth}")


def test_no_name_is_markup(page_text: str, starfish: Robot) -> None:
    data = _data(page_text)
    assert data["name"] == starfish.name
    assert data["poses"][0]["name"] == "</script><b>wave"
    assert page_text.count("<script") == 2
    assert len(page_text) < 1e6


def test_a_hostile_name_is_shown_and_not_run(page_text: str, starfish: Robot, open_page: Open) -> None:
    page = open_page(page_text)
    assert page.locator("h1").inner_text() == starfish.name
    assert page.locator("#poses button").first.inner_text() == "</script><b>wave"
    assert page.evaluate("window.hacked") is None
    page.evaluate("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.hacked=1\">')")
    page.wait_for_timeout(100)
    assert page.evaluate("window.hacked") is None  # the policy of the page, were markup ever to come in


def test_a_pose_without_finite_contractions_is_refused(starfish: Robot, shape: LearnedShape) -> None:
    for wrong in ((0.0, 0.0), (0.0, 0.0, np.nan)):
        with pytest.raises(InputError, match=r'pose "bent": contractions \[0, 0.*3 finite numbers'):
            toy_page(starfish, shape, poses=[ToyPose(name="bent", contractions=wrong)])
        with pytest.raises(InputError, match="keyframe at 2 s"):
            toy_page(starfish, shape, moves=[(2.0, np.array(wrong))])


def test_drives_have_knobs_in_their_units(starfish: Robot, open_page: Open) -> None:
    pins = tuple(replace(pin, drive="servo") for pin in starfish.pins)
    servo = PinDrive(name="servo", at=(0.0, 0.0), min=-0.5, max=0.5)
    robot = replace(starfish, pins=pins, drives=(servo,), poses={})
    shape = learn_shape(sample_shapes(robot, 20, jobs=1), Simulation(robot).rest.nodes, steps=50)
    text = toy_page(robot, shape, poses=[ToyPose(name="turned", contractions=(0.0, 0.0, 0.0, 0.25))])
    assert [knob["unit"] for knob in _data(text)["winches"]] == ["mm", "mm", "mm", "°"]
    page = open_page(text)
    assert page.locator("#knobs-title").inner_text() == "Winches and drives"
    page.locator(".knob input").nth(3).fill("20")
    assert page.locator(".knob output").all_inner_texts() == ["0.0 mm", "0.0 mm", "0.0 mm", "20.0 °"]
    taken, turned = page.evaluate("[toy.model.contractions(toy.shown().inputs), Array.from(toy.shown().points)]")
    assert taken[3] == pytest.approx(np.radians(20.0), abs=np.radians(0.1))
    skin = FlatSkin.of(robot.body).shape(shape.nodes(np.array(taken)))[0]
    assert np.abs(np.reshape(turned, (-1, 2))[: len(skin)] - skin).max() < 1e-4 * robot.body.mesh.size


def test_only_the_button_that_was_pressed_is_marked(starfish: Robot, shape: LearnedShape, open_page: Open) -> None:
    poses = [ToyPose(name="Rest", contractions=(0.02, 0.01, 0.0))] * 2
    page = open_page(toy_page(starfish, shape, poses=poses))
    page.locator("#poses button").nth(1).click()
    pressed = "[...document.querySelectorAll('#poses button')].map(each => each.getAttribute('aria-pressed'))"
    assert page.evaluate(pressed) == ["false", "true", "false", "false"]


def test_a_body_in_space_is_dots_where_webgl_is_missing(open_page: Open) -> None:
    robot = load_robot(gallery_folder("trunk"))
    nodes = robot.body.mesh.nodes
    still = LearnedShape(
        low=np.array([-each.release for each in robot.winches]),
        high=np.array([each.travel for each in robot.winches]),
        network=Perceptrons.of_layers([(np.zeros((1, len(robot.winches))), np.zeros(1))]),
        mean=nodes,
        basis=np.zeros((1, *nodes.shape)),
        samples=1,
        held_out=1,
        error=0.0,
        worst=0.0,
        moved=0.0,
        stopped=False,
    )
    off = "HTMLCanvasElement.prototype.getContext = (get => function (kind, ...more) {"
    off += " return kind === 'webgl' ? null : get.call(this, kind, ...more); })(HTMLCanvasElement.prototype.getContext)"
    page = open_page(toy_page(robot, still), off)
    page.wait_for_timeout(200)
    felt = """() => {
      const paper = document.getElementById("above");
      const bytes = paper.getContext("2d").getImageData(0, 0, paper.width, paper.height).data;
      let count = 0;
      for (let i = 0; i < bytes.length; i += 4) count += bytes[i] === 0xf0 && bytes[i + 2] === 0x9c;
      return count;
    }"""
    assert page.evaluate(felt) > 500  # pixels in the color of felt


def test_the_page_answers_as_python_does(page_text: str, starfish: Robot, shape: LearnedShape, open_page: Open) -> None:
    page, data = open_page(page_text), _data(page_text)
    got = page.evaluate("rows => rows.map(row => Array.from(toy.model.points(toy.model.scaled(row))))", ROWS)
    skin, attached = FlatSkin.of(starfish.body), Attachments(starfish)
    for row, points in zip(ROWS, got, strict=True):
        nodes, places = shape.nodes(np.array(row)), np.reshape(points, (-1, 2))
        expected = [("outline", skin.shape(nodes)[0]), ("cable", attached.cables(nodes)[0])]
        expected += [("winch", attached.winches(nodes)), ("marker", attached.markers(nodes))]
        for kind, wanted in expected:
            first = _first(data, kind)
            far = np.abs(places[first : first + len(wanted)] - wanted).max()
            assert far < 1e-4 * starfish.body.mesh.size, kind


def test_a_dragged_marker_goes_where_another_search_brings_it(
    page_text: str, starfish: Robot, shape: LearnedShape, open_page: Open
) -> None:
    page, data, size = open_page(page_text), _data(page_text), starfish.body.mesh.size
    marker = _first(data, "marker") + 1
    attached = Attachments(starfish)
    goal = attached.markers(shape.nodes(np.array([0.02, 0.01, 0.03])))[1]
    start = shape.scale_inputs(np.array([0.005, 0.005, 0.005]))
    ask = "([start, point, goal, size]) => toy.reach(toy.model, start, point, goal, {size, rounds: 60, still: 1e-6})"
    found = page.evaluate(ask, [start.tolist(), marker, goal.tolist(), size])
    place = page.evaluate(
        f"inputs => Array.from(toy.model.points(inputs)).slice({2 * marker}, {2 * marker + 2})", found
    )
    # the search of `LearnedModel`, on a network whose last layer is that of the marker
    wide = shape.network.sizes.tolist()
    moves = np.stack([attached.markers(shape.mean + each)[1] for each in shape.basis])
    middle = attached.markers(shape.mean)[1]
    moves = (moves - middle) / size
    numbers = shape.network.numbers[0].astype(float)
    body, linear = np.split(numbers, [len(numbers) - wide[0] * wide[-1]])
    head, last = np.split(body, [len(body) - (wide[-2] + 1) * wide[-1]])
    parts = [head, *(each.reshape(-1, wide[-1]) @ moves for each in (last, linear))]
    network = Perceptrons(
        sizes=np.array([*wide[:-1], 2]), numbers=np.concatenate([each.ravel() for each in parts])[None]
    )
    point, left = network.descend(start, (goal - middle) / size, np.ones(2))
    assert left < 1e-6
    assert np.linalg.norm(network.values(point)[0] * size + middle - place) < 1e-4 * size
    assert all(-1 <= value <= 1 for value in found)


def test_a_tip_follows_the_pointer_and_a_pose_plays(page_text: str, open_page: Open) -> None:
    page = open_page(page_text)
    marker = _first(_data(page_text), "marker") + 1
    see = f"points => toy.shown().sight.see(points, {2 * marker}).slice(0, 2)"
    x, y = page.evaluate(f"({see})(toy.shown().points)")
    to_x, to_y = page.evaluate(f"({see})(toy.model.points(toy.model.scaled([0.02, 0.005, 0.02])))")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(to_x, to_y, steps=4)
    _wait(page, f"(([x, y]) => Math.hypot(x - {to_x}, y - {to_y}))(({see})(toy.shown().points)) < 1")
    assert np.hypot(to_x - x, to_y - y) > 5
    page.mouse.up()
    shown = page.locator(".knob output").all_inner_texts()
    assert shown != ["0.0 mm"] * 3
    page.locator("#poses button").first.click()
    far = "Math.max(...[0.02, 0, 0.01].map((to, i) => Math.abs(to - toy.model.contractions(toy.shown().inputs)[i])))"
    _wait(page, f"{far} < 1e-9")


@pytest.mark.parametrize("far", [[1e9, -1e9], [0.0, 0.0]])
def test_no_drag_leaves_the_limits(page_text: str, open_page: Open, far: list[float]) -> None:
    page = open_page(page_text)
    inputs = page.evaluate(
        """far => {
          let inputs = toy.model.rest;
          for (let i = 0; i < 200; i++) {
            const goal = [far[0] * Math.sin(i), far[1] * Math.cos(i)];
            inputs = toy.reach(toy.model, inputs, i % 100, goal, {size: toy.data.size});
          }
          return inputs;
        }""",
        far,
    )
    assert all(-1 <= value <= 1 for value in inputs)
