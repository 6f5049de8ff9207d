"""Cutting the skin: discs that cover it once, smooth seams, the same on both sides."""

import numpy as np
import pytest
import shapely
from patch_bodies import ellipsoid_body, skin_of_ball
from shapely.geometry.base import BaseGeometry

from hydrostat.errors import InputError
from hydrostat.fabrication.patches.chord import is_narrow
from hydrostat.fabrication.patches.cutting import MAX_STRETCH, Cutting, cut_skin, front_and_back, thin_direction
from hydrostat.fabrication.patches.flatten import distortion, flatten
from hydrostat.fabrication.patches.patch import disc_of
from hydrostat.fabrication.patches.seams import Seam, find_seams
from hydrostat.fabrication.patches.skin_mesh import SkinMesh, skin_mesh, skin_of_surface
from hydrostat.geometry import Outline, Surface, inflate

UP = np.array([0.0, 0.0, 1.0])


def euler(triangles: np.ndarray) -> int:
    """Vertices less edges plus triangles: 1 for a disc."""
    edges = np.unique(np.sort(triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2), axis=1), axis=0)
    return len(np.unique(triangles)) - len(edges) + len(triangles)


def test_dividing_keeps_the_surface():
    ball = skin_of_ball()
    marked = np.arange(len(ball.edges[0])) % 3 == 0
    divided, parent = ball.divide_edges(marked, np.full(len(marked), 0.3))
    assert divided.areas.sum() == pytest.approx(ball.areas.sum(), rel=1e-12)
    assert np.bincount(parent, divided.areas) == pytest.approx(ball.areas, rel=1e-9)
    assert euler(divided.triangles) == 2


def test_a_lens_is_cut_along_its_edge():
    """By symmetry: in the plane of its two long axes, and the front is on one side of it."""
    mesh = skin_mesh(ellipsoid_body((0.12, 0.05, 0.1), cells=12))
    assert thin_direction(mesh) == pytest.approx([0, 1, 0])
    cut = front_and_back(mesh)
    line = cut.vertices[np.unique(cut.edges[0][(cut.patch[cut.neighbors] == [0, 1]).all(axis=1)])]
    assert np.abs(line[:, 1]).max() < 2.0
    front = cut.vertices[cut.triangles[cut.patch == 0]].mean(axis=1)
    assert (front[:, 1] < 2.0).all()


def test_the_seam_of_a_flat_ball_is_as_long_as_its_equator():
    ball = skin_of_ball(40.0)
    flat = SkinMesh(vertices=ball.vertices * [1, 0.9, 1], triangles=ball.triangles, patch=ball.patch)
    cut = front_and_back(flat)
    sides = cut.patch[cut.neighbors]
    ends = cut.vertices[cut.edges[0][sides[:, 0] != sides[:, 1]]]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * np.pi * 40.0, rel=0.005)


@pytest.fixture(scope="module")
def ball() -> Cutting:
    return cut_skin(skin_mesh(ellipsoid_body((0.1, 0.1, 0.1))))


@pytest.fixture(scope="module")
def lens() -> Cutting:
    return cut_skin(skin_mesh(ellipsoid_body((0.12, 0.04, 0.1))))


@pytest.mark.parametrize("name", ["ball", "lens"])
@pytest.mark.slow
def test_patches_are_discs_that_cover_the_skin_once(name, request):
    cutting = request.getfixturevalue(name)
    mesh = skin_mesh(ellipsoid_body({"ball": (0.1, 0.1, 0.1), "lens": (0.12, 0.04, 0.1)}[name]))
    areas = sum(patch.disc.areas.sum() for patch in cutting.patches)
    assert areas == pytest.approx(mesh.areas.sum(), rel=1e-9)
    assert all(euler(patch.disc.triangles) == 1 for patch in cutting.patches)
    assert all((patch.flat_areas > 0).all() for patch in cutting.patches)
    assert set(cutting.mesh.patch.tolist()) == set(range(len(cutting.patches)))
    assert max(distortion(patch).give(0.95) for patch in cutting.patches) <= MAX_STRETCH


@pytest.mark.slow
def test_a_rounder_body_takes_more_patches(ball, lens):
    assert lens.names == ("front", "back")
    assert len(ball.patches) > 2
    assert len(set(ball.names)) == len(ball.patches)


def test_seams_are_all_rims_twice(ball):
    seams = find_seams(ball.mesh, ball.patches, UP)
    rims = 0.0
    for patch in ball.patches:
        around = patch.disc.vertices[patch.disc.rim]
        rims += np.linalg.norm(np.roll(around, -1, axis=0) - around, axis=1).sum()
    assert 2 * sum(seam.length for seam in seams) == pytest.approx(rims, rel=1e-12)
    flat = sum(patch.outline.exterior.length for patch in ball.patches)
    assert sum(sum(seam.lengths) for seam in seams) == pytest.approx(flat, rel=1e-12)
    assert max(seam.mismatch for seam in seams) < 0.08


