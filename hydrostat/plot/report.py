"""`write_report`: the whole story of a design on one page that needs no other file and no network."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.design import Network, TreeTrace
from hydrostat.drawing import Html, tag
from hydrostat.errors import InputError
from hydrostat.plot.frame import Attachments
from hydrostat.plot.motion import motion_frames, motion_svg
from hydrostat.plot.picture_file import inline_svg
from hydrostat.plot.report_chapters import chapters
from hydrostat.plot.report_tables import add_caption, fact, footer, millimeters, page
from hydrostat.plot.robot_figures import draw_portrait
from hydrostat.plot.sheet import Spread
from hydrostat.plot.skin import outer_points
from hydrostat.robot import Robot
from hydrostat.units import MILLIMETERS, plural


def write_report(
    network: Network, path: str | Path, *, title: str | None = None, facts: Mapping[str, object] | None = None
) -> Path:
    """Write the report of a design as one HTML file; returns its path (InputError: no pose of the network was tried).

    The title is the robot's name if left out; facts are more lines for the end, such as options and seed.
    """
    from hydrostat.files import replace_file

    return replace_file(Path(path), report_text(network, title=title, facts=facts).encode(errors="replace"))


def report_text(network: Network, *, title: str | None = None, facts: Mapping[str, object] | None = None) -> str:
    """The report as text; see `write_report`."""
    if not network.ik_results:
        raise InputError("a report needs at least one pose that the network was tried on; this one has none")
    name = title or network.robot.name
    return page(name, _hero(network, name), *chapters(network), footer(network, facts or {}))


HOW = ", by its own winches, in simulation"


def _hero(network: Network, title: str) -> Html:
    """Headline, the errors, and portraits at rest and in poses."""
    robot = network.robot
    winches = plural(len(robot.winches), "winch")
    cables = plural(len(robot.cables), "cable")
    poses = plural(len(network.ik_results), "pose")
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
    steps = [_error_fact(network.rest_error, "at rest, nothing pulls")]
    activations = network.trace.activations if isinstance(network.trace, TreeTrace) else ()
    if activations:
        bound = float(np.sqrt(np.mean(np.array([activation.rms_error for activation in activations]) ** 2)))
        fibres = len(activations[0].fibres)
        steps.append(_error_fact(bound, f"if each of {fibres} muscle fibres could pull by itself"))
    share = 100 * network.rms_error / network.robot.body.mesh.size
    steps.append(_error_fact(network.rms_error, f"{words}, in the model: {share:.1f} % of the body's size"))
    steps.append(
        _error_fact(network.expected_error, "to be expected once it is built: sewing, friction, stiffness", best=True)
    )
    return tag("ol", *steps, class_="path")


def _error_fact(error: float, words: str, *, best: bool = False) -> Html:
    """An error [m] as a large number."""
    number = f"{MILLIMETERS * error:.1f}" if error >= 1e-3 else millimeters(error)
    return fact(number, "mm rms", words, best=best)


def _portraits(network: Network) -> Html:
    robot = network.robot
    rest = robot.body.mesh.nodes
    poses = [reached.pose.nodes for reached in network.ik_results]
    outer = outer_points(robot.body, [*poses, rest])
    carried = Attachments(robot)
    beside = [part for nodes in (*poses, rest) for part in (*carried.cables(nodes), carried.winches(nodes))]
    frame = np.concatenate(outer if rest.shape[1] == 2 else [*outer, *beside])
    still = _portrait(robot, rest, frame, "hero-rest", "At rest")
    most_poses = 5  # so many poses of a body in space have a portrait
    shown = network.ik_results[:1] if rest.shape[1] == 2 else network.ik_results[:most_poses]
    posed = [
        _portrait(robot, reached.pose.nodes, frame, f"hero-pose-{index}", "In a pose")
        for index, reached in enumerate(shown)
    ]
    names = [reached.pose_target.name for reached in shown]
    if rest.shape[1] == 3:
        pictures = [add_caption(picture, name, HOW) for picture, name in zip(posed, names, strict=True)]
        kind = "grid" if len(pictures) == 1 else "grid small"
        return tag("div", add_caption(still, "At rest", ", as it is made"), *pictures, class_=kind)
    frames = motion_frames(robot, [reached.pose.contractions for reached in network.ik_results])
    moving = motion_svg(robot, frames, label="The robot moves from rest into each of its poses and back")
    return tag(
        "div",
        add_caption(still, "At rest", ", as it is sewn"),
        add_caption(posed[0], names[0], HOW, kind="still"),
        add_caption(moving, ", ".join(reached.pose_target.name for reached in network.ik_results), HOW, kind="moving"),
        class_="grid",
    )


def _portrait(robot: Robot, nodes: Nodes, frame: Spread, name: str, label: str) -> Html:
    portrait = 4.6  # width of a portrait [inch]
    return Html(inline_svg(draw_portrait(robot, nodes, frame=frame, width=portrait), name=name, label=label))
