"""Obstacles from surface files. Oracles: shapes with closed forms, differences, what was written."""

import pickle
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, closed_mesh, load_robot, robot_hash, save_robot

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
SIDES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)


def stl(vertices: np.ndarray, triangles: np.ndarray) -> bytes:
    """A binary STL file."""
    facets = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    facets["corners"] = vertices[triangles]
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + facets.tobytes()


def block(sides: tuple[float, float, float] = (40, 60, 100), triangles: np.ndarray = SIDES) -> bytes:
    return stl(CORNERS * sides, triangles)


def mesh_object(content: bytes, **given: object) -> Obstacle:
    known = {"at": (0.2, 0.1, 0.0), "mass": 0.1}
    return Obstacle(name="object", shape="mesh", mesh=closed_mesh(content, "object.stl"), **(known | given))


def test_a_block_is_a_box() -> None:
    made, box = (
        mesh_object(block()),
        Obstacle(name="box", shape="box", at=(0.2, 0.1, 0.0), to=(0.24, 0.16, 0.1), mass=0.1),
    )
    points = np.random.default_rng(0).uniform((0.15, 0.05, -0.05), (0.3, 0.2, 0.15), (2000, 3))
    one, other = made.field()(points), box.field()(points)
    outside = (other.values > 1e-4) & (other.values < 0.02)
    for mine, known in zip(one, other, strict=True):
        assert np.allclose(mine[outside], known[outside], atol=1e-5 if mine.ndim < 3 else 1e-2)
    assert ((one.values < 0) == (other.values < 0)).all()
    assert made.frame()[0] == pytest.approx(box.frame()[0], abs=1e-7)
    assert np.sort(made.second_moments()) == pytest.approx(np.sort(box.second_moments()), rel=1e-5)
    assert (one.values <= other.values + 1e-7).all()  # never more than what is true


def test_in_its_own_frame_it_is_the_same() -> None:
    made = mesh_object(block())
    place, axes = made.frame()
    points = np.random.default_rng(1).uniform(-0.05, 0.05, (500, 3))
    here, there = made.to_own_frame().field()(points), made.field()(place + points @ axes)
    near = np.abs(there.values) < 0.02
    assert np.allclose(here.values[near], there.values[near], atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_slopes_of_the_distance() -> None:
    field = mesh_object(block()).field()
    points = np.random.default_rng(2).uniform((0.19, 0.09, -0.01), (0.25, 0.17, 0.11), (300, 3))
    found = field(points)
    outside = (found.values > 1e-3) & (found.values < 0.02)
    for axis in range(3):
        step = 1e-7 * np.eye(3)[axis]
        up, down = field(points + step), field(points - step)
        slopes = (up.values - down.values) / 2e-7
        assert np.median(np.abs(slopes - found.normals[:, axis])[outside]) < 1e-6
        bends = (up.normals - down.normals) / 2e-7
        assert np.median(np.abs(bends - found.curvatures[:, :, axis])[outside]) < 1e-3


def test_it_can_be_sent_to_other_processes() -> None:
    made = mesh_object(block())
    points = np.array([[0.25, 0.13, 0.05]])
    before = made.field()(points).values
    assert pickle.loads(pickle.dumps(made)).field()(points).values == before
    field = made.field()
    field(points)
    assert pickle.loads(pickle.dumps(field))(points).values == before


def test_what_is_written_is_read(tmp_path: Path) -> None:
    made = mesh_object(block(), at=(0.3, 0.0, 0.0), friction=0.4)
    robot = replace(gallery_robot("caging_gripper"), contact=Contact(), obstacles=(made,))
    save_robot(robot, tmp_path / "gripper")
    assert (tmp_path / "gripper" / "object.stl").read_bytes() == block()
    again = load_robot(tmp_path / "gripper")
    assert again.obstacles == robot.obstacles
    assert robot_hash(again) == robot_hash(robot)
    other = replace(robot, obstacles=(mesh_object(block((40, 60, 90)), at=(0.3, 0.0, 0.0), friction=0.4),))
    assert robot_hash(other) != robot_hash(robot)


def two_blocks(apart: float) -> bytes:
    """A block, and another so many of its sides away along all axes."""
    return stl(np.vstack([40 * CORNERS, 40 * (CORNERS + apart)]), np.vstack([SIDES, SIDES + 8]))


def test_an_object_may_have_parts() -> None:
    assert closed_mesh(two_blocks(1.2), "object.stl").surface.volume == pytest.approx(2 * 0.04**3)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (block(triangles=SIDES[:-1]), "object.stl: is not closed"),
        (block(triangles=SIDES[:, ::-1]), "object.stl: is inside out"),
        (block(triangles=np.vstack([SIDES[:-1], SIDES[-1:, ::-1]])), "do not all turn the same way"),
        (two_blocks(0.5), r"object.stl: runs through itself, for instance at \(.*\) mm; repair it first$"),
        (b"solid nothing", "object.stl"),
        (b"", "object.stl: the file is empty"),
    ],
)
def test_what_is_no_closed_surface_is_told(content: bytes, words: str) -> None:
    with pytest.raises(InputError, match=words):
        closed_mesh(content, "object.stl")


def test_a_flat_body_meets_no_mesh() -> None:
    with pytest.raises(InputError, match="a flat body meets no mesh"):
        mesh_object(block(), at=(0.0, 0.0))


def test_its_rims_are_drawn() -> None:
    from hydrostat.robot import rims

    lines = rims(mesh_object(block(), at=(0.3, 0.0, 0.0)), gallery_robot("caging_gripper"))
    corners = np.concatenate(lines)
    assert corners.min(axis=0) == pytest.approx((0.3, 0, 0), abs=1e-6)
    assert corners.max(axis=0) == pytest.approx((0.34, 0.06, 0.1), abs=1e-6)
