"""Feetech servos on an ESP32-S3. Oracles: our emulated servos, and the driver in Python on the same ones."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import ServoBoard, two_winch_strip

from hydrostat.control import BusLink, Calibration, Motors, Player, bake_moves
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedScs, EmulatedSts
from hydrostat.control.emulated_servos import InjectedFaults
from hydrostat.control.feetech_bus import BOUND, LOW, MODE, TORQUE, VOLTS, FeetechBus, SumReader, pack
from hydrostat.control.firmware_build import build_firmware, firmware_settings, robot_word
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.firmware_servos import SERVO_STEPS
from hydrostat.control.scs_bus import BOUND as SCS_BOUND
from hydrostat.control.scs_bus import LOCK, ScsBus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ProfileTable

KINDS = {"feetech": (EmulatedSts, FeetechBus), "scs": (EmulatedScs, ScsBus)}
ZEROS = {"feetech": (-2.0, 11.0), "scs": (0.8, 4.7)}
"""Zeros of the motors [rad]: those of STS servos lie in other turns than the one that they are switched on in."""
TURNS = {"feetech": (1, 1), "scs": (1, -1)}
TRAVEL = {"feetech": 0.06, "scs": 0.018}
"""Travel of both winches [m]: on a spool of 5 mm almost two turns, or 206 degrees."""
ROWS = ((0, 3, 0), (1, 14, 6), (1.6, 14, 6), (2.4, 4, 15), (3, 4, 15), (3.3, 4, 12))
"""Time [s] and contractions [mm]; the motors stand from 1 to 1.6 s and from 2.4 to 3 s."""


@pytest.fixture(params=["feetech", "scs"])
def bus(request: pytest.FixtureRequest) -> str:
    return request.param


@cache
def robot_with(bus: str) -> Robot:
    strip = two_winch_strip()
    return replace(strip, winches=tuple(replace(each, travel=TRAVEL[bus]) for each in strip.winches))


@cache
def motors_of(bus: str) -> Calibration:
    """Motor 2 on the first winch, motor 1 on the second, on layers that make the spool larger."""
    given = zip(Calibration.usual(robot_with(bus)).motors, ZEROS[bus], TURNS[bus], strict=True)
    rest = {"counts": SERVO_STEPS[bus], "curve": ((2.0, 0.0102), (5.0, 0.0264))}
    return Calibration(
        tuple(replace(m, number=3 - m.number, zero=zero, turns=turns, **rest) for m, zero, turns in given)
    )


def servos_of(bus: str) -> list[EmulatedSts | EmulatedScs]:
    """Servos 1 and 2, which stand at the zeros; a cable pulls each back by 200 N/m."""

    def pull(place: int) -> Callable[[float], float]:
        way = TURNS[bus][place]
        return lambda angle: way * 0.005**2 * 200 * max(way * (angle - ZEROS[bus][place]), 0.0)

    return [KINDS[bus][0](2 - place, angle=ZEROS[bus][place], load=pull(place)) for place in (1, 0)]


def start(
    bus: str,
    folder: Path,
    *,
    change: Callable[[list], None] = lambda _: None,
    more: str = "",
    robot: Robot | None = None,
) -> ServoBoard:
    """A board with moves and its servos, switched on a moment ago."""
    robot, motors, servos = robot or robot_with(bus), motors_of(bus), servos_of(bus)
    change(servos)
    names = ",".join(winch.name for winch in robot.winches)
    lines = [f"time_s,{names}", *(",".join(map(str, row)) for row in ROWS)]
    (folder / "dance.csv").write_text("\n".join(lines) + "\n")
    moves = bake_moves(folder / "dance.csv", folder, robot, motors, "esp32s3").settings
    settings = firmware_settings(robot, motors, rpm=60.0, bus=bus) + moves + more
    board = ServoBoard(servos, settings, echoes=True)
    board.run(0.1)
    return board


def steps_of(bus: str) -> str:
    """Zeros in steps, in the order of the board."""
    return " ".join(str(round(zero * SERVO_STEPS[bus] / (2 * np.pi))) for zero in ZEROS[bus][::-1])


def contractions_of(bus: str, servos: list) -> np.ndarray:
    """Where they are in truth [m]."""
    return motors_of(bus).contractions(np.array([servos[1].angle, servos[0].angle]))


def link_of(bus: str, board: ServoBoard) -> BusLink:
    """A link to a board whose zeros are known."""
    word = robot_word(robot_with(bus), motors_of(bus))
    driver = FirmwareBus(board, [SERVO_STEPS[bus]] * 2, [2, 1], robot=word, clock=board.clock, wait=board.run)
    assert board.ask(f"M {steps_of(bus)}") == "ok"
    link = BusLink(driver, robot_with(bus).winches, motors_of(bus), clock=board.clock)
    link.identify()
    link.arm()
    return link


def is_torque_on(board: ServoBoard) -> list[bool]:
    return [bool(servo.table[TORQUE]) for servo in board.chain.servos]


def test_packets_are_those_of_our_driver(bus: str, tmp_path: Path) -> None:
    """All that it sends is whole packets; the lasting memory of a servo is written behind its lock alone."""
    board = start(bus, tmp_path)
    assert board.ask("I").startswith(f"ok hydrostat 1 esp32s3 {robot_word(robot_with(bus), motors_of(bus))} 2 200 ")
    assert board.ask("A 400 200") == "ok"
    board.run(0.1)
    packets = list(SumReader().feed(board.line))
    assert b"".join(pack(*each) for each in packets) == board.line
    written = [packet.content[0] for packet in packets if packet.instruction != 0x02]
    assert (min(written) >= TORQUE) if bus == "feetech" else written.index(LOCK) < written.index(16)
    assert is_torque_on(board) == [True, True]
    driver = KINDS[bus][1](EmulatedFeetechChain(twins := servos_of(bus)), [1, 2])
    driver.identify()
    driver.arm(np.array([0.4, 0.2]))
    assert [servo.most for servo in board.chain.servos] == [servo.most for servo in twins]


def test_a_computer_gets_the_poses_of_our_driver(bus: str, tmp_path: Path) -> None:
    """Through the board and without it, within 0.1 mm in truth, though the board loses each fifth answer."""
    found, answers = [], count()
    for through in (True, False):
        board = start(bus, tmp_path)
        chain = board.chain
        if through:
            chain.back = lambda data: data[:-1] if data and next(answers) % 5 == 0 else data
            link = link_of(bus, board)
        else:
            driver = KINDS[bus][1](chain, [2, 1], clock=chain.clock, wait=chain.wait)
            link = BusLink(driver, robot_with(bus).winches, motors_of(bus), clock=chain.clock)
            link.identify()
            link.arm()
        for goal in ((0.9 * TRAVEL[bus], 0.004), (0.002, 0.8 * TRAVEL[bus])):
            for _ in range(round(2.5 * TRAVEL[bus] / 0.02 / 0.02)):
                link.send(np.array(goal), 0.0, speed=0.02)
                board.run(0.02) if through else chain.wait(0.02)
                link.read(0.0)
            found.append(contractions_of(bus, chain.servos))
            assert found[-1] == pytest.approx(goal, abs=3e-4)
        if through:
            assert link.reading is not None
            assert link.reading.volts == pytest.approx(chain.servos[0].supply)
            assert board.ask("G 40000 100 0 100") == "no limit"
            assert link.currents is not None
            assert link.currents[1] > 0.01  # what its cable pulls
        link.close()
    assert np.abs(np.array(found[:2]) - found[2:]).max() < 1e-4


@dataclass
class ErrorsInTurn(InjectedFaults):
    """Errors of the next answers, the last for all that follow."""

    script: tuple[int, ...] = ()

    @property
    def bits(self) -> int:
        """Errors of the next answer."""
        errors, *rest = self.script
        self.script = tuple(rest) or (errors,)
        return errors


def spoil_bound(servo: EmulatedSts | EmulatedScs, *, again: bool) -> None:
    """Set a servo's bound of torque to the greatest; with `again`, it takes no other."""
    place = SCS_BOUND if isinstance(servo, EmulatedScs) else BOUND
    take = servo.take
    take(place, bytes(2))
    if again:
        servo.take = lambda at, data: 0 if at == place else take(at, data)


