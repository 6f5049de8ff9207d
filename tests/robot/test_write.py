"""A robot is written and read without loss."""

import tomllib
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import meshio
import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from robot_files import GOOD, MAXIMAL_IN, edit, load, mesh_once, robot_folder

from hydrostat.errors import InputError
from hydrostat.robot import (
    MATERIALS,
    Cable,
    Marker,
    Material,
    Mount,
    Pin,
    PoseTarget,
    PronyTerm,
    Robot,
    Volume,
    Winch,
    gallery_folder,
    list_gallery,
    load_robot,
    robot_hash,
    robot_text,
    save_robot,
)
from hydrostat.robot.cable import name_cables
from hydrostat.robot.pin import take_pins

MESHED = """\
format = 1
name = "meshed"
length_unit = "{unit}"

[body]
mesh = "body.{ending}"
material = "FlexFoam-iT X"
{extra}

[[pin]]
box = [{box}]

[[winch]]
name = "only"
at = [{at}]

[[cable]]
winch = "only"
points = [[{at}], [{end}]]
"""


def check_round_trip(robot: Robot, folder: Path) -> str:
    """The text of a robot that came back equal, in text, hash and every bit of its records."""
    again = load_robot(save_robot(robot, folder))
    assert again == robot
    assert robot_text(again) == robot_text(robot) == (folder / "robot.toml").read_text(encoding="utf-8")
    assert robot_hash(again) == robot_hash(robot)
    assert again.body.content == robot.body.content
    assert again.body.mesh.nodes.tobytes() == robot.body.mesh.nodes.tobytes()
    assert again.body.mesh.elements.tobytes() == robot.body.mesh.elements.tobytes()
    return robot_text(robot)


@pytest.mark.parametrize("name", list_gallery())
@pytest.mark.slow
def test_gallery(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the robot itself, read again; and the gallery's own file, number by number."""
    mesh_once(monkeypatch)
    text = check_round_trip(load_robot(gallery_folder(name)), tmp_path)
    old = tomllib.loads((gallery_folder(name) / "robot.toml").read_text(encoding="utf-8"))
    new = tomllib.loads(text)
    for kind in ("marker", "pose"):
        assert new[kind] == old[kind]
    assert [cable["points"] for cable in new.get("cable", [])] == [cable["points"] for cable in old.get("cable", [])]


@pytest.mark.parametrize("unit", MAXIMAL_IN)
def test_every_key(unit: str, tmp_path: Path) -> None:
    """Oracle: the file's numbers, converted by hand, and the robot itself, read again."""
    robot = load(tmp_path / "here", MAXIMAL_IN[unit])
    factor = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254}[unit]
    assert robot.length_unit == unit
    assert robot.body.size == 0.06
    assert robot.body.thickness == 0.0205
    branches = (PronyTerm(modulus=1700, time=0.03), PronyTerm(modulus=450, time=30))
    material = Material(young=31.7e3, poisson=0.35, density=41.1, viscosity=12.3, relaxation=branches)
    assert robot.body.material == material
    assert robot.body.volume is Volume.PATCH
    assert robot.gravity == (0.3, -9.81)
    assert [pin.stiffness for pin in robot.pins] == [100e3, 12.3e3, 3e4]
    assert robot.pins[0].radius == pytest.approx({"mm": 10.1, "cm": 1.01, "in": 0.35}[unit] * factor, rel=1e-15)
    assert robot.winch("世界").mount is Mount.WORLD
    assert robot.winch("世界").at == pytest.approx((-9 * factor, 0.7 * factor), rel=1e-15)
    inner = robot.winch("in the body")
    assert (inner.spool_radius, inner.travel, inner.release, inner.mount) == (0.003, 0.02, 0.0013, Mount.BODY)
    cable = robot.cables[0]
    assert (cable.stiffness, cable.smoothing, cable.slack, cable.sheathed) == (4400, 0.0007, 0.002, ((0, 1), (2, 3)))
    assert [cable.friction for cable in robot.cables] == [0.15, 0.0]
    assert [cable.spool_radius for cable in robot.cables] == [0.0045, None]
    assert robot.spool_ratios == pytest.approx([1.5, 1.0], rel=1e-15)
    assert robot.pose("wave").targets["हाथ"] == pytest.approx((-1e-3 * factor, 1e3 * factor))
    assert list(robot.poses) == ["wave", "rest"]
    check_round_trip(robot, tmp_path / "there")


