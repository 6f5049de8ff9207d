"""A glove and what is learned of it. Oracles: synthetic hands, fits made anew without each pose, the package mcap."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from synthetic_hand import OUTPUTS, averaged, mimicked, shown

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop import CyberGlove, Mimicry
from hydrostat.teleop.cyber_glove import SENSORS, EmulatedGlove
from hydrostat.teleop.ridge import fit_ridge, folded_error, left_out_error

MARK = 0.0026  # of the thesis: error of 120 poses, contractions from -1 to 1


def test_the_glove_tells_its_sensors_to_half_a_step() -> None:
    values = np.linspace(0, 1, SENSORS)
    glove = CyberGlove(EmulatedGlove(values), clock=lambda: 7.0)
    reading = glove.read()
    assert reading.values == pytest.approx(values, abs=0.5 / 254 + 1e-9)
    assert reading.stamp == 7.0
    assert len(set(glove.names)) == len(glove.names) == SENSORS


@pytest.mark.parametrize("spoil", [lambda a: a[:-3], lambda a: b"x" + a[1:], lambda a: a[:5] + b"\0" + a[6:]])
def test_spoilt_answers_are_asked_for_again_and_never_made_up(spoil) -> None:
    emulated = EmulatedGlove(np.full(SENSORS, 0.25))
    glove, left = CyberGlove(emulated), [2]

    def some(answer: bytes) -> bytes:
        left[0] -= 1
        return spoil(answer) if left[0] >= 0 else answer

    emulated.spoil = some
    assert glove.read().values == pytest.approx(0.25, abs=0.5 / 254)
    emulated.spoil = spoil
    with pytest.raises(HydrostatError, match="does not answer with 22 sensors"):
        glove.read()


def test_errors_of_poses_left_out_are_those_of_fits_made_anew() -> None:
    made = mimicked(25, noise=0.01, repeats=2, bent=0.2)
    penalty, which, total = 0.3, np.array(made.poses), 0.0
    for pose in range(25):
        out = which == pose
        inputs, answers = made.inputs[~out], made.answers[~out]
        table = np.vstack([inputs - inputs.mean(0), np.sqrt(penalty) * np.eye(SENSORS)])
        wanted = np.vstack([answers - answers.mean(0), np.zeros((SENSORS, OUTPUTS))])
        weights = np.linalg.lstsq(table, wanted, rcond=None)[0]
        told = answers.mean(0) + (made.inputs[out] - inputs.mean(0)) @ weights
        total += np.sum((told - made.answers[out]) ** 2)
    anew = np.sqrt(total / made.answers.size)
    assert left_out_error(made.inputs, made.answers, made.poses, penalty) == pytest.approx(anew, rel=1e-9)
    assert folded_error(made.inputs, made.answers, made.poses, penalty, folds=25) == pytest.approx(anew, rel=1e-9)


def test_a_hundred_and_twenty_poses() -> None:
    made = mimicked(120, repeats=8, noise=0.5 / 254)  # noise of half a step makes the mean finer than a step
    mean = averaged(made, 8)
    known = mean.learn()
    one, folds = mean.errors(known)
    other = mimicked(200, repeats=8, noise=0.5 / 254, seed=9)
    error = np.sqrt(np.mean((known(averaged(other, 8).inputs) - other.answers[::8]) ** 2))
    assert max(one, folds, error) < MARK
    assert one == pytest.approx(error, rel=0.15)


def test_the_penalty_is_chosen_by_poses_left_out() -> None:
    made = mimicked(24, noise=0.03)
    known = made.learn()
    plain = fit_ridge(made.inputs, made.answers, made.poses, penalty=1e-9)
    other = mimicked(300, noise=0.03, seed=9)

    def error(ridge) -> float:
        return float(np.sqrt(np.mean((ridge(other.inputs) - other.answers) ** 2)))

    assert error(known) < 0.8 * error(plain)


def test_poses_chosen_for_information_teach_more_than_poses_at_random() -> None:
    random = np.random.default_rng(5)
    other = mimicked(200, noise=0.01, seed=9)
    errors = {True: [], False: []}
    for seed in range(6):
        pool = random.uniform(-1, 1, (150, OUTPUTS)) * random.uniform(0.1, 1, (150, 1))
        for chosen, told in errors.items():
            emulated = EmulatedGlove(np.zeros(SENSORS), noise=0.01, seed=seed)
            glove, made = CyberGlove(emulated), Mimicry(CyberGlove.names, [f"{n}" for n in range(OUTPUTS)])
            for pose in range(25):
                pick = made.next_pose(pool) if chosen else int(random.integers(len(pool)))
                emulated.values = shown(pool[pick])
                made.add(pose, glove.read().values, pool[pick])
            told.append(np.sqrt(np.mean((made.learn()(other.inputs) - other.answers) ** 2)))
    assert np.mean(errors[True]) < 0.8 * np.mean(errors[False])


def test_pairs_are_kept_as_text_and_as_mcap(tmp_path: Path) -> None:
    made = mimicked(4, noise=0.01, repeats=2)
    made.stamps = [0.5 * row for row in range(8)]
    made.forget(2)
    assert made.poses == [0, 0, 1, 1, 3, 3]
    read = Mimicry.open(made.save(tmp_path / "poses.csv"))
    assert (read.poses, read.stamps) == (made.poses, [0.0, 0.5, 1.0, 1.5, 3.0, 3.5])
    assert (read.sensors, read.outputs) == (made.sensors, made.outputs)
    assert np.array_equal(read.inputs, made.inputs)
    assert np.array_equal(read.answers, made.answers)
    mcap = pytest.importorskip("mcap.reader")
    path = read.write_mcap(tmp_path / "poses.mcap")
    told = list(mcap.make_reader(io.BytesIO(path.read_bytes())).iter_messages())
    assert [channel.topic for _, channel, _ in told].count("/glove") == 6
    schema, channel, message = next(each for each in told if each[1].topic == "/robot" and each[2].log_time == 10**9)
    assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
    content = json.loads(message.data)
    assert content["pose"] == 1
    assert [content[name] for name in made.outputs] == made.answers[2].tolist()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "no table of mimicked poses"),
        ("pose,time_s,sensor a,b\n0,0,1\n", "line 2"),
        ("pose,time_s,sensor a,b\n0,0,x,1\n", "line 2"),
    ],
)
def test_tables_that_are_none(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "poses.csv").write_text(text)
    with pytest.raises(InputError, match=told):
        Mimicry.open(tmp_path / "poses.csv")


def test_too_few_poses_are_told() -> None:
    with pytest.raises(InputError, match="1 poses are too few"):
        mimicked(1).learn()
