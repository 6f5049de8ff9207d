"""More cables allowed leave no larger error. Oracle: networks made by hand, of a search that finds more with fewer."""

from dataclasses import replace
from importlib import import_module

import pytest
from plot.designs import plain_network

from hydrostat.design import DesignRequest, Network, design_cables
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot


@pytest.mark.parametrize(("with_fewer", "kept"), [(0.5, 0.5), (2.0, 1.0), (None, 1.0)])
def test_the_better_of_more_and_fewer_cables(
    with_fewer: float | None, kept: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain, asked = plain_network(), []

    def search(robot: Robot, request: DesignRequest, **_: object) -> Network:
        asked.append((request.winches, request.cables))
        share = 1.0 if request.cables == 6 else with_fewer
        if share is None:
            raise HydrostatError("no network can be built")
        return replace(plain, request=request, expected_error=share * plain.expected_error)

    module = import_module("hydrostat.design.cable_design")
    monkeypatch.setattr(module, "design_routes", search)
    monkeypatch.setattr(module, "kit_fits", lambda network: True)
    found = design_cables(plain.source, plain.request.poses, winches=2, cables=6)
    assert asked == [(2, 6), (2, 2)]
    assert found.expected_error == kept * plain.expected_error
    assert found.request.cables == 6
    asked.clear()
    assert (
        design_cables(plain.source, plain.request.poses, winches=2, cables=6, seconds=5.0).expected_error
        == plain.expected_error
    )
    assert asked == [(2, 6)]
