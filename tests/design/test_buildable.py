"""What breaks constraints. Oracle: a network on a plate whose distances and angles are known by hand.

Each case is a network that keeps a constraint by 0.1 mm or 0.2 degrees, and one that breaks it by as much, and nothing
else.
"""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.design.buildable import pulls, violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import body_region
from hydrostat.design.zone import Zone
from hydrostat.robot import Body, Cable, Mount, Pin, PoseTarget, Robot, Winch

UP = ((0.03, 0.03), (0.06, 0.03), (0.1, 0.03), (0.15, 0.03))
DOWN = ((0.03, -0.03), (0.06, -0.03), (0.1, -0.03), (0.15, -0.03))
HAIR = 1e-4
STRAIGHT_UP, STRAIGHT_DOWN = (UP[0], UP[3]), (DOWN[0], DOWN[3])
FAN = 2 * float(np.arcsin(0.01 / 0.024))  # between two cables that are 10 mm apart 12 mm from their winch

Points = tuple[tuple[float, ...], ...]


@cache
def plate(dim: int) -> Body:
    """200 x 100 mm from x = 0, evenly about y = 0; in space 60 mm high from z = 0."""
    if dim == 2:
        return mesh_body(strip_mesh(8, 4, size=(0.2, 0.1)))
    mesh = box_mesh((8, 4, 3), size=(0.2, 0.1, 0.06))
    return mesh_body(replace(mesh, nodes=mesh.nodes - np.array([0.0, 0.05, 0.0])))


def network(
    up: Points = UP,
    down: Points = DOWN,
    *,
    winch: dict[str, Any] | None = None,
    lower: Any = (),
    more: Any = (),
    **cable: Any,
) -> Robot:
    """Two winches with a cable each; values of the upper ones, and further cables by winch and points."""
    dim = len(up[0])
    return Robot(
        name="plate",
        body=plate(dim),
        pins=(Pin(box=((-0.001,) + (-1.0,) * (dim - 1), (0.001,) + (1.0,) * (dim - 1))),),
        winches=(Winch(name="up", at=up[0], **(winch or {})), Winch(name="down", at=down[0], **dict(lower))),
        cables=(
            Cable(winch="up", points=up, **cable),
            Cable(winch="down", points=down),
            *(Cable(winch=name, points=points) for name, points in more),
        ),
        poses={},
    )


def broken(robot: Robot, **limits: Any) -> list[str]:
    constraints = Constraints(**{"cable_gap": 0.0, "turn": 75.0, **limits})
    constraints.check(robot)
    return violations(robot, constraints, body_region(robot.body, constraints.clearance))


def moved(points: Points, index: int, *at: float) -> Points:
    return (*points[:index], at, *points[index + 1 :])


def high(points: Points, z: float = 0.03) -> Points:
    """The same points in space."""
    return tuple((*point, z) for point in points)


def corner(angle: float, first: float = 0.03, last: float = 0.04) -> Points:
    """A cable that turns by an angle [degrees] at its point 1."""
    way = np.radians(angle)
    return (UP[0], (0.03 + first, 0.03), (0.03 + first + last * float(np.cos(way)), 0.03 - last * float(np.sin(way))))


def third(x: float, y: float) -> dict[str, Any]:
    """A further cable of the lower winch that ends in a place."""
    return {"more": [("down", (DOWN[0], (0.06, -0.012), (x, y)))]}


LEADS = {"leads": False, "still": (Zone(box=((0.04, 0.02), (0.07, 0.04))),)}
ROUND = {"turn": 180.0, "bend_radius": 0.02}

