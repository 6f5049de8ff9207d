"""The firmware in closed loop, one protocol on all boards. Oracles: motors by their own equations, limits, words."""

import numpy as np
import pytest
from firmware_bench import Board

from hydrostat.control.firmware_bus import line_of

FULL = "A 1500 1500"  # armed with all the current that its settings allow
DEADLINE = 0.25  # motors stand so long after the last good line [s]


@pytest.fixture(params=["atmega328p", "esp32s3"])
def chip(request: pytest.FixtureRequest) -> str:
    """An Uno in simavr; the sketch for an ESP32-S3, compiled for this computer."""
    return request.param


@pytest.mark.parametrize("chip", ["atmega328p", "atmega2560", "esp32s3"])
def test_two_winches_reach_their_goals_against_springs(chip: str) -> None:
    """Within four counts of 4,000, at no more than the speeds asked for and 8 %, with little overshoot."""
    board = Board(chip)
    name = {"atmega328p": "uno", "atmega2560": "mega"}.get(chip, chip)
    assert board.ask("I") == f"ok hydrostat 1 {name} trial 2 200 started new"
    assert board.ask(FULL) == "ok"
    for winch in board.winches:
        winch.stiffness, winch.slack = 5e-4, 100.0
    assert board.ask("G 900 2000 400 1000") == "ok"
    said = board.keep(2.0).split()
    assert said[:3] == ["ok", "armed", "0"]
    for told, goal, fastest, winch in zip(said[3::2], (900, 400), (2000, 1000), board.winches, strict=True):
        assert abs(int(told) - goal) <= 4
        assert winch.angle == pytest.approx(int(told) + 0.5, abs=1.0)
        assert 0.8 * fastest < winch.fastest < 1.08 * fastest
        assert winch.most < goal + 25
    assert 0.25 < board.winches[0].current < 0.6  # what the spring pulls, 0.4 A, give or take friction
    assert int(said[4]) == pytest.approx(1000 * abs(board.winches[0].current), abs=150)


def test_currents_have_the_sign_of_the_pull(chip: str) -> None:
    """Oracle: currents of the motors' own equations, as a spring is wound, held, and let out by a motor that brakes it.

    The board measures no sign: it tells that of the volts across the coil.
    """
    board, seen, braked = Board(chip), [], 0
    board.ask(FULL)
    board.winches[0].stiffness, board.winches[0].slack = 8e-4, 100.0
    for goal, seconds in ((1000, 0.9), (1000, 0.3), (150, 1.2), (0, 0.3), (90, 0.1), (0, 0.2)):
        board.ask(f"G {goal} 1200 0 1")
        for _ in range(round(seconds / 0.02)):
            told = int(board.ask("R").split()[4]) / 1000
            true, speed = board.winches[0].current, board.winches[0].speed
            seen.append((told, true))
            braked += speed < -500 and true > 0.1 and told > 0
            board.run(0.007)
    told, true = np.array(seen).T
    sure = np.abs(true) > 0.15
    assert sure.sum() > 60
    assert (true < -0.15).sum() > 5
    assert (np.sign(told) == np.sign(true))[sure].mean() > 0.97
    assert np.median(np.abs(told - true)) < 0.05
    assert braked > 5


def test_silence_stops_motors(chip: str) -> None:
    """A board that hears nothing good stands within the deadline, says so, and takes no goals until it is armed."""
    board = Board(chip)
    board.ask(FULL)
    board.ask("G 4000 1000 4000 1000")
    board.run(0.1)
    assert board.winches[0].speed > 800
    for _ in range(6):  # lines that are not good are no sign of life
        board.ask_bytes(b"7 R*0000\n")
        board.run(0.005)
    board.run(DEADLINE - 0.1 - 6 * 0.0134)
    where = board.winches[0].angle
    board.run(0.2)
    assert abs(board.winches[0].angle - where) < 6  # one that went on would be 200 farther
    assert board.winches[0].angle < 500
    assert board.ask("R").startswith("ok silent 0 ")
    assert board.ask("G 100 100 100 100") == "no silent"
    assert board.ask(FULL) == "ok"
    assert board.ask("G 100 1000 100 1000") == "ok"
    board.keep(0.6)
    assert board.winches[0].angle == pytest.approx(100.5, abs=3)


def test_a_program_that_hangs_is_reset_and_lets_go(chip: str) -> None:
    """The hardware watchdog switches the bridges off within the deadline; the board says why it started."""
    board = Board(chip)
    board.ask(FULL)
    board.ask("G 4000 1000 4000 1000")
    board.run(0.1)
    board.hang()
    board.run(DEADLINE)
    where = board.winches[0].angle
    board.run(0.1)
    assert board.winches[0].angle == where
    assert board.ask("I").endswith(" watchdog new")
    assert board.ask("R").startswith("ok off 0 ")


@pytest.mark.parametrize(("current", "word"), [(300, "current"), (1500, "stall")])
def test_a_shaft_that_is_held_stops_its_motor(chip: str, current: int, word: str) -> None:
    """By its bound of current, or because it does not turn; all motors lose power, and the answer names it."""
    board = Board(chip)
    board.ask(f"A 1500 {current}")
    board.winches[1].block = 1
    board.winches[1].wire = 6.0
    board.ask("G 500 500 500 500")
    said = board.keep(1.0)
    assert said.startswith(f"ok {word} 2 "), said
    assert all(abs(winch.current) < 0.05 for winch in board.winches)
    assert board.ask("G 0 100 0 100") == f"no {word}"


