"""`followed`: keyframes and wishes after winches and poses of the robot have changed."""

from collections.abc import Mapping
from dataclasses import replace

from hydrostat.robot import Robot
from hydrostat.studio.records.timeline import Timeline
from hydrostat.studio.records.wishes import Wishes
from hydrostat.studio.records.work import Work


def followed(work: Work, robot: Robot, renamed: Mapping[str, str] | None = None) -> tuple[Timeline, Wishes]:
    """Timeline and wishes that name only what the robot has.

    Args:
        work: as it was before.
        robot: as it is now.
        renamed: new names of winches, by their old ones.
    """
    names = {winch.name for winch in robot.winches}
    new = dict(renamed or {})
    keys = []
    for key in work.timeline.keys:
        told = {new.get(name, name): value for name, value in key.contractions.items()}
        kept = {name: value for name, value in told.items() if name in names}
        keys.append(key if kept == key.contractions else replace(key, contractions=kept))
    poses = tuple(pose for pose in work.wishes.poses if pose in robot.poses)
    wishes = work.wishes if poses == work.wishes.poses else replace(work.wishes, poses=poses)
    return replace(work.timeline, keys=tuple(keys)), wishes
