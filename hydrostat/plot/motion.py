"""A picture that moves: the robot bends from rest into its poses and back, without any script."""

from collections.abc import Iterable, Sequence

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.drawing import NAMESPACE, Color, Html, path, shape, tag
from hydrostat.plot.frame import Attachments
from hydrostat.plot.hardware import spool_size, stopper_bar
from hydrostat.plot.sheet import Places, frame_points
from hydrostat.plot.skin import FlatSkin
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.units import MILLIMETERS

STEPS = 6  # equilibria from rest to a pose
SCALE = 0.7  # millimeters to a point in this picture: it shows true millimeters, about so large on a page
STEP = 0.16  # time of a step [s]


def motion_frames(robot: Robot, poses: Iterable[Vector], *, steps: int = STEPS) -> list[Nodes]:
    """Solved equilibria from rest to the contractions [m] of each pose and back in turn; it starts and stops gently."""
    simulation = Simulation(robot)
    still = 4  # steps that it rests in a pose, and at rest
    frames: list[Nodes] = [robot.body.mesh.nodes] * still
    for contractions in poses:
        there, solved = [], None
        for step in range(1, steps + 1):
            share = 0.5 - 0.5 * np.cos(np.pi * step / steps)
            solved = simulation.solve(share * contractions, start=solved, strict=False)
            there.append(solved.nodes)
        frames += [*there, *[there[-1]] * still, *there[-2::-1], *[robot.body.mesh.nodes] * still]
    return frames


def motion_svg(robot: Robot, frames: Sequence[Nodes], *, label: str) -> Html:
    """The robot moving through frames [m], `STEP` apart, for ever, as an `<svg>` with a label for who cannot see it.

    Where nothing moves the first frame is shown. A body in space is an InputError.
    """
    skin = FlatSkin.of(robot.body)
    seconds = STEP * (len(frames) - 1)
    shapes = [_outline(skin.shape(nodes)) for nodes in frames]
    seams = [_outline(skin.seam(nodes)) for nodes in frames]
    parts = [
        _moving(shapes, seconds, fill=Color.FELT, stroke=Color.SEAM, stroke_width="1.3"),
        _moving(
            seams, seconds, fill=Color.FELT_LIGHT, stroke=Color.STITCH, stroke_width="1.1", stroke_dasharray="3 2.4"
        ),
        *_marks(robot, frames, seconds),
        *_cables(robot, frames, seconds),
        *_winches(robot, frames, seconds),
    ]
    low, high = frame_points(MILLIMETERS * np.concatenate([skin.shape(nodes)[0] for nodes in frames]), 0.04)
    box = [low[0], -high[1], *(high - low)]
    return tag(
        "svg",
        *parts,
        xmlns=NAMESPACE,
        viewBox=" ".join(f"{value:.1f}" for value in box),
        class_="figure",
        role="img",
        aria_label=label,
    )


def _marks(robot: Robot, frames: Sequence[Nodes], seconds: float) -> list[Html]:
    """Lines drawn on the body, such as eyes and a mouth."""
    look = {"fill": "none", "stroke": Color.INK, "stroke_width": "1.1", "stroke_linecap": "round"}
    return [
        _moving([_outline([anchors.positions(nodes)], closed=False) for nodes in frames], seconds, **look)
        for anchors in robot.body.mark_anchors
    ]


def _cables(robot: Robot, frames: Sequence[Nodes], seconds: float) -> list[Html]:
    colors, runs = Color.of_winches(robot.winches), list(map(Attachments(robot).cables, frames))
    lines = []
    for index, cable in enumerate(robot.cables):
        bars = [_outline([stopper_bar(MILLIMETERS * run[index], SCALE) / MILLIMETERS], closed=False) for run in runs]
        paths = [_outline([run[index]], closed=False) for run in runs]
        for color, width in ((Color.LIGHT, 3.2), (colors[cable.winch], 1.7)):
            look = {"fill": "none", "stroke": color, "stroke_linecap": "round"}
            lines.append(_moving(paths, seconds, stroke_width=f"{width}", **look))
            lines.append(_moving(bars, seconds, stroke_width=f"{width + 0.5}", **look))
    return lines


def _winches(robot: Robot, frames: Sequence[Nodes], seconds: float) -> list[Html]:
    places = [MILLIMETERS * place for place in map(Attachments(robot).winches, frames)]
    spools = []
    for index, (winch, color) in enumerate(zip(robot.winches, Color.of_winches(robot.winches).values(), strict=True)):
        radius = spool_size(winch, SCALE) * SCALE / 2
        discs = [
            shape("circle", r=f"{radius * share:.2f}", fill=fill)
            for share, fill in (
                (1.12, Color.LIGHT),
                (1, color),
                (0.58, Color.mix(color, Color.LIGHT, 0.75)),
                (0.2, color),
            )
        ]
        way = [f"{place[index][0]:.2f} {-place[index][1]:.2f}" for place in places]
        move = _animation("animateTransform", "transform", way, seconds, type="translate")
        spools.append(tag("g", *discs, move, transform=f"translate({way[0]})"))
    return spools


def _moving(paths: Sequence[str], seconds: float, **look: str) -> Html:
    return tag("path", _animation("animate", "d", paths, seconds), d=paths[0], **look)


def _animation(kind: str, attribute: str, values: Sequence[str], seconds: float, **more: str) -> Html:
    time = {"dur": f"{seconds:.2f}s", "repeatCount": "indefinite"}
    return shape(kind, attributeName=attribute, values=";".join(values), **time, **more)


def _outline(lines: Iterable[Places], *, closed: bool = True) -> str:
    """Path data of lines [m], in millimeters with y down."""
    return path((MILLIMETERS * np.asarray(line) * [1, -1] for line in lines), digits=1, closed=closed)
