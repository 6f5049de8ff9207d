"""The top of the report: the robot at rest and in its poses, and how near it comes to them."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.design.network import Network, TreeTrace
from hydrostat.design.score_card import rest_error
from hydrostat.plot.hardware import cable_points, winch_points
from hydrostat.plot.html import Html, tag
from hydrostat.plot.motion import motion_frames, motion_svg
from hydrostat.plot.numbers import millimetres
from hydrostat.plot.picture_file import inline_svg
from hydrostat.plot.places import Spread
from hydrostat.plot.pose_figures import draw_portrait
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.plot.skin import Skin
from hydrostat.robot import Robot
from hydrostat.units import counted

PORTRAIT = 4.6
"""Width of a portrait [inch]."""

MOST_POSES = 5
"""So many poses of a body in space have a portrait."""

HOW = ", by its own winches, in simulation"


def hero(network: Network, title: str) -> Html:
    """Headline, the errors, and portraits at rest and in poses."""
    robot = network.robot
    winches = counted(len(robot.winches), "winch")
    cables = counted(len(robot.cables), "cable")
    poses = counted(len(network.reached), "pose")
    return tag(
        "div",
        tag("p", "hydrostat \N{MIDDLE DOT} design report", class_="eyebrow"),
        tag("h1", title),
        tag("p", f"A soft body, {winches} and {cables}, designed for {poses}. This page tells how they were found, "
            "and how near the robot comes to what was asked."),
        _path(network, f"with {winches} and {cables}"),
        _portraits(network),
        class_="hero",
    )  # fmt: skip


def _path(network: Network, words: str) -> Html:
    """Error at rest, with all muscles, with the network."""
    steps = [_step(rest_error(network), "at rest, nothing pulls")]
    activations = network.trace.activations if isinstance(network.trace, TreeTrace) else ()
    if activations:
        bound = _rms(np.array([activation.rms_error for activation in activations]))
        fibres = len(activations[0].fibres)
        steps.append(_step(bound, f"if each of {fibres} muscle fibres could pull by itself"))
    share = 100 * network.rms_error / network.robot.body.mesh.size
    steps.append(_step(network.rms_error, f"{words}: {share:.1f} % of the body's size", best=True))
    return tag("ol", *steps, class_="path")


def _step(error: float, words: str, *, best: bool = False) -> Html:
    told = f"{MILLIMETRES * error:.1f}" if error >= 1e-3 else millimetres(error)
    number = tag("b", told, tag("small", "mm rms"))
    return tag("li", number, tag("span", words), **({"class_": "best"} if best else {}))


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))


def _portraits(network: Network) -> Html:
    robot = network.robot
    rest = robot.body.mesh.nodes
    frame = _frame(robot, [*(reached.pose.nodes for reached in network.reached), rest])
    still = _portrait(robot, rest, frame, "hero-rest", "At rest")
    shown = network.reached[:1] if rest.shape[1] == 2 else network.reached[:MOST_POSES]
    posed = [
        _portrait(robot, reached.pose.nodes, frame, f"hero-pose-{index}", "In a pose")
        for index, reached in enumerate(shown)
    ]
    names = [reached.wanted.name for reached in shown]
    if rest.shape[1] == 3:
        pictures = [_figure_of(picture, name, HOW) for picture, name in zip(posed, names, strict=True)]
        kind = "grid" if len(pictures) == 1 else "grid small"
        return tag("div", _figure_of(still, "At rest", ", as it is made"), *pictures, class_=kind)
    frames = motion_frames(robot, [reached.pose.contractions for reached in network.reached])
    moving = motion_svg(robot, frames, label="The robot moves from rest into each of its poses and back")
    return tag(
        "div",
        _figure_of(still, "At rest", ", as it is sewn"),
        _figure_of(posed[0], names[0], HOW, class_="still"),
        _figure_of(moving, ", ".join(reached.wanted.name for reached in network.reached), HOW, class_="moving"),
        class_="grid",
    )


def _portrait(robot: Robot, nodes: Nodes, frame: Spread, name: str, label: str) -> Html:
    return Html(inline_svg(draw_portrait(robot, nodes, frame=frame, width=PORTRAIT), name=name, label=label))


def _figure_of(picture: Html, head: str, words: str, **more: str) -> Html:
    return tag("figure", picture, tag("figcaption", tag("b", head), words), **more)


def _frame(robot: Robot, shapes: Sequence[Nodes]) -> Spread:
    """Points that hold all shapes, and in space what stands beside them [m]."""
    if robot.body.mesh.dim == 3:
        outer = robot.body.mesh.boundary_nodes
        beside = [points for nodes in shapes for points in (*cable_points(robot, nodes), winch_points(robot, nodes))]
        return np.concatenate([*(nodes[outer] for nodes in shapes), *beside])
    skin = Skin.of(robot.body)
    return np.concatenate([skin.shape(nodes)[0] for nodes in shapes])
