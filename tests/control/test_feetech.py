"""Feetech's servos. Oracles: packets by Feetech's published sums, truth of the emulated servos, words told."""

import random

import numpy as np
import pytest
from emulation import Rig, send_goal

from hydrostat.control.bus_link import BusLink, LinkState
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import InjectedFaults
from hydrostat.control.feetech_bus import BOUND, LOW, MODE, TICK, TORQUE, FeetechBus, SumReader, find_filler, pack
from hydrostat.control.guard import not_judged
from hydrostat.errors import HydrostatError
from hydrostat.robot import Winch

RADIUS, TRAVEL = 0.008, 0.06
NAMES = ("index flexor", "thumb")


class Hand:
    """Two winches on a link."""

    def __init__(self) -> None:
        def load(angle: float) -> float:
            return RADIUS * 200.0 * max(RADIUS * angle, 0.0)

        self.servos = [EmulatedSts(number, load=load) for number in (1, 2)]
        self.chain = EmulatedFeetechChain(self.servos)
        self.bus = FeetechBus(self.chain, [1, 2], clock=self.chain.clock, wait=self.chain.wait)
        winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=TRAVEL) for name in NAMES]
        motors = [
            WinchMotor(winch=name, number=number, zero=0.0, radius=RADIUS, current=0.5)
            for number, name in enumerate(NAMES, 1)
        ]
        self.link = BusLink(self.bus, winches, Calibration(tuple(motors)), clock=self.chain.clock)

    def go(self, goal: float, seconds: float) -> np.ndarray:
        """Both winches to a goal [m]; returns their places by the link."""
        return send_goal(self.link, self.chain, goal, seconds)

    @property
    def places(self) -> np.ndarray:
        """Where they are in truth [m]."""
        return np.array([RADIUS * servo.angle for servo in self.servos])


def test_packets_are_those_of_the_makers_client() -> None:
    # by hand: ping of 1 is FF FF 01 02 01 and ~(1 + 2 + 1) = FB; read 2 bytes from 56 of 1: ~(1 + 4 + 2 + 56 + 2) = BE
    assert pack(1, 0x01) == bytes.fromhex("ffff010201fb")
    assert pack(1, 0x02, bytes([56, 2])) == bytes.fromhex("ffff0104023802be")


def test_packets_are_found_among_bytes_of_another_kind() -> None:
    dice, reader = random.Random(5), SumReader()
    sent = [pack(dice.randrange(254), dice.randrange(100), dice.randbytes(dice.randrange(30))) for _ in range(300)]
    stream = b"".join(bytes(dice.randrange(200) for _ in range(dice.randrange(4))) + packet for packet in sent)
    found = []
    while stream:
        size = dice.randrange(1, 20)
        found += [pack(*packet) for packet in reader.feed(stream[:size])]
        stream = stream[size:]
    assert found == sent


def test_no_packet_that_lost_bytes_passes_its_sum() -> None:
    """Each byte lost, each cut, and the two packets after it lost or not. Without the filler 1 of 256 would pass."""
    dice = random.Random(6)
    for _ in range(60):
        count = dice.randrange(1, 5)
        goals = b"".join(bytes([number]) + dice.randbytes(7) for number in range(1, count + 1))
        packets = [pack(0xFE, 0x83, bytes([41, 7]) + goals), pack(1, 0x02, dice.randbytes(2)), pack(2, 0x01)]
        filler = [find_filler(packets[:end]) for end in range(len(packets))]
        last = find_filler(packets) + pack(3, 0x01)
        for place in range(len(packets[0])):
            for damaged in (packets[0][:place] + packets[0][place + 1 :], packets[0][:place]):
                rest = [filler[1] + packets[1], filler[2] + packets[2], last]
                for lost in range(3):
                    found = SumReader().feed(damaged + b"".join(rest[lost:]))
                    assert {pack(*each) for each in found} <= {*packets[1:], pack(3, 0x01)}


def test_it_goes_where_it_is_told_past_a_whole_turn() -> None:
    hand = Hand()
    hand.chain.servos[1].table[3:5] = (1289).to_bytes(2, "little")
    facts = hand.link.identify()
    assert [(fact.model, fact.watchdog) for fact in facts] == [("STS3215", False), ("STS3020", False)]
    hand.link.arm()
    assert hand.go(0.058, 2.0) == pytest.approx(0.058, abs=2e-5)
    assert hand.places == pytest.approx(0.058, abs=2e-5)
    assert hand.places[0] / RADIUS > 2 * np.pi
    reading = hand.link.reading
    assert reading is not None
    assert reading.currents == pytest.approx(RADIUS * 200.0 * 0.058 / 0.35, abs=0.01)
    assert reading.volts == pytest.approx(7.4)


def test_a_dead_host_leaves_motors_standing_though_they_have_no_watchdog() -> None:
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.go(0.05, 0.4)
    hand.chain.wait(0.25)
    before = hand.places
    hand.chain.wait(5.0)
    assert np.abs(hand.places - before).max() == 0.0
    assert (hand.places < 0.045).all()


