"""Oracles: `Simulation.solve` for shapes, `ContractionProfile` for commands, the record of the document for undo."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.arrays import Vector
from hydrostat.control import Key, Link, Timeline
from hydrostat.errors import HydrostatError, InputError
from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.document import Document
from hydrostat.studio.driving.driver import Driver
from hydrostat.studio.driving.machine import Follower
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.stage import Hit

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.fixture
def driver(document: Document) -> Driver:
    return Driver(document, Jobs(document.bell))


def settle(driver: Driver, start: float = 0.0, *, steps: int = 200) -> float:
    """Let it step, 20 ms at a time, until there is no more to do; the time then."""
    for number in range(1, steps + 1):
        if not driver.step(start + 0.02 * number):
            return start + 0.02 * number
    pytest.fail("it never comes to rest")


def put_keys(driver: Driver, *keys: tuple[float, dict[str, float]]) -> None:
    made = tuple(Key(time=time, contractions=contractions) for time, contractions in keys)
    driver.keyframes.replace_all(Timeline(keys=made), "keys")


def test_a_knob_bends_the_body_as_the_physics_say(driver: Driver, starfish: Robot) -> None:
    driver.turn("left", 0.02)
    settle(driver)
    found = Simulation(starfish).solve({"left": 0.02})
    assert np.abs(found.nodes - starfish.body.mesh.nodes).max() > 5e-3
    assert np.abs(driver.shape().nodes - found.nodes).max() < 1e-6
    pulled = [t for t, cable in zip(found.tensions, starfish.cables, strict=True) if cable.winch == "left"]
    assert driver.tensions()["left"] == pytest.approx(max(pulled), rel=1e-4)


def test_while_it_moves_it_is_a_hair_off_and_at_rest_exact(driver: Driver, starfish: Robot) -> None:
    physics = Simulation(starfish)
    driver.turn("left", 0.04)
    for number in range(1, 11):  # 2 mm a step
        driver.step(0.02 * number * 2 / 3)
    exact = physics.solve(driver.places()).nodes
    assert driver.motors.is_moving
    assert 0 < np.abs(driver.shape().nodes - exact).max() < 2e-5
    driver.leave()
    driver.step(1.0)
    assert np.abs(driver.shape().nodes - exact).max() < 1e-8


def test_motors_follow_at_their_speed(driver: Driver) -> None:
    driver.step(0.0)
    driver.motors.set_fastest(0.15)
    driver.turn("left", 0.06)
    driver.step(0.1)
    assert driver.step(0.2)
    assert driver.places()["left"] == pytest.approx(0.1 * 0.15)
    assert driver.commands()["left"] == 0.06


def test_commands_stay_within_the_limits(driver: Driver, starfish: Robot) -> None:
    winch = starfish.winch("left")
    driver.turn("left", 9.0)
    assert driver.commands()["left"] == winch.travel
    driver.turn("left", -9.0)
    assert driver.commands()["left"] == -winch.release


def test_what_is_no_contraction_is_refused(driver: Driver) -> None:
    with pytest.raises(InputError, match="must be a number"):
        driver.turn("left", float("nan"))
    with pytest.raises(InputError, match="tail"):
        driver.turn("tail", 0.01)
    with pytest.raises(InputError, match="number of seconds"):
        driver.seek(float("inf"))


def test_it_plays_by_the_clock_and_skips_when_it_is_late(driver: Driver) -> None:
    put_keys(driver, (0.0, {}), (4.0, {"feet": 0.04}))
    driver.set_loop(False)
    driver.play()
    driver.step(50.0)
    for now in (50.1, 50.2, 52.0):  # 1.8 s without a step
        driver.step(now)
    assert driver.player.time == pytest.approx(2.0)
    assert driver.commands()["feet"] == pytest.approx(0.02)
    driver.step(99.0)
    assert (driver.player.playing, driver.player.time) == (False, 4.0)
    settle(driver, 99.0)
    assert driver.places()["feet"] == pytest.approx(0.04)


def test_nothing_to_play_is_told(driver: Driver) -> None:
    with pytest.raises(InputError, match="no keyframes yet"):
        driver.key("space")


def test_space_r_and_leaving_stop_it(driver: Driver) -> None:
    put_keys(driver, (0.0, {"left": 0.01}), (4.0, {"feet": 0.04}))
    for stop in (lambda: driver.key("space"), lambda: driver.key("r"), driver.leave):
        assert driver.key("space")
        assert driver.player.playing
        stop()
        assert not driver.player.playing
    driver.key("r")
    settle(driver)
    assert set(driver.places().values()) == {0.0}
    assert not driver.key("q")


def test_left_while_they_turn_motors_hold(driver: Driver) -> None:
    driver.step(0.0)
    driver.turn("left", 0.06)
    driver.step(0.1)
    driver.step(0.2)
    driver.leave()
    assert driver.commands() == driver.places()
    assert 0.0 < driver.places()["left"] < 0.06


def test_at_a_limit_it_stops_and_tells(driver: Driver) -> None:
    put_keys(driver, (0.0, {}), (1.0, {"left": 0.1}))
    driver.play()
    driver.step(0.0)
    driver.step(0.9)
    assert not driver.player.playing
    settle(driver, 1.0)
    assert driver.shape().notes[0] == "stopped: left is at its limit of 60.0 mm and was asked for 90.0 mm"


class Broken(Link):
    """Motors that have lost their line."""

    def __init__(self) -> None:
        self.stops = 0

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        raise HydrostatError("the cable to the motors is unplugged")

    def read(self, now: float) -> Vector:
        raise AssertionError("nothing was sent")

    def stop(self) -> None:
        self.stops += 1

    def close(self) -> None:
        self.stop()


def test_on_an_error_of_the_motors_they_are_stopped(driver: Driver) -> None:
    put_keys(driver, (0.0, {}), (1.0, {"left": 0.02}))
    settle(driver)
    driver.motors.link = broken = Broken()
    driver.play()
    with pytest.raises(HydrostatError, match="unplugged"):
        driver.step(0.0)
    assert broken.stops >= 1
    assert not driver.player.playing
    assert driver.shape().notes == ("motors stopped: the cable to the motors is unplugged",)


class Counted(Link):
    """Motors that are where they shall be at once, and count what they are told."""

    def __init__(self, count: int) -> None:
        self.sent: list[Vector] = []
        self.stops = self.closes = 0
        self._places = np.zeros(count)

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        self.sent.append(contractions)
        self._places = contractions

    def read(self, now: float) -> Vector:
        return self._places

    def stop(self) -> None:
        self.stops += 1

    def close(self) -> None:
        self.closes += 1


def test_motors_of_another_kind_are_plugged_in(document: Document, starfish: Robot) -> None:
    """Oracle: the links that were made; each robot with other winches has its own, and the one before is closed."""
    made: list[Counted] = []

    def connect(places: Vector) -> Link:
        made.append(Counted(len(places)))
        return made[-1]

    driver = Driver(document, Jobs(document.bell), connect=connect)
    driver.turn("left", 0.02)
    settle(driver)
    assert made[-1].sent[-1].tolist() == [0.0, 0.02, 0.0]
    before = made[-1]
    travels = tuple(replace(winch, travel=0.03) for winch in starfish.winches)
    document.change("less travel", robot=replace(starfish, winches=travels))
    assert driver.commands()["left"] == 0.02
    assert (driver.motors.link, driver.motors.high.tolist()) == (before, [0.03] * 3)
    cables = tuple(cable for cable in starfish.cables if cable.winch != "feet")
    document.change("delete winch", robot=replace(starfish, winches=starfish.winches[:2], cables=cables))
    assert driver.places() == {"right": 0.0, "left": 0.02}
    assert before.closes == 1
    assert driver.motors.link is made[-1]
    assert driver.motors.link is not before


@pytest.mark.parametrize("place", ["follow", "physics", "timeline"])
def test_on_any_error_motors_hold_and_nothing_plays(
    driver: Driver, document: Document, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    put_keys(driver, (0.0, {}), (1.0, {"left": 0.02}))
    settle(driver)
    driver.motors.link = link = Counted(3)
    driver.play()
    driver.step(10.0)
    driver.step(10.2)

    def refuse(*arguments: object, **options: object) -> None:
        raise ZeroDivisionError("by nothing")

    if place == "follow":
        monkeypatch.setattr(Follower, "follow", refuse)
    elif place == "physics":
        monkeypatch.setattr(Document, "simulation", property(refuse))
    else:
        monkeypatch.setattr(Timeline, "profile", refuse)
    with pytest.raises(ZeroDivisionError):
        driver.step(10.4)
    assert not driver.player.playing
    assert link.stops == 1
    assert driver.commands() == driver.places()
    assert driver.shape().notes == ("motors stopped: ZeroDivisionError: by nothing",)


def test_an_error_that_stays_rings_once(driver: Driver, document: Document) -> None:
    settle(driver)
    driver.motors.link = Broken()
    rung: list[Topic] = []
    document.bell.listen(rung.append)
    for now in (1.0, 2.0, 3.0):
        with pytest.raises(HydrostatError, match="unplugged"):
            driver.step(now)
    assert rung.count(Topic.DRIVE) == 1


def test_motors_are_told_sixty_times_a_second_at_most(driver: Driver) -> None:
    put_keys(driver, (0.0, {"left": 0.01}), (1.0, {"left": 0.01}))
    settle(driver)
    driver.motors.link = link = Counted(3)
    driver.play()
    assert all(driver.step(10.0) for _ in range(20))
    assert len(link.sent) == 1
    assert all(driver.step(10.0 + 1e-3 * number) for number in range(1001))
    assert 50 <= len(link.sent) <= 70
    driver.stop()
    settle(driver, 20.0)
    assert driver.player.time == pytest.approx(1.0, abs=0.02)


def test_where_no_shape_is_found_the_last_one_stays(
    driver: Driver, document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver.turn("left", 0.01)
    settle(driver)
    before = driver.shape().nodes
    posed = Simulation.make_pose

    def turned_inside_out(self, *arguments):
        found = posed(self, *arguments)
        return replace(found, nodes=found.nodes[:, ::-1])

    monkeypatch.setattr(Simulation, "make_pose", turned_inside_out)
    put_keys(driver, (0.0, {"left": 0.01}), (1.0, {"left": 0.03}))
    driver.play()
    driver.step(10.0)
    driver.step(10.2)
    driver.step(10.4)
    assert np.array_equal(driver.shape().nodes, before)
    assert "elements inverted" in driver.shape().notes[0]
    assert not driver.player.playing
    assert driver.commands() == driver.places()
    there = driver.places()["left"]
    driver.turn("left", 0.05)  # on into what has no shape
    settle(driver, 11.0)
    assert driver.places()["left"] == there
    assert "elements inverted" in driver.shape().notes[0]
    driver.turn("left", 0.005)  # back, past where there was one
    settle(driver, 12.0)
    assert driver.places()["left"] == pytest.approx(0.005)
    monkeypatch.undo()
    driver.rest()
    settle(driver, 20.0)
    assert driver.shape().notes == ()


def test_a_cable_that_bears_too_much_is_told(driver: Driver, document: Document) -> None:
    driver.turn("left", 0.06)
    settle(driver)
    most = driver.tensions()["left"]
    document.change("less", wishes=document.work.wishes.with_values(tension=most / 2))
    assert driver.shape().notes[0] == f"left: cable tension {most:.1f} N, maximum {most / 2:g} N"


def test_keys_are_added_selected_turned_and_undone(driver: Driver, document: Document) -> None:
    driver.turn("left", 0.01)
    driver.add_key()
    assert driver.keyframes.chosen_index == 0
    for contraction in (0.02, 0.03, 0.04):
        driver.turn("feet", contraction)
    driver.let_go()
    assert document.work.timeline.keys[0].contractions == {"right": 0.0, "left": 0.01, "feet": 0.04}
    document.undo()
    assert document.work.timeline.keys[0].contractions["feet"] == 0.0
    driver.step(0.0)
    assert driver.commands()["feet"] == 0.0  # the knobs show the key as it is now
    document.undo()
    assert document.work.timeline.keys == ()
    assert driver.keyframes.chosen_index is None


def test_without_a_selected_key_knobs_change_none(driver: Driver, document: Document) -> None:
    put_keys(driver, (0.0, {}), (2.0, {"left": 0.02}))
    serial = document.serial
    driver.seek(1.0)
    assert driver.commands()["left"] == pytest.approx(0.01)
    driver.turn("left", 0.05)
    driver.rest()
    assert document.serial == serial
    driver.turn("feet", 0.03)
    driver.add_key()
    assert document.work.timeline.keys[1] == Key(time=1.0, contractions={"right": 0.0, "left": 0.0, "feet": 0.03})


def test_a_drag_of_a_key_is_one_change(driver: Driver, document: Document) -> None:
    put_keys(driver, (0.0, {}), (2.0, {"left": 0.02}), (3.0, {"left": 0.03}))
    for time in (2.5, 3.0, 3.5, 99.0):  # over the next key, which stays
        driver.move_key(1, time)
    assert [key.time for key in document.work.timeline.keys] == [0.0, 3.0, 4.0]
    assert driver.keyframes.chosen_index == 2
    driver.drop_key()
    driver.move_key(2, 1.0)
    driver.drop_key()
    assert [key.time for key in document.work.timeline.keys] == [0.0, 1.0, 3.0]
    document.undo()
    assert [key.time for key in document.work.timeline.keys] == [0.0, 3.0, 4.0]
    document.undo()
    assert [key.time for key in document.work.timeline.keys] == [0.0, 2.0, 3.0]


@pytest.mark.parametrize("between", ["leave", "undo", "change", "open"])
def test_a_drag_that_was_never_dropped_brings_nothing_old_back(
    driver: Driver, document: Document, starfish: Robot, between: str
) -> None:
    put_keys(driver, (0.0, {}), (2.0, {"left": 0.02}))
    driver.move_key(1, 2.5)
    if between == "leave":
        driver.leave()
        keys = (Key(time=0.0, contractions={}), Key(time=1.0, contractions={}))
        document.change("by another way", timeline=Timeline(keys=keys))
    elif between == "undo":
        document.undo()
    elif between == "change":
        driver.keyframes.add_key(1.0, {"feet": 0.01})
    else:
        document.open(
            Work(robot=replace(starfish, name="other"), timeline=Timeline(keys=(Key(time=1.0, contractions={}),)))
        )
        driver.keyframes.add_key(3.0, {"left": 0.01})
    before = driver.keyframes.timeline
    driver.move_key(1, 3.5)
    assert driver.keyframes.timeline == replace(before.move_key(1, 3.5), length=before.seconds)


def test_a_selected_key_is_one_of_this_robot(driver: Driver, document: Document, starfish: Robot) -> None:
    keys = (Key(time=0.0, contractions={}), Key(time=2.0, contractions={"left": 0.02}))
    put_keys(driver, (0.0, {}), (2.0, {"left": 0.02}))
    driver.choose(1)
    document.open(Work(robot=replace(starfish, name="other"), timeline=Timeline(keys=keys)))
    assert driver.keyframes.chosen_index is None
    driver.turn("left", 0.03)
    assert driver.keyframes.timeline.keys == keys


def test_keys_are_copied_and_deleted(driver: Driver, document: Document) -> None:
    put_keys(driver, (0.0, {"left": 0.02}), (0.5, {}))
    driver.choose(0)
    driver.duplicate_key()
    assert document.work.timeline.keys[2] == Key(time=1.0, contractions={"left": 0.02})
    assert driver.keyframes.chosen_index == 2
    driver.key("delete")
    assert len(document.work.timeline.keys) == 2
    with pytest.raises(InputError, match="no keyframe selected"):
        driver.delete_key()
    with pytest.raises(InputError, match=r"unknown keyframe 8\. Available: 1 to 2"):
        driver.choose(7)
    with pytest.raises(InputError, match="unknown keyframe 0"):
        driver.move_key(-1, 1.0)


def test_the_length_never_cuts_off_a_key(driver: Driver) -> None:
    put_keys(driver, (0.0, {}), (2.0, {}))
    driver.keyframes.set_length(2.5)
    assert driver.keyframes.timeline.seconds == 2.5
    with pytest.raises(InputError, match=r"the last keyframe is at 2\.00 s"):
        driver.keyframes.set_length(1.0)
    with pytest.raises(InputError, match="600 s"):
        driver.keyframes.set_length(1e9)


def test_a_key_from_a_pose_comes_near_it(driver: Driver, document: Document, starfish: Robot) -> None:
    name = next(iter(starfish.poses))
    driver.seek(1.0)
    words = driver.key_from_pose(name)
    key = document.work.timeline.keys[0]
    found = Simulation(starfish).solve(key.contractions)
    misses = [found.markers[marker] - at for marker, at in starfish.pose(name).targets.items()]
    assert words == f"{name}: marker error {1e3 * np.sqrt(np.mean(np.sum(np.square(misses), axis=1))):.1f} mm rms"
    assert key.time == 1.0


def test_winches_that_stay_keep_what_they_took_in(driver: Driver, document: Document, starfish: Robot) -> None:
    driver.turn("feet", 0.02)
    settle(driver)
    kept = tuple(winch for winch in starfish.winches if winch.name != "left")
    cables = tuple(cable for cable in starfish.cables if cable.winch != "left")
    document.change("delete winch", robot=replace(starfish, winches=kept, cables=cables))
    assert driver.shape().tensions.shape == (len(cables),)
    settle(driver, 9.0)
    assert driver.places() == pytest.approx({"right": 0.0, "feet": 0.02})
    document.undo()
    settle(driver, 19.0)
    assert driver.places() == pytest.approx({"right": 0.0, "left": 0.0, "feet": 0.02})


def test_a_robot_without_cables_stands_still(starfish: Robot) -> None:
    document = Document(Bell())
    document.open(Work(robot=replace(starfish, winches=(), cables=())))
    driver = Driver(document, Jobs(document.bell))
    assert not driver.step(0.0)
    assert not driver.key("space")
    assert driver.commands() == {}
    with pytest.raises(InputError, match="no winches"):
        driver.add_key()


def test_a_winch_is_pulled_in_the_view(driver: Driver, starfish: Robot) -> None:
    assert not driver.grab(Hit(key="marker:tip", world=(0.0, 0.0)))
    assert driver.grab(Hit(key="winch:left", world=(0.0, 0.0)))
    driver.drag(Hit(world=(0.01, -0.03)))
    assert driver.commands()["left"] == pytest.approx(0.03)
    driver.release()
    driver.drag(Hit(world=(0.0, -0.05)))
    assert driver.commands()["left"] == pytest.approx(0.03)


def test_a_table_takes_the_place_of_the_timeline(driver: Driver, document: Document) -> None:
    driver.load_table("wave.csv", b"time_s,left\n0,0\n2,20\n")
    assert driver.table() == b"time_s,right_mm,left_mm,feet_mm\n0,0,0,0\n2,0,20,0\n"
    assert document.undo_label == "import wave.csv"
