"""`Energy`: the contract of every term of the potential energy E(x; a)."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes, Vector

Stencils = Int[np.ndarray, "terms corners"]
Blocks = Float[np.ndarray, "terms corners dim"]
HessianBlocks = Float[np.ndarray, "terms size size"]


class Energy(ABC):
    """A sum of terms, each of which depends on the few nodes of its stencil and on at most one control.

    A control is what an actuator commands: the contraction of a winch [m], the tension of a muscle fibre [N].
    A new energy needs no more than this contract to be assembled, minimised and differentiated; run
    `hydrostat.testing.check_energy` on it.

    Attributes:
        stencils: nodes of each term, (terms, corners).
        controls: index of the control of each term, (terms,); None for an energy without controls.
        convex: whether every Hessian block is positive semidefinite wherever the energy is defined.
        quadratic: whether the Hessian is the same for all nodes and controls; then it is added up once.
    """

    stencils: Stencils
    controls: Int[np.ndarray, " terms"] | None = None
    convex: ClassVar[bool] = True
    quadratic: ClassVar[bool] = False

    @abstractmethod
    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Energy [J]; infinite where it is not defined, as for an inverted element."""

    @abstractmethod
    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        """dE/dx of each term [N], (terms, corners, dim)."""

    @abstractmethod
    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        """d2E/dx2 of each term [N/m], (terms, corners x dim, corners x dim), less what `low_rank` tells."""

    def lifted_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        """The Hessian blocks with this share, 0 to 1, of what is negative in them taken out (E6)."""
        blocks = self.hessian(nodes, controls)
        return blocks if self.convex else blocks + share * (nearest_semidefinite(blocks) - blocks)

    def low_rank(
        self, nodes: Nodes, controls: Vector
    ) -> tuple[Float[np.ndarray, "dofs rank"], Float[np.ndarray, "rank rank"]] | None:
        """G and D of a part G D G^T of d2E/dx2 that couples many nodes; D is positive semidefinite. None for most."""
        return None

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        """d2E/dx da of each term, (terms, corners, dim), a being the term's own control."""
        raise NotImplementedError(f"{type(self).__name__} has no controls")


def nearest_semidefinite(blocks: HessianBlocks) -> HessianBlocks:
    """Each symmetric block with its negative eigenvalues set to zero."""
    values, vectors = np.linalg.eigh(blocks)
    bad = values[:, 0] < 0
    if not bad.any():
        return blocks
    repaired = blocks.copy()
    kept = np.maximum(values[bad], 0.0)
    repaired[bad] = (vectors[bad] * kept[:, None, :]) @ np.swapaxes(vectors[bad], 1, 2)
    return repaired
