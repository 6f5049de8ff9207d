"""`unpack`: what the studio does with an archive of a robot, for tests and studies elsewhere."""

from pathlib import Path

from hydrostat.studio.starting.starter import unpack_robot


def unpack(path: Path) -> None:
    """Read the robot in an archive (InputError: there is none)."""
    unpack_robot(path.name, path.read_bytes())
