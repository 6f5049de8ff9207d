"""The studio: pose a robot by hand, watch it design itself, drive it, take it home. Begin reading at `session.py`."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.studio.bell import Bell
    from hydrostat.studio.designing.run import wished_request
    from hydrostat.studio.document import Document
    from hydrostat.studio.exporting.kit_work import page_pictures
    from hydrostat.studio.face.class_code import find_code_date, forget_code
    from hydrostat.studio.face.classroom import Classroom
    from hydrostat.studio.face.rooms import Rooms
    from hydrostat.studio.face.serve import serve
    from hydrostat.studio.face.share import Links, find_network_address, write_qr_text
    from hydrostat.studio.jobs import Jobs
    from hydrostat.studio.posing import (
        STRIDE,
        CableMover,
        HeldPoint,
        Mode,
        MuscleMover,
        MusclePulls,
        Poser,
        ProposalInput,
        Proposer,
        held_of,
    )
    from hydrostat.studio.robot_link import LINK_MARK
    from hydrostat.studio.session import Session
    from hydrostat.studio.stage import Hit
    from hydrostat.studio.starting.shelf import state_folder

__all__ = [
    "LINK_MARK",
    "STRIDE",
    "Bell",
    "CableMover",
    "Classroom",
    "Document",
    "HeldPoint",
    "Hit",
    "Jobs",
    "Links",
    "Mode",
    "MuscleMover",
    "MusclePulls",
    "Poser",
    "ProposalInput",
    "Proposer",
    "Rooms",
    "Session",
    "find_code_date",
    "find_network_address",
    "forget_code",
    "held_of",
    "page_pictures",
    "serve",
    "state_folder",
    "wished_request",
    "write_qr_text",
]

open_package(__name__)
