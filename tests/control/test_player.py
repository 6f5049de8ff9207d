"""Oracle: closed form: the playhead is at speed times time, modulo the length."""

from math import inf

import pytest

from hydrostat.control.player import Player
from hydrostat.errors import InputError


def playing(*, loop: bool = False, speed: float = 1.0) -> Player:
    player = Player()
    player.rounds = inf if loop else 1
    player.set_speed(speed)
    player.play(4.0)
    player.advance(100.0, 4.0)
    return player


def test_it_follows_the_clock_from_when_it_is_first_told() -> None:
    player = playing()
    assert player.time == 0.0
    player.advance(101.25, 4.0)
    assert player.time == pytest.approx(1.25)
    assert player.playing


def test_it_stops_at_the_end_and_starts_anew() -> None:
    player = playing()
    player.advance(109.0, 4.0)
    assert (player.time, player.playing) == (4.0, False)
    player.advance(110.0, 4.0)
    assert player.time == 4.0
    player.play(4.0)
    assert (player.time, player.playing) == (0.0, True)


def test_in_a_loop_it_misses_what_was_between() -> None:
    player = playing(loop=True, speed=2.0)
    player.advance(100.0 + 4.5, 4.0)
    assert player.time == pytest.approx(1.0)
    assert player.playing


def test_so_many_rounds_then_it_stops_at_the_end() -> None:
    player = playing()
    player.rounds = 3
    for now, time, done in ((103.0, 3.0, 0), (105.0, 1.0, 1), (109.5, 1.5, 2), (111.5, 3.5, 2)):
        player.advance(now, 4.0)
        assert (player.time, player.done, player.playing) == (pytest.approx(time), done, True)
    player.advance(112.0, 4.0)
    assert (player.time, player.done, player.playing) == (4.0, 3, False)
    player.play(4.0)
    assert (player.time, player.done) == (0.0, 0)


def test_rounds_that_pass_unseen_count() -> None:
    player = playing()
    player.rounds = 3
    player.advance(109.0, 4.0)
    assert (player.time, player.done) == (pytest.approx(1.0), 2)


def test_what_takes_no_time_is_played_once_a_look() -> None:
    player = Player()
    player.rounds = 2
    player.play(0.0)
    for now in (1.0, 2.0):
        assert player.playing
        player.advance(now, 0.0)
    assert (player.time, player.playing) == (0.0, False)


def test_a_change_of_speed_does_not_jump() -> None:
    player = playing()
    player.advance(101.0, 4.0)
    player.set_speed(0.5)
    player.advance(102.0, 4.0)
    assert player.time == pytest.approx(1.5)


@pytest.mark.parametrize("speed", [0.0, 0.05, 4.5, -1.0, float("nan"), float("inf")])
def test_speeds_out_of_range_are_refused(speed: float) -> None:
    with pytest.raises(InputError, match=r"from 0.1 to 4"):
        Player().set_speed(speed)
