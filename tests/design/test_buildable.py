"""What breaks constraints. Oracle: a network on a plate whose distances and angles are known by hand.

Each case is a network that keeps a constraint by 0.1 mm or 0.2 degrees, and one that breaks it by as much, and nothing
else.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh
from plate_networks import (
    DOWN,
    FAN,
    HAIR,
    STRAIGHT_DOWN,
    STRAIGHT_UP,
    UP,
    Points,
    broken,
    corner,
    high,
    moved,
    network,
    third,
)

from hydrostat.design.buildable import pulls
from hydrostat.design.constraints import Constraints
from hydrostat.design.zone import Zone
from hydrostat.robot import Cable, Mount, PoseTarget, Winch

LEADS = {"leads": False, "passive_zones": (Zone(box=((0.04, 0.02), (0.07, 0.04))),)}
ROUND = {"max_turn": 180.0, "bend_radius": 0.02}

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
    "passive_zones": (
        {"passive_zones": (Zone(at=(0.045, 0.03), radius=0.005),)},
        {"sheathed": ((0, 1),)},
        {"sheathed": ((1, 2),)},
        "cable[0] between points 0 and 1: no sheath in passive_zones[0] (5 mm deep). Allowed: outside.",
    ),
    "passive beside a bare segment": (
        {"passive_zones": (Zone(at=(0.045, 0.02), radius=0.01),)},
        {"up": ((0.03, 0.03 + HAIR), (0.06, 0.03 + HAIR), *UP[2:])},
        {"up": ((0.03, 0.03 - HAIR), (0.06, 0.03 - HAIR), *UP[2:])},
        "cable[0] between points 0 and 1: no sheath in passive_zones[0] (0.1 mm deep). Allowed: outside.",
    ),
    "no leads": (
        {"leads": False},
        {},
        {"sheathed": ((0, 1),)},
        "cable[0] between points 0 and 1: sheath outside passive zones. Not allowed without leads.",
    ),
    "no leads but in passive zones": (
        LEADS,
        {"sheathed": ((0, 2),)},
        {"sheathed": ((0, 3),), "up": (*UP, (0.18, 0.03))},
        "cable[0] between points 2 and 3: sheath outside passive zones. Not allowed without leads.",
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
    "max_turn": ({}, {"up": corner(74.8)}, {"up": corner(75.2)}, "cable[0].points[1]: turn too sharp (75.2 degrees)."),
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
    "max_length": (
        {"max_length": 0.13},
        {"up": moved(UP, 3, 0.16 - HAIR, 0.03)},
        {"up": moved(UP, 3, 0.16 + HAIR, 0.03)},
        "cable[0]: too long (130.1 mm). Maximum: 130 mm. Shorten it.",
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
    """But forces, which `pulls` looks at, mirror, locks, room for units, skin and drawings: tested elsewhere."""
    tested = {name.split()[0] for name in CASES} | {"hole_gap", "leads"}
    others = {
        "tension",
        "torque",
        "mirror",
        "locked_winches",
        "locked_cables",
        "built_in",
        "depth",
        "motor",
        "drawing_gap",
    }
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


def test_a_cable_from_the_world_does_not_come_back_past_its_winch() -> None:
    """Oracle: a way back at 3 mm from the winch, and one at 37 mm."""
    for aside, count in ((0.004, 1), (0.045, 0)):
        into: Points = ((0.03, 0.0), (0.15, 0.0), (0.01, aside))
        told = broken(network(into, winch={"mount": Mount.WORLD}))
        words = "cable[0].points[1]: the cable turns back past its own winch (by 178"
        assert sum(line.startswith(words) for line in told) == count


def test_a_cable_may_pass_its_own_winch() -> None:
    assert broken(network(more=[("down", (DOWN[0], (0.032, -0.038), (0.06, -0.039)))])) == []


def test_rounding_breaks_nothing() -> None:
    """Coordinates to 0.01 mm, of points that lie on their limits."""
    away = 0.045 + 4.9e-6
    assert broken(network(up=moved(UP, 3, 0.15, away))) == []
    assert broken(network(up=corner(75.05))) == []
    assert broken(network(), winch_clearance=0.02, winch_gap=0.06, max_length=0.12, cables_per_winch=1) == []


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