@pytest.mark.parametrize(("unit", "meters"), [("mm", 1e-3), ("in", 0.0254)])
@pytest.mark.parametrize("ending", ["vtk", "vtu", "msh"])
def test_triangles(unit: str, meters: float, ending: str, tmp_path: Path) -> None:
    """Oracle: the mesh that meshio wrote, in meters, and the robot itself, read again."""
    mesh = strip_mesh(4, 2, size=(8.0, 4.0))
    nodes = np.pad(mesh.nodes, ((0, 0), (0, 1)))
    robot_folder(tmp_path / "here")
    path, form = tmp_path / "here" / f"body.{ending}", {"msh": "gmsh"}.get(ending)
    meshio.write(path, meshio.Mesh(nodes, [("triangle", mesh.elements)]), file_format=form)
    flat = {"extra": 'thickness = "3 mm"', "box": "[-1, -9], [0.1, 9]", "at": "1, 0", "end": "7, 1"}
    robot = load(tmp_path / "here", MESHED.format(unit=unit, ending=ending, **flat))
    assert robot.body.mesh.nodes == pytest.approx(mesh.nodes * meters)
    assert robot.body.material.name == "flexfoam-it x"
    check_round_trip(robot, tmp_path / "there")


@pytest.mark.parametrize("size", [None, "0.13 m"])
def test_tetrahedra(size: str | None, tmp_path: Path) -> None:
    """Oracle: the mesh that meshio wrote, in meters or scaled to the size asked, and the robot itself, read again."""
    mesh = box_mesh((2, 1, 1), size=(8.0, 4.0, 4.0))
    robot_folder(tmp_path / "here")
    meshio.write(tmp_path / "here" / "body.vtk", meshio.Mesh(mesh.nodes, [("tetra", mesh.elements)]))
    extra = f'size = "{size}"' if size else ""
    space = {"extra": extra, "box": "[-1, -1, -1], [0.1, 999, 999]", "at": "1, 1, 1", "end": "7, 2, 3"}
    robot = load(tmp_path / "here", MESHED.format(unit="mm" if size else "cm", ending="vtk", **space))
    assert robot.body.mesh.nodes == pytest.approx(mesh.nodes * (0.13 / 8 if size else 0.01))
    assert robot.body.thickness is None
    check_round_trip(robot, tmp_path / "there")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return load(tmp_path_factory.mktemp("small"))


LENGTH = st.floats(1e-30, 1e6)
TRAVEL = st.floats(1e-30, 20.0)
PLACE = st.floats(-1e6, 1e6)
GRAVITY = st.tuples(*[st.floats(-1000, 1000)] * 2) | st.sampled_from([(0.0, -9.80665), (9.80665, 0.0), (0.0, 0.0)])
WORDS = st.text("aZ9_-. éß世हाথ", min_size=1, max_size=60).map(lambda text: "n" + text[1:])


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(data=st.data(), unit=st.sampled_from(["mm", "cm", "m", "in", "ft", "um", "yard"]))
@pytest.mark.slow
def test_any_number(data: st.DataObject, unit: str, small: Robot) -> None:
    """Oracle: bits: whatever floats the records hold, the file gives the very same (the body is not meshed again)."""
    from hydrostat.robot.read import RobotReader, _gravity, read_material

    draw = data.draw
    low, high = small.body.mesh.nodes.min(axis=0) * 0.99, small.body.mesh.nodes.max(axis=0) * 0.99
    inside = st.tuples(*(st.floats(*ends) for ends in zip(low, high, strict=True)))
    start, end, at = draw(inside), (float(high[0]), draw(inside)[1]), draw(inside)
    winch = Winch(
        name=draw(WORDS),
        at=start,
        spool_radius=draw(TRAVEL),
        travel=draw(TRAVEL),
        release=draw(TRAVEL | st.just(0.0)),
        mount=draw(st.sampled_from(Mount)),
    )
    cable = Cable(
        winch=winch.name,
        points=(start, (start[0] * 0.5 - 1e-3, 0.0), end),
        stiffness=draw(LENGTH),
        smoothing=draw(LENGTH),
        slack=draw(LENGTH | st.just(0.0)),
        friction=draw(st.floats(0, 2)),
        spool_radius=draw(st.none() | st.floats(0.25, 4).map(lambda ratio: ratio * winch.spool_radius)),
        name=draw(st.just("") | WORDS),
    )
    numbers = {"young": st.floats(100, 1e12), "poisson": st.floats(0, 0.499), "density": LENGTH}
    name = draw(st.sampled_from(["", *MATERIALS]))
    material = replace(
        MATERIALS[name] if name else Material(**draw(st.fixed_dictionaries(numbers))),
        viscosity=draw(LENGTH | st.just(0.0)),
        relaxation=tuple(
            PronyTerm(modulus=modulus, time=time)
            for modulus, time in draw(st.lists(st.tuples(LENGTH, LENGTH), max_size=10))
        ),
    )
    target = (draw(PLACE), draw(PLACE))
    robot = Robot(
        name=draw(WORDS),
        body=replace(small.body, material=material, volume=draw(st.sampled_from(Volume))),
        pins=(Pin(at=at, radius=0.05, stiffness=draw(LENGTH)), Pin(box=((-1.0, -1.0), at))),
        winches=(winch,),
        cables=(cable,),
        markers=(Marker(name="tip", at=at),),
        poses={"pose": PoseTarget(name="pose", targets={"tip": target})},
        length_unit=unit,
        gravity=draw(st.none() | GRAVITY),
    )
    text = robot_text(robot)
    reader = RobotReader(Path("robot.toml"), text)
    assert _gravity(reader.table.gravity, 2) == robot.gravity
    assert read_material(reader.table.body.material) == material
    assert (reader.table.body.volume or Volume.ELEMENT) is robot.body.volume
    assert reader.records("winch", reader._winch) == robot.winches
    assert name_cables(reader.records("cable", reader._cable)) == robot.cables
    assert take_pins(reader.records("pin", reader._pin), robot.body) == robot.pins
    assert reader.records("marker", reader._marker) == robot.markers
    assert reader.records("pose", reader._pose) == tuple(robot.poses.values())


