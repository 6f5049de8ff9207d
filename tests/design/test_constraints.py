"""Constraints are checked when made and on their robot. Oracles: the documented ranges; statics of a motor by hand."""

from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from builders import box_robot, mesh_body, strip_mesh, strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.zone import Zone
from hydrostat.errors import InputError
from hydrostat.robot import Mount

DISC = Zone(at=(0.05, 0.0), radius=0.01)
BALL = Zone(at=(0.05, 0.0, 0.0), radius=0.01)

BAD: dict[str, tuple[Any, ...]] = {
    "winch_zones": ((BALL, "here"), DISC, "left"),
    "keep_out": ((3,), 5.0),
    "passive_zones": ((None,),),
    "mount": ("air", 1),
    "cables_per_winch": (0, -1, 2.5, True, "2", nan),
    "clearance": (0.0, -0.001, inf, nan, "5 mm", None, True),
    "winch_clearance": (-0.001, inf, nan, "5 mm", None),
    "winch_gap": (-0.001, nan, "5 mm"),
    "hole_gap": (-0.001, nan, (0.004,)),
    "cable_gap": (-0.001, inf, nan, "4 mm", None),
    "drawing_gap": (-0.001, inf, nan, "4 mm", None),
    "built_in": (1, None, "yes"),
    "max_turn": (0.0, -5.0, 180.1, nan, "75"),
    "bend_radius": (-0.001, inf, nan, None),
    "max_length": (0.0, -1.0, inf, "1 m"),
    "depth": (-0.001, 0.2, inf, "1 mm"),
    "tension": (0.0, -1.0, inf, "20 N", None),
    "torque": (0.0, -1.0, nan, "1 N m"),
    "travel": (0.0, -0.01, inf, None),
    "release": (-0.01, inf, "1 mm"),
    "spool_radius": (0.0, -0.006, nan),
    "slack": (-0.001, nan, "1 mm"),
    "spool_ratio": (0.99, 4.1, nan, "2"),
    "two_way": (1, None, "yes"),
    "leads": (1, None, "yes"),
    "mirror": ("w", "X", 0, "left"),
    "motor": ("servo", None, 3),
    "locked_winches": ("left", (1,), ("left", "left"), 3),
    "locked_cables": ("left 1", (1,), (True,), ("left 1", "left 1"), 0),
}

GOOD: dict[str, tuple[Any, ...]] = {
    "winch_zones": ((), (DISC,), [DISC]),
    "mount": (None, Mount.BODY, "world"),
    "cables_per_winch": (1, np.int64(3)),
    "winch_clearance": (0.0,),
    "winch_gap": (0.0,),
    "hole_gap": (0, 0.0),
    "cable_gap": (0.0, 0.01),
    "drawing_gap": (0.0, 0.01),
    "built_in": (True, False),
    "max_turn": (180.0, 180, np.float64(0.1)),
    "max_length": (None, 0.1),
    "depth": (None, 0.0, 0.003),
    "torque": (None, 0.1),
    "release": (0.0,),
    "spool_ratio": (1, 4.0),
    "mirror": (None, "x", "y", "z"),
    "motor": ("auto", "n20", "sts3215-12v"),
    "locked_winches": ((), ["left", "right"]),
    "locked_cables": ((), ["left 1", "right 1"]),
}


def test_every_constraint_is_checked() -> None:
    assert set(BAD) == set(Constraints.__dataclass_fields__)


@pytest.mark.parametrize(("field", "value"), [(field, value) for field, values in BAD.items() for value in values])
def test_what_is_no_constraint_is_told_in_one_line(field: str, value: Any, unchecked: None) -> None:
    """With its name, and what is wrong."""
    with pytest.raises(InputError, match=f"^constraints: {field}.* (must be|twice).+") as error:
        Constraints(**{field: value})
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("field", "value"), [(field, value) for field, values in GOOD.items() for value in values])
def test_what_is_allowed(field: str, value: Any, unchecked: None) -> None:
    found = getattr(Constraints(**{field: value}), field)
    assert found == (tuple(value) if isinstance(value, list) else value)


