"""No quadratic element inverts. Oracles: central differences; J at random points; a force that no solid withstands."""

from itertools import combinations

import numpy as np
import pytest
from builders import gallery_robot
from states import CONTROLS, rough_mesh

from hydrostat.mechanics import InversionBarrier
from hydrostat.mechanics.inversion_barrier import BARRIER_START
from hydrostat.mechanics.quadratic_solid import shape_gradients
from hydrostat.simulation import Simulation
from hydrostat.testing import check_energy

NONE = np.zeros(CONTROLS)


def barrier(dim: int, seed: int, *, moduli: tuple[float, float] = (11e3, 7e3)) -> tuple[InversionBarrier, np.ndarray]:
    """Elements of two materials, and a state in which it pushes some of them but inverts none."""
    random = np.random.default_rng([seed, dim])
    while True:
        mesh = rough_mesh(dim, random).to_quadratic()
        assert mesh.quadratic is not None
        materials = np.arange(len(mesh.quadratic)) % 2
        volumes = mesh.volumes.reshape(len(materials), -1).sum(axis=1)
        found = InversionBarrier(
            mesh.nodes, mesh.quadratic, mu=np.array(moduli)[materials], volumes=volumes, materials=materials
        )
        nodes = mesh.nodes * random.uniform(0.6, 1.2, dim) + 0.003 * random.uniform(-1, 1, mesh.nodes.shape)
        if 0.03 < found.min_volume_ratio(nodes) < 0.15:
            return found, nodes


@pytest.mark.parametrize("dim", [2, 3])
def test_energy_keeps_its_contract(dim: int) -> None:
    energy, nodes = barrier(dim, 0)
    check_energy(energy, nodes, NONE, coordinates=30)


@pytest.mark.parametrize("dim", [2, 3])
def test_no_point_has_less_volume_than_the_least_coefficient(dim: int) -> None:
    """Oracle: J at random points. At corners, which are among the coefficients, it is the least in some element."""
    random, tight = np.random.default_rng(dim), 0
    for seed in range(5):
        energy, nodes = barrier(dim, seed)
        points = np.concatenate([np.eye(dim + 1), random.dirichlet(np.full(dim + 1, 0.5), 200)])
        slopes = shape_gradients(points)
        spans = [np.einsum("ecd,qcr->eqdr", each[energy.stencils], slopes) for each in (nodes, energy.rest)]
        ratios = np.linalg.det(spans[0]) / np.linalg.det(spans[1])
        least = energy.min_volume_ratio(nodes)
        assert ratios.min() > least - 1e-12
        tight += ratios.min() < least + 1e-12
    assert tight


def test_bodies_that_are_bent_as_usual_keep_their_poses() -> None:
    """Oracle: no energy and no force where no ratio is below `BARRIER_START`."""
    energy, nodes = barrier(2, 0)
    rest = energy.rest
    mild = rest + 0.25 * (nodes - rest)
    assert BARRIER_START < energy.min_volume_ratio(mild) < 0.9
    assert energy.value(mild, NONE) == 0.0
    assert not energy.gradient(mild, NONE).any()


@pytest.mark.parametrize("dim", [2, 3])
def test_an_inverted_corner_has_no_energy(dim: int) -> None:
    """A middle of an edge moved onto its end inverts a corner alone: J at the points of quadrature stays above 0."""
    energy, _ = barrier(dim, 0)
    nodes, first = energy.rest.copy(), energy.stencils[0]
    for place, (one, two) in enumerate(combinations(range(dim + 1), 2), start=dim + 1):
        if one == 0:
            nodes[first[place]] = 0.8 * energy.rest[first[0]] + 0.2 * energy.rest[first[two]]
    assert energy.min_volume_ratio(nodes) < 0
    assert energy.value(nodes, NONE) == np.inf


def test_work_by_moduli() -> None:
    """Oracle: differences of the work of the forces by mu of one material of two."""
    energy, nodes = barrier(2, 1)
    field = np.random.default_rng(0).standard_normal(nodes.shape)

    def work(mu: float) -> float:
        other, _ = barrier(2, 1, moduli=(11e3, mu))
        return float((other.gradient(nodes, NONE) * field[energy.stencils]).sum())

    works = energy.parameter_derivative(nodes, field)
    assert works["mu"][1] == pytest.approx((work(7010) - work(6990)) / 20, rel=1e-8)
    assert works["thickness"][0] == pytest.approx(work(7e3), rel=1e-12)


def test_a_pose_that_the_barrier_holds_open_is_warned_of() -> None:
    """Full extension squeezes a corner of the finger to less than 30 %. Oracle: the energy of the barrier itself."""
    simulation = Simulation(gallery_robot("finger"))
    barrier = next(energy for energy in simulation.assembly.energies if isinstance(energy, InversionBarrier))
    for contraction, is_pushed in ((0.004, False), (0.014, True)):
        pose = simulation.solve({"extend": contraction})
        assert (barrier.value(pose.nodes, pose.controls) > 0) is is_pushed
        assert any("kept from inverting" in line for line in pose.warnings) is is_pushed
