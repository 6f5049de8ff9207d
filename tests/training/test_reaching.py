"""Environments in which robots reach. Oracles: the simulator, sums by hand, the checkers of those who use them."""

import json
import pickle
from copy import deepcopy
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot
from model_cards import model_card

from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Load, LoadDrive, Sensor, SensorKind
from hydrostat.simulation import SensorReader, Simulation

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from hydrostat.arrays import Vector  # noqa: E402
from hydrostat.training import (  # noqa: E402
    CurvePoint,
    Listener,
    ReachEnv,
    ReachOptions,
    TrainMethod,
    TrainOptions,
    held_out_goals,
    judge,
    policy_of,
    portable_policy,
    train,
)
from hydrostat.training.backends import Backend, ExactBackend, LearnedBackend, MixedBackend  # noqa: E402

Goals = list[dict[str, Any]]


def test_observations_hold_readings() -> None:
    """Oracle: the reader, at the contractions of the action; a robot without sensors is refused."""
    robot = gallery_robot("starfish")
    marker = robot.markers[0].at
    sensed = replace(robot, sensors=(Sensor(name="tilt", kind=SensorKind.ORIENTATION, at=marker),))
    env = ReachEnv(sensed, options=ReachOptions(sensors=True))
    seen, _ = env.reset(seed=1)
    assert env.observation_space.contains(seen)
    assert seen["sensors"] == pytest.approx([0.0], abs=1e-9)
    action = np.full(len(robot.winches), 0.3)
    seen, *_ = env.step(action)
    simulation = Simulation(sensed)
    assert seen["sensors"] == SensorReader(simulation).read_vector(simulation.solve(env.contractions(action)))
    assert not env.portable
    with pytest.raises(InputError, match="no sensors"):
        ReachEnv(robot, options=ReachOptions(sensors=True))


def test_drives_are_actions_too() -> None:
    """Oracle: the simulator at the share that an action means."""
    robot = gallery_robot("starfish")
    push = Load(name="push", marker="left", force=(0.0, -0.3), drive="thumb")
    env = ReachEnv(replace(robot, loads=(push,), drives=(LoadDrive(name="thumb", min=-1.0, max=2.0),)))
    env.reset(seed=1)
    action = np.r_[np.full(len(robot.winches), 0.2), 0.9]
    assert env.contractions(action)[-1] == pytest.approx(-1.0 + 1.5 * (1 + 1.02 * 0.9))
    seen, *_ = env.step(action)
    pose = Simulation(env.robot).solve(env.contractions(action))
    assert env.rest + env.unit * seen["achieved_goal"] == pytest.approx(np.ravel(list(pose.markers.values())))


class Straight(LearnedBackend):
    """Markers go with winches along straight lines."""

    def __init__(self, env_robot: object = None) -> None:
        robot = gallery_robot("starfish")
        self.rest = np.array([marker.at for marker in robot.markers]).ravel()
        self.matrix = np.random.default_rng(0).normal(size=(len(self.rest), len(robot.winches)))

    def reach(self, contractions: Vector) -> Vector:
        return self.rest + self.matrix @ contractions


def straight(**options: object) -> ReachEnv:
    return ReachEnv(gallery_robot("starfish"), backend=Straight(), options=ReachOptions(**options))


@pytest.mark.parametrize("incremental", [False, True])
def test_checkers_of_both_libraries_pass(incremental: bool) -> None:
    from gymnasium.utils.env_checker import check_env

    made = gymnasium.make(
        "hydrostat/Reach-v0",
        robot=gallery_robot("starfish"),
        backend=Straight(),
        options=ReachOptions(steps=5, incremental=incremental),
    )
    check_env(made.unwrapped)
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="no stable-baselines3")
    checker.check_env(made.unwrapped)


def test_the_example_in_the_docs_runs() -> None:
    """Oracle: the text of docs/theory/reinforcement.md, line by line."""
    page = Path(__file__).parents[2] / "docs" / "theory" / "reinforcement.md"
    example = page.read_text().split("```python")[1].split("```")[0]
    names: dict[str, Any] = {}
    exec(example, names)
    assert set(names["seen"]) == {"observation", "achieved_goal", "desired_goal"}
    assert names["env"].observation_space.contains(names["seen"])


