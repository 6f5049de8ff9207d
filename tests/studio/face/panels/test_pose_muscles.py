"""Switches for muscles in the stage "pose". The oracle is the session behind them."""

import pytest
from desk import Desk, at_desk, is_shown

from hydrostat.robot import Robot
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.posing.proposal_work import Proposal
from hydrostat.studio.stage import StageName
from hydrostat.studio.view.coloring import Coloring
from hydrostat.units import plural


def test_muscles_are_shown_and_cables_proposed(starfish: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        session, poser = desk.session, desk.session.poser
        monkeypatch.setattr(poser.proposals, "_follow", lambda run: None)  # no process of its own
        assert not is_shown(desk.one("pose-colors"))
        poser.set_mode(Mode.MUSCLES)
        await desk.follow()
        assert is_shown(desk.one("pose-colors"))
        await desk.choose("pose-colors", True)
        assert session.coloring is Coloring.MUSCLES
        await desk.choose("pose-colors", False)
        assert session.coloring is Coloring.FELT
        assert not is_shown(desk.one("pose-proposed"))
        await desk.choose("pose-propose", True)
        assert poser.proposals.on
        assert desk.one("pose-proposed").text == "Drag a point to get a proposal."
        assert not is_shown(desk.one("pose-keep"))
        robot = desk.robot
        cables = tuple(cable for cable in robot.cables if cable.winch == robot.winches[0].name)
        found = Proposal(winches=robot.winches[:1], cables=cables, expected_error=0.0123)
        poser.show_pose("wave")
        poser.step(0.0)  # says that physics are made
        poser.step(0.0)
        poser.proposals._take(poser.proposals._run, robot, found)
        await desk.follow()
        assert desk.one("pose-proposed").text == f"1 winch, {plural(len(cables), 'cable')}"
        assert desk.one("pose-proposed-error").text == "12 mm as-built error"
        await desk.press("pose-keep")
        assert desk.robot.cables == cables
        assert desk.told[-1] == f"kept 1 winch and {plural(len(cables), 'cable')}. Undo takes them back"
        assert (desk.one("pose-keep").text, desk.one("pose-keep").enabled) == ("Kept", False)
        await desk.press("Undo")
        assert desk.robot.cables == robot.cables
        await desk.choose("pose-propose", False)
        assert not poser.proposals.on

    at_desk(starfish, act)


def test_what_stands_in_the_way_of_cables_is_told(starfish: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        poser = desk.session.poser
        monkeypatch.setattr(poser.proposals, "_follow", lambda run: None)
        poser.set_mode(Mode.MUSCLES)
        poser.proposals.switch(True)
        poser.show_pose("wave")
        poser.step(0.0)  # says that physics are made
        poser.step(0.0)
        poser.proposals._take(poser.proposals._run, desk.robot, Proposal(words="no cables fit these muscles"))
        await desk.follow()
        assert desk.one("pose-proposed-why").text == "No cables fit these muscles."
        assert not is_shown(desk.one("pose-keep"))

    at_desk(starfish, act)
