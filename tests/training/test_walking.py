"""A robot that walks. Oracles: the simulator step by step, Newton's laws, a turn by hand, the checkers of others."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import FOAM, gallery_robot, mesh_body, strip_mesh
from PIL import Image

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.learning import physics_hash
from hydrostat.robot import Cable, Marker, Obstacle, Robot, Winch
from hydrostat.simulation import Simulation, StepOptions

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from hydrostat.training import TaskOptions, WalkOptions, held_out_goals, judge  # noqa: E402
from hydrostat.training.ground import standing, tilt, with_friction  # noqa: E402
from hydrostat.training.walk_env import (  # noqa: E402
    Gait,
    GaitClock,
    WalkEnv,
)

LENGTH, HEIGHT = 0.16, 0.04
CONTRACTIONS = WalkOptions(actions="contractions", steps=2)
pytestmark = pytest.mark.usefixtures("unchecked")


def slab(*, lean: float = 0.0, size: tuple[float, float] = (LENGTH, HEIGHT)) -> Robot:
    """A slab of foam with a cable along its lower face, which arches it; its upper side may lean [m]."""
    mesh = strip_mesh(6, 2, size=size)
    share = mesh.nodes[:, 1] / size[1]
    nodes = mesh.nodes + np.column_stack([lean * share, np.zeros(len(share))])
    low = -0.3 * size[1]
    stops = [(float(x) + lean * -0.3, low) for x in np.linspace(0.1, 0.9, 5) * size[0]]
    return Robot(
        name="slab",
        body=mesh_body(Mesh(nodes, mesh.elements), material=replace(FOAM, viscosity=400.0)),
        pins=(),
        poses={},
        gravity="-y",
        obstacles=(Obstacle(name="table", shape="plane", at=(0.0, -0.5 * size[1] - 5e-4), normal=(0.0, 2.0)),),
        winches=(Winch(name="belly", at=stops[0], travel=0.03),),
        cables=(Cable(winch="belly", points=tuple(stops)),),
        markers=(Marker(name="front", at=(0.95 * size[0], 0.0)),),
    )


@pytest.mark.parametrize("actions", ["gait", "contractions"])
def test_checkers_of_both_libraries_pass(actions: str) -> None:
    from gymnasium.utils.env_checker import check_env

    options = WalkOptions(actions=actions, steps=2)
    made = gymnasium.make("hydrostat/Walk-v0", robot=slab(), options=options)
    made.unwrapped.beat = 1  # time step of an action: what is checked does not depend on it
    check_env(made.unwrapped, skip_render_check=True)
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="no stable-baselines3")
    checker.check_env(made.unwrapped)


def test_an_action_is_time_steps_of_the_simulator_and_each_is_counted() -> None:
    """Contractions go evenly, a fifth in each of five steps; the way is that of the middle of mass."""
    env, robot = WalkEnv(slab(), options=CONTRACTIONS), slab()
    env.reset(options={"goal": [0.05], "friction": 0.5})
    seen, reward, _, over, info = env.step(np.array([0.2]))
    simulation = Simulation(with_friction(standing(robot, None), 0.5))
    motion, end = simulation.motion_at_rest(), 0.6 * 0.5 * robot.winches[0].travel
    for step in range(1, 6):
        motion = simulation.step(motion, [end * step / 5], 0.02, options=StepOptions(scheme="euler"))
    masses = simulation.body.masses
    middle = masses @ (motion.nodes - robot.body.mesh.nodes) / masses.sum()
    place = motion.markers["front"] - robot.markers[0].at - middle
    assert seen["observation"][:3] == pytest.approx([0.2, *(place / env.unit)], abs=1e-8)
    assert seen["achieved_goal"] == pytest.approx([middle[0] / env.unit, 0.0], abs=1e-9)
    assert seen["desired_goal"] == pytest.approx([0.05 / env.unit, 0.0])
    assert (info["distance"], reward) == (pytest.approx(0.05 - middle[0]), pytest.approx(-(0.05 - middle[0]) / 0.02))
    assert (env.equilibria, env.cost, over, info["fallen"]) == (5, "time steps", False, False)
    assert env.step(np.array([0.2]))[3]
    assert env.equilibria == 10


def test_without_friction_nothing_goes_anywhere() -> None:
    """Newton's third law: nothing pushes along the ground, whatever a slab that is not symmetrical does."""
    ways = []
    for friction in (0.0, 0.6):
        env = WalkEnv(slab(lean=0.04), options=replace(CONTRACTIONS, steps=3))
        env.reset(options={"goal": [0.1], "friction": friction})
        ways.append([env.step(np.array([size]))[4]["way"] for size in (1.0, -1.0, 0.5)])
    assert ways[0] == pytest.approx([0.0] * 3, abs=1e-6)
    assert np.abs(ways[1]).max() > 1e-3


