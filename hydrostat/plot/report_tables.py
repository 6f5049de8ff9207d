"""Parts of a report: pages, chapters, pictures, tables; all numbers in millimeters, with a true minus sign."""

from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from hydrostat.design import Network, TreeTrace
from hydrostat.drawing import Color, Html, tag
from hydrostat.ik import IKResult
from hydrostat.plot.picture_file import inline_svg
from hydrostat.plot.targets import rest_errors
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import BodyPart, Robot, robot_hash
from hydrostat.units import MILLIMETERS

NARROW_WIDTH = 4.9  # width of pictures that stand side by side [inch]: the narrower, the larger their letters


class Chapter(NamedTuple):
    """A part of the story: its headline, what happens, and what there is to see."""

    head: str
    words: str
    parts: list[Html]


def page(title: str, *content: Html) -> str:
    """A page as text: content under a title in the look of all reports, without need of another file or a network."""
    style = (files("hydrostat.plot") / "report.css").read_text(encoding="utf-8")
    head = tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        Html('<meta name="color-scheme" content="light dark">'),
        tag("title", f"{title} \N{MIDDLE DOT} hydrostat"),
        tag("style", Html(f"\n{style}")),
    )
    return f'<!doctype html>\n<html lang="en">{head}<body>{tag("main", *content)}</body></html>\n'


def fact(number: str, unit: str, words: str, *, best: bool = False) -> Html:
    """A large number at the top of a page, and what it says."""
    shown = tag("b", number, tag("small", unit))
    return tag("li", shown, tag("span", words), class_="best" if best else None)


def section(number: int, chapter: Chapter) -> Html:
    """A chapter under its number."""
    words = tag("div", tag("h2", chapter.head), tag("p", chapter.words))
    return tag("section", tag("header", tag("div", number, class_="step"), words), *chapter.parts)


def picture(figure: Figure, name: str, head: str, words: str) -> Html:
    """A figure with a name of its own on the page, and what it shows: a headline and words that follow it."""
    return add_caption(Html(inline_svg(figure, name=name, label=head + words)), head, words)


def add_caption(content: Html, head: str, words: str, *, kind: str | None = None) -> Html:
    """Return a picture with a headline and words below; `kind` is a class of the style."""
    return tag("figure", content, tag("figcaption", tag("b", head), words), class_=kind)


def grid(*pictures: Html, kind: str = "") -> Html:
    """Pictures side by side; `kind` is a class of the style, for more than one."""
    return tag("div", *pictures, class_=f"grid {'one' if len(pictures) == 1 else kind}".strip())


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], *, numbers: Iterable[int] = ()) -> Html:
    """A table; columns `numbers` are set flush right."""
    right = set(numbers)

    def line(kind: str, cells: Sequence[object]) -> Html:
        return tag("tr", *(tag(kind, cell, class_="number" if i in right else None) for i, cell in enumerate(cells)))

    head = tag("thead", line("th", heads) if any(heads) else "")
    return tag("div", tag("table", head, tag("tbody", *(line("td", row) for row in rows))), class_="table")


def bar(share: float, color: str) -> Html:
    """A bar filled to a share, 0 to 1."""
    width = 100 * min(max(share, 0.0), 1.0)
    return tag("span", tag("i", style=f"width:{width:.1f}%;background:{color}"), class_="bar")


def swatch(color: str) -> Html:
    """A dot of a color."""
    return tag("i", class_="swatch", style=f"background:{color}")


def marker_table(robot: Robot, reached: IKResult) -> Html:
    """Target, reached place and error of each marker."""
    before = rest_errors(robot, reached.pose_target)
    rows = [
        (name, place(target), place(reached.pose.markers[name]), f"{MILLIMETERS * before[name]:.1f}",
         tag("span", f"{MILLIMETERS * reached.errors[name]:.2f}", class_="error"))
        for name, target in reached.pose_target.targets.items()
    ]  # fmt: skip
    heads = ("marker", "target [mm]", "reached [mm]", "error at rest [mm]", "error [mm]")
    return table(heads, rows, numbers=(1, 2, 3, 4))


def contraction_table(robot: Robot, reached: IKResult) -> Html:
    """Contraction of each winch against what it can take in."""
    colors = Color.of_winches(robot.winches)
    rows = [
        ([swatch(colors[winch.name]), winch.name], number(MILLIMETERS * contraction, 2),
         bar(abs(contraction) / (winch.travel if contraction >= 0 else winch.release or np.inf), colors[winch.name]),
         f"{MILLIMETERS * (winch.travel if contraction >= 0 else -winch.release):.0f}".replace("-", "\N{MINUS SIGN}"))
        for winch, contraction in zip(robot.winches, map(float, reached.pose.contractions), strict=True)
    ]  # fmt: skip
    return table(("winch", "contraction [mm]", "", "limit [mm]"), rows, numbers=(1, 3))


def tension_table(robot: Robot, reached: IKResult) -> Html:
    """Tension of each cable."""
    scale = TensionScale.of(reached.pose.tensions)
    colors = Color.of_winches(robot.winches)
    rows = [
        (str(count), [swatch(colors[cable.winch]), cable.winch], f"{tension:.2f}" if tension > 0 else "slack",
         bar(tension / scale.most, scale.color(tension)))
        for count, (cable, tension) in enumerate(zip(robot.cables, map(float, reached.pose.tensions), strict=True), 1)
    ]  # fmt: skip
    return table(("cable", "winch", "tension [N]", ""), rows, numbers=(2,))


