"""Loops of the compiled core against short programs of others: NumPy, SciPy, trimesh. Random inputs.

These loops are compiled once, for all levels of vector instructions.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from hydrostat.kernel import native

SEEDS = [0, 1, 2]


def soup(draw: np.random.Generator, count: int, size: float) -> np.ndarray:
    """Triangles at random places of a picture of `size` pixels, (count, 3, 3); some reach beyond it."""
    return draw.uniform(-0.2, 1.2, (count, 3, 3)) * size


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("inside", [True, False])
def test_rasterise(seed: int, kind: type, inside: bool) -> None:
    """Oracle: barycentric coordinates of every pixel in every triangle by LAPACK; the highest covers."""
    draw = np.random.default_rng(seed)
    rows, columns, spots = 23, 17, soup(draw, 40, 20.0)
    spots[3] = spots[3, 0]  # without area
    values = draw.normal(size=(40, 3, 5)).astype(kind)
    depth, owner, shown = (
        np.full((rows, columns), -np.inf),
        np.full((rows, columns), -1, np.int32),
        np.zeros((rows, columns, 5), kind),
    )
    native.rasterise(spots, values, inside, depth, shown, owner)
    planes = np.concatenate([np.swapaxes(spots[:, :, :2], 1, 2), np.ones((40, 1, 3))], axis=1)
    areas = np.linalg.det(planes)
    kept = (np.abs(areas) > 1e-9) & (inside | (areas > 0))
    y, x = np.indices((rows, columns))
    pixels = np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
    shares = np.full((40, 3, x.size), -1.0)
    shares[kept] = np.linalg.solve(planes[kept], np.broadcast_to(pixels, (kept.sum(), *pixels.shape)))
    heights = np.where((shares >= -1e-9).all(axis=1), np.einsum("tc,tcp->tp", spots[:, :, 2], shares), -np.inf)
    highest = heights.argmax(axis=0)
    seen = heights.max(axis=0) > -np.inf
    assert 0 < seen.sum() < x.size
    assert owner.ravel().tolist() == np.where(seen, highest, -1).tolist()
    assert depth.ravel()[seen] == pytest.approx(heights.max(axis=0)[seen], abs=1e-9)
    mixed = np.einsum("pcv,pc->pv", values[highest], shares[highest, :, np.arange(x.size)])
    assert np.abs(shown.reshape(-1, 5) - np.where(seen[:, None], mixed, 0.0)).max() < (
        1e-5 if kind is np.float32 else 1e-9
    )


def picture(draw: np.random.Generator, height: int, width: int, values: int) -> tuple[np.ndarray, np.ndarray]:
    """Depths, some of nothing, and what is shown: normals, held or not, distances to edges of the mesh."""
    depth = draw.normal(size=(height, width)).cumsum(axis=0).cumsum(axis=1) / 8
    depth[draw.random((height, width)) < 0.2] = -np.inf
    shown = draw.normal(size=(height, width, values))
    shown[..., 2] = np.abs(shown[..., 2])
    shown[..., 3] = draw.random((height, width)) < 0.4
    shown[..., 4:] = draw.uniform(0, 3, shown[..., 4:].shape)
    return depth, shown.astype(np.float32)


def neighbor(depth: np.ndarray, x: int, y: int) -> np.ndarray:
    """Depth `x` columns to the right and `y` rows on; -inf outside the picture."""
    height, width = depth.shape
    around = np.pad(depth, 40, constant_values=-np.inf)
    return around[40 + y : 40 + y + height, 40 + x : 40 + x + width]


@pytest.mark.parametrize("seed", SEEDS)
def test_sky_shares(seed: int) -> None:
    """Oracle: the same sum by whole pictures, moved by each neighbor of a sunflower."""
    draw = np.random.default_rng(seed)
    depth, shown = picture(draw, 31, 29, 4)
    normals = shown[..., :3] / np.linalg.norm(shown[..., :3], axis=2, keepdims=True).astype(float)
    reach, found = 6.0, np.empty(depth.shape, np.float32)
    native.sky_shares(depth, np.ascontiguousarray(normals, dtype=float), reach, found)
    turns = np.arange(40) * np.pi * (3 - np.sqrt(5))  # by the golden angle
    away = reach * np.sqrt((np.arange(40) + 0.5) / 40)
    taken = np.zeros(depth.shape)
    for x, y in zip(np.rint(away * np.cos(turns)).astype(int), np.rint(away * np.sin(turns)).astype(int), strict=True):
        with np.errstate(invalid="ignore"):
            rise = neighbor(depth, x, y) - depth
        far = np.sqrt(x**2 + y**2 + np.where(np.isfinite(rise), rise, 0.0) ** 2)
        lean = np.where(
            np.isfinite(rise), normals @ [x, y, 0] + normals[..., 2] * np.where(np.isfinite(rise), rise, 0), 0
        )
        lean = np.where(np.isfinite(rise), lean / (far + 1e-6) - 0.12, 0)
        taken += np.where(far < 2 * reach, np.maximum(lean, 0) * (1 - far / (2 * reach)), 0)
    expected = np.where(np.isfinite(depth), np.maximum(1 - 2.6 * taken / 40, 0), 1.0)
    assert (expected < 0.9).any()
    assert np.abs(found - expected).max() < 1e-4


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("values", [4, 7])
def test_paint(seed: int, values: int) -> None:
    """Oracle: light, hatching, mesh and edges by whole pictures, the mean over the samples of each pixel."""
    draw = np.random.default_rng(seed)
    fine, dot, jump, up, near, moved = look = np.array([2.0, 4.0, 0.8, 0.6, 0.8, 3.0])
    depth, shown = picture(draw, 24, 20, values)
    sky = draw.random((12, 10)).astype(np.float32)
    table, inks, shares, image = draw.random((9, 3)), draw.random((3, 3)), draw.random(3), np.empty((12, 10, 4))
    native.paint(depth, shown, sky, look, table, inks, shares, image)
    normals = shown[..., :3].astype(float)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    x, y, z = np.moveaxis(normals, 2, 0)
    key = np.clip((normals @ [-0.4801, 0.6202, 0.6202] + 0.25) / 1.25, 0, 1)
    side = np.clip(normals @ [0.8518, 0.0501, 0.5211], 0, 1)
    light = 0.14 + 0.26 * (0.5 + 0.5 * (up * y + near * z)) + 0.56 * key + 0.12 * side
    light *= (1 - 0.22 * (1 - np.clip(z, 0, 1)) ** 3) * (0.35 + 0.65 * np.kron(sky, np.ones((2, 2))))
    scale = np.linspace(0, 1, 9)
    colors = np.stack([np.interp(np.clip(light, 0, 1), scale, column) for column in table.T], axis=2)
    row, column = np.indices(depth.shape)
    along = (column + moved - row) / np.sqrt(2)
    stripe = np.abs(along % (3 * dot) - 1.5 * dot)
    covers = np.zeros((3, *depth.shape))
    covers[0] = (shown[..., 3] > 0.5) * (0.1 + 0.42 * np.clip(0.32 * dot + 0.5 - stripe, 0, 1))
    if values == 7:
        covers[1] = np.clip(0.24 * dot + 0.5 - shown[..., 4:].min(axis=2), 0, 1)
    for turn in range(8):
        u, v = np.rint(0.55 * dot * np.cos(turn * np.pi / 4)), np.rint(0.55 * dot * np.sin(turn * np.pi / 4))
        slope = -(x * u + y * v) / np.maximum(z, 0.15)
        with np.errstate(invalid="ignore"):
            covers[2] = np.maximum(covers[2], neighbor(depth, int(u), int(v)) - depth - np.maximum(slope, 0) > jump)
    for cover, share, ink in zip(covers, shares, inks, strict=True):
        colors += (share * cover)[..., None] * (ink - colors)
    seen = np.isfinite(depth)
    blocks = (
        np.where(seen[..., None], np.dstack([colors, np.ones(depth.shape)]), 0)
        .reshape(12, 2, 10, 2, 4)
        .sum(axis=(1, 3))
    )
    count = blocks[..., 3:]
    expected = np.where(count > 0, blocks[..., :3] / np.maximum(count, 1), inks[2])
    assert covers[2].any()
    assert np.abs(image[..., :3] - expected).max() < 1e-6
    assert np.abs(image[..., 3] - count[..., 0] / fine**2).max() < 1e-12


@pytest.mark.parametrize("seed", SEEDS)
def test_angles_and_normals_at_corners(seed: int) -> None:
    """Oracle: trimesh, on a bumpy ball. With creases: the same mean over the triangles that lie on one side of them."""
    import trimesh

    draw = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.vertices *= draw.uniform(0.8, 1.2, (len(ball.vertices), 1))
    triangles, vertices = (
        np.ascontiguousarray(ball.faces, dtype=np.int64),
        np.ascontiguousarray(ball.vertices, dtype=float),
    )
    angles, corners = np.empty(triangles.shape), np.empty((*triangles.shape, 3))
    native.corner_angles(vertices, triangles, angles)
    assert np.abs(angles - ball.face_angles).max() < 1e-9
    normals = np.array(ball.face_normals, dtype=float)
    order = np.argsort(triangles.ravel(), kind="stable")
    starts = np.append(0, np.cumsum(np.bincount(triangles.ravel())))
    native.corner_normals(triangles, normals, angles, starts, order, -2.0, corners)
    smooth = trimesh.geometry.weighted_vertex_normals(len(vertices), triangles, normals, angles)
    assert np.abs(corners - smooth[triangles]).max() < 1e-9
    sharpest = float(np.cos(np.radians(25)))
    native.corner_normals(triangles, normals, angles, starts, order, sharpest, corners)
    same = (triangles.reshape(-1, 1) == triangles.reshape(1, -1)) & np.kron(
        normals @ normals.T > sharpest, np.ones((3, 3), bool)
    )
    mean = (same * angles.reshape(1, -1)) @ np.repeat(normals, 3, axis=0)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    assert np.abs(mean.reshape(corners.shape) - smooth[triangles]).max() > 0.1
    assert np.abs(corners - mean.reshape(corners.shape)).max() < 1e-9


def split(sizes: list[int], numbers: np.ndarray) -> tuple[list[tuple[np.ndarray, np.ndarray]], np.ndarray]:
    """Layers of one network, and the linear map beside them."""
    layers, at = [], 0
    for one, two in pairwise(sizes):
        weights, at = numbers[at : at + one * two].reshape(one, two), at + one * two
        layers.append((weights, numbers[at : at + two]))
        at += two
    return layers, numbers[at:].reshape(sizes[0], sizes[-1])


@pytest.mark.parametrize("sizes", [[3, 13, 6, 5], [2, 4], [7, 17, 9]])
def test_networks(sizes: list[int]) -> None:
    """Oracle: NumPy, its slopes by complex steps, which are exact; in single precision too."""
    draw = np.random.default_rng(len(sizes))
    count = sum((one + 1) * two for one, two in pairwise(sizes)) + sizes[0] * sizes[-1]
    numbers, point = 0.4 * draw.normal(size=(4, count)), draw.uniform(-1, 1, sizes[0])

    def answer(member: np.ndarray, x: np.ndarray) -> np.ndarray:
        layers, beside = split(sizes, member)
        y = x
        for place, (weights, offsets) in enumerate(layers):
            y = (y if place == 0 else y / (1 + np.exp(-y))) @ weights + offsets
        return y + x @ beside

    expected = np.array([answer(member, point) for member in numbers])
    steps = point + 1e-30j * np.eye(sizes[0])
    slopes = np.mean([answer(member, steps).imag / 1e-30 for member in numbers], axis=0)
    shape, wide = np.array(sizes), sizes[-1]
    values, value, spread, found = np.empty((4, wide)), np.empty(wide), np.empty(wide), np.empty((sizes[0], wide))
    native.network_values(shape, numbers, point, values)
    assert np.abs(values - expected).max() < 1e-12
    native.network_mean(shape, numbers, point, value, found)
    assert np.abs(value - expected.mean(axis=0)).max() < 1e-12
    assert np.abs(found - slopes).max() < 1e-12
    native.network_agreement(shape, numbers.astype(np.float32), point.astype(np.float32), value, spread)
    assert np.abs(value - expected.mean(axis=0)).max() < 1e-5
    assert np.abs(spread - expected.std(axis=0)).max() < 1e-5


@pytest.mark.parametrize("seed", SEEDS)
def test_a_descent_on_a_linear_network(seed: int) -> None:
    """Oracle: SciPy's bounded linear least squares."""
    from scipy.optimize import lsq_linear

    draw = np.random.default_rng(seed)
    beside, offsets, goal, weights = draw.normal(size=(3, 5)), draw.normal(size=5), draw.normal(size=5), draw.random(5)
    numbers = np.concatenate([np.zeros(15), offsets, beside.ravel()])[None]
    low, high, point = np.full(3, -0.3), np.full(3, 0.4), np.zeros(3)
    left = native.network_descent(np.array([3, 5]), numbers, point, goal, weights, low, high, 200)
    best = lsq_linear(weights[:, None] * beside.T, weights * (goal - offsets), bounds=(low, high), tol=1e-14)
    assert left == pytest.approx(2 * best.cost, rel=1e-2)
    assert (point >= low).all()
    assert (point <= high).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_prices_of_edges(seed: int) -> None:
    """Oracles: einsum; the best tension by SciPy's bounded search."""
    draw = np.random.default_rng(seed)
    moves, residual = draw.normal(size=(11, 3, 8)), draw.normal(size=(1, 3, 8))
    pulls, squares = np.empty((2, 11, 3))
    native.edge_products(moves, residual, pulls, squares)
    assert np.abs(pulls - np.einsum("epr,pr->ep", moves, residual[0])).max() < 1e-12
    assert np.abs(squares - np.einsum("epr,epr->ep", moves, moves)).max() < 1e-12
    for pull, square in zip(pulls.ravel(), squares.ravel(), strict=True):
        best = minimize_scalar(
            lambda t, pull=pull, stiff=square + 0.3: -t * pull + t**2 * stiff / 2,
            bounds=(0, 0.5), method="bounded", options={"xatol": 1e-9},
        )  # fmt: skip
        assert native.decrease(pull, square, 0.3, 0.5) == pytest.approx(max(-best.fun, 0.0), abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_turns_and_leads(seed: int) -> None:
    """Oracles: angles of all pairs of edges; SciPy's shortest paths from edge to edge."""
    draw = np.random.default_rng(seed)
    points, blocked = draw.random((14, 2)), draw.random(14) < 0.15
    joined = np.triu(draw.random((14, 14)) < 0.4, 1)
    sources, targets = np.nonzero(joined | joined.T)
    offsets = np.searchsorted(sources, np.arange(15))
    number = {pair: place for place, pair in enumerate(zip(sources.tolist(), targets.tolist(), strict=True))}
    reverses = np.array([number[there, here] for here, there in number])
    spans = points[targets] - points[sources]
    lengths = np.linalg.norm(spans, axis=1)
    least, counts = np.cos(np.radians(70)), np.empty(len(sources) + 1, np.int64)
    given = points, offsets, sources, targets, reverses, blocked, least, counts
    before = np.empty(native.count_turns(*given, np.empty(0, np.int64)), np.int64)
    native.count_turns(*given, before)
    follows = (targets[:, None] == sources) & (targets != sources[:, None]) & ~blocked[sources]
    follows &= spans @ spans.T >= least * np.outer(lengths, lengths)
    assert [set(before[counts[edge] : counts[edge + 1]].tolist()) for edge in range(len(sources))] == [
        set(np.flatnonzero(column).tolist()) for column in follows.T
    ]
    begins = draw.random(len(sources)) < 0.1
    leads, origins, longest = np.where(begins, 0.0, np.inf), np.full(len(sources), -1), 1.5
    native.spread_leads(counts, before, lengths, leads, origins, longest)
    first, second = np.nonzero(follows)
    graph = csr_array((lengths[first], (first, second)), shape=follows.shape)
    far = dijkstra(graph, indices=np.flatnonzero(begins), min_only=True)
    expected = np.where(far <= longest, far, np.inf)
    assert np.isfinite(expected).sum() > begins.sum()
    assert (np.isfinite(leads) == np.isfinite(expected)).all()
    known = np.isfinite(leads)
    assert np.abs(leads[known] - expected[known]).max() < 1e-12
    later = np.flatnonzero(known & ~begins)
    assert leads[later] == pytest.approx(leads[origins[later]] + lengths[origins[later]], abs=1e-12)
