"""The panel of the stage "drive" and the timeline below it. The oracle is the driver."""

import pytest
from desk import Desk, at_desk

from hydrostat.robot import Robot
from hydrostat.studio.stage import StageName


def test_knobs_and_boxes_turn_winches(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DRIVE)
        driver, name = desk.session.driver, starfish.winches[0].name
        await desk.press(f"knob-{name}", "turn", 12.0)
        assert driver.commands()[name] == pytest.approx(0.012)
        assert desk.one(f"box-{name}").value == pytest.approx(12.0)
        await desk.press(f"knob-{name}", "turn", "no number")
        assert driver.commands()[name] == pytest.approx(0.012)
        await desk.press(f"box-{name}", "focus")
        await desk.press(f"box-{name}", "update:model-value", 7.5)
        assert driver.commands()[name] == pytest.approx(0.0075)
        await desk.press(f"box-{name}", "blur")
        await desk.press("drive-rest")
        assert set(driver.commands().values()) == {0.0}
        assert desk.one(f"box-{name}").value == 0.0

    at_desk(starfish, act)


def test_keyframes_length_and_play(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DRIVE)
        driver, name = desk.session.driver, starfish.winches[0].name
        await desk.press("drive-timeline", "seek", {"time": 1.5})
        await desk.press(f"knob-{name}", "turn", 10.0)
        await desk.press("drive-add")
        (key,) = driver.keyframes.timeline.keys
        assert key.time == pytest.approx(1.5)
        assert key.contractions[name] == pytest.approx(0.010)
        assert [round(shown["time"], 3) for shown in desk.one("drive-timeline").props["keys"]] == [1.5]
        await desk.press("drive-timeline", "move", {"index": 0, "time": 2.5})
        assert driver.keyframes.timeline.keys[0].time == pytest.approx(2.5)
        await desk.press("drive-timeline", "move", {"index": "x"})  # not heeded
        assert driver.keyframes.timeline.keys[0].time == pytest.approx(2.5)
        await desk.press("drive-length", "update:model-value", 7)
        assert driver.keyframes.timeline.seconds == pytest.approx(7.0)
        await desk.press("drive-play")
        assert driver.player.playing
        assert "pause" in str(desk.one("drive-play").props["icon"])
        await desk.press("drive-play")
        assert not driver.player.playing
        await desk.press("drive-timeline", "choose", {"index": 0})
        assert desk.one("Delete keyframe").enabled
        await desk.press("Delete keyframe")
        assert driver.keyframes.timeline.keys == ()

    at_desk(starfish, act)


def test_a_robot_without_cables_is_sent_on(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DRIVE)
        await desk.press("drive-design")
        assert desk.session.stage is StageName.DESIGN

    at_desk(starfish.with_network((), ()), act)
