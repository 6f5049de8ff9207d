"""`save_work`, `open_work`: a robot's folder, as the studio keeps it."""

from pathlib import Path

from hydrostat.robot import load_robot, save_robot
from hydrostat.studio.records.work import Work


def save_work(work: Work, folder: Path) -> None:
    """Write everything into a folder."""
    save_robot(work.robot, folder)


def open_work(folder: Path) -> Work:
    """Read a robot's folder.

    Raises:
        InputError: as for `load_robot`.
    """
    return Work(robot=load_robot(folder))
