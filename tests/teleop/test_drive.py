"""Motors that follow a person. Oracles: a scripted person, and the simulation itself."""

import os
import signal
import threading
import time
from collections.abc import Sequence
from math import inf

import numpy as np
import pytest

import hydrostat as hs
from hydrostat.control import Motors, SimulatedLink, TensionLookup
from hydrostat.errors import HydrostatError
from hydrostat.teleop import DriveLoop, DriveSource, MarkerMapper, WinchMapper, drive
from hydrostat.teleop.pose_process import FingertipPoses, PoseOnWay, PoseProcess, WinchPoses
from hydrostat.teleop.source import DriveWish


class Script(DriveSource):
    """A person who asks for one thing after the other; the last goes on."""

    def __init__(self, wishes: Sequence[DriveWish | Exception]) -> None:
        self.wishes = list(wishes)

    def read(self) -> DriveWish:
        wish = self.wishes.pop(0) if len(self.wishes) > 1 else self.wishes[0]
        if isinstance(wish, Exception):
            raise wish
        return wish

    def close(self) -> None:
        pass


@pytest.fixture(scope="module")
def simulation() -> hs.Simulation:
    return hs.Simulation(hs.load_robot("gallery:starfish"))


def motors_of(simulation: hs.Simulation) -> Motors:
    return Motors(simulation.robot.winches, SimulatedLink(np.zeros(len(simulation.robot.winches))))


def test_winches_go_where_they_are_told_step_by_step_and_within_limits(simulation: hs.Simulation) -> None:
    motors = motors_of(simulation)
    wishes = [
        DriveWish(stamp=0.0, places={"left": 0.004}),
        DriveWish(stamp=0.0, steps={"left": 0.001, "feet": 0.002}),
        DriveWish(stamp=0.0, places={"right": 9.0}),
        DriveWish(stamp=0.0),
    ]
    driven = DriveLoop(motors, WinchMapper(simulation, motors.places, solves=False), Script(wishes))
    now = 0.0
    for _ in range(60):
        now += 0.02
        assert driven.step(now)
    most = simulation.robot.winches[0].travel
    assert dict(zip(motors.names, motors.places, strict=True)) == pytest.approx(
        {"right": most, "left": 0.005, "feet": 0.002}
    )


@pytest.mark.parametrize("tips", [False, True])
def test_motors_hold_when_nobody_is_heard_and_go_on_after(simulation: hs.Simulation, tips: bool) -> None:
    motors = motors_of(simulation)
    motors.fastest = 0.03
    way = (MarkerMapper if tips else WinchMapper)(simulation, motors.places)
    name, far = ("left x", -0.05) if tips else ("left", 0.03)
    source = Script([DriveWish(stamp=0.0, places={name: far})])
    source.silence = 0.25
    driven, now, way.updated = DriveLoop(motors, way, source), 0.0, threading.Event()
    driven.step(now)
    assert not tips or way.updated.wait(30.0)  # the first pose
    for _ in range(10):
        now += 0.02
        driven.step(now)
    began = motors.places.copy()
    assert not driven.silent
    for _ in range(40):
        now += 0.02
        driven.step(now)
    assert driven.silent
    held = motors.places.copy()
    assert (np.abs(held - began) <= 0.03 * 0.1).all()  # it went on for less than 0.1 s
    assert np.abs(way.contractions - held).max() < 4e-3
    assert held.max() > 1e-4
    for _ in range(20):
        now += 0.02
        driven.step(now)
    assert motors.places == pytest.approx(held, abs=4e-3)
    source.wishes = [DriveWish(stamp=now, places={name: far})]
    for _ in range(10):
        now += 0.02
        driven.step(now)
    assert np.abs(motors.places - held).max() > 1e-3
    way.close()


