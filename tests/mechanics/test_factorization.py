"""The factorization. Oracle: dense eigenvalues and dense solves; SuperLU, an independent program."""

import copy
import pickle
from functools import lru_cache

import numpy as np
import pytest
from scipy.sparse import block_diag, coo_array, csc_array, eye_array, kron
from scipy.spatial import Delaunay

from hydrostat.mechanics.factorization import Backend, Factorization, SymbolicFactorization, factorize
from hydrostat.mechanics.supernodal import SupernodalAnalysis

BACKENDS: tuple[Backend, ...] = ("supernodal", "superlu")


def factorized(matrix: csc_array, *, dim: int = 1, points: np.ndarray | None = None, backend: Backend) -> Factorization:
    """One factorization by an analysis of its own."""
    matrix = csc_array(matrix)
    matrix.sort_indices()
    return SymbolicFactorization(matrix.indptr, matrix.indices, dim=dim, points=points, backend=backend).factorize(
        matrix.data
    )


def body(nodes: int, dim: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Points at random and which of them share a simplex, (nodes, nodes) with ones."""
    points = np.random.default_rng(seed).random((nodes, dim)) * np.array([3.0, 1.0, 1.0])[:dim]
    simplices = Delaunay(points).simplices
    graph = np.zeros((nodes, nodes))
    for one in simplices.T:
        for two in simplices.T:
            graph[one, two] = 1
    return points, graph


@lru_cache(maxsize=4)  # cases of one matrix follow each other
def eigenvalues_of(dense: bytes, size: int) -> np.ndarray:
    """Eigenvalues of a symmetric matrix, given by its bytes."""
    return np.linalg.eigvalsh(np.frombuffer(dense).reshape(size, size))


@lru_cache(maxsize=4)
def solution_of(dense: bytes, size: int) -> np.ndarray:
    """Dense solve with five right-hand sides at random, those of `assert_right`."""
    return np.linalg.solve(np.frombuffer(dense).reshape(size, size), right_sides(size))


def right_sides(size: int) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((size, 5))


def elastic(graph: np.ndarray, dim: int, seed: int = 0) -> csc_array:
    """A symmetric matrix with a random block of `dim` for every pair of neighbors, far from definite."""
    random = np.random.default_rng(seed)
    size = len(graph) * dim
    values = random.standard_normal((size, size)) * np.kron(graph, np.ones((dim, dim)))
    return csc_array(values + values.T)


def shifted(matrix: csc_array, negative: int) -> csc_array:
    """The matrix plus a multiple of 1 such that it has so many negative eigenvalues."""
    values = eigenvalues_of(matrix.toarray().tobytes(), matrix.shape[0])
    if negative == 0:
        shift = values[0] - 0.05 * (values[-1] - values[0]) - 0.01
    else:
        shift = (values[negative - 1] + values[negative]) / 2
    return csc_array(matrix - shift * eye_array(matrix.shape[0]))


def assert_right(factor: Factorization, matrix: csc_array, accuracy: float) -> None:
    """Pivots count the eigenvalues below 0, and the solutions are those of a dense solve."""
    dense, size = matrix.toarray().tobytes(), matrix.shape[0]
    eigenvalues = eigenvalues_of(dense, size)
    assert not factor.singular
    assert factor.negative == int((eigenvalues < 0).sum())
    assert factor.definite == bool((eigenvalues > 0).all())
    right, exact = right_sides(size), solution_of(dense, size)
    allowed = accuracy * np.abs(exact).max()
    assert np.abs(factor.solve(right) - exact).max() < allowed
    assert np.abs(factor.solve(right[:, 0]) - exact[:, 0]).max() < allowed
    assert np.abs(factor.solve(right[:, :1]) - exact[:, :1]).max() < allowed


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("with_points", [True, False])
@pytest.mark.parametrize(("nodes", "dim"), [(5, 1), (60, 1), (30, 2), (150, 2), (25, 3), (200, 3)])
def test_definite_against_dense(nodes: int, dim: int, with_points: bool, backend: Backend) -> None:
    points, graph = body(nodes, max(dim, 2))
    matrix = shifted(elastic(graph, dim), 0)
    factor = factorized(matrix, dim=dim, points=points if with_points else None, backend=backend)
    assert_right(factor, matrix, 1e-10)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("negative", [1, 2, 10, 60])
@pytest.mark.parametrize(("nodes", "dim"), [(150, 1), (150, 2), (200, 3)])
def test_indefinite_against_dense(nodes: int, dim: int, negative: int, backend: Backend) -> None:
    points, graph = body(nodes, max(dim, 2), seed=negative)
    matrix = shifted(elastic(graph, dim, seed=negative), negative)
    # Without pivoting an indefinite matrix may cost digits.
    assert_right(factorized(matrix, dim=dim, points=points, backend=backend), matrix, 1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("seed", range(8))
def test_patterns_at_random_against_dense(seed: int, backend: Backend) -> None:
    """Without geometry, with several unconnected parts, some of them single."""
    random = np.random.default_rng(seed)
    parts = []
    for size in random.integers(1, 40, 5):
        values = np.where(random.random((size, size)) < 3 / size, random.standard_normal((size, size)), 0.0)
        parts.append(values + values.T + np.diag(random.standard_normal(size) + 0.1))
    matrix = shifted(csc_array(block_diag([coo_array(part) for part in parts])), int(seed % 3))
    assert_right(factorized(matrix, backend=backend), matrix, 1e-7)


@pytest.mark.parametrize("negative", [0, 3])
@pytest.mark.parametrize("size", [1, 2, 3, 5, 23, 24, 25, 48, 49, 181])
def test_a_dense_matrix(size: int, negative: int) -> None:
    """One front, of one block of columns or of several."""
    if size <= negative:
        return
    matrix = shifted(elastic(np.ones((size, size)), 1, seed=size), negative)
    assert_right(factorized(matrix, backend="supernodal"), matrix, 1e-9)


def test_a_single_node() -> None:
    matrix = csc_array(np.array([[4.0, 1.0, 0.0], [1.0, -3.0, 0.0], [0.0, 0.0, 2.0]]))
    assert_right(factorized(matrix, dim=3, points=np.zeros((1, 3)), backend="supernodal"), matrix, 1e-12)


def test_points_that_coincide() -> None:
    """Coordinates are only a hint: with useless ones it is slower, not wrong."""
    _, graph = body(150, 2)
    matrix = shifted(elastic(graph, 2), 0)
    assert_right(factorized(matrix, dim=2, points=np.zeros((150, 2)), backend="supernodal"), matrix, 1e-10)


def test_a_matrix_that_misses_entries_of_its_blocks() -> None:
    _, graph = body(80, 2)
    matrix = elastic(graph, 2).toarray()
    matrix[np.random.default_rng(0).random(matrix.shape) < 0.5] = 0.0
    matrix = shifted(csc_array(np.tril(matrix) + np.tril(matrix).T), 2)
    assert_right(factorized(matrix, dim=2, backend="supernodal"), matrix, 1e-7)


@pytest.mark.parametrize("negative", [0, 20])
def test_back_ends_agree(negative: int) -> None:
    """A body too large for a dense oracle; SuperLU is the independent program."""
    points, graph = body(900, 3)
    laplacian = np.diag(graph.sum(axis=1)) - graph
    block = 2 * np.eye(3) + 0.3
    matrix = csc_array(kron(csc_array(laplacian), block) + (0.1 if negative == 0 else -2.3) * eye_array(2700))
    ours, theirs = (factorized(matrix, dim=3, points=points, backend=backend) for backend in BACKENDS)
    assert ours.negative == theirs.negative
    assert (ours.negative == 0) == (negative == 0)
    right = np.random.default_rng(0).standard_normal((2700, 4))
    assert ours.solve(right) == pytest.approx(theirs.solve(right), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "dense",
    [
        np.zeros((3, 3)),
        np.diag([1.0, 0.0, 2.0]),
        np.diag([1.0, 1e-14, 2.0]),
        np.ones((2, 2)),
        np.ones((60, 60)),
        np.array([[0.0, 1.0], [1.0, 0.0]]),
    ],
)
def test_a_breakdown_is_called_singular(dense: np.ndarray, backend: Backend) -> None:
    """The last one is regular, but not without a row exchange, after which pivots do not say what eigenvalues do."""
    pattern = csc_array(np.ones_like(dense))
    analysis = SymbolicFactorization(pattern.indptr, pattern.indices, dim=1, backend=backend)
    factor = analysis.factorize(dense.T.ravel())
    assert factor.singular
    assert not factor.definite
    assert factorize(csc_array(dense)).singular


def test_a_free_body_is_singular() -> None:
    """A graph's Laplacian has the constant vector in its kernel."""
    points, graph = body(200, 3)
    matrix = csc_array(kron(csc_array(np.diag(graph.sum(axis=1)) - graph), np.eye(3)))
    assert factorized(matrix, dim=3, points=points, backend="supernodal").singular


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_none_are_singular(bad: float, backend: Backend) -> None:
    """Anywhere: on the diagonal, off it, everywhere. Then the analysis still serves."""
    points, graph = body(120, 3)
    matrix = shifted(elastic(graph, 3), 0)
    matrix.sort_indices()
    analysis = SymbolicFactorization(matrix.indptr, matrix.indices, dim=3, points=points, backend=backend)
    columns = np.repeat(np.arange(360), np.diff(matrix.indptr))
    for row, column in [(0, 0), (7, 7), (359, 359), *zip(matrix.indices[::500], columns[::500], strict=True)]:
        data = matrix.data.copy()
        data[((matrix.indices == row) & (columns == column)) | ((matrix.indices == column) & (columns == row))] = bad
        assert analysis.factorize(data).singular
    assert analysis.factorize(np.full(len(matrix.data), bad)).singular
    assert_right(analysis.factorize(matrix.data), matrix, 1e-10)


@pytest.mark.parametrize("negative", [0, 5])
def test_the_same_bits_twice(negative: int) -> None:
    """Whatever was factorized in between, and in an analysis of its own."""
    points, graph = body(200, 3)
    matrix = shifted(elastic(graph, 3), negative)
    matrix.sort_indices()
    right = np.random.default_rng(0).standard_normal((600, 3))
    analysis = SymbolicFactorization(matrix.indptr, matrix.indices, dim=3, points=points)
    first = analysis.factorize(matrix.data)
    early = first.solve(right), first.solve(right[:, 0])
    analysis.factorize(-2 * matrix.data)
    for other in (analysis, SymbolicFactorization(matrix.indptr, matrix.indices, dim=3, points=points)):
        again = other.factorize(matrix.data)
        for solved in (again, first):
            assert np.array_equal(solved.solve(right), early[0])
            assert np.array_equal(solved.solve(right[:, 0]), early[1])


def test_what_comes_in_is_left_alone() -> None:
    points, graph = body(60, 2)
    matrix = shifted(elastic(graph, 2), 0)
    matrix.sort_indices()
    right = np.ones((120, 2))
    data = matrix.data.copy()
    SymbolicFactorization(matrix.indptr, matrix.indices, dim=2, points=points).factorize(data).solve(right)
    assert np.array_equal(data, matrix.data)
    assert (right == 1).all()


def test_right_hand_sides_in_any_layout() -> None:
    """Columns of Fortran, rows with gaps, none at all. Oracle: the same numbers, contiguous."""
    _, graph = body(60, 2)
    matrix = shifted(elastic(graph, 2), 0)
    right = np.random.default_rng(0).standard_normal((120, 6))
    for backend in BACKENDS:
        factor = factorized(matrix, dim=2, backend=backend)
        every = factor.solve(right)
        assert factor.solve(np.asfortranarray(right)) == pytest.approx(every, rel=1e-12)
        assert factor.solve(right[:, ::2]) == pytest.approx(every[:, ::2], rel=1e-12)
        assert factor.solve(right[:, 1]) == pytest.approx(every[:, 1], rel=1e-10)
        assert factor.solve(right[:, :0]).shape == (120, 0)


def test_sizes_that_do_not_go_together() -> None:
    pattern = csc_array(np.eye(6))
    with pytest.raises(ValueError, match="4 a node"):
        SymbolicFactorization(pattern.indptr, pattern.indices, dim=4)
    with pytest.raises(ValueError, match="5 points"):
        SymbolicFactorization(pattern.indptr, pattern.indices, dim=1, points=np.zeros((5, 2)))


def test_one_off() -> None:
    _, graph = body(60, 2)
    matrix = shifted(elastic(graph, 2), 3)
    assert_right(factorize(matrix), matrix, 1e-7)
    assert_right(factorize(matrix), matrix, 1e-7)


def test_ordering_finds_the_separator_of_a_grid() -> None:
    """A grid of 40 x 8: George's dissection fills in far less than elimination row by row, 8 columns wide."""
    x, y = np.meshgrid(np.arange(40.0), np.arange(8.0), indexing="ij")
    index = np.arange(320).reshape(40, 8)
    pairs = np.concatenate(
        [np.stack([index[:-1].ravel(), index[1:].ravel()]), np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()])],
        axis=1,
    )
    graph = coo_array((np.ones(pairs.shape[1]), (pairs[0], pairs[1])), shape=(320, 320))
    matrix = csc_array(graph + graph.T + 5 * eye_array(320))
    assert_right(factorized(matrix, points=np.stack([x.ravel(), y.ravel()], 1), backend="supernodal"), matrix, 1e-10)


def test_factors_that_go_give_nothing_away_that_is_still_in_use() -> None:
    """Copies, and what other processes send, may share arrays with others. Oracle: the same solve before."""
    places, graph = body(80, 2)
    matrix = shifted(elastic(graph, 2), 0)
    matrix.sort_indices()
    analysis = SupernodalAnalysis(
        SymbolicFactorization(matrix.indptr, matrix.indices, dim=2, points=places).tree,
        matrix.indptr.astype(np.int32),
        matrix.indices.astype(np.int32),
        2,
    )
    factors, right = analysis.factorize(matrix.data, 1e-13), np.ones(160)
    before = factors.solve(right)
    for again in (copy.copy(factors), pickle.loads(pickle.dumps(factors))):
        assert (again.solve(right) == before).all()
    del again
    others = [analysis.factorize(share * matrix.data, 1e-13) for share in (2.0, 3.0, 4.0)]
    assert (factors.solve(right) == before).all()
    assert others[0].solve(right) == pytest.approx(before / 2)