def test_a_halt_brings_no_motor_back_to_where_it_was_heard_long_before() -> None:
    """Other lines are asked before `stop` comes to this one: meanwhile it stands, and then where it stands."""
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.bus.write(np.full(2, 6.0), np.full(2, 6.0))
    hand.chain.wait(0.1)
    heard = hand.bus.read().angles
    hand.chain.wait(0.08)
    hand.bus.halt()
    hand.chain.wait(0.06)
    stood = hand.places
    assert (stood > RADIUS * heard + 0.003).all()
    hand.chain.wait(0.3)
    hand.bus.stop()
    hand.chain.wait(0.3)
    assert hand.places == pytest.approx(stood, abs=RADIUS * 2 * TICK)


def test_a_halt_pulls_no_blocked_motor_on() -> None:
    """A shaft held fast at 1 rad; the other one is on its way at 6 rad/s, 0.05 s after the second reading."""
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.servos[0].load = lambda angle: 100.0 * max(angle - 1.0, 0.0)
    hand.bus.write(np.full(2, 6.0), np.full(2, 6.0))
    for wait in (0.3, 0.1, 0.05):
        hand.chain.wait(wait)
        heard = hand.bus.read().angles if wait > 0.05 else heard
    hand.bus.halt()
    goals = [TICK * int.from_bytes(servo.table[42:44], "little") for servo in hand.servos]
    assert goals[0] == pytest.approx(hand.servos[0].angle, abs=0.02)
    assert goals[1] > heard[1] + 6.0 * 0.05


@pytest.mark.parametrize("times", [1, 2])
def test_a_count_is_lost_when_two_answers_say_so(times: int) -> None:
    """Noise passes the sum of 8 bits now and then: one answer of another turn is asked for again."""
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.go(0.02, 0.5)
    heard = hand.bus.read().angles
    false = [pack(1, 0, (40_000).to_bytes(2, "little") + bytes(13))] * times
    hand.chain.back = lambda data: false.pop() if false else data
    reading = hand.bus.read()
    assert hand.bus.lost_position == (times == 2)
    assert ("lost power" in reading.faults[0]) == (times == 2)
    if times == 1:
        assert reading.angles == pytest.approx(heard, abs=TICK)


def test_a_motor_that_is_silent_when_asked_again_keeps_its_first_answer() -> None:
    """Motor 1 is asked again for noise, motor 2 answers the first question only: its answer is not lost."""
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.go(0.02, 0.5)
    before = hand.bus.read()
    hand.servos[1].angle += 0.5
    hand.chain.wait(0.05)
    truth, length = hand.servos[1].counted_angle, len(pack(1, 0, bytes(15)))
    parts = [lambda data: pack(1, 0, (40_000).to_bytes(2, "little") + bytes(13)) + data[length:],
             lambda data: data[:length]]  # fmt: skip
    hand.chain.back = lambda data: parts.pop(0)(data) if parts and data else data
    reading = hand.bus.read()
    assert not parts
    assert reading.stamps[1] > before.stamps[1]
    assert reading.angles == pytest.approx([before.angles[0], truth], abs=2 * TICK)


def test_noise_in_the_second_answer_alone_is_no_lost_count() -> None:
    """Motor 1 jumps in the first answer, motor 2 in the second: each has one that is right."""
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.go(0.02, 0.5)
    heard, length = hand.bus.read().angles, len(pack(1, 0, bytes(15)))
    false = (40_000).to_bytes(2, "little") + bytes(13)
    parts = [lambda data: pack(1, 0, false) + data[length:], lambda data: data[:length] + pack(2, 0, false)]
    hand.chain.back = lambda data: parts.pop(0)(data) if parts and data else data
    reading = hand.bus.read()
    assert not parts
    assert not hand.bus.lost_position
    assert reading.angles == pytest.approx(heard, abs=2 * TICK)


def test_its_torque_is_bounded_by_the_servo() -> None:
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.bus.write(np.full(2, 7.0), np.full(2, 2.0))
    for servo in hand.servos:
        servo.load = lambda angle: 0.1 * max(angle, 0.0)
    hand.chain.wait(5.0)
    assert [servo.torque for servo in hand.servos] == pytest.approx([0.35 * 0.5] * 2, rel=0.05)


@pytest.mark.parametrize(
    ("ails", "told"),
    [
        (InjectedFaults(deaf=True), "the motor of thumb has not answered for 0.2"),
        (InjectedFaults(stuck=True), "thumb does not follow: it stands at"),
        (InjectedFaults(hot=True), "the motor of thumb reports: too hot"),
    ],
)
def test_a_motor_that_fails_is_named_and_all_stand(ails: InjectedFaults, told: str) -> None:
    hand = Hand()
    hand.link.identify()
    hand.link.arm()
    hand.go(0.02, 0.2)
    hand.servos[1].ails = ails
    with pytest.raises(HydrostatError, match=told):
        hand.go(0.05, 3.0)
    assert hand.link.state is LinkState.FAULT
    hand.chain.wait(0.25)
    before = hand.places
    hand.chain.wait(2.0)
    assert np.abs(hand.places - before).max() == 0.0


