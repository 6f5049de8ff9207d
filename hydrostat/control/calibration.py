"""`Calibration`: the motor of each winch, and the map from its angle to contraction; stored as motors.toml."""

import json
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat import units
from hydrostat.arrays import Vector
from hydrostat.control.motors import LEVER, DriveAxis
from hydrostat.control.scs_bus import KIT_STEP, SCS_STEPS, SCS_TICK
from hydrostat.errors import InputError
from hydrostat.fabrication import Motor
from hydrostat.files import read_stranger, replace_file
from hydrostat.robot import PinDrive, Robot
from hydrostat.units import quote

CALIBRATION = "motors.toml"
EMULATED_CALIBRATION = "motors_emulated.toml"
"""Calibration file of emulated motors, separate so that a trial run cannot replace measurements of real motors."""


@dataclass(frozen=True, kw_only=True)
class WinchMotor:
    """Motor of a winch, with its spool.

    Attributes:
        winch: winch name.
        number: motor number on its bus.
        zero: angle at zero contraction [rad]; None before calibration.
        turns: 1 if rising angles take cable in, -1 if they pay it out.
        radius: spool radius at the zero [m].
        curve: measured points of spool angle since the zero [rad] and cable taken in [m], rising, because cable winds
            in layers; linear between and beyond. Empty to use the radius alone.
        current: maximum motor current [A].
        counts: encoder counts per spool turn; only for motors on a board with our firmware.
        board: number of its board or serial line, from 1, if there are several.
        model: key of the motor, chosen by `hydrostat firmware`; None for that of the robot or of its design.
    """

    winch: str
    number: int
    zero: float | None = None
    turns: int = 1
    radius: float
    curve: tuple[tuple[float, float], ...] = ()
    current: float = 0.4
    counts: float | None = None
    board: int = 1
    model: str | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.number <= 252:
            raise InputError(f"{self.winch}: a motor has a number from 0 to 252, not {self.number}")
        if not 1 <= self.board <= 16:
            raise InputError(f"{self.winch}: boards are counted from 1 to 16, not {self.board}")
        if self.model is not None:
            Motor.choose(self.model)
        if self.turns not in (1, -1):
            raise InputError(f"{self.winch}: turns must be 1 or -1, not {self.turns}")
        for name, value, most in (("radius", self.radius, 0.5), ("current", self.current, 30.0)):
            if not 0 < value <= most:
                raise InputError(f"{self.winch}: {name} must be above 0 and at most {most:g}, not {value:g}")
        if self.counts is not None and not 1 <= self.counts <= 1e6:
            raise InputError(f"{self.winch}: counts must be from 1 to a million, not {self.counts:g}")
        points = np.array([(0.0, 0.0), *self.curve])
        if points.shape[1:] != (2,) or not (np.isfinite(points).all() and (np.diff(points, axis=0) > 0).all()):
            raise InputError(
                f"{self.winch}: curve must be pairs of an angle [rad] and the cable taken in [m], both rising from 0"
            )
        if not all(radius <= 0.5 for _, _, radius in self._pieces):
            raise InputError(f"{self.winch}: curve rises by more than 0.5 m a radian")

    def contraction(self, angle: float) -> float:
        """Return the cable taken in at an angle of the motor [m]; NaN before calibration."""
        turned = self.turns * (angle - (np.nan if self.zero is None else self.zero))
        begin, taken, radius = next((piece for piece in self._pieces if turned > piece[0]), (0.0, 0.0, self.radius))
        return taken + radius * (turned - begin)

    def angle(self, contraction: float) -> float:
        """Return the angle of the motor at a contraction [rad]."""
        begin, taken, radius = self._piece(contraction)
        return (np.nan if self.zero is None else self.zero) + self.turns * (begin + (contraction - taken) / radius)

    def reach(self, contraction: float) -> float:
        """Return the winding radius at a contraction [m]."""
        return self._piece(contraction)[2]

    def _piece(self, contraction: float) -> tuple[float, float, float]:
        return next((piece for piece in self._pieces if contraction > piece[1]), (0.0, 0.0, self.radius))

    @cached_property
    def _pieces(self) -> tuple[tuple[float, float, float], ...]:
        """Start of each straight piece of the curve [rad], [m], and its radius [m]; the last piece first."""
        points = ((0.0, 0.0), *self.curve)
        return tuple((*one, (two[1] - one[1]) / (two[0] - one[0])) for one, two in pairwise(points))[::-1]


