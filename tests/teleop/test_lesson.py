"""A lesson of poses. Oracles: an emulated person, whose hand follows by a known mixture, and beats that are counted."""

import time

import numpy as np
import pytest

from hydrostat.control import Motors, SimulatedLink
from hydrostat.errors import HydrostatError
from hydrostat.robot import Winch
from hydrostat.teleop import CyberGlove, EmulatedPerson, HeldStill, LessonPoses, Mimicry, go_there
from hydrostat.teleop.source import DriveChannels, HandReading, HandSource

COUNT = 10
CHANNELS = DriveChannels(
    names=tuple(f"winch {index}" for index in range(COUNT)),
    low=np.zeros(COUNT),
    high=np.full(COUNT, 0.04),
    rest=np.zeros(COUNT),
    groups=tuple((index,) for index in range(COUNT)),
)


def lesson() -> LessonPoses:
    pool = LessonPoses.pool(CHANNELS)
    return LessonPoses(Mimicry(CyberGlove.names, CHANNELS.names), pool, pool)


def test_poses_are_within_limits_and_the_first_is_the_rest() -> None:
    pool = LessonPoses.pool(CHANNELS)
    assert (pool >= CHANNELS.low).all()
    assert (pool <= 0.4 * CHANNELS.high + 1e-12).all()
    course = lesson()
    assert (course.next_pose() == 0).all()


@pytest.mark.parametrize(("bent", "enough"), [(0.0, 0.0026), (0.05, 0.01)])
def test_forty_poses_of_a_person_who_holds_still(bent: float, enough: float) -> None:
    """Error as the thesis counts it, of contractions whose range is from -1 to 1."""
    course, person = lesson(), EmulatedPerson(CHANNELS.low, CHANNELS.high, bent=bent)
    glove, told = CyberGlove(person.glove), iter(np.arange(0.0, 1e4, 1 / 90))
    for _ in range(40):
        contractions = course.next_pose()
        person.mimic(contractions)
        held = HeldStill.wait(glove, clock=lambda: float(next(told)))
        assert held.still
        assert 25 <= held.readings <= 29
        course.take(held, contractions)
    known = course.made.learn()
    other, errors = np.random.default_rng(5).uniform(0, 0.4, (200, COUNT)) * CHANNELS.high, []
    for contractions in other:
        person.mimic(contractions)
        values = np.mean([glove.read().values for _ in range(27)], axis=0)
        errors.append(known(values) - contractions)
    error = 2 * float(np.sqrt(np.mean(np.square(errors)))) / course.span
    assert error < 2 * enough
    assert "40 poses; cross-validation error: leave-one-out" in course.summary()
    assert float(course.summary().split("(")[1].split(")")[0]) == pytest.approx(error, rel=0.4)


def test_a_hand_that_moves_is_told_from_one_that_holds_still() -> None:
    person, times = EmulatedPerson(CHANNELS.low, CHANNELS.high), iter(np.arange(0.0, 1e4, 1 / 90))
    glove, beats = CyberGlove(person.glove), []

    def beat() -> None:
        beats.append(1)
        person.mimic(np.full(COUNT, 0.0004 * len(beats)))

    held = HeldStill.wait(glove, beat, clock=lambda: float(next(times)))
    assert not held.still
    assert len(beats) == held.readings - 1  # motors are told after each reading


def test_one_joint_that_moves_is_enough_to_move() -> None:
    """Oracle: one of 22 sensors swings by 0.05, four times what a still hand varies; their mean hides it."""

    class Hand(HandSource):
        times = 0

        def read(self) -> HandReading:
            self.times += 1
            return HandReading(np.append(np.zeros(21), 0.05 * (-1) ** self.times), 0.0)

        def close(self) -> None:
            pass

    told = iter(np.arange(0.0, 1e4, 1 / 90))
    assert not HeldStill.wait(Hand(), clock=lambda: float(next(told))).still


def test_motors_get_there_or_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    winches = [Winch(name="left", at=(0.0, 0.0), spool_radius=0.006, travel=0.04)]
    motors = Motors(winches, SimulatedLink(np.zeros(1)))
    go_there(motors, np.array([0.005]), lambda: motors.drive(time.monotonic()))
    assert motors.places == pytest.approx([0.005])
    monkeypatch.setattr("hydrostat.teleop.lesson_poses.ARRIVAL_TIME", 0.1)
    with pytest.raises(HydrostatError, match="left: target not reached in time"):
        go_there(motors, np.array([0.02]), lambda: None)
