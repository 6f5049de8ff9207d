"""The conformance suite can fail: every kind of slip is found, by its name. Oracle: energies broken on purpose."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest
from states import LAW, cables, deform, element_fibres, neo_hookean, pins, rough_mesh, weight

from hydrostat.mechanics import CableEnergy, CableSegments, DeadLoadEnergy, FibreEnergy, NeoHookean, PinEnergy
from hydrostat.mechanics.energy import Energy, LowRankStiffness
from hydrostat.testing import ConformanceError, check_energy


class HessianOffByTenMillionths(NeoHookean):
    def hessian(self, nodes, controls):
        return super().hessian(nodes, controls) * (1 + 1e-5)


class HessianWithoutVolumeTerm(NeoHookean):
    def hessian(self, nodes, controls):
        whole, self._moduli = self._moduli, self._moduli * [[[1.0]], [[0.0]]]
        blocks = super().hessian(nodes, controls)
        self._moduli = whole
        return blocks


class HessianOfOneTermWrong(PinEnergy):
    """The softest pin of four, a thousandth as stiff as the stiffest."""

    def hessian(self, nodes, controls):
        blocks = super().hessian(nodes, controls)
        blocks[0] *= 1.001
        return blocks


class HessianNotSymmetric(NeoHookean):
    def hessian(self, nodes, controls):
        blocks = super().hessian(nodes, controls)
        blocks[3, 0, 1] *= 1.01
        return blocks


class GradientWithoutVolumeTerm(NeoHookean):
    def gradient(self, nodes, controls):
        whole, self._moduli = self._moduli, self._moduli * [[[1.0]], [[0.0]]]
        blocks = super().gradient(nodes, controls)
        self._moduli = whole
        return blocks


class ConvexityClaimed(NeoHookean):
    convex = True


class ValueNaN(NeoHookean):
    def value(self, nodes, controls):
        value = super().value(nodes, controls)
        return value if np.isfinite(value) else np.nan


class ValueReadsAnotherNode(PinEnergy):
    def value(self, nodes, controls):
        free = np.setdiff1d(np.arange(len(nodes)), self.stencils)[0]
        return super().value(nodes, controls) + 0.5 * float(nodes[free] @ nodes[free])


class TermReadsAnotherNode(PinEnergy):
    """Right as a whole, but two of its terms have swapped their stencils."""

    def gradient(self, nodes, controls):
        blocks = super().gradient(nodes, controls)
        blocks[0] += nodes[self.stencils[1]]
        return blocks


class ControlDerivativeNegative(FibreEnergy):
    def control_gradient(self, nodes, controls):
        return -super().control_gradient(nodes, controls)

    def gradient(self, nodes, controls):
        return controls[:, None, None] * super().control_gradient(nodes, controls)


class ControlOfAnother(FibreEnergy):
    def __init__(self, **arguments):
        super().__init__(**arguments)
        self.controls = np.arange(len(self.stencils))[::-1].copy()


class CableWithoutBend(CableEnergy):
    """T' dl dl^T alone."""

    def hessian(self, nodes, controls):
        return 0.0 * super().hessian(nodes, controls)


class CableWithoutLowRank(CableEnergy):
    """T d2l alone: it says that it couples no more than the nodes of a segment."""

    def low_rank_hessian(self, nodes, controls):  # pyright: ignore[reportIncompatibleMethodOverride]
        return None


class CableOfAnotherTangent(CableEnergy):
    """D is right for three cables of four."""

    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        columns, weights = found.columns, found.weights
        weights[1, 1] *= 1.001
        return LowRankStiffness(columns=columns, weights=weights)


class CableOfSwappedColumns(CableEnergy):
    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        columns, weights = found.columns, found.weights
        return LowRankStiffness(columns=columns[:, ::-1].copy(), weights=weights)


class LowRankNegative(CableEnergy):
    """The sum is right, but what is negative in the blocks has been moved into the part of low rank."""

    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        columns, weights = found.columns, found.weights
        weights = np.block([[weights, np.zeros((4, 2))], [np.zeros((2, 4)), np.diag([1.0, -1.0])]])
        return LowRankStiffness(
            columns=np.concatenate([columns, columns[:, :1], columns[:, :1]], axis=1), weights=weights
        )


class LowRankNotSymmetric(CableEnergy):
    """Skew between two columns that are alike: the sum is right."""

    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        columns, weights = found.columns, found.weights
        weights = np.block([[weights, np.zeros((4, 2))], [np.zeros((2, 4)), np.array([[1.0, 0.5], [-0.5, 1.0]])]])
        return LowRankStiffness(columns=np.concatenate([columns, np.zeros((nodes.size, 2))], axis=1), weights=weights)


