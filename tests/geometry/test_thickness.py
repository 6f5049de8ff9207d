"""Thickness and clearance. Oracle: boxes, strips and balls, whose thickness and distances are known in closed form."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.geometry.anchors import clearance
from hydrostat.geometry.thickness import Thickness


def test_spacing_is_the_edge_of_a_regular_simplex() -> None:
    """Oracle: regular triangles and tetrahedra of edge 3."""
    flat = Mesh(3 * np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]]), np.array([[0, 1, 2]]))
    corners = 3 / 8**0.5 * np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]])
    solid = Mesh(corners, np.array([[0, 1, 2, 3]]))
    assert flat.spacings == pytest.approx([3.0])
    assert solid.spacings == pytest.approx([3.0])


@pytest.mark.parametrize("cells", [(1, 1, 1), (5, 3, 2), (8, 4, 4)])
def test_thickness_of_a_box(cells: tuple[int, int, int]) -> None:
    """Oracle: straight in from each facet it is the side of the box along its normal; half way is the middle."""
    size = np.array([0.1, 0.05, 0.03])
    mesh = box_mesh(cells, size=tuple(size))
    found = Thickness.measure(mesh)
    corners = mesh.nodes[mesh.boundary]
    axis = np.argmin(np.ptp(corners, axis=1), axis=1)
    assert found.chords == pytest.approx(size[axis], rel=1e-12)
    assert found.middles[np.arange(len(axis)), axis] == pytest.approx(size[axis] / 2, rel=1e-12)
    assert found.areas.sum() == pytest.approx(2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]))
    assert found.spacing == pytest.approx(np.full(len(axis), mesh.spacings[0]))
    thin, few = found.part(0.01)
    assert thin == pytest.approx(0.03)
    assert few == pytest.approx(0.03 / mesh.spacings[0])


def test_thickness_of_a_strip() -> None:
    """Oracle: 50 mm across, 200 mm along, in the plane."""
    found = Thickness.measure(strip_mesh(16, 4))
    assert set(np.round(found.chords, 12)) == {0.05, 0.2}
    assert found.areas.sum() == pytest.approx(0.5)


def test_thickness_of_a_ball() -> None:
    """Oracle: through the middle of a ball; the cube is blown up, so facets are a little askew."""
    cube = box_mesh((10, 10, 10), size=(2.0, 2.0, 2.0))
    centered = cube.nodes - 1.0
    size, radius = np.abs(centered).max(axis=1, keepdims=True), np.linalg.norm(centered, axis=1, keepdims=True)
    ball = Mesh(centered * np.divide(size, radius, out=np.ones_like(size), where=radius > 0), cube.elements)
    found = Thickness.measure(ball)
    assert np.median(found.chords) == pytest.approx(2.0, rel=0.03)
    assert found.chords.max() <= 2.0 + 1e-9
    assert found.thin_parts(3.0) == []


def dumbbell() -> Mesh:
    """Two boxes of 40 mm joined by a bar of 10 x 10 mm, 60 mm long, of cells of 10 mm."""
    mesh = box_mesh((14, 4, 4), size=(0.14, 0.04, 0.04))
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    bar = (np.abs(middles[:, 1:] - 0.015) < 0.005).all(axis=1)
    kept = mesh.elements[(np.abs(middles[:, 0] - 0.07) > 0.03) | bar]
    used, elements = np.unique(kept, return_inverse=True)
    return Mesh(mesh.nodes[used], elements.reshape(-1, 4))


def test_thin_part_is_found_and_named() -> None:
    """Oracle: the bar between two blocks: 10 mm thick, one cell, from 40 to 100 mm; nothing where nothing is thin."""
    found = Thickness.measure(dumbbell())
    (part,) = found.thin_parts(2.0)
    assert part.thickness == pytest.approx(0.01)
    assert part.across == pytest.approx(1 / 1.1225, rel=0.1)
    assert part.place[1:] == pytest.approx([0.015, 0.015], abs=0.006)
    assert 0.04 < part.place[0] < 0.1
    assert 0.045 < part.length < 0.06
    assert found.thin_parts(0.5) == []


def test_a_stub_is_no_limb() -> None:
    """Oracle: the same bar, 10 mm long, between the blocks."""
    mesh = dumbbell()
    squeezed = mesh.nodes.copy()
    squeezed[:, 0] = np.interp(squeezed[:, 0], [0, 0.04, 0.1, 0.14], [0, 0.04, 0.05, 0.09])
    assert Thickness.measure(Mesh(squeezed, mesh.elements)).thin_parts(2.0) == []


def test_clearance() -> None:
    """Oracle: distance from the faces of a box in closed form, inside and outside, beside its edges and corners."""
    size = np.array([0.1, 0.05, 0.03])
    rng = np.random.default_rng(1)
    points = rng.uniform(-0.05, 0.15, (500, 3))
    beyond = np.maximum(np.maximum(-points, points - size), 0)
    depth = np.minimum(points, size - points).min(axis=1)
    expected = np.where(depth > 0, depth, np.linalg.norm(beyond, axis=1))
    for cells in ((1, 1, 1), (6, 3, 2)):
        assert clearance(box_mesh(cells, size=tuple(size)), points) == pytest.approx(expected, abs=1e-15)
    flat = strip_mesh(7, 2)
    assert clearance(flat, np.array([[0.1, 0.02], [0.1, 0.03], [-0.03, 0.065]])) == pytest.approx([0.005, 0.005, 0.05])
    assert clearance(flat, np.zeros((0, 2))).shape == (0,)