def test_a_flood_of_wishes_leaves_the_line_its_time(simulation: hs.Simulation) -> None:
    """Oracle: a line on which reading takes 10 ms; goals that come sooner are told without, but not without end."""
    motors, now, read = motors_of(simulation), [0.0], []
    inner = motors.link.read

    def slow(when: float) -> np.ndarray:
        read.append(when)
        now[0] += 0.01
        return inner(when)

    motors.link.read = slow
    source = Script([DriveWish(stamp=inf, steps={"left": 1e-4})])
    way = WinchMapper(simulation, motors.places, solves=False)
    driven, told = DriveLoop(motors, way, source, clock=lambda: now[0]), 0
    while now[0] < 1.0:
        driven.step(now[0])
        told += 1
        now[0] += driven.pause + 1e-4  # the next wish is there at once
    assert 2 * len(read) < told < 4.1 * len(read)
    assert driven.motors.places.max() > 1e-3


def test_hold_and_then_only_what_is_touched_moves(simulation: hs.Simulation) -> None:
    motors = motors_of(simulation)
    going, hold = DriveWish(stamp=0.0, places={"left": 0.03}), DriveWish(stamp=0.0, hold=True)
    source = Script([going, hold, hold, DriveWish(stamp=0.0), DriveWish(stamp=0.0)])
    driven, now = DriveLoop(motors, WinchMapper(simulation, motors.places, solves=False), source), 0.0
    for _ in range(30):
        now += 0.02
        driven.step(now)
    assert motors.places.max() < 0.015 / 2


@pytest.mark.parametrize("wrong", [HydrostatError("the gamepad is gone"), ZeroDivisionError()])
def test_an_error_of_the_source_stops_the_motors(simulation: hs.Simulation, wrong: Exception) -> None:
    motors, stops = motors_of(simulation), []
    motors.link.stop = lambda: stops.append(1)
    way = WinchMapper(simulation, motors.places)
    with pytest.raises(type(wrong)):
        drive(motors, way, Script([DriveWish(stamp=0.0), wrong]))
    assert stops


def test_it_ends_by_the_person_or_in_time(simulation: hs.Simulation) -> None:
    motors, begin = motors_of(simulation), time.monotonic()
    drive(motors, WinchMapper(simulation, motors.places, solves=False), Script([DriveWish(stamp=inf, over=True)]))
    drive(motors, WinchMapper(simulation, motors.places, solves=False), Script([DriveWish(stamp=inf)]), seconds=0.1)
    assert 0.1 <= time.monotonic() - begin < 60.0


def test_motors_are_told_by_their_own_clock(simulation: hs.Simulation) -> None:
    motors, told = motors_of(simulation), []
    motors.clock, motors.link.send = lambda: 7.0, lambda _, now, **__: told.append(now)
    drive(motors, WinchMapper(simulation, motors.places, solves=False), Script([DriveWish(stamp=inf, over=True)]))
    assert told == [7.0]


def test_fingertips_come_to_their_targets(simulation: hs.Simulation) -> None:
    """Oracle: a hidden pose, and the simulation at the contractions that are found."""
    hidden = simulation.solve({"left": 0.015, "right": 0.006})
    places = {
        f"{name} {axis}": float(value)
        for name, place in hidden.markers.items()
        for axis, value in zip("xy", place, strict=True)
    }
    motors = motors_of(simulation)
    way = MarkerMapper(simulation, motors.places)
    drive(motors, way, Script([DriveWish(stamp=inf, places=places)]), seconds=2.0)
    found = simulation.solve(motors.places)
    for name, place in hidden.markers.items():
        assert np.linalg.norm(found.markers[name] - place) < 2e-4
    assert "mm from its targets" in way.words


