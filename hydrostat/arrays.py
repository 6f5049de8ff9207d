"""Named array types. Their shapes are checked while the tests run (jaxtyping with beartype).

`Float[np.ndarray, "nodes dim"]` is jaxtyping's type if that was loaded before, else an annotation that is only read:
loading jaxtyping takes a twentieth of a short command.
"""

import sys
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

if TYPE_CHECKING or "jaxtyping" in sys.modules:
    from jaxtyping import Bool, Float, Int, UInt8
else:

    class _Shaped:
        """Array type whose shape is only read."""

        def __init__(self, kind: str) -> None:
            self._kind = kind

        def __getitem__(self, array_and_shape: tuple[Any, str]) -> Any:
            array, shape = array_and_shape
            return Annotated[array, f"{self._kind}: {shape.strip()}"]

    Bool, Float, Int, UInt8 = map(_Shaped, ("bool", "float", "int", "uint8"))

Points = Float[np.ndarray, "points dim"]
"""Positions [m], one row a point."""

Nodes = Float[np.ndarray, "nodes dim"]
"""Positions of the nodes of a mesh [m]."""

Elements = Int[np.ndarray, "elements corners"]
"""Node indices of every element, corners = dim + 1, positively oriented."""

Vector = Float[np.ndarray, " _"]
"""A plain vector; the lengths of two in one signature have nothing to do with each other."""
