"""Named array types. Their shapes are checked while the tests run (jaxtyping with beartype)."""

import numpy as np
from jaxtyping import Float, Int

Points = Float[np.ndarray, "points dim"]
"""Positions [m], one row a point."""

Nodes = Float[np.ndarray, "nodes dim"]
"""Positions of the nodes of a mesh [m]."""

Elements = Int[np.ndarray, "elements corners"]
"""Node indices of every element, corners = dim + 1, positively oriented."""

Vector = Float[np.ndarray, " _"]
"""A plain vector; the lengths of two in one signature have nothing to do with each other."""
