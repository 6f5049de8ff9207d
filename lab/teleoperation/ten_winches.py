"""Ten emulated winches play poses of the cupping hand at 50 Hz under the loads of its finite elements; a cable is cut.

    python lab/teleoperation/ten_winches.py [--seconds 600] [--clock]

Time is that of the emulation. Counted are frames in which a motor was not heard, and frames longer than 20 ms. The
error of a pose is the largest distance of any node between the pose of what the motors have in truth and that of what
they were told, at the end of a frame, where each key is held and on the way between, in one round of seven. The guard
knows the same loads as the motors feel.

With --clock time is that of this computer. A frame is late when it begins more than 5 ms after its time, and lost when
its time passed while another went on; motors that were stopped are armed again, and told.
No motor of metal turns.
"""

import argparse
import os
import time
from contextlib import suppress

import machine
import numpy as np

from hydrostat.control import (
    BusLink,
    Calibration,
    DynamixelBus,
    EmulatedChain,
    EmulatedServo,
    LiveChain,
    TensionGuard,
    WinchMotor,
    steady,
    tensions_along,
)
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.simulation import ContractionProfile, Simulation

FRAME = 0.02  # [s]
CLOSED = 0.012  # that flexors take in [m]
CUT = "index flexor"
ROUNDS = 7  # of so many rounds the poses of one are solved
LATE = 5e-3
"""A frame that begins so much after its time is late [s]."""


class TenWinches:
    """Emulated motors on a link, with the load of the cables of a robot."""

    def __init__(self, robot: Robot, profile: ContractionProfile, *, live: bool = False) -> None:
        self.pulls, self.cut = tensions_along(robot, profile), -1
        radii = [winch.spool_radius for winch in robot.winches]
        self.servos = [EmulatedServo(n, model=1240) for n in range(1, len(radii) + 1)]
        self.chain, self.radii = (LiveChain if live else EmulatedChain)(self.servos), np.array(radii)
        self.chain.STEP = 2e-3
        self._known, self._torques = -1.0, np.zeros(len(radii))
        for index, servo in enumerate(self.servos):
            servo.constant = 0.93 / 1.8
            servo.load = lambda _, index=index: self.torque(index)
        numbers = [servo.number for servo in self.servos]
        clocks = {} if live else {"clock": self.chain.clock, "wait": self.chain.wait}
        bus = DynamixelBus(self.chain, numbers, **clocks)
        spools = [
            WinchMotor(winch=winch.name, number=number, zero=0.0, radius=winch.spool_radius)
            for winch, number in zip(robot.winches, numbers, strict=True)
        ]
        clocks.pop("wait", None)
        self.link = BusLink(bus, robot.winches, Calibration(tuple(spools)), **clocks)
        constants = np.array([fact.constant for fact in self.link.identify()])
        self.link.guard = TensionGuard(self.pulls, constants, tuple(winch.name for winch in robot.winches))
        self.link.arm()

    @property
    def places(self) -> np.ndarray:
        """What the winches have taken in in truth [m]."""
        return self.radii * [servo.angle for servo in self.servos]

    def torque(self, index: int) -> float:
        """Of a cable; all are known again at each step."""
        if self._known != self.chain.now:
            self._known, self._torques = self.chain.now, self.radii * self.pulls(self.places)
        return 0.0 if index == self.cut else float(self._torques[index])

    def frame(self, goal: np.ndarray) -> tuple[bool, float]:
        """Tell a goal; whether all motors were heard, and how long it took [s]."""
        begin = self.chain.now
        self.link.send(goal, begin, speed=0.06)
        self.link.read(begin)
        reading = self.link.reading
        heard = reading is not None and bool((reading.stamps >= begin).all())
        took = self.chain.now - begin
        self.chain.wait(max(0.0, FRAME - took))
        return heard, took


def moves(robot: Robot) -> ContractionProfile:
    """Open, fist, open, a finger that points, open: a key in two seconds, held for a half."""
    flexors = np.array([CLOSED * ("flexor" in winch.name) for winch in robot.winches])
    points = flexors * [winch.name != CUT for winch in robot.winches]
    keys = [0 * flexors, flexors, 0 * flexors, points, 0 * flexors]
    values = [value for key in keys for value in (key, key)]
    times = [time for count in range(len(keys)) for time in (2.0 * count, 2.0 * count + 0.5)]
    return ContractionProfile(times=np.array(times), values=np.array(values))


