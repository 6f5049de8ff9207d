"""The panel of the stage "pose". The oracle is the stage: what it holds is shown, what is pressed it does."""

from desk import Desk, at_desk

from hydrostat.robot import Robot
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.stage import Hit, StageName


def test_what_is_held_is_listed_stored_and_let_go(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        poser = desk.session.poser
        assert "No targets yet. Drag a point, or select a marker and press arrow keys." in desk.words
        assert not desk.one("pose-store").enabled
        at = next(marker.at for marker in starfish.markers if marker.name == "top")
        desk.session.grab("a", Hit(key="marker:top", rest=at, world=at))
        desk.session.drag("a", Hit(world=(at[0] + 0.01, at[1])))
        desk.session.release("a")
        desk.beat()
        assert "No targets yet. Drag a point, or select a marker and press arrow keys." not in desk.words
        await desk.choose("pose-name", "hello")
        await desk.press("pose-store")
        assert desk.robot.poses["hello"].targets == {"top": poser.held_points["top"].target}
        assert desk.one("pose-name").value == ""
        assert desk.told == []
        await desk.choose("pose-name", "again")
        await desk.press("pose-store")
        assert desk.told == ["pose again stored. It equals pose hello"]
        await desk.press("Delete again")
        await desk.press("Release top")
        assert dict(poser.held_points) == {}
        await desk.press("pose-show-hello")
        assert set(poser.held_points) == {"top"}
        await desk.press("pose-rest")
        assert dict(poser.held_points) == {}
        await desk.press("Delete hello")
        assert "hello" not in desk.robot.poses
        assert not desk.all("pose-show-hello")

    at_desk(starfish, act)


def test_muscles_or_cables(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        poser = desk.session.poser
        assert desk.one("pose-mode").value is Mode.CABLES
        assert [winch.name for winch in starfish.winches if not desk.all(f"pose-bar-{winch.name}")] == []
        assert "Winches" in desk.words
        await desk.choose("pose-mode", Mode.MUSCLES)
        assert poser.mode is Mode.MUSCLES
        assert "Winches" not in desk.words  # with muscles no winch does anything
        poser.set_mode(Mode.CABLES)  # another window may change it
        desk.beat()
        assert desk.one("pose-mode").value is Mode.CABLES

    at_desk(starfish, act)


def test_a_robot_without_cables_has_muscles_only(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        assert desk.one("pose-mode").value is Mode.MUSCLES
        await desk.choose("pose-mode", Mode.CABLES)  # refused, and shown so
        assert desk.session.poser.mode is Mode.MUSCLES
        assert desk.one("pose-mode").value is Mode.MUSCLES
        assert "no cables" in desk.told[-1]

    at_desk(starfish.with_network((), ()), act)


def test_a_pose_is_renamed(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        old = next(iter(starfish.poses))
        await desk.press(f"Rename {old}")
        await desk.type("New name", "other")
        assert "other" in desk.robot.poses
        assert desk.all("pose-show-other")

    at_desk(starfish, act)


def test_reach_is_searched_for_the_chosen_marker(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        desk.go(StageName.POSE)
        await desk.choose("pose-reach-marker", "left")
        await desk.press("pose-reach")
        ((title, arguments),) = desk.begun
        assert title == "Workspace of left"
        assert arguments[1] == "left"

    at_desk(starfish, act)
