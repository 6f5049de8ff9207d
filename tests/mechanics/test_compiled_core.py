"""The compiled core. Oracles: dense linear algebra, eigenvalues by LAPACK, the matrix exponential, one thread."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from scipy.linalg import expm

from hydrostat import kernel
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.kernel import native
from hydrostat.mechanics import Assembly, NeoHookean, PinEnergy, supernodal
from hydrostat.mechanics.energy import element_groups

MESHES = {"flat": strip_mesh(7, 3), "space": box_mesh((4, 2, 3))}


@pytest.fixture(params=MESHES, ids=str)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return MESHES[request.param]


def moved(mesh: Mesh, size: float) -> np.ndarray:
    """Nodes moved at random by a share of an edge."""
    edge = np.ptp(mesh.nodes, axis=0).min() / 4
    return mesh.nodes + size * edge * np.random.default_rng(0).uniform(-1, 1, mesh.nodes.shape)


def assembly_of(mesh: Mesh) -> Assembly:
    elastic = NeoHookean(mesh.nodes, mesh.elements, mu=3e4, lame=1e5)
    held = np.arange(4)[:, None]
    pins = PinEnergy(stencils=held, weights=np.ones((4, 1)), targets=mesh.nodes[:4], stiffness=np.full(4, 1e4))
    return Assembly([elastic, pins], rest=mesh.nodes, control_count=0)


def assert_same(one: np.ndarray | float, other: np.ndarray | float) -> None:
    assert np.abs(np.asarray(one) - other).max() <= 1e-10 * np.abs(other).max()


MU, LAME = 3e4, 1e5


def elastic_reference(mesh: Mesh, nodes: np.ndarray, share: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Energy, forces and Hessian by the formulas of Psi, element by element; what is negative is found by LAPACK."""
    dim, size = mesh.dim, nodes.size
    energy, forces, hessian = 0.0, np.zeros(size), np.zeros((size, size))
    rest = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(np.swapaxes(rest[:, 1:] - rest[:, :1], 1, 2))
    for element, inner, volume in zip(mesh.elements, inverse, mesh.volumes, strict=True):
        slopes = np.vstack([-inner.sum(axis=0), inner])
        F = nodes[element].T @ slopes
        T, log_j = np.linalg.inv(F).T, np.log(np.linalg.det(F))
        energy += volume * (MU / 2 * (np.sum(F**2) - dim) - MU * log_j + LAME / 2 * log_j**2)
        stress = MU * (F - T) + LAME * log_j * T
        crossed = (MU - LAME * log_j) * np.einsum("il,kj->ijkl", T, T)
        tangent = MU * np.eye(dim**2) + (LAME * np.einsum("ij,kl->ijkl", T, T) + crossed).reshape(dim**2, dim**2)
        values, axes = np.linalg.eigh(tangent)
        tangent -= share * (axes * np.minimum(values, 0.0)) @ axes.T
        spread = np.einsum("aj,ik->ijak", slopes, np.eye(dim)).reshape(dim**2, -1)
        dofs = (dim * element[:, None] + np.arange(dim)).ravel()
        forces[dofs] += volume * spread.T @ stress.ravel()
        hessian[np.ix_(dofs, dofs)] += volume * spread.T @ tangent @ spread
    return energy, forces, hessian


@pytest.mark.parametrize("size", [0.02, 0.2])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_energy_forces_and_hessian(mesh: Mesh, size: float, share: float) -> None:
    nodes, none = moved(mesh, size), np.zeros(0)
    assembly = Assembly([NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME)], rest=mesh.nodes, control_count=0)
    energy, forces, hessian = elastic_reference(mesh, nodes, share)
    assert_same(assembly.value(nodes, none), energy)
    assert_same(assembly.gradient(nodes, none), forces)
    assert_same(assembly.hessian(nodes, none, projection=share).toarray(), hessian)


def test_blocks_of_elements_add_up_to_the_sums(mesh: Mesh) -> None:
    """Oracle: the sums, which other loops make."""
    energy, nodes, none = NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME), moved(mesh, 0.2), np.zeros(0)
    assembly = Assembly([energy], rest=mesh.nodes, control_count=0)
    forces = np.zeros_like(nodes)
    np.add.at(forces, mesh.elements, energy.gradient(nodes, none))
    assert_same(forces.ravel(), assembly.gradient(nodes, none))
    dofs = (mesh.dim * mesh.elements[:, :, None] + np.arange(mesh.dim)).reshape(len(mesh.elements), -1)
    hessian = np.zeros((nodes.size, nodes.size))
    np.add.at(hessian, (dofs[:, :, None], dofs[:, None, :]), energy.projected_hessian(nodes, none, 0.3))
    assert_same(hessian, assembly.hessian(nodes, none, projection=0.3).toarray())


