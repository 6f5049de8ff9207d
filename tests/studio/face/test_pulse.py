"""The thread that lets a session work. The oracle is a stage that counts its steps."""

import time
from threading import Event

import pytest
from builders import gallery_robot

from hydrostat.project import Work
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.pulse import LONG_STEP, MIN_STEP, Pulse
from hydrostat.studio.jobs import Slots
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit, Stage, StageName
from hydrostat.studio.view.picture import Shown
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape


class Busy(Stage):
    """Always has more to do, and rings with every step, as players do."""

    def __init__(self, session: Session) -> None:
        self.session, self.steps, self.enough = session, 0, Event()
        self.fails = False

    def shape(self) -> RobotShape:
        return rest_shape(self.session.document.robot)

    def scene_items(self) -> list[SceneItem]:
        return robot_items(self.session.document.robot)

    def grab(self, hit: Hit) -> bool:
        return True

    def step(self, now: float) -> bool:
        self.steps += 1
        self.session.bell.ring(Topic.SHAPE)
        if self.steps >= 12:
            self.enough.set()
        if self.fails:
            raise ZeroDivisionError("a slip")
        return True


@pytest.fixture
def session() -> Session:
    made = Session()
    made.document.open(Work(robot=gallery_robot("starfish")))
    made.stages = {name: Busy(made) for name in StageName}
    made.go(StageName.POSE)
    return made


def test_work_without_end_does_not_spin(session: Session) -> None:
    stage, shown = session.current, list[Shown]()
    assert isinstance(stage, Busy)
    pulse = Pulse(session, shown.append)
    begun = time.monotonic()
    pulse.start()
    assert stage.enough.wait(60.0)
    took = time.monotonic() - begun  # a busy machine only makes it longer
    steps = stage.steps
    pulse.stop()
    assert steps <= took / MIN_STEP + 2
    assert shown


def test_a_drag_that_waits_is_stepped_at_once(session: Session) -> None:
    session.grab("a", Hit(key="body", world=(0.0, 0.0)), 1.0)
    assert session.waiting
    session.step(0.0)
    assert not session.waiting
    session.drag("a", Hit(world=(0.0, 0.0)), 2.0)
    assert session.waiting


def test_what_changes_is_shown_while_a_step_takes_long(session: Session) -> None:
    class Compiling(Busy):
        def step(self, now: float) -> bool:
            self.enough.set()
            return not done.wait(60.0)

    done, shown = Event(), list[Shown]()
    stage = Compiling(session)
    session.stages = dict.fromkeys(StageName, stage)
    pulse = Pulse(session, shown.append)
    pulse.start()
    assert stage.enough.wait(60.0)
    try:
        for stamp in range(1, 4):
            before = len(shown)
            session.grab("a", Hit(key="body", world=(0.0, 0.0)), float(stamp))
            while len(shown) == before and not done.is_set():
                time.sleep(0.01)
        assert session.answered == 0.0  # the step is not over: nothing of it is told as answered
    finally:
        done.set()
        pulse.stop()


@pytest.mark.slow
def test_a_stage_that_stumbles_does_not_end_the_studio(session: Session, caplog: pytest.LogCaptureFixture) -> None:
    stage = session.current
    assert isinstance(stage, Busy)
    stage.fails = True
    pulse = Pulse(session, lambda shown: None)
    pulse.start()
    while stage.steps < 3:
        time.sleep(0.01)
    stage.fails = False
    assert stage.enough.wait(60.0)
    pulse.stop()
    assert any("internal error" in note.text for note in session.notes)
    assert "a slip" in caplog.text


def test_drags_of_all_rooms_take_turns(session: Session) -> None:
    """While another room has the only turn nothing is computed here; then the picture says that one came before."""
    stage, turns = session.current, Slots(1)
    assert isinstance(stage, Busy)
    assert turns.wait(lambda: False, print)
    seen = list[int]()
    pulse = Pulse(session, lambda _: seen.append(session.before), turns)
    pulse.start()
    time.sleep(3 * LONG_STEP)
    assert stage.steps == 1
    turns.give()
    assert stage.enough.wait(60.0)
    pulse.stop()
    assert set(seen) == {0, 1}
    assert turns.wait(lambda: True, print), "a turn was not given back"
