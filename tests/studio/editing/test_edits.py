"""Each edit is a pure function of a robot. The oracle is what was there before, and arithmetic by hand."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.control import Key, Timeline
from hydrostat.errors import InputError, in_words
from hydrostat.geometry import locate
from hydrostat.project import Wishes, Work
from hydrostat.robot import Contact, Mount, Robot, find_risks
from hydrostat.studio.editing.cable_draft import begin_cable, end_cable
from hydrostat.studio.editing.change import change, remesh, rename, set_contact, set_gravity, sheathed_segments, sheaths
from hydrostat.studio.editing.hold import below_skin, inside
from hydrostat.studio.editing.part import Mirror, find_part, keys_of, place_of
from hydrostat.studio.editing.place import add_cable, add_marker, add_pin, add_winch, insert_via, move, remove

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return gallery_robot("starfish")


@pytest.fixture(scope="module")
def tongue() -> Robot:
    return gallery_robot("tongue")


@pytest.mark.parametrize("name", ["starfish", "tongue"])
def test_every_key_names_a_part_with_a_place(name: str) -> None:
    robot = gallery_robot(name)
    keys = keys_of(robot)
    parts = len(robot.pins) + len(robot.winches) + len(robot.cables) + len(robot.markers)
    assert len(set(keys)) == len(keys) == parts
    assert all(find_part(robot, key) is not None for key in keys)
    assert all((place_of(robot, key) is None) == key.startswith("cable") for key in keys)


@pytest.mark.parametrize("key", ["", "body", "pin:9", "pin:-1", "cable:x", "via:0:0", "via:0:99", "via:0", "winch:"])
def test_other_keys_name_nothing(starfish: Robot, key: str) -> None:
    assert find_part(starfish, key) is None
    assert place_of(starfish, key) is None


def test_only_what_is_moved_moves(starfish: Robot) -> None:
    moved = move(starfish, {"marker:top": (0.01, 0.11), "via:1:3": (-0.07, 0.02), "pin:0": (0.0, -0.02)})
    assert moved.markers[0].at == (0.01, 0.11)
    assert moved.cables[1].points[3] == (-0.07, 0.02)
    assert moved.pins[0].at == (0.0, -0.02)
    back = {key: place_of(starfish, key) for key in ("marker:top", "via:1:3", "pin:0")}
    assert move(moved, {key: at for key, at in back.items() if at is not None}) == starfish


def test_cables_follow_their_winch_and_other_cables_do_not(starfish: Robot) -> None:
    moved = move(starfish, {"winch:left": (-0.022, -0.006)})
    assert moved.winch("left").at == (-0.022, -0.006)
    for before, after in zip(starfish.cables, moved.cables, strict=True):
        if before.winch == "left":
            assert after.points[0] == (-0.022, -0.006)
            assert after.points[1:] == before.points[1:]
        else:
            assert after == before


def test_a_cable_that_begins_beside_its_winch_keeps_the_gap(starfish: Robot) -> None:
    cable = starfish.cables[0]
    beside = replace(
        starfish, cables=(replace(cable, points=((0.024, -0.005), *cable.points[1:])), *starfish.cables[1:])
    )
    moved = move(beside, {"winch:right": (0.021, -0.009)})
    assert moved.cables[0].points[0] == pytest.approx((0.025, -0.006))


def test_a_box_moves_as_a_whole() -> None:
    robot = next(
        found for name in ("tongue", "trunk", "fish_tail", "octopus_arm")
        if (found := gallery_robot(name)).pins[0].box is not None
    )  # fmt: skip
    middle = place_of(robot, "pin:0")
    assert middle is not None
    moved = move(robot, {"pin:0": tuple(np.array(middle) + 0.001)})
    assert np.allclose(np.array(moved.pins[0].box), np.array(robot.pins[0].box) + 0.001, atol=1e-12)


def test_no_part_goes_where_it_cannot_be(starfish: Robot) -> None:
    for key in ("marker:top", "via:0:2", "winch:left"):
        with pytest.raises(InputError, match="outside"):
            move(starfish, {key: (0.2, 0.2)})
    with pytest.raises(InputError, match="pin"):
        move(starfish, {"pin:0": (0.5, 0.5)})
    with pytest.raises(InputError, match="cannot be moved"):
        move(starfish, {"cable:0": (0.0, 0.0)})


def test_new_parts_have_names_of_their_own(starfish: Robot) -> None:
    robot = add_marker(add_marker(starfish, (0.0, 0.0)), (0.01, 0.0))
    assert [marker.name for marker in robot.markers[-2:]] == ["marker_1", "marker_2"]
    robot = add_winch(robot, (0.0, 0.01))
    assert robot.winches[-1].name == "winch_1"
    assert robot.winches[-1].spool_radius == starfish.winches[-1].spool_radius
    robot = add_cable(robot, "winch_1", ((0.0, 0.03), (0.0, 0.05)))
    assert robot.cables[-1].points == ((0.0, 0.01), (0.0, 0.03), (0.0, 0.05))
    robot = add_pin(robot, (0.0, 0.0))
    assert robot.pins[-1].radius == starfish.pins[0].radius


def test_a_via_point_is_put_between_its_neighbors_and_sheaths_keep_their_segments(starfish: Robot) -> None:
    sheathed = change(starfish, ["cable:0"], sheathed=((0, 1), (3, 5)))
    points = sheathed.cables[0].points
    at = tuple(((np.array(points[2]) + points[3]) / 2).tolist())
    robot, place = insert_via(sheathed, 0, at)
    assert place == 3
    assert robot.cables[0].points == (*points[:3], at, *points[3:])
    assert robot.cables[0].sheathed == ((0, 1), (4, 6))
    assert remove(robot, ["via:0:3"]) == sheathed
    within, place = insert_via(sheathed, 0, tuple(((np.array(points[3]) + points[4]) / 2).tolist()))
    assert place == 4
    assert within.cables[0].sheathed == ((0, 1), (3, 6))


def test_the_cables_of_a_winch_go_with_it(starfish: Robot) -> None:
    robot = remove(starfish, ["winch:left"])
    assert [winch.name for winch in robot.winches] == ["right", "feet"]
    assert [cable.winch for cable in robot.cables] == ["right", "feet", "feet"]
    assert robot.markers == starfish.markers


def test_a_marker_leaves_its_poses_and_a_pose_without_markers_goes(starfish: Robot) -> None:
    robot = remove(starfish, ["marker:top"])
    assert all("top" not in pose.targets and len(pose.targets) == 4 for pose in robot.poses.values())
    assert not remove(starfish, [f"marker:{marker.name}" for marker in starfish.markers]).poses


def test_what_a_robot_cannot_do_without_stays(starfish: Robot) -> None:
    with pytest.raises(InputError, match="last pin"):
        remove(starfish, ["pin:0"])
    short = add_cable(starfish, "left", ((-0.04, 0.0),))
    with pytest.raises(InputError, match="stopper"):
        remove(short, ["via:5:1"])
    with pytest.raises(InputError, match="unknown part winch:nobody"):
        remove(starfish, ["winch:nobody"])


def test_the_point_before_a_lost_stopper_becomes_the_stopper(starfish: Robot) -> None:
    sheathed = change(starfish, ["cable:0"], sheathed=((4, 6),))
    robot = remove(sheathed, ["via:0:6"])
    assert robot.cables[0].points == starfish.cables[0].points[:-1]
    assert robot.cables[0].sheathed == ((4, 5),)


def test_names_are_changed_everywhere(starfish: Robot) -> None:
    robot = rename(rename(starfish, "winch:feet", "legs"), "marker:top", "head")
    assert [cable.winch for cable in robot.cables] == ["right", "left", "left", "legs", "legs"]
    assert all("head" in pose.targets and "top" not in pose.targets for pose in robot.poses.values())
    assert rename(rename(robot, "winch:legs", "feet"), "marker:head", "top") == starfish
    for key, name, words in (
        ("winch:feet", "left", "already in use"),
        ("marker:top", "a/b", "letters"),
        ("cable:0", "left 1", "already in use"),
        ("cable:0", "a/b", "letters"),
        ("pin:0", "x", "no name"),
    ):
        with pytest.raises(InputError, match=words):
            rename(starfish, key, name)


def test_names_of_cables(starfish: Robot) -> None:
    """Oracle: by hand: a name that was given stays, one made up of the winch's follows the winch."""
    robot = rename(starfish, "cable:1", "thumb")
    assert [cable.name for cable in robot.cables] == ["right 1", "thumb", "left 2", "feet 1", "feet 2"]
    legs = rename(rename(robot, "winch:left", "arm"), "winch:feet", "legs")
    assert [cable.name for cable in legs.cables] == ["right 1", "thumb", "arm 2", "legs 1", "legs 2"]
    assert rename(robot, "cable:1", "left 1") == starfish
    near = replace(robot, winches=(*robot.winches, replace(robot.winch("left"), name="near")))
    moved = change(near, ["cable:1", "cable:2"], winch="near")
    assert [cable.name for cable in moved.cables] == ["right 1", "thumb", "near 2", "feet 1", "feet 2"]
    assert [cable.name for cable in remove(robot, ["cable:3"]).cables] == ["right 1", "thumb", "left 2", "feet 2"]


