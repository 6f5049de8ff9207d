"""Small pictures and charts. Oracles: coordinates worked out by hand, XML that parses, fronts by their definition."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.design import BuildCost, DesignRequest
from hydrostat.fabrication import Demand
from hydrostat.robot import PoseTarget, Robot
from hydrostat.studio.designing.charts import BOTTOM, FRONT_HEIGHT, LEFT, Chart, front_chart, growth_chart, ticks
from hydrostat.studio.designing.design_work import Candidate
from hydrostat.studio.designing.run import DesignRun, ProgressPoint
from hydrostat.studio.designing.sketch import DURATION, EDGE, MARGIN, BodySketch, Ease


def parsed(svg: str) -> ElementTree.Element:
    return ElementTree.fromstring(svg)


def all_of(svg: str, name: str, kind: str) -> list[ElementTree.Element]:
    return [part for part in parsed(svg).iter(name) if part.get("class") == kind]


def test_a_sketch_has_the_body_and_each_cable_where_it_runs() -> None:
    """A strip of 200 x 50 mm: its longest side fills the picture, y points down."""
    robot = strip_robot(columns=10, rows=3)
    svg = BodySketch(robot.body).network(robot)
    cables = all_of(svg, "path", "sketch-cable")
    assert len(cables) == len(robot.cables)
    nodes = robot.body.mesh.nodes
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    scale = (EDGE - 2 * MARGIN) / (high - low).max()
    expected = scale * (np.array(robot.cables[0].points) - low) + MARGIN
    expected[:, 1] = scale * (high - low)[1] + 2 * MARGIN - expected[:, 1]
    drawn = [tuple(map(float, pair.split())) for pair in (cables[0].get("d") or "")[1:].split("L")]
    np.testing.assert_allclose(drawn, expected, atol=0.051)
    (body,) = all_of(svg, "path", "sketch-body")
    assert (body.get("d") or "").count("M") == 1
    assert len(all_of(svg, "circle", "sketch-winch")) == len(robot.winches)


def test_a_body_in_space_is_one_small_silhouette() -> None:
    robot = box_robot()
    svg = BodySketch(robot.body).network(robot)
    assert len(svg) < 20_000
    assert len(all_of(svg, "path", "sketch-body")) == 1


@pytest.mark.parametrize(
    ("largest", "most", "expected"),
    [(10.0, 5, [0, 2, 4, 6, 8, 10]), (0.9, 3, [0, 0.5]), (33.0, 3, [0, 20]), (6.6, 6, [0, 2, 4, 6])],
)
def test_ticks_are_round(largest: float, most: int, expected: list[float]) -> None:
    assert ticks(largest, most=most) == expected


def test_counts_have_whole_ticks() -> None:
    assert ticks(2.6, most=6, least=1.0) == [0, 1, 2]


def test_a_chart_is_as_large_as_its_values() -> None:
    chart = Chart(width=300, height=120, across=10, up=4, name="a", below="b")
    assert chart.x(10) == 290
    assert chart.y(0) > chart.y(4) == 20
    assert parsed(chart.render("", label="words")).get("aria-label") == "words"


def marks(*errors: float) -> tuple[ProgressPoint, ...]:
    return tuple(
        ProgressPoint(seconds=1.0 + n, error=error, winches=1, cables=n + 1, minutes=10.0 * (n + 1))
        for n, error in enumerate(errors)
    )


def run(*errors: float) -> DesignRun:
    robot = strip_robot(columns=10, rows=3)
    request = DesignRequest(poses=(PoseTarget(name="up", targets={"tip": (0.18, 0.06)}),), winches=1, cables=2)
    return DesignRun(robot=robot, request=request, began=0.0, rest=0.02, best=robot, trail=marks(*errors))


def test_the_error_falls_in_steps_from_rest_to_now() -> None:
    svg = growth_chart(run(0.01, 0.005), 4.0)
    (line,) = all_of(svg, "polyline", "chart-line")
    points = [tuple(map(float, pair.split(","))) for pair in (line.get("points") or "").split()]
    assert len(points) == 6
    (across, heights) = zip(*points, strict=True)
    assert list(across) == sorted(across)
    floor = Chart(width=316, height=132, across=4, up=21, name="", below="").y(0.0)
    levels = (floor - np.array(heights)) / (floor - heights[0])
    np.testing.assert_allclose(levels, [1, 1, 0.5, 0.5, 0.25, 0.25], atol=0.01)
    assert "now 5.0 mm" in svg


def test_a_design_that_has_found_nothing_yet_has_a_chart() -> None:
    assert parsed(growth_chart(run(), 0.0)) is not None


def candidate(number: int, robot: Robot, *, minutes: float, built: float) -> Candidate:
    """A network that takes so long to sew and is so far off once built [mm]."""
    craft = replace(BuildCost.of_robot(robot, []), minutes=minutes)
    return Candidate(
        number=number,
        source=robot,
        robot=robot,
        reaches=(),
        error=0.0,
        expected_error=1e-3 * built,
        craft=craft,
        demand=Demand.of_results(robot, []),
        complete=True,
    )


def place(part: ElementTree.Element) -> tuple[float, float]:
    """Middle of a circle."""
    return float(part.get("cx") or "nan"), float(part.get("cy") or "nan")


def test_a_candidate_is_a_dot_where_its_minutes_and_its_error_are() -> None:
    """Minutes of 20, 40, 80 and errors of 8, 4, 2 mm: scales from 0 put the dots in these shares of the last."""
    robot = strip_robot(columns=10, rows=3)
    pulled = robot.with_network(robot.winches, [*robot.cables, replace(robot.cables[0], name="more")])
    told = [(1, robot, 20, 8), (2, pulled, 40, 4), (3, robot, 80, 2)]
    svg = front_chart([candidate(n, one, minutes=m, built=e) for n, one, m, e in told], marks(0.01), 2)
    dots = [place(dot) for dot in all_of(svg, "circle", "chart-dot")]
    across = np.array([x for x, _ in dots]) - LEFT
    np.testing.assert_allclose(across / across[2], [0.25, 0.5, 1.0], atol=0.002)
    floor = FRONT_HEIGHT - BOTTOM
    heights = floor - np.array([y for _, y in dots])
    np.testing.assert_allclose(heights / heights[0], [1.0, 0.5, 0.25], atol=0.002)
    (ring,) = all_of(svg, "circle", "chart-ring")
    assert place(ring) == dots[1]
    (way,) = all_of(svg, "circle", "chart-way")
    assert place(way)[0] - LEFT == pytest.approx(across[2] / 8, abs=0.1)
    words = all_of(svg, "text", "chart-count")
    assert sorted(part.text or "" for part in words) == sorted(str(len(one.cables)) for _, one, _, _ in told)
    assert "sewing time, min" in svg


def test_numbers_of_dots_that_coincide_are_one_number_that_of_the_chosen() -> None:
    robot = strip_robot(columns=10, rows=3)
    more = robot.with_network(robot.winches, [*robot.cables, replace(robot.cables[0], name="more")])
    pair = [candidate(1, robot, minutes=40, built=4), candidate(2, more, minutes=40.5, built=4)]
    for number, one in ((1, robot), (2, more)):
        (words,) = all_of(front_chart(pair, (), number), "text", "chart-count")
        assert words.text == str(len(one.cables))


def test_a_body_glides_and_arrives() -> None:
    start, goal, pulled = np.zeros((4, 2)), np.ones((4, 2)), np.array([3.0])
    ease = Ease(start, np.zeros(1))
    assert not ease.step(0.0)
    ease.go(goal, pulled)
    assert ease.step(10.0)
    np.testing.assert_array_equal(ease.nodes, start)
    assert ease.step(10.0 + DURATION / 2)
    np.testing.assert_allclose(ease.nodes, 0.5)
    np.testing.assert_allclose(ease.tensions, 1.5)
    assert not ease.step(10.01 + DURATION)
    assert ease.nodes is goal
    np.testing.assert_array_equal(ease.tensions, pulled)
    ease.go(goal, pulled)
    assert not ease.moving
    ease.go(goal, np.array([1.0, 2.0]))
    np.testing.assert_array_equal(ease.tensions, [1.0, 2.0])
