"""A learned model and its file, without PyTorch. Oracles: NumPy, the simulator, bytes and headers that were changed."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot
from plain_model import plain

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel, ModelCard, SamplePlan, Samples, sample_robot, verify
from hydrostat.learning.learn_model import kept_facts
from hydrostat.learning.learned_model import Tier
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.sample_plan import SamplingScheme, shared_numbers
from hydrostat.robot import Robot

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return strip_robot(columns=8, rows=2)


@pytest.fixture(scope="module")
def simulation(robot: Robot) -> hs.Simulation:
    return hs.Simulation(robot)


def test_an_answer_is_certified_by_the_simulator_that_is_asked(robot: Robot, simulation: hs.Simulation) -> None:
    """Oracle: the other simulator, asked for the contractions itself. A pose of the same robot is kept."""
    soft = replace(robot, body=replace(robot.body, material=replace(robot.body.material, density=3000.0)))
    soft = replace(soft, gravity=(0.0, -9.81))
    other, target = hs.Simulation(soft), {"tip": (0.15, -0.02)}
    answer = verify(simulation, plain(robot), plain(robot).solve(target))
    found = verify(other, plain(soft), answer)
    want = np.linalg.norm(other.solve(answer.contractions).markers["tip"] - target["tip"])
    assert found.error == pytest.approx(want, rel=1e-9)
    assert abs(found.error - answer.error) > 1e-4
    assert verify(hs.Simulation(replace(robot, name="renamed")), plain(robot), answer).pose is answer.pose


def test_an_answer_is_of_steps_only_where_one_was_taken(robot: Robot, simulation: hs.Simulation) -> None:
    model, target = plain(robot), {"tip": (0.15, -0.02)}
    answer = model.solve(target)
    assert verify(simulation, model, answer, steps=3, enough=1.0).tier is Tier.SEARCH
    stepped = verify(simulation, model, answer, steps=1)
    assert stepped.tier is verify(simulation, model, stepped).tier is Tier.STEP
    again = verify(simulation, model, replace(stepped, pose=None))
    assert again.pose is not None
    assert np.array_equal(again.pose.nodes, simulation.solve(stepped.contractions).nodes)


def test_a_file_gives_the_model_back(robot: Robot, tmp_path: Path) -> None:
    model = plain(robot)
    again = LearnedModel.load(model.save(tmp_path / "strip.model"))
    assert again.card == model.card
    target = {"tip": (0.1, 0.02)}
    assert again.solve(target).commands == model.solve(target).commands
    assert again.solve(target, search=False).errors == model.solve(target, search=False).errors


def test_what_networks_say_of_an_answer(robot: Robot) -> None:
    """Oracle: plain NumPy, to 1e-6 as networks run in single precision; all markers asked for, and then one of two."""
    first = plain(robot)
    card = replace(first.card, markers=("tip", "knee"), cables=())
    known = np.array([[0.1, 0.2, 0.3, 0.4], [0.4, 0.3, 0.2, 0.1], [0.0, 0.1, 0.0, 0.2]])
    networks = replace(first.inverse, sizes=np.array([4, 2, 2]), numbers=np.linspace(-1, 1, 24)[None])  # type: ignore[type-var]
    model = replace(first, card=card, inverse=networks, known=known[:, :2] * first.high, reached=known)

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
        assert found.contractions == pytest.approx(model.high * (scaled + 1) / 2, abs=1e-6)
        values = answers(model.forward, scaled)
        for name, place in target.items():
            at = slice(0, 2) if name == "tip" else slice(2, 4)
            assert found.errors[name] == pytest.approx(np.linalg.norm(values.mean(axis=0)[at] - place), abs=1e-6)
            assert found.spread[name] == pytest.approx(np.linalg.norm(values.std(axis=0)[at]), abs=1e-6)
            assert found.markers[name] == pytest.approx(values.mean(axis=0)[at], abs=1e-6)
        assert list(found.errors) == list(found.spread) == list(target)


def test_answers_hold_what_samples_held(robot: Robot, tmp_path: Path) -> None:
    """Of two winches that worked against one another in all samples only one takes in, by how much more it is asked to.

    Oracles: how samples are drawn so, the same model without that, and the best of both sides by a grid of what the
    networks expect.
    """
    free = plain(robot)
    pairs = (tuple(winch.name for winch in robot.winches),)
    held = LearnedModel.load(replace(free, card=replace(free.card, pairs=pairs)).save(tmp_path / "a"))
    with pytest.raises(InputError, match="pairs are none of its winches"):
        LearnedModel.load(replace(free, card=replace(free.card, pairs=(("W1", "nobody"),))).save(tmp_path / "b"))
    rows = np.random.default_rng(4).uniform(0, 1, (20, 2)) * held.high
    again = SamplingScheme.ANTAGONIST.contractions(
        shared_numbers(rows, held.high, [(0, 1)]), held.low, held.high, [(0, 1)]
    )
    assert np.array([held._apply_pairs(row) for row in rows]) == pytest.approx(again, abs=1e-15)
    sides = np.linspace(0, 1, 201)[:, None] * np.diag(free.high)[:, None]
    left = []
    places = np.array([held.predict(row)[0][:2] for row in sides.reshape(-1, 2)])
    for target in np.random.default_rng(3).uniform(-2, 2, (20, 2)):
        before, after = (one.solve({"tip": target}, search=False) for one in (free, held))
        share = before.contractions / free.high
        assert after.contractions / free.high == pytest.approx(
            np.maximum([share[0] - share[1], share[1] - share[0]], 0)
        )
        found = held.solve({"tip": target})
        assert found.contractions.min() == 0.0
        assert found.error <= after.error + 1e-9
        left.append(found.error - np.linalg.norm(places - target, axis=1).min())
    assert np.median(np.abs(left)) < 1e-3
    assert min(left) > -1e-3
    assert sum(one > 1e-3 for one in left) <= 2, "from the other side of a pair it may end in another optimum"


def test_a_model_of_another_contact_is_refused(robot: Robot, tmp_path: Path) -> None:
    """The two contacts differ in a number alone; the hash of physics knows neither."""
    felt = replace(robot, contact=hs.Contact())
    model = LearnedModel.load(plain(felt).save(tmp_path / "strip.model"))
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
    facts = model.card.as_json()
    bare = {name: fact for name, fact in facts.items() if name not in ("contact_distance", "contact_friction")}
    earlier = replace(model, card=ModelCard.from_json(bare))
    earlier.check(felt)
    with pytest.raises(InputError, match="the robot has contact from 10 mm"):
        earlier.check(replace(robot, contact=hs.Contact(distance=0.01)))
    for wrong in ("far", float("inf"), []):
        card = replace(model.card, contact_distance=wrong)  # type: ignore[arg-type]
        file = replace(model, card=card).save(tmp_path / "wrong.model")
        with pytest.raises(InputError, match=r"wrong\.model.*contact_distance"):
            LearnedModel.load(file)


def test_samples_and_models_tell_their_contact(robot: Robot, tmp_path: Path) -> None:
    felt = replace(robot, contact=hs.Contact(distance=0.002))
    samples = Samples.read(sample_robot(SamplePlan.of_robot(felt, 1), tmp_path).path)
    told = {name: kept_facts(samples)[name] for name in ("contact", "contact_distance", "contact_friction")}
    assert told == {"contact": True, "contact_distance": 0.002, "contact_friction": 0.0}
    other = replace(robot, contact=hs.Contact(distance=0.002, friction=2.0))
    with pytest.raises(InputError, match=r"contact_friction is 0\.0, asked for 2\.0"):
        sample_robot(SamplePlan.of_robot(other, 1), tmp_path)


def test_no_changed_file_is_believed(robot: Robot, tmp_path: Path) -> None:
    """Oracle: a checksum of 256 bits; bytes changed, cut off, put in, twice over."""
    whole, file = plain(robot).save(tmp_path / "strip.model").read_bytes(), tmp_path / "changed.model"
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
            LearnedModel.load(file)


def test_what_is_no_file_is_no_model() -> None:
    """A device without an end was read until the memory was full."""
    with pytest.raises(InputError, match="/dev/zero: is not a file; name a file that hydrostat learn wrote"):
        LearnedModel.load("/dev/zero")
    with pytest.raises(InputError, match="a model is read from its file, by a path, not None"):
        LearnedModel.load(None)  # type: ignore[arg-type]


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
    whole, file = plain(robot).save(tmp_path / "strip.model").read_bytes(), tmp_path / "forged.model"
    file.write_bytes(forged(whole, lambda header: None))
    LearnedModel.load(file)
    file.write_bytes(forged(whole, FORGERIES[kind]))
    with pytest.raises(InputError, match="is no sound model"):
        LearnedModel.load(file)


def test_another_robot_is_refused(robot: Robot, simulation: hs.Simulation) -> None:
    model = plain(robot)
    model.check(replace(robot, name="other", poses={}))
    with pytest.raises(InputError, match="learned of another robot") as stop:
        model.check(strip_robot(columns=8, rows=2, slack=0.001))
    assert "\n" not in str(stop.value)
    with pytest.raises(InputError, match="robot knows contact and the model does not"):
        model.check(replace(robot, contact=hs.Contact()))
    with pytest.raises(InputError, match="learned of another robot"):
        verify(hs.Simulation(strip_robot(columns=8, rows=2, stiffness=3e3)), model, model.solve({"tip": (0.1, 0.0)}))


@pytest.mark.parametrize(
    ("targets", "words"),
    [
        ({}, "at least one marker"),
        ({"top": (0.0, 0.0)}, 'unknown marker "top"'),
        ({"tip": (0.0, 0.0, 0.0)}, "must be 2 finite coordinates"),
        ({"tip": (0.0, np.inf)}, "finite coordinates"),
    ],
)
def test_wrong_targets_are_told(robot: Robot, targets: dict[str, tuple[float, ...]], words: str) -> None:
    with pytest.raises(InputError, match=words):
        plain(robot).solve(targets)
