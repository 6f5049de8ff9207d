"""Array types of a picture: places in the plane, any number of them in one call."""

import numpy as np
from jaxtyping import Float

Place = Float[np.ndarray, " 2"]
"""One place, in millimetres unless its function says otherwise."""

Places = Float[np.ndarray, "_ 2"]
"""Places, one row each, in millimetres unless their function says otherwise."""

Spread = Float[np.ndarray, "_ dim"]
"""Points or nodes of a robot [m], any number of them in one call."""
