"""`Work`: robot, keyframes and wishes; changes of the robot carried over to the others."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from hydrostat.control import Timeline
from hydrostat.project.wishes import Wishes
from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """Robot, keyframes and design settings that a person works on; each change makes a new record."""

    robot: Robot  # body, pins, winches, cables, markers, poses
    timeline: Timeline = field(default_factory=Timeline)  # keyframes
    wishes: Wishes = field(default_factory=Wishes)  # for a design


def follow_robot(
    work: Work, robot: Robot, renamed: Mapping[str, str] | None = None, cables: Mapping[str, str] | None = None
) -> tuple[Timeline, Wishes]:
    """Timeline and wishes that name only what the robot has now, by new names of winches and cables for old ones.

    Without names of cables, each is in its old place where there are as many as before, else those that are there still
    have their old names.
    """
    names = {winch.name for winch in robot.winches}
    new = dict(renamed or {})
    keys = []
    for key in work.timeline.keys:
        told = {new.get(name, name): value for name, value in key.contractions.items()}
        kept = {name: value for name, value in told.items() if name in names}
        keys.append(key if kept == key.contractions else replace(key, contractions=kept))
    before, now = work.wishes, [cable.name for cable in robot.cables]
    if cables is None:
        were = [cable.name for cable in work.robot.cables]
        cables = dict(zip(were if len(were) == len(now) else now, now, strict=True))
    wishes = replace(
        before,
        poses=tuple(pose for pose in before.poses if pose in robot.poses),
        kept_winches=tuple(name for name in (new.get(name, name) for name in before.kept_winches) if name in names),
        kept_cables=tuple(cables[name] for name in before.kept_cables if name in cables),
    )
    return replace(work.timeline, keys=tuple(keys)), before if wishes == before else wishes


def after_design(work: Work, robot: Robot) -> Wishes:
    """Wishes after a design has given the robot another network: what was kept and is there still is kept on."""
    same = {cable.name: cable.name for cable in work.robot.cables if cable in robot.cables}
    wishes = follow_robot(work, robot, cables=same)[1]
    places = {winch.name: winch.at for winch in work.robot.winches}
    stayed = {winch.name for winch in robot.winches if places.get(winch.name) == winch.at}
    return replace(wishes, kept_winches=tuple(name for name in wishes.kept_winches if name in stayed))


def fresh_name(stem: str, taken: Collection[str]) -> str:
    """The first of stem_1, stem_2 ... that is not taken."""
    number = 1
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"