FAULTS: list[tuple[str, Callable, str]] = [
    ("dead", lambda servo: setattr(servo.ails, "deaf", True), "unheard 2"),
    ("hot", lambda servo: setattr(servo.ails, "hot", True), "heat 2"),
    ("overloaded", lambda servo: setattr(servo.ails, "overloaded", True), "current 2"),
    ("too much current", lambda servo: setattr(servo, "ails", ErrorsInTurn(script=(8,))), "current 2"),
    ("encoder", lambda servo: setattr(servo, "ails", ErrorsInTurn(script=(2,))), "encoder 2"),
    ("sagging", lambda servo: setattr(servo.ails, "sags", True), "supply 0"),
    ("sags twice", lambda servo: setattr(servo, "ails", ErrorsInTurn(script=(1, 1, 0))), "supply 0"),
    ("sags once", lambda servo: setattr(servo, "ails", ErrorsInTurn(script=(1, 0))), ""),
    ("stuck", lambda servo: setattr(servo.ails, "stuck", True), "stall 2"),
    ("bound lost", lambda servo: spoil_bound(servo, again=False), ""),
    ("bound not taken", lambda servo: spoil_bound(servo, again=True), "unheard 2"),
    ("restarted", lambda servo: servo.begin_anew(), "restarted 2"),
    ("restarted within its turn", lambda servo: servo.take(TORQUE, bytes(1)), "restarted 2"),
    ("carried off", lambda servo: setattr(servo, "angle", servo.angle - 0.012), ""),
    ("past its limit", lambda servo: None, "beyond 2"),
]
GOALS = {"feetech": "G 8000 400 0 400", "scs": "G 400 150 700 150"}


