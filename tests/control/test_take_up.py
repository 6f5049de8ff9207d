"""Slack taken up by emulated winches. Oracles: slacks, friction and noise that only the emulated winches know."""

import numpy as np
import pytest

from hydrostat.control.calibration import WinchMotor
from hydrostat.control.dynamixel_bus import DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedScs, EmulatedSts
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo, InjectedFaults
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.model_tensions import WinchPull
from hydrostat.control.scs_bus import ScsBus
from hydrostat.control.take_up import RULES, SlackCalibration, find_cable_zeros, find_edge
from hydrostat.errors import HydrostatError

RADIUS, CONSTANT = 0.008, 0.35  # [m], [N m/A]
SLACKS = np.array([0.0, 0.0012, 0.0045, 0.0085, 0.013, 0.017, 0.0031, 0.022, -0.0012, -0.004])  # hidden [m]
STIFF = np.array([300, 500, 200, 900, 400, 1500, 250, 350, 600, 300])  # of what the cables pull at [N/m]


def straight(taut: float = 0.0) -> WinchPull:
    """A model whose cables pull by 100 N/m from an edge on."""
    return WinchPull(taut=taut, places=np.array([-1.0, taut, taut + 1.0]), pulls=np.array([0.0, 0.0, 100.0]))


class Winches:
    """Emulated winches with hidden slacks, friction and noisy currents."""

    def __init__(self, slacks: np.ndarray = SLACKS, *, noise: float = 2e-3) -> None:
        rng, self.slacks, count = np.random.default_rng(7), slacks, len(slacks)
        draws = (draw for _ in iter(int, 1) for draw in rng.normal(size=1000).tolist())
        self.pulls = STIFF[:count].astype(float)
        self.hardest = 0.0
        self.begin = rng.uniform(-3, 3, count)  # where each motor stands at first [rad]
        self.servos = [EmulatedServo(n + 1, model=1240, angle=float(self.begin[n])) for n in range(count)]

        def load(index: int):
            begin, slack = float(self.begin[index]), float(slacks[index])

            def torque(angle: float) -> float:
                pull = self.pulls[index] * max(RADIUS * (angle - begin) - slack, 0.0)
                self.hardest = max(self.hardest, pull)
                return RADIUS * pull + CONSTANT * (0.01 + noise * next(draws))

            return torque

        for index, servo in enumerate(self.servos):
            servo.load, servo.constant = load(index), CONSTANT
        self.chain = EmulatedChain(self.servos)
        self.chain.STEP = 2e-3
        numbers = [servo.number for servo in self.servos]
        self.bus = DynamixelBus(self.chain, numbers, clock=self.chain.clock, wait=self.chain.wait)
        self.motors = [WinchMotor(winch=f"winch {n}", number=n, radius=RADIUS) for n in numbers]
        self.found: list[SlackCalibration] = []

    def take_up(self, taut: np.ndarray | None = None) -> tuple[SlackCalibration, ...]:
        self.bus.identify()
        taut = np.zeros(len(self.motors)) if taut is None else taut
        model = [straight(float(place)) for place in taut]
        clock, wait = self.chain.clock, self.chain.wait
        return find_cable_zeros(self.bus, self.motors, model, self.found.append, clock=clock, wait=wait)

    def zeros(self) -> np.ndarray:
        return self.begin + self.slacks / RADIUS


def test_ten_hidden_slacks_are_found_to_half_a_millimeter_in_two_minutes() -> None:
    winches = Winches()
    taken = winches.take_up()
    errors = RADIUS * (np.array([each.motor.zero for each in taken]) - winches.zeros())
    assert np.abs(errors).max() < 5e-4
    assert [each.slack for each in taken] == pytest.approx(winches.slacks, abs=5e-4)
    assert winches.chain.now < 120.0
    assert winches.hardest < CONSTANT * (RULES.max_current + 0.01) / RADIUS + 1.5  # a step goes so far beyond it
    gains = [each.gain for each in taken]
    assert gains == pytest.approx(winches.pulls / 100 * RADIUS / CONSTANT, rel=0.25)
    stands = np.array([servo.angle for servo in winches.servos])
    assert pytest.approx(stands, abs=0.02) == [each.motor.zero for each in taken]
    winches.chain.wait(2.0)
    assert [servo.angle for servo in winches.servos] == pytest.approx(stands, abs=2e-3)