def test_an_inverted_element_has_no_energy(mesh: Mesh) -> None:
    nodes = mesh.nodes.copy()
    nodes[mesh.elements[0, 0]] += 10.0
    assert assembly_of(mesh).value(nodes, np.zeros(0)) == np.inf


@pytest.mark.parametrize("size", [1e-4, 0.3, 20.0])
def test_steps_along_arcs(mesh: Mesh, size: float) -> None:
    """Oracle: the matrix exponential. The largest step turns elements by more than one radian."""
    energy = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=1.0)
    nodes, step = moved(mesh, 0.2), moved(mesh, size) - mesh.nodes
    found, right = np.zeros_like(nodes), np.zeros_like(nodes)
    groups = element_groups(energy.stencils, energy.shape_gradients, energy.volumes)
    native.turn(nodes, step, *groups, found)
    for element, slopes, volume in zip(mesh.elements, energy.shape_gradients, energy.volumes, strict=True):
        F = nodes[element].T @ slopes
        A = step[element].T @ slopes @ np.linalg.inv(F)
        S, W = (A + A.T) / 2, (A - A.T) / 2
        beyond = _exponential_beyond(W)
        bent = beyond + (W + beyond) @ S
        np.add.at(right, element, volume * slopes @ (bent @ F).T)
    assert_same(found, right)


def _exponential_beyond(W: np.ndarray) -> np.ndarray:
    """exp W - I - W: by its series where that is short, else by SciPy."""
    if np.abs(W).max() > 1.0:
        return expm(W) - np.eye(len(W)) - W
    term, total = W, np.zeros_like(W)
    for power in range(2, 30):
        term = term @ W / power
        total = total + term
    return total


@pytest.mark.parametrize("shift", [0.05, -0.3])
@pytest.mark.parametrize("sides", [0, 1, 3, 8, 11, 20])
def test_factors(mesh: Mesh, shift: float, sides: int) -> None:
    """Oracle: LAPACK. Definite and indefinite, for a vector (0) and for several right-hand sides."""
    assembly = assembly_of(mesh)
    matrix = assembly.hessian(mesh.nodes, np.zeros(0))
    matrix.data[assembly.pattern.diagonal] += shift * np.median(matrix.data[assembly.pattern.diagonal])
    shape = (assembly.size, sides) if sides else (assembly.size,)
    right = np.random.default_rng(1).standard_normal(shape)
    factors = assembly.pattern.analysis.factorize(matrix.data)
    assert factors.negative == int((np.linalg.eigvalsh(matrix.toarray()) < 0).sum())
    assert (factors.negative > 0) == (shift < 0)
    exact = np.linalg.solve(matrix.toarray(), right)
    assert np.abs(factors.solve(right) - exact).max() <= 1e-9 * np.abs(exact).max()


def test_right_hand_sides_of_few_places(mesh: Mesh) -> None:
    """Oracle: LAPACK. Fronts whose numbers are all 0 are left out."""
    assembly = assembly_of(mesh)
    matrix = assembly.hessian(mesh.nodes, np.zeros(0))
    matrix.data[assembly.pattern.diagonal] *= 1.05
    factors = assembly.pattern.analysis.factorize(matrix.data)
    for dof in range(0, assembly.size, 7):
        right = np.zeros((assembly.size, 5))
        right[dof] = np.arange(5.0)
        exact = np.linalg.solve(matrix.toarray(), right)
        assert np.abs(factors.solve(right) - exact).max() <= 1e-9 * np.abs(exact).max()


LARGER = {"flat": strip_mesh(60, 12), "space": box_mesh((14, 8, 8))}
"""Bodies with fronts of more columns than are eliminated together, and subtrees below them."""


