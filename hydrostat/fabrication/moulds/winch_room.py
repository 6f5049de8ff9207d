"""`WinchRoom`: the box round a winch that sits in the body, about its shaft."""

from dataclasses import dataclass

Sides = tuple[float, float, float]
"""Lengths along three axes [mm]."""


@dataclass(frozen=True, kw_only=True)
class WinchRoom:
    """What a winch takes up; lengths in millimetres.

    Attributes:
        low: least corner of the box round it, its shaft along z through the origin.
        high: largest corner of that box.
    """

    low: Sides
    high: Sides

    @classmethod
    def about_the_middle(cls, sides: Sides) -> "WinchRoom":
        """A box whose shaft is in its middle."""
        a, b, c = (side / 2 for side in sides)
        return cls(low=(-a, -b, -c), high=(a, b, c))

    @property
    def sides(self) -> Sides:
        """Of the box [mm]."""
        (a, b, c), (x, y, z) = self.low, self.high
        return x - a, y - b, z - c

    @property
    def off(self) -> Sides:
        """From the winch's place to the middle of the box [mm]: across the shaft only.

        Along the shaft the middle of the box is at the winch's place: the foam gives a cable that little way.
        """
        return (self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2, 0.0