def test_exact_episodes_are_equilibria_and_are_counted() -> None:
    robot = gallery_robot("starfish")
    env = ReachEnv(robot, options=ReachOptions(steps=2))
    observation, _ = env.reset(seed=4)
    assert env.backend.equilibria == 1  # of the goal
    action = np.array([0.3, -0.5, 0.1])
    observation, _, _, over, _ = env.step(action)
    high, low = (np.array([getattr(winch, name) for winch in robot.winches]) for name in ("travel", "release"))
    pose = Simulation(robot).solve(-low + 0.5 * (1.02 * action + 1.0) * (high + low))
    places = env.unit * observation["achieved_goal"] + env.rest[env.seen]
    assert places == pytest.approx(np.array(list(pose.markers.values())).ravel(), abs=1e-9)
    assert (env.backend.equilibria, over) == (2, False)
    assert env.step(action)[3]


def test_rewards_and_distances_by_hand() -> None:
    env = straight(tolerance=0.01)
    count = len(env.seen)
    near, far = np.zeros(count), np.zeros(count)
    far[0], far[1] = 0.03 / env.unit, 0.04 / env.unit  # one of several markers is 50 mm away
    mean = 0.05 / (count / 2)
    both = np.array([near, far])
    assert env.distances(both, np.zeros((2, count))) == pytest.approx([0.0, mean])
    assert env.compute_reward(both, np.zeros((2, count)), [{}, {}]) == pytest.approx([0.0, -mean / 0.01])
    sparse = straight(tolerance=mean * 1.01, shaped=False)
    assert sparse.compute_reward(both, np.zeros((2, count)), [{}, {}]).tolist() == [0.0, 0.0]
    sparse = straight(tolerance=mean * 0.99, shaped=False)
    assert sparse.compute_reward(both, np.zeros((2, count)), [{}, {}]).tolist() == [0.0, -1.0]


def test_pairs_move_one_of_two_winches_and_increments_add_up() -> None:
    robot = gallery_robot("starfish")
    names, travel = [winch.name for winch in robot.winches], [winch.travel for winch in robot.winches]
    env = straight(pairs=[names[:2]])
    assert env.action_space.shape == (2,)
    assert env.contractions(np.array([0.5, -1.0])) == pytest.approx([0.51 * travel[0], 0.0, -robot.winches[2].release])
    assert env.contractions(np.array([-0.5, 1.0])) == pytest.approx([0.0, 0.51 * travel[1], travel[2]])
    env = straight(steps=3, incremental=True)
    env.reset(seed=0)
    for _ in range(3):
        observation = env.step(np.array([1.0, 0.5, -1.0]))[0]
    begin = np.array([2 * winch.release / (winch.travel + winch.release) - 1 for winch in robot.winches])
    assert observation["observation"] == pytest.approx(np.clip(begin + np.array([0.6, 0.3, -0.6]), -1, 1))


@pytest.mark.usefixtures("unchecked")
def test_pictures_show_robot_and_goal_in_one_frame() -> None:
    """On white paper, of one size whatever the pose; another goal is another picture, and crosses are dark.

    The pixels that a goal changes are near to where it is: no more than a tenth of the picture.
    """
    robot = gallery_robot("starfish")
    name = robot.markers[0].name
    options = ReachOptions(steps=2, markers=[name])
    env = ReachEnv(robot, backend=Straight(), options=options, render_mode="rgb_array")
    shown = []
    for goal in (env.rest[:2], env.rest[:2] + 0.01):
        env.reset(options={"goal": goal})
        shown.append(env.render())
    env.step(np.full(3, 0.5))
    shown.append(deepcopy(env).render())
    assert {(picture.shape, picture.dtype.name) for picture in shown} == {(shown[0].shape, "uint8")}
    assert all((picture[0, 0] == 255).all() for picture in shown)
    assert all(picture.mean() > 200 for picture in shown)
    body = slice(60, None)  # below the words
    other = (shown[0][body] != shown[1][body]).any(axis=2)
    assert 0 < other.mean() < 0.1
    assert shown[1][body][other].min() < 60
    assert (shown[2][body] != shown[1][body]).any(axis=2).mean() > 0.02
    assert straight().render() is None