def test_a_fall_ends_reward_and_costs() -> None:
    """A tower that leans out over its foot falls, as its middle of mass is not above it."""
    env = WalkEnv(slab(lean=0.1, size=(0.05, 0.12)), options=replace(CONTRACTIONS, steps=8))
    env.reset(options={"goal": [0.05], "friction": 0.6})
    told = [env.step(np.array([-1.0])) for _ in range(8)]
    fell = next(number for number, each in enumerate(told) if each[4]["fallen"])
    made = env.equilibria
    assert 0 < fell < 7
    assert 5 * fell < made <= 5 * (fell + 1)
    assert [each[4]["fallen"] for each in told[fell:]] == [True] * (8 - fell)
    assert told[-1][0]["achieved_goal"][1] == 1.0
    assert told[-1][4]["distance"] == pytest.approx(abs(told[-1][4]["way"] - 0.05) + env.unit)
    assert told[-1][1] == told[fell][1] == pytest.approx(-told[-1][4]["distance"] / 0.02)
    assert not told[-1][4]["is_success"]


@pytest.mark.parametrize("dim", [2, 3])
def test_a_turn_is_a_tilt_by_its_angle_and_a_way_or_a_stretch_is_none(dim: int) -> None:
    random = np.random.default_rng(2)
    rest, masses = random.normal(size=(9, dim)), random.uniform(0.5, 2.0, 9)
    angle = 0.3
    turn = np.eye(dim)
    turn[np.ix_([0, -1], [0, -1])] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    assert tilt(masses, rest, rest @ turn.T + 3.0) == pytest.approx(angle)
    assert tilt(masses, rest, 1.3 * rest) == pytest.approx(0.0, abs=1e-6)
    if dim == 3:  # a turn about what is up
        about = np.eye(3)
        about[:2, :2] = turn[::2, ::2]
        assert tilt(masses, rest, rest @ about.T) == pytest.approx(0.0, abs=1e-6)


def test_gaits_are_raised_cosines_and_go_on_without_a_jump() -> None:
    most, gait = 0.03, Gait(amplitude=0.024, lag=0.35, period=0.8)
    again = Gait.of_action(gait.action(most), most)
    assert [again.amplitude, again.lag, again.period] == pytest.approx([0.024, 0.35, 0.8])
    clock, order = GaitClock(3, most), np.arange(3)
    first = np.array([clock.after(gait, 0.02) for _ in range(80)])
    times = 0.02 * np.arange(1, 81)[:, None]
    size = np.minimum(most * times / 0.8, 0.024)
    assert first == pytest.approx(size * 0.5 * (1 - np.cos(2 * np.pi * (times / 0.8 - 0.35 * order))))
    other = Gait(amplitude=0.01, lag=-0.2, period=0.5)
    then = np.array([first[-1], *(clock.after(other, 0.02) for _ in range(100))])
    fastest = np.pi * 0.024 / 0.5 + most / 0.5 + np.pi * 0.024 * 0.5 * 2 / 0.5  # of phase, amplitude and lag
    assert np.abs(np.diff(then, axis=0)).max() < fastest * 0.02
    assert (clock.amplitude, clock.lag) == (pytest.approx(0.01), pytest.approx(-0.2))


def test_rewards_by_hand() -> None:
    env = WalkEnv(slab(), options=replace(CONTRACTIONS, tolerance=0.01))
    achieved = np.array([[0.25, 0.0], [0.25, 1.0], [0.5, 0.0]])
    desired = np.array([[0.5, 0.0], [0.5, 0.0], [0.5, 0.0]])
    far = env.unit * np.array([0.25, 1.25, 0.0])
    assert env.distances(achieved, desired) == pytest.approx(far)
    assert env.compute_reward(achieved, desired, [{}] * 3) == pytest.approx(-far / 0.01)
    assert env.compute_reward(achieved[0], desired[0], {}) == pytest.approx(-far[0] / 0.01)
    sparse = WalkEnv(slab(), options=replace(CONTRACTIONS, shaped=False))
    assert sparse.compute_reward(achieved, desired, [{}] * 3).tolist() == [-1.0, -1.0, 0.0]


