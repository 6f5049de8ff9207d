"""What is allowed but may disappoint, of bodies in space. The oracle of each test is a box with that one fault."""

import re
from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, mesh_body

from hydrostat.geometry import Mesh, Surface, contour, write_ply
from hydrostat.robot import Body, BodyPart, Cable, Marker, Mount, Pin, Robot, SurfaceSketch, Winch, find_risks

LENGTH, SIDE = 0.12, 0.04


def solid_robot(
    cells: tuple[int, int, int] = (12, 4, 4), *, route: tuple[tuple[float, ...], ...] = (), mount: Mount = Mount.BODY
) -> Robot:
    """A box 120 x 40 x 40 mm without risk, held at its left end, with one cable along it through `route` [mm]."""
    points = tuple((1e-3 * x, 1e-3 * y, 1e-3 * z) for x, y, z in route or ((10, 12, 28), (60, 12, 28), (110, 12, 28)))
    return Robot(
        name="solid",
        body=mesh_body(box_mesh(cells, size=(LENGTH, SIDE, SIDE))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="one", at=points[0], mount=mount),),
        cables=(Cable(winch="one", points=points),),
        markers=(Marker(name="tip", at=(LENGTH, 0.02, 0.02)),),
        poses={},
    )


def test_none() -> None:
    """Oracle: nothing to say of a good box."""
    assert find_risks(solid_robot()) == []


@pytest.mark.parametrize(
    ("cells", "percent"), [(1, "20 to 100 % or more"), (2, "20 to 100 % or more"), (3, "10 to 100 %")]
)
def test_thin_limb(cells: int, percent: str) -> None:
    """Oracle: cubes cut in six, each as large as a regular tetrahedron of 1.122 times their side; the cable is fine."""
    (line,) = find_risks(solid_robot((3 * cells, cells, cells)))
    assert line.startswith(f"body: a limb has only {cells / 1.1225:.1f} elements across (40 mm thick at [")
    assert line.endswith(
        f'{percent} too stiff in bending; a mesh with edges of 10 mm would do, as would elements = "quadratic"'
    )


def test_thin_sheet() -> None:
    """Oracle: a plate 3 mm thick, of one layer of elements, in one line."""
    robot = solid_robot()
    body = mesh_body(box_mesh((12, 12, 1), size=(LENGTH, LENGTH, 0.003)))
    plate = replace(robot, body=body, winches=(), cables=(), markers=())
    lines = [line for line in find_risks(plate) if "limb" in line]
    assert len(lines) == 1
    assert "(3 mm thick at [" in lines[0]


def test_slivers() -> None:
    """Oracle: cubes cut in six, flattened to a twentieth: the smallest angle is atan(1/20), about the long diagonal."""
    mesh = box_mesh((6, 6, 6), size=(0.12, 0.12, 0.12))
    flat = Mesh(mesh.nodes * [1.0, 1.0, 0.05], mesh.elements)
    robot = replace(solid_robot(), body=mesh_body(flat), winches=(), cables=(), markers=())
    lines = [line for line in find_risks(robot) if "sliver" in line]
    assert len(lines) == 1
    assert lines[0].startswith(f"body: {len(mesh.elements)} of {len(mesh.elements)} tetrahedra are slivers (below 10")
    assert f"the worst {np.degrees(np.arctan(0.05)):.1f}, at [" in lines[0]
    assert not any("sliver" in line for line in find_risks(solid_robot()))


def valley_body() -> Body:
    """A U of three boxes: a gap 20 mm wide, 20 mm deep, in the middle of the top."""
    mesh = box_mesh((12, 4, 4), size=(LENGTH, SIDE, SIDE))
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    gap = (np.abs(middles[:, 0] - 0.06) < 0.01) & (middles[:, 2] > 0.02)
    used, elements = np.unique(mesh.elements[~gap], return_inverse=True)
    return mesh_body(Mesh(mesh.nodes[used], elements.reshape(-1, 4)))


def test_cable_near_the_surface() -> None:
    """Oracle: a straight run between two deep points passes 2 mm under the floor of a gap, or 3.1 mm."""
    found = {}
    for height in (18.0, 16.9):
        robot = replace(solid_robot(route=((10, 20, height), (110, 20, height))), body=valley_body())
        found[height] = [risk for risk in find_risks(robot) if "cable" in risk]
    (line,) = found[18.0]
    assert re.fullmatch(r"cable\[0\]: only 2 mm inside the surface at \[\S+, 20, 18\] mm, it may tear out", line)
    assert found[16.9] == []


def test_cable_that_is_sewn_to_the_skin_does_not_tear_out() -> None:
    """Oracle: what the kit sews, points up to 4 mm deep; a point in the middle, or all of them."""
    assert find_risks(solid_robot(route=((10, 12, 28), (60, 12, 39), (110, 12, 28)))) == []
    assert find_risks(solid_robot(route=((10, 12, 28), (60, 12, 39), (90, 12, 39), (110, 12, 28)))) == []


