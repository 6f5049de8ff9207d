"""The renderer against exact geometry: areas, silhouettes, depths, normals, light."""

import numpy as np
import pytest
import shapely
from builders import box_mesh

from hydrostat.drawing.camera import Camera
from hydrostat.drawing.creases import smooth_normals
from hydrostat.drawing.depth import DepthBuffer
from hydrostat.drawing.palette import Color, sky_shares
from hydrostat.drawing.render import Render, render
from hydrostat.geometry import Mesh

SIDES = (0.1, 0.05, 0.03)
EYES = ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.5, -0.8, 0.4], [-0.3, 0.2, 0.9], [0.1, 1.0, -0.2])


def box() -> Mesh:
    return box_mesh((4, 3, 2), size=SIDES)


@pytest.mark.parametrize("eye", EYES)
def test_a_box_covers_its_projected_area(eye: list[float]) -> None:
    """Oracle: the area of a box seen along n is |n_x| b c + |n_y| c a + |n_z| a b."""
    mesh, camera = box(), Camera.towards(np.array(eye))
    image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25)
    a, b, c = 1e3 * np.array(SIDES)
    exact = float(np.abs(camera.axes[2]) @ np.array([b * c, c * a, a * b]))
    assert image.colors[..., 3].sum() * image.buffer.pixel**2 == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize("eye", EYES)
def test_the_silhouette_of_a_box(eye: list[float]) -> None:
    """Oracle: a convex body's silhouette is the hull of its seen nodes; corners are cut by less than a pixel."""
    mesh, camera = box(), Camera.towards(np.array(eye))
    spots = camera.see(1e3 * mesh.nodes)
    image = Render.silhouette(spots, mesh.boundary, pixel=0.25)
    rings = image.rings()
    hull = shapely.MultiPoint(spots[:, :2]).convex_hull
    assert len(rings) == 1
    assert shapely.hausdorff_distance(shapely.Polygon(rings[0]).exterior, hull.exterior) < image.buffer.pixel


def test_a_hole_is_a_ring_of_its_own() -> None:
    """Oracle: the middle cell taken out of a plate leaves an inner ring of that cell's area."""
    plate = box_mesh((3, 3, 1), size=(0.03, 0.03, 0.01))
    middles = plate.nodes[plate.elements].mean(axis=1)
    away = (np.abs(middles[:, :2] - 0.015) < 0.005).all(axis=1)
    mesh = Mesh(plate.nodes, plate.elements[~away])
    spots = Camera.towards(np.array([0.0, 0.0, 1.0])).see(1e3 * mesh.nodes)
    outer, inner = Render.silhouette(spots, mesh.boundary, pixel=0.1).rings()
    assert shapely.Polygon(outer).area == pytest.approx(900, rel=5e-3)
    assert shapely.Polygon(inner).area == pytest.approx(100, rel=1e-2)


def two_boxes() -> tuple[np.ndarray, np.ndarray]:
    """Nodes [mm] and boundary of a small box that hovers 50 mm above the middle of a large one."""
    low, high = box_mesh((1, 1, 1), size=(0.1, 0.1, 0.02)), box_mesh((1, 1, 1), size=(0.04, 0.04, 0.01))
    nodes = np.concatenate([low.nodes, high.nodes + np.array([0.03, 0.03, 0.07])])
    return nodes, np.concatenate([low.boundary, high.boundary + len(low.nodes)])


@pytest.mark.parametrize(("up", "hidden"), [(1.0, True), (-1.0, False)])
def test_the_nearer_surface_wins(up: float, hidden: bool) -> None:
    """Oracle: the heights of the faces that look at the eye; seen from below, the large box hides the small one."""
    nodes, facets = two_boxes()
    camera = Camera.towards(np.array([0.0, 0.0, up]))
    image = render(camera.see(1e3 * nodes), facets, pixel=0.5)
    levels, counts = np.unique(np.round(image.buffer.depth[np.isfinite(image.buffer.depth)], 3), return_counts=True)
    if hidden:
        assert levels.tolist() == [20.0, 80.0]
        assert counts * image.buffer.pixel**2 == pytest.approx([100**2 - 40**2, 40**2], rel=0.02)
    else:
        assert levels.tolist() == [0.0]


