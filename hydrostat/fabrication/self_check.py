"""`Check`: one line of the table that says whether a kit is true to the robot that was simulated."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Check:
    """A claim that was measured on the finished drawing or solid, not on what it was made from.

    Attributes:
        what: the claim, such as "pinholes are where the cables pass".
        measured: what was found, with its unit, such as "at most 0.004 mm off".
        allowed: such as "0.1 mm".
        passed: whether it holds.
    """

    what: str
    measured: str
    allowed: str
    passed: bool
