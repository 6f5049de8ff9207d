"""`take_up_slack`: where the cables of each winch begin to pull, felt by the current of its motor at low current."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, Reading, steady
from hydrostat.control.calibration import WinchMotor
from hydrostat.control.model_tensions import WinchPull
from hydrostat.errors import HydrostatError

GENTLE = 0.12
"""Motors may draw so much while slack is taken up, at most [A]."""
FELT, PULLED = 0.012, 0.05
"""A cable is felt, and pulled at enough, where its motor draws so much more than while it runs free [A]."""
DEEP = 0.012
"""A soft body is pulled at enough when so much cable was taken in since a measurement began [m]."""
SEARCH, FINE, BACK, LEAST = 0.03, 5e-4, 2e-3, 2e-3
"""Speed of search [m/s]; step of a measurement; how far before the edge it begins; cable let out at first [m]."""
TURN = 0.012
"""From one command to the next [s]."""
STABLE, PASSES = 3, 2
"""Readings of a motor that stands at each step; measurements of each edge."""
APART = 8e-4
"""Two measurements of an edge may differ by so much [m]."""
LAG = 4e-3
"""A motor this far behind its goal that feels nothing does not follow [m]."""
LATE, AGAIN = 0.08, 20
"""Motors that were told nothing for so long [s] are armed again where they stand, at most so many times."""
OLD = 0.2
"""A reading so old is an error [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlackCalibration:
    """Calibrated slack and zero of one winch.

    Attributes:
        motor: with its zero.
        slack: cable that was taken up from where the motor stood [m]; below 0: it was let out.
        apart: spread of its measurements [m].
        gain: current by what the model pulls with [A/N].
        places: cable taken in from the edge at each step of the last measurement [m].
        currents: there [A].
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


def take_up_slack(
    bus: Bus,
    motors: Sequence[WinchMotor],
    model: Sequence[WinchPull],
    found: Callable[[SlackCalibration], None],
    *,
    most: float = 0.04,
    clock: Callable[[], float] = steady,
    wait: Callable[[float], None] = time.sleep,
) -> tuple[SlackCalibration, ...]:
    """Find the zeros of all motors, one after the other, while the others stand; all stand at their zeros at the end.

    Args:
        bus: bus with identified motors.
        motors: motors of the winches, in the order of the bus.
        model: simulated tension of each winch: its onset and its rise; its scale is measured.
        found: told of each winch as soon as it is known.
        most: cable that may be taken up or let out at most [m].
        clock: monotonic clock [s].
        wait: lets so much time pass [s].

    Raises:
        HydrostatError: a cable is not felt, or always; measurements differ; a motor is silent or reports a fault. The
            motors stand.
    """
    taker = _Taker(bus, motors, most, clock, wait)
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
        self._goals, self._told, self._again = np.zeros(len(motors)), np.inf, AGAIN

    def begin(self) -> None:
        """Note where they stand, and arm them."""
        self._arm()
        angles = self._heard().angles
        self._from = tuple(
            replace(motor, zero=float(angle)) for motor, angle in zip(self._motors, angles.tolist(), strict=True)
        )

    def take_up(self, index: int, model: WinchPull) -> SlackCalibration:
        """Find the zero of a winch; its motor then stands there."""
        began = self._clock()
        floor = self._free(index)
        self._search(index, floor)
        edges, gains, places, currents, level = [], [], np.zeros(0), np.zeros(0), floor
        for _ in range(PASSES):
            self._let_out(index, floor)
            places, currents = self._measure(index, floor)
            edge, gain, level = find_edge(places, currents, model)
            edges.append(edge)
            gains.append(gain)
        apart, edge = max(edges) - min(edges), float(np.mean(edges))
        if apart > APART:
            raise HydrostatError(
                f"{self._name(index)}: its cable begins to pull {1e3 * apart:.1f} mm apart in two measurements; "
                "see that it runs freely and that its spool is fast on its motor, then begin again"
            )
        origin = self._from[index]
        place = replace(origin, zero=0.0, turns=1)
        turned = place.angle(edge) - place.angle(model.taut)
        self._go(index, edge - model.taut, SEARCH)
        return SlackCalibration(
            motor=replace(origin, zero=float((origin.zero or 0.0) + origin.turns * turned)),
            slack=edge,
            apart=apart,
            gain=float(np.mean(gains)),
            places=places - edge,
            currents=currents,
            floor=level,
            seconds=self._clock() - began,
        )

    def _free(self, index: int) -> float:
        """Let cable out until the motor feels nothing more; returns what it draws then [A]."""
        before = self._currents(index, 2 * STABLE)
        while self._goals[index] > -self._most:
            self._go(index, self._goals[index] - LEAST, SEARCH)
            now = self._currents(index, 2 * STABLE)
            if abs(before.mean() - now.mean()) < FELT / 4:
                return float(now.mean())
            before = now
        raise HydrostatError(
            f"{self._name(index)}: still pulls after {1e3 * self._most:.0f} mm were let out; "
            f"its motor may turn the other way (turns = {-self._motors[index].turns}), or its cable is jammed"
        )

    def _search(self, index: int, floor: float) -> None:
        """Take cable in until it is felt."""
        felt = 0
        while felt < STABLE:
            if self._goals[index] > self._most:
                raise HydrostatError(
                    f"{self._name(index)}: no pull is felt after {1e3 * self._most:.0f} mm were taken in; its cable is "
                    f"broken, off its spool, or its motor turns the other way (turns = {-self._motors[index].turns})"
                )
            current = self._turn(index, self._goals[index] + SEARCH * TURN)
            if current < floor + FELT:
                self._follows(index)
            felt = felt + 1 if current > floor + FELT else 0

    def _let_out(self, index: int, floor: float) -> None:
        """Let out until nothing is felt, and a little more."""
        while self._currents(index, STABLE).mean() > floor + FELT / 6:
            if self._goals[index] < -self._most:
                raise HydrostatError(f"{self._name(index)}: still pulls when its cable is let out; is it jammed?")
            self._go(index, self._goals[index] - 1e-3, SEARCH)
            self._follows(index)
        self._go(index, self._goals[index] - BACK, SEARCH)

    def _measure(self, index: int, floor: float) -> tuple[Vector, Vector]:
        """Take cable in step by step until the motor pulls enough; the place and the current of each reading."""
        places, currents, begin = [], [], self._goals[index]
        while self._goals[index] < begin + self._most:
            self._turn(index, self._goals[index] + FINE)
            for _ in range(STABLE):
                currents.append(self._turn(index, self._goals[index]))
                places.append(self._place(index))
            felt = float(np.mean(currents[-STABLE:])) - floor
            deep = felt > FELT and self._goals[index] > begin + DEEP
            if felt > PULLED or deep or places[-1] < self._goals[index] - 2 * FINE:
                return np.array(places), np.array(currents)
        raise HydrostatError(f"{self._name(index)}: what its cable pulls at is too soft to be felt, or it slips")

    def _arm(self) -> None:
        """Let them turn, at low current (HydrostatError: this was needed too often)."""
        self._again -= 1
        if self._again < 0:
            raise HydrostatError(
                "this computer is too busy: the motors were told nothing for too long, again and again"
            )
        self._bus.arm(np.array([min(motor.current, GENTLE) for motor in self._motors]))
        self._told = np.inf

    def _follows(self, index: int) -> None:
        """Raise that a motor is far from its goal though no cable holds it."""
        if abs(self._goals[index] - self._place(index)) > LAG:
            raise HydrostatError(f"{self._name(index)}: its motor does not follow; it is stuck or has lost its power")

    def _go(self, index: int, goal: float, speed: float) -> None:
        """Move a motor there, in small steps, and let it come to rest."""
        while abs(step := goal - self._goals[index]) > 1e-9:
            self._turn(index, self._goals[index] + float(np.clip(step, -speed * TURN, speed * TURN)))
        self._turn(index, goal)

    def _turn(self, index: int, goal: float) -> float:
        """Tell all motors their goals, wait a turn, and give the current of one [A]."""
        if self._clock() - self._told > LATE:  # this computer was busy, and their own watchdogs have stopped them
            self._arm()
            self._goals = np.array(
                [
                    motor.contraction(angle)
                    for motor, angle in zip(self._from, self._heard().angles.tolist(), strict=True)
                ]
            )
            goal = float(self._goals[index])
        self._goals[index] = goal
        angles = np.array([motor.angle(place) for motor, place in zip(self._from, self._goals.tolist(), strict=True)])
        radii = np.array([motor.reach(place) for motor, place in zip(self._from, self._goals.tolist(), strict=True)])
        self._bus.write(angles, 2 * SEARCH / radii)
        self._told = self._clock()
        self._wait(TURN)
        reading = self._heard()
        self._last = float(reading.angles[index])
        current = float(reading.currents[index]) * self._motors[index].turns
        if not np.isfinite(current):
            raise HydrostatError(f"{self._name(index)}: its motor does not tell its current; it cannot feel a cable")
        return current

    def _currents(self, index: int, count: int) -> Vector:
        return np.array([self._turn(index, self._goals[index]) for _ in range(count)])

    def _place(self, index: int) -> float:
        return self._from[index].contraction(self._last)

    def _heard(self) -> Reading:
        """A reading that is fresh and without fault (HydrostatError: whose is not)."""
        reading, now = self._bus.read(), self._clock()
        for index, (stamp, fault) in enumerate(zip(reading.stamps.tolist(), reading.faults, strict=True)):
            if fault:
                raise HydrostatError(f"the motor of {self._name(index)} reports: {fault}")
            if now - stamp > OLD:
                raise HydrostatError(f"the motor of {self._name(index)} does not answer; look at its power and cable")
        return reading

    def _name(self, index: int) -> str:
        return self._motors[index].winch
