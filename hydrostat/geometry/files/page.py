"""`Drawing`: the outline in a flat file; `Page`: what its own coordinates mean, so that another can be laid over it."""

from dataclasses import dataclass

import numpy as np

from hydrostat.errors import OutlineError
from hydrostat.geometry.outline import Outline, Ring


@dataclass(frozen=True)
class Page:
    """A place drawn at d lies at (d - origin) x scale [m] (docs/decisions/0001-coordinates.md)."""

    kind: str  # what two drawings must have in common to be on one page, in words
    origin: tuple[float, float]  # what lies at the origin of the body, in the drawing's units
    scale: tuple[float, float]  # length of one unit along x and y [m], y negative where the drawing counts it downwards

    def places(self, ring: Ring) -> Ring:
        """Places [m] of the points of a drawing."""
        return (ring - np.array(self.origin)) * np.array(self.scale)

    def check(self, kind: str, name: str) -> None:
        """Refuse a drawing that cannot lie on this page.

        An SVG drawing says its unit and its page, a DXF drawing its unit only, a picture its pixels only. So a DXF
        drawing that was moved as a whole, by a program that counts from a corner of the page, is not noticed; nor is a
        picture that was cut to the same number of pixels elsewhere. Raises OutlineError: it is of another kind, so the
        same numbers mean other places.
        """
        if kind != self.kind:
            raise OutlineError(
                f"{name}: is {kind}, the drawing that it should lie on is {self.kind}: begin with a copy of that one, "
                "and save it with the same page"
            )


def page_about(body: Ring, kind: str, unit: tuple[float, float], size: float | None) -> Page:
    """The page whose origin is the middle of the box of an outer ring in the drawing's units.

    One of its units is so long along x and y [m], y negative where the drawing counts it downwards, unless the longest
    side of the box is to be `size` [m].
    """
    low, high = body.min(axis=0), body.max(axis=0)
    scale = np.array(unit)
    if size is not None:
        scale = scale * size / float(((high - low) * np.abs(scale)).max())
    x, y = 0.5 * (low + high)
    return Page(kind, (float(x), float(y)), (float(scale[0]), float(scale[1])))


@dataclass(frozen=True, eq=False)
class Drawing:
    """The outline of a drawing or picture, and in words what was done to get it."""

    outline: Outline  # the body [m]
    page: Page  # what the drawing's own coordinates mean
    # one line for each thing that was ignored, filled or mended; empty if there was nothing
    notes: tuple[str, ...] = ()
