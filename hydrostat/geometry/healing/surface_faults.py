"""What is wrong with a surface, in words; and the pieces that do not become a part of the body."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from hydrostat.geometry.healing.crossings import MOST_PAIRS
from hydrostat.geometry.healing.holes import Holes
from hydrostat.geometry.healing.shells import Role, Shells
from hydrostat.geometry.healing.sides import sides_of
from hydrostat.geometry.healing.weld import Welded
from hydrostat.geometry.surface import Surface
from hydrostat.units import counted

SLIVER = 1e-3
"""A triangle lower than this share of its longest side is a sliver."""


@dataclass(frozen=True)
class Piece:
    """A part of the input that is not in the healed surface.

    Attributes:
        size: longest side of its box [m].
        place: middle of its box [m].
        triangles: how many it had.
        why: what it was.
    """

    size: float
    place: tuple[float, float, float]
    triangles: int
    why: str

    @classmethod
    def of(cls, surface: Surface, triangles: Int[np.ndarray, " some"], why: str) -> "Piece":
        """Some triangles of a surface as a piece."""
        corners = surface.vertices[surface.triangles[triangles]].reshape(-1, 3)
        return cls.of_box(np.stack([corners.min(axis=0), corners.max(axis=0)]), len(triangles), why)

    @classmethod
    def of_box(cls, box: np.ndarray, triangles: int, why: str) -> "Piece":
        """A piece by its lowest and highest coordinates [m]."""
        x, y, z = box.mean(axis=0).tolist()
        return cls(float(np.ptp(box, axis=0).max()), (x, y, z), triangles, why)

    @property
    def text(self) -> str:
        """The piece in words."""
        x, y, z = (f"{round(1e3 * coordinate, 2) + 0.0:g}" for coordinate in self.place)
        triangles = counted(self.triangles, "triangle")
        return f"{self.why}, {1e3 * self.size:.3g} mm in size at ({x}, {y}, {z}) mm, {triangles}"


def pieces_of(shells: Shells) -> tuple[Piece, ...]:
    """The parts of a surface that are neither body nor cavity."""
    counts = np.bincount(shells.label)
    return tuple(
        Piece.of_box(shells.boxes[part], int(counts[part]), role.value)
        for part, role in enumerate(shells.roles)
        if role in (Role.WITHIN, Role.SPECK)
    )


def sliver_count(surface: Surface) -> int:
    """How many triangles are slivers."""
    corners = surface.vertices[surface.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    return int((np.linalg.norm(surface.crosses, axis=1) < SLIVER * longest**2).sum())


def told(
    welded: Welded,
    surface: Surface,
    holes: Holes,
    flipped: int,
    crossing: Int[np.ndarray, "pairs 2"],
    shells: Shells,
    slivers: int,
) -> tuple[str, ...]:
    """What was found in a surface, a line each.

    Args:
        welded: how its vertices and triangles were joined.
        surface: the same turned one way, with its holes.
        holes: of it.
        flipped: triangles that looked another way than most of their patch.
        crossing: pairs of triangles that cross.
        shells: its parts.
        slivers: how many there are.
    """
    sides = sides_of(surface.triangles)
    longest = 1e3 * holes.length.max(initial=0.0)
    roles = shells.roles
    most = "at least " if len(crossing) >= MOST_PAIRS else ""
    lines = (
        (welded.merged, counted(welded.merged, "corner") + " in the place of another"),
        (welded.flat, counted(welded.flat, "triangle") + " without an area"),
        (welded.repeated, counted(welded.repeated, "triangle") + " that stand there twice"),
        (welded.walls, counted(welded.walls, "triangle") + " back to back in walls inside"),
        (len(holes), f"{counted(len(holes), 'hole')}, the longest {longest:.3g} mm around"),
        (sides.crowded.sum(), counted(int(sides.crowded.sum()), "edge") + " with more than two triangles"),
        (flipped, counted(flipped, "flipped triangle")),
        (sides.twisted.sum(), counted(int(sides.twisted.sum()), "edge") + " where inside and outside change sides"),
        (shells.inside_out.sum(), counted(int(shells.inside_out.sum()), "part") + " inside out"),
        (len(crossing), f"{most}{counted(len(crossing), 'pair')} of triangles that run through each other"),
        (len(roles) > 1, f"{len(roles)} parts that are not joined"),
        (roles.count(Role.CAVITY), counted(roles.count(Role.CAVITY), "pocket") + " of air inside, clean and thus kept"),
        (slivers, counted(slivers, "sliver")),
    )
    return tuple(text for count, text in lines if count)