@dataclass(frozen=True)
class Calibration:
    """Calibrated motors, in the order of the winches of a robot."""

    motors: tuple[WinchMotor, ...]

    def assume_zeros(self, robot: Robot) -> "Calibration":
        """Return a copy in which motors without a known zero count from 0, for emulated motors.

        A servo with less than one turn (`motor` of the robot) starts as kits mount it: with all cable paid out,
        `KIT_STEP` steps from its end.
        """
        payouts = {winch.name: winch.release for winch in robot.winches}
        limited = robot.motor != "auto" and Motor.choose(robot.motor).turns < 1
        motors = []
        for each in self.motors:
            begin = 0.0
            if limited:
                end = KIT_STEP if each.turns > 0 else SCS_STEPS - KIT_STEP
                begin = end * SCS_TICK + each.turns * payouts[each.winch] / each.radius
            motors.append(replace(each, zero=begin if each.zero is None else each.zero))
        return Calibration(tuple(motors))

    @property
    def model(self) -> str | None:
        """Key of the motor model, the same for all; None if models differ or one is unknown."""
        models = {motor.model for motor in self.motors}
        return models.pop() if len(models) == 1 else None

    @property
    def boards(self) -> int:
        """Number of boards or serial lines of the motors."""
        return max(motor.board for motor in self.motors)

    @property
    def labels(self) -> tuple[str, ...]:
        """Winch names for messages, with the board if there are several."""
        several = self.boards > 1
        return tuple(f"{motor.winch} (board {motor.board})" if several else motor.winch for motor in self.motors)

    def places(self, board: int) -> list[int]:
        """Return the indices of the motors on a board, in winch order."""
        return [place for place, motor in enumerate(self.motors) if motor.board == board]

    @property
    def is_complete(self) -> bool:
        """True if the zeros of all motors are known."""
        return all(spool.zero is not None for spool in self.motors)

    def check(self, robot: Robot, *, file: Path = Path(CALIBRATION)) -> None:
        """Check the winches against a robot (InputError: other or missing winches, a duplicate number, or drives).

        Args:
            robot: robot with the winches.
            file: file that error messages name.
        """
        PinDrive.require_none(robot.drives, "motors")
        wanted, given = [winch.name for winch in robot.winches], [spool.winch for spool in self.motors]
        for name in wanted:
            if name not in given:
                raise InputError(f'{file}: winch "{name}" has no motor; add [[motor]] with winch = "{name}"')
        for name in given:
            if name not in wanted:
                raise InputError(f"{file}: unknown winch {quote(name)}. Available: {', '.join(wanted)}.")
        numbers = [(spool.board, spool.number) for spool in self.motors]
        if len(set(numbers)) < len(numbers) or len(set(given)) < len(given):
            raise InputError(f"{file}: each winch has one motor, and each motor a number of its own on its board")
        if missing := set(range(1, self.boards + 1)) - {spool.board for spool in self.motors}:
            raise InputError(f"{file}: boards are counted 1, 2, ...; none of the motors is on board {min(missing)}")

    def contractions(self, angles: Vector) -> Vector:
        """Return the cable taken in by each winch [m]."""
        return np.array([spool.contraction(angle) for spool, angle in zip(self.motors, angles.tolist(), strict=True)])

    def angles(self, contractions: Vector) -> Vector:
        """Return the angle of each motor [rad], in its own count."""
        return np.array([spool.angle(taken) for spool, taken in zip(self.motors, contractions.tolist(), strict=True)])

    def radii(self, contractions: Vector) -> Vector:
        """Return the winding radius of each cable [m]."""
        return np.array([spool.reach(taken) for spool, taken in zip(self.motors, contractions.tolist(), strict=True)])

    @staticmethod
    def read(folder: Path, robot: Robot, *, name: str = CALIBRATION) -> "Calibration":
        """Read the motors of a robot folder (InputError: no such file, or an invalid one; names the line)."""
        import tomllib

        file = folder / name
        if not file.exists():
            raise InputError(f"{folder} has no {name}; `hydrostat calibrate` makes it")
        try:
            table = tomllib.loads(read_stranger(file, most=_MAX_BYTES).decode())
        except UnicodeDecodeError:
            raise InputError(f"{file}: not UTF-8 text; save the file again as UTF-8") from None
        except tomllib.TOMLDecodeError as error:
            raise InputError(f"{file}: {error}") from None
        except RecursionError:
            raise InputError(f"{file}: brackets are nested too deep") from None
        entries = table.get("motor")
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise InputError(f"{file}: needs a [[motor]] for each winch")
        motors = [_spool(entry, file) for entry in entries]
        by_name = {spool.winch: spool for spool in motors}
        for winch in by_name:
            if sum(spool.winch == winch for spool in motors) > 1:
                raise InputError(f'{file}: winch "{winch}" has more than one [[motor]]; keep one')
        found = Calibration(tuple(by_name.values()))
        found.check(robot, file=file)
        for axis in robot.winches:
            if isinstance(axis, DriveAxis) and axis.turns:
                _require_gear(by_name[axis.name], file)
        return Calibration(tuple(by_name[winch.name] for winch in robot.winches))

    @staticmethod
    def usual(robot: Robot) -> "Calibration":
        """Return motors 1, 2, ... for the winches in order, with the spools of robot.toml and unknown zeros."""
        winches = enumerate(robot.winches, 1)
        return Calibration(
            tuple(WinchMotor(winch=each.name, number=n, radius=each.spool_radius) for n, each in winches)
        )

    @staticmethod
    def emulate(folder: Path | None, robot: Robot) -> "Calibration":
        """Return emulated motors: as calibrated, or as in motors.toml; without either, with assumed zeros.

        Raises:
            InputError: an invalid file.
        """
        for name in (EMULATED_CALIBRATION, CALIBRATION):
            if folder is not None and (folder / name).exists():
                return Calibration.read(folder, robot, name=name)
        return Calibration.usual(robot).assume_zeros(robot)

    def write(self, folder: Path, *, name: str = CALIBRATION) -> Path:
        """Write the motors next to robot.toml, atomically; return the path."""
        known = any(spool.zero is not None for spool in self.motors)
        told = (
            "zero and curve are of this one robot" if known else "hydrostat calibrate finds where cables begin to pull"
        )
        lines = [f"# Which motor turns which winch; {told}.\n"]
        for spool in self.motors:
            lines += ["\n[[motor]]\n", f"winch = {json.dumps(spool.winch)}\n", f"number = {spool.number}\n"]
            if spool.zero is not None:
                lines.append(f"zero = {float(spool.zero)!r}  # angle with nothing taken in [rad]\n")
            lines += [f"turns = {spool.turns}\n", f'radius = "{units.format_quantity(spool.radius, units.LENGTH)}"\n']
            lines += [
                f"current = {float(spool.current)!r}  # at most [A]\n",
            ]
            if spool.curve:
                pairs = ", ".join(f"[{turned:.4f}, {taken:.6f}]" for turned, taken in spool.curve)
                lines.append(f"curve = [{pairs}]  # angle turned [rad], cable taken in [m]\n")
            if self.boards > 1:
                lines.append(f"board = {spool.board}\n")
            if spool.model is not None:
                lines.append(f"model = {json.dumps(spool.model)}\n")
            if spool.counts is not None:
                lines.append(f"counts = {float(spool.counts)!r}  # of the encoder in a turn of the spool\n")
        return replace_file(folder / name, "".join(lines).encode())


