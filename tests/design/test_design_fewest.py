"""The fewest winches. Oracle: the tolerance, fewer winches asked for by themselves, no other front is better."""

from dataclasses import replace
from functools import cache

import pytest
from builders import strip_robot
from test_design_routes import DOWN, SMALL, UP, Stopped, bare, broken

from hydrostat.design import Constraints, DesignStage, Network, design_cables
from hydrostat.design.request import RouteOptions
from hydrostat.errors import HydrostatError
from hydrostat.fabrication import Demand, find_refusals

TOLERANCE = 8e-3


def options(tolerance: float = TOLERANCE) -> RouteOptions:
    return replace(SMALL, tolerance=tolerance)


@cache
def fewest(tolerance: float = TOLERANCE) -> Network:
    return design_cables(bare(), [UP, DOWN], winches="auto", cables=3, options=options(tolerance))


@cache
def out_of_reach() -> tuple[Network, list[DesignStage]]:
    """The best network where none is within the tolerance, and what was told on the way."""
    told: list[DesignStage] = []
    asked = options(1e-9)
    return design_cables(bare(), [UP, DOWN], winches="auto", cables=2, options=asked, watch=told.append), told


@pytest.mark.slow
def test_every_pose_is_within_the_tolerance(unchecked: None) -> None:
    network = fewest()
    assert network.complete
    assert max(reached.rms_error for reached in network.ik_results) <= TOLERANCE
    assert broken(network) == []
    assert network.request.options == options()


@pytest.mark.slow
def test_fewer_winches_miss_it(unchecked: None) -> None:
    count = len(fewest().robot.winches)
    assert count == 2
    one = design_cables(bare(), [UP, DOWN], winches=1, cables=3, options=options())
    assert max(reached.rms_error for reached in one.ik_results) > TOLERANCE


@pytest.mark.slow
def test_the_front_holds_every_size_once(unchecked: None) -> None:
    network = fewest()
    counts = [(len(one.robot.winches), len(one.robot.cables)) for one in network.alternatives]
    assert counts == sorted(set(counts))
    assert {winches for winches, _ in counts} == {1, 2}
    assert min(one.rms_error for one in network.alternatives) <= network.rms_error * (1 + 1e-12)
    assert (len(network.robot.winches), len(network.robot.cables)) in counts


@pytest.mark.slow
def test_a_tolerance_out_of_reach_gives_the_best(unchecked: None) -> None:
    network, _ = out_of_reach()
    assert network.complete
    fitting = [
        one
        for one in network.alternatives
        if not find_refusals(one.robot, Demand.of_results(one.robot, one.ik_results))
    ]
    assert network.expected_error == pytest.approx(min(one.expected_error for one in fitting))


@pytest.mark.slow
def test_told_is_only_what_beats_fewer_winches(unchecked: None) -> None:
    _, told = out_of_reach()
    errors = [stage.error for stage in told]
    assert errors == sorted(set(errors), reverse=True)
    assert {len(stage.robot.winches) for stage in told} == {1, 2}


def test_locked_winches_count(unchecked: None) -> None:
    own = strip_robot(columns=10, rows=3)
    limits = Constraints(locked_winches=("up", "down"))
    network = design_cables(own, [UP, DOWN], winches="auto", cables=2, constraints=limits, options=options(1.0))
    assert network.robot.winches == own.winches


@pytest.mark.parametrize("at", [1, 5, 9])
def test_ctrl_c_keeps_what_was_found(at: int, unchecked: None) -> None:
    """Whenever it comes, but before the first network."""
    stopped = Stopped(at)
    try:
        network = design_cables(bare(), [UP, DOWN], winches="auto", cables=2, options=options(1e-9), progress=stopped)
    except KeyboardInterrupt:
        assert at == 1
        return
    assert not network.complete
    assert broken(network) == []


@pytest.mark.slow
def test_a_number_of_winches_that_cannot_be_built_is_passed_over(unchecked: None) -> None:
    """Two winches 160 mm apart find room on the strip; three do not."""
    limits = Constraints(winch_gap=0.16)
    network = design_cables(bare(), [UP, DOWN], winches="auto", cables=3, constraints=limits, options=options(1e-9))
    assert broken(network) == []
    with pytest.raises(HydrostatError):
        design_cables(bare(), [UP], winches="auto", cables=2, constraints=Constraints(max_length=0.003), options=SMALL)