class LowRankOfWrongShape(CableEnergy):
    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        columns, weights = found.columns, found.weights
        return LowRankStiffness(columns=columns[1:], weights=weights)


class CableControlForgotten(CableEnergy):
    """The last segment says that it does not follow its winch."""

    def control_gradient(self, nodes, controls):
        blocks = super().control_gradient(nodes, controls)
        blocks[-1] = 0.0
        return blocks


class CableOfAnotherLaw(CableEnergy):
    """D is right, but the law that is told is that of a stiffer cable."""

    def low_rank_hessian(self, nodes, controls):
        law = replace(self.law, stiffness=1.01 * self.law.stiffness)
        return replace(super().low_rank_hessian(nodes, controls), law=law)


class CableOfShiftedElongations(CableEnergy):
    """Told with a factor, so that G is not their slope."""

    def low_rank_hessian(self, nodes, controls):
        found = super().low_rank_hessian(nodes, controls)
        return replace(found, law=None, elongations=1.001 * found.elongations)


class ForceThatIsNegative(PinEnergy):
    def largest_force(self, nodes, controls):
        return -1.0


class StepOfNothing(PinEnergy):
    def largest_step(self, nodes, move):
        return 0.0


class TermsThatNeverRest(PinEnergy):
    """Near the same nodes it loses a term each time it is asked."""

    def with_active_terms(self, nodes):
        other = copy(self)
        other.stencils = self.stencils[1:]
        return other


class SupportsThatStay(PinEnergy):
    def with_supports_moved(self, shifts):
        return self


class LoadOfHalf(DeadLoadEnergy):
    """With a share of its load it forgets half of it."""

    def with_load(self, share):
        return DeadLoadEnergy(self._rest, 0.5 * share * self.forces)


class LoadOfNoWork(DeadLoadEnergy):
    def parameter_derivative(self, nodes, field):
        return {}


class SilentMemory(PinEnergy):
    """It changes along the path and does not say so."""

    def with_advanced_history(self, nodes, controls):
        return copy(self)


class ForgetsItsSlips(PinEnergy):
    """Resumed from what it remembers, it holds its points elsewhere."""

    has_history = True

    @property
    def history(self):
        return np.ones(1)

    def with_history(self, history, nodes, controls):
        other = copy(self)
        other.targets = self.targets + 0.01
        return other


class LiftsNothing(NeoHookean):
    def projected_hessian(self, nodes, controls, share):
        return super().projected_hessian(nodes, controls, 0.0)


class LiftsAtZero(NeoHookean):
    def projected_hessian(self, nodes, controls, share):
        return super().projected_hessian(nodes, controls, max(share, 0.01))

    def hessian(self, nodes, controls):
        return super().projected_hessian(nodes, controls, 0.0)


class LiftsBySquare(NeoHookean):
    def projected_hessian(self, nodes, controls, share):
        return super().projected_hessian(nodes, controls, share**2)


class LiftsTooLittle(NeoHookean):
    def projected_hessian(self, nodes, controls, share):
        return super().projected_hessian(nodes, controls, 0.99 * share)


class LiftThatLowers(NeoHookean):
    """It leaves every block definite, but takes from what was positive."""

    def projected_hessian(self, nodes, controls, share):
        whole, none = (super(LiftThatLowers, self).projected_hessian(nodes, controls, part) for part in (1.0, 0.0))
        return (1 - share) * none + share * 0.99 * whole


class GradientFlat(PinEnergy):
    def gradient(self, nodes, controls):
        return super().gradient(nodes, controls).reshape(len(self.stencils), -1)


