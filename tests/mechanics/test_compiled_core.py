"""The compiled core beside numba's kernels, which are its oracle: the same to 1e-10 in the plane and in space.

Loops that round as numba's do (`Kernel`) are the same to 1e-13, and those of whole numbers exactly.
"""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from builders import box_mesh, strip_mesh, strip_robot
from touching import fork_robot

from hydrostat import kernel
from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.surface import Solid, Surface
from hydrostat.geometry.tetrahedra.improve import ImproveStage, improve
from hydrostat.kernel import Kernel
from hydrostat.mechanics import Assembly, NeoHookean, PinEnergy, Warp, neo_hookean, supernodal, warp
from hydrostat.mechanics.factorisation import Analysis
from hydrostat.simulation import Simulation

pytestmark = pytest.mark.skipif(kernel.native is None, reason="installed without the compiled core")

MESHES = {"flat": strip_mesh(7, 3), "space": box_mesh((4, 2, 3))}


@pytest.fixture(params=MESHES, ids=str)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return MESHES[request.param]


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch) -> Callable:
    """What a function gives by the core and by numba."""

    def run(function: Callable) -> tuple:
        by_core = function()
        for room in (neo_hookean, warp, supernodal):
            monkeypatch.setattr(room, "native", None)
        by_numba = function()
        monkeypatch.undo()
        return by_core, by_numba

    return run


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


@pytest.mark.parametrize("size", [0.02, 0.2])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_energy_forces_and_hessian(mesh: Mesh, both: Callable, size: float, share: float) -> None:
    assembly, nodes, none = assembly_of(mesh), moved(mesh, size), np.zeros(0)
    for core, numba in zip(
        *both(
            lambda: (
                assembly.value(nodes, none),
                assembly.gradient(nodes, none),
                assembly.hessian(nodes, none, projection=share).data,
            )
        ),
        strict=True,
    ):
        assert np.isfinite(numba).all()
        assert_same(core, numba)


def test_an_inverted_element_has_no_energy(mesh: Mesh, both: Callable) -> None:
    nodes = mesh.nodes.copy()
    nodes[mesh.elements[0, 0]] += 10.0
    assert both(lambda: assembly_of(mesh).value(nodes, np.zeros(0))) == (np.inf, np.inf)


@pytest.mark.parametrize("size", [1e-4, 0.3, 20.0])
def test_steps_along_arcs(mesh: Mesh, both: Callable, size: float) -> None:
    """The largest step turns elements by more than one radian, where series give way to sine and cosine."""
    elastic = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=1.0)
    bend = Warp(
        stencils=elastic.stencils,
        shape_gradients=elastic.shape_gradients,
        volumes=elastic.volumes,
        rest=mesh.nodes,
        held=mesh.elements[:2],
        holds=np.full((2, mesh.dim + 1), 1 / (mesh.dim + 1)),
    )
    step = moved(mesh, size) - mesh.nodes
    assert_same(*both(lambda: bend(mesh.nodes, step)))


@pytest.mark.parametrize("shift", [0.05, -0.3])
@pytest.mark.parametrize("sides", [0, 1, 3, 8, 20])
def test_factors(mesh: Mesh, both: Callable, shift: float, sides: int) -> None:
    """Definite and indefinite, for a vector (0) and for several right-hand sides."""
    assembly = assembly_of(mesh)
    data = assembly.hessian(mesh.nodes, np.zeros(0)).data
    data[assembly.pattern.diagonal] += shift * np.median(data[assembly.pattern.diagonal])
    shape = (assembly.size, sides) if sides else (assembly.size,)
    right = np.random.default_rng(1).standard_normal(shape)

    def solved() -> tuple[int, np.ndarray]:
        factors = assembly.pattern.analysis.factorise(data)
        return factors.negative, factors.solve(right)

    core, numba = both(solved)
    assert core[0] == numba[0]
    assert (numba[0] > 0) == (shift < 0)
    assert np.abs(core[1] - numba[1]).max() <= 1e-9 * np.abs(numba[1]).max()


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
    monkeypatch.setattr(supernodal, "LARGE", 0.0)
    found = []
    for threads in (1, 2, 3, 5):
        monkeypatch.setattr(supernodal, "THREADS", threads)
        factors = assembly.pattern.analysis.factorise(data)
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
    monkeypatch.setattr(supernodal, "LARGE", 0.0)
    monkeypatch.setattr(supernodal, "THREADS", 3)
    assert assembly.pattern.analysis.factorise(matrix.data).singular


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


def kernels() -> dict[str, Kernel]:
    """Every `Kernel` of the package that is imported, by its name."""
    rooms = [module for name, module in sys.modules.items() if name.startswith("hydrostat.")]
    found = {id(item): item for room in rooms for item in vars(room).values() if isinstance(item, Kernel)}
    return {item.by_numba.__name__: item for item in found.values()}


