"""How long a factorization and a solve take, of bodies of several sizes, by both back ends.

    python lab/large_bodies/factorization.py [--repeat 30] [--largest 9000]

The matrix is a mesh's graph Laplacian with a block for every edge: it has the pattern of the Hessian of an elastic
body, definite as at rest ("definite"), or lowered until some eigenvalues are negative ("indefinite"). CPU time, the
median of many runs; the residual is that of one solve of the definite matrix, relative to the right-hand side. SuperLU
analyses again each time, so there its analysis is part of each factorization.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

from machine import machine

import numpy as np  # isort: skip

from benchmark_bodies import hand_mesh
from scipy.sparse import coo_array, csc_array, diags_array, eye_array, kron

from hydrostat.arrays import Elements, Nodes
from hydrostat.mechanics import Backend, SymbolicFactorization
from hydrostat.robot import gallery_folder, load_robot


@dataclass(frozen=True)
class Body:
    """A mesh.

    Attributes:
        name: what it is.
        nodes: where its nodes are.
        elements: their simplices.
    """

    name: str
    nodes: Nodes
    elements: Elements


def matrix(body: Body, shift: float) -> csc_array:
    """A block of 2 I + 0.3 for every edge, and `shift` on the diagonal."""
    count, dim = body.nodes.shape
    corners = body.elements.shape[1]
    rows, columns = np.repeat(body.elements, corners, axis=1).ravel(), np.tile(body.elements, (1, corners)).ravel()
    apart = rows != columns
    pattern = csc_array(coo_array((np.ones(apart.sum()), (rows[apart], columns[apart])), shape=(count, count)))
    pattern.data[:] = -1.0
    laplacian = pattern - diags_array(pattern.sum(axis=0))
    result = csc_array(kron(laplacian, 2 * np.eye(dim) + 0.3) + shift * eye_array(count * dim))
    result.sort_indices()
    return result


def median_ms(function: Callable[[], object], repeat: int) -> float:
    """CPU time of a call [ms]."""
    function()
    times = []
    for _ in range(repeat):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return 1e3 * float(np.median(times))


def row(body: Body, backend: Backend, repeat: int) -> str:
    """A line of the table."""
    definite, indefinite = matrix(body, 0.1), matrix(body, -1.6)
    count, dim = body.nodes.shape
    right = np.random.default_rng(0).standard_normal((count * dim, 16))

    def analyze() -> SymbolicFactorization:
        return SymbolicFactorization(definite.indptr, definite.indices, dim=dim, points=body.nodes, backend=backend)

    analysis = analyze()
    factor, other = analysis.factorize(definite.data), analysis.factorize(indefinite.data)
    residual = np.abs(definite @ factor.solve(right[:, 0]) - right[:, 0]).max() / np.abs(right[:, 0]).max()
    figures = (
        median_ms(analyze, 3) if backend == "supernodal" else 0.0,
        median_ms(lambda: analysis.factorize(definite.data), repeat),
        median_ms(lambda: analysis.factorize(indefinite.data), repeat),
        median_ms(lambda: factor.solve(right[:, 0]), repeat),
        median_ms(lambda: factor.solve(right), repeat),
    )
    timings = " | ".join(f"{figure:.2f}" if figure else "-" for figure in figures)
    return f"| {body.name} | {count} | {count * dim} | {backend} | {timings} | {other.negative} | {residual:.0e} |"


def bodies(largest: int) -> list[Body]:
    """From a flat robot to a fine hand."""
    flat = load_robot(gallery_folder("starfish")).body.mesh
    result = [Body("starfish", flat.nodes, flat.elements)]
    for element_size in (17e-3, 11.6e-3, 8e-3, 6.4e-3, 5e-3, 4.2e-3):
        mesh = hand_mesh(element_size)
        if len(mesh.nodes) > largest:
            break
        result.append(Body(f"hand, {1e3 * element_size:g} mm", mesh.nodes, mesh.elements))
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=30, help="runs of each timing at 1000 nodes; fewer above")
    parser.add_argument("--largest", type=int, default=9000, help="most nodes of a body")
    options = parser.parse_args()
    print(machine())
    print("CPU ms, median\n")
    print("| body | nodes | dofs | by | analysis | definite | indefinite | solve 1 | solve 16 | negative | residual |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for body in bodies(options.largest):
        for backend in ("supernodal", "superlu"):
            repeat = int(np.clip(options.repeat * 1000 / len(body.nodes), 3, 200))
            print(row(body, backend, repeat), flush=True)


if __name__ == "__main__":
    main()
