"""`Drawing`: what a flat file holds, an outline, and what was left out of it."""

from dataclasses import dataclass

from hydrostat.geometry.files.page import Page
from hydrostat.geometry.outline import Outline


@dataclass(frozen=True, eq=False)
class Drawing:
    """The outline of a drawing or picture, and in words what was done to get it.

    Attributes:
        outline: the body [m].
        page: what the drawing's own coordinates mean.
        notes: one line for each thing that was ignored, filled or mended; empty if there was nothing.
    """

    outline: Outline
    page: Page
    notes: tuple[str, ...] = ()
