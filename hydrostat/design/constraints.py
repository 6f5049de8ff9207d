"""`Constraints`: what makes a network one that can be built."""

from dataclasses import dataclass

from hydrostat.design.zone import Zone
from hydrostat.robot import Mount


@dataclass(frozen=True, kw_only=True)
class Constraints:
    """Limits that every returned network keeps (R12, R14, R44); lengths in metres, at rest.

    Attributes:
        winch_zones: winches stand in one of these only; anywhere in the body if there is none.
        keep_out: no cable passes here.
        still: cables run in sheaths here, so that they move nothing (R14).
        mount: winches in the body, or beside it; None: as the robot's own winches are, in the body if it has none.
            Winches in the world stand at places of the robot's own winches.
        cables_per_winch: most cables of one winch (R44).
        clearance: least distance of a cable from the edge of the body.
        winch_clearance: least distance of a winch in the body from its edge.
        winch_gap: least distance between two winches.
        hole_gap: least distance between two holes through which cables pass the cloth.
        turn: largest turn of a cable at a via point [degrees].
        bend_radius: least radius of the arc that fits a turn between the middles of its two segments.
        longest: greatest length of a cable from winch to stopper; None: any.
        tension: the most that a cable bears [N].
        torque: the most that the motor of a winch gives [N m]; None: as much as the tensions ask.
        travel: the most that a winch takes in.
        release: the most that a winch lets out.
        spool_radius: of the winches.
        slack: the most that a stopper may leave loose (E12).
        spool_ratio: most times by which a cable's own spool may be larger or smaller than its winch's; 1: none may.
        leads: whether a cable may run in a sheath from its winch to where bending should begin (R14).
        mirror: axis whose sign a left-right symmetric network does not feel: "x", "y" or "z"; None: no symmetry.
        locked_winches: names of the robot's own winches that stay.
        locked_cables: numbers of the robot's own cables that stay as they are, and their winches with them.
    """

    winch_zones: tuple[Zone, ...] = ()
    keep_out: tuple[Zone, ...] = ()
    still: tuple[Zone, ...] = ()
    mount: Mount | None = None
    cables_per_winch: int = 6
    clearance: float = 0.005
    winch_clearance: float = 0.012
    winch_gap: float = 0.025
    hole_gap: float = 0.004
    turn: float = 75.0
    bend_radius: float = 0.0
    longest: float | None = None
    tension: float = 20.0
    torque: float | None = None
    travel: float = 0.06
    release: float = 0.0
    spool_radius: float = 0.006
    slack: float = 0.0
    spool_ratio: float = 1.0
    leads: bool = True
    mirror: str | None = None
    locked_winches: tuple[str, ...] = ()
    locked_cables: tuple[int, ...] = ()
