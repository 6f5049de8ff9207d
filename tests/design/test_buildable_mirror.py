"""Constraints of mirrored and of locked networks. Oracle: a network on a plate, with distances known by hand."""

from plate_networks import DOWN, UP, Points, broken, moved, network, third

from hydrostat.robot import Cable, Winch


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
