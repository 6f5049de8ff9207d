"""From a hand that moves to motors that are told: the delay on ten emulated servos and an emulated glove.

    python lab/teleoperation/glove_delay.py [--moves 150] [--model hand.model] [--baud 1000000]

Glove and servos are a program of their own, at the other end of two pseudo-terminals, as slow as their serial lines:
115,200 baud for the glove, which measures 90 times a second, and --baud for the servos. Its sensors have noise of half
a step, so that a new pose is asked for all the time. At moments of its choice the hand takes another pose. The delay is
from then until a goal in a servo has gone by more than 0.5 mm of cable from where it was. Ways: a ridge map from
sensors to contractions; one to fingertips, which `Tracker` follows; the same with a learned model, whose networks
answer first. Poses are solved as `hydrostat drive` has it, by a process that is nicer than the others. The link has its
deadline; it has no guard by tensions, as these servos bear no load. No glove and no motor of metal is here.

On a computer that others use a core may stand still for tens of milliseconds whatever runs there. A process on each
core that only sleeps tells when: moves in which a core stood still for more than 5 ms are told apart.
"""

import argparse
import multiprocessing as mp
import os
import select
import sys
import threading
import time
import tty
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import heartbeat
import machine
import numpy as np

import hydrostat as hs
from hydrostat.control import (
    GOAL,
    TICK,
    BusLink,
    Calibration,
    DynamixelBus,
    EmulatedChain,
    EmulatedLine,
    EmulatedServo,
    Motors,
    open_line,
)
from hydrostat.errors import HydrostatError
from hydrostat.learning import LearnedModel
from hydrostat.robot import Contact, Robot
from hydrostat.teleop import (
    BAUD,
    SENSORS,
    CommandMapper,
    CyberGlove,
    EmulatedPerson,
    HandMap,
    MappedHand,
    MarkerMapper,
    Mimicry,
    Smoothing,
    WinchMapper,
    drive,
)

MEASURES = 90
"""Of a glove in a second."""
GONE = 0.5e-3
"""A goal that has gone so far is another one [m]."""
PAUSE = (0.8, 1.1)
"""From one move to the next [s]."""


@dataclass
class Told:
    """What the other end has seen.

    Attributes:
        moves: when the hand moved, and when a goal followed [s].
        rests: how far a goal went before each move, while the hand rested [m].
        missed: moves that no goal followed.
        stops: how often motors were stopped, as this computer was too busy.
    """

    moves: list[tuple[float, float]]
    rests: list[float]
    missed: int
    stops: int = 0


class SlowChain(EmulatedChain):
    """Servos whose line takes as long as its bytes do."""

    STEP = 4e-3

    def __init__(self, servos: list[EmulatedServo], baud: int) -> None:
        super().__init__(servos)
        self.towards = self.back = self.slow
        self.baud = baud

    def slow(self, data: bytes) -> bytes:
        """Let pass what bytes take."""
        time.sleep(10 * len(data) / self.baud)
        return data

    def wait(self, seconds: float) -> None:
        """Let time pass, a little at a time: when this program was not let run, what is on the line is heard first."""
        super().wait(min(seconds, 0.02))

    def goals(self) -> np.ndarray:
        """What the servos are told [rad]."""
        return TICK * np.array([servo.get(GOAL, 4) for servo in self.servos])


class LiveGlove(threading.Thread):
    """A glove on a pseudo-terminal, as slow as one of metal."""

    def __init__(self, person: EmulatedPerson) -> None:
        super().__init__(daemon=True)
        self.person, self.over = person, threading.Event()
        self.inner, outer = os.openpty()
        tty.setraw(outer)
        self.path = os.ttyname(outer)

    def run(self) -> None:
        """Measure and answer."""
        person, measured, answer = self.person, 0.0, b""
        while not self.over.is_set():
            if time.monotonic() - measured >= 1 / MEASURES:
                person.glove.write(b"G")
                answer, measured = person.glove.read(SENSORS + 2), time.monotonic()
            if select.select([self.inner], [], [], 0.5e-3)[0]:
                for _ in range(os.read(self.inner, 64).count(b"G")):
                    time.sleep(10 * (SENSORS + 3) / BAUD)
                    os.write(self.inner, answer)