@pytest.mark.parametrize(("fault", "told"), [each[1:] for each in FAULTS], ids=[each[0] for each in FAULTS])
@pytest.mark.parametrize(("bus", "alone"), [("feetech", False), ("feetech", True), ("scs", False)])
def test_a_servo_that_fails_stops_all(bus: str, tmp_path: Path, fault: Callable, told: str, alone: bool) -> None:
    """Torque goes off on all that hear, and the answer names the servo. Small faults, or a single one, do no harm."""
    board = start(bus, tmp_path)
    servos = board.chain.servos
    assert board.ask(f"M {steps_of(bus)}") == "ok"
    if alone:
        board.press()
    else:
        assert board.ask("A 400 400") == "ok"
        assert board.ask(GOALS[bus]) == "ok"
    board.keep(0.3)
    assert is_torque_on(board) == [True, True]
    bounds = [servo.most for servo in servos]
    fault(servos[1])
    if told == "beyond 2":  # as if its zero were 3 m away
        assert board.ask(f"M {steps_of(bus).split()[0]} -400000") == "ok"
    said = board.keep(0.3 if told == "" else 0.9)
    if not told:
        assert said.startswith("ok armed ")
        assert [servo.most for servo in servos] == bounds
        return
    assert said.startswith(f"ok {told} "), said
    assert is_torque_on(board) == [False, servos[1].ails.deaf]
    if told == "restarted 2" and bus == "feetech":
        assert board.ask("I").endswith(" new")
        board.press()
        assert board.ask("R").startswith("ok restarted ")
    if servos[1].ails.sags:
        assert board.ask("A 400 400") == "no voltage 2"


def test_silence_holds_and_a_hung_program_lets_go(tmp_path: Path) -> None:
    """A silent computer leaves servos standing where they are; the watchdog's reset ends torque on the line."""
    board = start("feetech", tmp_path)
    assert board.ask("A 400 400") == "ok"
    before = board.ask("R").split()
    goals = [int(before[3]) + 3000, int(before[5]) + 3000]
    assert board.ask(f"G {goals[0]} 800 {goals[1]} 800") == "ok"
    board.run(0.3)
    where = contractions_of("feetech", board.chain.servos)
    assert board.ask("R").startswith("ok silent 0 ")
    board.run(0.3)
    assert contractions_of("feetech", board.chain.servos) == pytest.approx(where, abs=3e-4)
    assert is_torque_on(board) == [True, True]
    board.hang()
    board.run(0.3)
    assert board.ask("I").endswith(" watchdog new")
    assert is_torque_on(board) == [False, False]


