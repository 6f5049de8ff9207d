"""Our method in tasks of others. Oracles: an environment whose places are sums of actions, numbers made by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
gymnasium = pytest.importorskip("gymnasium")

from hydrostat.errors import HydrostatError  # noqa: E402
from hydrostat_lab import reference as room  # noqa: E402
from hydrostat_lab import reproduce_reference as command  # noqa: E402
from hydrostat_lab.experiments import Ran  # noqa: E402
from hydrostat_lab.hindsight_ddpg import DdpgOptions, Epochs, HindsightDdpg  # noqa: E402
from hydrostat_lab.reference import REFERENCES, none_missed_from  # noqa: E402
from hydrostat_lab.trials import GymnasiumTrials, robotics_task  # noqa: E402

pytestmark = pytest.mark.usefixtures("unchecked")


class Walk(gymnasium.Env):
    """A point in the plane that goes on by a tenth of each action; it has a state of its own, as simulators have."""

    observation_space = gymnasium.spaces.Dict(
        {name: gymnasium.spaces.Box(-9, 9, (2,)) for name in ("observation", "achieved_goal", "desired_goal")}
    )
    action_space = gymnasium.spaces.Box(-1, 1, (2,))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at, self.goal = np.zeros(2), 0.3 * self.np_random.uniform(-1, 1, 2)
        return self.seen(), {}

    def step(self, action):
        self.at = self.at + 0.1 * action
        return self.seen(), 0.0, False, False, {}

    def seen(self):
        return {"observation": 2 * self.at, "achieved_goal": self.at, "desired_goal": self.goal}


def test_each_episode_has_a_copy_of_its_own() -> None:
    trials, draw = GymnasiumTrials(Walk, horizon=3), torch.Generator().manual_seed(0)
    assert (trials.states, trials.goals, trials.actions, trials.horizon) == (2, 2, 2, 3)
    states, reached, goals = trials.begin(draw, (2, 3))
    assert not states.any()
    assert not reached.any()
    assert len(np.unique(goals.numpy().reshape(6, 2), axis=0)) == 6
    acts = torch.linspace(-1, 1, 12).reshape(2, 3, 2)
    trials.act(acts)
    states, reached = trials.act(acts)
    np.testing.assert_allclose(reached.numpy(), 0.2 * acts.numpy(), atol=1e-6)
    np.testing.assert_allclose(states.numpy(), 0.4 * acts.numpy(), atol=1e-6)
    far = trials.distances(torch.tensor([[[3.0, 4.0]]]), torch.zeros(1, 1, 2))
    assert far.tolist() == [[5.0]]


def test_tests_are_the_same_for_every_seed_and_move_apart() -> None:
    trials = GymnasiumTrials(Walk, horizon=2)
    _, _, goals = trials.begin_alike(torch.Generator().manual_seed(3), (3, 4))
    assert (goals == goals[:1]).all()
    _, reached = trials.act(torch.ones(3, 4, 2) * torch.tensor([0.0, 0.5, 1.0])[:, None, None])
    np.testing.assert_allclose(reached[:, 0, 0].numpy(), [0.0, 0.05, 0.1], atol=1e-6)


@pytest.mark.slow
def test_it_learns_to_walk_with_sparse_rewards() -> None:
    """An untrained policy is 0.2 away, at random; hindsight brings most seeds to within 0.05 in most tests."""
    options = DdpgOptions(layers=(32, 32), tolerance=0.05, cycles=10, actions=20, updates=20, batch=64)
    learner = HindsightDdpg(GymnasiumTrials(Walk, horizon=5), options, seeds=2, epochs=8)
    done = learner.learn(tests=20)
    assert done.actions.tolist() == [200 * count for count in range(1, 9)]
    assert done.success[-3:].mean() > 0.8
    assert done.success[0].mean() < 0.8


@pytest.mark.parametrize(("last", "wanted"), [(1.0, 15), (0.95, np.inf)])
def test_when_no_seed_misses_a_test_any_more(last: float, wanted: float) -> None:
    success = np.array([[1.0, 1.0], [1.0, 0.6], [1.0, 1.0], [last, 1.0]])
    epochs = Epochs(actions=np.array([5, 10, 15, 20]), success=success, distance=success, tolerance=success)
    run = REFERENCES["figure-5.13"].experiment.runs["sparse"]
    assert none_missed_from(Ran(run=run, epochs=epochs, best=np.ones((1, 2, 1)))) == wanted
    always = replace(epochs, success=np.ones((4, 2)))
    assert none_missed_from(Ran(run=run, epochs=always, best=np.ones((1, 2, 1)))) == 5


def test_settings_are_the_published_ones() -> None:
    """Two episodes of 50 actions in a cycle, 40 updates, a discount of 0.98 (Plappert et al. 2018, appendix)."""
    for reference in REFERENCES.values():
        assert list(reference.experiment.runs) == ["sparse", "shaped"]
        for name, run in reference.experiment.runs.items():
            options = run.options
            assert (options.actions // run.horizon, options.updates, options.batch, run.horizon) == (2, 40, 256, 50)
            assert (options.random, options.noise, options.penalty, options.cut) == (0.3, 0.2, 1.0, True)
            assert options.shaped == (name == "shaped")


def test_its_table_picture_and_verdicts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    short = REFERENCES["figure-5.13"]
    runs = {
        name: replace(run, horizon=2, options=replace(run.options, layers=(8,), cycles=2, actions=4, updates=2))
        for name, run in short.experiment.runs.items()
    }
    small = replace(short, experiment=replace(short.experiment, runs=runs))
    monkeypatch.setattr(room, "REFERENCES", {"figure-5.13": small})
    monkeypatch.setattr(room, "robotics_task", lambda name, horizon: Walk())
    command.reproduce_reference(["figure-5.13"], tmp_path, size="minutes", seeds=2)
    told = capsys.readouterr().out
    assert "FetchReach-v4, 2 seeds" in told
    assert "sparse ends above 0.9, as published: " in told
    assert {file.name for file in tmp_path.iterdir()} == {"figure-5.13.json", "figure-5.13.png"}
    assert set(command.REFERENCE_TABLES) == set(REFERENCES)
    command.reproduce_reference(["figure-5.13"], tmp_path, size="minutes", seeds=2)
    assert "figure-5.13: finished before" in capsys.readouterr().out


def test_what_is_missing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "gymnasium_robotics", None)
    with pytest.raises(HydrostatError, match='install gymnasium-robotics "mujoco<3\\.6"'):
        robotics_task("FetchReach-v4", 50)


def test_fetch_reach_itself() -> None:
    """Oracle: MuJoCo. The gripper goes where it is pushed, and its goals are within 15 cm of where it begins."""
    pytest.importorskip("gymnasium_robotics", reason="gymnasium-robotics is not installed")
    try:
        robotics_task("FetchReach-v4", 50)
    except HydrostatError as error:
        pytest.skip(str(error))
    trials = GymnasiumTrials(lambda: robotics_task("FetchReach-v4", 50), horizon=50)
    _, begun, goals = trials.begin(torch.Generator().manual_seed(0), (1, 2))
    assert (goals - begun).abs().max() < 0.2
    for _ in range(10):
        reached = trials.act(torch.tensor([[[1.0, 0, 0, 0], [-1.0, 0, 0, 0]]]))[1]
    moved = (reached - begun)[0, :, 0]
    assert moved[0] > 0.05
    assert moved[1] < -0.05
