"""`solve_krylov`: a linear system that is known by products alone."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Vector


def solve_krylov(product: Callable[[Vector], Vector], right: Vector, *, share: float = 1e-6) -> Vector:
    """Solution x of x - A x = right by GMRES (Saad and Schultz 1986); the best one found if it takes too long.

    Args:
        product: A times a vector.
        right: right-hand side.
        share: share of the right-hand side that may be left over.
    """
    most = 40  # Most products
    size = float(np.linalg.norm(right))
    if size == 0.0:
        return np.zeros_like(right)
    basis, hessenberg = [right / size], np.zeros((most + 1, most))
    weights = np.zeros(0)
    for count in range(1, most + 1):
        found = basis[-1] - product(basis[-1])
        for row, known in enumerate(basis):
            hessenberg[row, count - 1] = known @ found
            found = found - hessenberg[row, count - 1] * known
        hessenberg[count, count - 1] = rest = float(np.linalg.norm(found))
        goal = np.append(size, np.zeros(count))
        weights = np.linalg.lstsq(hessenberg[: count + 1, :count], goal)[0]
        if rest <= 1e-14 * size or np.linalg.norm(hessenberg[: count + 1, :count] @ weights - goal) <= share * size:
            break
        basis.append(found / rest)
    return weights @ np.array(basis[: len(weights)])
