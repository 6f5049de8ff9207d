"""Moves that a board plays alone: a table of contractions as counts of encoders, in the settings of its firmware."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import ceil, floor, pi
from pathlib import Path

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus_link import LinkLimits
from hydrostat.control.calibration import Calibration
from hydrostat.control.corrected_link import correct_table
from hydrostat.control.link import SimulatedLink
from hydrostat.control.motors import Motors
from hydrostat.errors import InputError
from hydrostat.fabrication import check_board
from hydrostat.robot import Robot
from hydrostat.simulation import ProfileTable

TICKS, TICK = 250, 62 * 1024 / 16e6
"""Ticks of the board in a second by their name, and what one lasts [s]: 62 counts of a timer that divides by 1024."""

RATES = (5, 10, 25, 50)
"""Rows a second that moves may have; the board interpolates linearly."""

_MAX_INT16 = 32_767


@dataclass(frozen=True, kw_only=True)
class BakedMoves:
    """Moves of one board.

    Attributes:
        steps: counts from the zeros by `step`, a row for each time, a column for each motor in its order.
        step: counts of a step.
        rate: rows a second.
    """

    steps: np.ndarray = field(repr=False)
    step: int
    rate: int

    @property
    def seconds(self) -> float:
        """Time from the first row to the last [s]."""
        return (len(self.steps) - 1) * _measure_row(self.rate)

    @property
    def size(self) -> int:
        """Program memory [B]."""
        return 2 * self.steps.size

    @property
    def settings(self) -> str:
        """Text for settings.h, after that of `firmware_settings`."""
        ends = zip(self.steps.min(axis=0).tolist(), self.steps.max(axis=0).tolist(), strict=True)
        return (
            "/* moves that a button plays: rows, ticks from row to row, counts of a step, and steps from the zeros */\n"
            f"#define MOVE_ROWS {len(self.steps)}\n#define MOVE_TICKS {TICKS // self.rate}\n"
            f"#define MOVE_STEP {self.step}\n#define MOVE_ENDS {{ \\\n{_list_rows(ends)}}}\n"
            f"#define MOVES {{ \\\n{_list_rows(self.steps.tolist())}}}\n"
        )


def bake_moves(
    path: Path,
    folder: Path,
    robot: Robot,
    calibration: Calibration,
    board: str,
    *,
    rate: int = 25,
    rpm: float | None = None,
) -> BakedMoves:
    """Convert moves for a robot with one board, with the commands of `hydrostat play`.

    Args:
        path: table of contractions.
        folder: robot folder; its correction.json, if any, corrects the table.
        robot: robot with the winches.
        calibration: motors with encoder counts; zeros are not needed.
        board: kind of board.
        rate: rows per second, one of `RATES`.
        rpm: no-load speed of the motors [turns/min], which moves must not exceed; None if unknown.

    Raises:
        InputError: several boards, another rate, or a table that motors cannot play or that exceeds the board's memory.
    """
    if rate not in RATES:
        raise InputError(f"--rate {rate}: unknown rate. Available: {', '.join(map(str, RATES))} rows/s.")
    if calibration.boards > 1:
        raise InputError(f"--moves plays on one board, and this robot has {calibration.boards}.")
    calibration.check(robot)
    table = ProfileTable.open(path, robot)
    if rpm is not None:
        _check_speeds(table, calibration, rpm)
    limits = Motors(robot.winches, SimulatedLink(np.zeros(len(robot.winches))), fastest=LinkLimits().speed)
    limits.check(table)
    corrected = correct_table(table, folder, robot)
    try:
        limits.check(corrected)
    except InputError as error:
        raise InputError(f"{error}, as correction.json corrects it") from None
    profile = corrected.profile
    rows = max(2, ceil(float(profile.times[-1]) / _measure_row(rate) - 1e-9) + 1)
    room = check_board(board).room // (2 * len(calibration.motors))
    if rows > room:
        longest, slowest = (room - 1) * _measure_row(rate), (room - 1) * _measure_row(RATES[0])
        raise InputError(
            f"{path.name}: {profile.times[-1]:.1f} s at {rate} rows/s exceed the memory of board {board}. Longest: "
            f"{longest:.1f} s, or {slowest:.1f} s with --rate {RATES[0]}."
        )
    counts = np.array([_count_from_zeros(calibration, profile.at(row * _measure_row(rate))) for row in range(rows)])
    step = max(1, ceil(np.abs(counts).max() / _MAX_INT16))
    return BakedMoves(steps=np.rint(counts / step).astype(int), step=step, rate=rate)


def _check_speeds(table: ProfileTable, calibration: Calibration, rpm: float) -> None:
    """Reject moves that are faster than a motor turns its spool without load (InputError)."""
    fastest = np.array([rpm / 60 * 2 * pi * motor.radius for motor in calibration.motors])
    speeds = np.abs(np.diff(table.profile.values, axis=0)) / np.diff(table.profile.times)[:, None]
    ratios = speeds / fastest
    if ratios.size and ratios.max() > 1 + 1e-6:
        row, winch = np.unravel_index(int(ratios.argmax()), ratios.shape)
        most = 1e3 * fastest[winch]
        raise InputError(
            f"{table.place(int(row) + 1)}, column {calibration.motors[winch].winch}: moves at "
            f"{1e3 * speeds[row, winch]:.3g} mm/s, the motor at {most:.3g} mm/s without load. Plan slower moves: "
            f'hydrostat trajectory --max-speed "{floor(1e3 * fastest.min())} mm/s".'
        )


def _measure_row(rate: int) -> float:
    """Time that a row lasts on the board [s]."""
    return TICKS // rate * TICK


def _count_from_zeros(calibration: Calibration, contractions: Vector) -> list[float]:
    """Counts of each motor in the order of the board."""
    ordered = sorted(zip(calibration.motors, contractions.tolist(), strict=True), key=lambda each: each[0].number)
    return [
        replace(motor, zero=0.0).angle(contraction) * (motor.counts or 0.0) / (2 * pi) for motor, contraction in ordered
    ]


def _list_rows(rows: Iterable[Iterable[int]]) -> str:
    """Rows as initializers of C."""
    return "".join(f"    {{{', '.join(map(str, row))}}}, \\\n" for row in rows)
