"""`draw_sheet`: many robots on one picture."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from hydrostat.arrays import Nodes
from hydrostat.errors import InputError
from hydrostat.plot.labels import shorten
from hydrostat.plot.palette import INK, MUTED, PAPER
from hydrostat.plot.picture_file import drawing
from hydrostat.plot.pose_figures import draw_portrait
from hydrostat.robot import Robot
from hydrostat.units import counted

CELL, FOOT = 2.2, 0.42
"""Side of a portrait, and height of the words below it [inch]."""

PORTRAIT, DPI = 4.2, 110
"""Width for which a portrait is drawn [inch], larger than its cell so that its lines are finer, and pixels to an
inch."""


def draw_sheet(robots: Sequence[tuple[str, Robot, Float[np.ndarray, "_ _"]]], *, columns: int | None = None) -> Figure:
    """A contact sheet: a portrait of each robot, its title, and how many nodes, elements and winches it has.

    Args:
        robots: title, robot and where its nodes are [m].
        columns: portraits side by side; so many that the sheet is a little wider than tall if left out.

    Raises:
        InputError: there is no robot, or no column.
    """
    if not robots or (columns is not None and columns < 1):
        raise InputError("a contact sheet needs at least one robot and one column")
    across = columns or int(np.ceil(np.sqrt(1.2 * len(robots))))
    down = -(-len(robots) // across)
    width, height = across * CELL, down * (CELL + FOOT)
    figure = Figure(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    for index, (title, robot, nodes) in enumerate(robots):
        left, top = index % across * CELL, height - index // across * (CELL + FOOT)
        axes = figure.add_axes(((left + 0.08) / width, (top - CELL) / height, (CELL - 0.16) / width, CELL / height))
        axes.imshow(_portrait(robot, nodes), interpolation="antialiased")
        axes.set_axis_off()
        middle = (left + CELL / 2) / width
        for words, drop, size, colour, weight in (
            (shorten(title), 0.1, 8.5, INK, "bold"),
            (_caption(robot), 0.25, 6.5, MUTED, "normal"),
        ):
            figure.text(
                middle, (top - CELL - drop) / height, words, fontsize=size, color=colour, weight=weight, ha="center",
                va="center", parse_math=False,
            )  # fmt: skip
    return figure


def _portrait(robot: Robot, nodes: Nodes) -> np.ndarray:
    """Pixels of a portrait on a square of paper."""
    figure = draw_portrait(robot, nodes, width=PORTRAIT)
    figure.set_facecolor(PAPER)
    figure.set_dpi(DPI)
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    with drawing():
        canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    side = max(pixels.shape[:2])
    high, wide = (side - length for length in pixels.shape[:2])
    return np.pad(pixels, ((high // 2, high - high // 2), (wide // 2, wide - wide // 2), (0, 0)), constant_values=255)


def _caption(robot: Robot) -> str:
    mesh = robot.body.mesh
    parts = [f"{len(mesh.nodes)} nodes", f"{len(mesh.elements)} elements"]
    if robot.winches:
        parts.append(counted(len(robot.winches), "winch"))
    return ", ".join(parts)
