"""A robot's folder. The oracle is the robot that was saved, read again, and the comments that stood in the file."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from builders import gallery_robot
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hydrostat.control import Key, Timeline
from hydrostat.errors import InputError
from hydrostat.project import (
    PROJECT_FILE,
    Paint,
    Wishes,
    Work,
    changed_outside,
    folder_stamp,
    open_note,
    read_project_file,
    write_project_file,
)
from hydrostat.robot import (
    Robot,
    RobotReader,
    Winch,
    comments,
    gallery_folder,
    load_robot,
    lost_comments,
    merged_text,
    robot_text,
)
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.editing.change import change, rename, set_gravity
from hydrostat.studio.editing.part import keys_of, place_of
from hydrostat.studio.editing.place import add_cable, add_marker, add_pin, add_winch, insert_via, move, remove

pytestmark = pytest.mark.filterwarnings("error")

BODY = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<rect width="60" height="40"/></svg>'
)

COMMENTED = """\
# A robot with a remark in every place.
format = 1 # the format
name   =   "small" # its name
# end of the top

# apart

# of the body
[body] # header of the body
outline = "body.svg" # the drawing
element_size = "12mm" # coarse
thickness = "2 cm"
material = "polyester fibre" # fluffy

# all pins
[[pin]] # pin one
at = [ -20, 0.0 ] # odd form
radius = 12 # wide

# pin two
[[pin]]
box = [[25, -20], [30, 20]] # the far end

# all winches
[[winch]]
at = [-20, 5] # at comes first here
name = "left" # the left one
spool_radius = "3 mm"
travel = "20 mm"
# end of left

[[winch]]
name = "right"
at = [-20, -5]
spool_radius = "0.3 cm" # in centimeters
travel = "20 mm"

# all cables
[[cable]] # upper
winch = "left" # pulled by left
points = [
  [-20, 5], # at the winch
  [0, 10], # past the middle
  [10, 10], # further
  # nearly there
  [20, 10], # stopper
]
slack = "1 mm" # loose

# lower
[[cable]]
winch = "right"
points = [[-20, -5], [20, -10]] # straight

# all markers
[[marker]] # tip
name = "tip"
at = [25, 0] # at the end

[[marker]]
name = "middle" # not the end
at = [0, 0]

# all poses
[[pose]]
# how it waves
name = "wave"
[pose.targets] # places
tip = [20, 10] # up
middle = [0, 5]

[[pose]]
name = "rest" # as it lies
targets = { tip = [25, 0] } # home

# the end
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("small")
    (folder / "body.svg").write_text(BODY)
    (folder / "robot.toml").write_text(COMMENTED)
    return folder


@pytest.fixture(scope="module")
def robot(small: Path) -> Robot:
    return load_robot(small)


class Again(RobotReader):
    """Reads a robot with a body that is meshed already."""

    def __init__(self, text: str, robot: Robot) -> None:
        super().__init__(Path("robot.toml"), text)
        self.given = robot.body

    def _body(self):
        return self.given


def read_again(text: str, robot: Robot) -> Robot:
    return Again(text, robot).robot()


PLACES = st.tuples(st.integers(-280, 280), st.integers(-180, 180)).map(lambda at: (at[0] / 1e4, at[1] / 1e4))


def edited_once(data: st.DataObject, robot: Robot) -> Robot:
    """A robot after one edit of any kind, as it was if the edit is refused."""
    draw = data.draw
    key = draw(st.sampled_from([*keys_of(robot), "via:0:1", "via:0:2"]))
    at, number = draw(PLACES), draw(st.integers(1, 40)) / 1e4
    name, way, unit = (draw(st.sampled_from(some)) for some in (["one", "two", "three"], ["", "-y"], ["mm", "cm"]))
    actions = [
        lambda: move(robot, {key: at}) if place_of(robot, key) else robot,
        lambda: remove(robot, [key]),
        lambda: rename(robot, key, name),
        lambda: change(robot, [key], travel=number),
        lambda: change(robot, [key], slack=number, friction=0.1),
        lambda: change(robot, [key], slack=0.0),
        lambda: add_marker(robot, at),
        lambda: add_pin(robot, at),
        lambda: add_winch(robot, at),
        lambda: add_cable(robot, robot.winches[0].name, (at,)) if robot.winches else robot,
        lambda: insert_via(robot, 0, at)[0] if robot.cables else robot,
        lambda: set_gravity(robot, way),
        lambda: replace(robot, length_unit=unit),
        lambda: replace(robot, markers=robot.markers[::-1], cables=robot.cables[::-1]),
    ]
    try:
        return actions[draw(st.integers(0, len(actions) - 1))]()
    except InputError:
        return robot


