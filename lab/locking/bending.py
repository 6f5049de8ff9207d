"""How well bars bend: linear elements, patches and quadratic elements at each Poisson's ratio, and what they cost.

    python lab/locking/bending.py

**Free root.** A cantilever 16 times as long as high sags under its weight; its root may become thicker or thinner, so
Timoshenko's beam is the oracle (in the plane with E / (1 - nu^2) for E). The figure is the sag over the theory's, less
1.

**Clamped root.** The same bar, 8 times as long as high, of which the whole root is held. Oracle: a fine quadratic mesh.

**Cost.** CPU time of one Hessian and its factorization, by nodes. Linear elements with volume in patches need so many
more nodes for the same error.

**Lambda at each point.** The same with other shares of lambda at the points of quadrature (`MAX_POINTWISE_RATIO`).
"""

import time
from collections.abc import Callable
from functools import cache

import numpy as np
from machine import machine
from scipy.sparse.linalg import splu

from hydrostat.geometry import Mesh
from hydrostat.mechanics import (
    MAX_POINTWISE_RATIO,
    PATCH_SIZE,
    Assembly,
    Energy,
    NeoHookean,
    PatchDilatation,
    QuadraticSolid,
    grow_patches,
)
from hydrostat.robot import Material
from locking import HEIGHT, YOUNG, drawn, kuhn, lattice

RATIOS = (0.0, 0.3, 0.45, 0.49, 0.499)
MAKERS: dict[str, Callable[..., Mesh]] = {
    "triangles": drawn,
    "cubes cut in six": kuhn,
    "body-centered lattice": lattice,
}
WAYS = ((2, "quadratic"), (1, "quadratic"), (4, "element"), (4, "patch"))


def assemble(mesh: Mesh, poisson: float, kind: str) -> tuple[Mesh, Assembly]:
    """Mesh with the nodes of the elements of a kind, and their energy."""
    mu, lame = Material(young=YOUNG, poisson=poisson, density=1.0).lame
    if kind == "quadratic":
        mesh = mesh.to_quadratic()
        energies: list[Energy] = [QuadraticSolid(mesh.nodes, mesh.quadratic, mu=mu, lame=lame)]
    elif kind == "patch":
        patches = grow_patches(mesh.elements, PATCH_SIZE[mesh.dim])
        energies = [NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=None)]
        energies.append(PatchDilatation(mesh.nodes, mesh.elements, patches, lame=lame))
    else:
        energies = [NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=lame)]
    return mesh, Assembly(energies, rest=mesh.nodes, control_count=0)


def sag(mesh: Mesh, poisson: float, kind: str, *, clamped: bool) -> float:
    """Work of the weight of a cantilever, of density and gravity 1."""
    mesh, assembly = assemble(mesh, poisson, kind)
    hessian = assembly.hessian(mesh.nodes, np.zeros(0))
    weight = np.zeros_like(mesh.nodes)
    np.add.at(weight[:, 1], mesh.elements, np.repeat(mesh.volumes[:, None] / (mesh.dim + 1), mesh.dim + 1, 1))
    aside = np.abs(mesh.nodes)
    root = aside[:, 0] < 1e-9
    held = np.zeros(weight.shape, dtype=bool)
    held[root] = clamped
    held[root, 0] = True
    held[np.argmin(aside.sum(axis=1))] = True
    if mesh.dim == 3:
        held[np.argmin(aside[:, 0] + aside[:, 1] - aside[:, 2]), 1] = True
    free, right = ~held.ravel(), weight.ravel()
    return float(right[free] @ splu(hessian[free][:, free].tocsc()).solve(right[free]))


def theory(dim: int, poisson: float, length: float) -> float:
    """Timoshenko's work of the weight."""
    young, width = (YOUNG, HEIGHT) if dim == 3 else (YOUNG / (1 - poisson**2), 1.0)
    area, shear = HEIGHT * width, YOUNG / (2 * (1 + poisson))
    return area**2 * (length**5 / (20 * young * area * HEIGHT**2 / 12) + length**3 / (3 * 5 / 6 * shear * area))


