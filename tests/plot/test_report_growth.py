"""What the report tells of grown networks. Oracles: words and numbers by hand, brute force, the pictures' own data."""

from dataclasses import replace

import numpy as np
import pytest
from plot.designs import SCRIPT, grown, hostile_network, plain_network, space_network
from plot.test_report import Page

from hydrostat.design import (
    Alternative,
    BuildCost,
    Certificate,
    DesignStage,
    Network,
    on_front,
    score_card,
    winch_front,
)
from hydrostat.drawing import Color
from hydrostat.plot import inline_svg
from hydrostat.plot.design_charts import draw_front, draw_growth, draw_winch_front, stage_runs
from hydrostat.plot.report import report_text
from hydrostat.plot.report_chapters import alternative_chapters, certificate_words, evenly
from hydrostat.plot.robot_figures import draw_stage, stage_frame
from hydrostat.robot import Robot


def sized(winches: int, cables: int, error: float) -> Alternative:
    """An alternative of some size and error [m]; its winches pull the same two cables over and over."""
    network = plain_network()
    robot, (reached, *_) = network.robot, network.ik_results
    parts = [replace(robot.winches[0], name=f"w{index}") for index in range(winches)]
    lines = [replace(robot.cables[0], name="", winch=parts[index % winches].name) for index in range(cables)]
    pose = replace(reached.pose, tensions=np.ones(cables), contractions=np.zeros(winches))
    return Alternative(
        robot=robot.with_network(parts, lines),
        ik_results=(replace(reached, pose=pose, errors={"tip": error}),),
        expected_error=error,
    )


@pytest.mark.parametrize(("count", "most"), [(1, 8), (2, 8), (8, 8), (9, 8), (40, 8), (5, 2)])
def test_stages_shown_are_spread_evenly(count: int, most: int) -> None:
    shown = evenly(count, most)
    assert len(shown) == min(count, most)
    assert (shown[0], shown[-1]) == (0, count - 1)
    gaps = np.diff(shown)
    assert np.ptp(gaps) <= 1 if len(gaps) else True


def test_the_certificate_in_words() -> None:
    one = Certificate(further=0.0012, paths=12345, descent_rate=0.0251)
    assert certificate_words(0.0034, one) == (
        "One more cable with a winch of its own, along the best path found by pricing 12,345 states, would promise "
        "1.20 mm rms instead of 3.40 mm rms. Moving one via point along one axis lowers the error by at most 0.025 mm "
        "for each millimeter."
    )
    assert "promises nothing beyond 1.20 mm rms." in certificate_words(0.0012, one)
    assert certificate_words(0.1, None) == "The search was stopped before it could tell what one more cable would gain."


@pytest.mark.slow
def test_the_report_tells_how_it_grew(unchecked: None) -> None:
    page = Page(report_text(grown(hostile_network())))
    words = " ".join(page.words)
    assert "script" not in page.tags
    for told in ("How it grew", "Alternatives", "What is left to gain.", "promise 2.10 mm rms", f"1. {SCRIPT}"):
        assert told in words
    for number, shown in ((1, True), (2, True), (3, False), (6, False), (11, True)):
        assert (f"{number}. Via points of {number - 1} cables moved" in words) == (shown and number > 1)
    for error in ("34.50", "45.60"):
        assert any(word.startswith(f": {error} mm rms once built; ") and "of sewing" in word for word in page.words)
    assert "What muscles would do" not in words


@pytest.mark.slow
def test_no_alternatives_no_chapter() -> None:
    text = report_text(replace(plain_network(), alternatives=()))
    assert "Alternatives" not in text
    assert "How it grew" in text


def told(*others: tuple[int, int, float]) -> str:
    """The chapter on alternatives."""
    (chapter,) = alternative_chapters(replace(plain_network(), alternatives=tuple(sized(*other) for other in others)))
    return "".join(chapter.parts)


def test_alternatives_of_one_size_have_no_front() -> None:
    assert "Error against minutes of sewing" not in told((2, 2, 0.01), (2, 2, 0.02))
    assert "Error against minutes of sewing" in told((2, 2, 0.01), (2, 3, 0.02))


@pytest.mark.slow
def test_of_many_alternatives_some_are_shown() -> None:
    page = told(*((2, 2, 0.01 + 1e-3 * index) for index in range(14)))
    assert page.count("<figure>") == 12
    assert "12 of 14 are shown." in page


def staged(*cables: int) -> list[DesignStage]:
    """Stages with so many cables, whose errors fall from 30 mm."""
    return [
        DesignStage(words="", robot=sized(1, count, 0.0).robot, error=0.03 / number)
        for number, count in enumerate(cables, start=1)
    ]