@pytest.mark.parametrize(
    ("model", "constant", "stiff"),
    [
        (1200, 0.52 / 1.47, 400.0),
        (1240, 0.93 / 1.8, 700.0),
        (1060, 1.5 / 1.4, 700.0),
        (777, 1.912 / 2.7, 400.0),
        (777, 2.942 / 2.7, 700.0),
        (1284, 0.25, 200.0),
    ],
    ids=["XL330", "XC330", "XL430", "STS3215", "STS3215 of 12 V", "SCS0009"],
)
def test_zeros_of_each_make_are_repeatable_to_a_third_of_a_millimeter(
    model: int, constant: float, stiff: float
) -> None:
    """Oracle: the edge of a cable that pulls by so much [N/m], begun from three places with 2 mA of noise."""
    found = []
    edge, feetech = 2.5, {777: (EmulatedSts, FeetechBus), 1284: (EmulatedScs, ScsBus)}
    for seed, start in enumerate((2.0, 2.15, 1.8)):
        rng = np.random.default_rng(seed)
        make, kind = feetech.get(model, (EmulatedServo, DynamixelBus))
        servo = make(1, model=model, angle=start)
        servo.constant = constant

        def load(angle: float, servo: EmulatedServo = servo, rng: np.random.Generator = rng) -> float:
            pull = stiff * max(RADIUS * (angle - edge), 0.0)
            return RADIUS * pull + servo.constant * (0.01 + 2e-3 * float(rng.normal()))

        servo.load = load
        port = (EmulatedFeetechChain if model in feetech else EmulatedChain)([servo])
        port.STEP = 4e-3
        bus = kind(port, [1], clock=port.clock, wait=port.wait)
        bus.identify()
        motor = WinchMotor(winch="flexor", number=1, radius=RADIUS)
        (taken,) = find_cable_zeros(bus, [motor], [straight()], found.append, clock=port.clock, wait=port.wait)
        assert taken.motor.zero == pytest.approx(edge, abs=3e-4 / RADIUS)
    assert RADIUS * np.ptp([each.motor.zero for each in found]) < 3e-4


def test_what_the_model_has_slack_is_no_part_of_the_zero_and_spools_grow() -> None:
    winches = Winches(np.array([0.004]))
    winches.motors = [WinchMotor(winch="flexor", number=1, radius=RADIUS, curve=((0.5, 0.0041),))]
    (taken,) = winches.take_up(np.array([0.003]))
    assert taken.motor.contraction(winches.begin[0] + 0.004 / RADIUS) == pytest.approx(0.003, abs=3e-4)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda w: w.pulls.__setitem__(1, 0.0), "winch 2: no pull is felt after 40 mm"),
        (lambda w: w.servos[0].__setattr__("ails", InjectedFaults(hot=True)), "winch 1 reports"),
        (lambda w: w.servos[0].__setattr__("ails", InjectedFaults(stuck=True)), "winch 1: its motor does not follow"),
        (lambda w: w.pulls.__setitem__(0, 2.0), "winch 1: "),
    ],
)
def test_what_is_wrong_is_named_and_the_motors_stand(spoil, told: str) -> None:
    winches = Winches(np.array([0.002, 0.002]))
    winches.bus.identify()
    spoil(winches)
    with pytest.raises(HydrostatError, match=told):
        winches.take_up()
    before = [servo.angle for servo in winches.servos]
    winches.chain.wait(1.0)
    assert [servo.angle for servo in winches.servos] == pytest.approx(before, abs=0.02)


def test_a_motor_that_turns_the_other_way_is_told() -> None:
    winches = Winches(np.array([0.002]))
    winches.motors = [WinchMotor(winch="flexor", number=1, radius=RADIUS, turns=-1)]
    with pytest.raises(HydrostatError, match=r"turns = 1\)"):
        winches.take_up()


