"""Quadratic elements. Oracles: central differences, `NeoHookean`, sums over points, a rotation, the linear mesh."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from states import CONTROLS, deform, rough_mesh

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import Assembly, NeoHookean, QuadraticSolid
from hydrostat.testing import ConformanceError, check_energy

MU, SOFT, NEARLY_INCOMPRESSIBLE = 11e3, 17e3, 300e3
NONE = np.zeros(CONTROLS)


def body(dim: int, seed: int, *, lame: float = SOFT, curved: float = 0.0) -> tuple[QuadraticSolid, np.ndarray]:
    """A rough body, its edges bent by so much of its width, and a strongly deformed state."""
    random = np.random.default_rng([seed, dim])
    while True:
        mesh = rough_mesh(dim, random).to_quadratic()
        rest = mesh.nodes + 0.05 * curved * random.uniform(-1, 1, mesh.nodes.shape)
        solid = QuadraticSolid(rest, mesh.quadratic, mu=MU, lame=lame, thickness=0.03 if dim == 2 else 1.0)
        nodes = deform(mesh, random)
        if solid.volumes.min() > 0 and solid.min_volume_ratio(nodes) > 0.15:
            return solid, nodes


@pytest.mark.parametrize("lame", [SOFT, NEARLY_INCOMPRESSIBLE])
@pytest.mark.parametrize("dim", [2, 3])
def test_energy_keeps_its_contract(dim: int, lame: float) -> None:
    """With lambda at the points alone, and with most of it for the mean volume; straight edges and bent ones."""
    for seed, curved in enumerate((0.0, 0.03)):
        solid, nodes = body(dim, seed, lame=lame, curved=curved)
        check_energy(solid, nodes, NONE, seed=seed)


def test_the_contract_can_be_broken() -> None:
    """The check can fail: a Hessian 1 % too large."""

    class Stiffer(QuadraticSolid):
        def projected_hessian(self, nodes, controls, share):
            return super().projected_hessian(nodes, controls, share) * 1.01

    solid, nodes = body(2, 0)
    with pytest.raises(ConformanceError, match="hessian"):
        check_energy(Stiffer(solid._rest, solid.stencils, mu=MU, lame=SOFT), nodes, NONE)


@pytest.mark.parametrize("lame", [SOFT, NEARLY_INCOMPRESSIBLE])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_homogeneous_deformation_is_exact(dim: int, lame: float) -> None:
    """Patch test. Oracle: energy of the linear elements; no force on an inner node."""
    mesh = rough_mesh(dim, np.random.default_rng(dim)).to_quadratic()
    F = np.eye(dim) + 0.2 * np.random.default_rng(3).standard_normal((dim, dim))
    nodes, solid = mesh.nodes @ F.T, QuadraticSolid(mesh.nodes, mesh.quadratic, mu=MU, lame=lame)
    linear = NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=lame)
    assert solid.value(nodes, NONE) == pytest.approx(linear.value(nodes, NONE), rel=1e-12)
    forces = Assembly([solid], rest=mesh.nodes, control_count=0).gradient(nodes, NONE).reshape(nodes.shape)
    inner = np.setdiff1d(np.arange(len(nodes)), mesh.boundary_nodes)
    assert len(inner)
    assert np.abs(forces[inner]).max() < 1e-12 * np.abs(forces).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_turning_and_shifting_changes_nothing(dim: int) -> None:
    """Oracle: the forces, turned along."""
    solid, nodes = body(dim, 1, lame=NEARLY_INCOMPRESSIBLE)
    turn = np.linalg.qr(np.random.default_rng(0).standard_normal((dim, dim)))[0]
    turn[0] *= np.linalg.det(turn)
    moved = nodes @ turn.T + 0.3
    assert solid.value(moved, NONE) == pytest.approx(solid.value(nodes, NONE), rel=1e-12)
    forces = solid.gradient(nodes, NONE)
    assert np.abs(solid.gradient(moved, NONE) - forces @ turn.T).max() < 1e-10 * np.abs(forces).max()


@pytest.mark.parametrize("lame", [SOFT, NEARLY_INCOMPRESSIBLE])
def test_work_by_moduli(lame: float) -> None:
    """Oracle: differences of the work of the forces by mu and lambda of one material of two."""
    solid, nodes = body(2, 2, lame=lame)
    field = np.random.default_rng(0).standard_normal(nodes.shape)
    materials = np.arange(len(solid.stencils)) % 2

    def work(mu: float, squeeze: float) -> float:
        numbers = {"mu": np.where(materials, mu, MU), "lame": np.where(materials, squeeze, lame)}
        other = QuadraticSolid(solid._rest, solid.stencils, thickness=0.03, **numbers)
        return float((other.gradient(nodes, NONE) * field[solid.stencils]).sum())

    given = {"mu": MU, "lame": lame, "thickness": 0.03, "materials": materials}
    works = QuadraticSolid(solid._rest, solid.stencils, **given).parameter_derivative(nodes, field)
    assert works["mu"][1] == pytest.approx((work(MU + 10, lame) - work(MU - 10, lame)) / 20, rel=1e-8)
    assert works["lame"][1] == pytest.approx((work(MU, lame + 10) - work(MU, lame - 10)) / 20, rel=1e-8)
    assert works["thickness"][0] == pytest.approx(work(MU, lame), rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_rest_shape_that_crept(dim: int) -> None:
    """Oracle: c (tr(F A F^T) - dim - ln det(F A F^T)) / 2, by point."""
    solid, nodes = body(dim, 3)
    random = np.random.default_rng(0)
    turns = np.linalg.qr(random.standard_normal((len(solid.volumes), dim, dim)))[0]
    metrics = (turns * random.uniform(0.5, 1.8, (len(turns), 1, dim))) @ turns.swapaxes(1, 2)
    crept = solid.with_metrics(metrics, 700.0)
    F = solid.deformation_gradients(nodes)
    turned = F @ metrics @ F.swapaxes(1, 2)
    excess = np.trace(turned, axis1=1, axis2=2) - dim - np.log(np.linalg.det(turned))
    assert crept.value(nodes, NONE) == pytest.approx(350.0 * float(solid.volumes @ excess), rel=1e-10)
    check_energy(crept, nodes, NONE)


def test_an_inverted_element_has_no_energy() -> None:
    solid, nodes = body(3, 4)
    flat = nodes * [1.0, 1.0, -1.0]
    assert solid.value(flat, NONE) == np.inf
    assert solid.min_volume_ratio(flat) < 0


@pytest.mark.parametrize("mesh", [strip_mesh(5, 3), box_mesh((3, 2, 2))], ids=["plane", "space"])
def test_a_linear_mesh_becomes_quadratic_and_back(mesh: Mesh) -> None:
    """Oracle: as many parts of equal size as there should be, one node an edge, the same border."""
    found = mesh.to_quadratic()
    assert found.quadratic is not None
    parts = 2**mesh.dim
    np.testing.assert_allclose(found.volumes.reshape(-1, parts), np.repeat(mesh.volumes[:, None] / parts, parts, 1))
    assert len(found.nodes) == len(mesh.nodes) + len(mesh.edges)
    assert len(found.boundary) == 2 ** (mesh.dim - 1) * len(mesh.boundary)
    for quadratic, own in zip(found.quadratic, found.elements.reshape(len(mesh.elements), -1), strict=True):
        assert set(own) == set(quadratic)
    again = found.to_linear()
    assert (again.nodes == mesh.nodes).all()
    assert (again.elements == mesh.elements).all()
    assert mesh.to_linear() is mesh
    with pytest.raises(InputError, match="quadratic element must be"):
        Mesh(found.nodes, found.elements[1:], found.quadratic)
