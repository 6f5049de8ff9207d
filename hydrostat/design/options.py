"""`DesignOptions`: every number that steers the design of a network."""

from dataclasses import dataclass
from enum import StrEnum


class FibreKind(StrEnum):
    """Where the candidate muscles are (E21)."""

    EDGES = "edges"
    ELEMENTS = "elements"


@dataclass(frozen=True, kw_only=True)
class DesignOptions:
    """How a network is designed; lengths in units of the mean mesh edge unless said otherwise (M8 to M10).

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
        tension: largest tension [N] that a cable should bear: on a spool of 6 mm that asks a motor for 0.12 N m.
        loss: how much of the pose error leaving out cables may add, as a fraction.
        lead_penalty: how much the score loses for a lead as long as the body.
        sheathed_leads: whether leads from a winch to where its cables begin to pull run in sheaths (R14).
        clearance: least distance of a cable from the edge of the body [m].
        winch_clearance: least distance of a winch from the edge of the body [m].
        winch_gap: least distance between two winches [m].
        hole_gap: least distance between two holes through which cables pass the cloth [m].
        bend: sharpest turn of a finished cable, where its lead joins its route included [degrees].
        travel: travel of the winches [m].
        release: release of the winches [m].
        spool_radius: of the winches [m].
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
    tension: float = 20.0
    loss: float = 0.02
    lead_penalty: float = 0.1
    sheathed_leads: bool = True
    clearance: float = 0.005
    winch_clearance: float = 0.012
    winch_gap: float = 0.025
    hole_gap: float = 0.004
    bend: float = 90.0
    travel: float = 0.06
    release: float = 0.0
    spool_radius: float = 0.006
