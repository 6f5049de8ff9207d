"""Reach as an objective of design. Oracle: `find_workspaces` of the networks that are found, and the wish left out."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.design import Constraints, DesignRequest, Network, RouteOptions, find_network
from hydrostat.errors import InputError
from hydrostat.ik import find_workspaces
from hydrostat.simulation import Simulation


def designed(reach: float) -> Network:
    """A network for a strip whose tip should go up, which one winch does alone."""
    robot = strip_robot(columns=8, rows=3).with_network((), ())
    robot = replace(robot, markers=(*robot.markers, hs.Marker(name="middle", at=(0.1, 0.02))))
    request = DesignRequest(
        poses=(hs.PoseTarget(name="up", targets={"tip": (0.19, 0.03)}),),
        winches=2,
        cables=2,
        options=RouteOptions(workspace_weight=reach, starts=1, exchanges=2, refine_steps=15),
        constraints=Constraints(built_in=False),
    )
    return find_network(robot, request)


def area(network: Network) -> float:
    """What the markers reach, in mean [m^2]."""
    return float(np.mean([one.size for one in find_workspaces(Simulation(network.robot), tension=20.0, count=49)]))


@pytest.mark.slow
def test_a_wish_for_reach_raises_it_and_the_poses_are_still_reached() -> None:
    plain, wide = designed(0.0), designed(1.0)
    assert len(plain.robot.winches) == 1, "the pose alone asks for no more"
    assert area(plain) < 1e-6
    assert area(wide) > 1e-3
    assert wide.rms_error < 1e-3
    assert wide.expected_error < 1.5 * plain.expected_error


@pytest.mark.parametrize("reach", [-0.1, 5.1, float("nan")])
def test_a_wish_out_of_range_is_refused(reach: float) -> None:
    with pytest.raises(InputError, match=r"RouteOptions\.workspace_weight must be"):
        RouteOptions(workspace_weight=reach)
