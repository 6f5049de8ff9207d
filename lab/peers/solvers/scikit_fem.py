"""Newton's method as users of scikit-fem write it: its assembly of residual and Hessian, SciPy's direct solver."""

from collections.abc import Iterator

import numpy as np
from held_body import Answers, HeldBody, main
from skfem import Basis, BilinearForm, ElementTetP1, ElementVector, LinearForm, MeshTet, condense, solve
from skfem.helpers import ddot, det, grad, identity, inv, mul, trace, transpose


def prepare(body: HeldBody, _variant: str) -> Answers:
    """Full steps, halved while an element is inverted or the forces left over grow."""
    mu, lame = body.mu, body.lame
    basis = Basis(MeshTet(body.nodes.T.copy(), body.elements.T.copy()), ElementVector(ElementTetP1()), intorder=0)

    @LinearForm
    def forces(v, w):
        F = grad(w["u"]) + identity(w["u"])
        inverse = transpose(inv(F))
        return ddot(mu * (F - inverse) + lame * np.log(det(F)) * inverse, grad(v))

    @BilinearForm
    def hessian(u, v, w):
        F = grad(w["u"]) + identity(w["u"])
        inverse = inv(F)
        moved = mul(inverse, grad(u))
        turned = transpose(mul(moved, inverse))
        change = (mu - lame * np.log(det(F))) * turned + lame * trace(moved) * transpose(inverse)
        return ddot(mu * grad(u) + change, grad(v))

    loads = np.zeros(basis.N)
    loads[basis.nodal_dofs] = body.forces.T
    fixed = basis.nodal_dofs[:, body.held].ravel()
    free = np.setdiff1d(np.arange(basis.N), fixed)

    def left_over(u: np.ndarray) -> np.ndarray:
        field = basis.interpolate(u)
        if not (det(grad(field) + identity(field)) > 0).all():
            return np.full(basis.N, np.inf)
        return forces.assemble(basis, u=field) - loads

    def begin() -> Iterator[np.ndarray]:
        u = np.zeros(basis.N)
        residual = left_over(u)
        for _ in range(100):
            matrix = hessian.assemble(basis, u=basis.interpolate(u))
            step, share = solve(*condense(matrix, -residual, D=fixed)), 1.0
            trial = left_over(u + step)
            while not np.abs(trial[free]).max() < 10 * np.abs(residual[free]).max() and share > 1e-4:
                share /= 2
                trial = left_over(u + share * step)
            u, residual = u + share * step, trial
            yield body.nodes + u[basis.nodal_dofs].T
            if np.abs(residual[free]).max() < 1e-10 * np.abs(loads).max():
                return

    return begin


if __name__ == "__main__":
    main(prepare)
