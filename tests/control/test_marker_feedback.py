"""Contractions corrected by markers. Oracle: a hidden robot, on emulated servos in their own time."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from builders import routed_strip

from hydrostat.control import (
    BusLink,
    Calibration,
    DynamixelBus,
    EmulatedChain,
    EmulatedServo,
    LostAction,
    MarkerFeedback,
    MarkerPath,
    MarkerSight,
    Motors,
    Player,
    TensionGuard,
    TensionLookup,
    WinchMotor,
)
from hydrostat.control.model_tensions import winch_tensions
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile, Simulation

ROUTES = {name: [(0.01, y), (0.07, y), (0.13, y), (0.19, y)] for name, y in (("up", 0.014), ("down", -0.014))}
GAINS = np.array([0.88, 1.0])  # spool radii of the hidden robot, over those of its model
FRAME, LAG = 1 / 15, 0.1  # time between frames, and from a command to a frame with its effect [s]


def strip() -> Robot:
    """A strip that is held at its left end, sags under its weight, and has a cable above and one below."""
    return routed_strip(ROUTES, gravity=(0.0, -9.81), travel=0.03, release=0.002)


def hidden_strip() -> Robot:
    """The same of a softer material with another Poisson's ratio, its routes 1 mm off."""
    robot = strip()
    material = replace(robot.body.material, young=0.7 * robot.body.material.young, poisson=0.4)
    cables = tuple(
        replace(cable, points=tuple((x, y + 0.001 * (index % 2)) for index, (x, y) in enumerate(cable.points)))
        for cable in robot.cables
    )
    return replace(robot, body=replace(robot.body, material=material), cables=cables)


PROFILE = ContractionProfile(
    times=np.array([0.0, 1.0, 2.0, 3.5]), values=np.array([[0, 0], [0.006, 0.0], [0.01, 0.001], [0.008, 0.0]])
)


class Bench:
    """A hidden robot on emulated servos, and a camera that sees its markers some time later."""

    def __init__(self, see: Callable[[dict[str, np.ndarray], float], dict[str, np.ndarray]] | None = None) -> None:
        self.robot, self.hidden = strip(), Simulation(hidden_strip())
        self._see = see or (lambda places, _: places)
        winches = self.robot.winches
        spools = [
            WinchMotor(winch=w.name, number=n, zero=1.0, radius=w.spool_radius, current=0.6)
            for n, w in enumerate(winches, 1)
        ]
        calibration, pulls = Calibration(tuple(spools)), TensionLookup(self.robot)
        simulation = Simulation(self.robot)
        for time in np.linspace(0, 3.5, 12).tolist():
            pulls.add(simulation.solve(PROFILE.at(time)))
        self.servos = [EmulatedServo(n, model=1200, angle=1.0) for n in (1, 2)]
        self.chain = EmulatedChain(self.servos)
        for index, (servo, winch) in enumerate(zip(self.servos, winches, strict=True)):
            servo.constant = 0.35
            servo.load = lambda _, index=index, winch=winch: winch.spool_radius * pulls.nearest(self.places)[index]
        bus = DynamixelBus(self.chain, [1, 2], clock=self.chain.clock, wait=self.chain.wait)
        self.log, self.link = list[str](), BusLink(bus, winches, calibration, clock=self.chain.clock)
        self.link.identify()
        self.link.guard = TensionGuard(pulls.nearest, np.array([s.constant for s in self.servos]), ("up", "down"))
        self.link.arm()
        self.motors = Motors(winches, self.link, places=self.link.read(self.chain.now), fastest=self.link.limits.speed)
        self.path, self.commands = MarkerPath.along(self.robot, PROFILE), list[np.ndarray]()
        self._pose, self._framed, self._sights = self.hidden.rest, -np.inf, list[MarkerSight]()
        self.player = Player()
        self.player.rounds = 1

    @property
    def places(self) -> np.ndarray:
        """Contractions of the motors in truth [m]."""
        return np.array(
            [w.spool_radius * (s.angle - 1.0) for w, s in zip(self.robot.winches, self.servos, strict=True)]
        )

    def _markers(self) -> Mapping[str, np.ndarray]:
        self._pose = self.hidden.solve(GAINS * self.places, start=self._pose)
        return self._pose.markers

    def look(self) -> MarkerSight | None:
        """Newest frame that has arrived."""
        if self.chain.now >= self._framed + FRAME:
            self._framed = self.chain.now
            if seen := self._see(dict(self._markers()), self.player.time):
                self._sights.append(MarkerSight(self.chain.now + LAG, seen))
        return next((each for each in reversed(self._sights) if each.time <= self.chain.now), None)

    def play(self, lost: LostAction | None = LostAction.HOLD) -> float:
        """Play; returns the mean distance of the markers in truth from their simulated places at the end [m]."""
        made = MarkerFeedback(
            self.robot, self.path, self, lag=LAG, lost=lost or LostAction.CONTINUE, log=self.log.append
        )
        self.feedback = made
        self.player.run(
            self.motors,
            PROFILE,
            feedback=None if lost is None else made,
            clock=self.chain.clock,
            wait=self.chain.wait,
            tell=lambda: self.commands.append(self.motors.command.copy()),
        )
        wanted = Simulation(self.robot).solve(PROFILE.at(3.5)).markers
        return float(np.mean([np.linalg.norm(at - wanted[name]) for name, at in self._markers().items()]))