def test_numbers_are_changed_of_all_parts_named(starfish: Robot) -> None:
    robot = change(starfish, ["winch:left", "winch:right"], travel=0.05)
    assert [winch.travel for winch in robot.winches] == [0.05, 0.05, 0.06]
    assert change(starfish, ["pin:0"], radius=0.02).pins[0].radius == 0.02
    for key, values, words in (
        ("winch:left", {"spool_radius": -1.0}, "spool radius"),
        ("cable:0", {"friction": 9.0}, "friction"),
        ("marker:top", {"radius": 1.0}, "no radius"),
        ("pin:0", {"radius": 0.0001}, "pins hold too few"),
    ):
        with pytest.raises(InputError, match=words):
            change(starfish, [key], **values)


def test_cables_begin_in_a_winch_that_is_taken_out_of_the_body(starfish: Robot) -> None:
    cable = starfish.cables[0]
    beside = replace(
        starfish, cables=(replace(cable, points=((0.024, -0.005), *cable.points[1:])), *starfish.cables[1:])
    )
    robot = change(beside, ["winch:right"], mount=Mount.WORLD)
    assert robot.cables[0].points[0] == robot.winch("right").at


def test_gravity_has_a_direction_of_the_body(starfish: Robot) -> None:
    assert set_gravity(starfish, "-y").gravity == (0.0, -9.80665)
    assert set_gravity(set_gravity(starfish, "-y"), "").gravity is None
    with pytest.raises(InputError, match="-z"):
        set_gravity(starfish, "-z")


