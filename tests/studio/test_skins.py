"""Whether a skin can be sewn, told beside all else. Oracles: `Sewing.find` here, what `hydrostat check` prints."""

import threading
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, mesh_body

from hydrostat.design import Severity
from hydrostat.fabrication import KitOptions, Sewing
from hydrostat.geometry import Mesh
from hydrostat.project import Work
from hydrostat.robot import MATERIALS, Pin, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.judge import QUIET
from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName


@pytest.fixture
def session() -> Iterator[Session]:
    made = Session()
    yield made
    made.close()


@pytest.fixture
def settle(session: Session) -> Callable[[Robot], None]:
    """Waits until the skin of a robot is known."""
    rung = threading.Condition()

    def hear(topic: Topic) -> None:
        with rung:
            rung.notify_all()

    def wait(robot: Robot) -> None:
        def known() -> bool:
            skin = session.document.judge.skin(robot)
            return skin is not None and not skin.is_awaited

        with rung:
            assert rung.wait_for(known, timeout=300)

    session.bell.listen(hear)
    return wait


def ring() -> Robot:
    """A stuffed square with a hole through it, which no cloth can be cut for."""
    mesh = box_mesh((3, 3, 1), size=(0.09, 0.09, 0.03))
    middle = np.abs(mesh.nodes[mesh.elements].mean(axis=1)[:, :2] - 0.045).max(axis=1) < 0.015
    used, elements = np.unique(mesh.elements[~middle], return_inverse=True)
    body = mesh_body(Mesh(mesh.nodes[used], elements.reshape(-1, 4)), material=MATERIALS["polyester fibre"])
    return Robot(name="ring", body=body, pins=(Pin(at=(0.0, 0.0, 0.0), radius=0.2),), winches=(), cables=(), poses={})


def test_a_skin_that_cannot_be_sewn_is_told_in_all_lists_and_in_the_words_of_check(
    session: Session, settle: Callable[[Robot], None], capsys: pytest.CaptureFixture
) -> None:
    robot = ring()
    session.document.open(Work(robot=robot))
    judge, wishes = session.document.judge, session.document.work.wishes
    session.go(StageName.EDIT)
    session.step(0.0)
    session.step(2 * QUIET)
    skin = judge.skin(robot)
    assert skin is not None
    first = judge.of(robot, wishes)
    assert first is not None, "the rest is told while the skin is laid flat"
    settle(robot)
    problems = Sewing.find(robot.body).problems
    assert len(problems) > 0
    said = judge.of(robot, wishes)
    assert said is not None
    assert [(one.text, one.severity) for one in said[: len(problems)]] == [
        (text, Severity.REFUSED) for text in problems
    ]
    assert said[len(problems) :] == first
    judge.learn(robot, refused=problems)
    judge.look(robot, wishes, 0.0)
    judge.look(robot, wishes, 2 * QUIET)
    told = judge.of(robot, wishes)
    assert told is not None
    assert sorted(one.text for one in told) == sorted(one.text for one in said), "a kit that was refused says it too"
    assert all("sewn" not in note.text for note in session.notes)
    judge.skins.look(gallery_robot("starfish").body, KitOptions())
    assert judge.skins.of(gallery_robot("starfish").body, KitOptions()) is None, "a flat body has a flat pattern"


def test_where_no_list_is_shown_a_note_tells_it_once(session: Session, settle: Callable[[Robot], None]) -> None:
    robot = ring()
    session.document.open(Work(robot=robot))
    session.go(StageName.POSE)
    session.document.judge.skins.look(robot.body, KitOptions())
    settle(robot)
    session.step(0.0)
    session.step(1.0)
    assert [note.text for note in session.notes if Sewing.find(robot.body).problems[0] in note.text] == [
        f"skin cannot be sewn: {Sewing.find(robot.body).problems[0]}"
    ]


@pytest.mark.slow
def test_a_bear_can_be_sewn(session: Session, settle: Callable[[Robot], None], capsys: pytest.CaptureFixture) -> None:
    robot = gallery_robot("bear")
    judge = session.document.judge
    judge.skins.look(robot.body, judge.options)
    skin = judge.skin(robot)
    assert skin is not None
    assert skin.words == "Flattening the skin, patch by patch …"
    settle(robot)
    skin = judge.skin(robot)
    assert skin is not None
    assert (skin.words, skin.findings) == (f"skin: {Sewing.find(robot.body)}", ())
    assert judge.skin(gallery_robot("starfish")) is None
