"""Networks that Design has found outlive a crash of the studio. Oracle: those that were found, number by number."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrostat.design import Alternative
from hydrostat.errors import InputError
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot, save_robot
from hydrostat.simulation import Simulation
from hydrostat.studio.designing import cards_file
from hydrostat.studio.designing.cards_file import cards_content, read_cards
from hydrostat.studio.designing.design_work import DesignsFound, solution
from hydrostat.studio.designing.run import DesignRun, starting_robot, wished_request
from hydrostat.studio.session import Session


def found_by(session: Session, robot: Robot) -> None:
    """The robot's own network and one with half of its cables are what a design has found."""
    designer, few = session.designer, robot.with_network(robot.winches[:1], [robot.cables[0]])
    request = wished_request(robot, Wishes())
    designer.run = DesignRun(robot=robot, request=request, began=0.0, rest=0.0, best=starting_robot(robot, request))
    once = IKOptions(restarts=0)
    pose = next(iter(robot.poses.values()))
    made = [
        Alternative(robot=one, ik_results=(solve_ik(Simulation(one), pose, options=once),), expected_error=0.004)
        for one in (robot, few)
    ]
    designer._on_found(
        DesignsFound(solutions=tuple(solution(one, 0.09) for one in made), num_evaluated=2, complete=True)
    )


@pytest.fixture
def crashed(starfish: Robot, tmp_path: Path, unchecked: None) -> Iterator[Session]:
    """A studio that has a robot which is saved, has found networks, and is no more."""
    save_robot(starfish, tmp_path / "robot")
    session = Session(tmp_path / "state")
    session.document.open(Work(robot=starfish), folder=tmp_path / "robot")
    found_by(session, starfish)
    autosave = session.starter.autosave
    autosave.step(0.0)
    autosave.step(10.0)
    if autosave._writer is not None:
        autosave._writer.join()
    assert autosave._held is not None
    autosave._held.let_go()
    yield session
    session.close()


def test_cards_come_back_with_their_poses_and_loads(crashed: Session, tmp_path: Path) -> None:
    session = Session(tmp_path / "state")
    (left,) = session.starter.autosave.find_recovered()
    session.starter.autosave.restore(left)
    before, after = crashed.designer.candidates, session.designer.candidates
    assert len(after) == len(before) == 2
    for old, new in zip(before, after, strict=True):
        assert (new.robot.winches, new.robot.cables, new.robot.face) == (
            old.robot.winches,
            old.robot.cables,
            old.robot.face,
        )
        assert (new.error, new.expected_error, new.craft, new.complete) == (
            old.error,
            old.expected_error,
            old.craft,
            old.complete,
        )
        assert new.reaches[0].pose == old.reaches[0].pose
        assert (new.reaches[0].errors, new.reaches[0].places) == (old.reaches[0].errors, old.reaches[0].places)
        np.testing.assert_array_equal(new.reaches[0].nodes, old.reaches[0].nodes)
        np.testing.assert_array_equal(new.reaches[0].contractions, old.reaches[0].contractions)
        np.testing.assert_array_equal(new.demand.torques, old.demand.torques)
        np.testing.assert_array_equal(new.demand.taken, old.demand.taken)
        assert new.torque == old.torque == 0.09
    assert session.designer.outcome == "2 networks restored from an earlier session"
    session.designer.show(after[1].number, after[1].reaches[0].pose.name)
    session.designer.accept()
    assert len(session.document.robot.cables) == 1
    session.document.undo()
    session.close()
    (again,) = session.starter.autosave.find_recovered()
    assert (again.folder / "designs.json").is_file(), "what was restored is not saved yet"


def test_the_kit_of_an_accepted_network_keeps_to_the_torque_of_its_design(
    crashed: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: the torque limit that the design kept; a lower one of the settings counts, a higher one does not."""
    asked = list[float | None]()
    monkeypatch.setattr(crashed.exporter._jobs, "start", lambda *told, **_: asked.append(told[3].torque))
    few = crashed.designer.candidates[1]
    crashed.designer.show(few.number, few.reaches[0].pose.name)
    crashed.designer.accept()
    for torque in (None, 0.05, 0.2):
        wishes = crashed.document.work.wishes
        constraints = replace(wishes.constraints, torque=torque)
        crashed.document.change("torque", wishes=replace(wishes, constraints=constraints))
        crashed.exporter.busy = None
        crashed.exporter.make_kit()
    assert asked == [0.09, 0.05, 0.09]


def test_a_studio_that_ends_well_leaves_no_cards_of_saved_work(crashed: Session, tmp_path: Path) -> None:
    (left,) = crashed.starter.autosave.find_recovered()
    assert left.origin == tmp_path / "robot"
    crashed.close()
    assert crashed.starter.autosave.find_recovered() == []


def test_cards_of_another_body_damaged_ones_and_too_many(
    crashed: Session, starfish: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = crashed.document.designs
    moved = replace(starfish.body.mesh, nodes=starfish.body.mesh.nodes * 1.001)
    assert read_cards(content, replace(starfish, body=replace(starfish.body, mesh=moved))) == []
    assert len(read_cards(content, starfish)) == 2
    for damaged in (b"{}", content[:-9], content.replace(b'"built":0.004', b'"built":"x"', 1)):
        with pytest.raises(InputError, match="networks from an earlier session cannot be read"):
            read_cards(damaged, starfish)
    monkeypatch.setattr(cards_file, "MAX_BYTES", len(content) - 200)
    assert len(read_cards(cards_content(crashed.designer.candidates), starfish)) == 1, "the best is kept"
    crashed.designer.clear()
    assert crashed.document.designs == b""