def test_held_out_episodes_are_the_same_each_time_and_cost_nothing() -> None:
    env = WalkEnv(slab(), friction=0.5, options=CONTRACTIONS)
    drawn = held_out_goals(env, 40, 3)
    assert drawn == held_out_goals(WalkEnv(slab(), friction=0.5, options=CONTRACTIONS), 40, 3)
    friction, ways = np.array([each["friction"] for each in drawn]), np.array([each["goal"] for each in drawn])
    assert friction.min() == pytest.approx(0.365, abs=0.015)  # of 0.35 to 0.65
    assert friction.max() == pytest.approx(0.635, abs=0.015)
    longest = 0.1 * env.unit * 0.2
    assert 0 <= ways.min() < 0.1 * longest < 0.9 * longest < ways.max() <= longest
    left = judge(env, lambda _: np.array([0.3]), drawn[:2])
    assert judge(env, lambda _: np.array([0.3]), drawn[:2]).tolist() == left.tolist()
    assert env.equilibria == env.uncounted == 2 * 2 * 10
    other = WalkEnv(slab(), friction=0.5, options=CONTRACTIONS)
    other.reset(seed=1)
    other.go_on(env.get_state())
    assert (other.equilibria, other.uncounted) == (40, 40)


def test_the_eye_goes_with_the_robot_and_the_ground_goes_by() -> None:
    env = WalkEnv(slab(), options=CONTRACTIONS, render_mode="rgb_array")
    assert env.render() is None
    env.reset(options={"goal": [0.1], "friction": 0.6})
    shown = [env.render()]
    assert env.motion is not None
    for way in (0.1 * env.unit, 0.13 * env.unit):  # by one mark, and by a share of one more
        env.motion = replace(env.motion, nodes=slab().body.mesh.nodes + np.array([way, 0.0]))
        shown.append(env.render())
    body = [picture[60:].astype(int) for picture in shown]  # below the words
    assert np.abs(body[1] - body[0]).max() < 60  # no more than rounding
    assert 0 < (np.abs(body[2] - body[0]).max(axis=2) > 60).mean() < 0.05


def test_a_human_sees_what_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a page of this machine, after each reset and step; copies that learn show nothing."""
    from urllib.request import urlopen

    from hydrostat.training.env_copies import EnvCopies

    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    drawn = {"goal": [0.1], "friction": 0.6}
    made = gymnasium.make("hydrostat/Walk-v0", robot=slab(), options=CONTRACTIONS, render_mode="human")
    made.reset(options=drawn)
    made.step(np.array([0.5], np.float32))
    env = made.unwrapped
    assert (made.render(), opened) == (None, [env.page.address])
    with urlopen(f"{env.page.address}picture?after=1") as answer:
        assert answer.headers["x-number"] == "2"
        shown = np.asarray(Image.open(answer))
    assert (shown == env.picture()).all()
    EnvCopies(env, 1).ask("reset", [0])
    assert len(opened) == 1
    made.close()


def test_the_gallery_s_puppy_is_put_on_the_ground() -> None:
    robot = gallery_robot("puppy")
    made = standing(robot, 0.4)
    low = robot.body.mesh.nodes[:, 1].min()
    assert (made.pins, made.gravity, made.body.material.viscosity) == ((), (0.0, -9.80665), 400.0)
    assert [(obstacle.at, obstacle.friction) for obstacle in made.obstacles] == [
        ((0.0, pytest.approx(low - 1e-3)), 0.4)
    ]
    assert physics_hash(made) != physics_hash(robot)  # it can be written, as policies are kept with what they are of
    own = standing(slab(), None)  # what robot.toml says stays
    assert [(obstacle.name, obstacle.friction) for obstacle in own.obstacles] == [("table", 0.6)]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"actions": "steps"}, "actions must be one of gait, contractions"),
        ({"incremental": True}, "a gait is not incremental"),
        ({"steps": 0}, "steps must be 1 or more"),
        ({"spread": 1.0}, "spread must be from 0 to below 1"),
        ({"tolerance": 0.0}, "tolerance must be above 0"),
        ({"speed": -1.0}, "speed must be above 0"),
    ],
)
def test_options_that_cannot_be_are_told(given: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        WalkOptions(**given)


def test_what_does_not_fit_the_task_is_told() -> None:
    with pytest.raises(InputError, match="this task has no markers"):
        WalkEnv.for_task(slab(), TaskOptions(markers=["front"]))
    with pytest.raises(InputError, match="friction must be 0 or more"):
        WalkEnv(slab(), friction=-0.1)
    with pytest.raises(InputError, match="needs a winch"):
        WalkEnv(slab().with_network((), ()))
    slope = Obstacle(name="slope", shape="plane", at=(0.0, -0.1), normal=(0.3, 1.0))
    with pytest.raises(InputError, match='obstacle "slope" is not level'):
        WalkEnv(replace(slab(), obstacles=(slope,)))
    made = WalkEnv.for_task(slab(), TaskOptions(actions="contractions", incremental=True, steps=3, friction=0.7))
    assert (made.steps, made.options.incremental, made.friction, made.portable) == (3, True, 0.7, False)
    with pytest.raises(InputError, match=r"a goal has 1 way \[m\], not"):
        made.reset(options={"goal": [0.1, 0.2]})
