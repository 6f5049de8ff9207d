"""What tells directions and sizes in space: axes, a scale bar and the rules of a view along an axis."""

import numpy as np

from hydrostat.drawing.camera import Camera
from hydrostat.drawing.palette import GRID, INK, MUTED
from hydrostat.plot.places import Place
from hydrostat.plot.sheet import Sheet, round_step

ARM = 15.0
"""Length of an axis of the compass [pt]."""


SIDES = np.array([112.0, 38.0])
"""Room that compass and bar take [pt]."""


def draw_compass(sheet: Sheet, camera: Camera, low: Place) -> None:
    """x, y and z as arrows, and beside them a bar of round length; `low` is the lower left corner of both [mm]."""
    point = sheet.scale
    ways = camera.axes[:2].T * ARM * point
    middle = low + np.array([9.0, 9.0]) * point - np.minimum(ways.min(axis=0), 0.0)
    for way, name in zip(ways, "xyz", strict=True):
        if np.linalg.norm(way) > 3 * point:
            end = middle + way
            sheet.curve(np.array([middle, end]), color=MUTED, linewidth=1.0, zorder=12)
            letter = end + way / np.linalg.norm(way) * 5 * point
            sheet.text((letter[0], letter[1]), name, fontsize=7, color=MUTED, ha="center", va="center", zorder=12)
    length = round_step(4 * 55 * point)
    left = low + np.array([24.0 + 2 * ARM, 8.0]) * point
    bar = np.array([left, left + np.array([length, 0.0])])
    sheet.curve(bar, color=INK, linewidth=1.6, solid_capstyle="butt", zorder=12)
    words = left + np.array([length / 2, 4 * point])
    sheet.text((words[0], words[1]), f"{length:g} mm", fontsize=7, color=INK, ha="center", va="bottom", zorder=12)


def draw_rules(sheet: Sheet, camera: Camera, low: Place, high: Place, origin: Place) -> None:
    """Grid lines at round millimetres behind a view along an axis, numbered on its left and lower side.

    Args:
        sheet: to draw on.
        camera: along an axis.
        low: lower left corner of the view on the sheet [mm].
        high: its upper right corner [mm].
        origin: what the camera sees at the lower left corner [mm].
    """
    step = max(round_step(float((high - low).max())), round_step(4 * 24 * sheet.scale))
    for side in range(2):
        axis = int(np.argmax(np.abs(camera.axes[side])))
        sign = float(np.sign(camera.axes[side, axis]))
        ends = np.array([origin[side], origin[side] + high[side] - low[side]])
        for mark in np.arange(np.ceil(ends[0] / step), np.floor(ends[1] / step) + 1) * step:
            start = np.array([low[0] - 3 * sheet.scale, low[1] - 3 * sheet.scale])
            start[side] = low[side] + mark - origin[side]
            end = high + 3 * sheet.scale
            end[side] = start[side]
            sheet.curve(np.array([start, end]), color=GRID, linewidth=0.6, zorder=1)
            words = f"{sign * mark + 0.0:.10g}".replace("-", "\N{MINUS SIGN}")
            look = {"ha": "center", "va": "top"} if side == 0 else {"ha": "right", "va": "center"}
            spot = start - np.array([0.0, 2.0] if side == 0 else [2.0, 0.0]) * sheet.scale
            sheet.text((spot[0], spot[1]), words, fontsize=6.5, color=MUTED, **look)
        name = f"{'xyz'[axis]} [mm]"
        corner = np.array([high[0], low[1] - 11 * sheet.scale]) if side == 0 else np.array([low[0], high[1]])
        corner += np.array([0.0, 0.0] if side == 0 else [-4.0, 4.0]) * sheet.scale
        sheet.text(
            (corner[0], corner[1]), name, fontsize=6.5, color=MUTED, ha="right" if side == 0 else "center",
            va="top" if side == 0 else "bottom",
        )  # fmt: skip
