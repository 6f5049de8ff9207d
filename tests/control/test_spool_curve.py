"""Spools measured by a mark and a ruler. Oracle: layers of cable that only the emulated winches know."""

import numpy as np
import pytest
from emulation import CONSTANT, RADIUS

from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_bus import DynamixelBus
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo
from hydrostat.control.open_bus import add_cable_layers
from hydrostat.control.spool_curve import MIN_STOPS, STOPS, SpoolCurve
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Winch

ZERO, TRAVEL, SPRING = 1.3, 0.08, 50.0  # [rad], [m], [N/m]
OLD = Calibration(
    (
        WinchMotor(winch="flexor", number=1, zero=ZERO, radius=RADIUS),
        WinchMotor(winch="thumb", number=2, zero=0.2, turns=-1, radius=RADIUS),
    )
)
TRUE = add_cable_layers(OLD)


class Bench:
    """Two emulated winches with hidden layers, and somebody with a ruler of half millimeters."""

    def __init__(self) -> None:
        self.servos = [EmulatedServo(1, model=1240, angle=ZERO), EmulatedServo(2, model=1240, angle=0.2)]
        for servo, spool in zip(self.servos, TRUE.motors, strict=True):
            servo.constant = CONSTANT
            servo.load = lambda angle, spool=spool: RADIUS * SPRING * max(spool.contraction(angle), 0.0)
        self.chain = EmulatedChain(self.servos)
        self.chain.STEP = 4e-3
        bus = DynamixelBus(self.chain, [1, 2], clock=self.chain.clock, wait=self.chain.wait)
        winches = [Winch(name=m.winch, at=(0, 0), spool_radius=RADIUS, travel=TRAVEL, release=0.0) for m in OLD.motors]
        self.link = BusLink(bus, winches, OLD, clock=self.chain.clock)
        self.link.identify()
        self.asked: list[float] = []

    def taken(self, place: int) -> float:
        """Cable that a winch has taken in, in truth [m]."""
        return TRUE.motors[place].contraction(self.servos[place].angle)

    def measure(self, place: int) -> SpoolCurve:
        def read(thought: float) -> float:
            self.asked.append(thought)
            self.chain.wait(0.5)  # while somebody looks: motors are told nothing
            return 0.12 - 5e-4 * round(self.taken(place) / 5e-4)  # a ruler that counts down

        clock, wait = self.chain.clock, self.chain.wait
        return SpoolCurve.measure(self.link, OLD.motors[place], place, TRAVEL, read, clock=clock, wait=wait)


def errors(motor: WinchMotor, true: WinchMotor) -> np.ndarray:
    """How far a motor is beside the truth over the travel [m]."""
    goals = np.linspace(0.0, TRAVEL, 200)
    return np.array([true.contraction(motor.angle(goal)) for goal in goals.tolist()]) - goals


@pytest.mark.parametrize("place", [0, 1])
def test_hidden_layers_are_found_and_contractions_become_true(place: int) -> None:
    """By 1 % of radius and two layers of 0.4 mm a winch takes in 2.4 mm more than told; with the curve 0.3 at most."""
    bench = Bench()
    found = bench.measure(place)
    assert len(bench.asked) == STOPS
    assert np.abs(errors(OLD.motors[place], TRUE.motors[place])).max() > 2e-3
    assert np.abs(errors(found.motor, TRUE.motors[place])).max() < 4e-4
    assert found.scatter < 2.5e-4
    assert bench.taken(place) == pytest.approx(0.0, abs=4e-4)
    before = [servo.angle for servo in bench.servos]
    bench.chain.wait(1.0)
    assert [servo.angle for servo in bench.servos] == pytest.approx(before, abs=0.01)


def test_a_fit_of_exact_readings_is_exact() -> None:
    """By hand: straight pieces that bend at readings; a ruler that begins anywhere."""
    turned = np.linspace(0.0, 12.0, 7)
    taken = 0.0081 * turned + 4e-4 * np.maximum(turned - 6.0, 0.0)
    found = SpoolCurve.fit(OLD.motors[0], turned, 0.03 + taken)
    assert found.motor.radius == pytest.approx(0.0081, rel=1e-6)
    assert np.array(found.motor.curve) == pytest.approx(np.array([(6.0, 0.0486), (12.0, taken[-1])]), rel=1e-6)
    assert found.more == pytest.approx(taken[-1] - 0.096, rel=1e-6)
    angles = np.linspace(-3.0, 15.0, 50) + ZERO
    there = [found.motor.contraction(angle) for angle in angles.tolist()]
    assert [found.motor.angle(each) for each in there] == pytest.approx(angles)
    assert found.motor.reach(0.06) == pytest.approx(0.0085)
    assert [found.motor.reach(each) for each in (-0.01, 0.04)] == pytest.approx([0.0081, 0.0081])


@pytest.mark.parametrize(("spring", "stops"), [(350.0, 6), (2000.0, 3)])
def test_a_body_that_holds_a_winch_ends_it_there(spring: float, stops: int) -> None:
    """By hand: 0.4 A pull by 17.5 N; springs that begin at 10 mm give 50 and 9 mm: stops 6 and 3 are at 60 and 19."""
    bench = Bench()
    true = TRUE.motors[0]
    bench.servos[0].load = lambda angle: RADIUS * spring * max(true.contraction(angle) - 0.01, 0.0)
    if stops < MIN_STOPS:
        with pytest.raises(HydrostatError, match=r"flexor: its motor stood after 1\d of 80 mm; let its cable off"):
            bench.measure(0)
    else:
        assert (
            np.abs(errors(bench.measure(0).motor, TRUE.motors[0])).max() < 7e-4
        )  # beyond 60 mm it goes on as straight
    assert len(bench.asked) == stops


@pytest.mark.parametrize(
    ("readings", "told"),
    [
        (np.linspace(0, 9.6, 7), "by the ruler its spool has a radius of 800.0 mm"),
        (np.linspace(0, 0, 7), "by the ruler its spool has a radius of 0.0 mm"),
        (np.array([0, 16, 32, 54, 64, 80, 96]) * 1e-3, "reading 4 of 7 is .* beside every curve"),
    ],
)
def test_readings_that_no_spool_gives_are_named(readings: np.ndarray, told: str) -> None:
    with pytest.raises(HydrostatError, match=told):
        SpoolCurve.fit(OLD.motors[0], np.linspace(0, 12, 7), readings)


@pytest.mark.parametrize("curve", [((1.0, 0.01), (0.5, 0.02)), ((1.0, -0.01),), ((1.0, np.nan),), ((1.0, 0.6),)])
def test_curves_that_are_none_are_refused(curve: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(InputError, match="flexor: curve"):
        WinchMotor(winch="flexor", number=1, radius=RADIUS, curve=curve)
