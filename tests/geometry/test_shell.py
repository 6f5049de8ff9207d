"""Distances of a closed boundary. Oracles: shapely in the plane, winding numbers in space, differences."""

import numpy as np
import pytest
import trimesh
from builders import box_mesh, strip_mesh
from shapely import Point

from hydrostat.geometry.outline import Outline
from hydrostat.geometry.shell import Shell
from hydrostat.geometry.surface import Solid, Surface

ANGLES = np.linspace(0, 2 * np.pi, 10, endpoint=False)
RADII = np.where(np.arange(10) % 2, 0.02, 0.06)
STAR = Outline(
    RADII[:, None] * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]),
    (0.008 * np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]),),
)


def thorn() -> Surface:
    """A surface with sharp corners and edges, bent inwards and outwards: an icosahedron with every vertex moved."""
    made = trimesh.creation.icosphere(1, 0.05)
    random = np.random.default_rng(3)
    return Surface(made.vertices * random.uniform(0.5, 1.5, (len(made.vertices), 1)), np.asarray(made.faces))


def test_distances_in_the_plane_are_those_of_shapely() -> None:
    points = np.random.default_rng(0).uniform(-0.08, 0.08, (500, 2))
    points = np.concatenate([points, 1.1 * STAR.exterior, 0.9 * STAR.exterior])
    found = Shell.of_outline(STAR).nearest(points)
    boundary = STAR.polygon.boundary
    expected = [
        boundary.distance(Point(point)) * (-1 if STAR.polygon.contains(Point(point)) else 1) for point in points
    ]
    np.testing.assert_allclose(found.distances, expected, atol=1e-15)


def test_distances_in_space_are_those_of_the_solid() -> None:
    surface = thorn()
    points = np.random.default_rng(0).uniform(-0.09, 0.09, (3000, 3))
    points = np.concatenate([points, 1.02 * surface.vertices, 0.98 * surface.vertices])
    found = Shell(surface.vertices, surface.triangles).nearest(points)
    np.testing.assert_allclose(found.distances, Solid(surface).distances(points), atol=1e-9)


@pytest.mark.parametrize("shell", [Shell.of_outline(STAR), Shell(thorn().vertices, thorn().triangles)], ids=["2", "3"])
def test_derivatives_are_those_of_differences(shell: Shell) -> None:
    """By the point, and by the nodes of the facet; all but the few points whose nearest place jumps agree."""
    random, dim = np.random.default_rng(1), shell.nodes.shape[1]
    points = random.uniform(-0.08, 0.08, (400, dim))
    here, step = shell.nearest(points), 1e-7
    away = step * random.standard_normal(points.shape)
    change = shell.nearest(points + away).distances - shell.nearest(points - away).distances
    errors = np.abs(change - 2 * np.einsum("pd,pd->p", here.directions, away))
    assert np.quantile(errors, 0.99) < 1e-6 * step
    away = step * random.standard_normal(shell.nodes.shape)
    change = (
        shell.with_nodes(shell.nodes + away).nearest(points).distances
        - shell.with_nodes(shell.nodes - away).nearest(points).distances
    )
    moved = np.einsum("pc,pcd->pd", here.shares, away[here.stencils])
    errors = np.abs(change + 2 * np.einsum("pd,pd->p", here.directions, moved))
    assert np.quantile(errors, 0.99) < 1e-5 * step


@pytest.mark.parametrize("mesh", [strip_mesh(6, 2), box_mesh((3, 2, 2))], ids=["2", "3"])
def test_the_boundary_of_a_mesh_is_a_closed_shell_with_the_body_inside(mesh) -> None:
    shell = Shell(mesh.nodes, mesh.boundary)
    assert shell.is_closed
    assert not Shell(mesh.nodes, mesh.boundary[1:]).is_closed
    middle, normal = mesh.nodes[mesh.boundary].mean(axis=1), 1e-4 * shell._normals
    np.testing.assert_allclose(shell.nearest(middle - normal).distances, -1e-4, rtol=1e-9)
    np.testing.assert_allclose(shell.nearest(middle + normal).distances, 1e-4, rtol=1e-9)
    np.testing.assert_allclose(shell.nearest(mesh.nodes[mesh.boundary_nodes]).distances, 0.0, atol=1e-15)


def test_places_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        Shell.of_outline(STAR).nearest(np.array([[np.nan, 0.0]]))
