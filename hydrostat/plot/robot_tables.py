"""Tables of what a robot is made of: body, markers, winches, cables."""

from hydrostat.drawing.palette import winch_colours
from hydrostat.plot.html import Html, swatch, table
from hydrostat.plot.numbers import number, place
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.robot import Robot


def body_table(robot: Robot) -> Html:
    """Size, thickness and material."""
    body, material = robot.body, robot.body.material
    rows = [
        ("size", f"{MILLIMETRES * body.mesh.size:.0f} mm"),
        *([("thickness", f"{MILLIMETRES * body.thickness:.3g} mm")] if body.thickness else []),
        ("material", material.name or "by its numbers"),
        ("Young's modulus", f"{material.young / 1e3:.3g} kPa"),
        ("Poisson's ratio", f"{material.poisson:g}"),
        ("mesh", f"{len(body.mesh.nodes)} nodes, {len(body.mesh.elements)} elements"),
    ]
    return table(("", ""), rows, numbers=(1,))


def place_table(robot: Robot) -> Html:
    """Where each marker is at rest."""
    return table(("marker", "at [mm]"), [(marker.name, place(marker.at)) for marker in robot.markers], numbers=(1,))


def winch_table(robot: Robot) -> Html:
    """Place and limits of each winch."""
    colours = winch_colours(robot.winches)
    rows = [
        ([swatch(colours[winch.name]), winch.name], place(winch.at), number(MILLIMETRES * winch.spool_radius, 1),
         number(MILLIMETRES * winch.travel, 0), number(MILLIMETRES * winch.release, 0))
        for winch in robot.winches
    ]  # fmt: skip
    heads = ("winch", "at [mm]", "spool radius [mm]", "takes in [mm]", "lets out [mm]")
    return table(heads, rows, numbers=(1, 2, 3, 4))


def cable_table(robot: Robot) -> Html:
    """Length, via points and stopper of each cable; its spool's radius if that of one is not its winch's."""
    colours, steps = winch_colours(robot.winches), any(cable.spool_radius is not None for cable in robot.cables)
    rows = [
        (str(count), [swatch(colours[cable.winch]), cable.winch], number(MILLIMETRES * cable.length, 1),
         str(len(cable.points) - 2), place(cable.points[-1]), f"{cable.stiffness / 1e3:.3g}",
         *([number(MILLIMETRES * (cable.spool_radius or robot.winch(cable.winch).spool_radius), 1)] if steps else []))
        for count, cable in enumerate(robot.cables, 1)
    ]  # fmt: skip
    heads = ("cable", "winch", "length [mm]", "via points", "stopper [mm]", "stiffness [N/mm]",
             *(["spool radius [mm]"] if steps else []))  # fmt: skip
    return table(heads, rows, numbers=range(2, len(heads)))