def test_the_curve_of_growth_holds_every_stage() -> None:
    axes = draw_growth(staged(1, 2, 3, 4, 5, 6), rest=0.02, final=0.005, marked=[0, 5]).axes[0]
    line, hollow, filled, rest, final = axes.lines
    assert np.asarray(line.get_ydata()) == pytest.approx([30 / number for number in range(1, 7)])
    assert list(filled.get_xdata()) == [1, 6]
    assert list(hollow.get_xdata()) == [2, 3, 4, 5]
    assert (list(rest.get_ydata()), list(final.get_ydata())) == ([20, 20], [5, 5])
    assert {text.get_text() for text in axes.texts} == {"at rest: 20 mm", "returned: 5 mm"}
    assert (axes.get_yscale(), axes.get_ylim()[0]) == ("linear", 0.0)


def test_networks_drawn_one_after_the_other_are_separate() -> None:
    """Each has as many cables as the one before, and is no later stage of it."""
    begun = (True, True, False)
    stages = [replace(stage, is_begun=each) for stage, each in zip(staged(3, 3, 3), begun, strict=True)]
    assert stage_runs(stages) == [[0], [1, 2]]


def test_errors_that_differ_much_are_on_a_logarithmic_scale() -> None:
    assert draw_growth(staged(1, 2), final=1e-5).axes[0].get_yscale() == "log"
    assert draw_growth(staged(1, 2), final=0.0).axes[0].get_yscale() == "linear"


@pytest.mark.parametrize(
    ("cables", "runs"),
    [
        ((1, 2, 3, 3, 2, 3), [[0, 1, 2, 3, 4, 5]]),
        ((1, 2, 3, 1, 2, 3, 3), [[0, 1, 2], [3, 4, 5, 6]]),
        ((1, 2, 1, 2, 1), [[0, 1], [2, 3], [4]]),
        ((3, 4, 5, 3, 4, 5), [[0, 1, 2], [3, 4, 5]]),
        ((1,), [[0]]),
    ],
)
def test_a_new_line_where_another_network_is_begun(cables: tuple[int, ...], runs: list[list[int]]) -> None:
    """One cable that is dropped is no new network."""
    stages = staged(*cables)
    assert stage_runs(stages) == runs
    shown = [list(line.get_xdata()) for line in draw_growth(stages).axes[0].lines if line.get_linestyle() == "-"]
    assert shown == [[index + 1 for index in run] for run in runs]


OTHERS = [(1, 1, 0.009), (1, 2, 0.008), (1, 3, 0.0085), (2, 3, 0.004), (2, 4, 0.004), (3, 3, 0.005), (1, 2, 0.02)]


def chosen(error: float = 0.006) -> Network:
    network = plain_network()
    return replace(network, ik_results=(replace(network.ik_results[0], errors={"tip": error}),), expected_error=error)


def test_the_best_of_each_size_counts_and_the_chosen_one_always() -> None:
    errors = chosen().best_errors([sized(*other) for other in [*OTHERS, (2, 2, 0.001)]])
    assert errors == pytest.approx(
        {(1, 1): 0.009, (1, 2): 0.008, (1, 3): 0.0085, (2, 2): 0.006, (2, 3): 0.004, (2, 4): 0.004, (3, 3): 0.005}
    )
    assert list(errors) == sorted(errors)


def test_a_row_for_each_number_of_winches() -> None:
    """Oracle: the least by hand; the chosen network stands for its own number, others may be better."""
    network = replace(chosen(), alternatives=tuple(sized(*other) for other in OTHERS))
    rows = score_card(network, version="")["by_winches"]
    assert [row["winches"] for row in rows] == [1, 2, 3]
    assert [row["rms_error_as_built"] for row in rows] == pytest.approx([0.008, 0.006, 0.005])
    assert [row["cables"] for row in rows] == [2, len(network.robot.cables), 3]
    assert all({"motors", "minutes", "price"} <= row["craft"].keys() for row in rows)
    (chapter,) = alternative_chapters(network)
    assert "price [USD]" in "".join(map(str, chapter.parts))