@pytest.mark.slow
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_any_edits_are_read_again_and_lose_only_what_is_told(robot: Robot, data: st.DataObject) -> None:
    edited = robot
    for _ in range(data.draw(st.integers(1, 5))):
        edited = edited_once(data, edited)
    text = merged_text(COMMENTED, edited)
    assert read_again(text, edited) == edited
    assert read_again(text, edited).body == edited.body
    lost = lost_comments(COMMENTED, text)
    assert sorted([*comments(text), *lost]) == sorted(comments(COMMENTED))
    survivors = {winch.name for winch in edited.winches} | {marker.name for marker in edited.markers}
    for name, remarks in {
        "left": ["# the left one", "# end of left"],
        "tip": ["# at the end"],
        "middle": ["# not the end"],
    }.items():
        if name in survivors and all(part.name != "marker_1" for part in edited.markers):
            assert not set(remarks) & set(lost)
    general = ["# A robot with a remark in every place.", "# the format", "# apart", "# of the body", "# fluffy"]
    assert not set(general) & set(lost)


def test_what_did_not_change_is_left_to_the_letter(robot: Robot) -> None:
    assert merged_text(COMMENTED, robot) == COMMENTED
    assert merged_text(COMMENTED.rstrip("\n"), robot) == COMMENTED.rstrip("\n")
    assert "#" not in robot_text(robot)


def test_only_the_line_that_changed_is_another(robot: Robot) -> None:
    moved = merged_text(COMMENTED, move(robot, {"marker:tip": (0.024, 0.001)}))
    assert moved == COMMENTED.replace("at = [25, 0] # at", "at = [24, 1] # at")
    bent = merged_text(COMMENTED, move(robot, {"via:0:1": (0.0, 0.011)}))
    assert bent == COMMENTED.replace("[0, 10], # past", "[0, 11], # past")


def test_what_goes_takes_its_own_comments_and_no_others(robot: Robot) -> None:
    text = merged_text(COMMENTED, remove(robot, ["winch:left"]))
    told = ["# at comes first here", "# the left one", "# end of left", "# upper", "# pulled by left", "# at the winch",
            "# past the middle", "# further", "# nearly there", "# stopper", "# loose"]  # fmt: skip
    assert lost_comments(COMMENTED, text) == told
    assert text.index("# all winches") < text.index('name = "right"')
    assert text.index("# all cables") < text.index("# lower") < text.index('winch = "right"')


@pytest.mark.parametrize("text", ["", "not TOML at all [", "format = 2\n", 'format = 1\nname = "x"\n# alone\n'])
def test_what_is_no_robot_is_replaced(robot: Robot, text: str) -> None:
    assert merged_text(text, robot) == robot_text(robot)


def test_an_unusual_form_is_replaced_and_that_is_told(robot: Robot) -> None:
    unusual = COMMENTED[: COMMENTED.index("# all poses")].replace(
        "# apart", 'pose = [{ name = "wave", targets = { tip = [1, 2] } }] # in one line'
    )
    text = merged_text(unusual, robot)
    assert read_again(text, robot) == robot
    assert "# in one line" in lost_comments(unusual, text)


def work_of(robot: Robot) -> Work:
    timeline = Timeline(keys=(Key(time=0.5, contractions={"left": 0.01}),), smooth=True)
    from hydrostat.design import Zone

    wishes = Wishes.of(winches=3, zones=((Paint.STILL, Zone(at=(0.0, 0.0), radius=0.01)),), mirror="y", tolerance=0.002)
    return Work(robot=robot, timeline=timeline, wishes=wishes)


