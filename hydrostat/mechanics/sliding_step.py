"""`find_sliding_step`: a Newton step that slides along the parts that it meets."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.assembly import Assembly
from hydrostat.mechanics.energy import Gaps, LowRankBasis
from hydrostat.mechanics.factorized_hessian import FactorizedHessian
from hydrostat.mechanics.tension_law import TensionLaw


class StepTrial(NamedTuple):
    """End point of a step, and the admissible share of the step."""

    assembly: Assembly
    nodes: Nodes
    energy: float
    min_volume_ratio: float
    share: float


class SlidingStep(NamedTuple):
    """A step [m], (dofs,), and its trial."""

    step: Vector
    trial: StepTrial


def find_sliding_step(
    attempt: Callable[[Vector], StepTrial], start: Nodes, step: Vector, blocked: StepTrial, stiffness: FactorizedHessian
) -> SlidingStep:
    """Return a step that keeps apart the pairs that a step meets, or the step itself if that is no better.

    Newton's quadratic model contains active pairs only, so a step ends where it meets other pairs. Here these join the
    model as springs that push below a gap, linearized where the step ended. No matrix is factorized.

    Args:
        attempt: takes a step as far as it is admissible.
        start: nodes at which the step begins [m].
        step: the step, (dofs,) [m].
        blocked: trial of that step.
        stiffness: Hessian at `start`.
    """
    best = last = SlidingStep(step, blocked)
    springs: list[tuple[LowRankBasis, Vector, Vector]] = []
    for _ in range(4):  # A step that slides may meet more pairs
        place = last.trial.nodes
        move = start + last.step.reshape(start.shape) - place
        met = [_springs(gaps, start, place, move) for gaps in last.trial.assembly.gaps(place)]
        springs += [spring for spring in met if len(spring[1])]
        if not any(len(spring[1]) for spring in met):
            break
        columns, widths, stiff = (np.concatenate(parts, axis=-1) for parts in zip(*springs, strict=True))
        overlaps = -(widths + step @ columns)
        smoothing = 1e-3  # Springs begin smoothly, over this share of the largest overlap
        law = TensionLaw(stiffness=stiff, smoothing=np.full(len(stiff), smoothing * np.abs(overlaps).max()))
        push = stiffness.push(-columns, overlaps, law)
        if push is None:
            break
        last = SlidingStep(step + push, attempt(step + push))
        best = min(best, last, key=lambda found: found.trial.energy)
        if last.trial.share == 1.0:
            break
    return best


def _springs(gaps: Gaps, start: Nodes, place: Nodes, move: Nodes) -> tuple[LowRankBasis, Vector, Vector]:
    """Derivatives, widths at `start` and stiffness of the gaps at a place that a further move would close most."""
    ends = gaps.widths + np.einsum("pci,pci->p", gaps.normals, move[gaps.stencils])
    most = 16  # More springs change little
    closed = np.argsort(ends)[: min(most, int((ends < 0.0).sum()))]
    columns = np.zeros((*start.shape, len(closed)))
    for column, pair in enumerate(closed):
        np.add.at(columns[:, :, column], gaps.stencils[pair], gaps.normals[pair])
    columns = columns.reshape(start.size, -1)
    return columns, gaps.widths[closed] + (start - place).ravel() @ columns, gaps.stiffness[closed]
