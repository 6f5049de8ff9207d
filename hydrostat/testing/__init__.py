"""Conformance checks for your own energies and objectives; our tests use the same checks."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.testing.check_energy import check_energy
    from hydrostat.testing.check_objective import check_objective
    from hydrostat.testing.differences import ConformanceError, central_differences

__all__ = [
    "ConformanceError",
    "central_differences",
    "check_energy",
    "check_objective",
]

open_package(__name__)
