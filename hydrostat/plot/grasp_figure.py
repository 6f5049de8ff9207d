"""`draw_pull`: force against way of an object that is pulled out of a grasp; `pull_frames`: the same for a film."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from hydrostat.drawing import Color
from hydrostat.grasp import PullCase, PullOut
from hydrostat.plot.chart import plain_axes
from hydrostat.plot.frame import Attachments, Frame
from hydrostat.plot.labels import shorten
from hydrostat.plot.picture_file import figure_pixels
from hydrostat.plot.robot_figures import draw_portrait
from hydrostat.plot.sheet import WIDTH, new_figure
from hydrostat.robot import Robot, rims
from hydrostat.units import MILLIMETERS


def draw_pull(
    robot: Robot, pull: PullOut, cases: Sequence[PullCase] = (), *, title: str | None = None, width: float = WIDTH
) -> Figure:
    """The grasp, where the pull is hardest, and its end; below, the force against its displacement.

    Cases that were tried beside it are thin lines, the one without friction dashed.

    Args:
        robot: without the object.
        pull: result of the pull.
        cases: with one thing changed each.
        title: name of the robot if left out.
        width: figure width [inch].
    """
    hardest = int(np.argmax(pull.forces))
    rows = {"grasped": 0, f"hardest pull, {pull.peak:.3g} N": hardest, pull.status: len(pull.poses) - 1}
    images = _portraits(robot, pull, list(rows.values()))
    side = width / 3
    tall = min(max(image.shape[0] / image.shape[1] for image in images) * 0.94 * side, 3.2)
    figure = new_figure(width, 0.45 + tall + 3.1)
    height = figure.get_figheight()
    figure.text(
        0.1 / width, 1 - 0.22 / height, shorten(robot.name) if title is None else title, color=Color.INK, weight="bold"
    )
    for index, (words, image) in enumerate(zip(rows, images, strict=True)):
        axes = figure.add_axes(((index + 0.03) * side / width, 3.1 / height, 0.94 * side / width, tall / height))
        axes.imshow(image, interpolation="antialiased")
        axes.set_axis_off()
        axes.set_title(words, fontsize=8, color=Color.INK, pad=2, parse_math=False)
    axes = figure.add_axes((0.62 / width, 0.5 / height, (width - 0.82) / width, 2.4 / height))
    plain_axes(axes)
    for case in cases:
        if case.pull is not None:
            dashed = case.name == "no friction"
            (line,) = axes.plot(MILLIMETERS * case.pull.moved, case.pull.forces, linewidth=1.0)
            line.set(color=Color.MUTED if dashed else Color.WINCHES[0], linestyle="--" if dashed else "-", alpha=0.4)
    axes.plot(MILLIMETERS * pull.moved, pull.forces, color=Color.WINCHES[0], linewidth=2.0)
    axes.plot(MILLIMETERS * pull.moved[hardest], pull.peak, "o", color=Color.ERROR, markersize=4)
    axes.axhline(0.0, color=Color.MUTED, linewidth=0.8)
    axes.set_xlabel("displacement of the object [mm]", color=Color.INK, fontsize=8.5)
    axes.set_ylabel("force [N]", color=Color.INK, fontsize=8.5)
    return figure


def pull_frames(pull: PullOut, count: int = 30) -> list[Frame]:
    """Frames of a film of the pull, evenly along it."""
    rows = np.unique(np.linspace(0, len(pull.poses) - 1, count).round().astype(int))
    return [
        Frame.of(
            pull.poses[row],
            words=f"{pull.forces[row]:.2f} N, moved {MILLIMETERS * pull.moved[row]:.0f} mm",
            obstacles=[pull.object_at(int(row))],
        )
        for row in rows
    ]


def _portraits(robot: Robot, pull: PullOut, rows: Sequence[int]) -> list[np.ndarray]:
    """Pictures of some rows, all in one frame, without the border that is empty in all."""
    carried = Attachments(robot)
    shapes = [pull.poses[row].nodes for row in rows]
    obstacles = [pull.object_at(row) for row in rows]
    lines = [rims(obstacle, robot) for obstacle in obstacles]
    beside = [part for nodes in shapes for part in (*carried.cables(nodes), carried.winches(nodes))]
    frame = np.concatenate([*shapes, *beside, *(line for each in lines for line in each)])
    images = []
    portrait = 3.0  # Width at which a portrait is drawn [inch]
    for nodes, obstacle in zip(shapes, obstacles, strict=True):
        figure = draw_portrait(robot, nodes, frame=frame, obstacles=[obstacle], width=portrait)
        images.append(figure_pixels(figure, dpi=220))
    drawn = np.any([image[..., 3] > 0 for image in images], axis=0)
    up, across = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    return [image[up[0] : up[-1] + 1, across[0] : across[-1] + 1] for image in images]
