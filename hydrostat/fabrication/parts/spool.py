"""`Spool`: what cables are wound on: a groove for each cable, one above the other on the shaft of a motor."""

import math
from dataclasses import dataclass
from functools import cached_property

from hydrostat.fabrication.parts.motor import Shaft
from hydrostat.fabrication.solids.construct import Construction, Cylinder, Revolve

LAY = 1.25
"""Width that a turn takes over the diameter of the cable: a line that nobody guides does not lie side by side."""

_RIM = 0.8
_SKIN = 0.6  # material outside the hole for the knot, and below it [mm]
SHARED_STEP = 0.5
"""Widths of grooves are multiples of this [mm], so that winches of nearly the same travel share a spool."""

FINE_STEP = 0.05
"""Or of this [mm], less than half a printed layer, where a cable then needs a layer less. Printed in layers of 0.12 mm
such a groove can be up to a layer narrower: six turns of 0.4 mm then lie at 1.2 in place of `LAY`."""


def spool_turns(length: float, radius: float, spare: float) -> float:
    """Turns of a cable of a length [mm] in one layer at a radius [mm], and some that always stay."""
    return length / (2 * math.pi * radius) + spare


def width_for(turns: float, cable: float, step: float = SHARED_STEP) -> float:
    """Width of a groove [mm] for a number of turns of a cable [mm] in one layer, rounded up to multiples of a step."""
    return step * math.ceil((turns * LAY * cable + cable) / step - 1e-9)


def capacity(width: float, radius: float, cable: float, layers: int) -> float:
    """Length of cable [mm] in a number of full layers of a groove of this width [mm].

    A layer has n = (width - cable) / (LAY cable) turns; the first lies at the radius [mm], to the middle of the cable,
    the next each a cable further out: 2 pi n (layers radius + cable layers (layers - 1) / 2).
    """
    turns = max(0.0, (width - cable) / (LAY * cable))
    return 2 * math.pi * turns * (layers * radius + cable * layers * (layers - 1) / 2)


@dataclass(frozen=True, kw_only=True)
class Groove:
    """Place where a cable is wound, or a pair of cables next to each other; lengths in millimeters."""

    radius: float  # radius of the middle of the cable in the first layer [mm]
    width: float  # width of its floor [mm]
    layers: int = 1  # in which the cable lies
    lines: int = 1  # cables that are wound on it
    reverse: bool = False  # True if they are wound the other way round

    def eye(self, cable: float) -> float:
        """Radius of the hole through which its cables, of a diameter [mm], go to their knot [mm]."""
        return cable * math.sqrt(self.lines)


@dataclass(frozen=True, kw_only=True)
class Spool:
    """Grooves on a shaft, the first next to the motor; z counts from its lower face, which lies on the motor's side."""

    grooves: tuple[Groove, ...]  # in the order of the cables
    cable: float  # diameter of the cable [mm]
    shaft: Shaft  # shaft that turns it
    inside: float  # length of the shaft in it [mm]
    play: float  # between shaft and bore, on each side [mm]
    wall: float  # least thickness [mm]
    journal: float  # length of the pin at the far end, which turns in the housing [mm]

    @property
    def pin(self) -> float:
        """Radius of the pin at the far end [mm]."""
        return self.shaft.diameter / 2 + self.play + self.wall

    @property
    def knots(self) -> tuple[float, ...]:
        """Radius of the hole that hides the knot of each groove [mm]."""
        return tuple(2 * groove.eye(self.cable) for groove in self.grooves)

    @cached_property
    def drums(self) -> tuple[float, ...]:
        """Radius of the floor of each groove [mm]."""
        return tuple(groove.radius - self.cable / 2 for groove in self.grooves)

    @cached_property
    def ties(self) -> tuple[float, ...]:
        """Distance of the hole of each knot from the axis [mm], in the flange above its groove."""
        above = (*self.drums[1:], self.pin)
        return tuple(
            max(mine + groove.eye(self.cable) + 0.1, other + knot)
            for mine, groove, other, knot in zip(self.drums, self.grooves, above, self.knots, strict=True)
        )

    @cached_property
    def flanges(self) -> tuple[float, ...]:
        """Radius of each flange [mm]: below the first groove, then above each."""
        own = [drum + (groove.layers + 2) * self.cable for drum, groove in zip(self.drums, self.grooves, strict=True)]
        holes = [tie + knot + _RIM for tie, knot in zip(self.ties, self.knots, strict=True)]
        above = [max(one, other, hole) for one, other, hole in zip(own, (*own[1:], 0.0), holes, strict=True)]
        return own[0], *above

    @cached_property
    def floors(self) -> tuple[float, ...]:
        """Height of the floor of each groove's lower edge [mm]."""
        heights = [self._base]
        for drum, groove, flange in zip(self.drums, self.grooves, self.flanges[1:], strict=True):
            heights.append(heights[-1] + groove.width + (flange - drum) + self.wall / 2)
        return tuple(heights)

    @property
    def middles(self) -> tuple[float, ...]:
        """Height of the middle of each groove [mm]."""
        return tuple(floor + groove.width / 2 for floor, groove in zip(self.floors, self.grooves, strict=False))

    @property
    def body(self) -> float:
        """Height without the pin [mm]."""
        return self.floors[-1]

    @property
    def radius(self) -> float:
        """Radius of its largest flange [mm]."""
        return max(self.flanges)

    @property
    def _base(self) -> float:
        """Thickness of the first flange [mm]: of a wall, or so much that the shaft ends below the top of the pin."""
        tall = sum(
            groove.width + flange - drum + self.wall / 2
            for drum, groove, flange in zip(self.drums, self.grooves, self.flanges[1:], strict=True)
        )
        return max(self.wall, self.inside + 0.2 - tall - self.journal)

    def construction(self) -> Construction:
        """Shape on its lower face; undersides of flanges rise by 45 degrees, so that it prints without support."""
        top = self.body + self.journal
        body: Construction = Revolve(self._profile())
        deep = self.inside + 0.5
        if deep + self.pin > top - 0.4:
            bore = self.shaft.shape(top + 2, self.play).move(0, 0, -1)
        else:
            radius = self.shaft.diameter / 2 + self.play
            cone = Cylinder(deep + radius, radius) & Cylinder(deep + radius, deep + radius, 0.0)
            bore = self.shaft.shape(deep + radius + 1, self.play).move(0, 0, -1) & (
                cone + Cylinder(2, radius).move(0, 0, -1.5)
            )
        body = body - bore
        holes = zip(self.ties, self.knots, self.floors[1:], self.flanges[1:], self.drums, strict=True)
        for tie, knot, floor, flange, drum in holes:
            low = floor - (flange - drum) - self.wall / 2
            sunk = min(3 * self.cable, flange - tie - knot + self.wall / 2 - _SKIN)
            body = body - Cylinder(floor - low + 2, knot / 2).move(tie, 0, low)
            body = body - Cylinder(sunk + 1, knot).move(tie, 0, floor - sunk)
        return body

    def _profile(self) -> tuple[tuple[float, float], ...]:
        """(radius, height) corners, counter-clockwise from the axis."""
        corners = [(0.0, 0.0), (self.flanges[0], 0.0), (self.flanges[0], self.floors[0])]
        for drum, groove, flange, floor, end in zip(
            self.drums, self.grooves, self.flanges[1:], self.floors, self.floors[1:], strict=False
        ):
            top = floor + groove.width
            corners += [(drum, floor), (drum, top), (flange, top + flange - drum), (flange, end)]
        top = self.body + self.journal
        return (*corners, (self.pin, self.body), (self.pin, top), (0.0, top))