def footer(network: Network, facts: Mapping[str, object]) -> Html:
    """Return the footer with the settings and versions that reproduce the numbers."""
    from hydrostat.version import __version__

    known = {
        "hydrostat version": __version__,
        "robot hash (SHA-256)": robot_hash(network.robot),
        "method": network.request.method,
        "networks tried": network.num_evaluated,
        **_score(network),
        "CPU time of the design": f"{network.seconds:.1f} s" + ("" if network.complete else ", stopped early"),
        "body": _body(network.robot),
    }
    words = (
        "How the errors were computed: for each pose, inverse kinematics finds the contractions of the network's own "
        "winches; the body's equilibrium under these cables is solved by finite elements "
        f"(Neo-Hookean{f', plane {network.robot.body.plane}' if network.robot.body.mesh.dim == 2 else ''}); "
        "an error is the distance from a marker to its target there; rms is the root of the mean of the squared errors."
    )
    rows = [(name, tag("code", value)) for name, value in {**known, **facts}.items()]
    return tag("footer", tag("h2", "How this was made"), tag("p", words), table(("", ""), rows))


def _score(network: Network) -> dict[str, str]:
    trace = network.trace
    return {"score of the thesis, 0 to 1": f"{trace.score:.3f}"} if isinstance(trace, TreeTrace) else {}


def _body(robot: Robot) -> str:
    mesh = robot.body.mesh
    return f"{mesh.describe()}, {MILLIMETERS * mesh.size:.0f} mm"


def body_table(robot: Robot) -> Html:
    """Size, thickness and material."""
    body, material = robot.body, robot.body.material
    foam = ", ".join(f"{term.exponent:g}" for term in material.foam)
    rows = [
        ("size", f"{MILLIMETERS * body.mesh.size:.0f} mm"),
        *([("thickness", f"{MILLIMETERS * body.thickness:.3g} mm")] if body.thickness else []),
        ("material", material.name or "by its numbers"),
        ("Young's modulus", f"{material.young / 1e3:.3g} kPa"),
        ("Poisson's ratio", f"{material.poisson:g}"),
        *([("foam law", f"exponents {foam}")] if foam else []),
        *((f"part {part.name}", part_text(part)) for part in body.parts),
        ("mesh", body.mesh.describe()),
    ]
    return table(("", ""), rows, numbers=(1,))


def part_text(part: BodyPart) -> str:
    """Material of a part of the body."""
    if part.material is None:
        return "rigid"
    return part.material.name or f"{part.material.young / 1e3:.3g} kPa"


def place_table(robot: Robot) -> Html:
    """The places of the markers at rest."""
    return table(("marker", "at [mm]"), [(marker.name, place(marker.at)) for marker in robot.markers], numbers=(1,))


def winch_table(robot: Robot) -> Html:
    """Place and limits of each winch."""
    colors = Color.of_winches(robot.winches)
    rows = [
        ([swatch(colors[winch.name]), winch.name], place(winch.at), number(MILLIMETERS * winch.spool_radius, 1),
         number(MILLIMETERS * winch.travel, 0), number(MILLIMETERS * winch.release, 0))
        for winch in robot.winches
    ]  # fmt: skip
    heads = ("winch", "at [mm]", "spool radius [mm]", "takes in [mm]", "lets out [mm]")
    return table(heads, rows, numbers=(1, 2, 3, 4))


def cable_table(robot: Robot) -> Html:
    """Length, via points and stopper of each cable; winding and spool radius where cables of a winch differ in them."""
    colors, steps = Color.of_winches(robot.winches), any(cable.spool_radius is not None for cable in robot.cables)
    back = any(cable.reverse for cable in robot.cables)
    rows = [
        (str(count), [swatch(colors[cable.winch]), cable.winch], number(MILLIMETERS * cable.length, 1),
         str(len(cable.points) - 2), place(cable.points[-1]), f"{cable.stiffness / 1e3:.3g}",
         *([number(MILLIMETERS * (cable.spool_radius or robot.winch(cable.winch).spool_radius), 1)] if steps else []),
         *([("reversed" if cable.reverse else "usual")] if back else []))
        for count, cable in enumerate(robot.cables, 1)
    ]  # fmt: skip
    heads = ("cable", "winch", "length [mm]", "via points", "stopper [mm]", "stiffness [N/mm]",
             *(["spool radius [mm]"] if steps else []), *(["winding"] if back else []))  # fmt: skip
    return table(heads, rows, numbers=range(2, len(heads) - back))


def place(point: object) -> str:
    """Coordinates [m] in millimeters."""
    return ", ".join(number(MILLIMETERS * float(value), 1) for value in np.asarray(point))


def number(value: float, digits: int) -> str:
    """A number with so many digits after the point."""
    text = f"{value:.{digits}f}"
    text = text.lstrip("-") if float(text) == 0 else text
    return text.replace("-", "\N{MINUS SIGN}")


def millimeters(error: float) -> str:
    """An error [m] in millimeters: to a hundredth, below a tenth to two digits, below a thousandth 0.00."""
    value = MILLIMETERS * error
    return f"{value:.2f}" if value >= 0.1 or value < 1e-3 else f"{value:.2g}"
