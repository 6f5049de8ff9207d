"""What a screen says is checked before anything is done with it; oracle: what JSON and the records allow."""

import json

import pytest

from hydrostat.errors import InputError
from hydrostat.studio.face.messages import MAX_LETTERS, LetGo, Pointer, Seen, read_message

POINTER = {"kind": "drag", "key": "body", "rest": [0.1, 0, 0], "world": [0.1, -2, 3.5], "shift": True, "stamp": 12.5}


def test_all_kinds_are_read() -> None:
    message = read_message(json.dumps(POINTER))
    assert isinstance(message, Pointer)
    assert message.model_dump() == POINTER
    for kind in ("grab", "click"):
        short = read_message(json.dumps({"kind": kind, "world": [0, 0, 0]}))
        assert isinstance(short, Pointer)
        assert (short.key, short.rest, short.shift) == ("", None, False)
    assert isinstance(read_message('{"kind": "release"}'), LetGo)
    assert isinstance(read_message('{"kind": "seen"}'), Seen)


@pytest.mark.parametrize(
    "change",
    [{"kind": "eval"}, {"kind": None}, {"kind": ["drag"]}, {"world": [0, 0]}, {"world": [0, 0, 0, 0]}, {"world": None},
     {"world": "0,0,0"}, {"world": [0, 0, "0"]}, {"world": [0, 0, 1e9]}, {"world": [0, 0, float("nan")]},
     {"world": [0, 0, float("inf")]}, {"world": [0, 0, True]}, {"world": [0, 0, None]}, {"world": {"0": 0}},
     {"rest": [0, 0, float("nan")]}, {"rest": []}, {"rest": [[0], [0], [0]]}, {"stamp": -1}, {"stamp": float("nan")},
     {"stamp": float("inf")}, {"stamp": "12"}, {"stamp": 10**400}, {"key": 7}, {"key": "k" * 201}, {"key": None},
     {"shift": "yes"}, {"shift": 1}, {"more": 1}, {"__class__": "Session"}],
)  # fmt: skip
def test_wrong_values_are_refused(change: dict[str, object]) -> None:
    with pytest.raises(InputError):
        read_message(json.dumps({**POINTER, **change}))


@pytest.mark.parametrize(
    "text",
    ["", " ", "null", "[]", "7", '"grab"', "{", "{}", '{"kind": "grab"}', '{"kind": "seen"', '{"kind": "seen", "x": 1}',
     "{'kind': 'seen'}", '{"kind": "seen"} {"kind": "seen"}', "NaN", "\0", '{"kind": "se\\u0000en"}', "[" * MAX_LETTERS,
     '{"kind":' * 500, '{"kind": "grab", "world": ' + "[" * 1000 + "]" * 1000 + "}",
     '{"kind": "grab", "key": "\\ud800", "world": [0, 0, 0]}', '{"kind": "seen", "x": "' + "y" * MAX_LETTERS + '"}'],
)  # fmt: skip
def test_what_is_no_message_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        read_message(text)
