"""Feetech's SCS0009. Oracles: packets by Feetech's published sums, truth of emulated servos, words told."""

import numpy as np
import pytest
from emulation import send_goal

from hydrostat.control.bus_link import BusLink, LinkState
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedScs
from hydrostat.control.emulated_servos import InjectedFaults
from hydrostat.control.feetech_bus import TORQUE, FeetechBus, pack
from hydrostat.control.scs_bus import BOUND, SCS_STALL, SCS_TICK, ScsBus
from hydrostat.errors import HydrostatError
from hydrostat.robot import Winch

RADIUS = 0.006
MOST = RADIUS * 1023 * SCS_TICK  # cable that a spool of 6 mm takes in over 300 degrees [m]


class Pair:
    """Two winches on a link, their motors near the lower end of their turn."""

    def __init__(self, zero: float = 0.2) -> None:
        def load(angle: float) -> float:
            return RADIUS * 150.0 * max(RADIUS * (angle - zero), 0.0)

        self.servos = [EmulatedScs(number, load=load, angle=zero) for number in (1, 2)]
        self.chain = EmulatedFeetechChain(self.servos)
        self.bus = ScsBus(self.chain, [1, 2], clock=self.chain.clock, wait=self.chain.wait)
        winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=0.05) for name in ("flex", "extend")]
        motors = [
            WinchMotor(winch=each.name, number=number, zero=zero, radius=RADIUS, current=0.5)
            for number, each in enumerate(winches, 1)
        ]
        self.link = BusLink(self.bus, winches, Calibration(tuple(motors)), clock=self.chain.clock)

    def begin(self) -> None:
        self.link.identify()
        self.link.arm()

    def go(self, goal: float, seconds: float) -> np.ndarray:
        """Both winches to a goal [m]; returns their places by the link."""
        return send_goal(self.link, self.chain, goal, seconds)


def test_it_goes_where_it_is_told_with_high_bytes_first() -> None:
    pair = Pair()
    pair.begin()
    assert pair.link.facts[0].model == "SCS0009"
    assert pair.go(0.02, 1.5) == pytest.approx(0.02, abs=RADIUS * SCS_TICK)
    truth = [RADIUS * (servo.angle - 0.2) for servo in pair.servos]
    assert truth == pytest.approx([0.02, 0.02], abs=RADIUS * SCS_TICK)
    reading = pair.link.reading
    assert reading is not None
    assert reading.currents == pytest.approx(RADIUS * 150.0 * 0.02 / 0.35, abs=2e-3)
    assert reading.volts == pytest.approx(6.0)
    assert int.from_bytes(pair.servos[0].table[BOUND : BOUND + 2], "big") == round(1000 * 0.5 / SCS_STALL)


def test_a_word_is_sent_as_the_table_says() -> None:
    """Oracle: by hand, step 517 is 02 05, high byte first; of an STS it is 05 02."""
    sent = list[bytes]()
    for bus in (ScsBus, FeetechBus):
        chain = EmulatedFeetechChain([EmulatedScs(1)])
        chain.towards = lambda data: sent.append(data) or data
        bus(chain, [1], clock=chain.clock, wait=chain.wait)._go([517], [100], [1])
    assert sent[0].endswith(pack(0xFE, 0x83, bytes([42, 6, 1, 2, 5, 0, 0, 0, 100])))
    assert sent[1].endswith(pack(0xFE, 0x83, bytes([41, 7, 1, 0, 5, 2, 0, 0, 100, 0])))


def test_the_turn_ends_and_that_is_told() -> None:
    pair = Pair()
    pair.begin()
    assert pytest.approx(0.0314, abs=1e-4) == MOST
    with pytest.raises(HydrostatError, match=r"motor 1 turns from step 0 to 1023 \(300 degrees\) and was asked for"):
        pair.go(0.045, 3.0)
    assert pair.link.state is LinkState.FAULT


@pytest.mark.parametrize(
    ("ails", "told"),
    [
        (InjectedFaults(deaf=True), "the motor of extend has not answered for 0.2"),
        (InjectedFaults(stuck=True), "extend does not follow"),
        (InjectedFaults(overloaded=True), "the motor of extend reports: overloaded"),
        (InjectedFaults(sags=True), "extend reports: supply voltage out of range"),
    ],
)
def test_a_motor_that_fails_is_named_and_all_stand(ails: InjectedFaults, told: str) -> None:
    pair = Pair()
    pair.begin()
    pair.go(0.01, 0.4)
    pair.servos[1].ails = ails
    with pytest.raises(HydrostatError, match=told):
        pair.go(0.025, 3.0)
    pair.chain.wait(0.25)
    before = [servo.angle for servo in pair.servos]
    pair.chain.wait(2.0)
    assert [servo.angle for servo in pair.servos] == before


def test_who_is_not_ready_is_told() -> None:
    for spoil, told in (
        (lambda servo: servo.table.__setitem__(slice(3, 5), (777).to_bytes(2, "big")), "servo of number 777; known is"),
        (
            lambda servo: servo.table.__setitem__(slice(9, 13), bytes(4)),
            r"turns without end .* registers 9 to 0 and 11",
        ),
        (lambda servo: setattr(servo, "supply", 12.1), r"motor 2 measures 12\.1 V\. Its memory allows 4\.5 to 8\.4 V"),
    ):
        pair = Pair()
        spoil(pair.servos[1])
        pair.chain.wait(0.01)
        with pytest.raises(HydrostatError, match=told):
            pair.link.identify()


def test_power_that_is_lost_is_told_and_no_position_with_it() -> None:
    pair = Pair()
    pair.begin()
    pair.go(0.02, 1.0)
    pair.servos[0].begin_anew()
    assert pair.servos[0].table[TORQUE] == 0
    with pytest.raises(HydrostatError, match="flex lost power and restarted"):
        pair.go(0.028, 3.0)
    pair.begin()
    assert pair.go(0.01, 1.5) == pytest.approx(0.01, abs=RADIUS * SCS_TICK)
