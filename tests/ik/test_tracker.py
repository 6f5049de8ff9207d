"""Targets that move. Oracles: the equilibrium of the streamed contractions, the limits, solve_ik at the end."""

import pickle
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.errors import InputError
from hydrostat.ik import IKOptions, IKStatus, Limits, Tracker, solve_ik
from hydrostat.simulation import Simulation

INTERVAL = 1 / 30


def path(simulation: Simulation, hidden: list[float], updates: int) -> list[dict[str, tuple[float, ...]]]:
    """The tip on a straight line from rest to where hidden contractions bring it."""
    rest, end = (simulation.solve(np.array(a)).markers["tip"] for a in (np.zeros(2), hidden))
    return [{"tip": tuple((rest + (end - rest) * i / updates).tolist())} for i in range(1, updates + 1)]


@pytest.mark.parametrize("robot", [strip_robot(), box_robot()], ids=["flat", "space"])
def test_a_moving_target_is_followed_by_real_poses(robot) -> None:
    simulation = Simulation(robot)
    tracker = Tracker(simulation)
    for targets in path(simulation, [0.012, 0.004], 12):
        reached = tracker.update(targets, seconds=INTERVAL)
        assert reached.pose.result.converged
        assert reached.pose.result.stable
        again = simulation.solve(reached.pose.contractions, start=reached.pose)
        assert np.abs(again.nodes - reached.pose.nodes).max() < 1e-8 * robot.body.mesh.size
        assert max(reached.errors.values()) < 5e-3 * robot.body.mesh.size
    for _ in range(6):
        reached = tracker.update(targets, seconds=INTERVAL)
    assert reached.status is IKStatus.REACHED
    assert max(reached.errors.values()) < 1e-6 * robot.body.mesh.size


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6])
def test_poses_are_as_near_to_equilibrium_as_was_asked(accuracy: float) -> None:
    """Oracle: the equilibrium of the same contractions; the error that is told is the one there is."""
    simulation = Simulation(box_robot())
    tracker, told = Tracker(simulation, accuracy=accuracy), []
    for targets in path(simulation, [0.012, 0.004], 12):
        pose = tracker.update(targets, seconds=INTERVAL).pose
        told.append(pose.result.error)
        exact = simulation.solve(pose.contractions, start=pose)
        off = np.linalg.norm(pose.nodes - exact.nodes, axis=1).max()
        assert pose.result.error <= accuracy
        assert off <= pose.result.error + 1e-9
    assert max(told) > 0  # it is 0 where a pose is solved to the end
    assert max(tracker.update(targets, seconds=INTERVAL).errors.values()) < 2 * accuracy + 1e-6


@pytest.mark.parametrize("accuracy", [0.0, -1.0, float("nan")])
def test_an_accuracy_of_a_tracker_is_a_length(accuracy: float) -> None:
    simulation = Simulation(box_robot())
    with pytest.raises(InputError, match="accuracy must be above 0 m"):
        Tracker(simulation, accuracy=accuracy).update({"tip": (0.1, 0.0, 0.0)}, seconds=INTERVAL)


def test_limits_hold_at_every_update() -> None:
    simulation = Simulation(strip_robot())
    tracker = Tracker(simulation, limits=Limits(rate=0.06, tension=2.0))
    goal = {"tip": tuple(simulation.solve(np.array([0.04, 0.0])).markers["tip"].tolist())}
    before = np.zeros(2)
    for _ in range(25):
        reached = tracker.update(goal, seconds=INTERVAL)
        assert np.abs(reached.pose.contractions - before).max() <= 0.06 * INTERVAL * (1 + 1e-9)
        assert reached.pose.tensions.max() <= 2.0 * (1 + 2e-3)
        before = reached.pose.contractions
    best = solve_ik(simulation, goal, limits=Limits(tension=2.0))
    assert max(reached.errors.values()) == pytest.approx(max(best.errors.values()), rel=1e-3)


def test_slack_cables_join_under_a_limit_of_the_rate() -> None:
    """E15: from the far side of a bend the other cable hangs loose by millimeters."""
    simulation = Simulation(strip_robot(slack=0.004))
    start = simulation.solve(np.array([0.0, 0.02]))
    goal = {"tip": tuple(simulation.solve(np.array([0.025, 0.0])).markers["tip"].tolist())}
    tracker = Tracker(simulation, limits=Limits(rate=0.05), start=start)
    errors = [max(tracker.update(goal, seconds=INTERVAL).errors.values()) for _ in range(60)]
    assert errors[-1] < 1e-6
    assert all(later <= earlier * (1 + 1e-9) for earlier, later in pairwise(errors))


def test_idle_updates_change_nothing() -> None:
    simulation = Simulation(strip_robot())
    tracker = Tracker(simulation)
    goal = {"tip": tuple(simulation.solve(np.array([0.01, 0.0])).markers["tip"].tolist())}
    found = [tracker.update(goal, seconds=INTERVAL).pose.contractions for _ in range(30)]
    assert np.abs(np.diff(found[15:], axis=0)).max() == 0.0


def test_time_must_pass() -> None:
    with pytest.raises(InputError, match="above 0"):
        Tracker(Simulation(strip_robot())).update({"tip": (0.2, 0.0)}, seconds=0.0)


def test_slack_cables_join_from_rest() -> None:
    """A gap wider than the rate allows in one update is closed in several."""
    simulation = Simulation(strip_robot(slack=0.004))
    goal = {"tip": tuple(simulation.solve(np.array([0.025, 0.0])).markers["tip"].tolist())}
    tracker = Tracker(simulation, limits=Limits(rate=0.05))
    for _ in range(60):
        reached = tracker.update(goal, seconds=INTERVAL)
    assert max(reached.errors.values()) < 1e-6


