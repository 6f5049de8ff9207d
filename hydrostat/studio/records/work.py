"""`Work`: all that can be undone; what of it follows when the robot is changed."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from hydrostat.control import Timeline
from hydrostat.robot import Robot
from hydrostat.studio.records.wishes import Wishes


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """What a person works on; each change makes a new one.

    Attributes:
        robot: body, pins, winches, cables, markers, poses.
        timeline: keyframes.
        wishes: for a design.
    """

    robot: Robot
    timeline: Timeline = field(default_factory=Timeline)
    wishes: Wishes = field(default_factory=Wishes)


def followed(
    work: Work, robot: Robot, renamed: Mapping[str, str] | None = None, cables: Mapping[int, int] | None = None
) -> tuple[Timeline, Wishes]:
    """Timeline and wishes that name only what the robot has.

    Args:
        work: as it was before.
        robot: as it is now.
        renamed: new names of winches, by their old ones.
        cables: new numbers of cables, by their old ones; if left out, all have their old ones where there are as many
            as before, else those that are the same.
    """
    names = {winch.name for winch in robot.winches}
    new = dict(renamed or {})
    keys = []
    for key in work.timeline.keys:
        told = {new.get(name, name): value for name, value in key.contractions.items()}
        kept = {name: value for name, value in told.items() if name in names}
        keys.append(key if kept == key.contractions else replace(key, contractions=kept))
    before, now = work.wishes, len(robot.cables)
    if cables is None:
        cables = (
            {number: number for number in range(now)} if now == len(work.robot.cables) else _same_cables(work, robot)
        )
    wishes = replace(
        before,
        poses=tuple(pose for pose in before.poses if pose in robot.poses),
        kept_winches=tuple(name for name in (new.get(name, name) for name in before.kept_winches) if name in names),
        kept_cables=tuple(cables[number] for number in before.kept_cables if number in cables),
    )
    return replace(work.timeline, keys=tuple(keys)), before if wishes == before else wishes


def after_design(work: Work, robot: Robot) -> Wishes:
    """Wishes after a design has replaced the network: what was kept and is there still is kept on.

    Args:
        work: as it was before.
        robot: as it is now.
    """
    wishes = followed(work, robot, cables=_same_cables(work, robot))[1]
    places = {winch.name: winch.at for winch in work.robot.winches}
    stayed = {winch.name for winch in robot.winches if places.get(winch.name) == winch.at}
    return replace(wishes, kept_winches=tuple(name for name in wishes.kept_winches if name in stayed))


def _same_cables(work: Work, robot: Robot) -> dict[int, int]:
    """Numbers of the cables that a robot has as they were before, by their numbers then."""
    found: dict[int, int] = {}
    left = dict(enumerate(robot.cables))
    for number, cable in enumerate(work.robot.cables):
        same = next((place for place, other in left.items() if other == cable), None)
        if same is not None:
            found[number] = same
            del left[same]
    return found


def fresh_name(stem: str, taken: Collection[str]) -> str:
    """The first of stem_1, stem_2 ... that is not taken."""
    number = 1
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"