def test_a_motor_that_is_unplugged_midway_is_told_and_what_was_found_is_kept() -> None:
    winches = Winches(SLACKS[:3])
    winches.motors = winches.motors[:3]

    def found(taken: SlackCalibration) -> None:
        winches.found.append(taken)
        winches.servos[2].ails = InjectedFaults(deaf=True)

    winches.bus.identify()
    clock, wait = winches.chain.clock, winches.chain.wait
    with pytest.raises(HydrostatError, match="motor of winch 3 does not answer"):
        find_cable_zeros(winches.bus, winches.motors, [straight()] * 3, found, clock=clock, wait=wait)
    assert [each.motor.winch for each in winches.found] == ["winch 1"]


def test_a_body_that_stiffens_is_no_later_edge() -> None:
    winches = Winches(np.array([0.006]))
    winches.servos[0].load = lambda angle: RADIUS * curve(RADIUS * (angle - winches.begin[0]) - 0.006)

    def curve(way: float) -> float:
        return 180.0 * max(way, 0.0) + 6e3 * max(way, 0.0) ** 2

    places = np.array([-1.0, 0.0, *np.linspace(0.002, 0.02, 10)])
    model = WinchPull(taut=0.0, places=places, pulls=1.7 * np.array([curve(place) for place in places.tolist()]))
    winches.bus.identify()
    clock, wait = winches.chain.clock, winches.chain.wait
    (taken,) = find_cable_zeros(winches.bus, winches.motors, [model], winches.found.append, clock=clock, wait=wait)
    assert taken.slack == pytest.approx(0.006, abs=3e-4)
    assert taken.gain == pytest.approx(RADIUS / CONSTANT / 1.7, rel=0.1)


def test_a_busy_computer_only_takes_longer() -> None:
    winches = Winches(np.array([0.006]))
    winches.bus.identify()
    turns = [0]

    def wait(seconds: float) -> None:
        turns[0] += 1
        winches.chain.wait(0.4 if turns[0] in (40, 90) else seconds)

    clock = winches.chain.clock
    (taken,) = find_cable_zeros(winches.bus, winches.motors, [straight()], winches.found.append, clock=clock, wait=wait)
    assert turns[0] > 90
    assert taken.slack == pytest.approx(0.006, abs=4e-4)
    slow = lambda _: winches.chain.wait(0.2)  # noqa: E731
    with pytest.raises(HydrostatError, match="too busy"):
        find_cable_zeros(winches.bus, winches.motors, [straight()], winches.found.append, clock=clock, wait=slow)


@pytest.mark.parametrize(("noise", "stiff", "slip"), [(5e-3, 700, 0.8e-3), (5e-3, 500, 1.2e-3), (5e-3, 3000, 1.2e-3)])
def test_a_spool_that_slips_is_told(noise: float, stiff: float, slip: float) -> None:
    winches = Winches(np.array([0.002]), noise=noise)
    winches.pulls[0] = stiff
    torque, felt = winches.servos[0].load, [False] * 4  # after the first measurement, of soft cables a look

    def slips(angle: float) -> float:
        taken = RADIUS * (angle - winches.begin[0]) - 0.002
        for turn in (0, 2):  # measured, then let out
            felt[turn] |= all(felt[:turn]) and stiff * taken * RADIUS / CONSTANT > 0.045
            felt[turn + 1] |= all(felt[: turn + 1]) and taken < 0
        return torque(angle - (slip / RADIUS if all(felt) else 0.0))

    winches.servos[0].load = slips
    with pytest.raises(HydrostatError, match="mm apart in two measurements"):
        winches.take_up()


@pytest.mark.parametrize("currents", [np.full(60, 0.1), 0.1 - 5 * np.linspace(-3e-3, 3e-3, 60)])
def test_a_current_that_does_not_rise_is_told(currents: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    winches = Winches(np.array([0.002]))
    measured = np.linspace(-3e-3, 3e-3, 60), currents
    monkeypatch.setattr("hydrostat.control.take_up._Taker._measure", lambda *_: measured)
    with pytest.raises(HydrostatError, match="current does not rise with the pull"):
        winches.take_up()


def test_an_edge_is_where_the_line_begins() -> None:
    places = np.linspace(-0.003, 0.004, 60)
    edge, slope, floor = find_edge(places, 0.01 + 5.0 * np.maximum(places - 0.00123, 0.0), straight())
    assert (edge, slope, floor) == pytest.approx((0.00123, 0.05, 0.01), abs=2e-5, rel=1e-2)