def test_places_of_a_seam_are_one_place_of_the_body(lens):
    """Each side's place, taken back to the body through its triangles, is the place of the seam."""
    (seam,) = find_seams(lens.mesh, lens.patches, UP)
    assert seam.closed
    assert seam.solid[0, 2] == pytest.approx(seam.solid[:, 2].max())
    for along in (0.0, 0.3 * seam.length, 0.8 * seam.length):
        there = np.array(seam.on_body(along))
        assert seam.nearest(there) == pytest.approx((0.0, along), abs=1e-6)
        for side, number in enumerate(seam.patches):
            patch = lens.patches[number]
            rim = patch.disc.rim
            starts, ways = patch.flat[rim], np.roll(patch.flat[rim], -1, axis=0) - patch.flat[rim]
            to = np.array(seam.place(along, side)) - starts
            share = np.clip((to * ways).sum(axis=1) / (ways**2).sum(axis=1), 0, 1)
            edge = int(np.linalg.norm(to - share[:, None] * ways, axis=1).argmin())
            one, other = patch.disc.vertices[[rim[edge], rim[(edge + 1) % len(rim)]]]
            assert one + share[edge] * (other - one) == pytest.approx(there, abs=1e-6)


def test_a_patch_that_touches_itself_in_a_corner_is_still_a_disc():
    ball = skin_of_ball()
    touching = int(ball.triangles[0, 0])
    fan = np.flatnonzero((ball.triangles == touching).any(axis=1))
    patch = np.ones(len(ball.triangles), dtype=np.int64)
    patch[fan[0]] = 0
    opposite = next(
        index for index in fan[1:] if len(np.intersect1d(ball.triangles[index], ball.triangles[fan[0]])) == 1
    )
    patch[opposite] = 2
    disc = disc_of(ball.relabel_patches(np.where(patch == 1, 1, 0)), 1)
    assert (disc.of == touching).sum() == 2


def test_bodies_that_cannot_be_cut_are_refused():
    from builders import mesh_body, strip_mesh

    with pytest.raises(InputError, match="flat body"):
        skin_mesh(mesh_body(strip_mesh(4, 2)))


def test_short_seams_are_not_refused_for_what_nobody_sees() -> None:
    """By hand: of 5 mm and 5.4 mm nothing is left, of 10 mm and 11.5 mm a tenth, of 100 mm and 106.5 mm 6 %."""

    def straight(length: float) -> np.ndarray:
        return np.array([[0.0, 0.0], [length, 0.0]])

    def mismatch(one: float, other: float) -> float:
        solid = np.array([[0.0, 0.0, 0.0], [one, 0.0, 0.0]])
        return Seam(patches=(0, 1), closed=False, solid=solid, sides=(straight(one), straight(other))).mismatch

    assert mismatch(5.0, 5.4) == 0.0
    assert mismatch(11.5, 10.0) == pytest.approx(0.1)
    assert mismatch(100.0, 106.5) == pytest.approx(0.06)


def test_necks_are_seen() -> None:
    """Two squares of 20 mm, joined by a strip 10 mm or 6 mm wide."""

    def dumbbell(neck: float) -> BaseGeometry:
        squares = [shapely.box(0, 0, 20, 20), shapely.box(30, 0, 50, 20)]
        return shapely.union_all([*squares, shapely.box(20, 10 - neck / 2, 30, 10 + neck / 2)])

    assert not is_narrow(dumbbell(10.0))
    assert is_narrow(dumbbell(6.0))
    assert is_narrow(shapely.box(0, 0, 40, 6))


def test_very_fine_surfaces_are_cut_as_coarser_ones() -> None:
    """A ball of 32768 triangles: far fewer are as good to a thousandth, closed, and the same each time."""
    fine = skin_of_ball()
    for _ in range(2):
        fine, _ = fine.divide_edges(np.ones(len(fine.edges[0]), dtype=bool), np.full(len(fine.edges[0]), 0.5))
    surface = Surface(1e-3 * fine.vertices, fine.triangles)
    first, again = skin_of_surface(surface), skin_of_surface(surface)
    assert len(first.triangles) < len(fine.triangles) / 3
    assert first.areas.sum() == pytest.approx(fine.areas.sum(), rel=1e-3)
    assert euler(first.triangles) == 2
    assert (first.vertices == again.vertices).all()


@pytest.mark.slow
def test_a_tail_that_turns_up_is_sewn_in_a_front_and_a_back() -> None:
    """Laid flat with least mean distortion such a panel gives too much; evened out it does not."""
    turn = np.linspace(np.pi, 2 * np.pi + 0.8, 40)
    tail = shapely.LineString(np.column_stack([0.07 + 0.03 * np.cos(turn), 0.03 * np.sin(turn) - 0.02]))
    cat = shapely.Point(0, 0).buffer(0.05).union(tail.buffer(0.013))
    cat = cat.buffer(0.006).buffer(-0.012).buffer(0.006).simplify(1e-4)
    mesh = skin_of_surface(inflate(Outline(shapely.get_coordinates(cat)[:-1]), 0.055, spacing=0.004))
    halves = front_and_back(mesh)
    assert distortion(flatten(disc_of(halves, 0))).give(0.95) > MAX_STRETCH
    cutting = cut_skin(mesh)
    assert cutting.names == ("front", "back")
    assert max(distortion(patch).give(0.95) for patch in cutting.patches) <= MAX_STRETCH
    (seam,) = find_seams(cutting.mesh, cutting.patches, UP)
    assert seam.mismatch < 0.01