def test_segment_leaves_the_body() -> None:
    """Oracle: a U of three boxes; the straight line from leg to leg crosses the gap, 10 mm below its mouth."""
    body = valley_body()
    robot = solid_robot(route=((10, 20, 30), (110, 20, 30)))
    (line,) = [risk for risk in find_risks(replace(robot, body=body)) if "cable" in risk]
    found = re.fullmatch(
        r"cable\[0\]: leaves the body by (.*) mm at \[(.*), 20, 30\] mm; add a point .* round, .* slit", line
    )
    assert found is not None
    assert float(found[1]) == pytest.approx(10, abs=0.75)  # it is looked at every 1.5 mm
    assert float(found[2]) == pytest.approx(60, abs=1.25)
    round_it = solid_robot(route=((10, 20, 30), (40, 20, 10), (80, 20, 10), (110, 20, 30)))
    assert not any("cable" in risk for risk in find_risks(replace(round_it, body=body)))


def test_line_between_rigid_parts_runs_free() -> None:
    """Oracle: the tendons of the spine, threaded from disk to disk; were the disks soft, they would leave the body."""
    spine = gallery_robot("spine")
    assert not any("leaves" in risk for risk in find_risks(spine))
    soft = replace(spine, body=spine.body.with_parts(()), rods=())
    assert any("leaves" in risk for risk in find_risks(soft))


@pytest.mark.parametrize("ends", [(45, 75), (48, 74)])
def test_line_across_a_wide_gap_between_rigid_parts_leaves_the_body(ends: tuple[int, int]) -> None:
    """Oracle: the U above with rigid legs; its gap of 20 mm is a sixth of its size, a free line may span 15 %."""
    legs = [
        BodyPart(name=name, shape="box", at=(low, 0.0, 0.021), to=(high, SIDE, SIDE), density=1240.0)
        for name, low, high in (("left", 0.0, 0.049), ("right", 0.071, LENGTH))
    ]
    robot = solid_robot(route=((10, 20, 30), (ends[0], 20, 30), (ends[1], 20, 30), (110, 20, 30)))
    risks = find_risks(replace(robot, body=valley_body().with_parts(legs)))
    assert any("leaves the body by 10" in risk or "leaves the body by 9" in risk for risk in risks)


def test_world_winch_may_come_in_through_the_surface() -> None:
    """Oracle: the way to the body and the place where it enters are no risk, nor is a cable sewn to the skin."""
    for depth in (20.0, 1.0):
        route = ((-50, 20, 20), (0, 20, depth), (60, 20, depth), (110, 20, depth))
        assert find_risks(solid_robot(route=route, mount=Mount.WORLD)) == []


def test_spool_sticks_out() -> None:
    """Oracle: a winch 5 mm from a side with a spool of 6 mm."""
    robot = solid_robot(route=((10, 5, 28), (60, 12, 28), (110, 12, 28)))
    line = "winch[0] one: a spool of radius 6 mm sticks out, the surface is 5 mm away; move it inward"
    assert find_risks(robot) == [line]


@pytest.mark.slow
def test_a_mesh_unlike_its_surface() -> None:
    """By hand: the tip of a needle is far thinner than the elements; a ball is not."""
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rim = np.column_stack([0.02 * np.cos(turns), 0.02 * np.sin(turns), np.zeros(24)])
    vertices = np.concatenate([rim, [[0, 0, 0.2], [0, 0, 0]]])
    sides = [(i, (i + 1) % 24, 24) for i in range(24)] + [((i + 1) % 24, i, 25) for i in range(24)]
    needle = SurfaceSketch.of_scan(
        write_ply(Surface(vertices, np.array(sides))), file="a.ply", name="a", element_size=0.009
    )
    found = [risk for risk in find_risks(needle.robot) if "off the surface" in risk]
    assert len(found) == 1
    assert "mm the mesh is" in found[0]
    assert not any("other holes" in risk for risk in find_risks(needle.robot))
    ball = contour(lambda points: np.linalg.norm(points, axis=1) - 0.03, np.array([[-0.04] * 3, [0.04] * 3]), 0.004)
    smooth = SurfaceSketch.of_scan(write_ply(ball), file="b.ply", name="b", element_size=0.01)
    assert not any("off the surface" in risk or "other holes" in risk for risk in find_risks(smooth.robot))


def test_limbs_that_have_grown_together() -> None:
    """By hand: a ring whose hole is a hundredth of an element wide has another Euler characteristic than a disc."""
    ball = contour(lambda points: np.linalg.norm(points, axis=1) - 0.03, np.array([[-0.04] * 3, [0.04] * 3]), 0.004)
    robot = SurfaceSketch.of_scan(write_ply(ball), file="b.ply", name="b", element_size=0.01).robot
    ring = contour(
        lambda points: np.hypot(np.hypot(points[:, 0], points[:, 1]) - 0.02, points[:, 2]) - 0.008,
        np.array([[-0.04] * 3, [0.04] * 3]),
        0.004,
    )
    healing = robot.body.healing
    assert healing is not None
    other = replace(robot, body=replace(robot.body, healing=replace(healing, surface=ring)))
    assert any("other holes" in risk for risk in find_risks(other))
    assert not any("other holes" in risk for risk in find_risks(robot))
