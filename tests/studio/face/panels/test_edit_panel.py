"""The panel of the stage "edit". The oracle is the robot: what is shown is of it, what is done changes it."""

import pytest
from desk import Desk, at_desk

from hydrostat.errors import in_words
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.studio.editing.editor import Tool
from hydrostat.studio.editing.part import keys_of
from hydrostat.studio.judge import QUIET
from hydrostat.studio.stage import Hit, StageName


def place(robot: Robot, name: str) -> Point:
    return next(marker.at for marker in robot.markers if marker.name == name)


def test_parts_are_listed_chosen_moved_named_and_deleted(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        assert [key for key in keys_of(starfish) if not desk.all(f"part-{key}")] == []
        await desk.press("part-marker:top")
        assert desk.session.editor.selected_key == "marker:top"
        at = place(starfish, "top")
        assert [desk.one(f"edit-{axis}").value for axis in "xy"] == pytest.approx([1e3 * value for value in at])
        await desk.type("edit-y", 1e3 * at[1] - 5.0)
        assert place(desk.robot, "top") == pytest.approx((at[0], at[1] - 0.005))
        await desk.type("edit-name", "tip")
        assert desk.session.editor.selected_key == "marker:tip"
        assert desk.all("part-marker:tip")
        await desk.press("edit-delete")
        assert "tip" not in {marker.name for marker in desk.robot.markers}
        await desk.press("Undo")
        assert "tip" in {marker.name for marker in desk.robot.markers}

    at_desk(starfish, act)


def test_numbers_of_winches_and_sheaths_of_cables(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        winch = starfish.winches[0]
        await desk.press(f"part-winch:{winch.name}")
        assert desk.one("edit-travel").value == pytest.approx(1e3 * winch.travel)
        await desk.type("edit-travel", 33.0)
        assert desk.robot.winches[0].travel == pytest.approx(0.033)
        await desk.type("edit-travel", -1.0)  # refused: the robot stays, and so does the number that is shown
        assert desk.robot.winches[0].travel == pytest.approx(0.033)
        assert desk.one("edit-travel").value == pytest.approx(33.0)
        assert "travel" in desk.told[-1]
        await desk.press("part-" + next(key for key in keys_of(starfish) if key.startswith("cable:")))
        before = desk.robot.cables[0].bare.tolist()
        assert [k for k in range(len(before) + 3) if desk.all(f"edit-sheath-{k}")] == list(range(len(before)))
        await desk.press("edit-sheath-0")
        assert desk.robot.cables[0].bare.tolist() == [not before[0], *before[1:]]

    at_desk(starfish, act)


def test_tools_mirror_and_check(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        editor = desk.session.editor
        for tool in Tool:
            await desk.press(f"edit-{tool}")
            assert editor.tool is tool
        await desk.press("edit-mirror-x")
        assert editor.mirror is not None
        assert editor.mirror.axis == 0
        await desk.press("edit-mirror-off")
        assert editor.mirror is None
        assert "Checking" in desk.words
        editor.step(0.0)
        editor.step(2 * QUIET)
        desk.beat()
        mesh, findings = starfish.body.mesh, editor.findings
        assert findings is not None
        assert any(f"{len(mesh.nodes)} nodes, {len(mesh.elements)} triangles" in words for words in desk.words)
        said = desk.session.document.judge.of(desk.robot, desk.session.document.work.wishes)
        assert said is not None
        assert {in_words(finding.text) for finding in said} <= set(desk.words)
        assert ("OK: 0 errors, 0 warnings." in desk.words) is (not said)

    at_desk(starfish, act)


def test_a_robot_without_cables_is_not_called_sound(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        desk.session.editor.step(0.0)
        desk.session.editor.step(2 * QUIET)
        desk.beat()
        assert "OK: 0 errors, 0 warnings." not in desk.words
        assert any("0 errors, 0 warnings, but no cables yet" in words for words in desk.words)

    at_desk(starfish.with_network((), ()), act)


def test_several_parts_are_chosen_by_presses_alone(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        await desk.press("edit-several-on")
        for name in ("top", "left"):
            await desk.press(f"part-marker:{name}")
        assert desk.session.editor.selection == ("marker:top", "marker:left")
        await desk.press("edit-several-off")
        await desk.press("part-marker:top")
        assert desk.session.editor.selection == ("marker:top",)

    at_desk(starfish, act)


def test_material_gravity_and_contact(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        assert desk.one("edit-material").value == starfish.body.material.name
        other = next(name for name in desk.one("edit-material").options if name != starfish.body.material.name)
        await desk.choose("edit-material", other)
        await desk.until(lambda: desk.robot.body.material.name == other)
        await desk.choose("edit-gravity", "-y")
        assert desk.robot.gravity is not None
        assert desk.robot.gravity[1] < 0
        await desk.choose("edit-gravity", "")
        assert desk.robot.gravity is None
        for on in (True, False):
            desk.one("edit-contact").set_value(on)
            await desk.until(lambda on=on: (desk.robot.contact is not None) == on)

    at_desk(starfish, act)


def test_a_region_is_painted_of_a_chosen_material(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.EDIT)
        editor = desk.session.editor
        await desk.press("edit-part")
        await desk.press("edit-form-box")
        await desk.type("edit-brush-material", "ecoflex 00-30")
        assert editor.grab(Hit(key="body", rest=(-0.02, -0.01), world=(-0.02, -0.01)))
        editor.drag(Hit(world=(0.02, 0.01)))
        editor.release()
        assert [str(part.shape) for part in desk.robot.body.parts] == ["box"]
        await desk.follow()
        assert desk.one("edit-region-material").value == "ecoflex 00-30"
        assert desk.all("part-region:0")
        await desk.type("edit-region-material", "rigid")
        assert desk.robot.body.parts[0].is_rigid

    at_desk(starfish, act)
