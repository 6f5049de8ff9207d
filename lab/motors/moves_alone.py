"""An hour of stored moves on a board without a computer: how far motors are from the table where they stand.

Usage: python lab/motors/moves_alone.py [BOARD] [SECONDS]

BOARD is esp32s3 (default: a stand-in, compiled by g++, half a minute of CPU an hour) or uno (in simavr, which needs
gcc-avr, avr-libc, libsimavr-dev and libelf-dev, and five minutes of CPU an hour).
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "control"))
sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from firmware_bench import Board, two_winch_strip
from machine import machine

from hydrostat.control import Calibration, bake_moves, firmware_settings
from hydrostat.fabrication import BOARDS

COUNTS, MOVES, MOVE, HOLD = 1000.0, 80, 1.0, 0.4
"""Counts a turn; moves of a round, time of each and of the pause after it [s]."""
SLACK, STIFF = 150.0, 3e-4
"""Counts at which the cables begin to pull, and current by count that they ask for [A]: 0.15 A at 20 mm."""


def write_table(folder: Path, names: tuple[str, ...]) -> tuple[Path, np.ndarray]:
    """A table of random moves within 3 and 20 mm, and its rows with a pause after each: time [s], places [mm]."""
    goals = np.random.default_rng(1).uniform(3.0, 20.0, (MOVES, 2)).round(1)
    times = (MOVE + HOLD) * np.arange(MOVES)
    rows = np.vstack([np.column_stack([times, goals]), np.column_stack([times + HOLD, goals])])
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    file = folder / "dance.csv"
    file.write_text("\n".join(["time_s," + ",".join(names), *(",".join(map(str, row)) for row in rows)]) + "\n")
    return file, rows


def play_round(board: Board, counts: np.ndarray) -> tuple[float, str]:
    """Press the button until the motors are off: worst place at the ends of pauses [counts], and how it ended."""
    board.press()
    seen = list[tuple[float, float, float]]()
    while (state := board.ask("R")).startswith("ok armed"):
        seen.append((board.clock(), *(winch.angle for winch in board.winches)))
        board.run(0.02)
    times, *angles = np.array(seen).T
    ends = HOLD - 0.05 + (MOVE + HOLD) * np.arange(MOVES)

    def miss(late: float) -> float:  # it goes to the first row before it plays
        found = np.column_stack([np.interp(times[0] + late + ends, times, angle) for angle in angles])
        return float(np.abs(found - counts).max())

    return min(map(miss, np.arange(0.0, 3.0, 0.02))), state


def main() -> None:
    """Print the rounds, how far motors were from the table where they stand, and how each round ended."""
    machine()
    kind, seconds = (*sys.argv[1:], *("esp32s3", "3600")[len(sys.argv) - 1 :])
    robot, duration = two_winch_strip(), float(seconds)
    usual = Calibration.usual(robot).motors
    motors = Calibration(tuple(replace(each, counts=COUNTS, zero=0.0) for each in usual))
    with tempfile.TemporaryDirectory() as made:
        file, rows = write_table(Path(made), tuple(winch.name for winch in robot.winches))
        moves = bake_moves(file, Path(made), robot, motors, kind)
        board = Board(BOARDS[kind].chip, settings=firmware_settings(robot, motors, rpm=216.0) + moves.settings)
        pauses = 1e-3 * rows[1::2, 1:]
        angles = np.array([[m.angle(x) for m, x in zip(motors.motors, place, strict=True)] for place in pauses])
        counts = angles * COUNTS / (2 * np.pi)
        for winch in board.winches:
            winch.stiffness, winch.slack = STIFF, SLACK
        assert board.ask("M 0 0") == "ok"
        begun, rounds, worst, ends = time.process_time(), 0, 0.0, set[str]()
        while board.clock() < duration:
            found, end = play_round(board, counts)
            rounds, worst = rounds + 1, max(worst, found)
            ends.add(" ".join(end.split()[:3]))
    millimeters = worst * 2 * np.pi / COUNTS * 1e3 * motors.motors[0].radius
    print(f"{kind}: {rounds} rounds of {moves.seconds:.1f} s, {rounds * MOVES} moves in {board.clock():.0f} s")
    print(f"where they stand, motors are at most {worst:.1f} counts ({millimeters:.2f} mm) from the table")
    print(f"rounds ended as: {', '.join(sorted(ends))}; {time.process_time() - begun:.0f} s of CPU")


if __name__ == "__main__":
    main()
