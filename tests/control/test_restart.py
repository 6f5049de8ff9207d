"""Motors that switched themselves off, sagging supplies, slack. Oracles: what emulated motors know of themselves."""

import re
from collections.abc import Sequence

import numpy as np
import pytest
from emulation import NAMES, RADIUS, Rig

from hydrostat.control.bus_link import LinkState
from hydrostat.control.dynamixel_bus import MODELS
from hydrostat.control.emulated_servos import EmulatedServo, InjectedFaults
from hydrostat.control.restart_motors import COOL_TEMPERATURE, POLL_INTERVAL, fault_words, restart_motors
from hydrostat.errors import HydrostatError

MAKES = [(1200, 1220, 1060), (777, 777, 777)]


@pytest.mark.parametrize("models", MAKES)
def test_an_overloaded_motor_is_named_and_restarted_once_it_is_cool(models: tuple[int, int, int]) -> None:
    rig = Rig(guarded=False, models=models)
    rig.begin()
    rig.go(0.02, 0.3)
    rig.servos[1].ails = InjectedFaults(overloaded=True)
    with pytest.raises(HydrostatError, match=r"of index extensor reports: overloaded\. Free its cable, then run"):
        rig.go(0.02, 1.0)
    with pytest.raises(HydrostatError, match="overloaded"):
        rig.link.arm()
    said, begin = list[str](), rig.chain.now
    make_hot(rig.servos[1], lambda: rig.chain.now < begin + 18.0)
    rig.chain.wait(0.01)
    lost = list[Sequence[int]]()

    def forget(places: Sequence[int]) -> None:
        assert rig.servos[1].ails.overloaded, "before it is restarted"
        lost.append(places)

    again = restart_motors(rig.bus, NAMES, said.append, forget, clock=rig.chain.clock, wait=rig.chain.wait)
    assert again == ("index extensor",)
    assert said == [f"index extensor: its motor is 72 °C warm. Waiting until it is below {COOL_TEMPERATURE:.0f} °C"] * 4
    assert 18.0 <= rig.chain.now - begin <= 18.0 + POLL_INTERVAL + 1.0
    assert not rig.servos[1].ails.overloaded
    rig.link.identify()
    if models == MAKES[0]:  # a reboot forgets turns
        with pytest.raises(HydrostatError, match="calibrate them again"):
            rig.link.arm()
        rig.bus.mark()
    rig.link.arm()
    assert rig.go(0.02, 1.0)[1] == pytest.approx(0.02, abs=5e-5)
    assert restart_motors(rig.bus, NAMES, said.append, forget, clock=rig.chain.clock, wait=rig.chain.wait) == ()
    assert lost == [[1]]


@pytest.mark.parametrize("models", MAKES)
def test_a_motor_that_stays_warm_is_told(models: tuple[int, int, int]) -> None:
    rig = Rig(guarded=False, models=models)
    rig.servos[2].ails = InjectedFaults(hot=True)

    def jump(seconds: float) -> None:
        rig.chain.now += seconds

    rig.chain.wait(0.01)
    with pytest.raises(HydrostatError, match=r"thumb: its motor is 85 °C warm after 15 min\. Switch the power off"):
        restart_motors(rig.bus, NAMES, lambda _: None, lambda _: None, clock=rig.chain.clock, wait=jump)


@pytest.mark.parametrize("models", MAKES)
def test_a_battery_that_sags_is_told_with_its_voltage(models: tuple[int, int, int]) -> None:
    rig = Rig(guarded=False, models=models)
    rig.begin()
    rig.go(0.02, 0.3)
    rig.servos[0].ails = InjectedFaults(sags=True)
    rig.chain.wait(0.01)
    with pytest.raises(
        HydrostatError, match=r"index flexor reports: supply .* \(3\.5 V measured\)\. Charge its battery"
    ):
        rig.go(0.02, 1.0)
    assert rig.link.state is LinkState.FAULT


def test_a_motor_with_two_faults_is_told_both_remedies() -> None:
    rig = Rig(guarded=False)
    rig.servos[0].ails = InjectedFaults(sags=True, overloaded=True)
    rig.chain.wait(0.01)
    words = fault_words("thumb", rig.bus.read(), 0)
    assert "Charge its battery" in words
    assert "Free its cable, then run hydrostat calibrate --restart" in words


def test_slack_is_told_with_its_length_and_the_turn_that_takes_it_up() -> None:
    """Oracle: a spring that pulls by a twentieth of the model's is as one let out by 95 % of its stretch, 12 mm."""
    rig = Rig(reaches=(0.03, 0.03, 0.03))
    rig.begin()
    rig.go(0.012, 1.0)
    before = rig.servos[0].load
    rig.servos[0].load = lambda angle: 0.05 * before(angle)  # nearly nothing is felt
    with pytest.raises(HydrostatError, match="index flexor: cable slack or broken") as error:
        rig.go(0.012, 3.0)
    length, degrees = map(int, re.findall(r"calibrate \(about (\d+) mm, (\d+) degrees\)$", str(error.value))[0])
    assert length == pytest.approx(12.0 * 0.95, abs=1.0)
    assert degrees == pytest.approx(np.degrees(1e-3 * length / RADIUS), abs=4)


def make_hot(servo: EmulatedServo, is_hot) -> None:
    """Let a servo report 72 degrees while it is hot, else 30."""
    step, place = servo.step, 146 if servo.model in MODELS else 63

    def warm(now: float, dt: float) -> None:
        step(now, dt)
        servo.table[place] = 72 if is_hot() else 30

    servo.step = warm  # type: ignore[method-assign]
