"""`TimeScheme`: time integration as a sequence of minimisations."""

from dataclasses import dataclass
from math import sqrt
from types import MappingProxyType


@dataclass(frozen=True, kw_only=True)
class TimeScheme:
    """Diagonally implicit Runge-Kutta method whose last stage is its end.

    Stage i of a step h of y' = f(y) solves y_i = b_i + h a_ii f(y_i), b_i = y_n + h sum over j < i of a_ij f(y_j). With
    forces that have a potential each stage is a minimisation, like a step of implicit Euler; and as the end of the
    step is itself minimised, no element is inverted there.

    Attributes:
        table: rows a_i0 ... a_ii.
        order: order of convergence in the step length.
    """

    table: tuple[tuple[float, ...], ...]
    order: int


_G = 1 - 1 / sqrt(2)
_H = 0.43586652150845899942

SCHEMES = MappingProxyType(
    {
        "euler": TimeScheme(table=((1.0,),), order=1),
        "sdirk2": TimeScheme(table=((_G,), (1 - _G, _G)), order=2),
        "sdirk3": TimeScheme(
            table=(
                (_H,),
                ((1 - _H) / 2, _H),
                (-1.5 * _H**2 + 4 * _H - 0.25, 1.5 * _H**2 - 5 * _H + 1.25, _H),
            ),
            order=3,
        ),
    }
)
"""By name: implicit Euler, and the L-stable methods of two and three stages (Alexander 1977)."""
