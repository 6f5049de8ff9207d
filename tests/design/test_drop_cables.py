"""The fewest cables that still reach the poses of a robot, about."""

from dataclasses import replace

import pytest
from builders import strip_robot

from hydrostat.design import PosedNetwork, drop_cables
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget, Robot


@pytest.fixture(scope="module")
def crowded() -> Robot:
    """A strip that bends both ways, and a third cable so slack that it never pulls."""
    robot = strip_robot(columns=6, rows=2)
    idle = replace(robot.cables[0], name="idle", slack=1.0)
    poses = [PoseTarget(name=name, targets={"tip": at}) for name, at in (("up", (0.18, 0.06)), ("down", (0.19, -0.04)))]
    posed = replace(robot, poses={pose.name: pose for pose in poses})
    return posed.with_network(posed.winches, (idle, *posed.cables))


def test_the_cable_that_never_pulls_goes_and_those_that_bend_it_stay(crowded: Robot) -> None:
    """Oracle: the robot that it was made of; each pose needs the cable on its side."""
    full, fewer = drop_cables(crowded, share=0.0)
    assert fewer.robot.cables == crowded.cables[1:]
    assert fewer.robot.winches == crowded.winches
    assert full.robot is crowded
    assert fewer.error == pytest.approx(PosedNetwork.solve(fewer.robot).error)
    assert fewer.error <= 1.5 * full.error


def test_a_winch_goes_with_its_last_cable_and_one_cable_stays(crowded: Robot) -> None:
    """Oracle: whatever may be lost; names of the winches that cables are of."""
    told: list[tuple[int, int]] = []
    _, fewer = drop_cables(crowded, worse=1e9, progress=lambda _, done, total: told.append((done, total)))
    assert len(fewer.robot.cables) == len(fewer.robot.winches) == 1
    assert fewer.robot.cables[0].winch == fewer.robot.winches[0].name
    assert told == [(0, 2), (1, 2)]


def test_friction_moves_markers_the_more_the_rougher_holes_are(crowded: Robot) -> None:
    """Oracle: no friction moves nothing; a cable that rubs pulls less."""
    full, _ = drop_cables(crowded, worse=0.0, share=0.0)
    none, some, much = (full.friction_motion(mu) for mu in (0.0, 0.2, 0.4))
    assert none < 1e-9
    assert 1e-4 < some < much


def test_a_robot_without_poses_is_refused() -> None:
    with pytest.raises(InputError, match=r"Add a \[\[pose\]\] and cables"):
        drop_cables(strip_robot(columns=6, rows=2))
