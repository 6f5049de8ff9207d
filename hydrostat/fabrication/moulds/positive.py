"""The positive of a body in two halves that lie flat, and the frames that hold silicone round them.

One half lies on a board in a frame, its flat side down, with key domes beside it, and silicone is poured over it. That
block is turned over, the domes are taken out, the other half is put on with dowels, the second frame on top, and the
second pour is made: no clay is needed to bed the positive in.
"""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold

from hydrostat.fabrication.moulds.closing import MoldBlock
from hydrostat.fabrication.moulds.openings import Sprue
from hydrostat.fabrication.moulds.solids import join_solids
from hydrostat.fabrication.moulds.split import dowels_across
from hydrostat.fabrication.solids.construct import segments

SILICONE_WALL = 12.0  # silicone round the body [mm]: it keeps its shape and is not wasted


@dataclass(frozen=True, eq=False, kw_only=True)
class Positive:
    """The body to be printed, parted like the mold, in its coordinates."""

    upper: Manifold  # above the parting plane
    lower: Manifold  # below it
    dowels: int  # number of dowels that join the two
    lost: float  # volume of the holes for dowels [mm^3]
    stub: float  # volume of the piece of sprue on it [mm^3]


@dataclass(frozen=True, eq=False, kw_only=True)
class Frames:
    """Frames that hold the silicone, in the coordinates of the mold."""

    lower: Manifold  # round the lower half
    upper: Manifold  # round the upper half
    dome: Manifold  # a key, flat side down; domes lie on the board at the corners
    inside: MoldBlock  # block of silicone with the positive in it
    pours: tuple[float, float]  # volumes of silicone [mm^3], below the parting plane and above it


def make_positive(cavity: Manifold, sprue: Sprue | None) -> Positive:
    """Both halves of what is cast, with the sprue on it, and holes for dowels in their flat sides."""
    whole = _with_sprue(cavity, sprue)
    dowels = dowels_across(whole)
    holes = join_solids(dowels)
    upper, lower = (whole - holes).split_by_plane((0.0, 0.0, 1.0), 0.0)
    return Positive(
        upper=upper,
        lower=lower,
        dowels=len(dowels),
        lost=float((holes ^ whole).volume()),
        stub=0.0 if sprue is None else float((_stub(cavity, sprue) - cavity).volume()),
    )


def _with_sprue(cavity: Manifold, sprue: Sprue | None) -> Manifold:
    """Return the cavity with a stub of the sprue as long as the silicone is thick, where it meets the frame."""
    if sprue is None:
        return cavity
    return cavity + _stub(cavity, sprue)


def _stub(cavity: Manifold, sprue: Sprue) -> Manifold:
    return sprue.solid.trim_by_plane((0.0, -1.0, 0.0), -cavity.bounding_box()[4] - SILICONE_WALL)


def make_frames(cavity: Manifold, sprue: Sprue | None) -> Frames:
    """Two open frames, and how much silicone goes into each."""
    whole = _with_sprue(cavity, sprue)
    low, high = (np.array(corner) for corner in np.reshape(cavity.bounding_box(), (2, 3)))
    least, largest = (tuple(corner.tolist()) for corner in (low - SILICONE_WALL, high + SILICONE_WALL))
    inside = MoldBlock(low=least, high=largest)
    lower, upper = (_ring(inside, *span) for span in ((inside.low[2], 0.0), (0.0, inside.high[2])))
    silicone = inside.solid - whole
    above, below = silicone.split_by_plane((0.0, 0.0, 1.0), 0.0)
    dome = 6.0  # radius of a key dome [mm]
    return Frames(
        lower=lower,
        upper=upper,
        dome=Manifold.sphere(dome, segments(dome)).trim_by_plane((0.0, 0.0, 1.0), 0.0),
        inside=inside,
        pours=(float(below.volume()), float(above.volume())),
    )


def _ring(inside: MoldBlock, low: float, high: float) -> Manifold:
    """A wall round the silicone between two heights."""
    width, length, _ = inside.size
    frame_wall = 5.0  # thickness of a frame [mm]
    outer = Manifold.cube((width + 2 * frame_wall, length + 2 * frame_wall, high - low))
    inner = Manifold.cube((width, length, high - low + 2)).translate((frame_wall, frame_wall, -1.0))
    return (outer - inner).translate((inside.low[0] - frame_wall, inside.low[1] - frame_wall, low))
