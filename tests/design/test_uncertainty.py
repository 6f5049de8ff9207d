"""Robots drawn as they may be built. Oracles: the deviations asked for, over many draws; the robot itself."""

from dataclasses import fields, replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.built_error import built_errors
from hydrostat.design.uncertainty import UNCERTAINTY_RANGES, BuildTolerances
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Simulation

ROBOT = strip_robot(columns=10, rows=3)
NONE = BuildTolerances.none()


def test_without_tolerances_a_robot_is_as_its_model(unchecked: None) -> None:
    drawn = NONE.draw(ROBOT, np.random.default_rng(1))
    assert [cable.points for cable in drawn.cables] == [cable.points for cable in ROBOT.cables]
    assert [(cable.stiffness, cable.slack, cable.friction) for cable in drawn.cables] == [
        (cable.stiffness, cable.slack, 0.0) for cable in ROBOT.cables
    ]
    assert drawn.winches == ROBOT.winches
    assert drawn.spool_ratios.tolist() == ROBOT.spool_ratios.tolist()
    assert drawn.body.material.young == ROBOT.body.material.young


def test_the_same_seed_gives_the_same_robot(unchecked: None) -> None:
    one, same, other = (BuildTolerances().draw(ROBOT, np.random.default_rng(seed)) for seed in (3, 3, 4))
    assert one.cables == same.cables
    assert one.cables != other.cables


def test_what_differs_does_so_by_its_deviation(unchecked: None) -> None:
    """Of 400 draws; a standard deviation is then known to 4 %, so 15 % would be chance once in ten thousand times."""
    wide = replace(BuildTolerances(), sewing=5e-4)
    drawn = [wide.draw(ROBOT, np.random.default_rng([0, number])) for number in range(400)]
    last = np.array([robot.cables[0].points[-1] for robot in drawn]) - ROBOT.cables[0].points[-1]
    assert last.std(axis=0) == pytest.approx(np.full(2, 5e-4), rel=0.15)
    for values, deviation in (
        ([robot.body.material.young / ROBOT.body.material.young for robot in drawn], 0.2),
        ([robot.cables[1].stiffness / ROBOT.cables[1].stiffness for robot in drawn], 0.2),
        ([robot.cables[0].spool_radius / ROBOT.winches[0].spool_radius for robot in drawn], 0.03),
        ([robot.pins[0].stiffness / ROBOT.pins[0].stiffness for robot in drawn], 0.5),
    ):
        assert np.log(values).std() == pytest.approx(deviation, rel=0.15)
    friction = np.array([robot.cables[0].friction for robot in drawn])
    assert 0 <= friction.min() < 0.02
    assert 0.18 < friction.max() <= 0.2


def test_holes_stay_in_the_body(unchecked: None) -> None:
    """Even if they are sewn 20 mm beside their mark, on a strip 50 mm wide."""
    far = replace(NONE, sewing=0.02)
    for seed in range(20):
        points = [p for cable in far.draw(ROBOT, np.random.default_rng(seed)).cables for p in cable.points]
        assert ROBOT.body.distances(np.array(points)).max() <= 0.0


def test_errors_of_robots_that_are_built_just_so(unchecked: None) -> None:
    """Oracle: the distance of the marker from its target, solved once."""
    pose = PoseTarget(name="up", targets={"tip": (0.18, 0.03)})
    command = np.array([0.01, 0.0])
    solved = Simulation(ROBOT).solve(command)
    away = float(np.linalg.norm(solved.markers["tip"] - np.array((0.18, 0.03))))
    errors = built_errors(ROBOT, [pose], [command], NONE, draws=2)
    assert errors.model == pytest.approx(away, rel=1e-6)
    assert errors.drawn == pytest.approx([away, away], rel=1e-5)
    assert errors.most == errors.drawn.max()


@pytest.mark.parametrize("field", [field.name for field in fields(BuildTolerances)])
def test_what_is_no_tolerance_is_told_in_one_line(field: str, unchecked: None) -> None:
    for bad in (-0.1, "2 mm", None, float("nan")):
        with pytest.raises(InputError, match=f"^uncertainty: {field} must .+") as error:
            replace(NONE, **{field: bad if field != "friction" else (0.2, bad)})
        assert "\n" not in str(error.value)
    assert field == "friction" or field in UNCERTAINTY_RANGES
