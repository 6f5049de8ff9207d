"""Ways to a policy on the same pairs. Oracles: NumPy, and a robot of networks whose outcomes are known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from builders import strip_robot  # noqa: E402

from hydrostat.simulation import Simulation  # noqa: E402
from hydrostat_lab import policies as room  # noqa: E402
from hydrostat_lab import shared_data  # noqa: E402
from hydrostat_lab.policies import WAYS, Budget, TriedPairs  # noqa: E402
from hydrostat_lab.trial_tables import shared_table  # noqa: E402
from hydrostat_lab.trials import NetworkReach  # noqa: E402


class StraightReach(NetworkReach):
    """Two actions that move one marker to twice themselves [cm]."""

    def __init__(self) -> None:
        self.horizon, self.states, self.goals, self.actions, self._dim = 1, 2, 2, 2, 2
        self._random, self.rest = False, torch.zeros(2)

    def contractions(self, acts):
        return acts

    def places(self, taken):
        return 2.0 * taken


@pytest.fixture
def pairs() -> TriedPairs:
    acts = 2.0 * torch.rand(2, 300, 2, generator=torch.Generator().manual_seed(0)) - 1.0
    return TriedPairs(acts=acts, reached=2.0 * acts)


def test_each_way_is_as_near_as_it_can_be(pairs: TriedPairs, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the outcome of its actions: ridge, gradients and cloning find the straight map, 1-NN the nearest pair."""
    monkeypatch.setattr(room, "SMALL", replace(room.SMALL, layers=(8,), cycles=4, updates=4, batch=16))
    trials, goals = StraightReach(), 1.8 * torch.rand(2, 50, 2, generator=torch.Generator().manual_seed(1)) - 0.9
    left = {}
    for name, way in WAYS.items():
        act = way(trials, pairs, Budget(steps=300, epochs=1, batch=64))
        acts = act(goals, goals)
        assert acts.abs().max() <= 1.0
        left[name] = float(trials.distances(trials.reach(acts), goals).mean())
    assert left["ridge"] < 1e-3
    assert left["gradient"] < 0.03
    assert left["cloned"] < 0.1
    apart = np.linalg.norm(goals.numpy()[:, :, None] - pairs.reached.numpy()[:, None], axis=-1).min(axis=2)
    assert left["1-NN"] == pytest.approx(apart.mean(), rel=1e-4)
    assert left["constant"] > 0.5
    assert left["residual on the clone"] < 0.3


def test_slopes_go_through_to_the_actions(pairs: TriedPairs) -> None:
    """Oracle: the outcome is twice the action."""
    acts = pairs.acts[:, :4].clone().requires_grad_()
    trials = StraightReach()
    trials.places(trials.contractions(acts)).sum().backward()
    assert acts.grad is not None
    assert (acts.grad == 2.0).all()
    assert not trials.reach(acts).requires_grad


def test_others_learn_from_what_was_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Of a straight map: ridge finds it from either pairs, 1-NN leaves what NumPy says, more pairs leave less."""
    monkeypatch.setattr(shared_data, "SMALL", replace(room.SMALL, layers=(8,), cycles=4, updates=4, batch=16))
    goals = 1.8 * torch.rand(1, 50, 2, generator=torch.Generator().manual_seed(1)) - 0.9
    learners = []

    def exact(simulation, trials, act, seeds, asked):
        wanted = asked[1].expand(seeds, -1, -1)
        return trials.distances(trials.reach(act(wanted, wanted)), wanted).numpy()

    class Kept(shared_data.HindsightDdpg):
        def __init__(self, *given, **more):
            super().__init__(*given, **more)
            learners.append(self)

    monkeypatch.setattr(shared_data, "exact_goals", lambda *_: (goals, goals))
    monkeypatch.setattr(shared_data, "exact_distances", exact)
    monkeypatch.setattr(shared_data, "HindsightDdpg", Kept)
    budget, unasked = Budget(steps=60, epochs=8, batch=32), Simulation(strip_robot())
    found = list(shared_data.compare_on_shared_data(StraightReach(), unasked, seeds=2, goals=50, budget=budget))
    assert [each.pairs for each in found[::10]] == [40, 80, 160, 320]
    left = {(each.way, each.pairs): each.expected for each in found}
    ends = {each.way: each.exact for each in found if each.exact is not None}
    assert {each.pairs for each in found if each.exact is not None} == {320}
    assert len(left) == 4 * 10
    for data in ("shared", "independent"):
        assert left[f"network 4 x 30, {data}", 320].mean() < left[f"network 4 x 30, {data}", 40].mean() < 1.0
        assert left[f"ridge, {data}", 320].max() < 1e-3
        assert left[f"1-NN, {data}", 320].mean() < left[f"1-NN, {data}", 40].mean()
    tried = learners[0].tried[1]
    apart = np.linalg.norm(goals.numpy()[:, :, None] - tried[:, None], axis=-1).min(axis=2)
    np.testing.assert_allclose(ends["1-NN, shared"], apart, atol=1e-3)
    assert left[shared_data.BEST, 320].mean() <= 1.2 * left[shared_data.TRIED, 40].mean()

    shared_table("figure", found, tmp_path, 100.0)
    told = capsys.readouterr().out
    assert "a network ends nearer than ridge regression (N16): contradicted" in told
    assert len(json.loads((tmp_path / "figure.json").read_text())["rows"]) == 40
    assert (tmp_path / "figure.png").exists()
