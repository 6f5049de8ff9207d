"""`TreeOptions`: every number that steers the thesis's way to a network."""

from dataclasses import dataclass

from hydrostat.design.muscles.fibres import FibreKind


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
