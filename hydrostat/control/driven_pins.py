"""`motor_stand`: a robot as its motors see it, with its drives of pins as winches; `stand_table`: its moves."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.model_tensions import tensions_along
from hydrostat.control.motors import LEVER, DriveAxis
from hydrostat.robot import LoadDrive, Robot, Winch, with_fixed_drives
from hydrostat.simulation import ProfileTable


def motor_stand(robot: Robot) -> Robot:
    """Return a robot in which a winch without cables replaces each pin drive.

    A linear drive takes in its travel [m], a rotary drive its angle times `LEVER`. A robot without drives is returned
    unchanged.
    """
    if not robot.drives:
        return robot
    factors, (low, high) = _factors(robot), robot.control_limits
    moved = factors * low, factors * high
    axes = [
        DriveAxis(
            name=drive.name,
            turns=drive.turns,
            at=tuple(robot.body.mesh.nodes[0].tolist()),
            spool_radius=LEVER if drive.turns else Winch.spool_radius,
            travel=max(float(moved[1][index]), 1e-6),
            release=float(-moved[0][index]),
        )
        for index, drive in enumerate(robot.drives, start=len(robot.winches))
        if not isinstance(drive, LoadDrive)
    ]
    still = with_fixed_drives(robot)
    return replace(still, winches=(*still.winches, *axes))


def stand_table(table: ProfileTable, robot: Robot) -> ProfileTable:
    """Return a table of moves for the `motor_stand` of a robot, without load shares, which no motor changes."""
    if not robot.drives:
        return table
    return replace(table, profile=replace(table.profile, values=_select(robot, table.profile.values)))


def list_moved_loads(table: ProfileTable, robot: Robot) -> list[str]:
    """Return the columns of a table of moves that change a load; `stand_table` leaves them out."""
    values = table.profile.values
    return [
        drive.column[0]
        for column, drive in enumerate(robot.drives, start=len(robot.winches))
        if isinstance(drive, LoadDrive) and values[:, column].any()
    ]


def stand_tensions(robot: Robot, table: ProfileTable) -> tuple[Callable[[Vector], Vector], Callable[[Vector], Vector]]:
    """Return tensions along moves by the values of a `motor_stand`; drives pull 0 N, or NaN in the second function."""
    if not robot.drives:
        pulls = tensions_along(robot, table.profile)
        return pulls, pulls
    count, axes = len(robot.winches), len(stand_table(table, robot).profile.values[0]) - len(robot.winches)
    pulls = tensions_along(robot, table.profile)
    factors = _factors(robot)

    def append_pull(values: Vector, pull: float) -> Vector:
        controls = np.zeros(robot.num_controls)
        controls[_find_moved(robot)] = values
        return np.append(pulls(controls / np.where(factors, factors, 1.0))[:count], np.full(axes, pull))

    return (lambda values: append_pull(values, 0.0)), (lambda values: append_pull(values, np.nan))


def _factors(robot: Robot) -> Vector:
    """Meters of a winch for a unit of each control."""
    return np.array([1.0] * len(robot.winches) + [LEVER if drive.turns else 1.0 for drive in robot.drives])


def _find_moved(robot: Robot) -> np.ndarray:
    """Mask of the controls that a motor moves."""
    return np.array([True] * len(robot.winches) + [not isinstance(drive, LoadDrive) for drive in robot.drives])


def _select(robot: Robot, values: np.ndarray) -> np.ndarray:
    return (_factors(robot) * values)[:, _find_moved(robot)]
