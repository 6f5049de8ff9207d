"""What a design is asked. Oracles: the fields of the records; the same typed, wished for, and written in Python."""

import json
from dataclasses import fields, replace
from typing import Any

import pytest
from builders import strip_robot

from hydrostat.design import Constraints, DesignMethod, DesignRequest, FibreKind, RouteOptions, TreeOptions
from hydrostat.design.constraints import RANGES, Range
from hydrostat.design.request import COUNTS, ROUTE_RANGES
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget, Robot

UP = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})


def robot() -> Robot:
    return replace(strip_robot(), poses={"up": UP})


def test_every_number_has_its_range() -> None:
    """And its default lies in it."""
    asked = DesignRequest(poses=(UP,))
    for ranges, record in ((RANGES, Constraints()), (ROUTE_RANGES, RouteOptions()), (COUNTS, asked)):
        assert all(allowed.holds(getattr(record, name)) for name, allowed in ranges.items())
    numbers = {name for name, value in vars(Constraints()).items() if type(value) in (int, float)}
    assert set(RANGES) == {*numbers, "depth", "max_length", "torque"}
    assert set(ROUTE_RANGES) == {field.name for field in fields(RouteOptions)}


@pytest.mark.parametrize(
    ("allowed", "inside", "outside", "words"),
    [
        (Range(whole=True, least=1, most=20), (1, 20), (0, 21, 1.5, True, None), "a whole number from 1 to 20"),
        (Range(above=True, most=1.0, unit="m"), (1e-9, 1), (0.0, 1.1, None, "1"), "above 0 and at most 1 m"),
        (Range(unit="m"), (0, 9e9), (-1e-9, float("inf"), float("nan")), "finite and at least 0 m"),
        (Range(whole=True), (0, 9), (-1, 0.0), "a whole number, at least 0"),
        (Range(optional=True), (None, 1.0), (-1.0,), "finite and at least 0"),
    ],
)
def test_ranges(allowed: Range, inside: tuple[Any, ...], outside: tuple[Any, ...], words: str) -> None:
    assert [allowed.holds(value) for value in inside] == [True] * len(inside)
    assert [allowed.holds(value) for value in outside] == [False] * len(outside)
    assert str(allowed) == words


def test_a_range_in_another_unit() -> None:
    assert Range(above=True, most=1.0, unit="m").words(1e3, "mm") == "above 0 and at most 1000 mm"


def test_methods_and_muscles_are_of_closed_sets(unchecked: None) -> None:
    assert DesignRequest(poses=(UP,), method="trees").method is DesignMethod.TREES  # type: ignore[arg-type]
    assert TreeOptions(fibres="elements").fibres is FibreKind.ELEMENTS  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r'^fibres must be one of edges, elements, not "hairs"$'):
        TreeOptions(fibres="hairs")  # type: ignore[arg-type]
    single = TreeOptions.single(threshold=30, distance=2.0, steps=8, phi=0.3)
    assert (single.thresholds, single.distances, single.growth_steps, single.phis) == ((30,), (2.0,), 8, (0.3,))
    assert (single.shares, single.trials, single.loss) == (1, 1, 0.0)
    for wrong in ({"threshold": 0}, {"distance": 0.0}, {"steps": 1.5}, {"phi": 1.1}):
        with pytest.raises(InputError, match=r"TreeOptions\.\w+ must be"):
            TreeOptions.single(**wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r'^method must be one of routes, trees, chang2018, not "magic"$'):
        DesignRequest(poses=(UP,), method="magic")  # type: ignore[arg-type]


def test_the_request_as_values(unchecked: None) -> None:
    values = json.loads(json.dumps(DesignRequest(poses=(UP,), winches="auto").as_values()))
    assert (values["poses"], values["winches"], values["cables"], values["method"]) == (["up"], "auto", 6, "routes")
    assert values["options"]["max_edges"] == RouteOptions().max_edges
    assert values["constraints"]["tension"] == Constraints().tension


def test_improving_allows_what_the_robot_has(unchecked: None) -> None:
    own = strip_robot()
    request = DesignRequest(poses=(UP,), warm_start=True, constraints=Constraints(travel=0.001)).fit_robot(own)
    assert request.constraints.travel == max(winch.travel for winch in own.winches)
    usual = BuildTolerances.of(own.body)
    assert DesignRequest(poses=(UP,)).fit_robot(own) == DesignRequest(poses=(UP,), uncertainty=usual)
