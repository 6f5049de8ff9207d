"""Tips of limbs of drawings. Oracle: the places where the limbs were drawn to end."""

import numpy as np
import pytest
from builders import box_mesh

from hydrostat.robot import sketch_robot
from hydrostat.robot.limb_tips import name_tips

CROSS = "M-60,-8 H-8 V-40 H8 V-8 H60 V8 H8 V40 H-8 V8 H-60 Z"
COMB = "M0,0 H100 V60 H80 V20 H60 V60 H40 V20 H20 V60 H0 Z"
DISC = "M-40,0 A40,40 0 1 0 40,0 A40,40 0 1 0 -40,0 Z"


@pytest.mark.parametrize(
    ("path", "tips"),
    [
        (CROSS, {"left": (-60, 0), "right": (60, 0), "top": (0, 40), "bottom": (0, -40)}),
        (COMB, {"lower left": (10, -60), "bottom": (50, -60), "lower right": (90, -60)}),
        (DISC, {"tip": (0, 0)}),
    ],
    ids=["cross", "comb", "disc"],
)
def test_each_limb_has_a_marker_at_its_tip(path: str, tips: dict[str, tuple[float, float]]) -> None:
    drawing = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="400mm" viewBox="-200 -200 400 400"><path d="{path}"/></svg>'
    )
    robot = sketch_robot(drawing.encode(), file="body.svg", name="limbs", thickness=0.02)
    assert {marker.name for marker in robot.markers} == set(tips)
    pairs = {CROSS: ("left", "right"), COMB: ("lower left", "lower right")}  # that mirror each other bend together
    bent = pairs.get(path, ("tip",))
    stay = [marker for marker in robot.markers if marker.name not in bent]
    targets = robot.pose("bend").targets
    assert all(np.linalg.norm(np.subtract(targets[name], robot.marker(name).at)) > 0.01 for name in bent)
    assert all(targets.get(marker.name, marker.at) == marker.at for marker in stay)
    if path == DISC:
        return
    nodes = robot.body.mesh.nodes
    left = -60 if path == CROSS else 0
    drawn = 1e-3 * (np.array(list(tips.values())) - [left, min(y for _, y in tips.values())])
    found = np.array([robot.marker(name).at for name in tips]) - nodes.min(axis=0)
    assert np.abs(found - drawn).max() < 0.012


def test_twins_have_numbers_from_the_left() -> None:
    cube = box_mesh((1, 1, 1), size=(1e-9, 1e-9, 1e-9))
    tips = np.array([[0.02, -1.0, 5.0], [-0.02, -1.0, 5.0], [4.0, 0.0, -5.0], [-2.0, 0.0, 0.0]])
    assert name_tips(cube, tips) == ["top 2", "top 1", "lower right", "left"]
    assert name_tips(cube, tips[:1]) == ["tip"]


def test_halves_that_mirror_each_other_have_the_same_numbers() -> None:
    """Oracle: the mirror, by which left and right change places and numbers stay."""
    cube = box_mesh((1, 1, 1), size=(1e-9, 1e-9, 1e-9))
    left = np.array([[-3.0, -2.0, 0.0], [-2.0, -2.5, 0.0]])
    names = name_tips(cube, np.concatenate([left, left * [-1, 1, 1]]))
    assert names == ["lower left 1", "lower left 2", "lower right 1", "lower right 2"]
