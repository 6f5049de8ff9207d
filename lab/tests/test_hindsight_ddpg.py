"""The method of Plappert et al. 2018. Oracles: cases by hand, counts, NumPy, a task with a known answer."""

from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from hydrostat.errors import InputError  # noqa: E402
from hydrostat_lab.curriculum import Curriculum  # noqa: E402
from hydrostat_lab.hindsight_ddpg import (  # noqa: E402
    DdpgOptions,
    HindsightDdpg,
    cut_targets,
    discount,
    hindsight,
    rewards,
)
from hydrostat_lab.running import Running  # noqa: E402
from hydrostat_lab.trials import Trials  # noqa: E402


class PointReach(Trials):
    """A point on a line that goes where an action says."""

    states = goals = actions = 1

    def __init__(self, horizon: int = 1) -> None:
        self.horizon = horizon

    def begin(self, draw, shape):
        zero = torch.zeros(*shape, 1)
        return zero, zero, 2.0 * torch.rand(*shape, 1, generator=draw) - 1.0

    def act(self, acts):
        return acts, acts

    def distances(self, reached, goals):
        return (reached - goals).abs()[..., 0]


FEW = DdpgOptions(layers=(16,), cycles=10, updates=10, batch=32, shaped=True, penalty=0.0, cut=False, tolerance=0.1)


def test_discounts_and_cut_targets_by_hand() -> None:
    assert [discount(steps) for steps in (1, 5, 10)] == pytest.approx([0.0, 0.8, 0.9])
    targets = torch.tensor([-7.0, -5.0, -0.5, 0.3])
    assert cut_targets(targets, 0.8).tolist() == pytest.approx([-5.0, -5.0, -0.5, 0.0])
    assert cut_targets(targets, 0.0).tolist() == pytest.approx([-1.0, -1.0, -0.5, 0.0])


def test_rewards_by_hand() -> None:
    far, tolerance = torch.tensor([[0.0, 0.49, 0.5, 2.0]]), torch.tensor([[0.5]])
    assert rewards(far, tolerance, shaped=False).tolist() == [[0.0, 0.0, -1.0, -1.0]]
    assert rewards(far, tolerance, shaped=True).tolist() == pytest.approx(np.array([[0.0, -0.49, -0.5, -2.0]]))


def test_hindsight_takes_every_later_step_as_often() -> None:
    """Four of five get a goal; of an episode's steps left each comes as often. Counted over many draws."""
    left = torch.tensor([1, 2, 5]).repeat(40_000, 1)
    ahead = hindsight(left, 0.8, torch.Generator().manual_seed(0)).numpy()
    for column, steps in enumerate((1, 2, 5)):
        values, counts = np.unique(ahead[:, column], return_counts=True)
        assert values.tolist() == [-1, *range(steps)]
        assert counts / len(ahead) == pytest.approx([0.2, *[0.8 / steps] * steps], abs=0.01)


def test_transitions_belong_together() -> None:
    """Independent: each drawn transition is looked up in the episodes; its goal is its own, or one reached later."""
    learner = HindsightDdpg(PointReach(4), replace(FEW, random=1.0), seeds=2, epochs=1)
    for _ in range(5):
        learner._roll_out()
    state, act, after, reached, goal = (part.numpy()[..., 0] for part in learner._drawn(200))
    kept = 0
    for seed in range(2):
        acts = learner._acts[seed, : learner._filled, :, 0].numpy()
        goals = learner._goals[seed, : learner._filled, 0].numpy()
        for at in range(200):
            (episode, step), *_ = np.argwhere(acts == act[seed, at])
            assert after[seed, at] == reached[seed, at] == act[seed, at]
            assert state[seed, at] == (acts[episode, step - 1] if step else 0.0)
            own = goal[seed, at] == goals[episode]
            assert own or goal[seed, at] in acts[episode, step:]
            kept += own
    assert 0.1 < kept / 400 < 0.3


