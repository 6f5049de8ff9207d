"""What limits and objectives check of what they are given; types are checked too, as scripts are not."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh


def numbers(given: object) -> Float[np.ndarray, "..."] | None:
    """What is given as real numbers; None if it is anything else, such as text with a unit."""
    try:
        found = np.asarray(given)
    except (TypeError, ValueError):
        return None
    return found.astype(float) if found.dtype.kind in "iuf" else None


def describe(given: object) -> str:
    """Show what is given in an error of one line: a number, a short text, or its kind."""
    found = numbers(given)
    if found is not None and found.ndim == 0:
        return f"{found:g}"
    words = repr(given)
    if len(words) <= _LONGEST and "\n" not in words:
        return words
    kind = type(given).__name__
    return f"{'an' if kind[0] in 'AEIOU' else 'a'} {kind}"


def not_negative(what: str, given: object) -> float:
    """A number of 0 or more.

    Raises:
        InputError: it is anything else.
    """
    found = numbers(given)
    if found is None or found.ndim or not 0 <= found < np.inf:
        raise InputError(f"{what} must be 0 or more, not {describe(given)}")
    return float(found)


def above_zero(what: str, given: object, *, unit: str = "") -> float:
    """A number above 0; infinity is one.

    Raises:
        InputError: it is anything else.
    """
    found = numbers(given)
    if found is None or found.ndim or not found > 0:
        raise InputError(f"{what} must be a number above 0{unit and ' '}{unit}, not {describe(given)}")
    return float(found)


def by_name(what: str, given: object, example: str) -> Mapping[str, Any]:
    """Something for each name.

    Raises:
        InputError: it is anything else.
    """
    if not isinstance(given, Mapping):
        raise InputError(f"{what} must be given by name, such as {example}, not {describe(given)}")
    return given


def place(what: str, given: object, mesh: Mesh, *, held: Bool[np.ndarray, " dim"] | None = None) -> Vector:
    """A place to go for a part of a body [m].

    Args:
        what: its name.
        given: what should be a place.
        mesh: of the body at rest.
        held: along which axes it counts; along all if left out.

    Raises:
        InputError: no place, one of another dimension, not finite, or so far away that it cannot be in metres.
    """
    found = numbers(given)
    if found is None or found.ndim != 1:
        raise InputError(f"{what} must be {mesh.dim} coordinates [m], not {describe(given)}")
    if len(found) != mesh.dim:
        raise InputError(f"{what} has {len(found)} coordinates, the body {mesh.dim} dimensions")
    if not np.isfinite(found).all():
        raise InputError(f"{what} is not finite: {tuple(found.tolist())}")
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    ways = np.maximum(np.maximum(low - found, found - high), 0.0)
    way = float(np.linalg.norm(ways if held is None else ways[held]))
    if way > _FARTHEST * mesh.size:
        raise InputError(f"{what} is {way:.4g} m away from a body of {mesh.size:.3g} m; targets are in metres")
    return found


_LONGEST = 60
"""As many letters of what is given are told."""

_FARTHEST = 100.0
"""Sizes of its body that a target may be away; in millimetres it is a thousand."""
