"""`NamedVector`: numbers of winches or cables that can also be looked up by name."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from hydrostat.errors import InputError


class NamedVector(np.ndarray):
    """Array of one axis whose elements have names: `pose.contractions["left"]` as well as `pose.contractions[1]`.

    What is computed from it, copies and parts are arrays without names.

    Attributes:
        names: names of the elements; empty if it has none.
    """

    names: tuple[str, ...]

    def __new__(cls, values: Any, names: Iterable[str]) -> "NamedVector":
        """Return values with names; no data are copied."""
        vector = np.asarray(values).view(cls)
        vector.names = tuple(names)
        return vector

    def __array_finalize__(self, source: object) -> None:
        self.names = ()

    def __array_wrap__(self, array: np.ndarray, context: Any = None, return_scalar: bool = False) -> Any:
        """Return results of arithmetic as plain arrays and numbers."""
        plain = np.asarray(array)
        return plain[()] if return_scalar else plain

    def __getitem__(self, key: Any) -> Any:
        if not isinstance(key, str):
            return np.asarray(self)[key]
        if key not in self.names:
            raise InputError(f'unknown name "{key}". Available: {", ".join(self.names) or "none"}.')
        return float(np.asarray(self)[self.names.index(key)])

    def __reduce__(self) -> tuple[Any, ...]:
        return NamedVector, (np.asarray(self), self.names)

    def to_dict(self) -> dict[str, float]:
        """Return the values by name."""
        return dict(zip(self.names, self.tolist(), strict=True))
