"""The page on inverse kinematics: its code runs, and does what the page says."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jaxtyping import config

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """The names that the blocks of code leave behind, run one after the other, and unchecked, as a reader would."""
    blocks = (ROOT / "docs" / "theory" / "inverse.md").read_text().split("```python\n")[1:]
    assert len(blocks) == 5
    names: dict[str, Any] = {"__name__": "page"}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        patch.setattr(config, "jaxtyping_disable", True)
        for block in blocks:
            exec(block.split("```")[0], names)
    return names


@pytest.mark.slow
def test_the_targets_of_the_page_are_reached(page: dict[str, Any]) -> None:
    """Oracle: where the markers are in the pose."""
    place = page["reached"].pose.markers["left"]
    assert np.linalg.norm(place - (-0.103, 0.052)) < 1e-6
    assert page["contractions"].keys() == {"right", "left", "feet"}


@pytest.mark.slow
def test_the_limits_of_the_page_hold(page: dict[str, Any]) -> None:
    """The last one says that two winches are one; no update of the tracker is faster than its rate."""
    contractions = page["found"].pose.contractions
    assert contractions[0] == contractions[1]
    assert page["update"].pose is page["tracker"].pose
    assert page["update"].rms_error < 5e-3


def test_the_objective_of_the_page_levels_two_nodes(page: dict[str, Any]) -> None:
    """Oracle: the heights of these nodes; without the objective they differ by millimeters."""
    nodes = list(page["level"].nodes)
    level, other = (pose.nodes[nodes, 1] for pose in (page["leveled"].pose, page["reached"].pose))
    assert abs(level[0] - level[1]) < 1e-6
    assert abs(other[0] - other[1]) > 1e-3