def test_markers_that_are_not_asked_for_are_not_looked_at() -> None:
    robot = gallery_robot("starfish")
    env = straight(markers=[robot.markers[1].name])
    assert env.seen.tolist() == [2, 3]
    assert env.reset(seed=0)[0]["desired_goal"].shape == (2,)


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"steps": 0}, "steps must be 1 or more"),
        ({"tolerance": 0.0}, "tolerance must be above 0"),
        ({"steps": 1.5}, "steps must be 1 or more, not 1.5"),
        ({"tolerance": "5 mm"}, "tolerance must be a number, not '5 mm'"),
        ({"markers": "top"}, 'markers must be a list of names, such as ."tip"., not .top.'),
        ({"markers": ["nose"]}, 'unknown marker "nose"'),
        ({"pairs": [["a", "b"]]}, 'unknown winch "a"'),
        ({"pairs": [["left"]]}, "a pair has two winches"),
    ],
)
def test_what_is_wrong_is_told(options: dict, told: str) -> None:
    with pytest.raises(InputError, match=told):
        straight(**options)


def test_a_mixed_world_counts_exact_episodes_only() -> None:
    exact = ExactBackend(gallery_robot("starfish"))
    backend: Backend = MixedBackend(Straight(), exact, every=3)
    for _ in range(7):
        backend.begin()
        backend.reach(np.zeros(3))
    assert backend.equilibria == 3


@pytest.fixture
def goals() -> Goals:
    return held_out_goals(straight(), 20, 0)


def test_judging_costs_no_equilibria(goals: Goals) -> None:
    env = straight()
    env.backend.equilibria = 0
    left = judge(env, lambda seen: np.zeros(3), goals)
    middle = Straight().reach(env.contractions(np.zeros(3)))
    by_hand = [np.linalg.norm((middle - goal["goal"]).reshape(-1, 2), axis=1).mean() for goal in goals]
    assert left == pytest.approx(by_hand)


QUIET = pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")


