"""`draw_healing`: a surface as it came beside the body made of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from textwrap import wrap

import numpy as np
from matplotlib.figure import Figure

from hydrostat.arrays import Float, Int, Points
from hydrostat.drawing import Camera, Color, Render, Spots, render
from hydrostat.geometry import Surface, sides_of
from hydrostat.plot.pane import fit_pixel, lay_image
from hydrostat.plot.sheet import TALLEST, WIDTH, PictureSheet, Place, new_sheet, round_step
from hydrostat.units import MILLIMETERS

LINE, HEAD, LETTERS = 11.0, 28.0, 92  # height of a line of notes and of what is above the views [pt]; letters of a line


def draw_healing(
    before: Surface,
    after: Surface,
    *,
    notes: Sequence[str] = (),
    places: Points | None = None,
    title: str = "",
    width: float = WIDTH,
) -> Figure:
    """A surface as it came, and healed, both seen by one eye to one scale.

    On the first view red is what is wrong: the inside, seen through holes or on triangles that are turned over, edges
    that do not belong to two triangles that agree, and rings about the places [m], one where several would meet. Notes
    are lines below the views; width in inches.
    """
    marked = np.zeros((0, 3)) if places is None else np.asarray(places, dtype=float).reshape(-1, 3)
    first, second = _weld(before), _weld(after)
    edges = _bad_edges(first)
    shown = np.concatenate([marked, first.vertices[edges].mean(axis=1)])
    camera = Camera.three_quarter(second.vertices, shown)
    spots, healed, rings = (camera.see(MILLIMETERS * points) for points in (first.vertices, second.vertices, marked))
    lines = _fit_lines([line for note in notes for line in _lines(note, width)], width)
    layout = _lay_out(np.concatenate([spots, healed, rings])[:, :2], lines, width)
    sheet = new_sheet(layout.corners, title=title, width=width, ruled=False, room=0.0)
    image = _both_sides(spots, first.triangles, _pixel(sheet, spots), camera)
    lay_image(sheet, image, layout.shifts[0])
    _draw_edges(sheet, image, spots[edges], layout.shifts[0])
    rings = _apart(rings[:, :2] + layout.shifts[0], 10 * sheet.scale)
    sheet.dots(rings, 13, color="none", markeredgecolor=Color.LIGHT, markeredgewidth=3.2, zorder=20)
    sheet.dots(rings, 13, color="none", markeredgecolor=Color.ERROR, markeredgewidth=1.6, zorder=20.1)
    image = render(healed, second.triangles, pixel=_pixel(sheet, healed), up=camera.sky)
    lay_image(sheet, image, layout.shifts[1])
    _write(sheet, layout, (before, after), lines)
    return sheet.figure


@dataclass(frozen=True, eq=False)
class _PairLayout:
    """Places of views on a sheet."""

    corners: Float[np.ndarray, "2 2"]  # opposite corners of the sheet [mm]
    shifts: tuple[Place, Place]  # what is added to what the camera sees, for each view [mm]
    tops: tuple[Place, Place]  # middle of the upper side of each view [mm]
    foot: Place  # lower left corner of both views [mm]
    point: float  # millimeters that a point (1/72 inch) shows


def _lay_out(view: Float[np.ndarray, "_ 2"], lines: Sequence[str], width: float) -> _PairLayout:
    """Two views side by side, words above them, a scale and lines below."""
    paper = 72 * (width - 0.1)
    low, side = view.min(axis=0), np.ptp(view, axis=0)
    border, below = 14.0, 26.0 + LINE * len(lines)
    point = max(2 * side[0] / (paper - 4 * border), side[1] / (TALLEST * paper - below - HEAD))
    column = point * paper / 2
    foot = np.array([(column - side[0]) / 2, below * point])
    shifts = tuple(foot - low + np.array([number * column, 0.0]) for number in range(2))
    tops = tuple(np.array([(number + 0.5) * column, foot[1] + side[1] + 6 * point]) for number in range(2))
    corners = np.array([[0.0, 0.0], [2 * column, foot[1] + side[1] + HEAD * point]])
    return _PairLayout(corners, (shifts[0], shifts[1]), (tops[0], tops[1]), np.array([border * point, foot[1]]), point)


def _lines(note: str, width: float) -> list[str]:
    return wrap(note, max(int(LETTERS * width / WIDTH), 20), subsequent_indent="   ") or [""]


def _fit_lines(lines: list[str], width: float) -> list[str]:
    """Lines, as many as leave place for the views; the last says how many more there are."""
    most = max(int((0.55 * TALLEST * 72 * (width - 0.1) - 26 - HEAD) / LINE), 1)
    more = len(lines) - most + 1
    return lines if more <= 1 else [*lines[: most - 1], f"... and {more} lines more"]


def _apart(rings: Float[np.ndarray, "_ 2"], gap: float) -> Float[np.ndarray, "_ 2"]:
    """Places without those that are nearer than a gap [mm] to one before."""
    kept: list[Place] = []
    for ring in rings:
        if all(np.linalg.norm(ring - other) > gap for other in kept):
            kept.append(ring)
    return np.array(kept).reshape(-1, 2)


def _weld(surface: Surface) -> Surface:
    """The surface with vertices at one place as one, for shades and edges; triangles without area are left out."""
    low = surface.vertices.min(axis=0)
    weld = 1e-6  # vertices nearer than this, in sizes of the surface, are drawn as one
    cells = np.round((surface.vertices - low) / max(weld * surface.size, 1e-300))
    _, first, names = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    triangles = names.reshape(-1)[surface.triangles]
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return Surface(surface.vertices[first], triangles[real]) if real.any() else surface


def _bad_edges(surface: Surface) -> Int[np.ndarray, "edges 2"]:
    """Edges that are not shared by two triangles which run along them in opposite directions."""
    sides = sides_of(surface.triangles)
    return sides.ends[(sides.counts != 2) | sides.is_misoriented]


def _both_sides(spots: Spots, triangles: Int[np.ndarray, "triangles 3"], pixel: float, camera: Camera) -> Render:
    """A surface with its outside as felt and its inside, where that is nearer, in red."""
    outside = render(spots, triangles, pixel=pixel, up=camera.sky)
    inside = render(spots, triangles[:, ::-1], pixel=pixel, up=camera.sky)
    red = np.array(Color.channels(Color.ERROR)) / 255
    nearer = inside.buffer.depth > outside.buffer.depth
    tinted = inside.colors.copy()
    redness = 0.72  # how red the inside of a surface is drawn where it is seen
    tinted[..., :3] += redness * (red - tinted[..., :3])
    colors = np.where(nearer[..., None], tinted, outside.colors)
    depth = np.maximum(outside.buffer.depth, inside.buffer.depth)
    return Render(colors, replace(outside.buffer, depth=depth))


def _pixel(sheet: PictureSheet, spots: Spots) -> float:
    return fit_pixel(sheet, np.ptp(spots[:, :2], axis=0))


def _draw_edges(sheet: PictureSheet, image: Render, ends: Float[np.ndarray, "edges 2 3"], shift: Place) -> None:
    """Edges as red lines; those behind the surface are left out."""
    if len(ends):
        hidden = image.covers(ends.mean(axis=1)) > 4 * image.buffer.pixel
        sheet.segments(ends[~hidden][..., :2] + shift, color=Color.ERROR, linewidth=1.3, zorder=10)


def _write(sheet: PictureSheet, layout: _PairLayout, surfaces: tuple[Surface, Surface], lines: Sequence[str]) -> None:
    for words, surface, top in zip(("as it came", "healed"), surfaces, layout.tops, strict=True):
        count = f"{len(surface.triangles):,} triangles".replace(",", "\N{NARROW NO-BREAK SPACE}")
        sheet.text((top[0], top[1] + 11 * layout.point), words, fontsize=9, color=Color.INK, weight="bold", ha="center")
        sheet.text((top[0], top[1]), count, fontsize=7.5, color=Color.MUTED, ha="center")
    length = round_step(4 * 60 * layout.point)
    x, y = layout.foot[0], layout.foot[1] - 20 * layout.point
    sheet.curve(np.array([[x, y], [x + length, y]]), color=Color.INK, linewidth=1.6, solid_capstyle="butt", zorder=12)
    words = f"{length:g} mm"
    sheet.text((x + length + 5 * layout.point, y), words, fontsize=7, color=Color.INK, va="center", zorder=12)
    for number, line in enumerate(lines):
        at = (x, y - (number + 1.1) * LINE * layout.point)
        sheet.text(at, line, fontsize=7.5, color=Color.INK, va="center")
