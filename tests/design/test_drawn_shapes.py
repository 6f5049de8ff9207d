"""Cables leave drawn shapes free. Oracle: distances from circles and lines that are drawn here."""

import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import shapely
from builders import strip_robot
from plot.designs import plain_network

from hydrostat.design import (
    Constraints,
    DesignRequest,
    find_lifts,
    find_network,
    find_pinned_drawings,
    review_robot,
    violations,
)
from hydrostat.design.drawn_shapes import drawn_zones
from hydrostat.design.lifts import CROSSING
from hydrostat.design.routes.quick_search import RouteProposal, propose_routes
from hydrostat.design.skin_region import cable_region
from hydrostat.errors import HydrostatError
from hydrostat.robot import Pin, PoseTarget, Robot

GAP = Constraints.drawing_gap


def ring(x: float, y: float, radius: float) -> np.ndarray:
    turns = np.linspace(0.0, 2 * np.pi, 60)
    return np.array([x, y]) + radius * np.column_stack([np.cos(turns), np.sin(turns)])


def drawn_strip(*marks: np.ndarray) -> Robot:
    robot = strip_robot()
    return replace(robot, winches=(), cables=(), body=replace(robot.body, marks=marks))


def test_small_shapes_are_zones_and_large_ones_are_not() -> None:
    """An eye with its pupil is one disc, a mouth a zone all round its line, a belly of 80 mm none."""
    mouth = np.array([[0.05, -0.02], [0.06, -0.01], [0.07, -0.02]])
    body = drawn_strip(ring(0.1, 0.0, 0.008), ring(0.102, 0.0, 0.004), mouth, ring(0.1, 0.0, 0.04)).body
    zones = drawn_zones(body, GAP)
    (eye,) = [zone for zone in zones if zone.radius]
    assert eye.at == pytest.approx((0.1, 0.0), abs=1e-5)
    assert eye.radius == pytest.approx(0.008 + GAP, abs=3e-5)
    (other,) = [zone for zone in zones if zone.outline]
    along = shapely.get_coordinates(shapely.segmentize(shapely.LineString(mouth), 1e-3))
    assert other.distances(along).max() < -(GAP - 3e-4)
    assert other.distances(along).min() > -2 * GAP - 0.01
    assert drawn_zones(body, 0.0) == ()


def test_proposals_run_round_an_eye(unchecked: None) -> None:
    """Without the eye a cable runs where it is drawn; distances are those of the cable's own line from its middle."""
    at = (0.1, 0.016)
    pose = PoseTarget(name="up", targets={"tip": (0.17, 0.08)})
    request = DesignRequest(poses=(pose,), winches=1, cables=1, constraints=Constraints(built_in=False))

    def nearest(robot: Robot, request: DesignRequest) -> tuple[float, Robot]:
        made = list(propose_routes(robot, request))[-1].robot
        lines = [shapely.LineString(cable.points) for cable in made.cables]
        return min(line.distance(shapely.Point(at)) for line in lines), made

    robot = drawn_strip(ring(at[0], at[1], 0.004))
    crossing = replace(request, constraints=replace(request.constraints, drawing_gap=0.0))
    close, across = nearest(robot, crossing)
    assert close < 0.004
    assert nearest(robot, request)[0] > 0.004 + GAP - 1e-5
    fitted = request.fit_robot(robot)
    assert fitted.fit_robot(robot).constraints.keep_out == fitted.constraints.keep_out
    told = violations(across, fitted.constraints, cable_region(robot.body, fitted.constraints))
    assert any("within drawing_gap of a drawn shape" in text for text in told)


def test_shapes_in_the_way_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a design that fails, and of one that misses by much, if a search without them does better."""
    plain = plain_network()
    eyes = replace(plain.source, body=replace(plain.source.body, marks=(ring(0.1, 0.0, 0.005),)))
    request = replace(plain.request, winches=len(plain.request.poses)).fit_robot(eyes)
    large = replace(plain, source=eyes, request=request, expected_error=0.02 * eyes.body.mesh.size)
    shares = {"error": 0.5}

    def propose(robot: Robot, request: DesignRequest) -> Iterator[RouteProposal]:
        assert request.constraints.drawing_gap == 0.0
        assert request.constraints.keep_out == ()
        if shares["error"]:
            yield RouteProposal(
                robot=robot, error=0.0, expected_error=shares["error"] * large.expected_error, is_refined=True,
                is_buildable=True, ik_results=plain.ik_results,
            )  # fmt: skip

    def fail(*_: object) -> None:
        raise HydrostatError("no network.")

    monkeypatch.setattr("hydrostat.design.lifts.propose_routes", propose)
    assert [lift.words for lift in find_lifts(large)] == [CROSSING]
    assert find_lifts(replace(large, expected_error=0.009 * eyes.body.mesh.size)) == ()
    crossing = replace(request, constraints=replace(request.constraints, cable_gap=0.0))
    assert find_lifts(replace(large, source=plain.source, request=crossing)) == ()
    monkeypatch.setattr(sys.modules[find_network.__module__], "_search", fail)
    with pytest.raises(HydrostatError, match=r"no network\. Drawn shapes are in the way: drawing_gap"):
        find_network(eyes, request)
    shares["error"] = 0.0
    with pytest.raises(HydrostatError, match=r"no network\.$"):
        find_network(eyes, request)
    assert find_lifts(large) == ()


def test_a_pin_over_an_eye_is_told() -> None:
    """An eye of 3 mm. Oracle: a pin of 30 mm covers it at its place, and not 50 mm aside."""
    robot = drawn_strip(ring(0.1, 0.0, 0.003))
    aside, over = (replace(robot, pins=(Pin(at=(x, 0.0), radius=0.03),)) for x in (0.15, 0.1))
    assert list(find_pinned_drawings(aside)) == []
    (told,) = find_pinned_drawings(over)
    assert told == "pin[0]: covers the shape drawn at [100, 0] mm. Move the pin, or make it smaller"
    assert told in [finding.text for finding in review_robot(over)]
