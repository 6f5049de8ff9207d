"""Cables during a step. Oracles: scipy.optimize on the same convex function, complementarity, measured lengths."""

import numpy as np
import pytest
from builders import strip_mesh
from scipy.optimize import minimize

from hydrostat.mechanics import Assembly, CableEnergy, NeoHookean, PinEnergy, TensionLaw
from hydrostat.mechanics.tighten import Tightener, settle


def problem(seed: int, cables: int) -> tuple[TensionLaw, np.ndarray, np.ndarray]:
    """Cables of which about half would be slack, on a body that couples them."""
    random = np.random.default_rng([seed, cables])
    law = TensionLaw(stiffness=10 ** random.uniform(2, 5, cables), smoothing=10 ** random.uniform(-4, -2.5, cables))
    half = random.standard_normal((cables, cables))
    compliance = 10 ** random.uniform(-5, -3) * half @ half.T
    return law, random.uniform(-0.03, 0.03, cables), compliance


@pytest.mark.parametrize("cables", [1, 2, 5, 12])
@pytest.mark.parametrize("seed", range(6))
def test_tensions_settle_where_scipy_says(seed: int, cables: int) -> None:
    """The least of T C T / 2 + U(s - C T), by BFGS with the gradient C (T - U'), in units in which C is 1."""
    law, stretches, compliance = problem(seed, cables)
    root = np.linalg.cholesky(compliance)

    def cost(z: np.ndarray) -> tuple[float, np.ndarray]:
        remaining = stretches - root @ z
        value = 0.5 * z @ z + law.energy(remaining).sum()
        return 1e3 * float(value), 1e3 * (z - root.T @ law.tension(remaining))

    expected = minimize(cost, np.zeros(cables), jac=True, method="BFGS", options={"gtol": 1e-11, "maxiter": 5000})
    found = settle(law, stretches, compliance)
    assert found is not None
    reached = root.T @ found
    assert cost(reached)[0] <= expected.fun + 1e-9 * abs(expected.fun) + 1e-15
    scale = max(np.abs(expected.x).max(), 1e-9)
    assert reached == pytest.approx(expected.x, abs=1e-5 * scale)


@pytest.mark.parametrize("cables", [1, 3, 12])
@pytest.mark.parametrize("seed", range(6))
def test_each_cable_keeps_its_law_and_none_pushes(seed: int, cables: int) -> None:
    """Complementarity: T >= 0, T = 0 where what is left of the stretch is negative, T = law(s - C T) everywhere."""
    law, stretches, compliance = problem(seed, cables)
    tensions = settle(law, stretches, compliance)
    assert tensions is not None
    remaining = stretches - compliance @ tensions
    largest = tensions.max(initial=0.0)
    assert tensions.min() >= -1e-12 * largest
    assert np.abs(tensions[remaining < 0]).max(initial=0.0) <= 1e-11 * largest
    assert tensions == pytest.approx(law.tension(remaining), abs=1e-10 * max(largest, 1e-12))


def test_a_linear_law_would_let_a_cable_push() -> None:
    """The check can fail, and why `settle` is there: two cables of which one goes slack when the other pulls."""
    law = TensionLaw(stiffness=np.array([1e4, 1e4]), smoothing=np.array([1e-4, 1e-4]))
    compliance = 1e-3 * np.array([[1.0, 0.9], [0.9, 1.0]])
    stretches = np.array([0.02, 0.005])
    linear = np.linalg.solve(np.eye(2) / 1e4 + compliance, stretches - 1e-4)
    found = settle(law, stretches, compliance)
    assert found is not None
    assert linear[1] < -1.0
    assert found[1] == 0.0
    assert found[0] == pytest.approx((0.02 - 1e-4) / (1e-3 + 1e-4), rel=1e-9)


def test_slack_cables_stay_slack() -> None:
    law, _, compliance = problem(0, 4)
    found = settle(law, np.full(4, -0.01), compliance)
    assert found is not None
    assert not found.any()


MESH = strip_mesh(12, 4)


