"""Networks that learn a strip, with PyTorch. Oracles: the simulator, ridge regression."""

import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.cli.main import app
from hydrostat.errors import InputError
from hydrostat.ik import IKStatus
from hydrostat.learning import (
    LearnedModel,
    LearnOptions,
    SamplePlan,
    Samples,
    correct_model,
    learn_model,
    sample_robot,
    solve_exactly,
    verify,
)
from hydrostat.learning.learned_model import Tier
from hydrostat.learning.training_set import linear_map
from hydrostat.learning.verify import exact_steps
from hydrostat.mechanics import NewtonStatus
from hydrostat.robot import Robot

pytestmark = pytest.mark.usefixtures("unchecked")

OPTIONS = LearnOptions(members=2, width=24, depth=2, steps=400, inverse_steps=300, batch=32)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return strip_robot(columns=8, rows=2)


@pytest.fixture(scope="module")
def folder(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sample_robot(SamplePlan.of_robot(robot, 80), tmp_path_factory.mktemp("learned")).path


@pytest.fixture(scope="module")
def samples(folder: Path) -> Samples:
    return Samples.read(folder)


@pytest.fixture(scope="module")
def model(samples: Samples) -> LearnedModel:
    pytest.importorskip("torch")
    return learn_model(samples.first(60), options=OPTIONS)


@pytest.fixture(scope="module")
def simulation(robot: Robot) -> hs.Simulation:
    return hs.Simulation(robot)


def targets_of(samples: Samples) -> list[dict[str, tuple[float, ...]]]:
    """Places of the one marker [m]."""
    return [{"tip": tuple(places[0].tolist())} for places in samples.markers]


@pytest.mark.slow
def test_networks_expect_what_the_simulator_finds(model: LearnedModel, samples: Samples) -> None:
    """Oracle: samples that nothing was learned from; ridge regression of the others errs many times as much."""
    known, new = samples.first(60), samples.only(np.arange(60, 80))
    found = np.array([model.predict(row)[0][:2] for row in new.contractions])
    missed = np.linalg.norm(found - new.markers[:, 0], axis=1).mean()
    linear = linear_map(known.contractions, known.markers.reshape(60, -1))
    ridge = np.hstack([new.contractions, np.ones((20, 1))]) @ linear
    assert missed < 0.2 * np.linalg.norm(ridge - new.markers[:, 0], axis=1).mean()
    assert missed < 3 * model.card.error
    slopes = np.array([model.jacobian(row) for row in new.contractions])
    assert np.linalg.norm(slopes - new.jacobians[:, 0]) < 0.3 * np.linalg.norm(new.jacobians)  # cables go slack


@pytest.mark.slow
def test_answers_rolled_out_in_the_simulator(model: LearnedModel, samples: Samples, simulation: hs.Simulation) -> None:
    """Oracle: the simulator, which each tier errs less in than the one before; ridge regression of contractions."""
    known, new = samples.first(60), samples.only(np.arange(60, 72))
    linear = linear_map(known.markers.reshape(60, -1), known.contractions)
    errors: dict[str, list[float]] = {"ridge": [], "network": [], "search": [], "step": [], "exact": []}
    for target in targets_of(new):
        place = np.array(target["tip"])
        ridge = simulation.solve(np.clip(np.r_[place, 1.0] @ linear, model.low, model.high))
        errors["ridge"].append(float(np.linalg.norm(ridge.markers["tip"] - place)))
        fast, slow = model.solve(target, search=False), model.solve(target)
        assert fast.tier is Tier.NETWORK
        answers = {
            "network": verify(simulation, model, fast),
            "search": verify(simulation, model, slow),
            "step": verify(simulation, model, slow, steps=1),
            "exact": solve_exactly(simulation, model, slow),
        }
        for name, answer in answers.items():
            assert answer.certified is not None
            assert answer.pose is not None
            assert answer.certified["tip"] == pytest.approx(np.linalg.norm(answer.pose.markers["tip"] - place))
            assert answer.error == answer.certified["tip"]
            errors[name].append(answer.error)
            assert (answer.contractions >= model.low).all()
            assert (answer.contractions <= model.high).all()
        assert answers["search"].status is NewtonStatus.CONVERGED
        assert answers["exact"].status is IKStatus.REACHED
        assert answers["step"].error <= answers["search"].error
    means = {name: np.mean(values) for name, values in errors.items()}
    assert means["search"] <= 1.05 * means["network"]
    assert means["search"] < 0.2 * means["ridge"]
    assert means["step"] < 0.2 * means["search"]
    assert means["exact"] < 1e-6


@pytest.mark.slow
def test_a_few_samples_of_a_finer_mesh_correct_a_model(
    model: LearnedModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: samples of the finer mesh that nothing was learned from; the model as it was."""
    finer = strip_robot(columns=16, rows=4)
    found = Samples.read(sample_robot(SamplePlan.of_robot(finer, 20), tmp_path / "finer").path)
    known, new = found.only(np.arange(8)), found.only(np.arange(8, 20))
    better = correct_model(model, known)
    better.check(finer)
    missed = [
        np.linalg.norm(
            np.array([one.predict(row)[0][:2] for row in new.contractions]) - new.markers[:, 0], axis=1
        ).mean()
        for one in (model, better)
    ]
    assert missed[1] < 0.5 * missed[0]
    assert better.card.corrected == 8
    assert LearnedModel.load(better.save(tmp_path / "finer.model")).card.physics == better.card.physics
    with pytest.raises(InputError, match="there are 3 samples; learning takes 5"):
        correct_model(model, known.first(3))
    monkeypatch.setattr("hydrostat.learning.train.sobolev_loss", _interrupted)
    with pytest.raises(KeyboardInterrupt):  # nothing is there to keep, and no rate is to blame
        correct_model(model, known)
    other = replace(known, facts={**known.facts, "markers": ["elsewhere"]})
    with pytest.raises(InputError, match="other markers"):
        correct_model(model, other)


def _interrupted(*_: object) -> None:
    raise KeyboardInterrupt


def test_a_step_that_finds_nothing_is_tried_shorter(simulation: hs.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a tracker whose first two updates stay where they are."""
    goal = {"tip": simulation.solve(np.array([0.3, 0.0]) * simulation.robot.winches[0].travel).markers["tip"]}
    update, calls = hs.Tracker.update, []

    def lazy(self: hs.Tracker, target: object, *, seconds: float) -> object:
        calls.append(seconds)
        if len(calls) > 2:
            return update(self, target, seconds=seconds)  # type: ignore[arg-type]
        stayed = update(hs.Tracker(simulation, start=self.pose), target, seconds=seconds)  # type: ignore[arg-type]
        return replace(stayed, pose=self.pose, status=IKStatus.STALLED)

    monkeypatch.setattr(hs.Tracker, "update", lazy)
    pose, taken = exact_steps(simulation, simulation.rest, goal, 1)
    assert (taken, len(calls)) == (1, 3)
    assert pose.contractions[0] > 0
    assert exact_steps(simulation, pose, goal, 5, enough=1.0) == (pose, 0)


@pytest.mark.slow
def test_a_tracker_begins_from_an_answer(model: LearnedModel, samples: Samples, simulation: hs.Simulation) -> None:
    target = targets_of(samples)[70]
    begun = verify(simulation, model, model.solve(target), steps=1)
    tracker = hs.Tracker(simulation, start=begun.pose)
    assert tracker.update(target, seconds=1.0).errors["tip"] <= begun.error
    led, alone = (hs.Tracker(simulation, model=known).update(target, seconds=1.0) for known in (model, None))
    assert led.errors["tip"] < 0.5 * alone.errors["tip"]


@pytest.mark.slow
def test_the_answer_does_not_need_torch_nor_a_simulator(model: LearnedModel, samples: Samples, tmp_path: Path) -> None:
    """Oracle: an interpreter in which torch cannot be imported."""
    file = model.save(tmp_path / "strip.model")
    place = samples.markers[70, 0]
    code = f"""
import sys
from importlib.abc import MetaPathFinder
class NoTorch(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "torch":
            raise ImportError(name)
sys.meta_path.insert(0, NoTorch())
from hydrostat.learning import (LearnedModel)
print(LearnedModel.load({str(file)!r}).solve({{"tip": {place.tolist()}}}).commands)
"""
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == str(dict(LearnedModel.load(file).solve({"tip": place}).commands))


@pytest.mark.slow
@pytest.mark.parametrize(("stage", "after"), [("forward", 100), ("inverse", 100), ("forward", 0)])
def test_ctrl_c_keeps_the_best_so_far_or_nothing(samples: Samples, stage: str, after: int) -> None:
    pytest.importorskip("torch")

    def tell(name: str, done: int, total: int) -> None:
        if name == stage and done >= after:
            raise KeyboardInterrupt

    options = replace(OPTIONS, steps=300 if after else 1)
    stopped = learn_model(samples, options=options, progress=tell)
    assert stopped.card.stopped
    assert (stopped.inverse is None) == (stage == "forward")
    found = stopped.solve(targets_of(samples)[0])
    assert np.isfinite(found.contractions).all()
    with pytest.raises(InputError, match="no inverse network") if stopped.inverse is None else nullcontext():
        stopped.solve(targets_of(samples)[0], search=False)


def test_few_samples_are_refused(samples: Samples) -> None:
    pytest.importorskip("torch")
    with pytest.raises(InputError, match="there are 10 samples; learning takes 20 or more"):
        learn_model(samples.first(10))


@pytest.mark.parametrize(("name", "value"), [("steps", 0), ("rate", 0.0), ("jacobians", np.nan), ("held_out", 0.7)])
def test_options_are_checked(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        LearnOptions(**{name: value})


def test_what_cannot_be_certified_is_told(simulation: hs.Simulation, model: LearnedModel) -> None:
    answer = model.solve({"tip": (0.1, 0.0)})
    assert len(repr(model)) + len(repr(answer)) < 300
    for given, words in (
        ((None, model, answer), r"must be a Simulation\(robot\), not None"),
        ((simulation, None, answer), "one that LearnedModel.load returns, not None"),
        ((simulation, model, None), "what model.solve gives, not None"),
    ):
        with pytest.raises(InputError, match=words):
            verify(*given)  # type: ignore[arg-type]
    for steps in (-1, "a"):
        with pytest.raises(InputError, match="steps must be a whole number of 0 or more"):
            verify(simulation, model, answer, steps=steps)  # type: ignore[arg-type]


@pytest.mark.slow
def test_the_commands(
    model: LearnedModel,
    folder: Path,
    robot: Robot,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Oracle: the library called directly."""

    def run(*words: object) -> int | None:
        return app([*map(str, words)], standalone_mode=False)

    once = ("--max-samples", 60, "--members", 1, "--steps", 100)
    run("learn", folder, "--out", tmp_path / "strip.model", *once)
    assert "Wrote" in capsys.readouterr().out
    assert LearnedModel.load(tmp_path / "strip.model").card.samples == 60
    part = learn_model(Samples.read(folder).first(60), options=replace(OPTIONS, steps=1, inverse_steps=1))
    early = replace(part, card=replace(part.card, stopped=True))
    monkeypatch.setattr("hydrostat.learning.correct_model", lambda *_, **__: early)
    assert run("learn", folder, "--out", tmp_path / "early.model", "--fine-tune", tmp_path / "strip.model") == 130
    assert capsys.readouterr().out.endswith("interrupted: best model so far\n")
    place = tuple(Samples.read(folder).markers[70, 0].tolist())
    posed = replace(robot, poses={"far": hs.PoseTarget(name="far", targets={"tip": place})})
    good = model.save(tmp_path / "good.model")
    monkeypatch.setattr("hydrostat.robot.load_robot", lambda path: posed)
    run("pose", tmp_path, "--out", tmp_path / "out", "--model", good)
    assert "far: model predicts rms error" in (printed := capsys.readouterr().out)
    assert "target reached" in printed


def test_the_way_back_learns_what_a_model_answers() -> None:
    """Of two winches against one another one takes in, in training as in the model. Oracle: the model, by NumPy."""
    torch = pytest.importorskip("torch")
    from hydrostat.learning.learned_model import index_pairs
    from hydrostat.learning.train import _holding

    training_set = SimpleNamespace(low=np.array([0.0, -0.01, 0.0]), high=np.array([0.04, 0.05, 0.02]))
    pairs = index_pairs([["a", "c"], ["b"]], ["a", "b", "c"])
    model = SimpleNamespace(_pairs=pairs, high=training_set.high)
    half = 0.5 * (training_set.high - training_set.low)
    for scaled in np.random.default_rng(0).uniform(-1, 1, (20, 3)):
        want = LearnedModel._apply_pairs(model, training_set.low + half * (scaled + 1))  # type: ignore[arg-type]
        found = _holding(training_set, pairs)(torch.tensor(scaled[None]))[0]  # type: ignore[arg-type]
        assert training_set.low + half * (found.numpy() + 1) == pytest.approx(want, abs=1e-8)
