"""`ModelCard` and the facts in a model's file. Oracles: bytes and facts as versions before the card wrote them."""

import hashlib
import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import strip_robot
from plain_model import plain

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel, ModelCard

pytestmark = pytest.mark.usefixtures("unchecked")

OPTIONS = {"members": 3, "steps": None, "rate": 0.01}

FACTS: dict[str, Any] = {
    "robot": "strip",
    "physics": "0123abcd",
    "draws": ["antagonist"],
    "winches": ["W1", "W2"],
    "markers": ["tip"],
    "cables": ["C1", "C2"],
    "dim": 2,
    "node_count": 27,
    "size": 0.2,
    "pairs": [["W1", "W2"]],
    "contact": True,
    "contact_distance": 0.002,
    "contact_friction": 0.5,
    "version": "0.1.0",
    "samples": 200,
    "lost": 3,
    "error": 0.00123456789,
    "inverse_error": None,
    "displacement": 0.031,
    "stopped": False,
    "options": OPTIONS,
    "seconds": 12.34,
}
"""Facts in the order in which `hydrostat learn` wrote them before there was a card."""

FIRST = ("pairs", "contact_distance", "contact_friction")
"""Keys that the first version did not write."""

OPTIONAL = (*FIRST, "inverse_error", "corrected", "policy")


def written(facts: dict[str, Any], folder: Path) -> Path:
    """Write a file with such facts; its arrays are those of a plain model."""
    whole = plain(strip_robot(columns=8, rows=2)).save(folder / "plain.model").read_bytes()
    length = int.from_bytes(whole[8:16], "little")
    text = json.dumps({"facts": facts, "arrays": json.loads(whole[16 : 16 + length])["arrays"]}).encode()
    content = whole[:8] + len(text).to_bytes(8, "little") + text + whole[16 + length : -32]
    (folder / "old.model").write_bytes(content + hashlib.sha256(content).digest())
    return folder / "old.model"


@pytest.mark.parametrize("more", [{}, {"corrected": 8}, {"corrected": 8, "policy": "TQC"}, {"inverse_error": 0.002}])
def test_a_file_is_read_and_written_to_the_same_bytes(more: dict[str, Any], tmp_path: Path) -> None:
    old = written(FACTS | more, tmp_path)
    model = LearnedModel.load(old)
    for name, value in (FACTS | more).items():
        assert model.card.as_json()[name] == value
    assert model.save(tmp_path / "new.model").read_bytes() == old.read_bytes()


def test_a_file_of_the_first_version_is_read(tmp_path: Path) -> None:
    """It says no pairs, no distance and no friction: the distance is the usual one of the robot's contact."""
    felt = replace(strip_robot(columns=8, rows=2), contact=hs.Contact())
    facts = {name: value for name, value in FACTS.items() if name not in FIRST} | {"size": felt.body.mesh.size}
    card = LearnedModel.load(written(facts, tmp_path)).card
    assert (card.pairs, card.contact_distance, card.contact_friction) == ((), felt.contact_distance, 0.0)
    assert (card.corrected, card.policy) == (None, None)
    silent = LearnedModel.load(written(facts | {"contact": False}, tmp_path)).card
    assert (silent.contact, silent.contact_distance, silent.contact_friction) == (False, None, None)
    assert LearnedModel.load(written(FACTS | {"of another version": [1]}, tmp_path)).card == ModelCard.from_json(FACTS)


def test_a_card_is_given_back_by_its_json() -> None:
    card = ModelCard.from_json(FACTS)
    assert card.as_json() == FACTS
    assert list(card.as_json()) == list(FACTS)
    assert ModelCard.from_json(card.as_json()) == card
    assert {field.name for field in fields(card)} == {*FACTS, "corrected", "policy"}
    assert card.coordinates == 2
    assert (card.winches, card.pairs) == (("W1", "W2"), (("W1", "W2"),))
    assert tuple(card.known_contact) == (True, 0.002, 0.5)


@pytest.mark.parametrize("key", sorted(set(FACTS) - set(OPTIONAL)))
def test_a_missing_key_is_refused(key: str, tmp_path: Path) -> None:
    file = written({name: value for name, value in FACTS.items() if name != key}, tmp_path)
    with pytest.raises(InputError, match=rf'old\.model: is no sound model: "{key}" is missing$') as stop:
        LearnedModel.load(file)
    assert "\n" not in str(stop.value)
    with pytest.raises(InputError, match=f'"{key}" is missing$'):
        LearnedModel.load(written(FACTS | {key: None}, tmp_path))


FULL = FACTS | {"inverse_error": 0.1, "corrected": 8, "policy": "TQC"}

VALUES = ("x\ny", True, 2, 2.5, [7], {"a": 1})
"""One of each kind; the list is no list of names."""


def is_wrong(key: str, value: Any) -> bool:
    """Whether a value is of another kind than the key's; whole numbers stand for any number, true for none."""
    kinds = {float: (float, int), list: ()}.get(type(FULL[key]), (type(FULL[key]),))
    return type(value) not in kinds


@pytest.mark.parametrize(("key", "value"), [(key, value) for key in FULL for value in VALUES if is_wrong(key, value)])
def test_a_value_of_another_kind_is_refused(key: str, value: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf'old\.model: is no sound model: "{key}" ') as stop:
        LearnedModel.load(written(FULL | {key: value}, tmp_path))
    assert "\n" not in str(stop.value)


@pytest.mark.parametrize("key", [key for key, value in FULL.items() if isinstance(value, float)])
def test_a_whole_number_is_a_number(key: str, tmp_path: Path) -> None:
    assert getattr(LearnedModel.load(written(FULL | {key: 2}, tmp_path)).card, key) == 2


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *[
            (key, bad)
            for key in ("size", "error", "seconds", "displacement")
            for bad in (-1.0, np.nan, np.inf, 10**400)
        ],
        *[(key, bad) for key in ("contact_distance", "contact_friction", "inverse_error") for bad in (-1.0, np.nan)],
        *[(key, -1) for key in ("samples", "lost", "node_count", "corrected")],
        *[("dim", bad) for bad in (-1, 0, 1, 4, 10**9)],
        *[(key, ["a", "a"]) for key in ("winches", "markers", "cables")],
        ("pairs", [["W1", "nobody"]]),
        ("pairs", [["W1", "W1"]]),
        ("pairs", [["W1"], ["W2", "W1"]]),
        ("pairs", ["W1"]),
        ("pairs", [[["W1"]]]),
    ],
)
def test_a_value_out_of_range_is_refused(key: str, value: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf"old\.model: is no sound model: .*{key}.*") as stop:
        LearnedModel.load(written(FACTS | {key: value}, tmp_path))
    assert "\n" not in str(stop.value)