BROKEN = [
    (HessianOffByTenMillionths, "hessian"),
    (HessianWithoutVolumeTerm, "hessian"),
    (HessianOfOneTermWrong, "hessian"),
    (HessianNotSymmetric, "hessian"),
    (GradientWithoutVolumeTerm, "gradient"),
    (GradientFlat, "gradient"),
    (ConvexityClaimed, "convexity"),
    (ValueNaN, "value"),
    (ValueReadsAnotherNode, "stencil"),
    (TermReadsAnotherNode, "gradient"),
    (ControlDerivativeNegative, "control gradient"),
    (ControlOfAnother, "control gradient"),
    (CableWithoutBend, "hessian"),
    (CableWithoutLowRank, "hessian"),
    (CableOfAnotherTangent, "hessian"),
    (CableOfSwappedColumns, "hessian"),
    (LowRankNegative, "low_rank_hessian"),
    (LowRankNotSymmetric, "low_rank_hessian"),
    (LowRankOfWrongShape, "low_rank_hessian"),
    (CableControlForgotten, "control gradient"),
    (CableOfAnotherLaw, "low_rank_hessian"),
    (CableOfShiftedElongations, "low_rank_hessian"),
    (ForceThatIsNegative, "largest force"),
    (StepOfNothing, "largest step"),
    (TermsThatNeverRest, "near"),
    (SupportsThatStay, "supports"),
    (LoadOfHalf, "load"),
    (LoadOfNoWork, "parameters"),
    (SilentMemory, "history"),
    (ForgetsItsSlips, "history"),
    (LiftsNothing, "projection"),
    (LiftsAtZero, "projection"),
    (LiftsBySquare, "projection"),
    (LiftsTooLittle, "projection"),
    (LiftThatLowers, "projection"),
]
MAKERS = {
    NeoHookean: neo_hookean,
    PinEnergy: pins,
    FibreEnergy: element_fibres,
    CableEnergy: cables,
    DeadLoadEnergy: weight,
}


@pytest.mark.parametrize(("broken", "check"), BROKEN)
@pytest.mark.parametrize("dim", [2, 3])
def test_a_broken_energy_is_found(broken: type[Energy], check: str, dim: int) -> None:
    state = MAKERS[broken.__mro__[1]](dim, np.random.default_rng(dim))
    energy = state.energy
    check_energy(energy, state.nodes, state.controls)
    if broken is ControlOfAnother:
        assert isinstance(energy, FibreEnergy)
        energy = ControlOfAnother(stencils=energy.stencils, weights=energy.weights)
    else:
        energy.__class__ = broken
    with pytest.raises(ConformanceError, match=check) as caught:
        check_energy(energy, state.nodes, state.controls)
    assert caught.value.check == check


def test_a_term_that_reads_outside_its_stencil_is_found() -> None:
    """Value and summed gradient are right, the split into terms is not: two terms hold each other's gradient."""

    class Swapped(PinEnergy):
        def gradient(self, nodes, controls):
            blocks = super().gradient(nodes, controls)
            shift = 10.0 * nodes[self.stencils[1]]
            shared = np.isin(self.stencils[0], self.stencils[2]) & ~np.isin(self.stencils[0], self.stencils[1])
            for corner in np.flatnonzero(shared):
                blocks[0, corner] += shift[0]
                blocks[2, self.stencils[2] == self.stencils[0, corner]] -= shift[0]
            return blocks

    nodes = rough_mesh(2, np.random.default_rng(0)).nodes
    energy = Swapped(
        stencils=np.array([[0, 1, 2], [3, 4, 8], [1, 2, 6]]),
        weights=np.full((3, 3), 1 / 3),
        targets=np.zeros((3, 2)),
        stiffness=np.ones(3),
    )
    with pytest.raises(ConformanceError, match="stencil"):
        check_energy(energy, nodes, np.zeros(0))


def test_a_cable_that_forgets_a_node_is_found() -> None:
    """Its stencil lacks a node: the length changes with it, the gradient does not."""

    class Forgetful(CableEnergy):
        def value(self, nodes, controls):
            lengths = np.linalg.norm(nodes[:1] - nodes[-1:], axis=1)
            return super().value(nodes, controls) + float(self.law.energy(lengths)[0])

    random = np.random.default_rng(0)
    mesh = rough_mesh(2, random)
    energy = Forgetful(
        mesh.nodes,
        CableSegments(
            stencils=np.array([[1, 3]]),
            weights=np.array([[-1.0, 1.0]]),
            offsets=np.zeros((1, 2)),
            cables=np.array([0]),
        ),
        law=LAW,
        winches=np.array([0]),
        slack=np.zeros(1),
    )
    with pytest.raises(ConformanceError, match="stencil") as caught:
        check_energy(energy, deform(mesh, random), np.array([0.02]))
    assert caught.value.index[0] in (0, len(mesh.nodes) - 1)
    assert caught.value.relative_error > 1e-3


def test_a_state_without_energy_is_refused() -> None:
    state = neo_hookean(2, np.random.default_rng(0))
    with pytest.raises(ConformanceError, match="finite at the state"):
        check_energy(state.energy, state.nodes * [1, -1], state.controls)