def test_pleasant(tmp_path: Path) -> None:
    """Oracle: the text that a person would write: numbers as typed, a point or a cable on one line, no default kept."""
    lines = robot_text(load(tmp_path, GOOD)).splitlines()
    for line in (
        "at = [-20, 5]",
        "points = [[-20, 5], [0, 10], [20, 10]]",
        'element_size = "12 mm"',
        'material = "polyester fibre"',
        'stiffness = "4 N/mm"',
        'travel = "20 mm"',
    ):
        assert line in lines
    assert not any(line.startswith(("mount", "release", "slack", "sheathed", "length_unit", "size")) for line in lines)
    assert not any(line.startswith(("gravity", "friction", "volume")) for line in lines)
    assert all(lines[number - 1] == "" for number, line in enumerate(lines) if line.startswith("["))
    assert "\n\n\n" not in "\n".join(lines)


@pytest.mark.parametrize("unit", MAXIMAL_IN)
def test_numbers_as_typed(unit: str, tmp_path: Path) -> None:
    """Oracle: the numbers of the file that was read, to the digit, in inches too."""
    before = tomllib.loads(MAXIMAL_IN[unit], parse_float=Decimal)
    after = tomllib.loads(robot_text(load(tmp_path, MAXIMAL_IN[unit])), parse_float=Decimal)
    assert [cable["points"] for cable in after["cable"]] == [cable["points"] for cable in before["cable"]]
    assert [pin.get("box") for pin in after["pin"]] == [pin.get("box") for pin in before["pin"]]
    assert after["pose"] == before["pose"]


def test_minus_zero(tmp_path: Path) -> None:
    """Oracle: -0.0 equals 0.0, so robots with either have one text and one hash."""
    first, second = (load(tmp_path, edit(GOOD, "at = [25, 0]", f"at = [25, {zero}]")) for zero in ("0", "-0.0"))
    assert first == second
    assert robot_hash(first) == robot_hash(second)
    assert check_round_trip(second, tmp_path / "again") == robot_text(first)


def test_material_of_another_table(tmp_path: Path, small: Robot) -> None:
    """Oracle: the numbers come back, although the name is not, or no longer, the table's."""
    stiffer = replace(small.body.material, young=31e3)
    saved = save_robot(replace(small, body=replace(small.body, material=stiffer)), tmp_path)
    assert load_robot(saved).body.material == Material(young=31e3, poisson=0.3, density=40)


NAMED = 'material = { name = "Polyester fibre", '


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("format = 1", 'format = 1\ngravity = "-y"', 'gravity = "-y"'),
        ("format = 1", 'format = 1\ngravity = ["9.80665 N/kg", "0 m/s^2"]', 'gravity = "+x"'),
        ("format = 1", 'format = 1\ngravity = ["0 m/s^2", "9.81 m/s^2"]', 'gravity = ["0 m/s^2", "9.81 m/s^2"]'),
        (
            'material = "p',
            NAMED + 'viscosity = "40 Pa s" }\n#',
            'material = {name = "polyester fibre", viscosity = "40 Pa s"}',
        ),
        (
            'material = "p',
            NAMED + 'relaxation = [{ modulus = "10 kPa", time = "2 s" }] }\n#',
            'material = {name = "polyester fibre", relaxation = [{modulus = "10 kPa", time = "2 s"}]}',
        ),
        ('material = "p', NAMED + 'viscosity = "0 Pa s", relaxation = [] }\n#', 'material = "polyester fibre"'),
        ('material = "p', 'volume = "patch"\nmaterial = "p', 'volume = "patch"'),
        ('winch = "left"', 'winch = "left"\nfriction = 0.2', "friction = 0.2"),
        ('winch = "left"', 'winch = "left"\nname = "bends the tip"', 'name = "bends the tip"'),
    ],
)
def test_mechanics_as_typed(old: str, new: str, line: str, tmp_path: Path) -> None:
    """Oracle: the line that a person would write, and the robot itself, read again."""
    robot = load(tmp_path / "here", edit(GOOD, old, new))
    assert line in check_round_trip(robot, tmp_path / "there").splitlines()