def come_first(*, first: bool = True) -> None:
    """Let all threads of this program run before all other programs of the computer, or no longer (Linux, root)."""
    if "--first" not in sys.argv:
        return
    with suppress(AttributeError, OSError):
        for task in os.listdir("/proc/self/task"):
            os.sched_setscheduler(int(task), os.SCHED_RR if first else os.SCHED_OTHER, os.sched_param(5 * first))


def other_end(pipe, low: np.ndarray, high: np.ndarray, poses: np.ndarray, baud: int, radius: float) -> None:
    """Be glove and motors, and measure."""
    come_first()
    servos = [EmulatedServo(number, model=1240) for number in range(1, len(low) + 1)]
    chain, person = SlowChain(servos, baud), EmulatedPerson(low, high)
    line, glove = EmulatedLine(chain), LiveGlove(person)
    person.mimic(poses[0])
    glove.start()
    pipe.send((line.path, glove.path))
    pipe.recv()
    random, told = np.random.default_rng(3), Told([], [], 0)
    for pose in poses[1:]:
        before, until = deque[np.ndarray](maxlen=20), time.monotonic() + random.uniform(*PAUSE)
        while time.monotonic() < until:
            before.append(chain.goals())
            time.sleep(5e-3)
        usual_goals = np.median(before, axis=0)
        told.rests.append(radius * float(np.abs(before - usual_goals).max()))
        person.mimic(pose)
        moved = time.monotonic()
        while (now := time.monotonic()) - moved < 0.3:
            if radius * np.abs(chain.goals() - usual_goals).max() > GONE:
                told.moves.append((moved, now))
                break
            time.sleep(5e-4)
        else:
            told.missed += 1
    pipe.send(told)
    with suppress(EOFError):
        pipe.recv()
    line.close()


def learned(robot: Robot, simulation: hs.Simulation, *, tips: bool) -> HandMap:
    """What 60 mimicked poses teach, each read 25 times."""
    winches, random = WinchMapper.list_channels(robot), np.random.default_rng(1)
    person = EmulatedPerson(winches.low, winches.high)
    glove = CyberGlove(person.glove)
    names = tuple(f"{name} {axis}" for name in simulation.rest.markers for axis in "xyz") if tips else winches.names
    made = Mimicry(glove.names, names)
    for number, pose in enumerate(random.uniform(0, 0.4, (60, len(winches.names))) * winches.high):
        person.mimic(pose)
        answer = pose
        if tips:
            solved = simulation.solve(pose, strict=False)
            if not solved.result.converged:
                continue
            answer = np.concatenate(list(solved.markers.values()))
        made.add(number, np.mean([glove.read().values for _ in range(25)], axis=0), answer)
    ridge = made.learn()
    error = made.errors(ridge)[0]
    return HandMap(robot=robot.name, sensors=glove.names, outputs=names, ridge=ridge, poses=60, error=error)


def again(ask: Callable[[], object]) -> None:
    """Ask motors up to ten times, as this computer may be too busy for their answers."""
    for left in reversed(range(10)):
        try:
            ask()
            return
        except HydrostatError:
            if not left:
                raise


