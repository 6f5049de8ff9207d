"""`SpoolCurve.measure`: cable taken in by a spool's angle, measured by a mark on the cable and a ruler next to it."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import WinchMotor
from hydrostat.errors import HydrostatError, InputError

STOPS, MIN_STOPS = 7, 4
"""Places at which the mark is read, and how many of them must be reached."""
STANDS = 0.3
"""A winch that stands for so long [s] away from where it shall go is held by its body: that is how far it goes."""
TURN_SPEED, COMMAND_INTERVAL = 0.02, 0.02
"""Speed from one to the next [m/s]; from one command to the next [s]."""
WITHIN = 1e-3
"""Readings may lie so far beside the curve [m]: a ruler read to half a millimeter does far better."""
LIKELY = (0.7, 1.6)
"""The radius measured, over that of robot.toml: beyond, it was read in other units or the wrong spool is on."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpoolCurve:
    """Ruler measurement of one spool.

    Attributes:
        motor: motor with the fitted radius and curve.
        turned: spool angle since its zero at each reading [rad].
        readings: measured cable taken in, from the first reading on [m].
        before: cable taken in by the motor's old radius and curve [m].
    """

    motor: WinchMotor
    turned: Vector
    readings: Vector
    before: Vector

    @property
    def fitted_lengths(self) -> Vector:
        """Cable taken in by the fitted curve, at each reading [m]."""
        return _cable_length(self.motor, self.turned)

    @property
    def scatter(self) -> float:
        """Root-mean-square distance of the readings from the curve [m]."""
        beside = self.readings - self.fitted_lengths
        return float(np.sqrt(np.mean((beside - beside.mean()) ** 2)))

    @property
    def more(self) -> float:
        """Largest excess of the measured over the assumed cable length, from the first reading [m]."""
        apart = (self.fitted_lengths - self.fitted_lengths[0]) - (self.before - self.before[0])
        return float(apart[np.abs(apart).argmax()])

    @staticmethod
    def fit(motor: WinchMotor, turned: Vector, readings: Vector) -> "SpoolCurve":
        """Fit a curve to ruler readings [m] at spool angles since the zero [rad].

        The ruler may have any origin and direction. Cable on cable lies further out, never further in, so the curve is
        piecewise linear between the angles, and no piece is less steep than the one before (non-negative least
        squares).

        Raises:
            HydrostatError: readings that fit no such curve, or one far from the spool's radius.
        """
        from scipy.optimize import nnls

        taken = (readings - readings[0]) * np.sign(readings[-1] - readings[0])
        begins = turned[1:-1]
        table = np.stack([np.ones_like(turned), -np.ones_like(turned), turned], axis=1)
        table = np.hstack([table, np.maximum(turned[:, None] - begins, 0.0)])
        found = motor.radius * nnls(table, taken / motor.radius)[0]
        steps, radius = found[3:], float(found[2])
        if not LIKELY[0] <= radius / motor.radius <= LIKELY[1]:
            raise HydrostatError(
                f"{motor.winch}: by the ruler its spool has a radius of {1e3 * radius:.1f} mm, not of "
                f"{1e3 * motor.radius:.1f} mm; write millimeters, and look that the mark is on the cable of this winch"
            )
        angles = [float(begin) for begin, step in zip(begins, steps, strict=True) if step > 1e-9 and begin > 0]
        angles.append(float(turned[-1]))
        lengths = [radius * angle + float(steps @ np.maximum(angle - begins, 0.0)) for angle in angles]
        try:
            fitted = replace(motor, radius=radius, curve=tuple(zip(angles, lengths, strict=True)))
        except InputError as error:
            raise HydrostatError(f"readings of {error}; read them again") from None
        curve = SpoolCurve(
            motor=fitted, turned=turned, readings=taken + (found[1] - found[0]), before=_cable_length(motor, turned)
        )
        beside = np.abs(curve.readings - curve.fitted_lengths)
        if (worst := float(beside.max())) > WITHIN:
            raise HydrostatError(
                f"{motor.winch}: reading {int(beside.argmax()) + 1} of {len(turned)} is "
                f"{1e3 * worst:.1f} mm beside every "
                "curve that a spool can have; begin this winch again"
            )
        return curve

    @staticmethod
    def measure(
        link: BusLink,
        motor: WinchMotor,
        place: int,
        most: float,
        read: Callable[[float], float],
        *,
        clock: Callable[[], float] = time.monotonic,
        wait: Callable[[float], None] = time.sleep,
    ) -> "SpoolCurve":
        """Take in cable step by step and ask for the ruler reading at each step; then return to the zero.

        Motors measure force, not cable length, so a person reads the ruler. During a reading motors hold without
        commands; each step arms them again.

        Args:
            link: link to all motors, identified and calibrated.
            motor: calibrated motor of this winch.
            place: index of the winch among the motors.
            most: largest cable length to take in [m], within the winch's travel.
            read: function that takes the expected cable length [m] and returns the ruler reading [m].
            clock: monotonic clock [s].
            wait: function that sleeps for a duration [s].

        Raises:
            HydrostatError: an error of the link, a body so stiff that the motor takes in too little, or readings that
                fit no curve.
        """
        turned, readings, taken = list[float](), list[float](), 0.0
        try:
            for goal in np.linspace(0.0, most, STOPS).tolist():
                there = _go(link, place, goal, clock, wait)
                taken = float(link.read(clock())[place])
                assert link.reading is not None
                turned.append(motor.turns * (float(link.reading.angles[place]) - (motor.zero or 0.0)))
                readings.append(read(taken))
                if not there:
                    break
            _go(link, place, 0.0, clock, wait)
        finally:
            link.stop()
        if len(turned) < MIN_STOPS:
            raise HydrostatError(
                f"{motor.winch}: its motor stood after {1e3 * taken:.0f} of {1e3 * most:.0f} mm; let its cable "
                f"off the body, or allow more than {motor.current:g} A in motors.toml, and begin again"
            )
        return SpoolCurve.fit(motor, np.array(turned), np.array(readings))


def _cable_length(motor: WinchMotor, turned: Vector) -> Vector:
    """Cable taken in at angles since the zero [m]."""
    origin = replace(motor, zero=0.0, turns=1)
    return np.array([origin.contraction(angle) for angle in turned.tolist()])


def _go(link: BusLink, place: int, goal: float, clock: Callable[[], float], wait: Callable[[float], None]) -> bool:
    """Arm all, let one winch take so much in while the others stand, and stop them; whether it came there."""
    link.arm()
    goals = link.read(clock())
    now, since = float(goals[place]), clock()
    goals[place], mark = goal, now
    while clock() - since < STANDS:
        link.send(goals, clock(), speed=TURN_SPEED)
        wait(COMMAND_INTERVAL)
        now = float(link.read(clock())[place])
        if abs(now - mark) > 1e-4:
            mark, since = now, clock()
    link.stop()
    return abs(now - goal) < 1e-3
