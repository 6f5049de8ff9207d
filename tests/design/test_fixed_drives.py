"""Designs of robots with drives. Oracles: the search without them, a forward solve with them at rest."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design import RouteOptions, design_cables, find_lifts, score_card
from hydrostat.robot import Load, LoadDrive, PinDrive, PoseTarget
from hydrostat.simulation import Simulation

SMALL = RouteOptions(starts=1, exchanges=0, refine_steps=2, trials=1, steps=1, max_edges=5)


@pytest.mark.slow
def test_drives_stay_at_rest_in_a_search_and_come_back(unchecked: None) -> None:
    still = strip_robot(columns=10, rows=3).with_network((), ())
    driven = replace(
        still,
        pins=tuple(replace(pin, drive="servo") for pin in still.pins),
        loads=(Load(name="push", marker="tip", force=(0.0, 0.5), drive="thumb"),),
        drives=(PinDrive(name="servo", at=(0.0, 0.0)), LoadDrive(name="thumb", min=0.0, max=1.0)),
    )
    pose = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})
    found, plain = (design_cables(one, [pose], winches=1, cables=1, options=SMALL) for one in (driven, still))
    assert found.robot.cables == plain.robot.cables
    assert (found.robot.pins, found.robot.loads, found.robot.drives) == (driven.pins, driven.loads, driven.drives)
    (reached,) = found.ik_results
    again = Simulation(found.robot).solve(reached.pose.controls)
    np.testing.assert_allclose(again.nodes, reached.pose.nodes, atol=1e-8)
    assert score_card(found, version="test")["winches"] == score_card(plain, version="test")["winches"]
    mirrored = PoseTarget(name="down", targets={"tip": (0.18, -0.02)})
    both = replace(found, request=replace(found.request, poses=(pose, mirrored)), expected_error=1.0)
    lifts = find_lifts(both)
    assert lifts
    assert all(lift.network.robot.drives == driven.drives for lift in lifts)
