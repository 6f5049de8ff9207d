"""Cables that rub. Oracles: differences, the conditions of least energy, cables without friction, the capstan."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from states import SIZE, State, deform, rough_mesh

from hydrostat.geometry import locate
from hydrostat.mechanics import CableEnergy, CableSegments, FrictionCableEnergy, TensionLaw, ViaPointTurns
from hydrostat.mechanics.tension_law import ChainLaw
from hydrostat.testing import central_differences, check_energy

LAW = TensionLaw(stiffness=np.array([4e3, 2e3]), smoothing=np.array([0.5e-3, 0.2e-3]))
MU = np.array([0.3, 0.0])
RATIOS = np.array([1.7, 0.6])
POINTS = 5


def chains(random: np.random.Generator, *, limit: float = 3.0) -> ChainLaw:
    """Two cables, of four and of three spans."""
    starts = np.array([0, 4, 7])
    limits = random.uniform(0, limit, 7)
    limits[starts[:-1]] = 0.0
    return ChainLaw(
        stiffness=random.uniform(1e4, 4e4, 7),
        smoothing=random.uniform(2e-5, 2e-4, 7),
        starts=starts,
        limits=limits,
    )


def random_elongations(random: np.random.Generator) -> np.ndarray:
    return random.uniform(-1e-3, 3e-3, 7)


@pytest.mark.parametrize("seed", range(20))
def test_slips_have_the_least_energy(seed: int) -> None:
    """Oracle: the conditions of Karush, Kuhn and Tucker, which suffice as the energy is convex."""
    random = np.random.default_rng(seed)
    law, elongation = chains(random, limit=3.0 * (seed % 4 > 0)), random_elongations(random)
    slips, tensions = law.slips(elongation), law.tension(elongation)
    own = elongation + slips - np.append(slips[1:], 0.0)
    springs = TensionLaw(stiffness=law.stiffness, smoothing=law.smoothing)
    assert np.abs(tensions - springs.tension(own)).max() < 1e-12
    assert (slips[law.starts[:-1]] == 0).all()
    drops = -np.diff(tensions)
    inner = np.setdiff1d(np.arange(1, 7), law.starts)
    moving = inner[slips[inner] != 0]
    assert (np.abs(drops[inner - 1]) <= law.limits[inner] + 1e-9).all()
    assert drops[moving - 1] == pytest.approx(np.sign(slips[moving]) * law.limits[moving], abs=1e-9)
    assert tensions.min() >= 0


@pytest.mark.parametrize("seed", range(20))
def test_tension_is_the_slope_of_the_energy_and_tangents_of_the_tension(seed: int) -> None:
    random = np.random.default_rng(seed)
    law, elongation = chains(random), random_elongations(random)
    every = np.arange(7)
    slopes = central_differences(lambda s: np.array([law.energy(s).sum()]), elongation, every, 1e-7)[0]
    assert slopes == pytest.approx(law.tension(elongation), abs=1e-5)
    tangents = law.tangents(elongation)
    assert (
        np.abs(central_differences(law.tension, elongation, every, 1e-9) - tangents).max() < 1e-4 * law.stiffness.max()
    )
    assert np.abs(tangents - tangents.T).max() == 0
    assert np.linalg.eigvalsh(tangents)[0] > -1e-9


@pytest.mark.parametrize("seed", range(10))
def test_locked_chains_answer_limits_and_elongations(seed: int) -> None:
    random = np.random.default_rng(seed)
    law, elongation = chains(random), random_elongations(random)
    by_elongation, by_limit = law.compute_slip_jacobians(law.tension(elongation), np.sign(law.slips(elongation)))
    assert by_elongation == pytest.approx(law.tangents(elongation), abs=1e-6 * law.stiffness.max())
    rubbing = np.flatnonzero(law.limits > 0)
    found = central_differences(
        lambda limits: replace(law, limits=limits).tension(elongation), law.limits, rubbing, 1e-7
    )
    assert found == pytest.approx(by_limit[:, rubbing], abs=1e-6)


@dataclass(frozen=True)
class Rubbing(State):
    """A state of cables with friction."""

    energy: FrictionCableEnergy


def rubbing(
    dim: int, random: np.random.Generator, *, elongation: float, slipping: bool, world: bool = False
) -> Rubbing:
    """A cable with friction and one without, both equally elongated; the first with a sheath in the middle."""
    mesh = rough_mesh(dim, random)
    stencils, weights, offsets = [], [], []
    for _ in range(2):
        anchors = locate(mesh, random.uniform(0.1, 0.9, (POINTS, dim)) * SIZE[dim])
        own, shift = anchors.weights.copy(), np.zeros((POINTS, dim))
        if world:
            own[0], shift[0] = 0.0, -0.03
        stencils.append(np.concatenate([anchors.stencils[:-1], anchors.stencils[1:]], axis=1))
        weights.append(np.concatenate([-own[:-1], own[1:]], axis=1))
        offsets.append(np.diff(shift, axis=0))
    parts = dict(zip(("stencils", "weights", "offsets"), (stencils, weights, offsets), strict=True))
    bare, before, after = [0, 1, 3], [0, 1, 2], [1, 2, 3]
    energy = FrictionCableEnergy(
        mesh.nodes,
        segments=CableSegments(
            **{name: np.concatenate([rough[bare], smooth]) for name, (rough, smooth) in parts.items()},
            cables=np.repeat([0, 1], [3, 4]),
        ),
        law=LAW,
        winches=np.array([1, 0]),
        slack=np.array([0.002, 0.001]),
        friction=MU,
        ratios=RATIOS,
        turns=ViaPointTurns(
            **{name: np.stack([rough[before], rough[after]]) for name, (rough, _) in parts.items()},
            points=np.array([1, 2, 2]),
        ),
    )
    nodes, controls = deform(mesh, random), random.uniform(0, 0.02, 3)
    elongations = energy.elongations(nodes, controls)
    controls[[1, 0]] += (elongation - np.array([elongations[:3].sum(), elongations[3]])) / RATIOS
    limits = np.append(0.0, random.uniform(0.1, 0.3, 2)) * (1.0 if slipping else 1e5)
    return Rubbing(energy.with_limits(np.append(limits, 0.0)), nodes, controls)


KINDS = {
    "slipping": {"elongation": 0.02, "slipping": True},
    "sticking": {"elongation": 0.02, "slipping": False},
    "slack": {"elongation": -0.01, "slipping": True},
    "barely taut": {"elongation": 2e-4, "slipping": True},
    "from the world": {"elongation": 0.02, "slipping": True, "world": True},
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_energy_keeps_its_contract(kind: str, dim: int, seed: int) -> None:
    """Oracle: central differences, in `check_energy`."""
    state = rubbing(dim, np.random.default_rng([seed, dim]), **KINDS[kind])
    check_energy(state.energy, state.nodes, state.controls, seed=seed)


@pytest.mark.parametrize("kind", ["slipping", "sticking"])
def test_states_slip_and_stick_as_they_are_called(kind: str) -> None:
    """The names of the states above are true."""
    state = rubbing(2, np.random.default_rng([0, 2]), **KINDS[kind])
    slips = state.energy.law.slips(state.energy.elongations(state.nodes, state.controls))
    assert (slips != 0).tolist() == [False, kind == "slipping", kind == "slipping", False]


@pytest.mark.parametrize("dim", [2, 3])
def test_without_limits_it_is_a_cable_without_friction(dim: int) -> None:
    """Oracle: `CableEnergy`, its energy, forces and the whole Hessian."""
    state = rubbing(dim, np.random.default_rng(dim), elongation=0.02, slipping=True)
    energy, nodes, controls = state.energy.with_limits(np.zeros(4)), state.nodes, state.controls
    spans = energy._spans
    plain = CableEnergy(
        rough_mesh(dim, np.random.default_rng(dim)).nodes,
        segments=CableSegments(
            stencils=energy.stencils, weights=spans.weights, offsets=spans.offsets, cables=np.repeat([0, 1], [3, 4])
        ),
        law=LAW,
        winches=np.array([1, 0]),
        slack=np.array([0.002, 0.001]),
        ratios=RATIOS,
    )
    assert energy.tensions(nodes, controls) == pytest.approx(plain.tensions(nodes, controls), rel=1e-12)
    assert energy.value(nodes, controls) == pytest.approx(plain.value(nodes, controls), rel=1e-12)
    for part in ("gradient", "hessian", "control_gradient"):
        ours, theirs = getattr(energy, part)(nodes, controls), getattr(plain, part)(nodes, controls)
        assert np.abs(ours - theirs).max() < 1e-11 * np.abs(theirs).max()
    one, other = energy.low_rank_hessian(nodes, controls), plain.low_rank_hessian(nodes, controls)
    assert one.law is not None
    assert other.law is not None
    for further in (-0.02, -1e-4, 1e-4, 0.02):
        found, known = (part.law.tension(part.elongations + further) for part in (one, other))
        assert found == pytest.approx(known, rel=1e-6, abs=1e-9)
    ours, small, theirs, diagonal = one.columns, one.weights, other.columns, other.weights
    whole = theirs @ diagonal @ theirs.T
    assert np.abs(ours @ small @ ours.T - whole).max() < 1e-11 * np.abs(whole).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_angles_and_their_gradients(dim: int) -> None:
    """Oracles: the arc cosine of the directions; central differences."""
    state = rubbing(dim, np.random.default_rng(dim), elongation=0.02, slipping=True)
    turns, nodes = state.energy._turns, state.nodes
    spans = np.einsum("stc,stcd->std", turns.weights, nodes[turns.stencils]) + turns.offsets
    units = spans / np.linalg.norm(spans, axis=2, keepdims=True)
    assert turns.angles(nodes) == pytest.approx(np.arccos(np.einsum("td,td->t", *units)), abs=1e-9)

    def sums(point: np.ndarray) -> np.ndarray:
        return state.energy.angles(point.reshape(nodes.shape))

    found = central_differences(sums, nodes.ravel(), np.arange(nodes.size), 1e-7)
    expected = turns.gradients(nodes, 4).T
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


SEGMENTS = 8
TURN = 2 * np.pi / 3


def arc() -> tuple[FrictionCableEnergy, np.ndarray]:
    """A cable round an arc that does not give way, each via point a node; it turns by the same angle at each."""
    angles = np.linspace(0, TURN * SEGMENTS / (SEGMENTS - 1), SEGMENTS + 1)
    nodes = 0.05 * np.column_stack([np.cos(angles), np.sin(angles)])
    stencils = np.column_stack([np.arange(SEGMENTS), np.arange(1, SEGMENTS + 1)])
    weights = np.tile([-1.0, 1.0], (SEGMENTS, 1))
    offsets = np.zeros((SEGMENTS, 2))
    pairs = [np.stack([part[:-1], part[1:]]) for part in (stencils, weights, offsets)]
    energy = FrictionCableEnergy(
        nodes,
        segments=CableSegments(
            stencils=stencils, weights=weights, offsets=offsets, cables=np.zeros(SEGMENTS, dtype=np.int64)
        ),
        law=TensionLaw(stiffness=np.array([4e3]), smoothing=np.array([0.1e-3])),
        winches=np.array([0]),
        slack=np.zeros(1),
        friction=np.array([0.25]),
        turns=ViaPointTurns(stencils=pairs[0], weights=pairs[1], offsets=pairs[2], points=np.arange(1, SEGMENTS)),
    )
    return energy, nodes


def pull(energy: FrictionCableEnergy, nodes: np.ndarray, contraction: float) -> tuple[FrictionCableEnergy, np.ndarray]:
    """The cable after it was taken in to `contraction`, its capstan law brought about by repetition, and tensions."""
    controls = np.array([contraction])
    for _ in range(300):
        limits = energy.capstan_limits(nodes, controls)
        if np.abs(limits - energy.law.limits).max() < 1e-13:
            break
        energy = energy.with_limits(limits)
    else:
        raise AssertionError("the limits do not settle")
    return energy.with_advanced_history(nodes, controls), energy.span_tensions(nodes, controls)


def test_capstan_while_a_cable_is_taken_in_and_let_out() -> None:
    """Oracle: T = T0 exp(-mu angle) along the arc while it is taken in, exp(mu angle) at last while it is let out.

    In between the far end keeps its tension, until that of the winch has fallen below it by exp(mu angle). And the
    winch's tension itself, by the sum of the elongations of the segments at those tensions. The springs follow
    the straight part of their law, so the smoothing has no share in any error.
    """
    (energy, nodes), tensions = arc(), np.zeros(SEGMENTS)
    decay = np.exp(-0.25 * TURN * np.arange(SEGMENTS) / (SEGMENTS - 1))
    for contraction in np.linspace(0, 0.004, 9)[1:]:
        energy, tensions = pull(energy, nodes, contraction)
        if contraction > 1e-3:
            assert tensions / tensions[0] == pytest.approx(decay, rel=1e-10)
            assert tensions[0] == pytest.approx(4e3 * (contraction - 0.1e-3) / decay.mean(), rel=1e-10)
    end = tensions[-1]
    ends, winches = [], []
    for contraction in np.linspace(0.004, 0.0005, 36)[1:]:
        energy, tensions = pull(energy, nodes, contraction)
        assert (tensions[1:] / tensions[:-1] <= np.exp(0.25 * TURN / (SEGMENTS - 1)) * (1 + 1e-9)).all()
        assert (tensions[1:] / tensions[:-1] >= np.exp(-0.25 * TURN / (SEGMENTS - 1)) * (1 - 1e-9)).all()
        ends.append(tensions[-1])
        winches.append(tensions[0])
    sticks = np.isclose(ends, end, rtol=1e-12)
    assert (sticks == (np.array(winches) > end * np.exp(-0.25 * TURN))).all(), "the far end feels nothing until then"
    assert 0 < sticks.sum() < len(sticks)
    assert (np.diff(winches) < 0).all()
    assert tensions[-1] / tensions[0] == pytest.approx(np.exp(0.25 * TURN), rel=1e-10)


def test_a_cable_that_rests_at_its_limits_stays() -> None:
    """A state that is resumed from its slips alone has the tensions it had."""
    energy, nodes = arc()
    energy, tensions = pull(energy, nodes, 0.004)
    fresh = arc()[0].with_history(energy.slips, nodes, np.array([0.004]))
    assert fresh.span_tensions(nodes, np.array([0.004])) == pytest.approx(tensions, rel=1e-9)
    assert fresh.law.limits == pytest.approx(energy.law.limits, rel=1e-9)
