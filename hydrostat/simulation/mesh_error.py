"""`estimate_stiffening`: excess stiffness of linear elements in a pose, estimated from the pose."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from hydrostat.arrays import Float, Int, Nodes
from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Plane, Volume

WORTH_A_NOTE = 0.1
"""Least excess of stiffness that a pose has a note of."""

UNSTRAINED = 1e-3
"""Largest strain of a pose near rest, where tight cables at their ends alone would be judged."""

Tensors = Float[np.ndarray, "elements dim dim"]


def estimate_stiffening(body: Body, nodes: Nodes) -> float:
    """Estimate by how much linear elements are at least too stiff in a pose, as a share; 0 near rest, or if quadratic.

    Strain is constant in a linear element. The estimate compares it with the linear field that fits the strain of all
    elements around (Zienkiewicz and Zhu 1987): the energy of the difference over the energy of the body. For gallery
    robots of Poisson's ratio 0.3 it is 0.4 to 1.1 of the excess over quadratic elements, at 0.49 a quarter to a half.

    Args:
        body: body.
        nodes: positions of its nodes [m].
    """
    mesh = body.mesh
    if mesh.quadratic is not None or not len(mesh.elements):
        return 0.0
    spans, now = (np.swapaxes(x[mesh.elements[:, 1:]] - x[mesh.elements[:, :1]], 1, 2) for x in (mesh.nodes, nodes))
    derivatives = now @ np.linalg.inv(spans)
    strains = 0.5 * (np.swapaxes(derivatives, 1, 2) @ derivatives - np.eye(mesh.dim))
    if np.abs(strains).max() < UNSTRAINED:
        return 0.0
    squeezes = np.trace(strains, axis1=1, axis2=2)
    (mu, lame), volumes = np.array(body.lame()) * body.stiffness_factors, mesh.volumes
    if body.plane is Plane.STRESS:
        lame = 2 * mu * lame / (2 * mu + lame)
    stored = float(volumes @ (mu * (strains**2).sum(axis=(1, 2)) + 0.5 * lame * squeezes**2))
    fields = _fields(mesh, body.element_materials.tobytes())
    wrong = float(mu @ fields.misfit(strains.reshape(len(strains), -1), volumes).sum(axis=1))
    if body.volume is Volume.ELEMENT:
        wrong += 0.5 * float(lame @ fields.misfit(squeezes[:, None], volumes)[:, 0])
    return wrong / stored if stored > 0 else 0.0


@dataclass(frozen=True, eq=False)
class _LinearFields:
    """Linear fields that fit values of elements and of those around: weighted sums over pairs of near elements.

    Attributes:
        row: element of each pair whose field it is; in order.
        column: element of each pair whose value it takes.
        weights: weight in the value in the middle of the element, then in the derivative along each axis [1/m].
        moments: integral of the products of two coordinates from the middle [m^2 x volume].
    """

    row: Int[np.ndarray, " pairs"]
    column: Int[np.ndarray, " pairs"]
    weights: Float[np.ndarray, "terms pairs"]
    moments: Tensors

    def misfit(
        self, values: Float[np.ndarray, "elements columns"], volumes: Float[np.ndarray, " elements"]
    ) -> Float[np.ndarray, "elements columns"]:
        """Integral over each element of the square of the field less the value of the element."""
        begins = np.searchsorted(self.row, np.arange(len(values)))
        near = values[self.column]
        middle, *steep = (np.add.reduceat(weight[:, None] * near, begins) for weight in self.weights)
        found = volumes[:, None] * (values - middle) ** 2
        for one, other in product(range(len(steep)), repeat=2):
            found += self.moments[:, one, other, None] * steep[one] * steep[other]
        return found


def _near_pairs(elements: Int[np.ndarray, "elements corners"]) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of elements that share a node, each with itself too, in order of the first."""
    count, corners = elements.shape
    order = np.argsort(elements, axis=None, kind="stable")
    around, size = order // corners, np.bincount(elements.ravel())  # elements at each node, one node after the other
    begin, size = np.repeat(np.cumsum(size) - size, size), np.repeat(size, size)
    steps = np.arange(size.sum()) - np.repeat(np.cumsum(size) - size, size)
    pairs = np.sort(np.repeat(around, size) * count + around[np.repeat(begin, size) + steps])
    return np.divmod(pairs[np.append(True, np.diff(pairs) > 0)], count)


@lru_cache(maxsize=2)
def _fields(mesh: Mesh, materials: bytes) -> _LinearFields:
    """Fit by least squares, weighted by volumes, to elements of one material that share a node."""
    count, corners = mesh.elements.shape
    kinds: Int[np.ndarray, " elements"] = np.frombuffer(materials, dtype=np.int64)
    row, column = _near_pairs(mesh.elements)
    alike = kinds[row] == kinds[column]
    row, column = row[alike], column[alike]
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    away = middles[column] - middles[row]
    size = np.sqrt(np.bincount(row, (away**2).sum(axis=1), count) / np.bincount(row, minlength=count))
    size = np.where(size > 0, size, 1.0)
    basis = np.concatenate([np.ones((len(row), 1)), away / size[row, None]], axis=1)
    weights = mesh.volumes[column]
    products = np.empty((count, corners, corners))
    for a, b in product(range(corners), repeat=2):
        products[:, a, b] = np.bincount(row, weights * basis[:, a] * basis[:, b], count)
    scale = np.trace(products, axis1=1, axis2=2)
    products += 1e-6 * scale[:, None, None] * np.eye(corners)  # elements with few neighbors
    fits = np.einsum("pab,pb->pa", np.linalg.inv(products)[row], basis * weights[:, None])
    fits[:, 1:] /= size[row, None]
    spread = mesh.nodes[mesh.elements] - middles[:, None]
    moments = np.einsum("eci,ecj->eij", spread, spread) * (mesh.volumes / (corners * (corners + 1)))[:, None, None]
    return _LinearFields(row, column, fits.T, moments)