@pytest.mark.parametrize("cut", [1, 2, 3], ids=["cable", "one wire", "wires swapped"])
def test_an_encoder_that_is_cut_stops_its_motor(chip: str, cut: int) -> None:
    """It runs at full power and is not seen to turn, trembles to and fro by a count, or is seen to turn away."""
    board = Board(chip)
    board.ask(FULL)
    board.winches[0].cut = cut
    board.ask("G 500 500 500 500")
    assert board.keep(0.8).split()[1:3] in (["stall", "1"], ["beyond", "1"])
    assert board.winches[0].angle < 1000


def test_lines_that_are_not_good_are_refused_in_words(chip: str) -> None:
    """Nothing moves; each is told why."""
    board = Board(chip)
    assert board.ask("G 10 10 10 10") == "no off"
    assert board.ask(FULL) == "ok"
    good = line_of(f"{board.number + 1} G 500 1000 500 1000")
    assert board.ask_bytes(good.replace(b"500", b"600", 1)) == "no checksum"
    assert board.ask_bytes(good[:-6] + b"\n") == "no checksum"
    assert board.ask_bytes(line_of("G 500 1000 500 1000")) == "no number"
    assert board.ask_bytes(b"9" * 300) == "no long"
    assert board.ask_bytes(b"\n") == "no checksum"
    assert board.ask_bytes(good[:12]) == ""
    board.run(0.1)
    assert board.read(99).startswith(b"? no half*")
    assert board.ask("G 10 10 10 10", number=board.number) == "no old"
    assert board.ask("G 10 10 10 10", number=(board.number - 5) % 256) == "no old"
    board.number += 5
    assert board.ask(FULL) == "ok"
    for words, why in (
        ("G 500 1000 500", "goals"),
        ("G 500 1000 500 x", "goals"),
        ("G 4001 100 0 100", "limit"),
        ("G 0 100 -201 100", "limit"),
        ("A 1501 100", "current"),
        ("A 0 100", "current"),
        ("A 100", "currents"),
        ("Q", "word"),
    ):
        assert board.ask(words) == f"no {why}"
    assert max(winch.most for winch in board.winches) < 1.5


def test_bounds_that_are_refused_change_none(chip: str) -> None:
    """Of two bounds the second is too great: the first motor keeps the one that it had, and stops by it."""
    board = Board(chip)
    board.ask("A 300 1500")
    assert board.ask("A 1500 1501") == "no current"
    board.winches[0].block = 1
    board.winches[0].wire = 6.0
    board.ask("G 500 500 0 1")
    assert board.keep(1.0).startswith("ok current 1 ")


def test_limits_of_place_and_speed_hold_whatever_is_asked(chip: str) -> None:
    """From one end to the other, asked for ten times the speed; then power is off."""
    board = Board(chip)
    board.ask(FULL)
    for goal, seconds in ((4000, 2.0), (-200, 1.9)):
        board.ask(f"G {goal} 30000 0 1")
        board.keep(seconds)
        assert board.winches[0].angle == pytest.approx(goal + 0.5, abs=4 if chip == "esp32s3" else 3)
    assert board.winches[0].fastest < 1.08 * 3000
    assert board.winches[0].least > -230
    assert board.winches[0].most < 4030
    board.ask("O")
    assert all(winch.current == pytest.approx(0.0, abs=0.05) for winch in board.winches)


def test_a_stop_stops_at_once_even_when_it_is_old(chip: str) -> None:
    """Motors stand where they are, with torque."""
    board = Board(chip)
    board.ask(FULL)
    board.ask("G 4000 1500 4000 1500")
    board.run(0.1)
    where = board.winches[0].angle
    board.ask("S", number=board.number)
    said = board.keep(0.4)
    assert board.winches[0].angle - where < 120
    assert abs(board.winches[0].speed) < 20
    assert said.startswith("ok armed 0 ")


def test_a_mega_drives_six_motors_and_eight_servos() -> None:
    """The third motor's encoder is on another port than the first's; a servo's pulse is what was asked."""
    board = Board("atmega2560", full=True)
    assert board.ask("I") == "ok hydrostat 1 mega full 14 200 started new"
    assert board.ask("A" + 6 * " 1500" + 8 * " 1") == "ok"
    goals = "G 500 1500 0 1 300 1500" + 3 * " 0 1" + " 1500 1000" + 7 * " 1000 1000"
    assert board.ask(goals) == "ok"
    said = board.keep(1.2).split()
    assert said[1:3] == ["armed", "0"]
    assert [int(place) for place in said[3::2]] == pytest.approx([500, 0, 300, 0, 0, 0, 1500] + 7 * [1000], abs=4)
    assert [winch.angle for winch in board.winches] == pytest.approx([500.5, 300.5], abs=5)
    assert board.pulse() == pytest.approx(1.5e-3, abs=2e-5)
    assert board.ask(goals.replace("1500 1000", "2001 1000")) == "no limit"
