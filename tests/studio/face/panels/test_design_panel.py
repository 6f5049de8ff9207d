"""The panel of the stage "design". The oracle is what is wished."""

import pytest
from builders import gallery_robot
from desk import Desk, at_desk, is_shown

from hydrostat.design import DesignMethod, TreeOptions
from hydrostat.project import Paint
from hydrostat.robot import Robot
from hydrostat.studio.stage import StageName


def test_counts_and_limits_become_wishes(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        designer = desk.session.designer
        for name in ("winches", "cables"):
            before = getattr(designer.wishes, name)
            await desk.press(f"more-{name}")
            assert getattr(designer.wishes, name) == before + 1
            await desk.press(f"fewer-{name}")
            assert getattr(designer.wishes, name) == before
            assert desk.one(f"design-{name}").text == str(before)
        await desk.type("wish-tension", 12.5)
        assert designer.wishes.constraints.tension == pytest.approx(12.5)
        await desk.type("wish-clearance", 4.0)
        assert designer.wishes.constraints.clearance == pytest.approx(0.004)
        await desk.type("wish-tension", -1.0)  # refused: the wish stays, and so does the number that is shown
        assert designer.wishes.constraints.tension == pytest.approx(12.5)
        assert desk.one("wish-tension").value == pytest.approx(12.5)
        await desk.choose("wish-mirror", "x")
        assert designer.wishes.constraints.mirror == "x"
        await desk.press("Undo")
        assert designer.wishes.constraints.mirror is None
        assert desk.one("wish-mirror").value == ""

    at_desk(starfish, act)


def test_the_thesis_search_has_its_knobs(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        designer = desk.session.designer
        assert not is_shown(desk.one("wish-phi"))
        await desk.choose("wish-method", DesignMethod.CHANG2018)
        assert designer.wishes.method is DesignMethod.CHANG2018
        assert is_shown(desk.one("wish-phi"))
        assert not is_shown(desk.one("wish-simplicity"))
        for count, (knob, value) in enumerate((("threshold", 40), ("distance", 2.5), ("steps", 8), ("phi", 0.3)), 1):
            assert len(desk.begun) == count  # each knob acts immediately
            designer._on_end(desk.begun[-1][1][1], "")
            await desk.type(f"wish-{knob}", value)
            assert designer.wishes.value(knob) == pytest.approx(value)
        asked = desk.begun[-1][1][1]
        assert asked.method is DesignMethod.CHANG2018
        assert asked.options == TreeOptions.single(threshold=40, distance=2.5, steps=8, phi=0.3)
        await desk.type("wish-phi", 1.5)  # refused
        assert desk.one("wish-phi").value == pytest.approx(0.3)
        designer._on_end(asked, "")
        await desk.follow()
        await desk.press("design-go")
        assert len(desk.begun) == 6
        await desk.press("Undo")
        assert designer.wishes.knobs.phi == pytest.approx(0.5)

    at_desk(starfish, act)


def test_a_knob_without_effect_says_so(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        await desk.choose("wish-method", DesignMethod.CHANG2018)
        assert not is_shown(desk.one("design-no-spread"))
        desk.session.designer.wish(winches=3, cables=3)
        await desk.follow()
        assert is_shown(desk.one("design-no-spread"))

    at_desk(starfish, act)


def test_paints_are_taken_and_put_away(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        painter = desk.session.designer.painter
        for paint in Paint:
            await desk.press(f"paint-{paint}")
            assert painter.paint is paint
            await desk.press(f"paint-{paint}")
            assert painter.paint is None

    at_desk(starfish, act)


def test_design_begins_work(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        await desk.press("design-go")
        assert len(desk.begun) == 1

    at_desk(starfish, act)


def test_without_a_pose_one_is_sent_to_pose(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.session.poser.delete_pose(next(iter(starfish.poses)))
        for name in list(desk.robot.poses):
            desk.session.poser.delete_pose(name)
        desk.go(StageName.DESIGN)
        assert not desk.one("design-go").enabled
        await desk.press("design-to-pose")
        assert desk.session.stage is StageName.POSE

    at_desk(starfish, act)


def test_cables_on_the_skin_are_for_bodies_in_space(starfish: Robot) -> None:
    async def flat(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        assert desk.all("wish-depth") == []

    async def act(desk: Desk) -> None:
        desk.go(StageName.DESIGN)
        designer = desk.session.designer
        await desk.type("wish-depth", 2.5)
        assert designer.wishes.constraints.depth == pytest.approx(0.0025)
        await desk.type("wish-depth", None)
        assert designer.wishes.constraints.depth is None

    at_desk(starfish, flat)
    at_desk(gallery_robot("trunk"), act)
