"""`estimate_stiffening`: excess stiffness of linear elements in a pose, estimated from the pose."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes
from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Plane, Volume

if TYPE_CHECKING:
    from scipy.sparse import csr_array

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
    slopes = now @ np.linalg.inv(spans)
    strains = 0.5 * (np.swapaxes(slopes, 1, 2) @ slopes - np.eye(mesh.dim))
    if np.abs(strains).max() < UNSTRAINED:
        return 0.0
    squeezes = np.trace(strains, axis1=1, axis2=2)
    (mu, lame), volumes = body.lame(), mesh.volumes
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
    """Linear fields that fit values of elements and of those around, as matrices from values to the field in each.

    Attributes:
        middle: value in the middle of the element.
        slopes: slope along each axis.
        moments: integral of the products of two coordinates from the middle [m^2 x volume].
    """

    middle: "csr_array"
    slopes: "list[csr_array]"
    moments: Tensors

    def misfit(
        self, values: Float[np.ndarray, "elements columns"], volumes: Float[np.ndarray, " elements"]
    ) -> Float[np.ndarray, "elements columns"]:
        """Integral over each element of the square of the field less the value of the element."""
        found = volumes[:, None] * (values - self.middle @ values) ** 2
        steep = [slope @ values for slope in self.slopes]
        for one, other in product(range(len(steep)), repeat=2):
            found += self.moments[:, one, other, None] * steep[one] * steep[other]
        return found


@lru_cache(maxsize=2)
def _fields(mesh: Mesh, materials: bytes) -> _LinearFields:
    """Fit by least squares, weighted by volumes, to elements of one material that share a node."""
    from scipy.sparse import csr_array

    count, corners = mesh.elements.shape
    kinds: Int[np.ndarray, " elements"] = np.frombuffer(materials, dtype=np.int64)
    entries = np.ones(mesh.elements.size), (np.repeat(np.arange(count), corners), mesh.elements.ravel())
    touching = csr_array(entries, shape=(count, len(mesh.nodes)))
    near = (touching @ touching.T).tocoo()
    row, column = (part[kinds[near.row] == kinds[near.col]] for part in (near.row, near.col))
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
    middle, *slopes = (
        csr_array((fits[:, place] / (size[row] if place else 1.0), (row, column)), shape=(count, count))
        for place in range(corners)
    )
    spread = mesh.nodes[mesh.elements] - middles[:, None]
    moments = np.einsum("eci,ecj->eij", spread, spread) * (mesh.volumes / (corners * (corners + 1)))[:, None, None]
    return _LinearFields(middle, slopes, moments)
