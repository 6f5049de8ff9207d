"""One judgement in Edit, Design and Export. Oracles: `review_robot`, the places of its findings, reasons of kits."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.design import Severity, review_robot
from hydrostat.fabrication import Demand, KitOptions
from hydrostat.project import Wishes, Work
from hydrostat.robot import Mount, Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.judge import QUIET, Judge
from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName
from hydrostat.studio.view.robot_items import MAX_LABEL_LETTERS, TONES, diagnostic_items
from hydrostat.studio.view.scene_items import Dot, Look

WISHES = Wishes()


@pytest.fixture(scope="module")
def squid() -> Robot:
    """Its winches stand close, two of its cables cross, and one travel is too long."""
    return gallery_robot("squid")


def judged(judge: Judge, robot: Robot, wishes: Wishes = WISHES) -> tuple:
    judge.look(robot, wishes, 0.0)
    judge.look(robot, wishes, QUIET)
    said = judge.of(robot, wishes)
    assert said is not None
    return said


def flags(items: object) -> set[tuple]:
    return {(dot.at, dot.color, dot.about) for dot in items if isinstance(dot, Dot) and dot.look is Look.FLAG}  # type: ignore[attr-defined]


def test_what_is_said_is_the_one_judgement_once_a_robot_rests(squid: Robot) -> None:
    heard: list[Topic] = []
    bell = Bell()
    bell.listen(heard.append)
    judge = Judge(bell)
    judge.look(squid, WISHES, 0.0)
    judge.look(squid, WISHES, QUIET / 2)
    judge.look(squid, WISHES, 2 * QUIET, held=True)
    assert judge.of(squid, WISHES) is None
    assert heard == []
    assert judged(judge, squid) == review_robot(squid, constraints=WISHES.to_constraints(squid))
    assert set(heard) == {Topic.JOB, Topic.SCENE}


def test_other_wishes_and_other_kits_are_judged_anew(squid: Robot) -> None:
    judge = Judge(Bell())
    usual = judged(judge, squid)
    tight = Wishes.of(clearance=0.012)
    assert judge.of(squid, tight) is None
    assert len(judged(judge, squid, tight)) >= len(usual)
    judge.options = KitOptions(motor="25d")
    assert judge.of(squid, WISHES) is None
    strong = judged(judge, squid)
    assert {one.severity for one in strong} > {one.severity for one in usual}
    of_robot = replace(squid, motor="25d")
    judge.options = KitOptions()
    assert {one.text for one in judged(judge, of_robot)} == {one.text for one in strong}
    judge.options = KitOptions()
    assert judge.of(squid, WISHES) == usual


def test_loads_that_a_design_found_and_reasons_of_a_kit_count_for_the_accepted_network_too(squid: Robot) -> None:
    judge = Judge(Bell())
    usual = judged(judge, squid)
    found = Demand.find(replace(squid, poses=dict(list(squid.poses.items())[:1])))
    demand = replace(found, torques=np.full(len(squid.winches), 10.0))
    judge.learn(squid, demand=demand)
    loaded = judged(judge, squid)
    assert loaded == review_robot(squid, demand=demand, constraints=WISHES.to_constraints(squid))
    assert loaded != usual
    again = squid.with_network(squid.winches, squid.cables)
    assert judged(judge, again) == loaded
    judge.learn(squid, refused=("cable[1].points[0] = [0, 80] mm is torn", loaded[0].text))
    told = judged(judge, squid)
    assert told[0].text.endswith("is torn")
    assert told[0].severity is Severity.REFUSED
    assert told[1:] == loaded
    other = squid.with_network(squid.winches, squid.cables[:-1])
    assert all("is torn" not in finding.text for finding in judged(judge, other))


def test_networks_of_a_design_are_weighed_one_after_another(squid: Robot) -> None:
    """Oracle: with a larger motor, and after a kit that was refused, the mark; no network is looked at twice."""
    heard: list[Topic] = []
    bell = Bell()
    bell.listen(heard.append)
    judge = Judge(bell)
    other = squid.with_network(squid.winches[:1], [squid.cables[0]])
    for known in ([False, None], [False, False], [False, False]):
        judge.review_kits([squid, other])
        assert [judge.is_refused(squid), judge.is_refused(other)] == known
    assert heard == [Topic.JOB] * 2
    judge.learn(other, refused=("it is torn",))
    assert judge.is_refused(other) is None
    judge.review_kits([squid, other])
    assert judge.is_refused(other) is True
    judge.options = KitOptions(motor="25d")
    assert judge.is_refused(squid) is None
    judge.review_kits([squid])
    assert judge.is_refused(squid) is True


def test_a_finding_is_chosen_and_let_go(squid: Robot) -> None:
    judge = Judge(Bell())
    first = judged(judge, squid)[0]
    judge.choose(first)
    chosen = [dot for dot in diagnostic_items(squid, judged(judge, squid), judge.chosen) if dot.chosen]  # type: ignore[union-attr]
    assert {dot.at for dot in chosen} == {place.at for place in first.places}  # type: ignore[union-attr]
    judge.choose(first)
    assert judge.chosen is None


def test_a_ring_at_every_place_with_few_words(squid: Robot) -> None:
    said = review_robot(squid, constraints=WISHES.to_constraints(squid))
    dots = diagnostic_items(squid, said)
    expected = {(place.at, TONES[one.severity], place.part) for one in said for place in one.places}
    assert flags(dots) == expected
    assert all(0 < len(dot.label) <= MAX_LABEL_LETTERS + 2 and dot.key == "" for dot in dots)  # type: ignore[union-attr]
    outside = squid.with_network([replace(squid.winches[0], mount=Mount.WORLD), *squid.winches[1:]], squid.cables)
    loose = {dot.about for dot in diagnostic_items(outside, said) if not dot.stuck}  # type: ignore[union-attr]
    assert loose <= {f"winch:{squid.winches[0].name}"}


def test_edit_design_and_export_mark_the_same(squid: Robot) -> None:
    session = Session()
    session.document.open(Work(robot=squid))
    seen = {}
    for name in (StageName.EDIT, StageName.DESIGN, StageName.EXPORT):
        stage = session.stages[name]
        stage.step(0.0)
        stage.step(2 * QUIET)
        seen[name] = flags(stage.scene_items())
    said = session.document.judge.of(squid, session.document.work.wishes)
    assert said
    expected = {(place.at, TONES[one.severity], place.part) for one in said for place in one.places}
    assert seen == dict.fromkeys(seen, expected)
    session.close()
