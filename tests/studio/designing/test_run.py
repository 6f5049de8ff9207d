"""Wishes as a design is asked for. Oracle: the fields of `Constraints`, its own messages."""

import pytest
from builders import gallery_robot

from hydrostat.design import Constraints, DesignMethod, RouteOptions, TreeOptions, Zone
from hydrostat.errors import InputError
from hydrostat.project import Paint, Wishes
from hydrostat.robot import Robot
from hydrostat.studio.designing.run import starting_robot, wished_request


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return gallery_robot("starfish")


DISC, TRIANGLE = Zone(at=(0.0, 0.0), radius=0.02), Zone(outline=((0.0, 0.0), (0.04, 0.0), (0.02, 0.03)))


def test_every_wish_is_a_constraint(starfish: Robot) -> None:
    wishes = Wishes.of(
        zones=((Paint.KEEP_OUT, DISC), (Paint.STILL, TRIANGLE), (Paint.WINCH_ZONES, DISC), (Paint.KEEP_OUT, TRIANGLE)),
        mirror="x",
        tension=12.0,
        clearance=0.004,
        cables_per_winch=3,
        slack=0.01,
        stepped=True,
        torque=0.2,
        kept_winches=("left",),
        kept_cables=("left 2",),
    )
    assert wishes.to_constraints(starfish) == Constraints(
        keep_out=(DISC, TRIANGLE), passive_zones=(TRIANGLE,), winch_zones=(DISC,), mirror="x", tension=12.0,
        clearance=0.004,
        cables_per_winch=3, slack=0.01, spool_ratio=2.0, torque=0.2, locked_winches=("left",),
        locked_cables=("left 2",),
    )  # fmt: skip


def test_a_depth_is_for_bodies_in_space(starfish: Robot) -> None:
    wishes = Wishes.of(depth=0.0)
    assert wishes.to_constraints(starfish) == Constraints()
    trunk = gallery_robot("trunk")
    assert wishes.to_constraints(trunk) == Constraints(depth=0.0)
    assert wished_request(trunk, wishes).constraints.depth == 0.0
    with pytest.raises(InputError, match="does not keep depth"):
        wished_request(trunk, Wishes.of(depth=0.0, method=DesignMethod.TREES))


def test_no_wish_is_no_constraint(starfish: Robot) -> None:
    assert Wishes().to_constraints(starfish) == Constraints()


def test_what_is_kept_but_gone_is_passed_over(starfish: Robot) -> None:
    constraints = Wishes(kept_winches=("left", "nobody"), kept_cables=("left 1", "gone 7")).to_constraints(starfish)
    assert constraints == Constraints(locked_winches=("left",), locked_cables=("left 1",))


def test_poses_by_name_all_if_none_is_left(starfish: Robot) -> None:
    every = tuple(starfish.poses.values())
    assert Wishes().to_poses(starfish) == every
    assert Wishes(poses=("star_jump", "gone")).to_poses(starfish) == (starfish.pose("star_jump"),)
    assert Wishes(poses=("gone",)).to_poses(starfish) == every


def test_as_few_winches_as_will_do(starfish: Robot) -> None:
    asked = wished_request(starfish, Wishes.of(winches=0, cables=4, tolerance=0.003, simplicity=4.0))
    assert (asked.winches, asked.cables, asked.warm_start) == ("auto", 4, False)
    assert asked.options == RouteOptions(tolerance=0.003, simplicity=4.0)
    assert wished_request(starfish, Wishes(winches=3)).winches == 3
    with pytest.raises(InputError, match=r"cannot improve a network \(.auto.\). Give a number of winches"):
        wished_request(starfish, Wishes(winches=0, improve=True))


def test_usual_knobs_are_those_of_one_tree(starfish: Robot) -> None:
    """The usual ones are those of `TreeOptions.single`; what trees do not keep is told at once."""
    asked = wished_request(starfish, Wishes(method=DesignMethod.CHANG2018))
    assert (asked.method, asked.options) == (DesignMethod.CHANG2018, TreeOptions.single())
    with pytest.raises(InputError, match="does not keep mirror"):
        wished_request(starfish, Wishes.of(method=DesignMethod.CHANG2018, mirror="x"))
    with pytest.raises(InputError, match="needs a number of winches and cannot improve"):
        wished_request(starfish, Wishes(method=DesignMethod.CHANG2018, winches=0))


def test_what_does_not_fit_the_body_is_told_at_once(starfish: Robot) -> None:
    far = Wishes(zones=((Paint.KEEP_OUT, Zone(at=(9.0, 9.0), radius=0.01)),))
    with pytest.raises(InputError, match="does not touch the body"):
        wished_request(starfish, far)
    with pytest.raises(InputError, match="mirror"):
        wished_request(starfish, far.with_values(zones=(), mirror="z"))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"winches": -1}, "winches must be a whole number from 1 to 20, or 0 for as few as will do, not -1"),
        ({"cables": 61}, "cables must be a whole number from 1 to 60, not 61"),
        ({"cables_per_winch": 0}, "cables per winch must be a whole number from 1 to 60, not 0"),
        ({"depth": -0.001}, "depth must be at least 0 and at most 100 mm, not -1 mm"),
        ({"phi": 1.5}, "phi must be at least 0 and at most 1, not 1.5"),
        ({"threshold": 0}, "threshold must be a whole number, at least 1, not 0"),
        ({"simplicity": -1.0}, "simplicity must be at least 0 and at most 20, not -1.0"),
        ({"tension": 0.0}, "tension must be above 0 and at most 1000 N, not 0 N"),
        ({"clearance": -0.001}, "clearance must be above 0 and at most 1000 mm, not -1 mm"),
        ({"tolerance": float("inf")}, "tolerance must be above 0 and at most 1000 mm, not inf mm"),
        ({"slack": -0.002}, "slack must be at least 0 and at most 1000 mm, not -2 mm"),
        ({"torque": float("nan")}, "torque must be above 0 and at most 100 N m, not nan N m"),
    ],
)
def test_numbers_out_of_range(wrong: dict[str, float], words: str) -> None:
    with pytest.raises(InputError) as caught:
        Wishes.of(**wrong)
    assert str(caught.value) == words


def test_a_search_begins_with_what_stays(starfish: Robot) -> None:
    """Oracle: the names and numbers that were wished for."""

    def begun(**wishes: object) -> Robot:
        return starting_robot(starfish, wished_request(starfish, Wishes.of(**wishes)))

    assert (begun().winches, begun().cables) == ((), ())
    assert begun(improve=True) is starfish
    kept = begun(kept_winches=("feet",), kept_cables=("right 1",))
    assert kept.cables == starfish.cables[:1]
    assert {winch.name for winch in kept.winches} == {"feet", starfish.cables[0].winch}
