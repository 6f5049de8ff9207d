"""Steps that slide. Oracle: a point on a spring in a corner of two walls, whose place of rest is known."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.sparse import csc_array

from hydrostat.mechanics import FactorizedHessian, SymbolicFactorization
from hydrostat.mechanics.energy import Gaps, LowRankStiffness
from hydrostat.mechanics.projection import Projection
from hydrostat.mechanics.sliding_step import StepTrial, find_sliding_step

GOAL = np.array([[3.0, 2.0]])
"""Rest of the spring, 1 N/m in each direction, beyond a wall at x = 1."""


@dataclass(frozen=True)
class Wall:
    """Stands for the sum of energies that knows the gap to the wall."""

    at: float

    def gaps(self, nodes: np.ndarray) -> list[Gaps]:
        normals = np.array([[[-1.0, 0.0]]])
        return [Gaps(np.array([[0]]), np.array([self.at - nodes[0, 0]]), normals, np.array([1e3]))]


def attempt(step: np.ndarray) -> StepTrial:
    share = min(1.0, 1.0 / max(step[0], 1.0))
    nodes = share * step.reshape(1, 2)
    energy = 0.5 * float(((GOAL - nodes) ** 2).sum())
    return StepTrial(Wall(1.0), nodes, energy, 1.0, share)  # pyright: ignore[reportArgumentType]


def spring() -> FactorizedHessian:
    indptr, indices = np.array([0, 2, 4], np.int32), np.array([0, 1, 0, 1], np.int32)
    assert csc_array((np.ones(4), indices, indptr), shape=(2, 2)).nnz == 4
    factors = SymbolicFactorization(indptr, indices, dim=2).factorize(np.array([1.0, 0.0, 0.0, 1.0]))
    return FactorizedHessian(factors, LowRankStiffness(columns=np.zeros((2, 0)), weights=np.zeros((0, 0))))


def test_a_step_slides_along_a_wall() -> None:
    """It ends at the wall, and across it where the spring pulls: a cut step would end at (1, 2/3)."""
    start, step = np.zeros((1, 2)), GOAL.ravel()
    found = find_sliding_step(attempt, start, step, attempt(step), spring())
    assert found.step == pytest.approx([1.0, 2.0], abs=0.01)
    assert found.trial.energy < attempt(step).energy


def test_a_step_that_meets_nothing_stays() -> None:
    start, step = np.zeros((1, 2)), np.array([0.5, 2.0])
    assert find_sliding_step(attempt, start, step, attempt(step), spring()).step is step


def test_contact_loses_its_negative_part_first() -> None:
    shares = [Projection()]
    while not shares[-1].whole:
        shares.append(shares[-1].with_larger_shares(projects_first=True))
    assert [share.early for share in shares] == sorted(share.early for share in shares)
    assert all(share.early == 1.0 for share in shares if share.late)
    assert [share.late for share in shares if share.early < 1.0] == [0.0]


def test_many_negative_eigenvalues_are_taken_whole() -> None:
    """Oracle: 7 of them, the count from which smaller shares failed in 38 of 38 steps."""
    assert Projection().with_larger_shares(projects_first=True, negative=7) == Projection(1.0, 1.0, raised=True)
    assert Projection().with_larger_shares(projects_first=True, negative=6) == Projection(1.0, raised=True)


def test_shares_fall_to_nothing() -> None:
    """The share of the body falls first, then all of that of contact; one that was just raised stays for a step."""
    shares = [Projection(1.0, 1.0, raised=True)]
    while shares[-1].any:
        shares.append(shares[-1].with_smaller_shares(projects_first=True))
    assert [share.late for share in shares] == [1.0, 1 / 16, 1 / 256, 0.0]
    assert [share.early for share in shares] == [1.0, 1.0, 1.0, 0.0]
    assert Projection(1.0, raised=True).with_smaller_shares(projects_first=True) == Projection(1.0)


def test_without_contact_all_of_it_is_taken_first() -> None:
    assert Projection().with_larger_shares(projects_first=False) == Projection(0.0, 1.0)
    assert Projection(1.0).with_smaller_shares(projects_first=False) == Projection()
