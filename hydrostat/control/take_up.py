"""`find_cable_zeros`: where the cables of each winch go taut, detected by its motor's current at a low limit."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, Reading
from hydrostat.control.calibration import WinchMotor
from hydrostat.control.model_tensions import WinchPull
from hydrostat.control.restart_motors import fault_words
from hydrostat.errors import HydrostatError


@dataclass(frozen=True, kw_only=True)
class TakeUpRules:
    """Currents, lengths and times of the search for slack.

    Attributes:
        max_current: maximum current while slack is taken up [A].
        touch_current: excess over the current of a free motor at which a cable begins to pull [A].
        pull_current: excess at which it pulls enough [A].
        max_depth: cable taken in since a measurement began at which a soft body is pulled enough [m].
        search_speed: speed of the search [m/s].
        step: step of a measurement [m].
        back: distance before the place where nothing is felt at which a measurement begins [m].
        before: distance before the edge of the last measurement at which the next begins at least [m].
        first_release: cable let out at first [m].
        interval: time between two commands [s].
        num_readings: readings of a standing motor at each step.
        many_readings: readings at each step where an edge is coarse.
        coarse: standard error of one measurement above which it is repeated with many readings [m].
        num_passes: minimum number of measurements of each edge.
        max_passes: maximum number of them, where the motor's current is noisy or coarse.
        precision: standard error of an edge at which measurements end [m].
        max_difference: difference of the measurements of an edge that is always allowed [m].
        max_deviations: allowed change between earlier and later measurements, in its standard deviations.
        max_lag: distance behind its goal at which a motor without load does not follow [m].
        silence: silence after which motors are armed again where they stand [s].
        max_rearmed: maximum number of these times.
        max_age: age at which a reading is an error [s].
    """

    max_current: float = 0.12
    touch_current: float = 0.012
    pull_current: float = 0.05
    max_depth: float = 0.012
    search_speed: float = 0.03
    step: float = 5e-4
    back: float = 2e-3
    before: float = 4e-3
    first_release: float = 2e-3
    interval: float = 0.012
    num_readings: int = 3
    many_readings: int = 16
    coarse: float = 1.5e-4
    num_passes: int = 2
    max_passes: int = 12
    precision: float = 6e-5
    max_difference: float = 8e-4
    max_deviations: float = 4.5
    max_lag: float = 4e-3
    silence: float = 0.08
    max_rearmed: int = 20
    max_age: float = 0.2


RULES = TakeUpRules()


@dataclass(frozen=True, kw_only=True, eq=False)
class SlackCalibration:
    """Calibrated slack and zero of one winch.

    Attributes:
        motor: motor with its zero.
        slack: cable taken up from the start position of the motor [m]; below 0 if paid out.
        apart: spread of its measurements [m].
        gain: ratio of motor current to simulated pull [A/N].
        places: cable taken in beyond the edge at each step of the last measurement [m].
        currents: motor current at these steps [A].
        floor: current of the motor while its cable is slack [A].
        seconds: duration [s].
    """

    motor: WinchMotor
    slack: float
    apart: float
    gain: float
    places: Vector
    currents: Vector
    floor: float
    seconds: float

    @property
    def reeled_length(self) -> float:
        """Cable length that the winch took in beyond the edge, where its cable goes taut [m]."""
        return max(float(self.places.max()), 1e-3)


def find_cable_zeros(
    bus: Bus,
    motors: Sequence[WinchMotor],
    model: Sequence[WinchPull],
    found: Callable[[SlackCalibration], None],
    *,
    most: float = 0.04,
    clock: Callable[[], float] | None = None,
    wait: Callable[[float], None] = time.sleep,
) -> tuple[SlackCalibration, ...]:
    """Find the zeros of all motors one by one, while the others hold; at the end all motors are at their zeros.

    Args:
        bus: bus with identified motors.
        motors: motors of the winches, in the order of the bus.
        model: simulated tension of each winch, for its onset and its slope; the scale is measured.
        found: callback for each calibrated winch.
        most: largest cable length to take up or pay out [m].
        clock: monotonic clock [s]; that of the bus if left out.
        wait: function that sleeps for a duration [s].

    Raises:
        HydrostatError: a cable that never pulls, or always; measurements that differ; a motor that is silent or
            reports a fault. The motors hold.
    """
    taker = _Taker(bus, motors, most, clock or bus.clock, wait)
    try:
        taker.begin()
        done = []
        for index in range(len(motors)):
            done.append(taker.take_up(index, model[index]))
            found(done[-1])
        return tuple(done)
    finally:
        bus.stop()


def find_edge(places: Vector, currents: Vector, model: WinchPull) -> tuple[float, float, float]:
    """Fit a current that is constant up to an edge and rises from it on as the pull of a model does, by a factor.

    Returns the edge [m], the factor [A/N] and the constant [A].
    """
    best = (np.inf, 0.0, 0.0, 0.0)
    low, high = float(places.min()), float(places.max())
    for _ in range(3):
        grid = np.linspace(low, high, 81)
        for edge in grid.tolist():
            ramp = model.at(model.taut + np.maximum(places - edge, 0.0))
            table = np.stack([np.ones_like(ramp), ramp], axis=1)
            answer, *_ = np.linalg.lstsq(table, currents, rcond=None)
            error = float(np.sum((table @ answer - currents) ** 2))
            if answer[1] > 0 and error < best[0]:
                best = (error, edge, float(answer[1]), float(answer[0]))
        step = grid[1] - grid[0]
        low, high = best[1] - step, best[1] + step
    return best[1:]


def find_change(edges: Vector) -> float:
    """Largest change of the mean from earlier measurements to later ones, in units of its deviation for deviation 1."""
    count = len(edges)
    return max(
        float(abs(edges[:k].mean() - edges[k:].mean()) / np.sqrt(1 / k + 1 / (count - k))) for k in range(1, count)
    )


def _edge_deviation(
    places: Vector, currents: Vector, model: WinchPull, edge: float, gain: float, floor: float
) -> float:
    """Standard deviation of the edge of one fit by what its currents leave [m].

    Near its edge a ramp is taken for straight: the floor has the variance s^2 / n, the ramp extended back to its begin
    4 s^2 / n.
    """
    depth = max(float(places.max()) - edge, 1e-4)
    slope = gain * model.stiffness(depth)
    left = currents - floor - gain * model.at(model.taut + np.maximum(places - edge, 0.0))
    taut = int(np.sum(places > edge))
    spread = np.sqrt(1 / max(len(places) - taut, 1) + 4 / max(taut, 1))
    return max(float(left.std() * spread / slope), 1e-6)


class _Taker:
    """Motors on a bus while their slack is taken up; places are cable taken in from where each stood at first [m]."""

    def __init__(
        self,
        bus: Bus,
        motors: Sequence[WinchMotor],
        most: float,
        clock: Callable[[], float],
        wait: Callable[[float], None],
    ) -> None:
        self._bus, self._motors, self._most, self._clock, self._wait = bus, tuple(motors), most, clock, wait
        self._goals, self._told, self._again = np.zeros(len(motors)), np.inf, RULES.max_rearmed

    def begin(self) -> None:
        """Note where they stand, and arm them."""
        self._arm()
        angles = self._read_fresh().angles
        self._from = tuple(
            replace(motor, zero=float(angle)) for motor, angle in zip(self._motors, angles.tolist(), strict=True)
        )

    def take_up(self, index: int, model: WinchPull) -> SlackCalibration:
        """Find the zero of a winch; its motor then stands there."""
        began = self._clock()
        floor = self._free(index)
        self._search(index, floor)
        edges, weights, all_places, all_currents = list[float](), list[float](), list[Vector](), list[Vector]()
        edge, places, currents, readings = np.inf, np.zeros(0), np.zeros(0), RULES.num_readings
        while len(edges) < RULES.num_passes or (sum(weights) < RULES.precision**-2 and len(edges) < RULES.max_passes):
            self._let_out(index, floor)  # a soft cable is not felt at first: there, too, the floor is measured
            self._go(index, min(self._goals[index], edge - RULES.before), RULES.search_speed)
            places, currents = self._measure(index, floor, readings)
            edge, gain, level = find_edge(places, currents, model)
            if gain <= 0:
                raise HydrostatError(
                    f"{self._name(index)}: current does not rise with the pull of the model. Check the motor, its "
                    "cable and this winch in robot.toml"
                )
            deviation = _edge_deviation(places, currents, model, edge, gain, level)
            if readings < RULES.many_readings and deviation > RULES.coarse:
                readings = RULES.many_readings  # this measurement was only a look
                continue
            edges.append(edge)
            all_places.append(places)
            all_currents.append(currents)
            weights.append(deviation**-2)
        apart = max(edges) - min(edges)
        edge, gain, level = find_edge(np.concatenate(all_places), np.concatenate(all_currents), model)
        change = find_change(np.array(edges)) / float(np.median(weights)) ** -0.5
        if apart > RULES.max_difference and change > RULES.max_deviations:
            raise HydrostatError(
                f"{self._name(index)}: its cable begins to pull {1e3 * apart:.1f} mm apart in two measurements; "
                "see that it runs freely and that its spool is fast on its motor, then begin again"
            )
        origin = self._from[index]
        place = replace(origin, zero=0.0, turns=1)
        turned = place.angle(edge) - place.angle(model.taut)
        self._go(index, edge - model.taut, RULES.search_speed)
        return SlackCalibration(
            motor=replace(origin, zero=float((origin.zero or 0.0) + origin.turns * turned)),
            slack=edge,
            apart=apart,
            gain=gain,
            places=places - edge,
            currents=currents,
            floor=level,
            seconds=self._clock() - began,
        )

    def _free(self, index: int) -> float:
        """Let cable out until the motor feels nothing more; returns what it draws then [A]."""
        before = self._currents(index, 2 * RULES.num_readings)
        while self._goals[index] > -self._most:
            self._go(index, self._goals[index] - RULES.first_release, RULES.search_speed)
            now = self._currents(index, 2 * RULES.num_readings)
            if abs(before.mean() - now.mean()) < RULES.touch_current / 4:
                return float(now.mean())
            before = now
        raise HydrostatError(
            f"{self._name(index)}: still pulls after {1e3 * self._most:.0f} mm were let out; "
            f"its motor may turn the other way (turns = {-self._motors[index].turns}), or its cable is jammed"
        )

    def _search(self, index: int, floor: float) -> None:
        """Take cable in until it is felt."""
        felt = 0
        while felt < RULES.num_readings:
            if self._goals[index] > self._most:
                raise HydrostatError(
                    f"{self._name(index)}: no pull is felt after {1e3 * self._most:.0f} mm were taken in; its cable is "
                    "broken, off its spool or loose at its stopper (pull the line straight there and fix it again), or "
                    f"its motor turns the other way (turns = {-self._motors[index].turns})"
                )
            current = self._turn(index, self._goals[index] + RULES.search_speed * RULES.interval)
            if current < floor + RULES.touch_current:
                self._follows(index)
            felt = felt + 1 if current > floor + RULES.touch_current else 0

    def _let_out(self, index: int, floor: float) -> None:
        """Let out until nothing is felt, and a little more."""
        while self._currents(index, RULES.num_readings).mean() > floor + RULES.touch_current / 6:
            if self._goals[index] < -self._most:
                raise HydrostatError(f"{self._name(index)}: still pulls when its cable is let out; is it jammed?")
            self._go(index, self._goals[index] - 1e-3, RULES.search_speed)
            self._follows(index)
        self._go(index, self._goals[index] - RULES.back, RULES.search_speed)

    def _measure(self, index: int, floor: float, readings: int) -> tuple[Vector, Vector]:
        """Take cable in step by step until the motor pulls enough; the place and the current of each reading."""
        places, currents, begin = [], [], self._goals[index]
        while self._goals[index] < begin + self._most:
            self._turn(index, self._goals[index] + RULES.step)
            for _ in range(readings):
                currents.append(self._turn(index, self._goals[index]))
                places.append(self._place(index))
            felt = float(np.mean(currents[-readings:])) - floor
            deep = felt > RULES.touch_current and self._goals[index] > begin + RULES.max_depth
            if felt > RULES.pull_current or deep or places[-1] < self._goals[index] - 2 * RULES.step:
                return np.array(places), np.array(currents)
        raise HydrostatError(f"{self._name(index)}: what its cable pulls at is too soft to be felt, or it slips")

    def _arm(self) -> None:
        """Let them turn, at low current (HydrostatError: this was needed too often)."""
        self._again -= 1
        if self._again < 0:
            raise HydrostatError(
                "this computer is too busy: the motors were told nothing for too long, again and again"
            )
        self._bus.arm(np.array([min(motor.current, RULES.max_current) for motor in self._motors]))
        self._told = np.inf

    def _follows(self, index: int) -> None:
        """Raise that a motor is far from its goal though no cable holds it."""
        if abs(self._goals[index] - self._place(index)) > RULES.max_lag:
            raise HydrostatError(f"{self._name(index)}: its motor does not follow; it is stuck or has lost its power")

    def _go(self, index: int, goal: float, speed: float) -> None:
        """Move a motor there, in small steps, and let it come to rest."""
        while abs(step := goal - self._goals[index]) > 1e-9:
            most = speed * RULES.interval
            self._turn(index, self._goals[index] + float(np.clip(step, -most, most)))
        self._turn(index, goal)

    def _turn(self, index: int, goal: float) -> float:
        """Tell all motors their goals, wait a turn, and give the current of one [A]."""
        if self._clock() - self._told > RULES.silence:  # this computer was busy: their own watchdogs have stopped them
            self._arm()
            self._goals = np.array(
                [
                    motor.contraction(angle)
                    for motor, angle in zip(self._from, self._read_fresh().angles.tolist(), strict=True)
                ]
            )
            goal = float(self._goals[index])
        self._goals[index] = goal
        angles = np.array([motor.angle(place) for motor, place in zip(self._from, self._goals.tolist(), strict=True)])
        radii = np.array([motor.reach(place) for motor, place in zip(self._from, self._goals.tolist(), strict=True)])
        self._told = self._clock()  # before: this computer may be held up on the way
        self._bus.write(angles, 2 * RULES.search_speed / radii)
        self._wait(RULES.interval)
        reading = self._read_fresh()
        self._last = float(reading.angles[index])
        current = float(reading.currents[index]) * self._motors[index].turns
        if not np.isfinite(current):
            raise HydrostatError(f"{self._name(index)}: its motor does not tell its current; it cannot feel a cable")
        return current

    def _currents(self, index: int, count: int) -> Vector:
        return np.array([self._turn(index, self._goals[index]) for _ in range(count)])

    def _place(self, index: int) -> float:
        return self._from[index].contraction(self._last)

    def _read_fresh(self) -> Reading:
        """A reading that is fresh and without fault (HydrostatError: whose is not)."""
        reading, now = self._bus.read(), self._clock()
        for index, (stamp, fault) in enumerate(zip(reading.stamps.tolist(), reading.faults, strict=True)):
            if fault:
                raise HydrostatError(fault_words(self._name(index), reading, index))
            if now - stamp > RULES.max_age:
                raise HydrostatError(f"the motor of {self._name(index)} does not answer; look at its power and cable")
        return reading

    def _name(self, index: int) -> str:
        return self._motors[index].winch