def test_the_order_of_facets_does_not_matter(rng: np.random.Generator) -> None:
    nodes, facets = two_boxes()
    spots = Camera.towards(np.array([0.4, -0.7, 0.5])).see(1e3 * nodes)
    one, two = (render(spots, order, pixel=0.5) for order in (facets, rng.permutation(facets)))
    assert np.abs(one.colors - two.colors).max(axis=2).mean() < 1e-3
    assert (
        np.array_equal(one.buffer.depth, two.buffer.depth)
        or np.nanmax(np.abs(one.buffer.depth - two.buffer.depth)) < 1e-3
    )


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def test_depth_is_that_of_the_plane(rng: np.random.Generator) -> None:
    """Oracle: the plane through three points, and the sign of three areas, at the middle of every pixel."""
    corners = rng.uniform(2, 38, size=(1, 3, 3))
    a, b, c = corners[0]
    if (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0:
        corners = corners[:, [0, 2, 1]]
    buffer = DepthBuffer.within(corners, corners.copy(), np.full(2, 0.5), 1.0, (40, 40), inside=False)
    depth, shown = buffer.depth, buffer.shown
    x, y = np.meshgrid(np.arange(40) + 0.5, np.arange(40) + 0.5)
    plane = np.linalg.solve(np.column_stack([corners[0, :, :2], np.ones(3)]), corners[0, :, 2])
    inside = shapely.contains_xy(shapely.Polygon(corners[0, :, :2]), x, y)
    assert np.array_equal(np.isfinite(depth), inside)
    assert depth[inside] == pytest.approx((plane[0] * x + plane[1] * y + plane[2])[inside], rel=1e-5)
    assert shown[inside][:, 0] == pytest.approx(x[inside], rel=1e-5)


@pytest.mark.parametrize("inside", [False, True])
def test_facets_that_look_away_are_seen_from_inside_only(inside: bool) -> None:
    corners = np.array([[[1.0, 1.0, 0.0], [1.0, 9.0, 0.0], [9.0, 1.0, 0.0]]])
    buffer = DepthBuffer.within(corners, corners, np.zeros(2), 1.0, (10, 10), inside=inside)
    assert np.isfinite(buffer.depth).any() == inside
    assert (buffer.owner >= 0).any() == inside


def test_a_coarser_buffer_sees_the_same_places() -> None:
    """Oracle: the buffer of larger pixels made at once, on a plane whose depth is that of its place."""
    corners = np.array([[[0.0, 0.0, 0.0], [40.0, 0.0, 40.0], [0.0, 40.0, 0.0]]])
    fine = DepthBuffer.within(corners, corners, np.full(2, 0.5), 1.0, (40, 40), inside=False)
    coarse = fine.coarser(3)
    direct = DepthBuffer.within(corners, corners, np.full(2, 1.5), 3.0, (13, 13), inside=False)
    assert coarse.low == pytest.approx(direct.low)
    assert coarse.depth[:13, :13] == pytest.approx(direct.depth)


def test_a_point_is_covered_as_deep_as_it_lies() -> None:
    """Oracle: the front face of the box is at y = 0, its back face at 50 mm."""
    mesh, camera = box(), Camera.towards(np.array([0.0, -1.0, 0.0]))
    image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25)
    points = np.array([[0.05, 0.01, 0.01], [0.05, 0.06, 0.01], [0.05, -0.01, 0.01], [0.05, 0.01, 0.2], [0.3, 0.01, 0]])
    assert image.covers(camera.see(1e3 * points)) == pytest.approx([10, 60, 0, 0, 0], abs=1e-3)


