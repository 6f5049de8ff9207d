"""The top of the report: the robot at rest and in its poses, and how near it comes to them."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.design.network import Network, TreeTrace
from hydrostat.design.score_card import rest_error
from hydrostat.plot.html import Html, tag
from hydrostat.plot.motion import motion_frames, motion_svg
from hydrostat.plot.picture_file import inline_svg
from hydrostat.plot.places import Spread
from hydrostat.plot.pose_figures import draw_portrait
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.plot.skin import Skin
from hydrostat.robot import Robot
from hydrostat.units import counted

PORTRAIT = 4.6
"""Width of a portrait [inch]."""

HOW = ", by its own winches, in simulation"


def hero(network: Network, title: str) -> Html:
    """Headline, the three errors, and portraits at rest and in the first pose."""
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
    number = tag("b", f"{MILLIMETRES * error:.{1 if error >= 1e-3 else 2}f}", tag("small", "mm rms"))
    return tag("li", number, tag("span", words), **({"class_": "best"} if best else {}))


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))


def _portraits(network: Network) -> Html:
    robot, first = network.robot, network.reached[0]
    rest = robot.body.mesh.nodes
    frame = _frame(robot, [*(reached.pose.nodes for reached in network.reached), rest])
    still, posed = (
        Html(inline_svg(draw_portrait(robot, nodes, frame=frame, width=PORTRAIT), name=name, label=label))
        for nodes, name, label in ((rest, "hero-rest", "At rest"), (first.pose.nodes, "hero-pose", "In a pose"))
    )
    if rest.shape[1] == 3:
        return tag("div", _figure_of(still, "At rest", ", as it is made"), _figure_of(posed, first.wanted.name, HOW),
            class_="grid")  # fmt: skip
    frames = motion_frames(robot, [reached.pose.contractions for reached in network.reached])
    moving = motion_svg(robot, frames, label="The robot moves from rest into each of its poses and back")
    names = ", ".join(reached.wanted.name for reached in network.reached)
    return tag(
        "div",
        _figure_of(still, "At rest", ", as it is sewn"),
        _figure_of(posed, first.wanted.name, HOW, class_="still"),
        _figure_of(moving, names, HOW, class_="moving"),
        class_="grid",
    )


def _figure_of(picture: Html, head: str, words: str, **more: str) -> Html:
    return tag("figure", picture, tag("figcaption", tag("b", head), words), **more)


def _frame(robot: Robot, shapes: Sequence[Nodes]) -> Spread:
    """Points that hold all shapes [m]."""
    if robot.body.mesh.dim == 3:
        outer = robot.body.mesh.boundary_nodes
        return np.concatenate([nodes[outer] for nodes in shapes])
    skin = Skin.of(robot.body)
    return np.concatenate([skin.shape(nodes)[0] for nodes in shapes])
