"""Small flat robots, drawn in code."""

import math

from hydrostat.robot import MATERIALS, Body, Cable, Marker, Pin, Robot, Winch

SQUARE = "M0 0H100V100H0Z"
HOLED = SQUARE + "M30 30H70V70H30Z"


def drawn_body(path: str, *, element_size: float = 0.02) -> Body:
    """Body of an SVG path in millimeters, inside a page of 300 mm; its origin is the middle of its box."""
    root = '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="300mm" viewBox="0 0 300 300">'
    page = f'{root}<path d="{path}"/></svg>'
    material = MATERIALS["polyester fibre"]
    return Body.from_outline(
        page.encode(), file="body.svg", material=material, element_size=element_size, thickness=0.03
    )


def disc_path(radius: float, corners: int = 720) -> str:
    """A disc as a polygon of many corners."""
    angles = [2 * math.pi * corner / corners for corner in range(corners)]
    return "M" + "L".join(f"{150 + radius * math.cos(a):.9f} {150 + radius * math.sin(a):.9f}" for a in angles) + "Z"


def plush_robot(
    body: Body,
    *routes: list[tuple[float, float]],
    name: str = "Sam",
    marker: tuple[float, float] = (40, 40),
    **winch: object,
) -> Robot:
    """A robot with a winch at the first point of the first route [mm], and a pin that holds the whole body."""
    points = [tuple((1e-3 * x, 1e-3 * y) for x, y in route) for route in routes]
    winches = (Winch(name="pull", at=points[0][0], **winch),) if points else ()
    return Robot(
        name=name,
        body=body,
        pins=(Pin(at=(0.0, 0.0), radius=1.0, stiffness=100e3),),
        winches=winches,
        cables=tuple(Cable(winch="pull", points=route) for route in points),
        markers=(Marker(name="tip", at=(1e-3 * marker[0], 1e-3 * marker[1])),),
        poses={},
    )


def crossed() -> Robot:
    """A square of 100 mm with two cables in no symmetric place."""
    return plush_robot(drawn_body(SQUARE), [(-20, -10), (5, 12), (31.5, 22.25)], [(-20, -10), (-24, 20), (-10.125, 38)])