_MAX_BYTES = 1_000_000
"""No motors.toml has more bytes."""

_KEYS: dict[str, tuple[type, ...]] = {
    "winch": (str,),
    "number": (int,),
    "zero": (int, float),
    "turns": (int,),
    "radius": (str,),
    "curve": (list,),
    "current": (int, float),
    "counts": (int, float),
    "board": (int,),
    "model": (str,),
}


def _spool(entry: dict[str, Any], file: Path) -> WinchMotor:
    name = entry.get("winch", "?")
    for key, value in entry.items():
        if key not in _KEYS:
            raise InputError(
                f"{file}: [[motor]] of {quote(name)}: unknown key {quote(key)}. Allowed: {', '.join(_KEYS)}."
            )
        too_large = isinstance(value, int) and abs(value) > 2**53
        if not isinstance(value, _KEYS[key]) or isinstance(value, bool) or too_large:
            raise InputError(f"{file}: [[motor]] of {quote(name)}: {key} cannot be {repr(value)[:60]}")
    for key in ("winch", "number", "radius"):
        if key not in entry:
            raise InputError(f"{file}: [[motor]] of {quote(name)} needs {key}")
    try:
        given: dict[str, Any] = entry | {"radius": units.parse_quantity(entry["radius"], units.LENGTH)}
        given["curve"] = _pairs(entry.get("curve", []))
        return WinchMotor(**given)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def _require_gear(motor: WinchMotor, file: Path) -> None:
    """Refuse the radius of a spool where a motor turns pins: they would turn too far, beyond their limits."""
    most, ratio = 3.0, LEVER / motor.radius
    if round(max(ratio, 1 / ratio), 1) > most:
        raise InputError(
            f"{file}: [[motor]] of {quote(motor.winch)}: radius {1e3 * motor.radius:g} mm is a gear of {ratio:.2g}:1 "
            f'for a drive that turns. Write "{1e3 * LEVER:.7f} mm", divided by its gear ratio of 1/{most:g} to {most:g}'
        )


def _pairs(entries: list[Any]) -> tuple[tuple[float, float], ...]:
    """A curve as it is written; what is none becomes NaN, which a `WinchMotor` refuses."""
    try:
        return tuple((float(turned), float(taken)) for turned, taken in entries)
    except (TypeError, ValueError, OverflowError):
        return ((np.nan, np.nan),)