@pytest.mark.slow
@QUIET
def test_it_learns_and_a_run_that_was_killed_goes_on_the_same_way(goals: Goals, tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")

    def run(steps: int, out: str, *, resume: bool = False) -> list:
        options = TrainOptions(
            method=TrainMethod.SAC, steps=steps, eval_interval=152, layers=(32, 32), batch=64, learning_rate=3e-3
        )
        return train(straight(), goals, options, tmp_path / out, resume=resume)[1]

    whole = run(456, "whole")
    assert whole[-1].mean < 0.95 * judge(straight(), lambda seen: np.zeros(3), goals).mean()
    run(304, "broken")
    (tmp_path / "broken" / "checkpoint-456").mkdir()  # it was killed while it wrote the next
    assert run(456, "broken", resume=True) == whole
    assert [path.name for path in (tmp_path / "broken").glob("checkpoint-*")] == ["checkpoint-456"]


@pytest.mark.slow  # six processes begin
@QUIET
def test_the_curve_is_the_same_whoever_works(goals: Goals, tmp_path: Path) -> None:
    """Episodes of three actions, four side by side, exact in every third: by one process, four, and one, then two.

    Equilibria are counted in all of them: of a goal and three actions for each exact episode.
    """
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")

    def run(processes: int, out: str, steps: int = 120, *, resume: bool = False) -> list:
        robot = gallery_robot("starfish")
        backend = MixedBackend(Straight(), ExactBackend(robot), every=3)
        env = ReachEnv(robot, backend=backend, options=ReachOptions(steps=3))
        options = TrainOptions(method=TrainMethod.DDPG, steps=steps, eval_interval=50, layers=(8,), batch=16)
        more = {"resume": resume, "processes": processes, "judge_in": straight(steps=3)}
        return train(env, goals, options, tmp_path / out, **more)[1]  # type: ignore[arg-type]

    curve = run(1, "one")
    assert [point.steps for point in curve] == [60, 120]
    assert len({point.mean for point in curve}) == 2
    assert curve[0].equilibria == 4 * 4 * 2  # five whole episodes and the beginning of a sixth: exact are 0 and 3
    assert run(4, "four") == curve
    run(1, "broken", 60)
    assert run(2, "broken", resume=True) == curve


@pytest.mark.slow  # a process begins
def test_a_process_that_dies_is_told_and_none_is_left_over() -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    from multiprocessing import active_children

    from hydrostat.training.side_by_side import SideBySide

    others = set(active_children())  # of tests before
    copies = SideBySide(straight(steps=2), 2, processes=2)
    try:
        copies.reset()
        seen = copies.step(np.zeros((2, 3)))[0]
        assert {name: rows.shape for name, rows in seen.items()} == {
            "observation": (2, 3),
            "achieved_goal": (2, len(straight().seen)),
            "desired_goal": (2, len(straight().seen)),
        }
        dead = (set(active_children()) - others).pop()
        dead.kill()
        dead.join()
        with pytest.raises(HydrostatError, match="a process that solves for poses has died"):
            copies.step(np.zeros((2, 3)))
    finally:
        copies.close()
    assert set(active_children()) <= others


def test_what_does_not_fit_a_checkpoint_is_told(goals: Goals, tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    with pytest.raises(InputError, match="processes must be 1 to 4"):
        train(straight(), goals, TrainOptions(), tmp_path, processes=5)
    with pytest.raises(InputError, match="no checkpoint to resume from"):
        train(straight(), goals, TrainOptions(), tmp_path, resume=True)
    (tmp_path / "before" / "checkpoint-4").mkdir(parents=True)
    with pytest.raises(InputError, match="before: holds a run already; go on with --resume, or name another folder"):
        train(straight(), goals, TrainOptions(), tmp_path / "before")
    (tmp_path / "curve.json").write_text('{"options": {"method": "ddpg-her"}, "curve": []}')
    with pytest.raises(InputError, match="begun with method = ddpg-her, not sac-her"):
        train(straight(), goals, TrainOptions(), tmp_path, resume=True)
    (tmp_path / "curve.json").write_text("{")
    with pytest.raises(InputError, match=r"curve.json: is missing or damaged; begin again, without --resume"):
        train(straight(), goals, TrainOptions(), tmp_path, resume=True)
    point = CurvePoint(steps=4, equilibria=8, mean=0.0, median=0.0, worst=0.0, success=0.0)
    told = asdict(TrainOptions())
    before = {"learning_rate": "rate", "eval_interval": "every", "num_envs": "together"}  # names of earlier versions
    told = {before.get(name, name): value for name, value in told.items()}
    whole = json.dumps({"options": told, "curve": [asdict(point)]})
    (tmp_path / "curve.json").write_text(whole)
    (tmp_path / "checkpoint-4").mkdir()
    (tmp_path / "checkpoint-4" / "weights.pt").write_bytes(b"PK half of it")
    with pytest.raises(InputError, match=r"checkpoint-4: is missing or damaged; begin again"):
        train(straight(), goals, TrainOptions(), tmp_path, resume=True)


class Forged:
    """What writes a file where it is unpickled."""

    def __init__(self, path: Path) -> None:
        """The file."""
        self.path = path

    def __reduce__(self) -> tuple:
        return Path.touch, (self.path,)


@QUIET
def test_a_checkpoint_of_a_stranger_runs_no_code(goals: Goals, tmp_path: Path) -> None:
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    options = TrainOptions(steps=8, layers=(4,), batch=4)
    train(straight(), goals[:1], options, tmp_path)
    (folder,) = tmp_path.glob("checkpoint-*")
    forged, ran = Forged(tmp_path / "ran"), tmp_path / "ran"
    for name in ("weights.pt", "experience.npz", "state.json", "state.pkl"):
        before = (folder / name).read_bytes() if name != "state.pkl" else b""
        if name == "weights.pt":
            torch.save(forged, folder / name)
        elif name == "experience.npz":
            np.savez(folder / name, ep_start=np.array([forged], dtype=object))
        else:
            (folder / name).write_bytes(pickle.dumps(forged))
        with pytest.raises(InputError, match=r"damaged; begin again|could run code and is not read"):
            train(straight(), goals[:1], replace(options, steps=16), tmp_path, resume=True)
        assert not ran.exists()
        (folder / name).write_bytes(before)
    pickle.loads(pickle.dumps(forged))
    assert ran.exists()  # it would have


@QUIET
@pytest.mark.parametrize("method", ["SAC", "DDPG", "TQC"])
def test_a_policy_runs_without_torch_and_answers_the_same(method: str, goals: Goals, tmp_path: Path) -> None:
    name = "sb3_contrib" if method == "TQC" else "stable_baselines3"
    library = pytest.importorskip(name, reason=f"{name} is not installed")
    from hydrostat.learning import LearnedModel, Perceptrons, PortablePolicy

    env, random = straight(), np.random.default_rng(5)
    count = len(env.seen)
    trained = getattr(library, method)("MultiInputPolicy", env, seed=3, device="cpu", policy_kwargs=silu())
    nothing = Perceptrons(sizes=np.array([3, count]), numbers=np.zeros((1, 3 * count * 2 + count)))
    model = LearnedModel(
        card=model_card(env.robot, pairs=[[w.name for w in env.robot.winches[:2]]]),  # which the policy does not know
        low=np.array([-winch.release for winch in env.robot.winches]),
        high=np.array([winch.travel for winch in env.robot.winches]),
        middle=env.rest[env.seen] + 0.01 * random.normal(size=count),
        unit=0.01 * random.uniform(0.5, 2.0, count),
        forward=nothing,
        inverse=None,
        known=np.zeros((1, 3)),
        reached=np.zeros((1, count)),
    )
    alone = portable_policy(trained, env, model)
    policy = PortablePolicy.load(policy_of(trained, env, task="reach", error=0.01).save(tmp_path / "actor.policy"))
    for goal in goals[:5]:
        observation, _ = env.reset(options=goal)
        action = trained.predict(observation, deterministic=True)[0]
        assert alone.predict_inverse(goal["goal"]) == pytest.approx(env.contractions(action), abs=1e-7)
        assert policy.act(observation) == pytest.approx(action, abs=1e-6)  # kept in float32
    with pytest.raises(InputError, match="the policy must see 10 finite numbers of achieved_goal"):
        policy.act({**observation, "achieved_goal": np.full(10, np.nan)})


@QUIET
def test_tensorboard_reads_what_the_curve_says_and_how_far_it_is_is_told(goals: Goals, tmp_path: Path) -> None:
    pytest.importorskip("sb3_contrib", reason="sb3-contrib is not installed")
    reader = pytest.importorskip("tensorboard.backend.event_processing.event_accumulator", reason="no tensorboard")
    options = TrainOptions(method=TrainMethod.TQC, steps=60, eval_interval=30, layers=(8,), batch=16)
    heard: list[tuple[str, int, int]] = []
    listener = Listener(progress=lambda *words: heard.append(words))
    curve = train(straight(), goals, options, tmp_path, listener=listener)[1]
    assert [words for words in heard if words[0] == "actions"][::5] == [("actions", n, 60) for n in (4, 24, 44)]
    assert [done for stage, done, _ in heard if stage == "judged by unseen goals"] == 2 * list(range(len(goals)))
    found = {}
    for file in tmp_path.glob("tensorboard/*/events*"):
        events = reader.EventAccumulator(str(file)).Reload()
        found |= {event.step: event.value for event in events.Scalars("unseen goals/mean")}
    assert found == pytest.approx({point.steps: point.mean for point in curve})


def silu() -> dict:
    import torch

    return {"net_arch": [16, 16], "activation_fn": torch.nn.SiLU}
