"""Volume in patches: the contract of an energy, closed forms, and how the patches lie."""

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from states import CONTROLS, deform, rough_mesh

from hydrostat.geometry import Mesh
from hydrostat.mechanics import Assembly, NeoHookean
from hydrostat.mechanics.patch_dilatation import PATCH_SIZE, PatchDilatation, grow_patches
from hydrostat.testing import ConformanceError, check_energy

LAME, MU = 17e3, 11e3
NONE = np.zeros(CONTROLS)


def meshes(dim: int) -> list[Mesh]:
    """A regular one, larger, and a rough one, small."""
    regular = strip_mesh(12, 5) if dim == 2 else box_mesh((5, 3, 4))
    return [regular, rough_mesh(dim, np.random.default_rng(dim))]


def in_patches(mesh: Mesh, *, lame: float = LAME, thickness: float = 1.0) -> PatchDilatation:
    patches = grow_patches(mesh.elements, PATCH_SIZE[mesh.dim])
    return PatchDilatation(mesh.nodes, mesh.elements, patches, lame=lame, thickness=thickness)


def squeezed(mesh: Mesh, factor: float) -> np.ndarray:
    """A rough state whose patches have about `factor` times their volume."""
    nodes = deform(mesh, np.random.default_rng(1))
    changes = in_patches(mesh).changes(nodes)
    return nodes * (factor / (1 + changes.mean())) ** (1 / mesh.dim)


@pytest.mark.parametrize("factor", [0.3, 0.9, 1.2, 4.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_energy_keeps_its_contract(dim: int, factor: float) -> None:
    """Oracle: central differences, under pressure, under tension, and where (ln J)^2 is no longer convex, J > e."""
    mesh = rough_mesh(dim, np.random.default_rng(dim))
    check_energy(in_patches(mesh, thickness=0.03 if dim == 2 else 1.0), squeezed(mesh, factor), NONE)


def test_the_contract_can_be_broken() -> None:
    """The check can fail: a Hessian 1 % too large."""

    class Stiffer(PatchDilatation):
        def projected_hessian(self, nodes, controls, share):
            return super().projected_hessian(nodes, controls, share) * 1.01

    mesh = rough_mesh(2, np.random.default_rng(2))
    patches = grow_patches(mesh.elements, 4)
    with pytest.raises(ConformanceError, match="hessian"):
        check_energy(Stiffer(mesh.nodes, mesh.elements, patches, lame=LAME), squeezed(mesh, 1.2), NONE)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_homogeneous_deformation_is_exact(dim: int) -> None:
    """Oracle: V lambda/2 (ln det F)^2; with the rest of the material the forces of `NeoHookean` alone."""
    random = np.random.default_rng(3)
    F = np.eye(dim) + 0.2 * random.standard_normal((dim, dim))
    for mesh in meshes(dim):
        nodes = mesh.nodes @ F.T + 0.1
        patch, volume = in_patches(mesh), float(mesh.volumes.sum())
        assert patch.value(nodes, NONE) == pytest.approx(volume * LAME / 2 * np.log(np.linalg.det(F)) ** 2, rel=1e-12)
        parts = [NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=0.0), patch]
        split = Assembly(parts, rest=mesh.nodes, control_count=0)
        whole = Assembly([NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME)], rest=mesh.nodes, control_count=0)
        forces = whole.gradient(nodes, NONE)
        assert np.abs(split.gradient(nodes, NONE) - forces).max() < 1e-12 * np.abs(forces).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_patch_of_one_element_is_the_element(dim: int) -> None:
    """Oracle: `NeoHookean`, which takes the volume of each element by itself; value, gradient and Hessian."""
    mesh = rough_mesh(dim, np.random.default_rng(5))
    nodes = deform(mesh, np.random.default_rng(6))
    single = PatchDilatation(mesh.nodes, mesh.elements, np.arange(len(mesh.elements)), lame=LAME, thickness=0.03)
    split = [NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=0.0, thickness=0.03), single]
    whole = [NeoHookean(mesh.nodes, mesh.elements, mu=MU, lame=LAME, thickness=0.03)]
    one, two = (Assembly(parts, rest=mesh.nodes, control_count=0) for parts in (split, whole))
    assert one.value(nodes, NONE) == pytest.approx(two.value(nodes, NONE), rel=1e-12)
    gradient, hessian = two.gradient(nodes, NONE), two.hessian(nodes, NONE).toarray()
    assert np.abs(one.gradient(nodes, NONE) - gradient).max() < 1e-12 * np.abs(gradient).max()
    assert np.abs(one.hessian(nodes, NONE).toarray() - hessian).max() < 1e-12 * np.abs(hessian).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_little_is_lost_near_rest(dim: int) -> None:
    """Oracle: V lambda/2 ln^2(1 + e)^dim of a growth of e = 1e-9, where det F - 1 by itself would keep 7 digits."""
    mesh = Mesh(meshes(dim)[0].nodes + 0.3, meshes(dim)[0].elements)
    nodes = mesh.nodes + 1e-9 * (mesh.nodes - mesh.nodes[0])
    exact = float(mesh.volumes.sum()) * LAME / 2 * (dim * np.log1p(1e-9)) ** 2
    assert in_patches(mesh).value(nodes, NONE) == pytest.approx(exact, rel=1e-6)


def test_an_inverted_patch_has_no_energy() -> None:
    """Oracle: J < 0 of a mirror image."""
    mesh = meshes(2)[0]
    assert in_patches(mesh).value(mesh.nodes * [-1.0, 1.0], NONE) == np.inf


@pytest.mark.parametrize("dim", [2, 3])
def test_every_patch_is_connected_and_about_full(dim: int) -> None:
    """Oracle: counts, and a walk across faces inside each patch; twice the same patches."""
    size = PATCH_SIZE[dim]
    for mesh in meshes(dim):
        patches = grow_patches(mesh.elements, size)
        counts = np.bincount(patches)
        assert len(patches) == len(mesh.elements)
        assert counts.min() >= size / 2
        assert counts.max() < 2 * size
        assert abs(counts.mean() / size - 1) < 0.1
        assert np.array_equal(patches, grow_patches(mesh.elements, size))
        for patch in range(len(counts)):
            assert _connected(mesh.elements[patches == patch])


def _connected(elements: np.ndarray) -> bool:
    """Whether one can walk from any of these elements to all across faces."""
    reached = {0}
    for _ in elements:
        reached |= {
            other
            for other in range(len(elements))
            if any(len(np.intersect1d(elements[other], elements[one])) == elements.shape[1] - 1 for one in reached)
        }
    return len(reached) == len(elements)