@pytest.mark.parametrize(
    ("bus", "change", "told"),
    [
        ("feetech", {"supply": 12.1}, "voltage 2"),
        ("feetech", {"supply": 8.6, "allowed": (6.0, 14.0)}, "voltage 2"),
        ("feetech", {"supply": 12.0, "allowed": (8.0, 14.0)}, "voltage 2"),
        ("feetech", {"model": 1284}, "model 2"),
        ("feetech", {"number": 7}, "servo 2"),
        ("feetech", {"registers": (LOW, bytes([0, 0, 0xFF, 0x0F]))}, "range 2"),
        ("feetech", {"registers": (MODE, bytes([1]))}, "mode 2"),
        ("feetech", {"allowed": (8.0, 4.0)}, "memory 2"),
        ("feetech", {"ails": InjectedFaults(hot=True)}, "fault 2"),
        ("feetech", {"ails": ErrorsInTurn(script=(8,))}, "fault 2"),
        ("scs", {"registers": (VOLTS, bytes([45, 84]))}, "memory 2"),
        ("scs", {"ails": InjectedFaults(hot=True)}, "fault 2"),
        ("scs", {"model": 777}, "model 2"),
        ("scs", {"supply": 8.6}, "voltage 2"),
        ("scs", {"registers": (LOW, bytes(4))}, "range 2"),
    ],
)
def test_servos_that_are_not_ready_are_not_armed(bus: str, change: dict, told: str, tmp_path: Path) -> None:
    """The second is on another supply than its own, or than the first's; another model; not there; counts no turns."""

    def spoil(servos: list) -> None:
        rest = {name: value for name, value in change.items() if name != "registers"}
        servos[1] = KINDS[bus][0](**{"number": 2, "angle": ZEROS[bus][0], **rest})
        at, data = change.get("registers", (0, b""))
        servos[1].table[at : at + len(data)] = data

    board = start(bus, tmp_path, change=spoil)
    assert board.ask("A 400 400") == f"no {told}"
    assert not board.is_lit()
    driver = FirmwareBus(board, [SERVO_STEPS[bus]] * 2, clock=board.clock, wait=board.run)
    with pytest.raises(HydrostatError, match="servo 2 "):
        driver.identify()
    assert is_torque_on(board) == [False, False]


def test_a_board_alone_moves_as_with_our_driver(bus: str, tmp_path: Path) -> None:
    """Within 0.1 mm where motors stand, 1 mm on the way. An SCS0009 keeps its zeros without power, so the board too."""
    board = start(bus, tmp_path)
    robot, motors, chain = robot_with(bus), motors_of(bus), EmulatedFeetechChain(servos_of(bus))
    driver = KINDS[bus][1](chain, [2, 1], clock=chain.clock, wait=chain.wait)
    link = BusLink(driver, robot.winches, motors, clock=chain.clock)
    link.identify()
    link.arm()
    player, guided = Player(), list[tuple[float, ...]]()
    player.rounds = 1

    def note() -> None:
        if player.time > 0:
            guided.append((player.time, *contractions_of(bus, chain.servos)))

    profile = ProfileTable.open(tmp_path / "dance.csv", robot).profile
    hands = Motors(robot.winches, link, places=link.read(0.0), fastest=0.06)
    player.run(hands, profile, tell=note, clock=chain.clock, wait=chain.wait)
    assert board.is_lit() == (bus == "scs")
    if bus == "feetech":
        board.press()
        assert board.ask("R").startswith("ok off 0 ")
        assert board.ask(f"M {steps_of(bus)}") == "ok"
    assert board.is_lit()
    board.press()
    free = list[tuple[float, ...]]()
    while board.ask("R").startswith("ok armed") and len(free) < 800:
        free.append((board.clock(), *contractions_of(bus, board.chain.servos)))
    one, other = np.array(guided), np.array(free)
    other[:, 0] -= other[0, 0]
    assert 5.2 < other[-1, 0] < 6.0  # 3.3 s and 2 s to hold, after it went to the first row

    def differ(late: float, times: np.ndarray) -> float:
        pairs = ((np.interp(times, *one[:, [0, k]].T), np.interp(times + late, *other[:, [0, k]].T)) for k in (1, 2))
        return max(float(np.abs(first - second).max()) for first, second in pairs)

    times = np.linspace(0.3, 3.2, 200)
    late = min(np.arange(-0.4, 0.8, 0.01).tolist(), key=lambda each: differ(each, times))
    assert differ(late, times) < 1e-3
    assert differ(late, np.array([1.55, 2.95])) < 1e-4
    assert is_torque_on(board) == [False, False]


