"""Learned inverse kinematics of a strip. Oracles: the simulator, ridge regression, bytes that were changed."""

import hashlib
import json
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.ik import InverseReason
from hydrostat.learning import (
    METHODS,
    LearnedModel,
    LearnOptions,
    Samples,
    Tier,
    certify,
    compare,
    correct_model,
    learn_model,
    load_model,
    plan_samples,
    read_samples,
    sample_robot,
    save_model,
    solve_exactly,
)
from hydrostat.learning.certify import exact_steps
from hydrostat.learning.compare import WAYS, targets_of
from hydrostat.learning.learn_model import kept_facts
from hydrostat.learning.lesson import linear_map
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.mechanics import Reason
from hydrostat.robot import Robot

pytestmark = pytest.mark.usefixtures("unchecked")

OPTIONS = LearnOptions(members=2, width=24, depth=2, steps=400, inverse_steps=300, batch=32)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return strip_robot(columns=8, rows=2)


@pytest.fixture(scope="module")
def folder(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sample_robot(plan_samples(robot, 80), tmp_path_factory.mktemp("learned")).path


@pytest.fixture(scope="module")
def samples(folder: Path) -> Samples:
    return read_samples(folder)


@pytest.fixture(scope="module")
def model(samples: Samples) -> LearnedModel:
    pytest.importorskip("torch")
    return learn_model(samples.first(60), options=OPTIONS)


@pytest.fixture(scope="module")
def simulation(robot: Robot) -> hs.Simulation:
    return hs.Simulation(robot)


def plain(robot: Robot) -> LearnedModel:
    """A model that has learned nothing: for what needs no training."""
    draw = np.random.default_rng(0)

    def networks(*sizes: int) -> Perceptrons:
        numbers = draw.normal(size=(2, Perceptrons.count(np.array(sizes)))).astype(np.float32)
        return Perceptrons(sizes=np.array(sizes), numbers=numbers.astype(float))

    plan = plan_samples(robot, 20)
    return LearnedModel(
        facts=plan.facts() | {"error": 1e-3},
        low=np.zeros(2),
        high=np.array([winch.travel for winch in robot.winches]),
        middle=np.zeros(4),
        unit=np.ones(4),
        forward=networks(2, 5, 4),
        inverse=networks(2, 5, 2),
        known=np.zeros((3, 2)),
        reached=np.zeros((3, 2)),
    )


@pytest.mark.slow
def test_networks_expect_what_the_simulator_finds(model: LearnedModel, samples: Samples) -> None:
    """Oracle: samples that nothing was learned from; ridge regression of the others errs many times as much."""
    known, new = samples.first(60), samples.only(np.arange(60, 80))
    found = np.array([model.expect(row)[0][:2] for row in new.contractions])
    missed = np.linalg.norm(found - new.markers[:, 0], axis=1).mean()
    linear = linear_map(known.contractions, known.markers.reshape(60, -1))
    ridge = np.hstack([new.contractions, np.ones((20, 1))]) @ linear
    assert missed < 0.2 * np.linalg.norm(ridge - new.markers[:, 0], axis=1).mean()
    assert missed < 3 * model.facts["error"]
    slopes = np.array([model.slopes(row) for row in new.contractions])
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
            "network": certify(simulation, model, fast),
            "search": certify(simulation, model, slow),
            "step": certify(simulation, model, slow, steps=1),
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
        assert answers["search"].reason is Reason.CONVERGED
        assert answers["exact"].reason is InverseReason.REACHED
        assert answers["step"].error <= answers["search"].error
    means = {name: np.mean(values) for name, values in errors.items()}
    assert means["search"] <= 1.05 * means["network"]
    assert means["search"] < 0.2 * means["ridge"]
    assert means["step"] < 0.2 * means["search"]
    assert means["exact"] < 1e-6


@pytest.mark.slow
def test_ways_to_learn_side_by_side(samples: Samples, simulation: hs.Simulation, model: LearnedModel) -> None:
    """Oracles: the samples themselves, whose nearest are rolled out to where they were; learning by hand."""
    known, new = samples.first(60), samples.only(np.arange(60, 66))
    rows = {found.method: found for found in compare(simulation, known, new, METHODS, options=OPTIONS)}
    assert list(rows) == list(METHODS)
    assert all(found.distances.shape == (6, 1) and found.lost == 0 for found in rows.values())
    near = np.linalg.norm(known.markers[:, 0] - new.markers, axis=-1).min(axis=1)
    assert rows["1-NN"].distances[:, 0] == pytest.approx(near, abs=1e-9)
    means = {name: found.found.mean() for name, found in rows.items()}
    assert means["1-NN"] < means["constant"]
    assert means["1-NN, Jacobian"] < means["1-NN"]
    assert means["search"] < min(means[name] for name in ("constant", "1-NN", "ridge", "thesis"))
    assert all(means[way + ", step"] < means[way] for way in WAYS)
    assert means["search, steps"] <= means["search, step"]
    assert 0 < rows["search, step"].facts["steps"] <= 1
    assert [name for name, found in rows.items() if found.curve is not None] == ["thesis"]
    answer = certify(simulation, model, model.solve(targets_of(new)[0]))
    assert rows["search"].distances[0, 0] == pytest.approx(answer.error, rel=1e-6)
    with pytest.raises(InputError, match="no way to learn called 'magic'"):
        next(compare(simulation, known, new, ["magic"]))


@pytest.mark.slow
def test_a_few_samples_of_a_finer_mesh_correct_a_model(model: LearnedModel, tmp_path: Path) -> None:
    """Oracle: samples of the finer mesh that nothing was learned from; the model as it was."""
    finer = strip_robot(columns=16, rows=4)
    found = read_samples(sample_robot(plan_samples(finer, 20), tmp_path / "finer").path)
    known, new = found.only(np.arange(8)), found.only(np.arange(8, 20))
    better = correct_model(model, known)
    better.check(finer)
    missed = [
        np.linalg.norm(
            np.array([one.expect(row)[0][:2] for row in new.contractions]) - new.markers[:, 0], axis=1
        ).mean()
        for one in (model, better)
    ]
    assert missed[1] < 0.5 * missed[0]
    assert better.facts["corrected"] == 8
    assert load_model(save_model(better, tmp_path / "finer.model")).facts["physics"] == better.facts["physics"]
    with pytest.raises(InputError, match="there are 3 samples; learning takes 5"):
        correct_model(model, known.first(3))
    other = replace(known, facts={**known.facts, "markers": ["elsewhere"]})
    with pytest.raises(InputError, match="other markers"):
        correct_model(model, other)


def test_a_step_that_finds_nothing_is_tried_shorter(simulation: hs.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: a tracker whose first two updates stay where they are."""
    goal = {"tip": simulation.solve(np.array([0.3, 0.0]) * simulation.robot.winches[0].travel).markers["tip"]}
    update, calls = hs.Tracker.update, []

    def lazy(self: hs.Tracker, target: object, *, seconds: float) -> object:
        calls.append(seconds)
        if len(calls) > 2:
            return update(self, target, seconds=seconds)  # type: ignore[arg-type]
        stayed = update(hs.Tracker(simulation, start=self.pose), target, seconds=seconds)  # type: ignore[arg-type]
        return replace(stayed, pose=self.pose, reason=InverseReason.STUCK)

    monkeypatch.setattr(hs.Tracker, "update", lazy)
    pose, taken = exact_steps(simulation, simulation.rest, goal, 1)
    assert (taken, len(calls)) == (1, 3)
    assert pose.contractions[0] > 0
    assert exact_steps(simulation, pose, goal, 5, enough=1.0) == (pose, 0)


def test_an_answer_is_certified_by_the_simulator_that_is_asked(robot: Robot, simulation: hs.Simulation) -> None:
    """Oracle: the other simulator, asked for the contractions itself. A pose of the same robot is kept."""
    soft = replace(robot, body=replace(robot.body, material=replace(robot.body.material, density=3000.0)))
    soft = replace(soft, gravity=(0.0, -9.81))
    other, target = hs.Simulation(soft), {"tip": (0.15, -0.02)}
    answer = certify(simulation, plain(robot), plain(robot).solve(target))
    found = certify(other, plain(soft), answer)
    want = np.linalg.norm(other.solve(answer.contractions).markers["tip"] - target["tip"])
    assert found.error == pytest.approx(want, rel=1e-9)
    assert abs(found.error - answer.error) > 1e-4
    assert certify(hs.Simulation(replace(robot, name="renamed")), plain(robot), answer).pose is answer.pose


def test_an_answer_is_of_steps_only_where_one_was_taken(robot: Robot, simulation: hs.Simulation) -> None:
    model, target = plain(robot), {"tip": (0.15, -0.02)}
    answer = model.solve(target)
    assert certify(simulation, model, answer, steps=3, enough=1.0).tier is Tier.SEARCH
    stepped = certify(simulation, model, answer, steps=1)
    assert stepped.tier is certify(simulation, model, stepped).tier is Tier.STEP
    again = certify(simulation, model, replace(stepped, pose=None))
    assert again.pose is not None
    assert np.array_equal(again.pose.nodes, simulation.solve(stepped.contractions).nodes)


@pytest.mark.slow
def test_a_tracker_begins_from_an_answer(model: LearnedModel, samples: Samples, simulation: hs.Simulation) -> None:
    target = targets_of(samples)[70]
    begun = certify(simulation, model, model.solve(target), steps=1)
    tracker = hs.Tracker(simulation, start=begun.pose)
    assert tracker.update(target, seconds=1.0).errors["tip"] <= begun.error
    led, alone = (hs.Tracker(simulation, model=known).update(target, seconds=1.0) for known in (model, None))
    assert led.errors["tip"] < 0.5 * alone.errors["tip"]


@pytest.mark.slow
def test_the_answer_does_not_need_torch_nor_a_simulator(model: LearnedModel, samples: Samples, tmp_path: Path) -> None:
    """Oracle: an interpreter in which torch cannot be imported."""
    file = save_model(model, tmp_path / "strip.model")
    place = samples.markers[70, 0]
    code = f"""
import sys
from importlib.abc import MetaPathFinder
class NoTorch(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "torch":
            raise ImportError(name)
sys.meta_path.insert(0, NoTorch())
from hydrostat.learning import load_model
print(load_model({str(file)!r}).solve({{"tip": {place.tolist()}}}).commands)
"""
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == str(dict(load_model(file).solve({"tip": place}).commands))


@pytest.mark.slow
@pytest.mark.parametrize(("stage", "after"), [("forward", 100), ("inverse", 100), ("forward", 0)])
def test_ctrl_c_keeps_the_best_so_far_or_nothing(samples: Samples, stage: str, after: int) -> None:
    pytest.importorskip("torch")

    def tell(name: str, done: int, total: int) -> None:
        if name == stage and done >= after:
            raise KeyboardInterrupt

    options = replace(OPTIONS, steps=300 if after else 1)
    stopped = learn_model(samples, options=options, tell=tell)
    assert stopped.facts["stopped"]
    assert (stopped.inverse is None) == (stage == "forward")
    found = stopped.solve(targets_of(samples)[0])
    assert np.isfinite(found.contractions).all()
    with pytest.raises(InputError, match="no inverse network") if stopped.inverse is None else nullcontext():
        stopped.solve(targets_of(samples)[0], search=False)


def test_few_samples_are_refused(samples: Samples) -> None:
    pytest.importorskip("torch")
    with pytest.raises(InputError, match="there are 10 samples; learning takes 20 or more"):
        learn_model(samples.first(10))


@pytest.mark.parametrize(("name", "value"), [("steps", 0), ("rate", 0.0), ("slopes", np.nan), ("held_out", 0.7)])
def test_options_are_checked(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        LearnOptions(**{name: value})


def test_a_file_gives_the_model_back(robot: Robot, tmp_path: Path) -> None:
    model = plain(robot)
    again = load_model(save_model(model, tmp_path / "strip.model"))
    assert again.facts == json.loads(json.dumps(model.facts))
    target = {"tip": (0.1, 0.02)}
    assert again.solve(target).commands == model.solve(target).commands
    assert again.solve(target, search=False).errors == model.solve(target, search=False).errors


def test_what_networks_say_of_an_answer(robot: Robot) -> None:
    """Oracle: plain NumPy on each network, to 1e-12; all markers asked for, and then one of two."""
    first = plain(robot)
    facts = {**first.facts, "markers": ["tip", "knee"], "cables": []}
    known = np.array([[0.1, 0.2, 0.3, 0.4], [0.4, 0.3, 0.2, 0.1], [0.0, 0.1, 0.0, 0.2]])
    networks = replace(first.inverse, sizes=np.array([4, 2, 2]), numbers=np.linspace(-1, 1, 24)[None])  # type: ignore[type-var]
    model = replace(first, facts=facts, inverse=networks, known=known[:, :2] * first.high, reached=known)

    def answers(one: Perceptrons, point: np.ndarray) -> np.ndarray:
        (a, b, c), found = one.sizes.tolist(), []
        for row in one.numbers:
            hidden = point @ row[: a * b].reshape(a, b) + row[a * b : a * b + b]
            rest = row[a * b + b :]
            out = (hidden / (1 + np.exp(-hidden))) @ rest[: b * c].reshape(b, c) + rest[b * c : b * c + c]
            found.append(out + point @ rest[b * c + c :].reshape(a, c))
        return np.array(found)

    for target in ({"tip": (0.1, 0.25), "knee": (0.3, 0.35)}, {"knee": (0.21, 0.12)}):
        found = model.solve(target, search=False)
        goal = np.r_[target.get("tip", known[1, :2]), target["knee"]]
        scaled = np.clip(1.02 * np.tanh(answers(networks, goal)[0]), -1, 1)
        assert found.contractions == pytest.approx(model.high * (scaled + 1) / 2, abs=1e-12)
        values = answers(model.forward, scaled)
        for name, place in target.items():
            at = slice(0, 2) if name == "tip" else slice(2, 4)
            assert found.errors[name] == pytest.approx(np.linalg.norm(values.mean(axis=0)[at] - place), abs=1e-12)
            assert found.spread[name] == pytest.approx(np.linalg.norm(values.std(axis=0)[at]), abs=1e-12)
            assert found.markers[name] == pytest.approx(values.mean(axis=0)[at], abs=1e-12)
        assert list(found.errors) == list(found.spread) == list(target)


def test_a_model_of_another_contact_is_refused(robot: Robot, tmp_path: Path) -> None:
    """The two contacts differ in a number alone; the hash of physics knows neither."""
    felt = replace(robot, contact=hs.Contact())
    model = load_model(save_model(plain(felt), tmp_path / "strip.model"))
    model.check(felt)
    usual = 1e3 * felt.contact_distance
    for contact, words in (
        (hs.Contact(distance=0.01), "contact from 10 mm with friction 0"),
        (hs.Contact(friction=2.0), f"contact from {usual:.4g} mm with friction 2"),
    ):
        other = replace(robot, contact=contact)
        with pytest.raises(
            InputError, match=f"knows contact from {usual:.4g} mm with friction 0, the robot has {words}"
        ):
            model.check(other)
        plain(other).check(other)
    with pytest.raises(InputError, match="the model knows contact and the robot does not"):
        model.check(robot)
    bare = {name: fact for name, fact in model.facts.items() if name not in ("contact_distance", "contact_friction")}
    earlier = replace(model, facts=bare)
    earlier.check(felt)
    with pytest.raises(InputError, match="the robot has contact from 10 mm"):
        earlier.check(replace(robot, contact=hs.Contact(distance=0.01)))
    for wrong in ("far", float("inf"), []):
        file = save_model(replace(model, facts=bare | {"contact_distance": wrong}), tmp_path / "wrong.model")
        with pytest.raises(InputError, match=r"wrong\.model"):
            load_model(file)


def test_samples_and_models_tell_their_contact(robot: Robot, tmp_path: Path) -> None:
    felt = replace(robot, contact=hs.Contact(distance=0.002))
    samples = read_samples(sample_robot(plan_samples(felt, 1), tmp_path).path)
    told = {name: kept_facts(samples)[name] for name in ("contact", "contact_distance", "contact_friction")}
    assert told == {"contact": True, "contact_distance": 0.002, "contact_friction": 0.0}
    other = replace(robot, contact=hs.Contact(distance=0.002, friction=2.0))
    with pytest.raises(InputError, match=r"contact_friction is 0\.0, asked for 2\.0"):
        sample_robot(plan_samples(other, 1), tmp_path)


def test_no_changed_file_is_believed(robot: Robot, tmp_path: Path) -> None:
    """Oracle: a checksum of 256 bits; bytes changed, cut off, put in, twice over."""
    whole, file = save_model(plain(robot), tmp_path / "strip.model").read_bytes(), tmp_path / "changed.model"
    draw = np.random.default_rng(7)
    for _ in range(500):
        content = bytearray(whole)
        for _ in range(int(draw.integers(1, 4))):
            at = int(draw.integers(len(content)))
            kind = draw.integers(4)
            if kind == 0:
                content[at] ^= 1 << int(draw.integers(8))
            elif kind == 1:
                content[at:] = content[at + 1 :]
            elif kind == 2:
                del content[at:]
            else:
                content[at:at] = draw.bytes(int(draw.integers(1, 50)))
            if not content:
                break
        if bytes(content) == whole:
            continue
        file.write_bytes(content)
        with pytest.raises(InputError, match=r"is damaged|is no model"):
            load_model(file)


@pytest.mark.usefixtures("unchecked")
def test_what_cannot_be_certified_is_told(simulation: hs.Simulation, model: LearnedModel) -> None:
    answer = model.solve({"tip": (0.1, 0.0)})
    assert len(repr(model)) + len(repr(answer)) < 300
    for given, words in (
        ((None, model, answer), r"by a Simulation\(robot\), not None"),
        ((simulation, None, answer), "one that load_model gives, not None"),
        ((simulation, model, None), "what model.solve gives, not None"),
    ):
        with pytest.raises(InputError, match=words):
            certify(*given)  # type: ignore[arg-type]
    for steps in (-1, "a"):
        with pytest.raises(InputError, match="steps must be a whole number of 0 or more"):
            certify(simulation, model, answer, steps=steps)  # type: ignore[arg-type]


@pytest.mark.usefixtures("unchecked")
def test_what_is_no_file_is_no_model() -> None:
    """A device without an end was read until the memory was full."""
    with pytest.raises(InputError, match="/dev/zero: is not a file; name a file that hydrostat learn wrote"):
        load_model("/dev/zero")
    with pytest.raises(InputError, match="a model is read from its file, by a path, not None"):
        load_model(None)  # type: ignore[arg-type]


def forged(whole: bytes, change: object) -> bytes:
    """A file with another header, and a checksum that fits it."""
    length = int.from_bytes(whole[8:16], "little")
    header = json.loads(whole[16 : 16 + length])
    header = change(header) or header  # type: ignore[operator]
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    content = whole[:8] + len(text).to_bytes(8, "little") + text + whole[16 + length : -32]
    return content + hashlib.sha256(content).digest()


FORGERIES = {
    "no facts": lambda header: header.pop("facts") and None,
    "a list": lambda header: [header],
    "no JSON": lambda header: b"\xff\xfe{",
    "deep": lambda header: b"[" * 100_000,
    "long": lambda header: json.dumps(header | {"more": "x" * 3_000_000}).encode(),
    "no winches": lambda header: header["facts"].update(winches=[]),
    "a winch that is a number": lambda header: header["facts"].update(winches=[1, 2]),
    "more markers": lambda header: header["facts"].update(markers=["a", "b"]),
    "dim": lambda header: header["facts"].update(dim=10**9),
    "not a number": lambda header: header["facts"].update(error=float("nan")),
    "contact as text": lambda header: header["facts"].update(contact="yes"),
    "a huge array": lambda header: header["arrays"][0].__setitem__(2, [10**12]),
    "a negative size": lambda header: header["arrays"][0].__setitem__(2, [-2]),
    "objects": lambda header: header["arrays"][0].__setitem__(1, "|O"),
    "one array fewer": lambda header: header["arrays"].pop() and None,
    "an array twice": lambda header: header["arrays"].append(header["arrays"][0]),
    "arrays by number": lambda header: header.update(arrays=7),
    "sizes as numbers": lambda header: header["arrays"].reverse(),
}


@pytest.mark.parametrize("kind", FORGERIES)
def test_no_forged_file_crashes(kind: str, robot: Robot, tmp_path: Path) -> None:
    """Oracle: files whose checksum fits, but whose contents are no model."""
    whole, file = save_model(plain(robot), tmp_path / "strip.model").read_bytes(), tmp_path / "forged.model"
    file.write_bytes(forged(whole, lambda header: None))
    load_model(file)
    file.write_bytes(forged(whole, FORGERIES[kind]))
    with pytest.raises(InputError, match="is no sound model"):
        load_model(file)


def test_another_robot_is_refused(robot: Robot, simulation: hs.Simulation) -> None:
    model = plain(robot)
    model.check(replace(robot, name="other", poses={}))
    with pytest.raises(InputError, match="learned of another robot") as stop:
        model.check(strip_robot(columns=8, rows=2, slack=0.001))
    assert "\n" not in str(stop.value)
    with pytest.raises(InputError, match="robot knows contact and the model does not"):
        model.check(replace(robot, contact=hs.Contact()))
    with pytest.raises(InputError, match="learned of another robot"):
        certify(hs.Simulation(strip_robot(columns=8, rows=2, stiffness=3e3)), model, model.solve({"tip": (0.1, 0.0)}))


@pytest.mark.parametrize(
    ("targets", "words"),
    [
        ({}, "at least one marker"),
        ({"top": (0.0, 0.0)}, 'no marker "top"'),
        ({"tip": (0.0, 0.0, 0.0)}, "must be 2 finite coordinates"),
        ({"tip": (0.0, np.inf)}, "finite coordinates"),
    ],
)
def test_wrong_targets_are_told(robot: Robot, targets: dict[str, tuple[float, ...]], words: str) -> None:
    with pytest.raises(InputError, match=words):
        plain(robot).solve(targets)


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
    from hydrostat.cli.learn import learn
    from hydrostat.cli.pose import pose

    learn(folder, tmp_path / "strip.model", count=60, members=1, steps=100)
    assert "Wrote" in capsys.readouterr().out
    assert load_model(tmp_path / "strip.model").facts["samples"] == 60
    place = tuple(read_samples(folder).markers[70, 0].tolist())
    posed = replace(robot, poses={"far": hs.Pose(name="far", targets={"tip": place})})
    monkeypatch.setattr("hydrostat.cli.pose.read_robot", lambda path: posed)
    pose(tmp_path / "strip", tmp_path / "out", model=save_model(model, tmp_path / "good.model"))
    assert "far: networks expect" in (printed := capsys.readouterr().out)
    assert "every goal is reached" in printed
