"""`RouteOptions`: how hard the search for routes works."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class RouteOptions:
    """How the search for routes works.

    Attributes:
        tolerance: rms error, as a fraction of the body's size, at which nothing more is sought.
        spacing: distance between via points, in mean mesh edges.
        seed: of the random choices.
    """

    tolerance: float = 1e-4
    spacing: float = 2.0
    seed: int = 0
