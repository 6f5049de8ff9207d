"""Oracles: values written down by hand, and `ContractionProfile`, which has tests of its own."""

import pytest

from hydrostat.control.timeline import KEY_TOLERANCE, MAX_KEYS, Key, Timeline
from hydrostat.errors import InputError


def two_keys(*, smooth: bool = False) -> Timeline:
    keys = (Key(time=1.0, contractions={"left": 0.0}), Key(time=3.0, contractions={"left": 0.02, "right": 0.01}))
    return Timeline(keys=keys, smooth=smooth)


@pytest.mark.parametrize(("smooth", "share"), [(False, 0.25), (True, 3 * 0.25**2 - 2 * 0.25**3)])
def test_between_keys_it_goes_along_a_line_or_gently(smooth: bool, share: float) -> None:
    profile = two_keys(smooth=smooth).profile(["right", "left"])
    assert profile.at(1.5) == pytest.approx([0.01 * share, 0.02 * share])
    assert profile.at(0.0) == pytest.approx([0.0, 0.0])
    assert profile.at(9.0) == pytest.approx([0.01, 0.02])


def test_without_keys_nothing_is_taken_in() -> None:
    assert Timeline().profile(["left"]).at(2.0) == pytest.approx([0.0])


def test_it_is_as_long_as_said_or_as_its_last_key() -> None:
    assert two_keys().seconds == 4.0
    assert two_keys().with_key(Key(time=7.5, contractions={})).seconds == 7.5


def test_a_moved_key_replaces_one_that_is_there() -> None:
    timeline = two_keys()
    assert [key.time for key in timeline.move_key(0, 3.5).keys] == [3.0, 3.5]
    assert timeline.move_key(0, 3.0 + KEY_TOLERANCE / 2).keys == (
        Key(time=3.0 + KEY_TOLERANCE / 2, contractions={"left": 0.0}),
    )
    assert timeline.index_at(3.0 - KEY_TOLERANCE / 2) == 1
    assert timeline.index_at(2.0) is None


@pytest.mark.parametrize("length", [0.0, -1.0, 601.0, float("nan")])
def test_a_length_out_of_range_is_refused(length: float) -> None:
    with pytest.raises(InputError, match=r"from 0.1 to 600 s"):
        Timeline(length=length)


def test_too_many_keys_are_refused() -> None:
    keys = tuple(Key(time=0.01 * index, contractions={}) for index in range(MAX_KEYS + 1))
    with pytest.raises(InputError, match="may have 2000 keyframes, not 2001"):
        Timeline(keys=keys)
