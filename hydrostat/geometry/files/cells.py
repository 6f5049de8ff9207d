"""`Cells`: what a mesh file says, before it is a `Mesh`."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True, eq=False)
class Cells:
    """Points and the simplices among the cells of a file.

    Attributes:
        points: places in the file's own unit.
        tetrahedra: indices of four points each, as declared and thus perhaps wrong.
        triangles: indices of three points each.
    """

    points: Float[np.ndarray, "points 3"]
    tetrahedra: Int[np.ndarray, "tetrahedra 4"]
    triangles: Int[np.ndarray, "triangles 3"]
