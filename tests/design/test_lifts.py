"""What would leave less error. Oracle: proposals made by hand, of which some are clearly better and can be built."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from plot.designs import plain_network

from hydrostat.design import DesignRequest, Network, find_lifts
from hydrostat.design.lifts import CROSSING_LINE, search_front
from hydrostat.design.routes.quick_search import RouteProposal
from hydrostat.errors import HydrostatError
from hydrostat.ik import solve_ik
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation


def test_a_winch_that_hardly_helps_is_named() -> None:
    """Oracle: of two winches that pull the same cable one is enough; the strip without either bends down only."""
    plain = plain_network()
    up, down = plain.robot.winches
    same = [replace(cable, winch="twin", name="twin") for cable in plain.robot.cables if cable.winch == up.name]
    robot = plain.robot.with_network([up, replace(up, name="twin"), down], [*plain.robot.cables, *same])
    reached = solve_ik(Simulation(robot), plain.request.poses[0])
    network = replace(plain, robot=robot, ik_results=(reached,))
    assert {up.name, "twin"} <= set(network.idle_winches)
    assert network.idle_winches["twin"] == pytest.approx(network.rms_error, abs=1e-4)
    both = replace(network, robot=plain.robot, ik_results=(solve_ik(Simulation(plain.robot), reached.target),))
    assert up.name not in both.idle_winches
    alone = plain.robot.with_network([up], [cable for cable in plain.robot.cables if cable.winch == up.name])
    assert replace(network, robot=alone).idle_winches == {}


def test_clear_gains_that_can_be_built_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = plain_network()
    poses = (*plain.request.poses, replace(plain.request.poses[0], name="again"))
    network = replace(plain, request=replace(plain.request, poses=poses, winches=1, cables=3))
    asked = []

    def answer(more: float, both: float, *, fits: bool = True) -> None:
        def propose(robot: Robot, request: DesignRequest) -> Iterator[RouteProposal]:
            asked.append((request.winches, request.cables, request.constraints.two_way))
            built = network.expected_error * (both if request.constraints.two_way else more)
            yield RouteProposal(
                robot=robot, error=0.0, expected_error=0.1 * built, is_refined=False, is_buildable=False
            )
            solved = network.ik_results
            yield RouteProposal(
                robot=robot, error=0.0, expected_error=built, is_refined=True, is_buildable=fits, ik_results=solved
            )

        monkeypatch.setattr("hydrostat.design.lifts.propose_routes", propose)

    answer(0.5, 0.9)
    (lift,) = find_lifts(network)
    assert (lift.words, lift.network.expected_error) == ("--winches 2 --cables 4", 0.5 * network.expected_error)
    assert lift.network.ik_results == network.ik_results
    assert asked == [(2, 4, False), (1, 3, True)]
    answer(0.9, 0.5)
    assert [lift.words for lift in find_lifts(network)] == ["--two-way"]
    answer(0.5, 0.5, fits=False)
    assert find_lifts(network) == ()
    answer(0.5, 0.5)
    enough = replace(network, request=replace(network.request, winches=len(poses)))
    assert [lift.words for lift in find_lifts(enough)] == [CROSSING_LINE]
    assert find_lifts(replace(enough, expected_error=1e-4)) == ()
    monkeypatch.setattr("hydrostat.design.lifts.propose_routes", refuse)
    assert find_lifts(network) == ()


def test_whole_searches_for_other_winches_are_alternatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: counts and kinds by hand; refused kits and failed searches are left out, a stop ends them."""
    plain = plain_network()
    poses = tuple(replace(plain.request.poses[0], name=name) for name in ("one", "two", "three"))
    request = replace(plain.request, poses=poses, winches=2, cables=3, front=True)
    network = replace(plain, alternatives=())
    asked: list[tuple[int, int, bool, bool]] = []
    monkeypatch.setattr("hydrostat.design.lifts.kit_fits", lambda other: len(asked) != 2)

    def design(changed: DesignRequest) -> Network:
        asked.append((changed.winches, changed.cables, changed.constraints.two_way, changed.front))
        if len(asked) == 1:
            raise HydrostatError("no room for this motor")
        return replace(plain, expected_error=0.001 * len(asked), num_evaluated=5)

    found = search_front(network, request, design)
    assert asked == [(w, c, two, False) for w, c, two in [(1, 3, False), (1, 3, True), (2, 3, True), (3, 4, False)]]
    assert [other.expected_error for other in found.alternatives] == [0.003, 0.004]
    assert (found.complete, found.num_evaluated) == (True, network.num_evaluated + 15)

    def stop(_: DesignRequest) -> Network:
        raise KeyboardInterrupt

    assert not search_front(network, request, stop).complete


def refuse(*_: object) -> None:
    raise HydrostatError("no room for 2 motors")