def test_a_start_above_the_limit_of_tension_is_brought_below_it() -> None:
    simulation = Simulation(strip_robot())
    start = simulation.solve(np.array([0.05, 0.0]))
    tracker = Tracker(simulation, limits=Limits(tension=1.0, rate=0.1), start=start)
    goal = {"tip": tuple(start.markers["tip"].tolist())}
    for _ in range(40):
        reached = tracker.update(goal, seconds=INTERVAL)
    assert reached.pose.tensions.max() <= 1.0 * (1 + 2e-3)


@pytest.mark.slow
def test_a_target_that_moves_on_after_long_rest_is_followed() -> None:
    simulation = Simulation(strip_robot())
    tracker = Tracker(simulation, options=IKOptions(tolerance=1e-15))
    here, there = (
        {"tip": tuple(simulation.solve(np.array(a)).markers["tip"].tolist())} for a in ([0.01, 0.0], [0.03, 0.0])
    )
    for _ in range(40):
        tracker.update(here, seconds=INTERVAL)
    for _ in range(15):
        reached = tracker.update(there, seconds=INTERVAL)
    assert max(reached.errors.values()) < 1e-6


@dataclass(frozen=True)
class Known:
    """A model that has one answer, and the answer itself."""

    contractions: np.ndarray
    error: float = 0.0
    uncertainty: float = 0.0
    robot: str = "strip"

    def check(self, robot) -> None:
        if robot.name != self.robot:
            raise InputError(f"the model was learned of another robot than {robot.name!r}")

    def solve(self, targets) -> "Known":
        return self


HIDDEN = np.array([0.012, 0.004])


def test_a_tracker_goes_at_once_where_a_model_leads() -> None:
    """Oracles: where hidden contractions bring the tip; short strides without a model; the streamed equilibrium."""
    robot = strip_robot()
    simulation = Simulation(robot)
    target = {"tip": tuple(simulation.solve(HIDDEN).markers["tip"].tolist())}
    short = IKOptions(largest_step=0.02)
    alone = Tracker(simulation, options=short).update(target, seconds=INTERVAL)
    model = Known(0.99 * HIDDEN, robot=robot.name)
    led = Tracker(simulation, options=short, model=model).update(target, seconds=INTERVAL)
    assert led.errors["tip"] < 0.02 * alone.errors["tip"]
    again = simulation.solve(led.pose.contractions, start=led.pose)
    assert np.abs(again.nodes - led.pose.nodes).max() < 1e-8 * robot.body.mesh.size


def test_what_a_model_says_in_vain_changes_nothing() -> None:
    """A model that lies, or doubts. Oracle: a tracker without one."""
    robot = strip_robot()
    simulation = Simulation(robot)
    target = {"tip": tuple(simulation.solve(HIDDEN).markers["tip"].tolist())}
    alone = Tracker(simulation).update(target, seconds=INTERVAL).pose.contractions
    lying, doubting = Known(HIDDEN[::-1].copy(), robot=robot.name), Known(HIDDEN, uncertainty=1.0, robot=robot.name)
    for model in (lying, doubting):
        found = Tracker(simulation, model=model).update(target, seconds=INTERVAL).pose.contractions
        assert (found == alone).all()


def test_where_a_model_leads_limits_hold() -> None:
    """Oracles: what the rate allows in an interval; the limit on the tension."""
    robot = strip_robot()
    simulation = Simulation(robot)
    pose = simulation.solve(HIDDEN)
    target, model = {"tip": tuple(pose.markers["tip"].tolist())}, Known(HIDDEN, robot=robot.name)
    slow = Tracker(simulation, limits=Limits(rate=0.03), model=model).update(target, seconds=INTERVAL)
    assert np.abs(slow.pose.contractions).max() <= 0.03 * INTERVAL + 1e-12
    most = 0.5 * float(pose.tensions.max())
    weak = Tracker(simulation, limits=Limits(tension=most), model=model).update(target, seconds=INTERVAL)
    assert weak.pose.tensions.max() <= 1.01 * most


def test_a_model_of_another_robot_is_refused() -> None:
    with pytest.raises(InputError, match="another robot"):
        Tracker(Simulation(strip_robot()), model=Known(HIDDEN, robot="another"))


def test_an_outlook_tells_the_step_that_the_next_update_takes() -> None:
    """Oracle: that update, which begins at the same pose and finds the equilibrium at the end of the step."""
    simulation = Simulation(box_robot())
    limits = Limits(rate=0.05)
    tracker, targets = Tracker(simulation, limits=limits), path(simulation, [0.012, 0.004], 12)
    with pytest.raises(InputError, match="needs an update"):
        tracker.linearize(seconds=INTERVAL)
    for before, after in pairwise(targets):
        tracker.update(before, seconds=INTERVAL)
        outlook = pickle.loads(pickle.dumps(tracker.linearize(seconds=INTERVAL)))
        told, here = outlook.towards(after), tracker.pose.contractions
        assert np.abs(told - here).max() <= 0.05 * INTERVAL * (1 + 1e-9)
        assert tracker.update(after, seconds=INTERVAL).pose.contractions == pytest.approx(told, abs=1e-9)
    with pytest.raises(InputError, match="of the markers of the last update: "):
        outlook.towards({"nose": (0.0, 0.0, 0.0)})