def strip(stiffness: float = 4e4, held: bool = True) -> Assembly:
    """A strip with a stiff cable above its middle and one below; held at its left end or, loosely, by one node."""
    pins = np.flatnonzero(MESH.nodes[:, 0] == 0.0)
    rows = [np.flatnonzero(np.abs(MESH.nodes[:, 1] - y) < 1e-9) for y in (0.0125, -0.0125)]
    pairs = np.concatenate([np.column_stack([row[:-1], row[1:]]) for row in rows])
    cables = CableEnergy(
        MESH.nodes,
        stencils=pairs,
        weights=np.tile([-1.0, 1.0], (len(pairs), 1)),
        offsets=np.zeros((len(pairs), 2)),
        cables=np.repeat([0, 1], [len(row) - 1 for row in rows]),
        law=TensionLaw(stiffness=np.full(2, stiffness), smoothing=np.full(2, 1e-4)),
        winches=np.array([0, 1]),
        slack=np.zeros(2),
    )
    pin = PinEnergy(
        stencils=pins[:, None],
        weights=np.ones((len(pins), 1)),
        targets=MESH.nodes[pins],
        stiffness=np.full(len(pins), 2.5e4 if held else 1e-3),
    )
    body = NeoHookean(MESH.nodes, MESH.elements, mu=11e3, lame=17e3, thickness=0.03)
    return Assembly([body, pin, cables], rest=MESH.nodes, control_count=2)


def step(assembly: Assembly, controls: np.ndarray) -> tuple[CableEnergy, np.ndarray, np.ndarray, Tightener]:
    """Where Newton's first step from rest leads, and the tensions that it promises."""
    cables = assembly.energies[2]
    assert isinstance(cables, CableEnergy)
    stiffness = assembly.stiffness(MESH.nodes, controls)
    stretches = cables.stretches(MESH.nodes, controls)
    moved = -stiffness.solve(assembly.gradient(MESH.nodes, controls))
    promised = cables.law.tension(stretches + stiffness.columns.T @ moved)
    return cables, MESH.nodes + moved.reshape(MESH.nodes.shape), promised, Tightener(cables, controls, stiffness)


@pytest.mark.parametrize("controls", [[0.02, 0.0], [0.02, 0.008], [0.04, 0.001], [0.015, 0.015]])
def test_tensions_come_nearer_to_what_was_promised(controls: list[float]) -> None:
    """And so the energy falls. Oracles: lengths measured afresh, the energy of the whole robot.

    The step is bent sideways, which the cables feel to second order: at their stiffness by many times what they pull.
    """
    given, assembly = np.array(controls), strip()
    cables, nodes, promised, tighten = step(assembly, given)
    nodes = nodes + np.column_stack([np.zeros(len(nodes)), 0.02 * (MESH.nodes[:, 0] / 0.2) ** 2])
    tightened = tighten(nodes, promised)
    before, after = (np.abs(cables.tensions(at, given) - promised).max() for at in (nodes, tightened))
    assert before > 0.3 * promised.max()
    assert after < 0.1 * before
    assert assembly.value(tightened, given) < assembly.value(nodes, given)


def test_nothing_promised_and_nothing_taut_moves_nothing() -> None:
    _, _, _, tighten = step(strip(), np.array([0.01, 0.0]))
    assert (tighten(MESH.nodes * 0.8, np.zeros(2)) == MESH.nodes * 0.8).all()


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("held", [True, False])
def test_it_ends_with_numbers_whatever_it_is_given(seed: int, held: bool) -> None:
    """Wild positions and promises, cables up to 1e8 N/m, a body held by hardly anything."""
    random = np.random.default_rng(seed)
    assembly = strip(10 ** random.uniform(1, 8), held)
    _, nodes, promised, tighten = step(assembly, random.uniform(0, 0.1, 2))
    wild = nodes + 10 ** random.uniform(-4, 1) * random.standard_normal(nodes.shape)
    for at, tension in ((nodes, promised), (wild, promised), (wild, 10 ** random.uniform(-6, 6, 2))):
        assert np.isfinite(tighten(at, tension)).all()
