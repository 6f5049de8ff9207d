"""Newton's method. Oracles: its own promises (reasons, J > 0, never NaN) and the order of its convergence."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import strip_mesh

from hydrostat.mechanics import (
    Assembly,
    CableEnergy,
    CableSegments,
    NeoHookean,
    NewtonOptions,
    NewtonResult,
    NewtonStatus,
    PinEnergy,
    RoundOff,
    TensionLaw,
    minimize,
)

MESH = strip_mesh(12, 3)
OPTIONS = NewtonOptions()
ROUND_OFF = RoundOff(force=1e-13, energy=1e-16)


class Uphill(PinEnergy):
    """Its gradient points the wrong way: no step that Newton takes lowers the energy."""

    def gradient(self, nodes, controls):
        return -super().gradient(nodes, controls)


class NotANumber(PinEnergy):
    """Its Hessian is NaN."""

    def hessian(self, nodes, controls):
        return np.full_like(super().hessian(nodes, controls), np.nan)


def strip(pin: type[PinEnergy] = PinEnergy) -> Assembly:
    """A strip held at its left end, with one cable along its upper half."""
    held = np.flatnonzero(MESH.nodes[:, 0] == 0.0)
    upper = np.flatnonzero(np.abs(MESH.nodes[:, 1] - MESH.nodes[:, 1].max()) < 1e-9)
    return Assembly(
        [
            NeoHookean(MESH.nodes, MESH.elements, mu=11e3, lame=17e3, thickness=0.03),
            pin(
                stencils=held[:, None],
                weights=np.ones((len(held), 1)),
                targets=MESH.nodes[held],
                stiffness=np.full(len(held), 2.5e4),
            ),
            CableEnergy(
                MESH.nodes,
                CableSegments(
                    stencils=np.column_stack([upper[:-1], upper[1:]]),
                    weights=np.tile([-1.0, 1.0], (len(upper) - 1, 1)),
                    offsets=np.zeros((len(upper) - 1, 2)),
                    cables=np.zeros(len(upper) - 1, dtype=np.int64),
                ),
                law=TensionLaw(stiffness=np.array([4e3]), smoothing=np.array([0.5e-3])),
                winches=np.array([0]),
                slack=np.zeros(1),
            ),
        ],
        rest=MESH.nodes,
        control_count=1,
    )


def dense(assembly: Assembly, nodes: np.ndarray, controls: np.ndarray) -> np.ndarray:
    """The whole Hessian, part of low rank included."""
    springs = assembly.low_rank_hessian(nodes, controls)
    columns, weights = springs.columns, springs.weights
    return assembly.hessian(nodes, controls).toarray() + columns @ weights @ columns.T


def solve(
    contraction: float, *, assembly: Assembly | None = None, start: np.ndarray | None = None, **options: float
) -> NewtonResult:
    assembly = assembly or strip()
    controls = np.array([contraction])
    cable = assembly.energies[2]
    assert isinstance(cable, CableEnergy)
    return minimize(
        assembly,
        MESH.nodes if start is None else start,
        controls,
        round_off=ROUND_OFF,
        options=replace(OPTIONS, **options),
    )


def test_it_converges_to_a_minimum_and_says_so() -> None:
    result = solve(0.03)
    assembly, controls = strip(), np.array([0.03])
    assert result.status is NewtonStatus.CONVERGED
    assert result.converged
    assert result.stable
    assert np.linalg.eigvalsh(dense(assembly, result.nodes, controls))[0] > 0
    assert result.residual == np.abs(assembly.gradient(result.nodes, controls)).max()
    assert result.residual <= result.allowed
    assert result.energy == assembly.value(result.nodes, controls)


def test_at_rest_there_is_nothing_to_do() -> None:
    result = solve(0.0)
    assert result.converged
    assert result.iterations == 0
    assert (result.nodes == MESH.nodes).all()


def test_one_step_squares_a_small_error() -> None:
    """Quadratic convergence: from starts off the end by d, d/2, d/4 one step leaves errors as d^2 (or smaller)."""
    end = solve(0.03, tolerance=1e-13)
    x = MESH.nodes[:, :1] / MESH.nodes[:, 0].max()
    bend = np.hstack([np.sin(2 * x), x**2 - 0.3 * x]) * MESH.nodes[:, 0].max()
    offs = 5e-4 * 0.5 ** np.arange(4)
    errors = [np.abs(solve(0.03, start=end.nodes + d * bend, iterations=1).nodes - end.nodes).max() for d in offs]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[0] < 0.5 * offs[0] * np.abs(bend).max()
    assert (orders > 1.7).all()
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


def test_the_last_steps_are_few() -> None:
    """Oracle: residuals after 0, 1, 2 ... steps; under a thousandth of the tension each step gains a digit or more."""
    cable, end = strip().energies[2], solve(0.03)
    assert isinstance(cable, CableEnergy)
    tension = float(cable.tensions(end.nodes, np.array([0.03]))[0])
    fractions = [solve(0.03, iterations=steps).residual / tension for steps in range(end.iterations + 1)]
    last = [(a, b) for a, b in pairwise(fractions) if a < 1e-3]
    assert last
    assert all(after < 0.2 * before for before, after in last)


def test_what_is_no_minimum_is_not_called_stable() -> None:
    """Oracle: dense eigenvalues of the strip, crushed to 60 % of its length along and swollen across."""
    start = MESH.nodes * [0.6, 1.1]
    result = solve(0.0, start=start, iterations=0)
    assert np.linalg.eigvalsh(dense(strip(), start, np.zeros(1)))[0] < 0
    assert not result.stable
    assert not solve(0.03, start=MESH.nodes * [1, -1]).stable


def test_a_node_that_nothing_holds_stays_and_the_rest_arrives() -> None:
    """The Hessian is singular, however much of it is lifted: only a shift of its diagonal can be solved with.

    Closed form: the pins carry the strip along as it is; the loose node feels no force.
    """
    nodes, shift = np.vstack([MESH.nodes, [[0.3, 0.3]]]), np.array([0.01, 0.02])
    pins = PinEnergy(
        stencils=np.arange(4)[:, None],
        weights=np.ones((4, 1)),
        targets=MESH.nodes[:4] + shift,
        stiffness=np.full(4, 10.0),
    )
    body = NeoHookean(nodes, MESH.elements, mu=11e3, lame=17e3, thickness=0.03)
    result = minimize(
        Assembly([body, pins], rest=nodes, control_count=0),
        nodes,
        np.zeros(0),
        round_off=ROUND_OFF,
        options=OPTIONS,
    )
    assert result.converged
    assert not result.stable
    assert result.nodes[:-1] == pytest.approx(MESH.nodes + shift, abs=1e-8)
    assert result.nodes[-1] == pytest.approx(nodes[-1], abs=1e-12)


@pytest.mark.parametrize("iterations", [0, 1, 3])
def test_the_iteration_limit_is_kept_and_named(iterations: int) -> None:
    result = solve(0.03, iterations=iterations)
    assert result.status is NewtonStatus.ITERATION_LIMIT
    assert result.iterations == iterations
    assert np.isfinite(result.nodes).all()


def test_an_inverted_start_is_named() -> None:
    result = solve(0.03, start=MESH.nodes * [1, -1])
    assert result.status is NewtonStatus.BAD_START
    assert (result.nodes == MESH.nodes * [1, -1]).all()


def test_no_descent_is_named_not_hidden() -> None:
    """A gradient that lies: Newton stops where it is and says that no step helps."""
    assembly = strip(Uphill)
    result = solve(0.03, assembly=assembly, start=MESH.nodes + np.array([0.01, 0.0]))
    assert result.status in (NewtonStatus.NO_DESCENT, NewtonStatus.ITERATION_LIMIT)
    assert not result.converged
    assert np.isfinite(result.nodes).all()
    assert solve(0.03, halvings=0).status is NewtonStatus.NO_DESCENT


def test_a_hessian_that_is_not_a_number_ends_without_one() -> None:
    result = solve(0.03, assembly=strip(NotANumber))
    assert result.status is NewtonStatus.NO_DESCENT
    assert np.isfinite(result.nodes).all()


@pytest.mark.parametrize("seed", range(10))
def test_from_a_wild_start_it_ends_with_numbers_and_no_inverted_element(seed: int) -> None:
    """Starts shaken by up to 40 % of an element, contractions up to 60 % of the strip."""
    random = np.random.default_rng(seed)
    start = MESH.nodes + 0.4 * 0.0166 * random.uniform(-0.5, 0.5, MESH.nodes.shape)
    result = solve(random.uniform(0.0, 0.12), start=start)
    corners = result.nodes[MESH.elements]
    assert np.isfinite(result.nodes).all()
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
    assert np.isfinite([result.energy, result.residual, result.allowed]).all()
    assert result.converged


@pytest.mark.parametrize("contraction", [0.05, 0.1, 0.2])
def test_no_step_leaves_less_than_a_fifth_of_the_element_squeezed_most(contraction: float) -> None:
    """Oracle: det F of all elements, after each iteration."""
    body, least = strip().energies[0], 1.0
    assert isinstance(body, NeoHookean)
    for steps in range(1, 12):
        nodes = solve(contraction, iterations=steps).nodes
        before, least = least, float(np.linalg.det(body.deformation_gradients(nodes)).min())
        assert least > 0.199 * before


def test_a_first_step_that_would_crush_an_element_is_refused_at_no_cost() -> None:
    """A contraction of two thirds of the strip: cut short the step is taken, whole it is not."""
    refused, cut = (solve(0.2, whole=whole, iterations=1) for whole in (True, False))
    assert refused.status is NewtonStatus.NO_DESCENT
    assert refused.iterations == 0
    assert refused.stiffness is None
    assert (refused.nodes == MESH.nodes).all()
    assert cut.iterations == 1


def test_it_converges_to_a_ten_billionth_of_the_largest_force() -> None:
    """Oracle: the largest force that is applied, of the assembly itself; round-off is far below it here."""
    result = solve(0.03)
    scale = strip().largest_force(result.nodes, np.array([0.03]))
    assert result.allowed == pytest.approx(1e-10 * scale, rel=1e-6)
    assert result.residual <= result.allowed