@pytest.mark.slow
def test_a_hidden_material_is_corrected() -> None:
    before, bench = Bench().play(None), Bench()
    after = bench.play()
    assert after < before / 3
    assert bench.feedback.rate == pytest.approx(1 / FRAME, rel=0.3)
    second = len(bench.feedback.errors) // 2
    assert np.mean(bench.feedback.errors[second:]) < np.mean(bench.feedback.open_errors[second:])
    assert not bench.log


def test_slopes_of_the_path_are_those_of_whole_solves() -> None:
    simulation, path = Simulation(strip()), MarkerPath.along(strip(), PROFILE)
    index, step = int(np.searchsorted(path.times, 1.0)), np.array([1e-6, 0.0])
    at = PROFILE.at(float(path.times[index]))
    more, less = (simulation.solve(at + sign * step).markers for sign in (1, -1))
    slope = [(more[name] - less[name]) / 2e-6 for name in more]
    assert path.jacobians[index][:, :, 0] == pytest.approx(np.array(slope), rel=1e-3, abs=1e-4)


@pytest.mark.slow
def test_a_lost_camera_holds_or_goes_on() -> None:
    """Markers are covered from 1 s on: held motors stand and stop with one line; others go on as planned."""

    def see(places: dict[str, np.ndarray], time: float) -> dict[str, np.ndarray]:
        return places if time < 1.0 else {}

    bench = Bench(see)
    with pytest.raises(HydrostatError, match="no marker in sight for 10 s"):
        bench.play(LostAction.HOLD)
    assert bench.player.time < 1.8
    assert any("motors hold until one is" in line for line in bench.log)
    assert np.ptp(bench.commands[-200:], axis=0).max() < 1e-9
    bench = Bench(see)
    bench.play(LostAction.CONTINUE)
    assert any("going on without correction" in line for line in bench.log)
    assert bench.commands[-1] == pytest.approx(PROFILE.at(3.5), abs=2e-4)


@pytest.mark.slow
def test_wrong_markers_move_nothing_far() -> None:
    """Misread markers count for nothing; a constant error ends at the bound, within all limits."""
    bench = Bench(lambda places, _: {name: at + 0.1 for name, at in places.items()})
    bench.play(LostAction.CONTINUE)
    assert np.abs(bench.commands[-1] - PROFILE.at(3.5)).max() < 1e-9
    bench = Bench(lambda places, _: {name: at + np.array([0.0, -0.03]) for name, at in places.items()})
    bench.play(LostAction.CONTINUE)
    assert any("at its bound of 6 mm" in line for line in bench.log)
    corrections = np.array(bench.commands) - PROFILE.at(3.5)
    assert np.abs(corrections[-1]).max() <= 0.006 + 1e-9
    assert np.array(bench.commands).min() >= -0.002 - 1e-12
    assert np.array(bench.commands).max() <= 0.03 + 1e-12


def test_a_robot_without_markers_is_refused() -> None:
    with pytest.raises(InputError, match="Add one for each tag"):
        MarkerPath.along(replace(strip(), markers=()), PROFILE)


def swing(rows: int) -> ContractionProfile:
    """One winch to and fro, in seconds."""
    return ContractionProfile(times=np.arange(float(rows)), values=np.outer(np.arange(rows) % 2, [0.01, 0.0]))


