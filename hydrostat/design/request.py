"""`DesignRequest`: what a design is asked, and how its method shall work."""

from dataclasses import dataclass

from hydrostat.design.muscles.fibres import FibreKind
from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class RouteOptions:
    """How the search for routes works.

    Raises InputError for a number out of its range.

    Attributes:
        enough: rms error, as a fraction of the body's size, at which nothing more is sought.
        tolerance: rms error of each pose [m] that the fewest winches must reach where their number is left open; a
            hundredth of the body's size if left out.
        spacing: distance between via points, in mean mesh edges.
        hops: most edges of a path that is priced.
        lead_penalty: share of the promised gain that a lead as long as the body costs.
        trials: paths whose networks are solved before one is added.
        starts: networks that are grown, each from another first cable; if left out two for a flat body, one in space.
        exchanges: most cables that are taken out, one at a time, for the best to be put in their place; the last round
            of all cables is followed by another where it gained a fifth.
        steps: of refinement after each cable.
        polish: steps of refinement of a whole network.
        seed: nothing is drawn at random yet; kept with the results.
    """

    enough: float = 1e-4
    tolerance: float | None = None
    spacing: float = 2.0
    hops: int = 14
    lead_penalty: float = 0.3
    trials: int = 4
    starts: int | None = None
    exchanges: int = 12
    steps: int = 5
    polish: int = 60
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least in _LEAST.items():
            value = getattr(self, name)
            if value is None and name in ("starts", "tolerance"):
                continue
            whole = isinstance(least, int)
            if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not value >= least:
                kind = "a whole number" if whole else "a number"
                raise InputError(f"RouteOptions.{name} must be {kind} of {least:g} or more, not {value!r}")

    def starts_for(self, dim: int) -> int:
        """Networks that are grown for a body of so many dimensions."""
        return self.starts if self.starts is not None else {2: 2, 3: 1}[dim]


_LEAST = {
    "enough": 0.0, "tolerance": 0.0, "spacing": 0.5, "hops": 1, "lead_penalty": 0.0, "trials": 1, "starts": 1,
    "exchanges": 0, "steps": 0, "polish": 0, "seed": 0,
}  # fmt: skip
"""Of each option; whole numbers for those that are counts."""


@dataclass(frozen=True, kw_only=True)
class TreeOptions:
    """How winch trees are grown; lengths in units of the mean mesh edge unless said otherwise (M8 to M10).

    Attributes:
        fibres: a muscle on every mesh edge, or one in every element.
        effort: weight of squared tensions in the activation: the larger, the weaker the muscles and the error left.
        stages: steps in which the target is approached.
        thresholds: numbers of candidate fibres to try (R39).
        distances: largest gaps to bridge between two fibres to try (R40).
        growth_steps: most fibres joined to one route (R40).
        turn: sharpest turn of a route [degrees].
        shortest: least length of a route worth a cable.
        phis: weights of the mean against the spread in the score to try (R43, E23).
        shares: most ways to share the cables among the winches to try, the evenest first.
        trials: most networks whose poses are solved (E24).
        loss: how much of the pose error leaving out cables may add, as a fraction.
        lead_penalty: how much the score loses for a lead as long as the body.
    """

    fibres: FibreKind = FibreKind.EDGES
    effort: float = 1e-4
    stages: int = 5
    thresholds: tuple[int, ...] = (20, 40, 60, 80, 120, 160)
    distances: tuple[float, ...] = (0.6, 1.5, 2.5)
    growth_steps: int = 12
    turn: float = 75.0
    shortest: float = 2.5
    phis: tuple[float, ...] = (0.2, 0.5, 0.8)
    shares: int = 12
    trials: int = 64
    loss: float = 0.02
    lead_penalty: float = 0.1
