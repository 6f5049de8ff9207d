"""`Shape`: a body by its signed distance, with the limbs along which cables are led."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.geometry.contour import contour
from hydrostat.geometry.surface import Surface
from hydrostat.shapes.field import Field
from hydrostat.shapes.limb import Limb


@dataclass(frozen=True, eq=False)
class Shape:
    """A body in space.

    Attributes:
        field: about how far points are outside [m], negative inside.
        box: lowest and highest coordinates that hold the whole body [m].
        limbs: by name; their landmarks are the joints.
    """

    field: Field
    box: Float[np.ndarray, "2 3"]
    limbs: Mapping[str, Limb]

    def surface(self, spacing: float) -> Surface:
        """The closed surface, drawn on a grid [m]; details smaller than the spacing are lost.

        Raises:
            SurfaceError: the spacing is not above 0, too fine for the memory or so coarse that nothing is left.
        """
        # Halved, for the distance from a flat section can change by more than the way, though by less than twice.
        return contour(lambda points: self.field(points) / 2, self.box, spacing, distance=True)
