"""The page on routes: its code runs, and does what the page says."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jaxtyping import config

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.constraints_file import read_constraints
from hydrostat.design.region import Region
from hydrostat.robot import load_robot

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The names that the blocks of code leave behind, run one after the other, and unchecked, as a reader would."""
    blocks = (ROOT / "docs" / "theory" / "routes.md").read_text().split("```python\n")[1:]
    assert len(blocks) == 6
    folder = tmp_path_factory.mktemp("page")
    (folder / "examples").symlink_to(ROOT / "examples")
    names: dict[str, Any] = {"__name__": "page"}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(config, "jaxtyping_disable", True)
        for block in blocks:
            exec(block.split("```")[0], names)
    names["folder"] = folder
    return names


def test_the_designs_of_the_page_are_what_was_asked_for(page: dict[str, Any]) -> None:
    """Oracle: counts, and the error that the markers of the poses give."""
    network = page["network"]
    assert len(network.robot.winches) == 2
    assert 2 <= len(network.robot.cables) <= 4
    squares = [
        np.mean(
            [np.sum((reached.pose.markers[name] - goal) ** 2) for name, goal in reached.pose_target.targets.items()]
        )
        for reached in network.ik_results
    ]
    assert network.rms_error == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-6)
    assert network.rms_error < network.expected_error < 1e-2
    assert (page["folder"] / "build" / "designed_starfish" / "robot.toml").exists()


def test_the_proposal_of_the_page_can_be_built(page: dict[str, Any]) -> None:
    proposal = page["proposal"]
    assert proposal.is_refined
    assert proposal.is_buildable
    limits = Constraints()
    assert violations(proposal.robot, limits, Region.of_body(proposal.robot.body, limits.clearance)) == []


def test_the_constraints_of_the_page_hold(page: dict[str, Any]) -> None:
    """Oracle: `violations`, and the largest tension."""
    robot, constraints, bounded = page["robot"], page["constraints"], page["bounded"]
    region = Region.of_body(robot.body, constraints.clearance)
    assert violations(bounded.robot, constraints, region) == []
    assert max(reached.pose.tensions.max() for reached in bounded.ik_results) <= 15.0 * 1.001


def test_what_is_locked_on_the_page_stays(page: dict[str, Any]) -> None:
    """And the rest is better than by hand: 5.66 mm."""
    assert page["robot"].cables[0] in page["improved"].robot.cables
    assert page["improved"].rms_error < 5e-3


def test_the_fewest_winches_of_the_page_keep_their_tolerance(page: dict[str, Any]) -> None:
    """Oracle: the error of each pose."""
    assert all(reached.rms_error <= 6e-3 for reached in page["fewest"].ik_results)
    assert page["fewest"].alternatives


def test_the_price_on_the_page_is_what_a_weak_cable_does(page: dict[str, Any]) -> None:
    """Oracle: the equilibrium of the pulled robot."""
    real, priced = page["moved"] / page["pose"].tensions[0], page["best"].moves
    assert np.linalg.norm(real - priced) < 0.05 * np.linalg.norm(priced)


def test_the_file_of_constraints_on_its_page_is_read(tmp_path: Path) -> None:
    """Oracle: what its comments say."""
    section = (ROOT / "docs" / "constraints.md").read_text()
    path = tmp_path / "constraints.toml"
    path.write_text(section.split("```toml\n")[1].split("```")[0])
    read = read_constraints(path, load_robot(ROOT / "examples" / "starfish"))
    assert (read.clearance, read.max_turn, read.slack, read.spool_ratio) == pytest.approx((0.006, 60.0, 0.010, 2.0))
    assert (read.locked_winches, read.locked_cables, read.mirror) == (("left",), ("left 1",), "x")
    assert [len(zones) for zones in (read.winch_zones, read.keep_out, read.passive_zones)] == [1, 1, 1]
