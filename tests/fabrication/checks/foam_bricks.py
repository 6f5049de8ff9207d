"""Bricks of foam in space, made by another program."""

import trimesh

import hydrostat as hs
from hydrostat.robot import MATERIALS, Body, Mount


def foam_brick(*routes: list[tuple[float, float, float]], sheathed: tuple[tuple[int, int], ...] = ()) -> hs.Robot:
    """A brick of 100 x 40 x 40 mm about the origin, held at its left end, with cables of one winch [mm]."""
    made = trimesh.creation.box((100.0, 40.0, 40.0)).export(file_type="stl")
    body = Body.from_surface(
        bytes(made), file="brick.stl", unit=1e-3, material=MATERIALS["flexfoam-it x"], element_size=0.02
    )
    points = [tuple(tuple(1e-3 * x for x in point) for point in route) for route in routes]
    return hs.Robot(
        name="brick",
        body=body,
        pins=(hs.Pin(box=((-0.06, -0.03, -0.03), (-0.045, 0.03, 0.03))),),
        winches=(hs.Winch(name="pull", at=points[0][0], mount=Mount.WORLD),) if points else (),
        cables=tuple(hs.Cable(winch="pull", points=route, sheathed=sheathed) for route in points),
        poses={},
    )