@pytest.mark.slow
def test_a_file_that_numbers_kept_cables_is_still_read(tmp_path: Path) -> None:
    """Oracle: the names of the cables; numbers counted from 0 there. One that is gone is passed over."""
    robot = load_robot(gallery_folder("starfish"))
    Work(robot=robot, wishes=Wishes(kept_cables=("left 1",))).save(tmp_path / "kept")
    assert Work.open(tmp_path / "kept").wishes.kept_cables == ("left 1",)
    file = tmp_path / "kept" / "studio.json"
    read = json.loads(file.read_text())
    read["wishes"]["kept_cables"] = [0, 3, 99]
    file.write_text(json.dumps(read))
    assert Work.open(tmp_path / "kept").wishes.kept_cables == (robot.cables[0].name, robot.cables[3].name)
    assert open_note(tmp_path / "kept") == ""


def test_all_work_is_read_again(robot: Robot, tmp_path: Path) -> None:
    work = work_of(robot)
    work.save(tmp_path / "new" / "robot")
    again = Work.open(tmp_path / "new" / "robot")
    assert (again.robot, again.timeline, again.wishes) == (work.robot, work.timeline, work.wishes)
    assert open_note(tmp_path / "new" / "robot") == ""
    assert not list((tmp_path / "new" / "robot").glob(".*"))


@pytest.mark.parametrize("ratio", [1.0, 1.5, 2.0])
def test_a_spool_ratio_is_read_as_it_was_written(tmp_path: Path, ratio: float) -> None:
    wishes = Wishes.of(spool_ratio=ratio)
    write_project_file(tmp_path, Timeline(), wishes)
    assert read_project_file(tmp_path)[1] == wishes
    assert ("spool_ratio" in (tmp_path / PROJECT_FILE).read_text()) is (ratio == 1.5)


@pytest.mark.parametrize(("value", "told"), [(None, "nothing"), ("20 N", '"20 N"'), (-3, "-3 N"), (True, "true")])
def test_a_tension_that_is_no_number_is_refused(value: object, told: str) -> None:
    with pytest.raises(InputError, match=f"^tension must be above 0 and at most 1000 N, not {told}$"):
        Wishes.of(tension=value)


def test_a_plain_robot_needs_no_second_file(robot: Robot, tmp_path: Path) -> None:
    """One with cables does: a kit that is made of the folder keeps to the limits that its poses had here."""
    plain = robot.with_network((), ())
    Work(robot=plain).save(tmp_path)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["body.svg", "robot.toml"]
    assert Work(robot=plain).warnings(tmp_path, folder_stamp(tmp_path)) == []
    Work(robot=robot).save(tmp_path)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["body.svg", "robot.toml", "studio.json"]
    assert Work(robot=robot).warnings(tmp_path, folder_stamp(tmp_path)) == []


@pytest.mark.parametrize(
    ("before", "after"),
    [("{", "["), ('"format": 1', '"format": 2'), ('"winches"', '"wenches"'), ('"winches": 3', '"winches": "3"'),
     ('"time": 0.5', '"time": NaN'), ('"time": 0.5', '"time": -1.0'), ('"radius": 0.01', '"radius": -1.0')],
)  # fmt: skip
def test_a_broken_studio_file_is_told_in_one_line(robot: Robot, tmp_path: Path, before: str, after: str) -> None:
    work_of(robot).save(tmp_path)
    file = tmp_path / "studio.json"
    assert before in file.read_text()
    file.write_text(file.read_text().replace(before, after, 1))
    again = Work.open(tmp_path)
    assert again.robot == robot
    assert (again.timeline, again.wishes) == (Timeline(), Wishes())
    assert "studio.json" in open_note(tmp_path)
    assert "\n" not in open_note(tmp_path)
    assert len(open_note(tmp_path)) < 400
    assert "replaced" in again.warnings(tmp_path, folder_stamp(tmp_path))[-1]


