"""Robots from surfaces, and robot.toml of such. Oracles: what was asked for, the robot read again, refusals' words."""

from pathlib import Path

import numpy as np
import pytest

from hydrostat.errors import InputError, SurfaceError
from hydrostat.geometry import Surface, locate, write_ply
from hydrostat.robot import SurfaceSketch, find_risks, load_robot, robot_text, save_robot

CORNERS = np.array([[x, y, z] for x in (0.0, 0.12) for y in (0.0, 0.03) for z in (0.0, 0.02)])
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BAR = Surface(CORNERS, np.array([piece for a, b, c, d in QUADS for piece in ((a, b, c), (a, c, d))]))
"""A bar of 120 x 30 x 20 mm."""


def tapered(turned: bool = False) -> Surface:
    """A bar that is thicker where x is low, or high."""
    x = CORNERS[:, :1] / 0.12
    share = 1 - 0.3 * (1 - x if turned else x)
    return Surface(np.column_stack([CORNERS[:, :1], CORNERS[:, 1:] * share]), BAR.triangles)


@pytest.mark.parametrize("turned", [False, True])
def test_sketch(turned: bool, tmp_path: Path) -> None:
    """Held at the thicker end, with a cable along it and a marker at the other; read again it is the same."""
    told: list[str] = []
    sketch = SurfaceSketch.of_scan(write_ply(tapered(turned)), file="bar.ply", name="bar", nodes=600, tell=told.append)
    assert [words.split()[0] for words in dict.fromkeys(told)][:2] == ["healing", "filling"]
    assert told[-1] == "finding ends, winches and cables"
    robot = sketch.robot
    assert sketch.healing.clean
    assert len(robot.body.mesh.nodes) == pytest.approx(600, rel=0.1)
    assert [risk for risk in find_risks(robot) if "elements across" not in risk and "spool" not in risk] == []
    (pin,), (marker,), (cable,) = robot.pins, robot.markers, robot.cables
    assert pin.box is not None
    low, high = np.array(pin.box)
    held = ((robot.body.mesh.nodes >= low) & (robot.body.mesh.nodes <= high)).all(axis=1)
    assert 0.02 < held.mean() < 0.4
    ends = (0.12, 0.0) if turned else (0.0, 0.12)
    assert np.abs(robot.body.mesh.nodes[held][:, 0] - ends[0]).max() < 0.015
    assert abs(marker.at[0] - ends[1]) < 0.01
    assert abs(cable.points[0][0] - ends[0]) < 0.025, "half a winch of 40 mm has room before the end"
    assert abs(cable.points[-1][0] - ends[1]) < 0.012
    assert locate(robot.body.mesh, np.array(cable.points)).inside.all()
    assert cable.points[0] == robot.winches[0].at
    again = load_robot(save_robot(robot, tmp_path))
    assert again == robot
    assert robot_text(again) == robot_text(robot)
    assert again.body.mesh.nodes.tobytes() == robot.body.mesh.nodes.tobytes()


def test_the_cable_runs_along_the_thin_way_off_the_middle() -> None:
    """By hand: the bar is thinnest along z; from its winch in the middle the cable rises to 4 mm above it or so."""
    robot = SurfaceSketch.of_scan(write_ply(BAR), file="bar.ply", name="bar", element_size=0.012).robot
    points = np.array(robot.cables[0].points)
    np.testing.assert_allclose(points[:, 1], 0.015, atol=0.002)
    assert points[0, 2] == pytest.approx(0.01, abs=0.001)
    assert (points[3:, 2] > 0.0115).all()
    assert (points[:, 2] < 0.0185).all()
    assert robot.poses["bend"].targets["tip"][2] > robot.markers[0].at[2] + 0.02


def test_size_scales_and_element_size_is_taken() -> None:
    robot = SurfaceSketch.of_scan(write_ply(BAR), file="b.ply", name="b", size=0.24, element_size=0.025).robot
    assert robot.body.element_size == 0.025
    assert np.ptp(robot.body.mesh.nodes, axis=0) == pytest.approx([0.24, 0.06, 0.04], abs=0.004)
    assert robot.body.material.name == "flexfoam-it x"


def test_a_dirty_surface_is_kept_healed(tmp_path: Path) -> None:
    """Without a quarter of its triangles turned and one gone; the robot holds the healed one, clean when read again."""
    triangles = np.concatenate([BAR.triangles[1:4, ::-1], BAR.triangles[4:]])
    dirty = SurfaceSketch.of_scan(
        write_ply(Surface(CORNERS, triangles)), file="a b.ply", name="bar", element_size=0.012
    )
    assert not dirty.healing.clean
    assert dirty.robot.body.file == "a b_healed.ply"
    assert dirty.robot.body.mesh.volumes.sum() == pytest.approx(0.12 * 0.03 * 0.02, rel=0.03)
    again = load_robot(save_robot(dirty.robot, tmp_path))
    assert again == dirty.robot
    assert again.body.healing is not None
    assert again.body.healing.clean


def test_no_body() -> None:
    with pytest.raises(SurfaceError, match=r"encloses|holes|open"):
        SurfaceSketch.of_scan(write_ply(Surface(CORNERS, BAR.triangles[:2])), file="a.ply", name="a")
    with pytest.raises(InputError, match="unknown material"):
        SurfaceSketch.of_scan(write_ply(BAR), file="a.ply", name="a", material="steel")
    with pytest.raises(InputError, match="number of nodes must be from 10"):
        SurfaceSketch.of_scan(write_ply(BAR), file="a.ply", name="a", nodes=3)


