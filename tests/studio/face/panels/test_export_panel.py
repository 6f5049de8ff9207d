"""The panel of the stage "export". The oracle is the exporter: its options, and what was begun."""

import pytest
from desk import Desk, at_desk

from hydrostat.fabrication import Method, MoldKind, Paper
from hydrostat.robot import CableSide, Robot
from hydrostat.studio.exporting.exporter import Export
from hydrostat.studio.stage import StageName


def test_choices_become_the_options_of_the_kit(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EXPORT)
        exporter = desk.session.exporter
        assert desk.one("kit-motor").value == exporter.options.motor
        await desk.choose("kit-method", Method.FOAM.value)
        assert exporter.options.method is Method.FOAM
        await desk.choose("cloth between seam and cut [mm]", 11.0)
        assert exporter.options.pattern.seam_allowance == pytest.approx(11.0)
        before = exporter.options
        await desk.choose("diameter of the cables [mm]", -3.0)  # refused
        assert exporter.options == before
        assert desk.told
        assert exporter.options.paper is Paper.A4
        assert exporter.options.mould.kind is MoldKind.PRINTED

    at_desk(starfish, act)


def test_where_cables_run_is_said_and_chosen(starfish: Robot) -> None:
    """Oracle: the robot of the document, and its state before."""

    async def act(desk: Desk) -> None:
        desk.go(StageName.EXPORT)
        document = desk.session.document
        assert desk.one("cable-face").value == ""
        await desk.choose("cable-face", CableSide.PAIRS.value)
        assert document.robot.face is CableSide.PAIRS
        assert desk.one("cable-face").value == "pairs"
        document.undo()
        desk.beat()
        assert document.robot.face is None
        assert desk.one("cable-face").value == ""

    at_desk(starfish, act)


def test_each_button_begins_its_work(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EXPORT)
        for export in Export:
            await desk.press(f"make-{export}")
        assert [title for title, _ in desk.begun] == ["Building the kit", "Writing the report", "Drawing pictures"]
        assert all(arguments[0] is starfish for _, arguments in desk.begun)

    at_desk(starfish, act)


def test_a_pose_is_shown_and_what_failed_is_told(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EXPORT)
        exporter, pose = desk.session.exporter, next(iter(starfish.poses))
        await desk.choose("export-pose", pose)
        assert exporter.pose == pose
        exporter.errors[Export.REPORT] = "no paper"
        desk.session.document.change("same", robot=starfish)
        desk.beat()
        assert "no paper" in desk.words

    at_desk(starfish, act)


def test_a_robot_without_cables_has_no_kit(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EXPORT)
        assert "Build kit" not in desk.words
        await desk.press("export-design")
        assert desk.session.stage is StageName.DESIGN

    at_desk(starfish.with_network((), ()), act)
