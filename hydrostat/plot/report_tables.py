"""The tables of the report: all its numbers, with their units."""

from collections.abc import Mapping

import numpy as np

from hydrostat.design.network import Network, TreeTrace
from hydrostat.drawing.palette import winch_colours
from hydrostat.ik import ReachedPose
from hydrostat.plot.html import Html, bar, swatch, table, tag
from hydrostat.plot.numbers import number, place
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.plot.targets import rest_errors
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot, robot_hash


def marker_table(robot: Robot, reached: ReachedPose) -> Html:
    """Target, reached place and error of each marker."""
    before = rest_errors(robot, reached.wanted)
    rows = [
        (name, place(target), place(reached.pose.markers[name]), f"{MILLIMETRES * before[name]:.1f}",
         tag("span", f"{MILLIMETRES * reached.errors[name]:.2f}", class_="error"))
        for name, target in reached.wanted.targets.items()
    ]  # fmt: skip
    heads = ("marker", "target [mm]", "reached [mm]", "error at rest [mm]", "error [mm]")
    return table(heads, rows, numbers=(1, 2, 3, 4))


def contraction_table(robot: Robot, reached: ReachedPose) -> Html:
    """Contraction of each winch against what it can take in."""
    colours = winch_colours(robot.winches)
    rows = [
        ([swatch(colours[winch.name]), winch.name], number(MILLIMETRES * contraction, 2),
         bar(abs(contraction) / (winch.travel if contraction >= 0 else winch.release or np.inf), colours[winch.name]),
         f"{MILLIMETRES * (winch.travel if contraction >= 0 else -winch.release):.0f}".replace("-", "\N{MINUS SIGN}"))
        for winch, contraction in zip(robot.winches, map(float, reached.pose.contractions), strict=True)
    ]  # fmt: skip
    return table(("winch", "contraction [mm]", "", "limit [mm]"), rows, numbers=(1, 3))


def tension_table(robot: Robot, reached: ReachedPose) -> Html:
    """Tension of each cable."""
    scale = TensionScale.of(reached.pose.tensions)
    colours = winch_colours(robot.winches)
    rows = [
        (str(count), [swatch(colours[cable.winch]), cable.winch], f"{tension:.2f}" if tension > 0 else "slack",
         bar(tension / scale.most, scale.colour(tension)))
        for count, (cable, tension) in enumerate(zip(robot.cables, map(float, reached.pose.tensions), strict=True), 1)
    ]  # fmt: skip
    return table(("cable", "winch", "tension [N]", ""), rows, numbers=(2,))


def footer(network: Network, facts: Mapping[str, object]) -> Html:
    """How the numbers came about, and what is needed to get them again."""
    from hydrostat import __version__

    known = {
        "hydrostat version": __version__,
        "robot hash (SHA-256)": robot_hash(network.robot),
        "method": network.method,
        "networks tried": network.tried,
        **_score(network),
        "CPU time of the design": f"{network.seconds:.1f} s" + ("" if network.complete else ", stopped early"),
        "body": _body(network.robot),
    }
    words = (
        "How the errors were computed: for each pose, inverse kinematics finds the contractions of the network's own "
        "winches; the body's equilibrium under these cables is solved by finite elements "
        f"(Neo-Hookean{', plane strain' if network.robot.body.mesh.dim == 2 else ''}); "
        "an error is the distance from a marker to its target there; rms is the root of the mean of the squared errors."
    )
    rows = [(name, tag("code", value)) for name, value in {**known, **facts}.items()]
    return tag("footer", tag("h2", "How this was made"), tag("p", words), table(("", ""), rows))


def _score(network: Network) -> dict[str, str]:
    trace = network.trace
    return {"score of the thesis, 0 to 1": f"{trace.score:.3f}"} if isinstance(trace, TreeTrace) else {}


def _body(robot: Robot) -> str:
    mesh = robot.body.mesh
    return f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements, {MILLIMETRES * mesh.size:.0f} mm"