def normals_of(mesh: Mesh, sharp: float) -> np.ndarray:
    return smooth_normals(mesh.nodes[mesh.boundary], mesh.boundary, sharp=sharp)


def test_edges_of_a_box_stay_sharp_and_a_cylinder_is_round() -> None:
    """Oracle: the axis normals of the faces; the radius of a bent box (a ring) at its nodes."""
    mesh = box()
    normals = normals_of(mesh, 45.0)
    corners = mesh.nodes[mesh.boundary]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert normals == pytest.approx(np.repeat(flat[:, None], 3, axis=1), abs=1e-12)

    bent = box_mesh((24, 1, 2), size=(3.0, 0.2, 0.4))
    angle, radius = bent.nodes[:, 0], 1 + bent.nodes[:, 1]
    ring = Mesh(np.column_stack([radius * np.sin(angle), radius * np.cos(angle), bent.nodes[:, 2]]), bent.elements)
    outside = ring.boundary[(np.linalg.norm(ring.nodes[ring.boundary][..., :2], axis=2) > 1.19).all(axis=1)]
    inner = ((ring.nodes[outside][..., 0] > 0.4) & (np.abs(ring.nodes[outside][..., 1]) < 0.9)).all(axis=1)
    rows = {tuple(facet) for facet in outside[inner]}
    keep = np.array([tuple(facet) in rows for facet in ring.boundary])
    at = ring.nodes[ring.boundary[keep]] * np.array([1.0, 1.0, 0.0])
    radial = at / np.linalg.norm(at, axis=2, keepdims=True)
    shading = normals_of(ring, 42.0)[keep]
    assert np.einsum("fcd,fcd->fc", shading, radial).min() > np.cos(np.radians(3.5))
    assert np.einsum("fcd,fcd->fc", normals_of(ring, 0.25)[keep], radial).min() < np.cos(np.radians(3.5))


def test_a_plane_sees_all_the_sky_and_a_corner_does_not() -> None:
    """Oracle: nothing rises above a plane, tilted or not; sky is lost beside a wall, not far from it."""
    normals = np.zeros((40, 40, 3))
    normals[..., 2] = 1.0
    assert sky_shares(np.zeros((40, 40)), normals, 8.0).min() == 1.0
    slope = 0.5 * np.arange(40.0)[None, :] * np.ones((40, 1))
    normals[...] = np.array([-0.5, 0.0, 1.0]) / np.sqrt(1.25)
    assert sky_shares(slope, normals, 8.0).min() == 1.0
    normals[...] = [0.0, 0.0, 1.0]
    wall = np.where(np.arange(40) < 20, 0.0, 10.0)[None, :] * np.ones((40, 1))
    sky = sky_shares(wall, normals, 8.0)[20]
    assert sky[19] < 0.8
    assert sky[5] == 1.0
    assert (np.diff(sky[8:20]) <= 1e-6).all()


def test_light_comes_from_above_and_felt_looks_like_felt() -> None:
    """Oracle: the top of a box is lighter than its front, the front than its underside; red > green > blue as felt."""
    mesh = box()
    tones = {}
    faces = {"top": [0.05, 0.025, 0.03], "front": [0.05, 0.0, 0.015], "under": [0.05, 0.025, 0.0]}
    for name, eye in {"above": [0.5, -0.5, 0.7], "below": [0.5, -0.5, -0.7]}.items():
        camera = Camera.towards(np.array(eye))
        image = render(camera.see(1e3 * mesh.nodes), mesh.boundary, pixel=0.25, up=camera.axes[:, 2])
        for face, middle in faces.items():
            spot = camera.see(1e3 * np.array([middle]))
            column, row = np.rint((spot[0, :2] - image.buffer.low) / image.buffer.pixel).astype(int)
            if abs(image.buffer.depth[row, column] - spot[0, 2]) < 0.5:
                tones[name, face] = image.colors[row, column, :3]
    assert tones["above", "top"].sum() > tones["above", "front"].sum() > tones["below", "under"].sum()
    for tone in tones.values():
        assert tone[0] > tone[1] > tone[2]
    felt = np.array([int(Color.FELT[start : start + 2], 16) for start in (1, 3, 5)]) / 255
    assert np.abs(tones["above", "front"] - felt).max() < 0.16