CASES: dict[str, tuple[dict[str, Any], dict[str, Any], dict[str, Any], str]] = {
    "winch_zones": (
        {"winch_zones": (Zone(at=(0.03, 0.0), radius=0.03), Zone(at=(0.15, 0.0), radius=0.02))},
        {},
        {"up": moved(UP, 0, 0.03, 0.0301)},
        "winch[0] up: outside winch_zones (by 0.1 mm, at [30, 30.1] mm). Allowed: inside a zone. Move it there.",
    ),
    "winch_clearance": (
        {},
        {"up": moved(UP, 0, 0.03, 0.038 - HAIR)},
        {"up": moved(UP, 0, 0.03, 0.038 + HAIR)},
        "winch[0] up: low clearance (11.9 mm inside the edge). Minimum winch_clearance: 12 mm. Move it inward.",
    ),
    "winch_gap": (
        {"winch_gap": 0.06},
        {"up": moved(UP, 0, 0.03, 0.03 + HAIR)},
        {"up": moved(UP, 0, 0.03, 0.03 - HAIR)},
        "winch[1] down: too close to winch[0] up (59.9 mm). Minimum winch_gap: 60 mm. Move them apart.",
    ),
    "mount": (
        {"mount": Mount.BODY},
        {},
        {"winch": {"mount": Mount.WORLD}},
        'winch[0] up: wrong mount ("world"). Allowed: "body". Change it.',
    ),
    "travel": (
        {},
        {"winch": {"travel": 0.06}},
        {"winch": {"travel": 0.0601}},
        "winch[0] up: travel too large (60.1 mm). Maximum: 60 mm. Reduce it.",
    ),
    "release": (
        {"release": 0.01},
        {"winch": {"release": 0.01}},
        {"winch": {"release": 0.0101}},
        "winch[0] up: release too large (10.1 mm). Maximum: 10 mm. Reduce it.",
    ),
    "spool_radius": (
        {"spool_radius": 0.006},
        {"winch": {"spool_radius": 0.006}},
        {"winch": {"spool_radius": 0.0059}},
        "winch[0] up: wrong spool_radius (5.9 mm). Allowed: 6 mm. Change it.",
    ),
    "cables_per_winch": (
        {"cables_per_winch": 2},
        third(0.15, -0.012),
        {"more": [*third(0.15, -0.012)["more"], ("down", (DOWN[0], (0.06, 0.0), (0.15, 0.0)))]},
        "winch[1] down: too many cables (3). Maximum cables_per_winch: 2. Add a winch.",
    ),
    "clearance of a point": (
        {},
        {"up": moved(UP, 3, 0.15, 0.045 - HAIR)},
        {"up": moved(UP, 3, 0.15, 0.045 + HAIR)},
        "cable[0].points[3]: low clearance (4.9 mm inside the edge, at [150, 45.1] mm). Minimum clearance: 5 mm.",
    ),
    "clearance of a point in space": (
        {},
        {"up": moved(high(UP), 3, 0.15, 0.03, 0.005 + HAIR), "down": high(DOWN)},
        {"up": moved(high(UP), 3, 0.15, 0.03, 0.005 - HAIR), "down": high(DOWN)},
        "cable[0].points[3]: low clearance (4.9 mm inside the surface, at [150, 30, 4.9] mm). Minimum clearance: 5 mm.",
    ),
    "keep_out of a segment": (
        {"keep_out": (Zone(at=(0.125, 0.02), radius=0.01),)},
        {"up": (*UP[:2], (0.1, 0.03 + HAIR), (0.15, 0.03 + HAIR))},
        {"up": (*UP[:2], (0.1, 0.03 - HAIR), (0.15, 0.03 - HAIR))},
        "cable[0] between points 2 and 3: inside keep_out[0] (0.1 mm deep). Allowed: outside. Reroute it.",
    ),
    "keep_out of a point": (
        {"keep_out": (Zone(at=(0.2, 0.05), radius=0.001), Zone(box=((0.16, 0.0), (0.18, 0.04))))},
        {"up": moved(UP, 3, 0.16 - HAIR, 0.03)},
        {"up": moved(UP, 3, 0.16 + HAIR, 0.03)},
        "cable[0] between points 2 and 3: inside keep_out[1] (0.1 mm deep). Allowed: outside. Reroute it.",
    ),
    "keep_out in a sheath": (
        {"keep_out": (Zone(at=(0.045, 0.03), radius=0.005),)},
        {"up": moved(UP, 1, 0.05, 0.042), "sheathed": ((0, 1),)},
        {"sheathed": ((0, 1),)},
        "cable[0] between points 0 and 1: inside keep_out[0] (5 mm deep). Allowed: outside. Reroute it.",
    ),
    "still": (
        {"still": (Zone(at=(0.045, 0.03), radius=0.005),)},
        {"sheathed": ((0, 1),)},
        {"sheathed": ((1, 2),)},
        "cable[0] between points 0 and 1: no sheath in still[0] (5 mm deep). Allowed: outside.",
    ),
    "still beside a bare segment": (
        {"still": (Zone(at=(0.045, 0.02), radius=0.01),)},
        {"up": ((0.03, 0.03 + HAIR), (0.06, 0.03 + HAIR), *UP[2:])},
        {"up": ((0.03, 0.03 - HAIR), (0.06, 0.03 - HAIR), *UP[2:])},
        "cable[0] between points 0 and 1: no sheath in still[0] (0.1 mm deep). Allowed: outside.",
    ),
    "no leads": (
        {"leads": False},
        {},
        {"sheathed": ((0, 1),)},
        "cable[0] between points 0 and 1: sheath outside the still zones. Not allowed without leads.",
    ),
    "no leads but in still zones": (
        LEADS,
        {"sheathed": ((0, 2),)},
        {"sheathed": ((0, 3),), "up": (*UP, (0.18, 0.03))},
        "cable[0] between points 2 and 3: sheath outside the still zones. Not allowed without leads.",
    ),
    "hole_gap": (
        {"hole_gap": 0.06},
        {"up": ((0.03, 0.03), (0.15, 0.03 + HAIR)), "down": ((0.03, -0.03), (0.15, -0.03))},
        {"up": ((0.03, 0.03), (0.15, 0.03 - HAIR)), "down": ((0.03, -0.03), (0.15, -0.03))},
        "cable[1].points[1]: too close to cable[0].points[1] (59.9 mm). Minimum hole_gap: 60 mm. Move them apart.",
    ),
    "hole_gap along one cable": (
        {},
        {"up": (*UP, (0.154 + HAIR, 0.03))},
        {"up": (*UP, (0.154 - HAIR, 0.03))},
        "cable[0].points[4]: too close to cable[0].points[3] (3.9 mm). Minimum hole_gap: 4 mm. Move them apart.",
    ),
    "a hole that is shared": (
        {},
        {"more": [("down", (DOWN[0], (0.06, -0.012), (0.1, -0.02), DOWN[3]))]},
        {"more": [("down", (DOWN[0], (0.06, -0.012), (0.1, -0.02), (0.15, -0.0299)))]},
        "cable[2].points[3]: too close to cable[1].points[3] (0.1 mm). Minimum hole_gap: 4 mm. Move them apart.",
    ),
    "a hole at a winch": (
        {},
        {"more": [("down", (DOWN[0], (0.03, 0.018 - HAIR)))]},
        {"more": [("down", (DOWN[0], (0.03, 0.018 + HAIR)))]},
        "cable[2].points[1]: too close to winch[0] up of other cables (11.9 mm). Minimum: two spool radii, 12 mm.",
    ),
    "cable_gap": (
        {"cable_gap": 0.01},
        {"up": STRAIGHT_UP, "down": STRAIGHT_DOWN, "more": [("down", (DOWN[0], (0.05, 0.0), (0.15, 0.02 - HAIR)))]},
        {"up": STRAIGHT_UP, "down": STRAIGHT_DOWN, "more": [("down", (DOWN[0], (0.05, 0.0), (0.15, 0.02 + HAIR)))]},
        "cable[2] between points 1 and 2: too close to cable[0] between points 0 and 1 (9.9 mm). Minimum cable_gap: 10",
    ),
    "cable_gap where cables cross": (
        {"cable_gap": 0.004},
        {"up": STRAIGHT_UP, "down": STRAIGHT_DOWN, "more": [("down", (DOWN[0], (0.09, 0.026 - HAIR)))]},
        {"up": STRAIGHT_UP, "down": STRAIGHT_DOWN, "more": [("down", (DOWN[0], (0.09, 0.045)))]},
        "cable[2] between points 0 and 1: crosses cable[0] between points 0 and 1. Minimum cable_gap: 4 mm.",
    ),
    "cable_gap beside a winch of others": (
        {"cable_gap": 0.004},
        {"more": [("down", (DOWN[0], (0.018 - HAIR, 0.0), (0.018 - HAIR, 0.044)))]},
        {"more": [("down", (DOWN[0], (0.018 + HAIR, 0.0), (0.018 + HAIR, 0.044)))]},
        "cable[2] between points 1 and 2: too close to winch[0] up of other cables (11.9 mm). Minimum: two spool",
    ),
    "cable_gap of two cables of a winch": (  # by the angle between them, two spool radii from it
        {"cable_gap": 0.01},
        {"more": [("up", (UP[0], (UP[0][0] + 0.04 * np.cos(FAN + 0.01), UP[0][1] - 0.04 * np.sin(FAN + 0.01))))]},
        {"more": [("up", (UP[0], (UP[0][0] + 0.04 * np.cos(FAN - 0.01), UP[0][1] - 0.04 * np.sin(FAN - 0.01))))]},
        "cable[2] between points 0 and 1: too close to cable[0] between points 0 and 1 (9.8",
    ),
    "turn": ({}, {"up": corner(74.8)}, {"up": corner(75.2)}, "cable[0].points[1]: turn too sharp (75.2 degrees)."),
    "turn in space": (
        {},
        {"up": high(corner(74.8)), "down": high(DOWN)},
        {"up": high(corner(75.2)), "down": high(DOWN)},
        "cable[0].points[1]: turn too sharp (75.2 degrees). Maximum turn: 75 degrees. Move the point.",
    ),
    "bend_radius": (  # a right angle: the radius is half the shorter segment
        ROUND,
        {"up": corner(90, last=0.04 + HAIR, first=0.05)},
        {"up": corner(90, last=0.04 - 2 * HAIR, first=0.05)},
        "cable[0].points[1]: bend too sharp (radius 19.9 mm). Minimum bend_radius: 20 mm. Move the point.",
    ),
    "bend_radius by the first segment": (  # 60 degrees: half of it times the root of 3
        ROUND,
        {"up": corner(60, first=0.04 / 3**0.5 + HAIR)},
        {"up": corner(60, first=0.04 / 3**0.5 - HAIR)},
        "cable[0].points[1]: bend too sharp (radius 19.91 mm). Minimum bend_radius: 20 mm. Move the point.",
    ),
    "longest": (
        {"longest": 0.13},
        {"up": moved(UP, 3, 0.16 - HAIR, 0.03)},
        {"up": moved(UP, 3, 0.16 + HAIR, 0.03)},
        "cable[0]: too long (130.1 mm). Maximum (longest): 130 mm. Shorten it.",
    ),
    "slack": (
        {"slack": 0.005},
        {"slack": 0.005},
        {"slack": 0.0051},
        "cable[0]: slack too large (5.1 mm). Maximum: 5 mm. Reduce it.",
    ),
    "spool_ratio": (
        {"spool_ratio": 1.5},
        {"spool_radius": 0.009},
        {"spool_radius": 0.0091},
        "cable[0]: spool too different from its winch's (1.517 times its radius). Maximum spool_ratio",
    ),
    "spool_ratio below one": (
        {"spool_ratio": 1.5},
        {"spool_radius": 0.004},
        {"spool_radius": 0.0039},
        "cable[0]: spool too different from its winch's (0.65 times its radius). Maximum spool_ratio",
    ),
    "two_way": (
        {},
        {},
        {"reverse": True},
        "cable[0]: wound the other way round. Not allowed without two_way.",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_each_constraint_is_kept_or_broken(case: str) -> None:
    limits, keeps, breaks, words = CASES[case]
    assert broken(network(**keeps), **limits) == []
    (told,) = broken(network(**breaks), **limits)
    assert told.startswith(words)


def test_every_constraint_has_a_case() -> None:
    """But forces, which `pulls` looks at, mirror, what is locked, room for units, the skin: these have their own."""
    tested = {name.split()[0] for name in CASES} | {"hole_gap", "leads"}
    others = {"tension", "torque", "mirror", "locked_winches", "locked_cables", "built_in", "depth"}
    assert set(Constraints.__dataclass_fields__) - others <= tested


@pytest.mark.parametrize("dim", [2, 3])
def test_a_segment_keeps_half_the_clearance(dim: int) -> None:
    """Below a notch 20 mm wide that ends at y = 20 mm, between two points far from any edge."""
    mesh = strip_mesh(20, 10, size=(0.2, 0.1)) if dim == 2 else box_mesh((20, 10, 3), size=(0.2, 0.1, 0.06))
    mesh = mesh if dim == 2 else replace(mesh, nodes=mesh.nodes - np.array([0.0, 0.05, 0.0]))
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    body = mesh_body(_part(mesh, (np.abs(middles[:, 0] - 0.1) > 0.01) | (middles[:, 1] < 0.02)))
    for depth, words in ((0.0026, ""), (0.0024, "2.4 mm inside"), (-0.0016, "1.6 mm outside")):
        flat: Points = ((0.03, 0.02 - depth), (0.17, 0.02 - depth))
        way = flat if dim == 2 else high(flat)
        robot = network() if dim == 2 else network(high(UP), high(DOWN))
        robot = replace(
            robot, body=body, winches=(Winch(name="up", at=way[0]),), cables=(Cable(winch="up", points=way),)
        )
        told = broken(robot)
        assert len(told) == bool(words)
        if told:
            assert told[0].startswith(f"cable[0] between points 0 and 1: low clearance ({words} the ")
            assert told[0].endswith("Minimum: half the clearance of 5 mm. Reroute it.")


def _part(mesh: Any, chosen: np.ndarray) -> Any:
    used, elements = np.unique(mesh.elements[chosen], return_inverse=True)
    return replace(mesh, nodes=mesh.nodes[used], elements=elements.reshape(-1, mesh.dim + 1))


@pytest.mark.parametrize("dim", [2, 3])
def test_a_cable_from_the_world_may_come_in_at_the_edge(dim: int) -> None:
    """Its first segment and a clearance's way on are free; then half the clearance holds."""
    into: Points = ((-0.05, 0.03), (0.0, 0.03), (0.1, 0.03), (0.15, 0.03))
    along: Points = ((-0.05, 0.048), (0.0, 0.048), (0.1, 0.048), (0.15, 0.03))
    down = DOWN if dim == 2 else high(DOWN)
    make = {"winch": {"mount": Mount.WORLD}, "down": down}
    assert broken(network(into if dim == 2 else high(into), **make)) == []
    told = broken(network(along if dim == 2 else high(along), **make))
    assert f", at [100, 48{', 30' if dim == 3 else ''}] mm)" in told[0]
    assert [one.split(": low clearance (")[0] for one in told] == [
        "cable[0].points[2]",
        "cable[0] between points 1 and 2",
        "cable[0] between points 2 and 3",
    ]


def test_winches_in_the_world_may_stand_close() -> None:
    into: Points = ((-0.05, 0.005), (0.05, 0.03), (0.15, 0.03))
    other: Points = ((-0.05, -0.005), (0.05, -0.03), (0.15, -0.03))
    outside = network(into, other, winch={"mount": Mount.WORLD}, lower={"mount": Mount.WORLD})
    assert broken(outside, winch_gap=0.03) == []
    body_and_world = network(into, ((0.02, 0.005), *other[1:]), winch={"mount": Mount.WORLD})
    assert broken(body_and_world, winch_gap=0.06) == []
    (told,) = broken(body_and_world, winch_gap=0.08)
    assert "(70 mm). Minimum winch_gap: 80 mm" in told


def test_a_mirrored_network() -> None:
    assert broken(network(), mirror="y") == []
    assert broken(network(up=moved(UP, 2, 0.1, 0.0305)), mirror="y") == [
        "cable[0]: no mirror image (expected to end at [150, -30] mm). Add it or clear mirror.",
        "cable[1]: no mirror image (expected to end at [150, 30] mm). Add it or clear mirror.",
    ]
    assert broken(network(up=moved(UP, 2, 0.1, 0.03005)), mirror="y") == []
    told = broken(network(up=moved(UP, 0, 0.03, 0.031)), mirror="y")
    assert [one.split(": no mirror image ")[0] for one in told] == [
        "winch[0] up",
        "winch[1] down",
        "cable[0]",
        "cable[1]",
    ]
    told = broken(network(winch={"travel": 0.05}), mirror="y")
    assert [one.split(": no mirror image ")[0] for one in told] == [
        "winch[0] up",
        "winch[1] down",
        "cable[0]",
        "cable[1]",
    ]
    for values in ({"slack": 0.01}, {"spool_radius": 0.007}, {"sheathed": ((0, 1),)}, {"stiffness": 5e3}):
        told = broken(network(**values), mirror="y", slack=0.01, spool_ratio=2.0)
        assert [one.split(": no mirror image ")[0] for one in told] == ["cable[0]", "cable[1]"]


def test_a_winch_in_the_mirror_is_its_own_image() -> None:
    start = (0.03, 0.0)
    pair = network().with_network(
        (Winch(name="middle", at=start),),
        (
            Cable(winch="middle", points=(start, *UP[1:])),
            Cable(winch="middle", points=(start, *DOWN[1:])),
            Cable(winch="middle", points=(start, (0.15, 0.0))),
        ),
    )
    assert broken(pair, mirror="y") == []
    one = pair.with_network(pair.winches, pair.cables[1:])
    (told,) = broken(one, mirror="y")
    assert told == "cable[0]: no mirror image (expected to end at [150, 30] mm). Add it or clear mirror."


def test_an_image_is_pulled_by_the_image_of_its_winch() -> None:
    """Two winches in the mirror, with cables that begin at the same place between them."""
    upper = ((0.04, 0.0), (0.07, 0.02), (0.15, 0.03))
    lower = tuple((x, -y) for x, y in upper)
    winches = Winch(name="first", at=(0.03, 0.0)), Winch(name="second", at=(0.05, 0.0))
    for pulls_lower, count in (("first", 0), ("second", 2)):
        cables = Cable(winch="first", points=upper), Cable(winch=pulls_lower, points=lower)
        told = broken(network().with_network(winches, cables), mirror="y", winch_gap=0.02)
        assert len(told) == count


def test_what_is_locked_is_not_looked_at() -> None:
    wild = network(up=((0.03, 0.041), (0.15, 0.048)), winch={"travel": 0.09, "release": 0.01}, slack=0.02)
    assert len(broken(wild, winch_gap=0.03)) == 6
    assert broken(wild, locked_cables=("up 1",)) == []
    told = broken(wild, locked_winches=("up",))
    assert [one.split()[0].rstrip(":") for one in told] == ["cable[0].points[1]", "cable[0]", "cable[0]"]


def test_a_cable_may_begin_at_a_locked_winch_near_the_edge() -> None:
    """As at the edge itself: a clearance's way on from there is free."""
    edge: Points = ((0.03, 0.048), (0.06, 0.03), (0.15, 0.03))
    assert broken(network(up=edge), locked_winches=("up",)) == []
    assert len(broken(network(up=edge))) == 3
    along = network(up=(edge[0], (0.06, 0.048), (0.15, 0.03)))
    told = broken(along, locked_winches=("up",))
    assert ", at [60, 48] mm)" in told[0]
    assert [one.split(": low clearance (")[0] for one in told] == [
        "cable[0].points[1]",
        "cable[0] between points 0 and 1",
        "cable[0] between points 1 and 2",
    ]


def test_a_winch_with_locked_cables_may_have_more_of_them() -> None:
    robot = network(**third(0.15, -0.012))
    assert broken(robot, cables_per_winch=1, locked_cables=("down 1", "down 2")) == []
    assert len(broken(robot, cables_per_winch=1, locked_cables=("down 1",))) == 1


def test_locked_cables_are_known_by_their_names() -> None:
    """In another order, and with another cable that has the place of the locked one."""
    robot = network(up=((0.03, 0.03), (0.15, 0.048)))
    for cables in (robot.cables, robot.cables[::-1]):
        turned = robot.with_network(robot.winches, cables)
        assert broken(turned, locked_cables=("up 1",)) == []
        assert len(broken(turned, locked_cables=("down 1",))) == 2


def test_what_is_new_keeps_away_from_what_is_locked() -> None:
    near = network(**third(0.1, -0.0265))
    words = "cable[2].points[2]: too close to cable[1].points[2] (3.5 mm). Minimum hole_gap: 4 mm. Move them apart."
    assert broken(near, locked_cables=("down 1",)) == [words]
    assert broken(near, locked_cables=("down 2",)) == [words]
    assert broken(near, locked_cables=("down 1", "down 2")) == []
    crowded = network(up=moved(UP, 0, 0.03, -0.01))
    (told,) = broken(crowded, locked_winches=("down",))
    assert told.startswith("winch[1] down: too close to winch[0] up (20 mm)")
    assert broken(crowded, locked_winches=("down", "up")) == []


def test_a_cable_may_pass_its_own_winch() -> None:
    assert broken(network(more=[("down", (DOWN[0], (0.032, -0.038), (0.06, -0.039)))])) == []


def test_rounding_breaks_nothing() -> None:
    """Coordinates to 0.01 mm, of points that lie on their limits."""
    away = 0.045 + 4.9e-6
    assert broken(network(up=moved(UP, 3, 0.15, away))) == []
    assert broken(network(up=corner(75.05))) == []
    assert broken(network(), winch_clearance=0.02, winch_gap=0.06, longest=0.12, cables_per_winch=1) == []


def reached(contractions: tuple[float, ...], tensions: tuple[float, ...], name: str | None = "wave") -> Any:
    return SimpleNamespace(
        target=None if name is None else PoseTarget(name=name, targets={"tip": (0.0, 0.0)}),
        pose=SimpleNamespace(contractions=np.array(contractions), tensions=np.array(tensions)),
    )


def test_what_poses_ask(unchecked: None) -> None:
    robot = network(winch={"travel": 0.05, "release": 0.01}, spool_radius=0.009, **third(0.15, -0.012))
    limits = Constraints(tension=10.0)
    within = reached((0.05, 0.0), (10.005, 0.0, 10.0))
    assert pulls(robot, [within], limits) == []
    beyond = reached((0.0501, -0.0001), (10.02, 0.0, 9.0), None)
    assert pulls(robot, [within, beyond], limits) == [
        "pose 1: cable[0]: tension too high (10.02 N). Maximum: 10 N. Ease the pose or add cables.",
        "pose 1: winch[0] up: contraction too large (50.1 mm). Maximum travel: 50 mm. Ease the pose or raise travel.",
        "pose 1: winch[1] down: payout too large (0.1 mm). Maximum release: 0 mm. Ease the pose or raise release.",
    ]
    out = reached((-0.0101, 0.0), (0.0, 0.0, 0.0))
    assert pulls(robot, [reached((-0.01, 0.0), (0.0, 0.0, 0.0))], limits) == []
    assert pulls(robot, [out], limits) == [
        'pose "wave": winch[0] up: payout too large (10.1 mm). Maximum release: 10 mm. Ease the pose or raise release.'
    ]


def test_what_motors_must_give(unchecked: None) -> None:
    """6 mm times the sum of the tensions of a winch's cables, 9 mm on a larger step."""
    robot = network(spool_radius=0.009, **third(0.15, -0.012))
    limits = Constraints(torque=0.054, spool_ratio=1.0, cables_per_winch=1)
    assert limits.tension_limit == pytest.approx(9.0)
    assert pulls(robot, [reached((0.0, 0.0), (6.0, 5.0, 4.0))], limits) == []
    assert pulls(robot, [reached((0.0, 0.0), (6.1, 5.0, 4.1))], limits) == [
        'pose "wave": winch[0] up: torque too high (0.0549 N m). Maximum: 0.054 N m. Ease the pose or raise torque.',
        'pose "wave": winch[1] down: torque too high (0.0546 N m). Maximum: 0.054 N m. Ease the pose or raise torque.',
    ]
