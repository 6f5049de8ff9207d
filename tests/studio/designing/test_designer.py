"""The stage design with real searches in real processes. Oracles: `design_cables` here, the network that was shown."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design import Constraints, DesignRequest, RouteOptions, TreeOptions, design_cables
from hydrostat.drawing import Color
from hydrostat.errors import InputError
from hydrostat.ik import Limits, solve_ik
from hydrostat.project import Wishes, Work
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.designing.designer import Designer
from hydrostat.studio.designing.run import error_at_rest, share_done, time_left
from hydrostat.studio.designing.sketch import DURATION
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName
from hydrostat.studio.view.scene_items import Dot, Look, Strand

TIMEOUT = 100.0
FAST = RouteOptions(starts=1, exchanges=0, refine_steps=2, trials=1, steps=1, max_edges=6)
LONG = RouteOptions(stop_error=0.0, exchanges=1000)


class Studio:
    """A session that can be waited on."""

    def __init__(self, robot: Robot, options: RouteOptions, *, cables: int = 2) -> None:
        self.session = Session()
        self.designer = self.session.designer
        self.designer._options = options
        self.rung = threading.Condition()
        self.session.bell.listen(self._hear)
        self.session.document.open(Work(robot=robot, wishes=Wishes(winches=1, cables=cables, poses=("up",))))
        self.session.go(StageName.DESIGN)

    def _hear(self, topic: Topic) -> None:
        with self.rung:
            self.rung.notify_all()

    def until(self, condition) -> None:
        with self.rung:
            assert self.rung.wait_for(condition, TIMEOUT)

    def settle(self) -> None:
        """Let the body come to where it glides."""
        now = 0.0
        while self.session.step(now):
            now += DURATION / 4


@pytest.fixture(scope="module")
def strip() -> Robot:
    """A strip with two cables of its own and two poses."""
    poses = {"up": (0.18, 0.06), "down": (0.185, -0.05)}
    targets = {name: PoseTarget(name=name, targets={"tip": place}) for name, place in poses.items()}
    return replace(strip_robot(columns=10, rows=3), poses=targets)


@pytest.fixture(scope="module")
def done(strip: Robot) -> Iterator[Studio]:
    """A design that is done; tests leave it so."""
    studio = Studio(strip, FAST)
    studio.designer.design()
    studio.until(lambda: not studio.designer.running)
    yield studio
    studio.session.close()


@pytest.fixture
def fresh(strip: Robot) -> Iterator[Studio]:
    studio = Studio(strip, LONG, cables=6)
    yield studio
    studio.session.close()


@pytest.mark.slow
def test_what_is_found_is_what_design_cables_returns(done: Studio, strip: Robot, unchecked: None) -> None:
    expected = design_cables(strip, [strip.pose("up")], winches=1, cables=2, options=FAST)
    best = done.designer.candidates[0]
    assert best.complete
    assert (best.robot.winches, best.robot.cables) == (expected.robot.winches, expected.robot.cables)
    assert best.error == pytest.approx(expected.rms_error, rel=1e-6)
    assert best.expected_error == pytest.approx(expected.expected_error, rel=1e-6)
    # Of the alternatives those are shown that are simpler than all that are better.
    shown: list[tuple[int, int, int]] = []
    for network in (expected, *sorted(expected.alternatives, key=lambda other: other.expected_error)):
        robot = network.robot
        parts = len(robot.winches), len(robot.cables), sum(len(cable.points) for cable in robot.cables)
        if not any(all(one <= other for one, other in zip(better, parts, strict=True)) for better in shown):
            shown.append(parts)
    assert len(done.designer.candidates) == len(shown) < 1 + len(expected.alternatives)
    assert best.counts == "1 winch, 1 cable"
    assert best.length == sum(cable.length for cable in expected.robot.cables)
    assert best.tension == pytest.approx(expected.ik_results[0].pose.tensions.max(), rel=1e-6)
    assert "1 winch, 1 cable" in done.designer.outcome
    assert done.session.document.robot is strip


@pytest.mark.slow
def test_networks_on_the_way_get_better_from_rest_on(done: Studio, strip: Robot) -> None:
    run = done.designer.run
    assert run is not None
    errors = [mark.error for mark in run.trail]
    assert errors == sorted(set(errors), reverse=True)
    assert [mark.seconds for mark in run.trail] == sorted(mark.seconds for mark in run.trail)
    assert 0 < errors[-1] < run.rest == error_at_rest(strip, (strip.pose("up"),))


def test_a_candidate_is_shown_in_its_pose_and_at_rest(done: Studio) -> None:
    designer, best = done.designer, done.designer.candidates[0]
    designer.show(best.number, "up")
    done.settle()
    solved = solve_ik(Simulation(best.robot), best.robot.pose("up"), limits=Limits(tension=20.0)).pose
    np.testing.assert_allclose(designer.shape().nodes, solved.nodes, atol=1e-5)
    np.testing.assert_allclose(designer.shape().tensions, solved.tensions, atol=1e-2)
    assert designer.shape().errors == best.reaches[0].errors
    targets = [item for item in designer.scene_items() if isinstance(item, Dot) and item.look is Look.TARGET]
    assert [dot.at for dot in targets] == list(best.robot.pose("up").targets.values())
    cables = [item for item in designer.scene_items() if isinstance(item, Strand) and item.key.startswith("cable")]
    assert [line.points for line in cables] == [cable.points for cable in best.robot.cables]
    designer.show(best.number)
    done.settle()
    np.testing.assert_array_equal(designer.shape().nodes, best.source.body.mesh.nodes)
    assert not designer.shape().tensions.any()
    assert done.session.current_view() is not None


def test_accepting_is_one_step_to_undo(done: Studio, strip: Robot) -> None:
    document, designer = done.session.document, done.designer
    best = designer.candidates[0]
    designer.show(best.number, "up")
    designer.accept()
    assert document.robot.winches == best.robot.winches
    assert document.robot.cables == best.robot.cables
    assert document.robot.body is strip.body
    assert document.undo_label == "accept design, 1 winch, 1 cable"
    document.undo()
    assert document.robot is strip


def test_nothing_is_accepted_into_another_body(done: Studio, strip: Robot) -> None:
    document, designer = done.session.document, done.designer
    designer.show(designer.candidates[0].number)
    thick = replace(strip, body=replace(strip.body, thickness=0.05))
    document.change("thicker", robot=thick)
    assert designer.candidates == ()
    with pytest.raises(InputError, match="no network selected for this body"):
        designer.accept()
    document.undo()
    assert len(designer.candidates) > 0


def test_candidates_are_forgotten_when_cleared(done: Studio) -> None:
    kept = done.designer._all
    done.designer.clear()
    assert done.designer.candidates == ()
    assert done.designer.candidate is None
    done.designer._all = kept


@pytest.mark.slow
def test_stopped_it_returns_the_best_so_far(fresh: Studio, strip: Robot) -> None:
    designer = fresh.designer
    designer.design()
    with pytest.raises(InputError, match="Designing cables is still running"):
        designer.design()
    assert [item for item in designer.scene_items() if isinstance(item, Strand) and item.key.startswith("cable")] == []
    fresh.until(lambda: designer.run is not None and len(designer.run.trail) > 0)
    assert designer.running
    fresh.settle()
    run = designer.run
    assert run is not None
    cables = [item for item in designer.scene_items() if isinstance(item, Strand) and item.key.startswith("cable")]
    assert len(cables) > 0
    assert len(run.best.cables) == run.trail[-1].cables
    fresh.session.go(StageName.POSE)
    fresh.session.go(StageName.DESIGN)
    assert designer.running
    designer.stop()
    fresh.until(lambda: not designer.running)
    assert not designer.candidates[0].complete
    assert designer.outcome.startswith("stopped early")
    assert fresh.session.document.robot is strip


def test_stopped_twice_there_is_none(fresh: Studio) -> None:
    fresh.designer.design()
    fresh.designer.stop()
    fresh.designer.stop()
    fresh.until(lambda: not fresh.designer.running)
    assert fresh.designer.candidates == ()
    assert fresh.designer.outcome == "stopped before a network was found"
    assert fresh.designer.step(0.0) is False


class Waiting(Jobs):
    """Keeps what is to be called, and does nothing."""

    def __init__(self, bell: Bell) -> None:
        super().__init__(bell)
        self.ends: list[Callable[[str], None]] = []

    def start(self, title: str, function: Callable[..., Any], *arguments: Any, **calls: Any) -> None:
        """Nothing begins."""
        self.ends.append(calls["on_end"])

    def warm(self, *modules: str) -> None:
        """Nothing is made ready."""


def test_the_end_of_one_design_does_not_end_the_next(strip: Robot) -> None:
    bell = Bell()
    document = Document(bell)
    document.open(Work(robot=strip))
    jobs = Waiting(bell)
    designer = Designer(document, jobs, options=FAST)
    designer.design()
    designer.design()
    jobs.ends[0]("no network was found")
    assert designer.running
    jobs.ends[1]("stopped")
    assert not designer.running
    assert designer.outcome == "stopped before a network was found"


@pytest.mark.slow
def test_what_the_search_refuses_is_told(fresh: Studio) -> None:
    fresh.designer.wish(winches=1, cables=1, mirror="y")
    fresh.designer.design()
    fresh.until(lambda: not fresh.designer.running)
    assert fresh.designer.outcome.startswith("1 cable: a mirrored network has its cables in pairs")


def test_what_cannot_be_asked_is_told_at_once(fresh: Studio) -> None:
    fresh.designer.wish(winches=2, cables=1)
    with pytest.raises(InputError, match=r"^2 winches need at least 2 cables, got 1"):
        fresh.designer.design()
    assert not fresh.designer.running


def test_without_poses_it_says_what_to_do(fresh: Studio, strip: Robot) -> None:
    fresh.session.document.change("no poses", robot=replace(strip, poses={}))
    with pytest.raises(InputError, match=r"no poses to design for\. Drag the body in Pose"):
        fresh.designer.design()
    assert not fresh.designer.running


def test_wishes_are_undone_and_wrong_ones_refused(fresh: Studio) -> None:
    designer, document = fresh.designer, fresh.session.document
    designer.wish(winches=3)
    designer.wish(cables=4)
    document.undo()
    assert (designer.wishes.winches, designer.wishes.cables) == (3, 6)
    for wrong in ({"winches": 21}, {"cables": 0}, {"tension": 0.0}, {"slack": -1.0}, {"torque": float("nan")}):
        with pytest.raises(InputError, match="must be"):
            designer.wish(**wrong)
    designer.wish(slack=0.0)
    assert document.redo_label == "change design settings"


def test_one_pose_at_least_is_reached(fresh: Studio) -> None:
    designer = fresh.designer
    with pytest.raises(InputError, match="at least one pose"):
        designer.wish_pose("up", False)
    designer.wish_pose("down", True)
    assert designer.wishes.poses == ()
    designer.wish_pose("up", False)
    assert designer.wishes.poses == ("down",)


def test_targets_of_several_poses_are_told_apart(fresh: Studio) -> None:
    """Oracle: where the poses want their marker; one pose alone has no color."""

    def rings() -> dict[tuple[float, ...], str]:
        items = fresh.designer.scene_items()
        return {item.at: item.color for item in items if isinstance(item, Dot) and item.look is Look.TARGET}

    assert rings() == {(0.18, 0.06): Color.INK}
    fresh.designer.wish_pose("down", True)
    colors = Color.of_poses(["up", "down"])
    assert rings() == {(0.18, 0.06): colors["up"], (0.185, -0.05): colors["down"]}
    assert len({*colors.values(), Color.INK}) == 3


@pytest.mark.slow
def test_the_best_so_far_can_be_taken_at_any_moment(fresh: Studio, strip: Robot) -> None:
    """One press ends the search, and the network that is listed is in the robot; undo takes it back."""
    designer, document = fresh.designer, fresh.session.document
    designer.design()
    fresh.until(lambda: designer.run is not None and designer.run.trail)
    assert designer.run is not None
    best = designer.run.trail[-1]
    assert best.words
    assert best.num_evaluated > 0
    designer.take_best()
    fresh.until(lambda: not designer.running)
    taken = designer.candidates[0]
    assert not taken.complete
    assert document.robot.cables == taken.robot.cables != strip.cables
    assert document.undo()
    assert document.robot.cables == strip.cables


@pytest.mark.slow
def test_knobs_of_the_thesis_search_act_immediately(strip: Robot, unchecked: None) -> None:
    """A change leaves one network, which `design_cables` returns for these knobs; one that gives none says why."""
    studio = Studio(strip, FAST)
    designer = studio.designer
    designer.wish(method="chang2018", clearance=0.004)
    for threshold in (4, 6, 8):
        designer.wish(threshold=threshold)
    studio.until(lambda: not designer.running)
    knobs = TreeOptions.single(threshold=8)
    limits = Constraints(clearance=0.004)
    expected = design_cables(
        strip, [strip.pose("up")], winches=1, cables=2, method="chang2018", options=knobs, constraints=limits
    )
    assert [one.robot.cables for one in designer.candidates] == [expected.robot.cables]
    designer.wish(threshold=20)
    studio.until(lambda: not designer.running)
    assert designer.candidates == ()
    assert "Rejected: " in designer.outcome
    studio.session.close()


def test_a_search_tells_how_much_of_it_is_done() -> None:
    """Shares rise from stage to stage; what is left follows by the rule of three."""
    routes = DesignRequest(poses=(PoseTarget(name="up", targets={"tip": (0.0, 0.0)}),), winches=1, cables=2)
    stages = [("Drawing networks", 0, 6), ("Drawing networks", 3, 6), ("Growing networks", 1, 6), ("Refining", 1, 2)]
    shares = [share_done(routes, *stage) for stage in (*stages, ("Exchanging cables", 1, 1))]
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < shares[-1] < 1.0
    assert share_done(replace(routes, winches="auto"), *stages[1]) is None
    assert time_left(10.0, 0.5) == "about 10 s left"
    assert time_left(100.0, 0.5) == "about 105 s left"
    assert time_left(10.0, 0.05) == time_left(10.0, None) == ""