def test_a_long_path_is_as_fine_as_a_short_one() -> None:
    """Oracle: markers of the equilibrium between two poses of the path. One of too many poses is refused at once."""
    simulation, profile = Simulation(strip()), swing(12)
    path = MarkerPath.along(strip(), profile)
    for time in (0.31, 5.77, 10.5):
        at = np.array(list(simulation.solve(profile.at(time)).markers.values()))
        assert path.at(time)[0] == pytest.approx(at, abs=5e-5)
    with pytest.raises(InputError, match="Play a shorter one"):
        MarkerPath.along(strip(), swing(1200))


class Sights:
    """A camera whose newest sight is set by hand."""

    def __init__(self) -> None:
        self.newest: MarkerSight | None = None

    def look(self) -> MarkerSight | None:
        return self.newest

    def show(self, time: float, *place: float) -> None:
        self.newest = MarkerSight(time, {"tip": np.array(place)})


def sighted(slope: float = 0.0) -> tuple[MarkerFeedback, Sights]:
    """Feedback on one marker that is simulated to go 0.01 m/s in x; each winch moves it along one axis.

    The first winch pulls with 0.5 N/s; each correction adds to the pull of its winch by `slope` [N/m].
    """
    robot = strip()
    path = MarkerPath(
        times=np.array([0.0, 10.0]),
        places=np.array([[[0.0, 0.0]], [[0.1, 0.0]]]),
        jacobians=np.tile(np.eye(2), (2, 1, 1, 1)),
        pulls=np.array([[0.0, 0.0], [5.0, 0.0]]),
        pull_jacobians=np.tile(slope * np.eye(2), (2, 1, 1)),
    )
    camera = Sights()
    return MarkerFeedback(replace(robot, markers=robot.markers[2:]), path, camera, lag=0.125), camera


def test_a_perfect_robot_seen_late_is_not_corrected() -> None:
    feedback, camera = sighted()
    for now in np.arange(0.0, 3.0, 0.0625).tolist():
        camera.show(now, 0.01 * max(now - 0.125, 0.0), 0.0)
        assert feedback.correct(np.full(2, 0.01), now, now) == pytest.approx(np.full(2, 0.01), abs=1e-6)
    assert max(feedback.errors) < 1e-6


def test_a_correction_is_slow_and_unspoiled_by_what_is_no_number() -> None:
    feedback, camera = sighted()
    last = np.full(2, 0.01)
    for now in np.arange(0.0, 2.0, 0.0625).tolist():
        camera.show(now, np.nan, 0.0) if now < 1.0 else camera.show(now, 0.01 * (now - 0.125), -0.02)
        command = feedback.correct(np.full(2, 0.01), now, now)
        assert np.abs(command - last).max() <= 0.02 * 0.0625 + 1e-9
        assert now >= 1.0 or (command == 0.01).all()
        last = command
    assert last[1] > 0.0125


def test_a_correction_does_not_wind_up_at_a_limit() -> None:
    feedback, camera = sighted()
    for now in np.arange(0.0, 2.0, 0.0625).tolist():
        camera.show(now, 0.01 * max(now - 0.125, 0.0), -0.02)
        assert feedback.correct(np.array([0.01, 0.03]), now, now)[1] == pytest.approx(0.03)
    assert feedback.correct(np.array([0.01, 0.02]), 2.0, 2.0)[1] == pytest.approx(0.02, abs=0.02 * 0.0625 + 1e-9)


def test_a_correction_raises_no_pull_beyond_the_guard() -> None:
    """Oracle: 2 N and half the simulated pull over 1,500 N/m by hand, at the time of the command."""
    feedback, camera = sighted(slope=1500.0)
    now, command = 0.0, np.zeros(2)
    for now in np.arange(0.0, 4.0, 0.0625).tolist():
        camera.show(now, 0.01 * max(now - 0.125, 0.0) - 0.02, 0.0)
        command = feedback.correct(np.full(2, 0.01), now, now)
    assert command[0] - 0.01 == pytest.approx((2.0 + 0.5 * 0.5 * now) / 1500.0, rel=1e-6)
    assert command[1] == pytest.approx(0.01, abs=1e-6)


def test_slopes_of_pulls_are_those_of_whole_solves() -> None:
    robot, step = strip(), 1e-6
    path = MarkerPath.along(robot, PROFILE)
    middle = len(path.times) // 2
    at, slopes = PROFILE.at(path.times[middle]), path.pull_jacobians[middle]
    for winch, row in enumerate(np.eye(2)):
        less, more = (
            winch_tensions(robot, Simulation(robot).solve(at + sign * step * row).tensions) for sign in (-1, 1)
        )
        assert slopes[:, winch] == pytest.approx((more - less) / (2 * step), rel=1e-4, abs=1e-3)