def test_gravity_words(tmp_path: Path) -> None:
    """Oracle: 9.80665 m/s^2 along the axis and sign of the word, by hand, and no gravity without the key."""
    for word, gravity in {
        "-x": (-9.80665, 0.0),
        "+x": (9.80665, 0.0),
        "-y": (0.0, -9.80665),
        "+y": (0.0, 9.80665),
    }.items():
        assert load(tmp_path, edit(GOOD, "format = 1", f'format = 1\ngravity = "{word}"')).gravity == gravity
    assert load(tmp_path).gravity is None


@pytest.mark.parametrize(("word", "gravity"), [("-z", (0.0, 0.0, -9.80665)), ("+y", (0.0, 9.80665, 0.0))])
def test_gravity_in_space(word: str, gravity: tuple[float, ...], tmp_path: Path) -> None:
    """Oracle: three components by hand, and the robot itself, read again."""
    mesh = box_mesh((2, 1, 1), size=(8.0, 4.0, 4.0))
    robot_folder(tmp_path / "here")
    meshio.write(tmp_path / "here" / "body.vtk", meshio.Mesh(mesh.nodes, [("tetra", mesh.elements)]))
    space = {"extra": 'volume = "patch"', "box": "[-1, -1, -1], [0.1, 999, 999]", "at": "1, 1, 1", "end": "7, 2, 3"}
    text = MESHED.format(unit="mm", ending="vtk", **space)
    robot = load(tmp_path / "here", edit(text, "\n\n", f'\ngravity = "{word}"\n\n'))
    assert robot.gravity == gravity
    assert robot.body.volume is Volume.PATCH
    check_round_trip(robot, tmp_path / "there")


def test_hash_of_old_files(tmp_path: Path) -> None:
    """Oracle: the hash that was printed before gravity, viscosity, relaxation, friction and volume were known."""
    assert robot_hash(load(tmp_path)) == "d8b39a4bf4461d406d77a50cb22861e8a6f110884482cff531ccd9d0e19a7d12"


def test_hash_tells_apart(tmp_path: Path) -> None:
    """Oracle: a robot changed in one number, or in one byte of its drawing, has another hash."""
    first = load(tmp_path)
    assert robot_hash(load(tmp_path, edit(GOOD, "[20, 10]]", "[20, 10.0001]]"))) != robot_hash(first)
    for old, new in (
        ("format = 1", 'format = 1\ngravity = "-y"'),
        ('material = "p', 'volume = "patch"\nmaterial = "p'),
        ('material = "p', NAMED + 'viscosity = "1 Pa s" }\n#'),
        ('material = "p', NAMED + 'relaxation = [{ modulus = "1 Pa", time = "1 s" }] }\n#'),
        ('winch = "left"', 'winch = "left"\nfriction = 0.01'),
    ):
        assert robot_hash(load(tmp_path, edit(GOOD, old, new))) != robot_hash(first)
    drawing = first.body.content.decode() + " "
    assert robot_hash(load(tmp_path, svg=drawing)) != robot_hash(first)


def test_whole_or_not_at_all(tmp_path: Path, small: Robot) -> None:
    """Oracle: the folder: no temporary file stays, neither after success nor after failure, which is one line."""
    save_robot(small, tmp_path / "deep" / "down")
    assert sorted(path.name for path in (tmp_path / "deep" / "down").iterdir()) == ["body.svg", "robot.toml"]
    (tmp_path / "bad" / "robot.toml").mkdir(parents=True)
    with pytest.raises(InputError, match=r"robot.toml: cannot be written \("):
        save_robot(small, tmp_path / "bad")
    assert sorted(path.name for path in (tmp_path / "bad").iterdir()) == ["body.svg", "robot.toml"]
    with pytest.raises(InputError, match=r"body.svg: cannot be made a folder \("):
        save_robot(small, tmp_path / "bad" / "body.svg")


def test_unreadable_names_are_not_written(tmp_path: Path, small: Robot) -> None:
    """Oracle: what could not be read again is refused before anything is written."""
    with pytest.raises(InputError, match='"a/b" has "/" in it'):
        save_robot(replace(small, name="a/b"), tmp_path / "new")
    assert not (tmp_path / "new").exists()