def test_comments_stay_when_saved(robot: Robot, tmp_path: Path) -> None:
    Work(robot=robot).save(tmp_path)
    (tmp_path / "robot.toml").write_text(COMMENTED)
    stamp = folder_stamp(tmp_path)
    edited = Work(robot=remove(move(robot, {"marker:tip": (0.024, 0.0)}), ["marker:middle"]))
    assert edited.comments_lost(tmp_path) == ["# not the end"]
    assert "# not the end" in edited.warnings(tmp_path, stamp)[0]
    edited.save(tmp_path)
    assert lost_comments(COMMENTED, (tmp_path / "robot.toml").read_text()) == ["# not the end"]
    assert Work.open(tmp_path).robot == edited.robot


def test_what_others_wrote_is_asked_about(robot: Robot, tmp_path: Path) -> None:
    work = Work(robot=robot)
    assert work.warnings(tmp_path) == []
    assert not changed_outside(tmp_path, "")
    work.save(tmp_path)
    assert "already" in work.warnings(tmp_path)[0]
    stamp = folder_stamp(tmp_path)
    assert not changed_outside(tmp_path, stamp)
    (tmp_path / "robot.toml").write_text((tmp_path / "robot.toml").read_text() + "# mine\n")
    assert changed_outside(tmp_path, stamp)
    assert "another program" in work.warnings(tmp_path, stamp)[0]


def test_a_file_that_is_not_of_the_robot_is_asked_about(robot: Robot, tmp_path: Path) -> None:
    """Oracle: a drawing of a person's own that has the name of the body's file, with and without a robot.toml."""
    work = Work(robot=robot)
    (tmp_path / "body.svg").write_bytes(robot.body.content)
    assert work.warnings(tmp_path) == []
    (tmp_path / "body.svg").write_text("mine")
    assert "body.svg" in work.warnings(tmp_path)[0]
    work.save(tmp_path)
    stamp = folder_stamp(tmp_path)
    (tmp_path / "other.svg").write_text("mine")
    other = Work(robot=replace(robot, body=replace(robot.body, file="other.svg")))
    assert "other.svg" in other.warnings(tmp_path, stamp)[0]


def test_a_body_that_others_changed_is_asked_about_but_not_a_new_outline(robot: Robot, tmp_path: Path) -> None:
    """Oracle: the file of the body as it was when the robot was opened."""
    work = Work(robot=robot)
    work.save(tmp_path)
    stamp = folder_stamp(tmp_path)
    drawn = Work(robot=replace(robot, body=replace(robot.body, content=BODY.replace("40", "42").encode())))
    assert drawn.warnings(tmp_path, stamp) == []
    (tmp_path / "body.svg").write_text(BODY.replace("40", "41"))
    assert "another program" in drawn.warnings(tmp_path, stamp)[0]


def test_names_that_the_file_does_not_allow_are_refused(robot: Robot, tmp_path: Path) -> None:
    wrong = replace(robot, winches=(*robot.winches, Winch(name="a/b", at=(0.0, 0.0))))
    with pytest.raises(InputError, match="letters"):
        Work(robot=wrong).save(tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_gallery_is_left_to_the_letter() -> None:
    text = (gallery_folder("starfish") / "robot.toml").read_text(encoding="utf-8")
    assert merged_text(text, gallery_robot("starfish")) == text


def test_a_document_knows_how_its_folder_was(robot: Robot, tmp_path: Path) -> None:
    document = Document(Bell())
    Work(robot=robot).save(tmp_path)
    document.open(Work.open(tmp_path), folder=tmp_path)
    assert document.work.warnings(tmp_path, document.stamp) == []
    (tmp_path / "robot.toml").write_text((tmp_path / "robot.toml").read_text() + "# mine\n")
    assert changed_outside(tmp_path, document.stamp)
    document.work.save(tmp_path)
    document.mark_saved(tmp_path, document.work)
    assert document.work.warnings(tmp_path, document.stamp) == []
    assert "# mine" in (tmp_path / "robot.toml").read_text()
    document.open(Work(robot=robot))
    assert document.stamp == ""