@cache
def clamped_limit(name: str, poisson: float) -> float:
    mesh = drawn(12, 8 * HEIGHT) if name == "triangles" else kuhn(3, 8 * HEIGHT)
    return sag(mesh, poisson, "quadratic", clamped=True)


def errors(name: str, rows: int, kind: str, *, clamped: bool) -> list[float]:
    found = []
    for poisson in RATIOS:
        mesh = MAKERS[name](rows, (8 if clamped else 16) * HEIGHT)
        exact = clamped_limit(name, poisson) if clamped else theory(mesh.dim, poisson, 16 * HEIGHT)
        found.append(sag(mesh, poisson, kind, clamped=clamped) / exact - 1)
    return found


def bending(*, clamped: bool) -> None:
    print(f"\nsag less what it should be [%], {'clamped' if clamped else 'free'} root\n")
    print("| mesh | elements across | " + " | ".join(f"nu {ratio:g}" for ratio in RATIOS) + " |")
    print("|---" * (2 + len(RATIOS)) + "|")
    for name in MAKERS:
        for rows, kind in WAYS:
            found = " | ".join(f"{100 * error:.1f}" for error in errors(name, rows, kind, clamped=clamped))
            print(f"| {name} | {rows} {kind} | {found} |", flush=True)


def cost() -> None:
    print("\ncost of a Hessian and its factors, free root, nu 0.3 and 0.49\n")
    print("| mesh | elements across | nodes | CPU ms | sag at 0.3 | sag at 0.49 |\n|---|---|---|---|---|---|")
    for name in ("triangles", "cubes cut in six"):
        most = (4, 8, 16) if name == "triangles" else (4, 8)
        for rows, kind in ((2, "quadratic"), *((rows, "patch") for rows in most)):
            length = 16 * HEIGHT
            mesh, assembly = assemble(MAKERS[name](rows, length), 0.49, kind)
            values = assembly._values(mesh.nodes, np.zeros(0), 0.0)
            values[assembly.pattern.diagonal] += 1e-3 * values.max()
            assembly.pattern.analysis.factorize(values)
            start = time.process_time()
            for _ in range(3):
                assembly._values(mesh.nodes, np.zeros(0), 0.0)
                assembly.pattern.analysis.factorize(values)
            spent = 1e3 * (time.process_time() - start) / 3
            some = [
                100 * (sag(MAKERS[name](rows, length), nu, kind, clamped=False) / theory(mesh.dim, nu, length) - 1)
                for nu in (0.3, 0.49)
            ]
            tail = " | ".join(f"{error:.1f} %" for error in some)
            print(f"| {name} | {rows} {kind} | {len(mesh.nodes)} | {spent:.1f} | {tail} |", flush=True)


def pointwise() -> None:
    print("\nsag less what it should be [%], 2 quadratic across: free root, then clamped, nu 0.45, 0.49, 0.499\n")
    for name in ("triangles", "cubes cut in six"):
        dim = 2 if name == "triangles" else 3
        kept = MAX_POINTWISE_RATIO[dim]
        for share in (0.0, 4.0, 6.0, 8.0, 12.0, np.inf):
            found = []
            for clamped in (False, True):
                MAX_POINTWISE_RATIO[dim] = kept
                for nu in RATIOS[2:]:
                    clamped_limit(name, nu)
                MAX_POINTWISE_RATIO[dim] = share
                found += errors(name, 2, "quadratic", clamped=clamped)[2:]
            print(f"- {name}, {share:g} mu: " + ", ".join(f"{100 * error:.1f}" for error in found), flush=True)
        MAX_POINTWISE_RATIO[dim] = kept


def main() -> None:
    print(machine())
    bending(clamped=False)
    bending(clamped=True)
    cost()
    pointwise()


if __name__ == "__main__":
    main()