@pytest.mark.parametrize("name", LARGER)
@pytest.mark.parametrize("shift", [0.05, -0.3])
def test_threads_make_the_same_bytes(name: str, shift: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: one thread, which goes through other loops. Definite and indefinite."""
    mesh = LARGER[name]
    assembly = assembly_of(mesh)
    data = assembly.hessian(mesh.nodes, np.zeros(0)).data
    data[assembly.pattern.diagonal] += shift * np.median(data[assembly.pattern.diagonal])
    right = np.random.default_rng(1).standard_normal((assembly.size, 3))
    monkeypatch.setattr(supernodal, "THREADED_SECONDS", 0.0)
    found = []
    for threads in (1, 2, 3, 5):
        monkeypatch.setattr(supernodal, "THREADS", threads)
        factors = assembly.pattern.analysis.factorize(data)
        found.append((factors.negative, factors.singular, factors.solve(right).tobytes()))
    assert (found[0][0] > 0) == (shift < 0)
    assert not found[0][1]
    assert all(other == found[0] for other in found[1:])


@pytest.mark.parametrize("wrong", [np.nan, 0.0])
@pytest.mark.parametrize("place", [0.0, 0.5, 0.999])
def test_threads_end_together_at_a_singular_matrix(wrong: float, place: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A row of zeros, or a diagonal that is no number, wherever it stands."""
    mesh = LARGER["space"]
    assembly = assembly_of(mesh)
    matrix = assembly.hessian(mesh.nodes, np.zeros(0))
    dof = int(place * assembly.size)
    matrix.data[assembly.pattern.diagonal[dof]] = wrong
    if wrong == 0.0:
        matrix.data[matrix.indptr[dof] : matrix.indptr[dof + 1]] = 0.0
        matrix.data[matrix.indices == dof] = 0.0
    monkeypatch.setattr(supernodal, "THREADED_SECONDS", 0.0)
    monkeypatch.setattr(supernodal, "THREADS", 3)
    assert assembly.pattern.analysis.factorize(matrix.data).singular


@pytest.mark.parametrize("given", ["0", "two", "-1", "1.5"])
def test_threads_are_asked_for_by_a_whole_number(given: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYDROSTAT_THREADS", given)
    with pytest.raises(InputError, match="HYDROSTAT_THREADS must be a whole number"):
        kernel._threads()


def test_threads_that_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYDROSTAT_THREADS", "3")
    assert kernel._threads() == 3
    monkeypatch.delenv("HYDROSTAT_THREADS")
    assert kernel._threads() >= 1


def test_what_the_core_cannot_fill_in_is_refused() -> None:
    """A copy of another type would be filled in and lost."""
    stencils, vectors = np.zeros((1, 1), int), np.ones((1, 1, 2))
    total = np.zeros((1, 2))
    native.add_vectors(stencils.astype(np.int32), vectors, total)
    assert total.tolist() == [[1.0, 1.0]]
    with pytest.raises(TypeError):
        native.add_vectors(stencils, vectors, np.zeros((1, 2), np.float32))
    with pytest.raises(ValueError, match="a vector for each corner"):
        native.add_vectors(stencils, np.ones((2, 1, 2)), total)


@pytest.mark.parametrize("wrong", [-1, 5, 2**62, -(2**63)])
def test_what_is_no_node_is_refused(wrong: int) -> None:
    core, whole = native, np.array([[0, 4]])
    nodes, corners, data = np.zeros((5, 2)), np.array([[0, wrong]]), np.zeros(40)
    segment = np.ones((1, 2)), np.ones((1, 2)), np.ones(1)
    slots, strides, vectors, blocks = np.zeros((1, 2, 2), int), np.full(5, 4), np.ones((1, 2, 2)), np.ones((1, 4, 4))
    far, none = np.full((1, 2, 2), 36 if wrong > 0 else wrong), np.array([wrong])
    spans, lengths, first = np.ones((1, 2)), np.ones(1), np.zeros(1, int)
    calls = [
        lambda at: core.measure(nodes, at, *segment, spans, lengths),
        lambda at: core.lengths(nodes, at, *segment, first, np.zeros(5)),
        lambda at: core.add_bends(spans, lengths, np.ones((1, 2)), lengths, at, slots, strides, data),
        lambda at: core.add_slopes(nodes, at, *segment, first, lengths, np.zeros((5, 2, 1))),
        lambda at: core.add_vectors(at, vectors, np.zeros((5, 2))),
        lambda at: core.add_blocks(at, slots, strides, blocks, data),
    ]
    for call in calls:
        call(whole)
        with pytest.raises(ValueError, match="a corner is no node"):
            call(corners)
    with pytest.raises(ValueError, match="a corner is no node"):
        core.least_volume(nodes, np.array([[0, 1, wrong]]), np.ones((1, 3, 3)), (0, 1))
    with pytest.raises(ValueError, match="a segment of no cable"):
        core.lengths(nodes, whole, *segment, none, np.zeros(5))
    with pytest.raises(ValueError, match="a segment of no cable"):
        core.add_slopes(nodes, whole, *segment, none, lengths, np.zeros((5, 2, 5)))
    core.add_blocks(whole, np.full((1, 2, 2), 34), strides, blocks, data)  # the last block: 34, 35, 38 and 39
    with pytest.raises(ValueError, match="a block lies outside the matrix"):
        core.add_blocks(whole, far, strides, blocks, data)


@pytest.mark.parametrize("wrong", [-1, 10**12])
def test_what_reaches_beyond_a_list_is_refused(wrong: int) -> None:
    """Meshes that are improved, and labels that are walked back."""
    box, none = box_mesh((1, 1, 1)), np.zeros(0, int)
    lists = np.zeros(len(box.nodes) + 1, int), np.zeros(box.elements.size, int)
    facets = np.zeros((0, 3), int), np.zeros(len(box.nodes) + 1, int), none, np.zeros((0, 3, 3)), np.zeros((0, 3))
    given = np.zeros((3, 3)), 1.0, 1.0
    native.sweep(box.nodes.copy(), box.elements, *lists, *facets, *given)
    elements, star = box.elements.copy(), lists[1].copy()
    elements[0, 0] = star[0] = wrong
    with pytest.raises(ValueError, match="a corner is no node"):
        native.sweep(box.nodes.copy(), elements, *lists, *facets, *given)
    with pytest.raises(ValueError, match="no such corner"):
        native.sweep(box.nodes.copy(), box.elements, lists[0], star, *facets, *given)
    ends, parents, paths = np.zeros(2, int), np.full((2, 2), -1), np.zeros((1, 3), int)
    native.walk_back(parents, ends, ends, 1, np.array([1]), np.array([0]), paths)
    parents[1, 0] = wrong - 1
    with pytest.raises(ValueError, match="no such label"):
        native.walk_back(parents, ends, ends, 1, np.array([1]), np.array([0]), paths)


def test_a_surface_seen_edge_on_covers_nothing() -> None:
    points, corners = np.zeros((1, 3)), np.array([[[-1.0, 0, 0], [1, 0, 0], [0, 0, 5]]])
    above, below = np.ones(1, bool), np.ones(1, bool)
    native.find_covered(points, corners, above, below)
    assert not above.any()
    assert not below.any()


def test_a_tree_that_does_not_fit_its_facets_is_refused() -> None:
    """Two triangles, each a leaf; then two leaves of one, an edge with one end, children before parents."""
    nodes = np.random.default_rng(0).normal(size=(6, 3))
    children, facets = np.array([[1, 2], [-1, 0], [-1, 1]]), np.arange(6).reshape(2, 3)
    edges, front = np.full((2, 6), -1), np.array([[1, 2]])
    beside, kinds = np.array([[0, 3, 4, 5]]), np.zeros(1, np.bool_)
    pairs = np.empty((9, 4), int), np.empty(9, np.bool_)

    def call(
        children: np.ndarray,
        facets: np.ndarray,
        edges: np.ndarray,
        front: np.ndarray = front,
        beside: np.ndarray = beside,
    ) -> None:
        tree = children, facets, facets, edges, front, beside, kinds
        native.sweep_boundary(*tree, nodes, 0 * nodes, nodes, 0.1, 9.0, *pairs)

    call(children, facets, edges)
    call(np.array([[1, 2], [-1, 0], [-1, 0]]), facets, edges)  # it finds nothing wrong, and nothing outside
    broken = [
        (children, facets, np.where(np.arange(6) == 1, 2, edges), "an edge with one end"),
        (children, facets, np.full((2, 6), 6), "an edge has no nodes"),
        (children, facets + 1, edges, "no such node|no node"),
        (np.array([[1, 2], [-1, 0], [-1, 2]]), facets, edges, "children come after their parents"),
        (np.array([[1, 0], [-1, 0], [-1, 1]]), facets, edges, "children come after their parents"),
        (children, facets, edges, front + 1, "no such box"),
        (children, facets, edges, front, beside + 1, "a corner is no node"),
    ]
    for *given, told in broken:
        with pytest.raises(ValueError, match=told):
            call(*given)
