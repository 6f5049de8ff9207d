"""`Warp`: a step that turns material instead of stretching it."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Float, Int, Nodes
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Stencils, element_groups
from hydrostat.mechanics.factorization import SymbolicFactorization

StepMap = Callable[[Nodes, Nodes], Nodes]
"""Map from the unknowns and a step to the unknowns after the step [m]."""


class Warp:
    """Step of Newton that follows arcs (rotation-strain warping).

    A straight step that turns a limb by an angle t lengthens it by 1/cos t, so far from equilibrium Newton on a
    slender body creeps. Here the step's gradient in each element is split into a stretch S and a spin W; the element
    is turned by exp(W) and stretched by I + S, and the nodes that fit these best follow from one scalar Laplacian for
    all axes, whose factors never change (rotation-strain warping, Huang et al. 2011). To first order the step is the
    same.
    """

    def __init__(
        self,
        *,
        stencils: Stencils,
        shape_gradients: Float[np.ndarray, "elements corners dim"],
        volumes: Float[np.ndarray, " elements"],
        rest: Nodes,
        held: Int[np.ndarray, "points anchors"],
        holds: Float[np.ndarray, "points anchors"],
    ) -> None:
        """Elements of the body and held points, by stencils and weights, that go where the straight step leads.

        Volumes may be weighted: the nodes fit elements of more weight better, such as those of a stiff part.
        """
        count = len(rest)
        if not len(held):  # a free body stays where the straight step leads on average
            held, holds = np.arange(count)[:, None], np.full((count, 1), 1e-4)
        spread = volumes[:, None, None] * (shape_gradients @ shape_gradients.swapaxes(1, 2))
        grips = float(np.einsum("eaa->", spread)) / count * holds[:, :, None] * holds[:, None, :]
        entries = [_entries(stencils, spread, count), _entries(held, grips, count)]
        keys, places = np.unique(np.concatenate([keys for keys, _ in entries]), return_inverse=True)
        data = np.bincount(places, np.concatenate([values for _, values in entries]))
        columns, rows = np.divmod(keys, count)
        indptr = np.searchsorted(columns, np.arange(count + 1)).astype(np.int32)
        self._factors = SymbolicFactorization(indptr, rows.astype(np.int32), dim=1, points=rest).factorize(data)
        self._groups = element_groups(stencils, shape_gradients, volumes)

    def __call__(self, nodes: Nodes, step: Nodes) -> Nodes:
        """Return the nodes after a step in which each element follows its own spin and stretch [m]."""
        right = np.zeros_like(nodes)
        native.turn(nodes, step, *self._groups, right)
        return nodes + (step + self._factors.solve(right))


def _entries(stencils: Stencils, blocks: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Keys, column x count + row, and values of the blocks of all stencils."""
    keys = stencils[:, None, :].astype(np.int64) * count + stencils[:, :, None]
    return keys.ravel(), blocks.ravel()
