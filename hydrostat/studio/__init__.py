"""The studio: pose a robot by hand, watch it design itself, drive it, take it home. Begin reading at `session.py`."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.studio.bell import Bell
    from hydrostat.studio.designing.run import wished_request
    from hydrostat.studio.document import Document
    from hydrostat.studio.face.rooms import Rooms
    from hydrostat.studio.face.serve import serve
    from hydrostat.studio.jobs import Jobs
    from hydrostat.studio.posing.cable_mover import STRIDE, CableMover
    from hydrostat.studio.posing.held import HeldPoint, Mode
    from hydrostat.studio.posing.mover import MuscleMover
    from hydrostat.studio.posing.poser import Poser
    from hydrostat.studio.posing.poses import held_of
    from hydrostat.studio.posing.propose_work import ProposalInput, propose_network
    from hydrostat.studio.session import Session
    from hydrostat.studio.stage import Hit
    from hydrostat.studio.starting.shelf import state_folder

__all__ = [
    "STRIDE",
    "Bell",
    "CableMover",
    "Document",
    "HeldPoint",
    "Hit",
    "Jobs",
    "Mode",
    "MuscleMover",
    "Poser",
    "ProposalInput",
    "Rooms",
    "Session",
    "held_of",
    "propose_network",
    "serve",
    "state_folder",
    "wished_request",
]

open_package(__name__)