def test_a_mount_in_words_is_a_mount(unchecked: None) -> None:
    given: Any = "world"
    assert Constraints(mount=given).mount is Mount.WORLD


def test_the_limit_of_tension() -> None:
    """A motor of 0.06 N m on a spool of 6 mm holds 10 N if it pulls one cable; on spools half as large, 20 N."""
    assert Constraints(tension=30.0).tension_limit == 30.0
    for cables in (1, 4):
        assert Constraints(torque=0.06, cables_per_winch=cables).tension_limit == pytest.approx(10.0)
    assert Constraints(torque=0.06, spool_radius=0.012).tension_limit == pytest.approx(5.0)
    assert Constraints(tension=30.0, torque=0.06, spool_ratio=2.0).tension_limit == pytest.approx(20.0)
    assert Constraints(tension=2.0, torque=0.06).tension_limit == 2.0


def misfit(limits: dict[str, Any], *, space: bool = False, bare: bool = False) -> str:
    robot = box_robot() if space else strip_robot()
    with pytest.raises(InputError) as error:
        Constraints(**limits).check(robot.with_network((), ()) if bare else robot)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_constraints_that_fit() -> None:
    limits = Constraints(
        winch_zones=(DISC,),
        keep_out=(DISC,),
        mirror="y",
        locked_winches=("up",),
        locked_cables=("up 1", "down 1"),
        mount=Mount.WORLD,
    )
    limits.check(strip_robot())
    Constraints(passive_zones=(BALL,)).check(box_robot())


@pytest.mark.parametrize("field", ["winch_zones", "keep_out", "passive_zones"])
def test_zones_have_the_dimensions_of_the_body(field: str) -> None:
    assert misfit({field: (DISC, BALL)}).startswith(f"constraints: {field}[1]: wrong dimension (3). Body: 2. ")
    assert misfit({field: (DISC,)}, space=True).startswith(f"constraints: {field}[0]: wrong dimension (2). Body: 3. ")


def test_what_is_locked_must_be_there() -> None:
    told = misfit({"locked_winches": ("up", "left")})
    assert told == 'constraints: locked_winches[1]: unknown winch "left". Available: up, down.'
    told = misfit({"locked_cables": ("up 1", "up 2")})
    assert told == 'constraints: locked_cables[1]: unknown cable "up 2". Available: up 1, down 1. Did you mean "up 1"?'
    assert 'unknown cable "up 1"' in misfit({"locked_cables": ("up 1",)}, bare=True)


def test_what_stays_is_what_is_locked_and_its_winches() -> None:
    robot = strip_robot()
    assert Constraints().staying(robot) == ((), ())
    assert Constraints(locked_winches=("down",)).staying(robot) == (robot.winches[1:], ())
    assert Constraints(locked_cables=("up 1",)).staying(robot) == (robot.winches[:1], robot.cables[:1])


def test_winches_in_the_world_need_places() -> None:
    assert "Add a [[winch]]" in misfit({"mount": Mount.WORLD}, bare=True)
    Constraints(mount=Mount.BODY).check(strip_robot().with_network((), ()))


def test_a_mirror_needs_a_body_about_it() -> None:
    assert 'Allowed: "x" or "y"' in misfit({"mirror": "z"})
    assert "body not centered on x = 0 (0 to 200 mm)" in misfit({"mirror": "x"})
    middle = strip_mesh(8, 2)
    moved = replace(middle, nodes=middle.nodes - np.array([0.1, 0.0]))
    robot = replace(strip_robot().with_network((), ()), body=mesh_body(moved), markers=(), pins=(_pin(),))
    Constraints(mirror="x").check(robot)


def _pin() -> Any:
    return replace(strip_robot().pins[0], box=((-0.101, -1.0), (-0.099, 1.0)))