def test_who_is_not_ready_is_told() -> None:
    hand = Hand()
    hand.servos[1].table[3:5] = (2825).to_bytes(2, "little")
    with pytest.raises(HydrostatError, match="motor 2 is a servo of number 2825; known are STS3215"):
        hand.bus.identify()
    hand = Hand()
    hand.servos[0].table[MODE] = 1
    with pytest.raises(HydrostatError, match="motor 1 is not in position mode"):
        hand.bus.identify()
    hand = Hand()
    hand.servos[0].ails = InjectedFaults(deaf=True)
    with pytest.raises(HydrostatError, match="motor 1 does not answer"):
        hand.bus.identify()


@pytest.mark.parametrize(
    ("supply", "allowed", "told"),
    [
        (12.1, (4.0, 8.0), r"motor 2 is .* 7.4 V \(its memory allows 4.0 to 8.0 V\) and measures 12.1 V.*7.4 V.$"),
        (8.4, (4.0, 8.0), "motor 2 .* measures 8.4 V.* Two full lithium cells give 8.4 V: put a regulator"),
        (9.5, (4.0, 10.0), "motor 2 is a servo for 7.4 V .* measures 9.5 V"),
        (20.0, (4.0, 25.5), "motor 2 is a servo for 12 V .* measures 20.0 V"),
        (3.2, (4.0, 8.0), "motor 2 is a servo for 7.4 V .* measures 3.2 V"),
        (7.4, (8.0, 4.0), r"motor 2 allows supplies from 8.0 V up to 4.0 V, which is reversed. Set its registers 14"),
        (7.4, (4.0, 14.0), "motor 1 is a servo for 7.4 V, motor 2 one for 12 V. Use servos of one voltage"),
    ],
)
def test_a_servo_on_the_wrong_supply_is_refused(supply: float, allowed: tuple[float, float], told: str) -> None:
    """Oracle: limits and voltage that the emulated servo was given; none is armed."""
    hand = Hand()
    second = EmulatedSts(2, supply=supply, allowed=allowed)
    chain = EmulatedFeetechChain([hand.servos[0], second])
    bus = FeetechBus(chain, [1, 2], clock=chain.clock, wait=chain.wait)
    with pytest.raises(HydrostatError, match=told):
        bus.identify()
    assert not second.table[TORQUE]


@pytest.mark.parametrize("supply", [5.0, 7.4, 8.4, 8.9, 9.0, 12.1, 12.6])
def test_servos_for_12_volts_are_taken_on_3_lithium_cells_and_refused_on_2(supply: float) -> None:
    """Oracle: three lithium cells give 9 to 12.6 V, two give at most 8.4 V; the memory allows both."""
    chain = EmulatedFeetechChain([EmulatedSts(n, supply=supply, allowed=(4.0, 14.0)) for n in (1, 2)])
    bus = FeetechBus(chain, [1, 2], clock=chain.clock, wait=chain.wait)
    if supply < 9.0:
        cells = " Charge a battery of eight NiMH cells." if supply > 8.0 else ""  # an empty cell gives 1 V
        with pytest.raises(HydrostatError, match=rf"motor 1 is .* 12 V .* {supply} V.* 12 V.{cells} If its label"):
            bus.identify()
    else:
        assert [fact.number for fact in bus.identify()] == [1, 2]


def test_a_servo_that_counts_no_turns_is_never_sent_past_its_limits() -> None:
    hand = Hand()
    for servo in hand.servos:
        servo.table[LOW : LOW + 4] = bytes([0, 0, 0xFF, 0x0F])
    hand.bus.identify()
    hand.bus.write(np.full(2, 4095 * TICK), np.ones(2))
    with pytest.raises(HydrostatError, match=r"motor 1 turns from step 0 to 4095 and was asked for 4096; set both"):
        hand.bus.write(np.full(2, 4096 * TICK), np.ones(2))


def test_a_bound_that_was_not_taken_is_told() -> None:
    hand = Hand()
    hand.bus.identify()
    lasting = hand.servos[1].take
    hand.servos[1].take = lambda place, data: 0 if place == BOUND else lasting(place, data)
    with pytest.raises(HydrostatError, match="motor 2 did not take its bound of torque"):
        hand.bus.arm(np.full(2, 0.5))
    assert not any(servo.table[TORQUE] for servo in hand.servos)


def test_it_says_at_connection_that_no_guard_judges_its_cables() -> None:
    """Of three motors one whose torque is known is not named; Dynamixel's servos, all known, bring no such line."""
    hand = Hand()
    lines = list[str]()
    hand.link._log = lines.append
    hand.link.identify()
    assert sum("no tension guard: the torque per current" in line for line in lines) == 1
    assert not_judged(np.array([0.3, np.nan, np.nan]), "abc").startswith("no tension guard of b, c: ")
    rig = Rig()
    rig.link.identify()
    assert not any("no tension guard" in line for line in rig.log)