def test_what_is_held_is_hatched_and_nothing_else() -> None:
    """Oracle: the images with and without hatching differ only left of the middle between held and free nodes."""
    mesh, camera = box(), Camera.towards(np.array([0.0, -1.0, 0.0]))
    spots, held = camera.see(1e3 * mesh.nodes), (mesh.nodes[:, 0] < 1e-6).astype(float)
    plain, hatched = (
        render(spots, mesh.boundary, pixel=0.25, held=mask, point=0.5).colors for mask in (np.zeros_like(held), held)
    )
    columns = np.flatnonzero(np.abs(plain - hatched).max(axis=(0, 2)) > 0.02)
    assert columns.min() <= 3
    assert (columns.max() - 2) * 0.25 == pytest.approx(12.5, abs=0.5)


def test_pale_felt_is_lighter() -> None:
    mesh = box()
    spots = Camera.towards(np.array([0.5, -0.5, 0.7])).see(1e3 * mesh.nodes)
    full, pale = (render(spots, mesh.boundary, pixel=0.5, pale=share).colors for share in (0.0, 0.4))
    inside = full[..., 3] == 1
    assert (pale[inside][:, :3] >= full[inside][:, :3] - 1e-9).all()
    assert pale[inside].mean() > full[inside].mean() + 0.03


@pytest.mark.parametrize("eye", EYES)
def test_a_camera_keeps_lengths_and_up(eye: list[float]) -> None:
    """Oracle: its axes are a right-handed orthonormal frame, and z has no share to the right."""
    axes = Camera.towards(np.array(eye)).axes
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert axes[0, 2] == pytest.approx(0, abs=1e-12)
    assert axes[1, 2] >= -1e-12


@pytest.mark.parametrize("turn", [0.0, 0.4, 1.2, 2.5])
def test_the_long_side_of_a_body_is_seen(turn: float) -> None:
    """Oracle: however a rod lies, its projected length is sin(58 degrees) of the true one or more."""
    rod = box_mesh((4, 1, 1), size=(0.2, 0.02, 0.02)).nodes
    spin = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    camera = Camera.three_quarter(rod @ spin.T, np.empty((0, 3)))
    way = camera.see((spin @ np.array([200.0, 0.0, 0.0]))[None])[0]
    assert np.hypot(way[0], way[1]) >= 200 * np.sin(np.radians(58)) - 1e-6
    assert 0.2 < camera.axes[2, 2] < 0.7


def test_the_eye_is_where_things_are_to_be_seen() -> None:
    nodes = box().nodes
    for y in (0.0, 0.05):
        camera = Camera.three_quarter(nodes, np.array([[0.05, y, 0.015]]))
        assert np.sign(camera.axes[2, 1]) == np.sign(y - 0.025)


@pytest.mark.parametrize(("way", "hidden"), [([0.0, 0.0, 0.01], "y"), ([0.0, 0.01, 0.0], "z"), ([0, 0.0, 0.0], "z")])
def test_the_side_view_shows_the_motion(way: list[float], hidden: str) -> None:
    """Oracle: of a box 100 x 50 x 30 mm, the view across the motion in which most is to be seen."""
    nodes = box().nodes
    camera = Camera.along_an_axis(nodes, np.empty((0, 3)), np.tile(np.array(way, dtype=float), (len(nodes), 1)))
    assert "xyz"[int(np.argmax(np.abs(camera.axes[2])))] == hidden
    assert np.abs(camera.axes).max(axis=1) == pytest.approx(1)
