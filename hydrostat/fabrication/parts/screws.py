"""`Screw`: a small screw with a countersunk head that cuts its own thread in a printed part."""

from dataclasses import dataclass

from hydrostat.fabrication.solids.construct import Construction, Cylinder


@dataclass(frozen=True, kw_only=True)
class Screw:
    """A screw with a flat countersunk head; lengths in millimeters."""

    title: str  # title to buy it by
    length: float  # with its head [mm]
    core: float  # diameter within the thread [mm]
    pilot: float  # diameter of the printed hole that it cuts its thread in [mm]
    passage: float  # diameter of the printed hole that it passes freely [mm]
    head: float  # diameter of the head [mm]
    head_height: float  # height of the cone of the head [mm]

    @property
    def envelope(self) -> Construction:
        """The screw without its thread, head at z = 0 and point at z = -length."""
        shank = Cylinder(self.length, self.core / 2).move(0, 0, -self.length)
        head = Cylinder(self.head_height, self.core / 2, self.head / 2).move(0, 0, -self.head_height)
        return shank + head


M2X6 = Screw(
    title="M2 x 6 mm countersunk screw (stopper), self-tapping or machine thread",
    length=6.0,
    core=1.5,
    pilot=1.7,
    passage=2.4,
    head=3.8,
    head_height=1.2,
)
"""Head and core: ISO 7046 (head at most 3.8 mm wide, 1.2 mm high) and ISO 724 (core of M2 x 0.4: 1.51 mm).

The holes are for printed PLA, which comes out narrower than drawn: measured on none, check yours.
"""
