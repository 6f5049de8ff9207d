"""Parts of a body in robot.toml. Oracle: what was written, areas of circles, and the line that tells each fault."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh
from robot_files import GOOD, edit, load

from hydrostat.errors import InputError
from hydrostat.robot import (
    BodyPart,
    ElementKind,
    Material,
    Robot,
    find_risks,
    inflated_robot,
    load_robot,
    merged_text,
    robot_text,
    save_robot,
)
from hydrostat.robot.scaled import scaled_robot

BONE = (
    '[[body.part]]\nname = "bone"\nshape = "box"\nat = [0, -30]\nto = [20, 30]\nrigid = true\ndensity = "1.2 g/cm^3"\n'
)
JOINT = '[[body.part]]\nname = "joint"\nshape = "sphere"\nat = [-12, 0]\nradius = 8\nmaterial = "ecoflex 00-30"\n'
RIGID = 'rigid = true\ndensity = "1.2 g/cm^3"\n'
FAR = (
    '[[body.part]]\nname = "plate"\nshape = "polygon"\n'
    f"points = [[-25, 10], [-15, 10], [-15, 30], [15, 30], [15, 10], [25, 10], [25, 40], [-25, 40]]\n{RIGID}"
)
THIN = f'[[body.part]]\nname = "wire"\nshape = "capsule"\nat = [-20, -10]\nto = [20, 10]\nradius = 1.3\n{RIGID}'


def with_parts(*tables: str) -> str:
    """A robot in a finer mesh with these parts."""
    finer = edit(GOOD, 'element_size = "12 mm"', 'element_size = "4 mm"')
    return edit(finer, "[[pin]]", "".join(tables) + "\n[[pin]]")


def test_what_is_written_is_read(tmp_path: Path) -> None:
    robot = load(tmp_path / "a", with_parts(BONE, JOINT))
    assert [part.name for part in robot.body.parts] == ["bone", "joint"]
    assert robot.body.materials[1].density == pytest.approx(1200.0)
    assert robot.body.materials[2].name == "ecoflex 00-30"
    save_robot(robot, tmp_path / "b")
    again = load_robot(tmp_path / "b")
    assert again == robot
    assert (again.body.mesh.nodes == robot.body.mesh.nodes).all()


def test_quadratic_elements_are_kept(tmp_path: Path) -> None:
    """In files, with parts, in another size and inflated. Oracle: the robot of linear elements."""
    text = edit(with_parts(BONE, JOINT), 'material = "p', 'elements = "quadratic"\nmaterial = "p')
    robot, linear = load(tmp_path / "a", text), load(tmp_path / "c", with_parts(BONE, JOINT))
    assert robot.body.with_elements("linear") == linear.body
    assert (robot.body.element_materials == linear.body.element_materials.repeat(4)).all()
    assert robot.body.with_parts(robot.body.parts) == robot.body
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    assert scaled_robot(robot, 1.5).body.mesh.quadratic is not None
    assert inflated_robot(robot).body.elements is ElementKind.QUADRATIC


CELLS = '[[body.part]]\nname = "bone"\nshape = "cells"\nlabel = 3\n' + RIGID


def labeled(folder: Path, table: str) -> Robot:
    """The robot in a ready mesh whose elements right of x = 5 mm have the label 3."""
    import meshio

    mesh = strip_mesh(12, 8, size=(60.0, 40.0))
    points = np.pad(mesh.nodes - [30.0, 0.0], ((0, 0), (0, 1)))
    labels = np.where(points[mesh.elements][:, :, 0].mean(axis=1) > 5.0, 3, 1).astype(np.int32)
    folder.mkdir(exist_ok=True)
    meshio.write(folder / "body.vtu", meshio.Mesh(points, [("triangle", mesh.elements)], cell_data={"a": [labels]}))
    text = edit(GOOD, 'outline = "body.svg"\nelement_size = "12 mm"', 'mesh = "body.vtu"')
    return load(folder, edit(text, "[[pin]]", f"{table}\n[[pin]]"))


def test_labels_of_a_mesh_file_are_parts(tmp_path: Path) -> None:
    """Oracle: the same region as a box."""
    robot = labeled(tmp_path / "a", CELLS)
    box = labeled(tmp_path / "c", BONE.replace("at = [0,", "at = [5,").replace("to = [20,", "to = [40,"))
    assert (robot.body.element_materials == box.body.element_materials).all()
    assert 0 < robot.body.element_materials.sum() < len(robot.body.mesh.elements)
    assert robot.body.mesh.nodes == pytest.approx(box.body.mesh.nodes, abs=1e-9)
    quadratic = robot.body.with_elements("quadratic")
    assert (quadratic.element_materials == robot.body.element_materials.repeat(4)).all()
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    assert scaled_robot(robot, 2.0).body.mass == pytest.approx(8 * robot.body.mass)
    assert not [line for line in find_risks(robot) if "bone" in line]


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (CELLS.replace("= 3", "= 4"), r'body.part\[0\].label: unknown label "4". Available: a=1, 1, a=3, 3.'),
        (CELLS.replace("label = 3\n", ""), r'body.part\[0\].shape = "cells" needs a label, and no other shape has one'),
        (BONE + "label = 3\n", r'body.part\[0\].shape = "cells" needs a label, and no other shape has one'),
        (CELLS + "at = [0, 0]\n", r"body.part\[0\]: a region of cells has no at"),
    ],
)
def test_what_is_wrong_with_a_label_is_told(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        labeled(tmp_path, table)


def test_a_label_needs_a_ready_mesh(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'unknown label "3". The file has none, or is no ready mesh'):
        load(tmp_path, with_parts(CELLS))


def test_a_text_keeps_its_comments(tmp_path: Path) -> None:
    text = "# mine\n" + with_parts(BONE, "# soft\n" + JOINT)
    robot = load(tmp_path, text)
    harder = replace(robot, body=robot.body.with_parts((robot.body.parts[0],)))
    assert merged_text(text, robot) == text
    assert "# mine" in merged_text(text, harder)
    assert "joint" not in robot_text(harder)


def test_the_mesh_follows_the_borders(tmp_path: Path) -> None:
    """The areas of the parts are those of their shapes, the corners of a circle lie on it, nothing is turned over."""
    body = load(tmp_path, with_parts(BONE, JOINT)).body
    areas = np.bincount(body.element_materials, body.mesh.volumes)
    assert areas[1] == pytest.approx(0.02 * 0.04, rel=0.01)
    assert areas[2] == pytest.approx(np.pi * 0.008**2, rel=0.06)  # of the polygon within the circle
    (ring,) = body.part_rings[1]
    radii = np.linalg.norm(body.mesh.nodes[ring] - [-0.012, 0.0], axis=1)
    assert np.mean(np.abs(radii - 0.008) < 1e-6) > 0.8
    loose = replace(body, mesh=load(tmp_path, with_parts()).body.mesh)
    assert (np.linalg.norm(loose.mesh.nodes[ring] - [-0.012, 0.0], axis=1) != radii).any()


def test_a_part_in_the_plane_goes_through_a_body_in_space() -> None:
    disc = BodyPart(
        name="disc", shape="polygon", points=((0.02, 0.0), (0.05, 0.0), (0.05, 0.03), (0.02, 0.03)), density=1e3
    )
    body = mesh_body(box_mesh((10, 5, 4), size=(0.1, 0.05, 0.04))).with_parts((disc,))
    volumes = np.bincount(body.element_materials, body.mesh.volumes)
    assert volumes[1] == pytest.approx(0.03 * 0.03 * 0.04, rel=1e-6)


def test_a_robot_keeps_its_parts_when_scaled_and_blown_up(tmp_path: Path) -> None:
    robot = load(tmp_path, with_parts(JOINT))
    twice, blown = scaled_robot(robot, 2.0), inflated_robot(robot)
    assert twice.body.parts[0].radius == pytest.approx(0.016)
    assert twice.body.mass == pytest.approx(8 * robot.body.mass, rel=1e-3)
    assert (blown.body.element_materials == 1).any()


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (edit(BONE, "density", "# density"), r"body.part\[0\]: a rigid part needs its density"),
        (edit(BONE, "rigid = true\n", ""), r"body.part\[0\]: give either material or rigid = true"),
        (edit(JOINT, "material", "rigid = true\nmaterial"), "give either material or rigid = true"),
        (edit(JOINT, "radius", 'density = "1 g/cm^3"\nradius'), "density is for rigid parts"),
        (edit(JOINT, "[-12, 0]", "[90, 0]"), r'body.part\[0\]: "joint" holds no element: it lies outside the body'),
        (edit(JOINT, "radius = 8", "radius = 0.1"), "is thinner than an element"),
        (BONE + edit(JOINT, "[-12, 0]", "[0, 0]"), r'body.part\[1\]: "joint" overlaps "bone" in \d+ elements'),
        (BONE + edit(JOINT, '"joint"', '"bone"'), r'body.part\[1\].name: there are two of the name "bone"'),
        (edit(JOINT, "[-12, 0]", "[-12, 0, 0]"), r"line 14: body.part\[0\].at has 3 coordinates, but"),
        (edit(JOINT, "radius = 8", "radius = -8"), r"body.part\[0\].radius must be finite and above 0"),
        (edit(JOINT, "radius = 8\n", ""), "a sphere needs a radius"),
        (edit(JOINT, '"sphere"', '"cone"'), r'body.part\[0\].shape: "cone" is not known'),
        (edit(JOINT, '"sphere"', '"mesh"'), 'shape = "mesh" needs a file'),
        (edit(JOINT, '"ecoflex 00-30"', '"cheese"'), 'body.part.0..material: unknown material "cheese"'),
        (FAR, r'rigid "plate" is in 2 pieces, [\d.]+ mm apart, at .* as it leaves the body between them'),
        (THIN, r'rigid "wire" is in \d+ pieces of the mesh, at .* too thin for its elements'),
        (
            '[[body.part]]\nname = "x"\nshape = "polygon"\npoints = [[0, 0], [9, 9], [9, 0], [0, 9]]\nrigid = true\n'
            'density = "1 g/cm^3"\n',
            "the sides of the polygon cross",
        ),
        (edit(BONE, "[[body.part]]", "[[part]]"), "begin each with .*body.part"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, with_parts(table))
    assert "\n" not in str(caught.value)
    assert "robot.toml" in str(caught.value)


def test_a_part_that_reaches_out_is_told(tmp_path: Path) -> None:
    """A box that reaches 20 mm out of a body 40 mm high is half outside; a soft one is a region, so it may."""
    out = edit(BONE, "to = [20, 30]", "to = [20, 40]")
    (line,) = find_risks(load(tmp_path / "a", with_parts(edit(out, "[0, -30]", "[0, 0]"))))
    assert line == (
        'body.part[0] "bone": reaches 20 mm out of the body at [0, 40] mm; the 49 % outside have neither stiffness nor '
        "mass. Draw it to the edge, or enlarge the body"
    )
    soft = edit(edit(out, 'rigid = true\ndensity = "1.2 g/cm^3"', 'material = "ecoflex 00-30"'), "[0, -30]", "[0, 0]")
    assert find_risks(load(tmp_path / "b", with_parts(soft))) == []
    coarse = edit(with_parts(edit(JOINT, "radius = 8", "radius = 4")), 'element_size = "4 mm"', 'element_size = "9 mm"')
    (line,) = find_risks(load(tmp_path / "c", coarse))[-1:]
    assert re.fullmatch(r'body.part\[0\] "joint": [+-]\d+ % in volume in the mesh; take a smaller element_size', line)


def test_a_record_checks_itself() -> None:
    soft = Material(young=1e5, poisson=0.3, density=100.0)
    with pytest.raises(InputError, match="a box needs at"):
        BodyPart(name="a", shape="box", to=(1.0, 1.0), material=soft)
    with pytest.raises(InputError, match="a polygon has no radius"):
        BodyPart(name="a", shape="polygon", points=((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), radius=1.0, material=soft)