TEXT = """\
format = 1
name = "bar"

[body]
surface = "bar.ply"
element_size = "15 mm"
material = "polyester fibre"

[[pin]]
at = [0, 15, 10]
radius = 20
"""


def _folder(folder: Path, text: str, content: bytes | None = None) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "bar.ply").write_bytes(write_ply(BAR) if content is None else content)
    (folder / "robot.toml").write_text(text)
    return folder


@pytest.mark.parametrize(
    "extra", ["", 'size = "60 mm"\nvolume = "patch"', "@cm"], ids=["plain", "scaled", "centimeters"]
)
def test_load_save_load(extra: str, tmp_path: Path) -> None:
    """The same robot, text and bits; a coordinate counts as length_unit says, unless a size is given."""
    text = TEXT.replace("[[pin]]", extra.replace("@cm", "") + "\n[[pin]]")
    if extra == "@cm":
        text = text.replace('"bar"\n\n', '"bar"\nlength_unit = "cm"\n\n').replace('"15 mm"', '"15 cm"')
    one = load_robot(_folder(tmp_path / "one", text))
    two = load_robot(save_robot(one, tmp_path / "two"))
    assert two == one
    assert robot_text(two) == robot_text(one) == (tmp_path / "two" / "robot.toml").read_text()
    assert two.body.mesh.nodes.tobytes() == one.body.mesh.nodes.tobytes()
    longest = {"": 0.12, "@cm": 1.2}.get(extra, 0.06)
    assert one.body.mesh.size == pytest.approx(longest, rel=0.05)
    assert one.body.source == "surface"
    assert one.body.healing is not None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('element_size = "15 mm"\n', "", 'line 4: body: the key "element_size" is missing; a body from a surface'),
        ('"15 mm"', '"15 mm"\nthickness = "3 mm"', "line 7: body.thickness is only for flat bodies; remove it"),
        ('"15 mm"', '"15 mm"\nplane = "stress"', "line 7: body.plane is only for flat bodies; remove it"),
        ('"15 mm"', '"300 mm"', "line 6: body.element_size: elements of 300 mm are too large for a body of 72 cm^3"),
        ('"15 mm"', '"0.1 mm"', "line 6: body.element_size: elements of 0.1 mm would be about "),
        ('"15 mm"', '"0 mm"', "line 6: body.element_size must be finite and above 0, not 0 mm"),
        ('"15 mm"', '"15 mm"\nsize = "-3 mm"', "line 7: body.size must be finite and above 0, not -3 mm"),
        ('"bar.ply"', '"rod.ply"', 'line 5: body.surface: file "rod.ply" not found next to robot.toml'),
        ('surface = "bar.ply"', 'surface = "bar.ply"\nmesh = "bar.ply"', "line 4: body: give one of outline"),
        ("[0, 15, 10]", "[0, 15]", "line 9: pin[0] has 2 coordinates, but the body has 3"),
    ],
)
def test_refusals_name_file_line_and_key(old: str, new: str, words: str, tmp_path: Path) -> None:
    assert old in TEXT
    with pytest.raises(InputError) as refused:
        load_robot(_folder(tmp_path, TEXT.replace(old, new, 1)))
    assert str(refused.value).startswith(f"{tmp_path}/robot.toml, {words}")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "the file is empty"),
        (b"solid\n", "not a PLY file|is no PLY|ply"),
        (write_ply(Surface(CORNERS, BAR.triangles[:3])), "encloses|holes|open"),
    ],
)
def test_what_is_no_body_is_told_at_its_line(content: bytes, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words) as refused:
        load_robot(_folder(tmp_path, TEXT, content))
    assert str(refused.value).startswith(f"{tmp_path}/robot.toml, line 5: body.surface: ")


def test_a_body_has_an_element_size_for_a_number_of_nodes(tmp_path: Path) -> None:
    body = load_robot(_folder(tmp_path, TEXT)).body
    size = body.element_size_for(500)
    text = TEXT.replace('"15 mm"', f'"{1e3 * size:.6g} mm"')
    assert len(load_robot(_folder(tmp_path, text)).body.mesh.nodes) == pytest.approx(500, rel=0.1)


def test_distances_count_from_the_surface(tmp_path: Path) -> None:
    """Closed form of a box; 0 inside, and where the mesh cuts a corner that the surface has."""
    body = load_robot(_folder(tmp_path, TEXT)).body
    points = np.array([[0.06, 0.015, 0.01], [0.06, 0.015, 0.027], [-0.03, -0.04, 0.01], [0.0001, 0.0001, 0.0001]])
    np.testing.assert_allclose(body.distances(points), [0, 0.007, 0.05, 0], atol=1e-9)


@pytest.mark.slow
def test_a_ball_is_held_and_reached(tmp_path: Path) -> None:
    """A stout body, where the way from what is held is short: found by a scan of a ball."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.03)
    sketch = SurfaceSketch.of_scan(write_ply(Surface(ball.vertices, ball.faces)), file="ball.ply", name="ball")
    (cable,) = sketch.robot.cables
    assert 0.0 < cable.length < 0.12
    assert (sketch.robot.body.distances(np.array(cable.points)) <= 0).all()
    save_robot(sketch.robot, tmp_path)
    assert load_robot(tmp_path) == sketch.robot