@pytest.fixture
def twice(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """The names of the kernels called so far, each by the core and by numba on copies, with the same outcome."""
    called = set()

    def call(self: Kernel, *arguments: Any) -> Any:
        copies = [each.copy() if isinstance(each, np.ndarray) else each for each in arguments]
        assert self.by_core is not None, self.by_numba.__name__
        outcomes = self.by_core(*arguments), self.by_numba(*copies)
        lots = list(zip(arguments, copies, strict=True))
        if self.by_numba.__name__ == "_sweep_boundary":  # what stands behind the pairs that it tells is room to work in
            lots[-2:] = [(core[: outcomes[0][1]], numba[: outcomes[1][1]]) for core, numba in lots[-2:]]
        for core, numba in (outcomes, *lots):
            if isinstance(numba, np.ndarray) and numba.dtype.kind == "f":
                np.testing.assert_allclose(core, numba, rtol=1e-13, atol=1e-13 * np.abs(numba).max(initial=0.0))
            else:
                np.testing.assert_array_equal(core, numba)
        called.add(self.by_numba.__name__)
        return outcomes[0]

    monkeypatch.setattr(Kernel, "__call__", call)
    return called


@pytest.mark.slow
def test_kernels(twice: set[str]) -> None:
    """Flat and in space; more nodes than a part that is not cut, one row of numbers a node, and no places of nodes."""
    simulation = Simulation(strip_robot(columns=40, rows=6))
    pose = simulation.solve({winch.name: 0.01 for winch in simulation.robot.winches})
    simulation.cables.bends(pose.nodes, np.ones(len(pose.tensions)))
    box = box_mesh((6, 4, 4))
    assembly = assembly_of(box)
    data = assembly.hessian(box.nodes, np.zeros(0)).data
    pattern = assembly.pattern
    Analysis(pattern.indptr, pattern.indices, dim=3, points=None).factorise(data)
    NeoHookean(box.nodes, box.elements, mu=1.0, lame=1.0).least_volume(moved(box, 0.2))
    solid = Solid(Surface(box.nodes, box.boundary))
    stages = tuple(ImproveStage(rounds=2, sweeps=2, power=power, pull=10.0) for power in (1.0, 2.0, 3.0))
    touching = Simulation(fork_robot(3))
    touching.solve({"up": 0.002}, start=touching.solve({"up": 0.012, "down": 0.01}))
    improve(Mesh(moved(box, 0.1), box.elements), solid, element_size=0.02, stages=stages)
    assert twice == kernels().keys()


def test_what_the_core_cannot_fill_in_is_refused() -> None:
    """A copy of another type would be filled in and lost."""
    kernel_of_both = kernels()["_add_vectors"]
    stencils, vectors = np.zeros((1, 1), int), np.ones((1, 1, 2))
    total = np.zeros((1, 2))
    kernel_of_both(stencils.astype(np.int32), vectors, total)
    assert total.tolist() == [[1.0, 1.0]]
    with pytest.raises(TypeError):
        kernel_of_both(stencils, vectors, np.zeros((1, 2), np.float32))
    with pytest.raises(ValueError, match="a vector for each corner"):
        kernel_of_both(stencils, np.ones((2, 1, 2)), total)


@pytest.mark.parametrize("wrong", [-1, 5, 2**62, -(2**63)])
def test_what_is_no_node_is_refused(wrong: int) -> None:
    core, whole = kernel.native, np.array([[0, 4]])
    nodes, corners, data = np.zeros((5, 2)), np.array([[0, wrong]]), np.zeros(40)
    segment = np.ones((1, 2)), np.ones((1, 2)), np.ones(1)
    slots, strides, vectors, blocks = np.zeros((1, 2, 2), int), np.full(5, 4), np.ones((1, 2, 2)), np.ones((1, 4, 4))
    far, none = np.full((1, 2, 2), 36 if wrong > 0 else wrong), np.array([wrong])
    spans, lengths, first = np.ones((1, 2)), np.ones(1), np.zeros(1, int)
    calls = [
        lambda at: core.measure(nodes, at, *segment, spans, lengths),
        lambda at: core.lengths(nodes, at, *segment, first, np.zeros(5)),
        lambda at: core.add_bends(spans, lengths, np.ones((1, 2)), lengths, at, slots, strides, data),
        lambda at: core.spread(at, first, vectors, np.zeros((10, 5))),
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
        core.spread(whole, none, vectors, np.zeros((10, 5)))
    core.add_blocks(whole, np.full((1, 2, 2), 34), strides, blocks, data)  # the last block: 34, 35, 38 and 39
    with pytest.raises(ValueError, match="a block lies outside the matrix"):
        core.add_blocks(whole, far, strides, blocks, data)


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
        kernel.native.sweep_boundary(*tree, nodes, 0 * nodes, nodes, 0.1, 9.0, *pairs)

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
