"""Things that a robot pushes and turns, as tasks. Oracles: way / radius, angles and distances by hand."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import FOAM, mesh_body, strip_mesh, strip_robot
from flat_gripper import DRAG, flat_gripper

from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, Pin, Robot

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from hydrostat.training import (  # noqa: E402
    ManipulationPhysics,
    PushEnv,
    PushOptions,
    TaskOptions,
    TwistEnv,
    TwistOptions,
    held_out_goals,
    judge,
)
from hydrostat.training.manipulation_env import ManipulationOptions  # noqa: E402
from hydrostat.training.manipulation_world import ManipulationWorld  # noqa: E402

pytestmark = pytest.mark.usefixtures("unchecked")
BALL = Obstacle(name="ball", shape="sphere", at=(0.12, 0.045), radius=0.015, mass=0.05, friction=0.5)
QUICK = ManipulationPhysics(seconds=0.1, beats=1, drag=20.0)


@pytest.fixture(scope="module")
def robot() -> Robot:
    """A strip that two cables bend, and a ball above it."""
    return replace(strip_robot(columns=8, rows=2), contact=Contact(distance=2e-3), obstacles=(BALL,))


@pytest.mark.parametrize(("name", "options"), [("Push", PushOptions), ("Twist", TwistOptions)])
def test_checkers_of_both_libraries_pass(robot: Robot, name: str, options: type[ManipulationOptions]) -> None:
    from gymnasium.utils.env_checker import check_env

    made = gymnasium.make(f"hydrostat/{name}-v0", robot=robot, options=options(steps=2, physics=QUICK, travel=2e-3))
    check_env(made.unwrapped, skip_render_check=True)
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="no stable-baselines3")
    checker.check_env(made.unwrapped)


def test_what_rolls_without_slip_turns_by_way_over_radius() -> None:
    """A pad goes by below a disc that cannot leave its place: the angle is the way over the radius."""
    mesh = strip_mesh(16, 1, size=(0.08, 0.01))
    radius = 0.012
    disc = Obstacle(name="disc", shape="sphere", at=(0.04, 0.005 + radius + 0.9e-3), radius=radius, mass=0.05)
    pad = Robot(
        name="pad",
        body=mesh_body(mesh, material=replace(FOAM, young=3e6)),
        pins=(Pin(box=((-1e-3, -6e-3), (0.081, -4e-3)), stiffness=1e6),),
        poses={},
        contact=Contact(distance=1e-3),
        obstacles=(replace(disc, friction=1.0),),
        gravity=(0.0, -9.81),
    )
    world = ManipulationWorld(pad, pad.obstacles[0], np.array([0.0, 0.0, 1.0]), ManipulationPhysics(hold=3e4, drag=2.0))
    simulation, way, motion = world.simulation, 0.0, world.motion
    for _ in range(6):
        way += 1e-3
        motion = simulation.step(motion, {}, 0.02, pin_shifts={0: np.array([way, 0.0])})
        world.follow(motion)
    assert world.place == pytest.approx(disc.at, abs=1e-4)
    assert world.turned == pytest.approx(way / (radius + 0.9e-3), rel=0.02)


def test_the_turn_is_that_about_the_axis_and_counts_on() -> None:
    """Beside rotations by hand: a disc beyond half a turn; a ball that swings besides."""
    from scipy.spatial.transform import Rotation

    from hydrostat.training.manipulation_world import angle_about

    axis = np.array([0.0, 0.6, 0.8])
    for angle in (-2.0, 0.3, 3.0):
        swing = Rotation.from_rotvec([0.4, 0.0, 0.0])  # across the axis
        turn = (swing * Rotation.from_rotvec(angle * axis)).as_matrix()
        assert angle_about(turn.T, np.eye(3), axis) == pytest.approx(angle)
        flat = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        assert angle_about(flat.T, np.eye(2), axis) == pytest.approx(angle)


def test_rewards_by_hand(robot: Robot) -> None:
    twist = TwistEnv(robot, options=TwistOptions(tolerance=np.deg2rad(10.0), physics=QUICK))
    achieved, desired = np.array([[0.25], [0.6], [0.48], [-0.6]]), np.array([[0.5], [0.5], [0.5], [-0.5]])
    assert twist.compute_reward(achieved, desired, {}) == pytest.approx([-4.5, 0.0, -0.36, 0.0])
    sparse = TwistEnv(robot, options=TwistOptions(tolerance=np.deg2rad(10.0), physics=QUICK, shaped=False))
    assert sparse.compute_reward(achieved, desired, {}) == pytest.approx([-1, 0, 0, 0])
    push = PushEnv(robot, options=PushOptions(tolerance=0.01, physics=QUICK))
    size = robot.body.mesh.size
    places = np.array([[0.03, 0.04], [0.003, 0.004]]) / size
    assert push.compute_reward(places, np.zeros((2, 2)), {}) == pytest.approx([-5.0, -0.5])
    assert push.compute_reward(places[0], np.zeros(2), {}) == pytest.approx(-5.0)


def test_a_strip_pushes_the_ball_away_and_time_steps_are_counted(robot: Robot) -> None:
    """Beside what is seen in the simulation: the ball is where the goal was put, within nothing."""
    options = PushOptions(steps=2, physics=ManipulationPhysics(seconds=0.2, beats=4, drag=20.0), travel=30e-3)
    env = PushEnv(robot, options=options)
    up, still = np.array([1.0, -1.0]), -np.ones(2)
    assert env.contractions(up) == pytest.approx([30e-3, -robot.winches[1].release])
    env.reset(options={"goal": [0.0, 0.0]})
    assert env.equilibria == 0
    observation, _, _, over, info = env.step(up)
    assert (env.equilibria, over) == (4, False)
    assert info["distance"] == pytest.approx(np.linalg.norm(env.world.place - BALL.at))
    assert info["distance"] > 2e-3
    observation, _reward, _, over, info = env.step(still)
    assert (env.equilibria, over) == (4 + 8, True)  # the keyframe, and that the hand opens
    goal = observation["achieved_goal"]
    left = judge(env, lambda seen: up if seen["observation"][-1] == 0 else still, [{"goal": goal}])
    assert left == pytest.approx([0.0], abs=1e-12)
    assert (env.equilibria, env.uncounted) == (24, 12)


def test_a_hand_that_does_not_open_has_achieved_nothing(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    env = PushEnv(robot, options=PushOptions(steps=1, physics=QUICK, travel=2e-3))
    begun, _ = env.reset(seed=0)
    monkeypatch.setattr(env.world, "go", lambda contractions: [])
    monkeypatch.setattr(type(env), "get_achieved", lambda env: np.ones(2))
    seen, reward, _, over, info = env.step(np.zeros(2))
    assert over
    assert seen["achieved_goal"] == pytest.approx(begun["achieved_goal"])
    assert reward == pytest.approx(-info["distance"] / env.tolerance)
    for wrong in (np.array([np.nan, 0.0]), np.zeros(3), "up"):
        with pytest.raises(InputError, match="an action has 2 numbers from -1 to 1, not"):
            env.step(wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="a goal has 2 numbers, not"):
        env.reset(options={"goal": (np.nan, 0.0)})


def test_each_episode_has_a_thing_of_its_own(robot: Robot) -> None:
    env = TwistEnv(robot, options=TwistOptions(physics=QUICK, friction=0.3, radius=0.05, start=5e-3))
    drawn = held_out_goals(env, 20, 3)
    assert drawn == held_out_goals(TwistEnv(robot, options=env.options), 20, 3)
    assert env.equilibria == 0
    for name, most in (("friction", 0.3), ("radius", 0.05)):
        off = np.array([each[name] for each in drawn]) - 1
        assert 0.5 * most < np.abs(off).max() <= most
    env.reset(options=drawn[0])
    obstacle = env.world.obstacle
    assert obstacle.friction == pytest.approx(0.5 * drawn[0]["friction"])
    assert obstacle.radius == pytest.approx(0.015 * drawn[0]["radius"])
    assert np.subtract(obstacle.at, BALL.at) == pytest.approx(drawn[0]["start"])
    env.reset(options={"goal": [0.5]})
    assert env.world.obstacle == BALL
    env.reset(seed=5)
    first = env.world.obstacle
    env.reset()
    assert env.world.obstacle != first
    env.reset(seed=5)
    assert env.world.obstacle == first
    other = TwistEnv(robot, options=env.options)
    env.step(np.array([0.0, 0.0]))
    other.go_on(env.get_state())
    assert other.get_state() == env.get_state()
    assert (other.equilibria, other.uncounted) == (1, 0)
    for each in (env, other):
        each.reset()
    assert other.world.obstacle == env.world.obstacle != first


def test_a_gripper_turns_its_disc() -> None:
    """Fingers that press, shorten and lift leave a turn; with no friction they leave none."""
    physics = ManipulationPhysics(beats=5, drag=DRAG)
    env = TwistEnv(
        flat_gripper(), options=TwistOptions(steps=3, tied=(" a", " b"), physics=physics), render_mode="rgb_array"
    )
    keys = np.array([(10, 0), (35, 25), (0, 25)]) / 22.5 - 1
    turned, info = [], dict[str, float]()
    for friction in (1.0, 0.0):
        env.reset(options={"goal": [0.5], "friction": friction})
        begun = env.render()
        for key in keys:
            info = env.step(key)[-1]
        turned.append(info["turned"])
        dot = np.array(env.world.visible_obstacles()[1].at) - env.world.place
        angle = np.arctan2(dot[1], dot[0])  # it began on the x axis
        assert angle == pytest.approx(info["turned"], abs=1e-6)
        assert (env.render() != begun).any()
    assert np.rad2deg(turned[0]) > 45
    assert abs(turned[1]) < 0.02


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"obstacle": replace(BALL, mass=None)}, '"ball" stands still: give it a mass'),
        ({"obstacle": replace(BALL, at=(0.12, 0.0))}, '"ball" begins in the body or touches it'),
        ({"obstacle": replace(BALL, at=(0.12, 0.0, 0.1))}, '"ball" has 3 coordinates, but the body has 2'),
        ({"options": TwistOptions(tied=("u", "up"))}, "a winch is tied to others once only"),
        ({"options": TwistOptions(tied=("left",))}, 'no winch name contains "left". Available: up, down'),
        ({"axis": (0, 0, 0)}, "the axis of turns must not be 0"),
    ],
)
def test_what_cannot_be_is_told(robot: Robot, given: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        TwistEnv(robot, **given)


def test_tasks_say_what_they_do_not_have(robot: Robot) -> None:
    with pytest.raises(InputError, match="has nothing to move: give an"):
        PushEnv(replace(robot, obstacles=()))
    with pytest.raises(InputError, match="this task has no pairs"):
        PushEnv.for_task(robot, TaskOptions(pairs=[["up", "down"]]))
    with pytest.raises(InputError, match="turns that are asked for go one way"):
        TwistOptions(turn=(-1.0, 1.0))
    with pytest.raises(InputError, match="friction is drawn within a share"):
        PushOptions(friction=1.0)
    made = TwistEnv.for_task(robot, TaskOptions(obstacle=replace(BALL, radius=0.01), friction=0.7, steps=7))
    assert (made.obstacle.radius, made.obstacle.friction, made.steps, made.cost) == (0.01, 0.7, 7, "time steps")
