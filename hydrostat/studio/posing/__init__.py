"""Posing: drag points of a body; muscles or cables follow. Begin reading at `poser.py`."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.studio.posing.movers import STRIDE, CableMover, MuscleMover
    from hydrostat.studio.posing.photograph_work import PhotographFit
    from hydrostat.studio.posing.photographs import MAX_BYTES, Photographs
    from hydrostat.studio.posing.pose_state import HeldPoint, Mode, held_of, same_as
    from hydrostat.studio.posing.poser import Poser
    from hydrostat.studio.posing.proposal_work import (
        MusclePulls,
        Proposal,
        ProposalInput,
        Proposer,
        propose_network,
    )

__all__ = [
    "MAX_BYTES",
    "STRIDE",
    "CableMover",
    "HeldPoint",
    "Mode",
    "MuscleMover",
    "MusclePulls",
    "PhotographFit",
    "Photographs",
    "Poser",
    "Proposal",
    "ProposalInput",
    "Proposer",
    "held_of",
    "propose_network",
    "same_as",
]

open_package(__name__)
