"""`PortablePolicy`: networks from what is seen to an action. Oracles: sums by hand, forged files."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.learning import PortablePolicy
from hydrostat.learning.perceptrons import Perceptrons

FACTS = {"task": "walk", "robot": "strip", "physics": "0", "sees": [["goal", 1], ["place", 2]], "actions": 2}


def policy() -> PortablePolicy:
    """tanh of two sums."""
    weights = np.array([[1.0, 0.5, 0.0], [0.0, 0.25, -1.0]])
    return PortablePolicy(
        facts={**FACTS, "error": 0.0}, network=Perceptrons.of_layers([(weights, np.array([0.0, 0.125]))])
    )


def test_actions_are_sums_squashed(tmp_path: Path) -> None:
    kept = PortablePolicy.load(policy().save(tmp_path / "actor.policy"))
    action = kept.act({"goal": np.array([0.5]), "place": np.array([1.0, 2.0])})
    assert action == pytest.approx(np.tanh([0.5 + 0.5, 0.25 - 2.0 + 0.125]), abs=1e-12)
    assert kept.facts == policy().facts
    with pytest.raises(InputError, match="must see 2 finite numbers of place"):
        kept.act({"goal": np.array([0.5])})


def test_numbers_that_overflow_are_no_action() -> None:
    """A sound file may hold any numbers: of some the layers make inf - inf."""
    wide = np.array([[3e38, 3e38], [3e38, 3e38]])
    network = Perceptrons.of_layers(
        [(wide[:, :1], np.zeros(2)), *9 * [(wide, np.zeros(2))], (wide - 6e38 * np.eye(2), np.zeros(2))]
    )
    forged = PortablePolicy(facts={"sees": [["goal", 1]], "actions": 2}, network=network)
    with pytest.raises(InputError, match="the policy answers with no number"):
        forged.act({"goal": np.array([1.0])})


@pytest.mark.parametrize(
    "change",
    [
        lambda header: header["facts"].update(actions=3),
        lambda header: header["facts"].update(actions=True),
        lambda header: header["facts"].update(sees=[]),
        lambda header: header["facts"].update(sees=[["goal", -1], ["place", 4]]),
        lambda header: header["facts"].update(sees=7),
        lambda header: header["facts"].update(error=float("inf")),
        lambda header: header["facts"].pop("task"),
        lambda header: header["arrays"].pop(),
        lambda header: header["arrays"][0].__setitem__(0, "other"),
    ],
)
def test_no_forged_file_answers(change: Callable[[dict], object], tmp_path: Path) -> None:
    file = policy().save(tmp_path / "actor.policy")
    whole = file.read_bytes()
    length = int.from_bytes(whole[8:16], "little")
    header = json.loads(whole[16 : 16 + length])
    change(header)
    text = json.dumps(header).encode()
    content = whole[:8] + len(text).to_bytes(8, "little") + text + whole[16 + length : -32]
    file.write_bytes(content + hashlib.sha256(content).digest())
    with pytest.raises(InputError, match="is no sound policy"):
        PortablePolicy.load(file)
    file.write_bytes(whole[:-1])
    with pytest.raises(InputError, match="is damaged"):
        PortablePolicy.load(file)
