"""`Outline`: the closed boundary of a flat body."""

from dataclasses import dataclass

from hydrostat.arrays import Points


@dataclass(frozen=True, eq=False)
class Outline:
    """One outer ring and any holes, as dense polygons.

    Attributes:
        exterior: corners of the outer ring [m], counter-clockwise, first point not repeated.
        holes: corners of each hole [m], clockwise.
    """

    exterior: Points
    holes: tuple[Points, ...] = ()
