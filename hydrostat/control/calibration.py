"""`Calibration`: which motor turns which winch, and what its angle says of the cable; kept as motors.toml."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat import units
from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot, replace_file

CALIBRATION = "motors.toml"


@dataclass(frozen=True, kw_only=True)
class WinchMotor:
    """A motor and the spool on it.

    Attributes:
        winch: its name.
        number: of the motor on its bus.
        zero: angle at which the winch has taken in nothing [rad]; None: not calibrated yet.
        turns: 1 where rising angles take cable in, -1 where they let it out.
        radius: of the spool at the zero [m].
        growth: of the radius as cable lies on cable [m/rad].
        current: the most that the motor may draw [A].
        counts: of its encoder in a turn of the spool; only for motors on a board with our firmware.
        board: or line that it hangs on, from 1, where there are several.
    """

    winch: str
    number: int
    zero: float | None = None
    turns: int = 1
    radius: float
    growth: float = 0.0
    current: float = 0.4
    counts: float | None = None
    board: int = 1

    def __post_init__(self) -> None:
        if not 0 <= self.number <= 252:
            raise InputError(f"{self.winch}: a motor has a number from 0 to 252, not {self.number}")
        if not 1 <= self.board <= 16:
            raise InputError(f"{self.winch}: boards are counted from 1 to 16, not {self.board}")
        if self.turns not in (1, -1):
            raise InputError(f"{self.winch}: turns must be 1 or -1, not {self.turns}")
        for name, value, most in (("radius", self.radius, 0.5), ("current", self.current, 30.0)):
            if not 0 < value <= most:
                raise InputError(f"{self.winch}: {name} must be above 0 and at most {most:g}, not {value:g}")
        if self.counts is not None and not 1 <= self.counts <= 1e6:
            raise InputError(f"{self.winch}: counts must be from 1 to a million, not {self.counts:g}")
        if not 0 <= self.growth <= self.radius:
            raise InputError(f"{self.winch}: growth must be from 0 to the radius, a radian, not {self.growth:g}")

    def contraction(self, angle: float) -> float:
        """Cable taken in at an angle of the motor [m], NaN before it is calibrated."""
        turned = self.turns * (angle - (np.nan if self.zero is None else self.zero))
        return self.radius * turned + 0.5 * self.growth * max(turned, 0.0) * turned

    def angle(self, contraction: float) -> float:
        """Angle of the motor at which so much is taken in [rad]."""
        turned = contraction / self.radius
        if self.growth > 0 and contraction > 0:
            turned = (np.sqrt(self.radius**2 + 2 * self.growth * contraction) - self.radius) / self.growth
        return (np.nan if self.zero is None else self.zero) + self.turns * turned

    def reach(self, contraction: float) -> float:
        """Radius at which cable runs on when so much is taken in [m]."""
        return float(np.sqrt(self.radius**2 + 2 * self.growth * max(contraction, 0.0)))


@dataclass(frozen=True)
class Calibration:
    """Motors in the order of the winches of a robot."""

    motors: tuple[WinchMotor, ...]

    def known(self) -> "Calibration":
        """The same with motors that count from 0, where no zero is known: for motors that are not there."""
        return Calibration(tuple(replace(each, zero=each.zero or 0.0) for each in self.motors))

    @property
    def boards(self) -> int:
        """How many boards or lines its motors hang on."""
        return max(motor.board for motor in self.motors)

    def places(self, board: int) -> list[int]:
        """Places of the motors of a board in the order of the winches."""
        return [place for place, motor in enumerate(self.motors) if motor.board == board]

    @property
    def done(self) -> bool:
        """Whether all zeros are known."""
        return all(spool.zero is not None for spool in self.motors)

    def check(self, robot: Robot) -> None:
        """Check that these are the winches of a robot (InputError: another, one missing, or a number twice)."""
        wanted, given = [winch.name for winch in robot.winches], [spool.winch for spool in self.motors]
        for name in wanted:
            if name not in given:
                raise InputError(f'{CALIBRATION}: winch "{name}" has no motor; add [[motor]] with winch = "{name}"')
        for name in given:
            if name not in wanted:
                raise InputError(f'{CALIBRATION}: there is no winch "{name}"; there are: {", ".join(wanted)}')
        numbers = [(spool.board, spool.number) for spool in self.motors]
        if len(set(numbers)) < len(numbers) or len(set(given)) < len(given):
            raise InputError(
                f"{CALIBRATION}: each winch has one motor, and each motor a number of its own on its board"
            )
        if missing := set(range(1, self.boards + 1)) - {spool.board for spool in self.motors}:
            raise InputError(
                f"{CALIBRATION}: boards are counted 1, 2, ...; none of the motors is on board {min(missing)}"
            )

    def contractions(self, angles: Vector) -> Vector:
        """Cable taken in by each winch [m]."""
        return np.array([spool.contraction(angle) for spool, angle in zip(self.motors, angles.tolist(), strict=True)])

    def angles(self, contractions: Vector) -> Vector:
        """Angle of each motor [rad], in its own count."""
        return np.array([spool.angle(taken) for spool, taken in zip(self.motors, contractions.tolist(), strict=True)])

    def radii(self, contractions: Vector) -> Vector:
        """Radius at which each cable runs on [m]."""
        return np.array([spool.reach(taken) for spool, taken in zip(self.motors, contractions.tolist(), strict=True)])


def usual_calibration(robot: Robot) -> Calibration:
    """Motors 1, 2, ... on the winches in their order, with the spools of robot.toml and zeros unknown."""
    winches = enumerate(robot.winches, 1)
    return Calibration(tuple(WinchMotor(winch=each.name, number=n, radius=each.spool_radius) for n, each in winches))


def read_calibration(folder: Path, robot: Robot) -> Calibration:
    """The motors of a robot folder (InputError: no motors.toml, or a wrong one, with the line of what is wrong)."""
    import tomllib

    file = folder / CALIBRATION
    try:
        table = tomllib.loads(file.read_text("utf-8"))
    except FileNotFoundError:
        raise InputError(f"{folder} has no {CALIBRATION}; `hydrostat calibrate` makes it") from None
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{file}: {error}") from None
    entries = table.get("motor")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(f"{file}: needs a [[motor]] for each winch")
    by_name = {spool.winch: spool for spool in (_spool(entry, file) for entry in entries)}
    found = Calibration(tuple(by_name.values()))
    found.check(robot)
    return Calibration(tuple(by_name[winch.name] for winch in robot.winches))


def write_calibration(folder: Path, calibration: Calibration) -> Path:
    """Write motors.toml beside robot.toml, whole or not at all; returns its path."""
    lines = ["# Which motor turns which winch. Made by hydrostat calibrate; zero and growth are of this one robot.\n"]
    for spool in calibration.motors:
        lines += ["\n[[motor]]\n", f'winch = "{spool.winch}"\n', f"number = {spool.number}\n"]
        if spool.zero is not None:
            lines.append(f"zero = {float(spool.zero)!r}  # angle with nothing taken in [rad]\n")
        lines += [f"turns = {spool.turns}\n", f'radius = "{units.format_quantity(spool.radius, units.LENGTH)}"\n']
        lines += [
            f"growth = {float(spool.growth)!r}  # of the radius [m/rad]\n",
            f"current = {float(spool.current)!r}  # at most [A]\n",
        ]
        if calibration.boards > 1:
            lines.append(f"board = {spool.board}\n")
        if spool.counts is not None:
            lines.append(f"counts = {float(spool.counts)!r}  # of the encoder in a turn of the spool\n")
    return replace_file(folder / CALIBRATION, "".join(lines).encode())


_KEYS: dict[str, tuple[type, ...]] = {
    "winch": (str,),
    "number": (int,),
    "zero": (int, float),
    "turns": (int,),
    "radius": (str,),
    "growth": (int, float),
    "current": (int, float),
    "counts": (int, float),
    "board": (int,),
}


def _spool(entry: dict[str, Any], file: Path) -> WinchMotor:
    name = entry.get("winch", "?")
    for key, value in entry.items():
        if key not in _KEYS:
            raise InputError(f'{file}: [[motor]] of "{name}": there is no key "{key}"; there are: {", ".join(_KEYS)}')
        if not isinstance(value, _KEYS[key]) or isinstance(value, bool):
            raise InputError(f'{file}: [[motor]] of "{name}": {key} cannot be {value!r}')
    for key in ("winch", "number", "radius"):
        if key not in entry:
            raise InputError(f'{file}: [[motor]] of "{name}" needs {key}')
    try:
        given: dict[str, Any] = entry | {"radius": units.parse_quantity(entry["radius"], units.LENGTH)}
        return WinchMotor(**given)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