def test_a_new_target_does_not_wait_for_the_pose_that_is_solved(simulation: hs.Simulation) -> None:
    """Oracle: the simulation at what is answered while nothing at all is solved."""
    rest, motors = simulation.rest.markers, motors_of(simulation)
    way, names = MarkerMapper(simulation, motors.places, rate=0.06), list(simulation.rest.markers)
    begin = np.concatenate([np.asarray(rest[name]) for name in names])
    goal = np.concatenate([np.asarray(simulation.solve({"left": 0.005}).markers[name]) for name in names])

    def left(contractions: np.ndarray) -> float:
        markers = simulation.solve(contractions).markers
        return float(np.linalg.norm(np.concatenate([np.asarray(markers[name]) for name in names]) - goal))

    way.updated = threading.Event()
    way.ask(begin)
    assert way.updated.wait(20.0)
    os.kill(way._poses._process.pid, signal.SIGSTOP)
    way.ask(goal)
    answer = way.contractions
    os.kill(way._poses._process.pid, signal.SIGCONT)
    way.close()
    assert left(answer) < 0.3 * left(motors.places)
    assert np.abs(answer).max() <= 0.06 * 0.1 + 1e-9


def test_who_gives_jobs_never_waits(simulation: hs.Simulation) -> None:
    """Oracle: a process that stands still takes far more jobs than its pipe holds; of these the newest is answered."""
    heard, one = [], threading.Event()

    def hear(found: PoseOnWay) -> None:
        heard.append(found.contractions)
        one.set()

    process = PoseProcess(WinchPoses, (simulation.robot,), hear)
    os.kill(process._process.pid, signal.SIGSTOP)
    for number in range(5000):
        process.give(np.full(len(simulation.robot.winches), 1e-6 * number))
    os.kill(process._process.pid, signal.SIGCONT)
    while not heard or heard[-1][0] < 4.999e-3 - 1e-9:
        assert one.wait(30.0)
        one.clear()
    process.close()
    assert len(heard) < 100


def test_what_fails_behind_is_told(simulation: hs.Simulation) -> None:
    motors = motors_of(simulation)
    way = MarkerMapper(simulation, motors.places)

    child = way._poses._process
    os.kill(child.pid, signal.SIGKILL)
    child.join()
    with pytest.raises(HydrostatError, match="no pose is found any more: its process has ended"):
        drive(motors, way, Script([DriveWish(stamp=inf, steps={"left x": 1e-4})]), seconds=5.0)
    with pytest.raises(HydrostatError, match=r"no pose can be found: .*nonsense"):
        PoseProcess(FingertipPoses, (simulation.robot, "nonsense", None), print)


def test_pulls_are_known_near_poses_that_were_solved(simulation: hs.Simulation) -> None:
    known = TensionLookup(simulation.robot, near=2e-3, most=3)
    assert np.isnan(known(np.zeros(3))).all()
    one, two = (simulation.solve({"left": taken}) for taken in (0.010, 0.012))
    known.add(one)
    known.add(two)
    left = [winch.name for winch in simulation.robot.winches].index("left")
    pulls = [
        sum(t for t, cable in zip(pose.tensions, simulation.robot.cables, strict=True) if cable.winch == "left")
        for pose in (one, two)
    ]
    assert known(one.contractions)[left] == pytest.approx(pulls[0])
    middle = 0.5 * (one.contractions + two.contractions)
    assert known(middle)[left] == pytest.approx(np.mean(pulls))
    away = one.contractions - 3e-3
    assert np.isnan(known(away)).all()
    assert known.nearest(away)[left] == pytest.approx(pulls[0], rel=0.4)
    for _ in range(3):
        known.add(two)
    assert np.isnan(known(one.contractions - 1e-3)).all()  # the oldest is forgotten


@pytest.mark.slow
def test_a_way_with_a_guard_knows_what_it_drives_through(simulation: hs.Simulation) -> None:
    motors = motors_of(simulation)
    way = WinchMapper(simulation, motors.places)
    drive(motors, way, Script([DriveWish(stamp=inf, places={"left": 0.01})]), seconds=1.0)
    exact = simulation.solve({"left": 0.01})
    left = [winch.name for winch in simulation.robot.winches].index("left")
    pull = sum(t for t, cable in zip(exact.tensions, simulation.robot.cables, strict=True) if cable.winch == "left")
    assert way.known(motors.places)[left] == pytest.approx(pull, rel=1e-3)