def test_contact_is_switched_on_and_off(starfish: Robot) -> None:
    assert set_contact(starfish, on=True).contact == Contact()
    assert set_contact(set_contact(starfish, on=True), on=False) == starfish


def test_twins_are_found_by_place(starfish: Robot) -> None:
    mirror = Mirror(axis=0)
    assert mirror.twin(starfish, "winch:left") == "winch:right"
    assert mirror.twin(starfish, "marker:right_foot") == "marker:left_foot"
    assert mirror.twin(starfish, "cable:0") == "cable:1"
    assert mirror.twin(starfish, "via:3:4") == "via:4:4"
    assert mirror.twin(starfish, "winch:feet") is None
    assert mirror.holds(starfish, "winch:feet")
    assert mirror.twin(starfish, "marker:top") is None
    assert mirror.twin(starfish, "cable:2") is None


def test_a_cable_is_laid_from_the_winch_that_is_near(starfish: Robot) -> None:
    assert begin_cable(starfish, (-0.024, -0.008)).winch == "left"
    assert begin_cable(starfish, (0.1, 0.03), "winch:feet").points == (starfish.winch("feet").at,)
    draft = begin_cable(starfish, (0.0, 0.03)).through((0.0, 0.05))
    assert draft.winch is None
    robot = end_cable(starfish, draft)
    assert robot.winches[-1].at == (0.0, 0.03)
    assert robot.cables[-1].winch == robot.winches[-1].name
    with pytest.raises(InputError, match="stopper"):
        end_cable(starfish, begin_cable(starfish, (0.0, 0.03)))


def test_a_mirrored_cable_has_a_twin_at_the_twin_winch(starfish: Robot) -> None:
    mirror = Mirror(axis=0)
    draft = begin_cable(starfish, (0.0, 0.0), "winch:left").through((-0.04, 0.005))
    robot = end_cable(starfish, draft, mirror)
    assert [cable.winch for cable in robot.cables[-2:]] == ["left", "right"]
    assert robot.cables[-1].points == tuple(mirror.point(point) for point in robot.cables[-2].points)
    shared = end_cable(starfish, begin_cable(starfish, (0.0, 0.0), "winch:feet").through((0.02, -0.05)), mirror)
    assert [cable.winch for cable in shared.cables[-2:]] == ["feet", "feet"]
    fresh = end_cable(starfish, begin_cable(starfish, (0.03, 0.02)).through((0.06, 0.02)), mirror)
    assert len(fresh.winches) == len(starfish.winches) + 2
    on_plane = end_cable(starfish, begin_cable(starfish, (0.0, 0.03)).through((0.0, 0.05)), mirror)
    assert len(on_plane.cables) == len(starfish.cables) + 1


@pytest.mark.parametrize("name", ["starfish", "tongue"])
def test_any_place_is_held_inside_the_body(name: str) -> None:
    body = gallery_robot(name).body
    rng = np.random.default_rng(3)
    for point in rng.uniform(-0.2, 0.2, (20, body.mesh.dim)):
        asked = tuple(point.tolist())
        held = inside(body, asked)
        assert not body.distances(np.array([held])).any()
        far = float(locate(body.mesh, np.array([asked])).distances[0])
        assert np.linalg.norm(np.subtract(held, asked)) <= far + 1.5e-4