def test_winches_that_pull_both_ways_are_a_row_and_a_diamond() -> None:
    """Oracle: rows by hand. Of two with one price and one effort, the row of the larger error is no better."""
    one = sized(1, 2, 0.008)
    turned = replace(one.robot.cables[0], reverse=True)
    both = replace(one, robot=one.robot.with_network(one.robot.winches, [turned, one.robot.cables[1]]))
    alternatives = (one, replace(both, expected_error=0.007), replace(both, expected_error=0.0071))
    rows = winch_front(replace(chosen(), alternatives=alternatives))
    assert [(row.title, row.expected_error, row.note) for row in rows] == [
        ("1", 0.008, "no better"),
        ("1, both ways", 0.007, ""),
        ("2", 0.006, "chosen"),
    ]
    axes = draw_winch_front(rows).axes[0]
    dots = [line for line in axes.lines if line.get_markersize() == 5.5]
    assert [dot.get_marker() for dot in dots] == ["o", "D", "o"]
    assert [dot.get_markerfacecolor() == "white" for dot in dots] == [True, False, False]
    assert [float(dot.get_ydata()[0]) for dot in dots] == pytest.approx([8.0, 7.0, 6.0])
    assert [float(dot.get_xdata()[0]) for dot in dots] == [row.cost.price for row in rows]


@pytest.mark.parametrize("seed", range(5))
def test_the_front_is_what_nothing_dominates(seed: int) -> None:
    """Brute force over all pairs: at most as many winches and cables, at most the error, and not itself."""
    random = np.random.default_rng(seed)
    sizes = {(int(w), int(w + more)) for w, more in random.integers(1, 5, size=(12, 2))}
    errors = {size: float(error) for size, error in zip(sizes, random.integers(1, 6, len(sizes)), strict=True)}
    points = {size: np.array([*size, error]) for size, error in errors.items()}
    for size, point in points.items():
        beaten = any((other <= point).all() for name, other in points.items() if name != size)
        assert on_front(size, errors) == (not beaten)


def test_the_picture_of_the_front() -> None:
    """A cable of `sized` takes as many minutes as each other: dots stand at multiples of it, filled by brute force."""
    others = [sized(*other) for other in OTHERS]
    axes = draw_front(others, chosen(), tolerance=0.0045).axes[0]
    each = BuildCost.cable_minutes(others[0].robot)
    own = BuildCost.cable_minutes(chosen().robot)
    points = [(own, 6.0), *((each * cables, 1e3 * error) for _, cables, error in OTHERS)]
    dots = [line for line in axes.lines if line.get_markersize() == 5.5 and np.size(line.get_xdata())]
    drawn = {tuple(np.asarray(dot.get_xydata())[0].round(9)): dot for dot in dots}
    assert set(drawn) == {tuple(np.round(point, 9)) for point in points}
    winches = [len(chosen().robot.winches), *(count for count, _, _ in OTHERS)]
    for (x, y), count in zip(points, winches, strict=True):
        dot = drawn[tuple(np.round((x, y), 9))]
        beaten = any(left <= x and low <= y and (left, low) != (x, y) for left, low in points)
        if points.count((x, y)) == 1:
            assert dot.get_markeredgecolor() == Color.WINCHES[count - 1]
            assert dot.get_markerfacecolor() == ("white" if beaten else Color.WINCHES[count - 1])
    labels = [line.get_label() for line in axes.lines if not str(line.get_label()).startswith("_")]
    assert labels == ["1 winch", "2 winches", "3 winches"]
    (ring,) = [line for line in axes.lines if line.get_markersize() == 12]
    assert np.asarray(ring.get_xydata()) == pytest.approx(np.array([[own, 6.0]]))
    words = {text.get_text() for text in axes.texts}
    assert {"chosen: 6.00 mm", "tolerance"} < words
    assert words - {"chosen: 6.00 mm", "tolerance"} <= {"1", "2", "3", "4"}
    assert axes.get_ylim()[0] == 0.0


@pytest.mark.parametrize("network", [plain_network, space_network])
def test_stages_share_their_frame_and_side(network: object) -> None:
    """The same body lies at the same place, whatever network is on it."""
    robot: Robot = network().robot  # pyright: ignore[reportCallIssue]
    begun = robot.with_network(robot.winches[1:], robot.cables[1:])
    frame = stage_frame([robot, begun])
    one, two = (draw_stage(shown, like=robot, frame=frame) for shown in (robot, begun))
    assert np.array_equal(one.get_size_inches(), two.get_size_inches())
    assert one.axes[0].get_xlim() == two.axes[0].get_xlim()
    for first, second in zip(one.axes[0].images, two.axes[0].images, strict=True):
        assert np.array_equal(first.get_array(), second.get_array())  # pyright: ignore[reportArgumentType]
    assert inline_svg(one, name="it", label="") != inline_svg(two, name="it", label="")
