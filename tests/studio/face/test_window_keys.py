"""Keys of the window. Oracle: calls that the session and the view get."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from hydrostat.given import Point
from hydrostat.studio.face.window import _key
from hydrostat.studio.stage import StageName


def press(
    name: str, *, stage: StageName = StageName.POSE, repeat: bool = False, held: str = "", aim: Point | None = None
) -> list[str]:
    """Calls that a key leads to, with a modifier held and the cross-hair at a place."""
    calls: list[str] = []
    editor = SimpleNamespace(cross_hair=SimpleNamespace(at=aim))
    session = SimpleNamespace(stage=stage, key=calls.append, undo=lambda: calls.append("undo"), editor=editor)
    page = SimpleNamespace(session=session, viewport=SimpleNamespace(view=calls.append))
    modifiers = SimpleNamespace(**{each: each == held for each in ("alt", "ctrl", "meta", "shift")})
    action = SimpleNamespace(keydown=True, repeat=repeat)
    event = SimpleNamespace(key=SimpleNamespace(name=name), modifiers=modifiers, action=action)
    _key(cast(Any, page), cast(Any, event), cast(Any, None), cast(Any, None))
    return calls


@pytest.mark.parametrize("name", ["ArrowUp", "PageUp"])
def test_a_held_arrow_repeats_for_targets_and_the_cross_hair_only(name: str) -> None:
    assert press(name, repeat=True) == [name.lower()]
    assert press(name, repeat=True, held="shift") == [f"shift {name.lower()}"]
    assert press(name, stage=StageName.EDIT, repeat=True) == []
    assert press(name, stage=StageName.EDIT, repeat=True, aim=(0.0, 0.0)) == [name.lower()]
    assert press(name, stage=StageName.DESIGN, repeat=True, aim=(0.0, 0.0)) == []
    assert press(name, stage=StageName.EDIT) == [name.lower()]
    assert press("r", repeat=True) == []


@pytest.mark.parametrize("held", ["ctrl", "meta", "alt"])
def test_keys_of_the_browser_are_left_to_it(held: str) -> None:
    assert [press(name, held=held) for name in ("1", "r", "ArrowLeft", " ")] == [[], [], [], []]
    assert press("z", held=held) == ([] if held == "alt" else ["undo"])