def test_winches_are_placed_below_the_skin(tongue: Robot) -> None:
    mesh = tongue.body.mesh
    facet = mesh.nodes[mesh.boundary[len(mesh.boundary) // 2]]
    on_skin = tuple(facet.mean(axis=0).tolist())
    deep = below_skin(tongue.body, on_skin, 0.004)
    assert not tongue.body.distances(np.array([deep])).any()
    assert 0.001 < np.linalg.norm(np.subtract(deep, on_skin)) <= 0.0042
    assert np.linalg.norm(np.subtract(below_skin(tongue.body, on_skin, 0.0), on_skin)) < 2e-4


def test_a_body_is_meshed_anew_only_for_other_elements(starfish: Robot) -> None:
    other = remesh(starfish, thickness=0.03, material="flexfoam-it x")
    assert other.mesh is starfish.body.mesh
    assert (other.thickness, other.material.name) == (0.03, "flexfoam-it x")
    coarse = remesh(starfish, element_size=0.02)
    assert len(coarse.mesh.elements) < len(starfish.body.mesh.elements)
    assert coarse.material == starfish.body.material
    assert replace(coarse, element_size=starfish.body.element_size) == starfish.body


def test_segments_and_sheaths_are_the_same_thing_said_twice(starfish: Robot) -> None:
    assert sheaths([0, 2, 3, 5]) == ((0, 1), (2, 4), (5, 6))
    for segments in ([], [1], [0, 1, 4], [5, 3]):
        cable = replace(starfish.cables[0], sheathed=sheaths(segments))
        assert sheathed_segments(cable) == sorted(segments)


def test_keyframes_and_wishes_follow(starfish: Robot) -> None:
    timeline = Timeline(keys=(Key(time=0.0, contractions={"left": 0.01, "feet": 0.02}),))
    work = Work(robot=starfish, timeline=timeline, wishes=Wishes(poses=("wave", "star_jump")))
    renamed = rename(starfish, "winch:feet", "legs")
    assert work.follow_robot(renamed, {"feet": "legs"})[0].keys[0].contractions == {"left": 0.01, "legs": 0.02}
    gone = remove(starfish, ["winch:feet", *(f"marker:{marker.name}" for marker in starfish.markers)])
    after, wishes = work.follow_robot(gone)
    assert after.keys[0].contractions == {"left": 0.01}
    assert wishes.poses == ()


def test_what_is_kept_follows(starfish: Robot) -> None:
    """Oracle: the cables and winches themselves, wherever they are now."""
    names = (starfish.cables[0].name, starfish.cables[3].name)
    work = Work(robot=starfish, wishes=Wishes(kept_winches=("feet", "left"), kept_cables=names))
    gone = remove(starfish, ["cable:1"])
    wishes = work.follow_robot(gone)[1]
    assert [gone.cable(name) for name in wishes.kept_cables] == [starfish.cables[0], starfish.cables[3]]
    assert wishes.kept_winches == ("feet", "left")
    assert work.follow_robot(remove(starfish, ["cable:3"]))[1].kept_cables == names[:1]
    legs = rename(starfish, "winch:feet", "legs")
    renamed = work.follow_robot(legs, {"feet": "legs"})[1]
    assert renamed.kept_winches == ("legs", "left")
    assert renamed.kept_cables == (legs.cables[0].name, legs.cables[3].name) != names
    assert work.follow_robot(remove(starfish, ["via:0:2"]))[1] is work.wishes
    bare = remove(starfish, ["winch:feet"])
    assert work.follow_robot(bare)[1].kept_winches == ("left",)


def test_a_design_keeps_what_it_has_kept(starfish: Robot) -> None:
    """Oracle: a network in another order, in which one winch has an old name at another place."""
    names = (starfish.cables[0].name, starfish.cables[3].name)
    work = Work(robot=starfish, wishes=Wishes(kept_winches=("feet", "left"), kept_cables=names))
    winches = [replace(winch, at=(0.0, -0.03)) if winch.name == "feet" else winch for winch in starfish.winches]
    changed = replace(starfish.cables[0], slack=0.002)
    made = starfish.with_network(winches, [starfish.cables[3], changed, *starfish.cables[1:3]])
    wishes = work.after_design(made)
    assert wishes.kept_winches == ("left",)
    assert [made.cable(name) for name in wishes.kept_cables] == [starfish.cables[3]]


def test_risks_are_told_in_the_words_of_the_screen(starfish: Robot) -> None:
    alone = remove(starfish, ["cable:0"])
    assert [in_words(risk) for risk in find_risks(alone)] == ["winch right: pulls no cable"]
    assert in_words("cable[0], cable[1] and cable[4]: too long (cable[4] is the worst)") == (
        "cable 1, cable 2 and cable 5: too long (cable 5 is the worst)"
    )