def test_a_short_winch_finds_its_turn(tmp_path: Path) -> None:
    """STS servos that were switched on count from within a turn; stored zeros lie in others. Oracle: the last row."""

    def switch_on(servos: list) -> None:
        for servo in servos:
            servo.origin = 2 * np.pi * (servo.angle // (2 * np.pi))
            servo.step(0.0, 1e-3)

    board = start("feetech", tmp_path, change=switch_on, robot=robot_with("scs"))
    assert board.is_lit()
    board.press()
    board.keep(4.5)
    assert board.ask("R").startswith("ok armed ")
    assert contractions_of("feetech", board.chain.servos) == pytest.approx([0.004, 0.012], abs=1e-4)


def test_a_second_press_stops_and_a_low_battery_ends_moves(tmp_path: Path) -> None:
    """Servos stand where they were for 2 s, then let go; below the supply of the settings nothing plays again."""
    board = start("scs", tmp_path, more="#define MIN_SUPPLY 5500\n")
    board.press()
    board.run(0.9)
    board.press()
    where = contractions_of("scs", board.chain.servos)
    assert where.max() > 5e-3
    assert board.ask("G 0 100 0 100") == "no alone"
    board.run(1.7)
    assert board.ask("R").startswith("ok armed 0 ")
    board.run(0.4)
    assert board.ask("R").startswith("ok off 0 ")
    assert contractions_of("scs", board.chain.servos) == pytest.approx(where, abs=4e-4)
    board.press()
    assert board.ask("R").startswith("ok armed 0 ")
    for servo in board.chain.servos:
        servo.supply = 5.2
    board.run(0.3)
    assert board.ask("R").startswith("ok armed 0 ")
    board.run(0.4)
    assert board.ask("R").startswith("ok supply 0 ")
    assert is_torque_on(board) == [False, False]
    for servo in board.chain.servos:
        servo.supply = 6.0
    board.run(0.1)
    board.press()
    assert board.ask("A 400 400") == "no supply"


def test_settings_hold_zeros_that_last(tmp_path: Path) -> None:
    """By hand: of an SCS0009 always, of an STS3215 if the winch turns by less than a turn of 31.4 mm."""
    text = firmware_settings(robot_with("scs"), motors_of("scs"), rpm=60.0, bus="scs")
    assert f"#define ZEROS {{{steps_of('scs').replace(' ', ', ')}}}" in text
    rows = re.findall(r"\{(-?\d+), (-?\d+), (\d+), \d+, 1, 400\}, /\*", text)
    most = round(1228.8 * 0.018 / 0.0314159)
    assert [tuple(map(int, row[:2])) for row in rows] == [(-most, 0), (0, most)]  # motor 1 turns the other way
    long = firmware_settings(robot_with("feetech"), motors_of("feetech"), rpm=60.0, bus="feetech")
    assert "#define ZEROS" not in long
    short = firmware_settings(robot_with("scs"), motors_of("feetech"), rpm=60.0, bus="feetech")
    assert "#define ZEROS {7171, -1304}" in short
    assert "#define ALONE_SPARE 2.0000f" in short
    assert "#define TURN 4096" in short
    new = Calibration(tuple(replace(motor, zero=None) for motor in motors_of("scs").motors))
    assert "#define ZEROS" not in firmware_settings(robot_with("scs"), new, rpm=60.0, bus="scs")
    with pytest.raises(InputError, match=r"board mega drives 0 servos, the robot has 2\. Use --board esp32s3"):
        build_firmware(text, "mega", tmp_path)