def apart(simulation: Simulation, first: np.ndarray, second: np.ndarray) -> float:
    """Largest distance of a node between two poses [m]."""
    one, two = (simulation.solve(each) for each in (first, second))
    return float(np.linalg.norm(one.nodes - two.nodes, axis=1).max())


def by_the_clock(robot: Robot, profile: ContractionProfile, seconds: float) -> None:
    """Play for so long by the clock of this computer, and tell what was late, lost or stopped."""
    winches, length = TenWinches(robot, profile, live=True), float(profile.times[-1])
    winches.link.watch()
    begin, told, stops, errors, before = time.monotonic(), 0, list[str](), list[float](), os.getloadavg()[0]
    late, lost, unheard = list[float](), 0, 0
    while (passed := time.monotonic() - begin) < seconds:
        due = (told + 1) * FRAME
        time.sleep(max(0.0, due - passed))
        behind = time.monotonic() - begin - due
        missed = int(behind / FRAME)
        lost, told = lost + missed, told + 1 + missed
        late += [behind] if behind > LATE else []
        try:
            winches.link.send(profile.at(told * FRAME % length), time.monotonic(), speed=0.06)
            asked = steady()
            winches.link.read(asked)
            reading = winches.link.reading
            unheard += reading is None or bool((reading.stamps < asked).any())
            errors.append(float(np.abs(winches.places - profile.at((told - 1) * FRAME % length)).max()))
        except HydrostatError as error:
            stops.append(f"at {time.monotonic() - begin:.0f} s: {error}")
            with suppress(HydrostatError):  # tried again at the next frame
                winches.link.arm()
    winches.link.close()
    told_late = f"{len(late)} begun more than {1e3 * LATE:g} ms late (latest {1e3 * max(late, default=0.0):.0f} ms)"
    middle, most = 1e3 * np.median(errors), 1e3 * np.quantile(errors, 0.99)
    print(f"{machine.machine()}; {seconds:g} s by the clock, {len(robot.winches)} winches at {1 / FRAME:g} Hz")
    print(f"load {before:.1f} at first, {os.getloadavg()[0]:.1f} at last")
    print(f"{told} frames; {lost} lost, {told_late}, {unheard} in which a motor was not heard; {len(stops)} stops")
    print(f"motors behind the frame before: {middle:.2f} mm in the middle, {most:.2f} mm at p99")
    for line in stops[:20]:
        print(line)


def main() -> None:
    """Play, measure, cut."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--clock", action="store_true", help="by the clock of this computer")
    given = parser.parse_args()
    seconds = given.seconds
    robot = load_robot(gallery_folder("cupping_hand"))
    profile = moves(robot)
    if given.clock:
        by_the_clock(robot, profile, seconds)
        return
    winches, simulation = TenWinches(robot, profile), Simulation(robot)
    frames = lost = late = 0
    held: list[tuple[np.ndarray, np.ndarray]] = []
    going: list[tuple[np.ndarray, np.ndarray]] = []
    begin, length = winches.chain.now, float(profile.times[-1])
    while (passed := winches.chain.now - begin) < seconds:
        goal = profile.at(passed % length)
        heard, took = winches.frame(goal)
        frames, lost, late = frames + 1, lost + (not heard), late + (took > FRAME)
        phase = passed % length % 2.0
        if int(passed / length) % ROUNDS == 0 and (0.44 <= phase < 0.46 or 1.2 <= phase < 1.22):
            (held if phase < 0.5 else going).append((goal, winches.places))
    errors = [1e3 * max(apart(simulation, *pair) for pair in pairs) for pairs in (held, going)]
    print(f"{machine.machine()}; {seconds:g} s of emulated time, {len(robot.winches)} winches at {1 / FRAME:g} Hz")
    print(f"{frames} frames; {lost} in which a motor was not heard, {late} longer than {1e3 * FRAME:g} ms")
    print(f"pose error: {errors[0]:.3f} mm where keys are held, {errors[1]:.3f} mm on the way, after each frame")
    fist = profile.at(2.5)
    while winches.chain.now - begin < seconds + 2.0:
        winches.frame(np.minimum(winches.places + 1e-3, fist))
    winches.cut, cut = [winch.name for winch in robot.winches].index(CUT), winches.chain.now
    try:
        while winches.chain.now - cut < 5.0:
            winches.frame(fist)
        print("the cut cable was not noticed within 5 s")
    except HydrostatError as error:
        print(f"cut cable of {CUT}: after {winches.chain.now - cut:.2f} s: {error}")


if __name__ == "__main__":
    main()