def test_running_means_are_those_of_numpy() -> None:
    draw = np.random.default_rng(0)
    values = 3.0 + 2.0 * draw.standard_normal((2, 60, 3)).astype(np.float32)
    values[..., 2] = 7.0  # never changes: its unit is 0.01
    seen = Running(2, 3)
    seen.see(torch.tensor(values[:, :20]))
    seen.see(torch.tensor(values[:, 20:]))
    wanted = (values - values.mean(1, keepdims=True)) / np.maximum(values.std(1, keepdims=True), 0.01)
    np.testing.assert_allclose(seen(torch.tensor(values)).numpy()[..., :2], wanted[..., :2].clip(-5, 5), atol=1e-3)
    assert np.abs(seen(torch.tensor(values + 1.0)).numpy()[..., 2]).max() <= 5.0


def test_a_point_learns_to_go_where_it_should() -> None:
    """The answer is the goal itself; every seed comes within a tenth of the range, from half of it."""
    learner = HindsightDdpg(PointReach(), FEW, seeds=3, epochs=8)
    epochs = learner.learn(tests=50)
    assert epochs.actions.tolist() == [100 * count for count in range(1, 9)]
    assert learner.test(learner.best, 50)[-1].mean(axis=1).max() < 0.1
    acts, reached = learner.tried
    assert acts.shape == reached.shape == (3, 800, 1)
    again = HindsightDdpg(PointReach(), FEW, seeds=3, epochs=8).learn(tests=50)
    assert np.array_equal(epochs.distance, again.distance)


def test_best_policies_are_those_of_the_best_epoch() -> None:
    learner = HindsightDdpg(PointReach(), FEW, seeds=3, epochs=6)
    epochs = learner.learn(tests=50)
    np.testing.assert_allclose(learner.test(learner.best, 50)[-1].mean(axis=1), epochs.distance.min(0), rtol=1e-4)


@pytest.mark.parametrize(
    ("curriculum", "wanted"),
    [(Curriculum.FIXED, 1.0), (Curriculum.HALVE, 0.5), (Curriculum.TENTH, 0.9), (Curriculum.CURRENT, 0.3)],
)
def test_tolerances_go_on_when_nine_of_ten_succeed(curriculum: Curriculum, wanted: float) -> None:
    found = curriculum.next(np.ones(2), np.array([0.89, 0.9]), np.array([0.3, 0.3]))
    assert found.tolist() == pytest.approx([1.0, wanted])


@pytest.mark.parametrize("late", [None, 1e-2])
def test_a_branch_goes_on_as_if_it_had_begun_with_its_options(late: float | None) -> None:
    """Oracle: the run that has them from the start, bit for bit; tolerances change in between."""
    few = replace(FEW, cycles=4, shaped=False, tolerance=0.8)
    options = replace(few, curriculum=Curriculum.TENTH, late_critic_rate=late)
    first = HindsightDdpg(PointReach(2), few, seeds=3, epochs=9)
    first.learn_first(tests=50)
    done = len(first._rows)
    assert first.has_mastered
    assert done < 9
    whole = HindsightDdpg(PointReach(2), options, seeds=3, epochs=done + 4).learn(tests=50)
    for _ in range(2):  # a branch leaves the first as it was
        branch = first.branch(options, more=4).learn(tests=50)
        for name in ("actions", "success", "distance", "tolerance"):
            assert np.array_equal(getattr(branch, name), getattr(whole, name))
    assert whole.tolerance[-1].min() < 0.8


@pytest.mark.parametrize(("easy", "wanted"), [(True, 0.0), (False, 40.0)])
def test_steps_of_adam_begin_again_with_a_new_tolerance(easy: bool, wanted: float) -> None:
    """Counted by hand: two epochs of two cycles of ten updates; every test succeeds within 9, none within 0."""
    options = replace(FEW, cycles=2, curriculum=Curriculum.TENTH, tolerance=9.0 if easy else 0.0, reset_adam=True)
    learner = HindsightDdpg(PointReach(), options, seeds=2, epochs=2)
    learner.learn(tests=5)
    for adam in (learner._actor_adam, learner._critic_adam):
        assert {float(state["step"]) for state in adam.state.values()} == {wanted}


def test_numbers_that_cannot_be_are_refused() -> None:
    with pytest.raises(InputError, match="noise must be from 0 to 1"):
        DdpgOptions(noise=2.0)
    with pytest.raises(InputError, match="batch must be 1 or more"):
        DdpgOptions(batch=0)
