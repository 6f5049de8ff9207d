"""[contact] and [[obstacle]] in robot.toml. Oracle: what was written, and the lines told of what is wrong."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, strip_mesh

from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, Robot, edge_points, find_risks, load_robot, save_robot
from hydrostat.robot.merge import merged_text

WALL = Obstacle(name="wall", shape="plane", at=(0.0, -0.16), normal=(0.0, 1.0))
OTHERS = (
    WALL,
    Obstacle(name="ball", shape="sphere", at=(0.3, 0.0), radius=0.02),
    Obstacle(name="rod", shape="capsule", at=(0.3, 0.1), to=(0.4, 0.2), radius=0.01),
    Obstacle(name="step", shape="box", at=(-0.3, 0.0), to=(-0.2, 0.1)),
    Obstacle(name="puck", shape="sphere", at=(0.3, 0.0), radius=0.02, friction=0.4, mass=0.05),
    Obstacle(name="press", shape="box", at=(-0.3, 0.2), to=(-0.2, 0.3), path=((0.5, (-0.1, 0.2)), (2.0, (0.1, 0.25)))),
)
BALL = '[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]\nradius = 5\n'


def starfish(contact: Contact | None = None, *obstacles: Obstacle) -> Robot:
    return replace(gallery_robot("starfish"), contact=contact, obstacles=obstacles)


@pytest.mark.parametrize("contact", [None, Contact(), Contact(distance=2e-3), Contact(friction=0.3)])
def test_what_is_written_is_read(contact: Contact | None, tmp_path: Path) -> None:
    robot = starfish(contact, *OTHERS)
    save_robot(robot, tmp_path / "star")
    found = load_robot(tmp_path / "star")
    assert (found.contact, found.obstacles) == (contact, OTHERS)


def test_contact_comes_and_goes_in_a_text_that_keeps_its_comments(tmp_path: Path) -> None:
    save_robot(starfish(), tmp_path / "star")
    text = "# mine\n" + (tmp_path / "star" / "robot.toml").read_text("utf-8")
    with_contact = merged_text(text, starfish(Contact(distance=1e-3), WALL))
    assert "# mine" in with_contact
    assert '[contact]\ndistance = "1 mm"' in with_contact
    changed = merged_text(with_contact, starfish(Contact(distance=2e-3), WALL))
    assert changed == with_contact.replace('distance = "1 mm"', 'distance = "2 mm"')
    gone = merged_text(changed, starfish())
    assert "contact" not in gone
    assert "obstacle" not in gone


def test_each_edge_of_the_skin_has_its_points_once() -> None:
    """Oracle: a closed skin has 3 edges for each 2 triangles; a closed line as many edges as corners."""
    for mesh, edges in ((box_mesh((3, 2, 2)), 1.5), (strip_mesh(4, 2), 1.0)):
        points = edge_points(mesh, 2)
        assert len(points) == 2 * edges * len(mesh.boundary)
        assert len(np.unique(points.round(9), axis=0)) == len(points)


def test_the_distance_is_a_share_of_the_size() -> None:
    robot = starfish(Contact())
    assert robot.contact_distance == pytest.approx(robot.body.mesh.size / 200)
    assert starfish(Contact(distance=3e-3)).contact_distance == 3e-3


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ('[contact]\ndistance = "-1 mm"', r"line \d+: contact.distance must be finite and above 0, not -1 mm"),
        (
            '[contact]\ndistance = "90 mm"',
            r"contact.distance of 90 mm is large beside a body of 279.3 mm; it is usually",
        ),
        ("[contact]\ndistance = 1", r"line \d+: contact.distance: 1 has no unit"),
        ("[contact]\nfriction = 30", r"line \d+: contact.friction|contact: friction must be from 0 to 3, not 30"),
        (
            '[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]\nradius = 5\nfriction = -1',
            r"obstacle\[0\].friction must be from 0 to 3, not -1",
        ),
        (
            '[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]\nradius = 5\nmass = "0 g"',
            r"obstacle\[0\].mass must be finite and above 0",
        ),
        (
            '[[obstacle]]\nname = "a"\nshape = "plane"\nat = [0, -900]\nnormal = [0, 1]\nmass = "5 g"',
            r"obstacle\[0\]: a plane has no end, so no mass",
        ),
        (
            f"{BALL}mass = '5 g'\npath = [{{ time = '1 s', at = [910, 0] }}]",
            r"obstacle\[0\]: an object with a mass goes where",
        ),
        (
            f"{BALL}path = [{{ time = '0 s', at = [910, 0] }}]",
            r"obstacle\[0\].path: its times must rise from above 0 s; 0 s",
        ),
        (f"{BALL}path = [{{ time = '1 s', at = [9, 1, 0] }}]", r"obstacle\[0\].path: a place has 3 entries, at has 2"),
        (f"{BALL}path = [{{ at = [910, 0] }}]", r"obstacle\[0\].path\[0\].time"),
        ('[[obstacle]]\nname = "a"\nshape = "cone"\nat = [900, 0]', r"obstacle\[0\].shape"),
        ('[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]', r"obstacle\[0\]: a sphere needs a radius"),
        ('[[obstacle]]\nname = "a"\nshape = "plane"\nat = [0, 0]\nnormal = [0, 0]', "normal must not be 0"),
        ('[[obstacle]]\nname = "a"\nshape = "box"\nat = [900, 0]\nto = [900, 9]', "leave nothing between them"),
        ('[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]\nto = [0, 0]\nradius = 3', "a sphere has no to"),
        (
            '[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [0, 0]\nradius = 9',
            '"a" stands in the body at rest; move it out',
        ),
        (
            '[[obstacle]]\nname = "a"\nshape = "plane"\nat = [0, 0]\nnormal = [0, 1]',
            'body at rest stands in "a", [0-9.]+ mm deep',
        ),
        ('[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [0, 0, 9]\nradius = 9', "at has 3 entries"),
        (
            '[[obstacle]]\nname = "a"\nshape = "cylinder"\nat = [900, 0]\nto = [950, 0]\nradius = 9',
            "a flat body meets no cylinder",
        ),
        (2 * '[[obstacle]]\nname = "a"\nshape = "sphere"\nat = [900, 0]\nradius = 9\n', 'two of the name "a"|"a"'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    save_robot(starfish(), tmp_path / "star")
    file = tmp_path / "star" / "robot.toml"
    file.write_text(file.read_text("utf-8") + "\n" + table + "\n", "utf-8")
    with pytest.raises(InputError, match=told) as caught:
        load_robot(tmp_path / "star")
    assert "\n" not in str(caught.value)


def test_a_body_that_crosses_itself_at_rest_is_risky() -> None:
    robot = starfish(Contact())
    assert not any("passes through itself" in risk for risk in find_risks(robot))


def test_friction_of_an_obstacle_is_its_own_or_that_of_the_contact() -> None:
    puck = OTHERS[-2]
    assert starfish(Contact(friction=0.2), WALL).friction_of(WALL) == 0.2
    assert starfish(Contact(friction=0.2), puck).friction_of(puck) == 0.4
    assert starfish(None, WALL).friction_of(WALL) == 0.0


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("shape", ["sphere", "capsule", "cylinder", "box"])
def test_second_moments_and_frames(shape: str, dim: int) -> None:
    """Oracle: points drawn within, and distances that do not care in which frame they are told."""
    if shape == "cylinder" and dim == 2:
        pytest.skip("a flat body meets no cylinder")
    sizes = {"sphere": {"radius": 0.03}, "box": {"to": (0.1, 0.08, 0.07)[:dim]}}
    rod = {"to": (0.1, 0.05, 0.02)[:dim], "radius": 0.03}
    obstacle = Obstacle(name="object", shape=shape, at=(0.01,) * dim, mass=1.0, **sizes.get(shape, rod))
    place, axes = obstacle.frame()
    points = np.random.default_rng(0).uniform(-0.12, 0.12, (400_000, dim))
    distances = obstacle.to_own_frame().field()(points).values
    assert np.allclose(obstacle.field()(place + points[:1000] @ axes).values, distances[:1000], atol=1e-12)
    assert axes @ axes.T == pytest.approx(np.eye(dim), abs=1e-12)
    if shape != "box":
        turned = axes @ np.linalg.qr(np.random.default_rng(1).normal(size=(dim, dim)))[0]
        there = obstacle.with_frame(place + 0.1, turned)
        assert np.allclose(there.field()(place + 0.1 + points[:1000] @ turned).values, distances[:1000], atol=1e-9)
    assert (points[distances < 0] ** 2).mean(axis=0) == pytest.approx(obstacle.second_moments(), rel=0.03)
