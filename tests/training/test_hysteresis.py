"""A robot that reaches while its cables rub. Oracles: the simulator on the same way, distances by hand."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from hydrostat.training import ReachEnv, ReachOptions, TaskOptions, held_out_goals, judge  # noqa: E402
from hydrostat.training.reach_env import HysteresisEnv  # noqa: E402

MU = 0.3


@pytest.fixture(scope="module")
def robot() -> Robot:
    """One winch, and a cable that turns a lot."""
    return gallery_robot("letter_s")


def places(pose: Equilibrium) -> Vector:
    return np.array(list(pose.markers.values())).ravel()


def seen(env: ReachEnv, observation: dict[str, Vector]) -> Vector:
    return env.unit * observation["achieved_goal"] + env.rest[env.seen]


@pytest.mark.parametrize("incremental", [False, True])
def test_checkers_of_both_libraries_pass(robot: Robot, incremental: bool) -> None:
    from gymnasium.utils.env_checker import check_env

    options = ReachOptions(steps=3, incremental=incremental)
    made = gymnasium.make("hydrostat/ReachWithHysteresis-v0", robot=robot, options=options)
    check_env(made.unwrapped, skip_render_check=True)
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="no stable-baselines3")
    checker.check_env(made.unwrapped)


def test_the_way_counts_and_all_of_it_is_counted(robot: Robot) -> None:
    """The same action from two starts, beside the simulator of a robot whose file says that cables rub."""
    rubs = Simulation(robot.with_network(robot.winches, [replace(cable, friction=MU) for cable in robot.cables]))
    env, ends = HysteresisEnv(robot, friction=MU, options=ReachOptions(tolerance=1e-3)), []
    full = robot.winches[0].travel
    goal = places(rubs.solve(np.array([0.5 * full])))
    for start in (0.0, 0.9 * full):
        before = env.equilibria
        env.reset(seed=0, options={"goal": goal, "start": [start]})
        action = np.array([0.0])  # half way from release to travel
        observation, reward, _, over, info = env.step(action)
        middle = env.contractions(action)
        assert middle == pytest.approx([0.5 * (full - robot.winches[0].release)])
        by_hand = rubs.solve(middle, start=rubs.solve(np.array([start])) if start else None)
        assert seen(env, observation) == pytest.approx(places(by_hand), abs=1e-8)
        far = np.linalg.norm((places(by_hand) - goal).reshape(-1, 2), axis=1).mean()
        assert (reward, info["distance"], over) == (pytest.approx(-far / 1e-3, abs=1e-4), pytest.approx(far), True)
        assert env.equilibria - before == 1 + (start > 0)  # of the action, and of a start that is not rest
        ends.append(places(by_hand))
    assert np.abs(ends[0] - ends[1]).max() > 2e-3


def test_a_start_that_is_given_stays_where_only_the_goal_is_drawn(robot: Robot) -> None:
    env, start = HysteresisEnv(robot), 0.8 * robot.winches[0].travel
    env.reset(seed=0, options={"start": [start]})
    assert env.moves[0][1] == pytest.approx([start])


def test_without_friction_it_is_reach(robot: Robot) -> None:
    goal = {"goal": ReachEnv(robot).rest + 0.01}
    left = [
        judge(env, lambda _: np.array([0.4]), [goal])
        for env in (ReachEnv(robot), HysteresisEnv(robot, friction=0.0), HysteresisEnv(robot, friction=MU))
    ]
    assert left[1] == pytest.approx(left[0], abs=1e-8)
    assert abs(left[2] - left[0]) > 1e-3


def test_held_out_episodes_are_the_same_each_time(robot: Robot) -> None:
    """They begin where they say, whatever was before; they cost no learning."""
    env = HysteresisEnv(robot, friction=MU)
    goals = held_out_goals(env, 2, 5)
    again = held_out_goals(HysteresisEnv(robot, friction=MU), 2, 5)
    assert [sorted(goal) for goal in goals] == [["goal", "start"]] * 2
    for one, other in zip(goals, again, strict=True):
        assert all(one[name] == pytest.approx(other[name], abs=1e-12) for name in one)
    left = judge(env, lambda _: np.array([0.1]), goals)
    assert judge(env, lambda _: np.array([0.1]), goals) == pytest.approx(left, abs=1e-12)
    assert env.equilibria == env.uncounted == 2 + 4 + 4
    assert env.get_state()["equilibria"] == env.equilibria


@pytest.mark.usefixtures("unchecked")
def test_a_picture_shows_the_pose_of_the_way_that_was_gone(robot: Robot) -> None:
    env = HysteresisEnv(robot, friction=MU, render_mode="rgb_array")
    shown = []
    for start in (0.0, robot.winches[0].travel):
        env.reset(options={"goal": env.rest, "start": [start]})
        env.step(np.array([0.0]))
        shown.append(env.render()[60:])  # below the words
    assert (shown[0] != shown[1]).any(axis=2).mean() > 0.01


@pytest.mark.parametrize(
    ("given", "told"),
    [({"friction": -0.1}, "friction must be 0 or more"), ({"friction": None}, "no cable of robot")],
)
def test_friction_that_cannot_be_is_told(robot: Robot, given: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        HysteresisEnv(robot, **given)


def test_what_a_task_does_not_have_is_told(robot: Robot) -> None:
    with pytest.raises(InputError, match="this task has no friction"):
        ReachEnv.for_task(robot, TaskOptions(friction=0.2))
    made = HysteresisEnv.for_task(robot, TaskOptions(friction=MU, steps=7, incremental=True))
    assert {cable.friction for cable in made.robot.cables} == {MU}
    assert (made.steps, made.options.incremental, made.portable) == (7, True, False)
    with pytest.raises(InputError, match="a start has 1 contractions"):
        made.reset(options={"goal": made.rest, "start": [0.0, 0.1]})
    with pytest.raises(InputError, match=r"a goal has 8 coordinates \[m\], not"):
        made.reset(options={"goal": [0.0, 0.1, 0.2]})


@pytest.mark.usefixtures("unchecked")
def test_actions_and_goals_that_are_none_are_told(robot: Robot) -> None:
    """A goal that is no number made every reward NaN."""
    env = ReachEnv(robot)
    with pytest.raises(InputError, match="a goal has 8 coordinates"):
        env.reset(options={"goal": np.full(8, np.nan)})
    env.reset(seed=0)
    for action in (None, [0.0, 0.0, 0.0, 0.0], [np.nan], "a"):
        with pytest.raises(InputError, match="an action has 1 numbers from -1 to 1, not"):
            env.step(action)  # type: ignore[arg-type]
    assert env.taken_steps == 0
