"""`play` by a clock that only the test moves. Oracles: `ContractionProfile.at`, and the travel at a motor's speed."""

from collections.abc import Callable

import numpy as np
import pytest

from hydrostat.arrays import Vector
from hydrostat.control import Link, Motors, Player, SimulatedLink
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Winch
from hydrostat.simulation import ContractionProfile

WINCHES = (Winch(name="left", at=(0.0, 0.0)), Winch(name="feet", at=(0.0, 0.0)))
TABLE = ContractionProfile(times=np.array([0.0, 1.0, 2.0]), values=np.array([[0.01, 0.0], [0.03, 0.02], [0.02, 0.0]]))


class Clock:
    """Time passes when somebody waits."""

    def __init__(self) -> None:
        self.time = 1000.0

    def __call__(self) -> float:
        return self.time

    def wait(self, seconds: float) -> None:
        self.time += seconds


class Heard(SimulatedLink):
    """Motors that remember what they were told, and when; their line may break, or a winch be stuck."""

    def __init__(self) -> None:
        super().__init__(np.zeros(2))
        self.heard: list[tuple[float, Vector]] = []
        self.stops = 0
        self.breaks_at = np.inf
        self.stuck = False

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        if now >= self.breaks_at:
            raise HydrostatError("the line is broken")
        self.heard.append((now, contractions))
        super().send(contractions * (not self.stuck), now, speed=speed)

    def stop(self) -> None:
        self.stops += 1
        super().stop()


def played(link: Link, clock: Clock, tell: Callable[[Motors, Player], None] | None = None, **settings: float) -> Motors:
    """Motors that have played the table."""
    motors, player = Motors(WINCHES, link), Player()
    player.rounds = settings.get("rounds", 1)
    player.set_speed(settings.get("speed", 1.0))
    player.run(motors, TABLE, clock=clock, wait=clock.wait, tell=lambda: tell(motors, player) if tell else None)
    return motors


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
def test_it_goes_to_the_first_row_and_then_keeps_time(speed: float) -> None:
    link, clock = Heard(), Clock()
    motors = played(link, clock, speed=speed)
    moving = next(number for number, (_, command) in enumerate(link.heard) if command.tolist() != [0.01, 0.0])
    begin = link.heard[moving - 1][0]
    assert begin - 1000 == pytest.approx(0.01 / 0.15, abs=0.04)
    for now, command in link.heard[moving:]:
        assert command == pytest.approx(TABLE.at(speed * (now - begin)), abs=1e-9)
    assert link.heard[-1][0] - begin == pytest.approx(2.0 / speed, abs=0.1)
    assert motors.places == pytest.approx([0.02, 0.0])
    assert link.stops == 1


def test_motors_are_told_often_enough_for_their_watch() -> None:
    link = Heard()
    played(link, Clock())
    assert np.diff([now for now, _ in link.heard]).max() < 0.02


def test_rounds_follow_one_another() -> None:
    rounds: list[int] = []
    clock = Clock()
    played(Heard(), clock, lambda motors, player: rounds.append(player.done), rounds=3)
    assert sorted(set(rounds)) == [0, 1, 2, 3]
    assert clock.time - 1000 == pytest.approx(6.0, abs=0.3)


def test_it_plays_until_it_is_told_to_stop() -> None:
    clock = Clock()

    def stop(motors: Motors, player: Player) -> None:
        if clock.time > 1010:
            player.stop()

    link = Heard()
    motors = played(link, clock, stop, rounds=np.inf)
    assert 1010 < clock.time < 1011
    assert not motors.is_moving
    assert link.stops == 1


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(143), ZeroDivisionError()])
def test_interrupted_they_hold_where_they_are(error: BaseException) -> None:
    link, clock = Heard(), Clock()
    seen: list[Motors] = []

    def interrupt(motors: Motors, player: Player) -> None:
        seen[:] = [motors]
        if player.time > 0.5:
            raise error

    with pytest.raises(type(error)):
        played(link, clock, interrupt)
    here = seen[0].places
    assert 0.01 < here[0] < 0.03
    assert link.stops == 1
    assert seen[0].command.tolist() == here.tolist()
    assert link.read(clock.time + 0.4) == pytest.approx(here)


def test_a_broken_line_stops_them() -> None:
    link = Heard()
    link.breaks_at = 1001.0
    with pytest.raises(HydrostatError, match="the line is broken"):
        played(link, Clock())
    assert link.stops >= 1


def test_a_program_that_stood_still_too_long_stops_them() -> None:
    """As after Ctrl-Z and fg: the motors' own watch has stopped them, and nothing jumps ahead."""
    link, clock = Heard(), Clock()

    def doze(motors: Motors, player: Player) -> None:
        if player.time > 0.5:
            clock.time += 9.0

    with pytest.raises(HydrostatError, match=r"told nothing for 9\.0 s, longer than 0\.5 s"):
        played(link, clock, doze)
    assert link.heard[-1][1][0] < 0.025


def test_a_winch_that_does_not_arrive_is_told() -> None:
    link, clock = Heard(), Clock()
    link.stuck = True
    with pytest.raises(HydrostatError, match=r"left stays at 0\.0 mm and should be at 10\.0 mm"):
        played(link, clock)
    assert clock.time - 1000 == pytest.approx(0.01 / 0.15 + 2.0, abs=0.1)
    assert link.stops >= 1


def test_beyond_a_limit_nothing_is_sent() -> None:
    link, clock = Heard(), Clock()
    motors = Motors((WINCHES[0], Winch(name="feet", at=(0.0, 0.0), travel=0.01)), link)
    with pytest.raises(InputError, match=r"feet is at its limit of 10\.0 mm"):
        Player().run(motors, TABLE, clock=clock, wait=clock.wait)
    assert max(command[1] for _, command in link.heard) <= 0.01
    assert link.stops == 1


def test_one_row_is_gone_to() -> None:
    link, clock = Heard(), Clock()
    motors = Motors(WINCHES, link)
    player = Player()
    player.rounds = 2
    player.run(
        motors, ContractionProfile(times=np.zeros(1), values=np.array([[0.03, 0.0]])), clock=clock, wait=clock.wait
    )
    assert motors.places == pytest.approx([0.03, 0.0])