def measure(robot: Robot, way: CommandMapper, known: HandMap, given: argparse.Namespace) -> Told:
    """Drive, and let the other end measure."""
    winches, random, moves, baud = WinchMapper.list_channels(robot), np.random.default_rng(2), given.moves, given.baud
    flexors = np.array(["flexor" in name for name in winches.names])
    poses = random.uniform(0, 0.35, (moves + 1, len(flexors))) * winches.high * flexors
    ours, theirs = mp.get_context("spawn").Pipe()
    radius = robot.winches[0].spool_radius
    work = mp.get_context("spawn").Process(
        target=other_end, args=(theirs, winches.low, winches.high, poses, baud, radius)
    )
    work.start()
    line, glove = ours.recv()
    calibration = Calibration.usual(robot).assume_zeros(robot)
    come_first()
    bus = DynamixelBus(open_line(line, baud), [motor.number for motor in calibration.motors])
    link = BusLink(bus, robot.winches, calibration)
    again(link.identify)
    again(link.arm)
    smoothing = Smoothing(least=given.smoothing) if given.smoothing else None
    source = MappedHand(way.channels, CyberGlove(open_line(glove, BAUD)), known, smoothing=smoothing)
    found: list[Told] = []

    def hear(_: object) -> None:
        if ours.poll():
            found.append(ours.recv())
            raise KeyboardInterrupt

    ours.send("begin")
    stops, close, way.close = 0, way.close, lambda: None
    try:
        while not found:
            motors = Motors(robot.winches, link, places=link.read(time.monotonic()), fastest=link.limits.speed)
            try:
                drive(motors, way, source, tell=hear)
            except KeyboardInterrupt:
                pass
            except HydrostatError as error:  # this machine did not let it run for longer than a watchdog waits
                stops += 1
                print(f"stopped: {error}", file=sys.stderr, flush=True)
                again(link.arm)
    finally:
        close()
        source.close()
        link.close()
        ours.close()
        work.join(10)
        come_first(first=False)
    return replace(found[0], stops=stops)


def main() -> None:
    """Print a row for each way."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--moves", type=int, default=150)
    parser.add_argument("--model", type=Path, help="learned model of the cupping hand")
    parser.add_argument("--baud", type=int, default=1_000_000)
    parser.add_argument("--way", type=int, choices=(0, 1, 2), help="only this one")
    parser.add_argument("--first", action="store_true", help="go before all other programs (Linux, root)")
    parser.add_argument("--smoothing", type=float, default=1.5, metavar="HZ", help="of the hand; 0: none")
    given = parser.parse_args()
    robot = hs.load_robot("gallery:cupping_hand")
    print(f"{machine.machine()}; load {os.getloadavg()[0]:.1f}; {given.baud} baud to the servos", flush=True)
    print(
        "| way | moves | missed | stops | at rest, mm | p50, ms | p90, ms | p99, ms |\n" + 8 * "|---" + "|", flush=True
    )
    ways = ["ridge to winches", "ridge to fingertips, Tracker"] + ["the same, a learned model first"] * (
        given.model is not None
    )
    for number, name in enumerate(ways):
        if given.way not in (None, number):
            continue
        model = LearnedModel.load(given.model) if number == 2 and given.model else None
        body = replace(robot, contact=Contact()) if model and model.card.contact else robot
        simulation = hs.Simulation(body)
        known = learned(robot, simulation, tips=number > 0)
        rest = np.zeros(len(robot.winches))
        if number == 0:
            way: CommandMapper = WinchMapper(simulation, rest)
        else:
            way = MarkerMapper(simulation, rest, model=model, rate=0.06)
        hearts = heartbeat.Hearts(first=given.first)
        told = measure(robot, way, known, given)
        stood = hearts.stop()
        ran = [move for move in told.moves if not heartbeat.overlap(stood, *move)]
        rest = f"{1e3 * np.median(told.rests):.2f}"
        for words, moves in ("all", told.moves), ("cores ran", ran):
            delays = [1e3 * (seen - moved) for moved, seen in moves]
            shown = " | ".join(f"{value:.1f}" for value in np.percentile(delays or [np.nan], [50, 90, 99]))
            print(f"| {name} | {words}: {len(moves)} | {told.missed} | {told.stops} | {rest} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
