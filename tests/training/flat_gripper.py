"""A gripper in the plane, of few nodes, on which turning a disc can be learned on a small computer."""

import numpy as np

from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Cable, Material, Obstacle, Pin, Robot, Source, Winch

DISC = Obstacle(name="disc", shape="sphere", at=(0.0, 0.0), radius=20e-3, mass=0.2, friction=0.8)
LENGTH, BREADTH, ROOM, BEYOND = 90e-3, 10e-3, 6e-3, 10e-3
"""Of a finger, its distance from the disc, and how far its tip lies beyond where it is nearest to the disc [m]."""

DRAG = 80.0
"""Of a disc that resists being turned [1/s]: with its mass it takes about as much as soft fingers can give."""

FOAM = Material(young=60e3, poisson=0.3, density=40)


def flat_gripper(cells: int = 8, disc: Obstacle = DISC) -> Robot:
    """Four soft fingers beside a disc, each along a side of a square about it, held where it begins.

    A finger has two cables: `a` along its inner side, which bends it onto the disc, and `b` along its outer side, which
    lifts it off. Both shorten it, and what it presses on goes along: so to press, to shorten, to lift and to let go
    turns the disc. A finger is a strip of so many cells by two.
    """
    strip, nodes, elements, pins, cables = _strip(cells), [], [], [], []
    room = (disc.radius or 0.0) + ROOM + 0.5 * BREADTH
    for number, name in enumerate(("right", "top", "left", "bottom")):
        out = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]][number], dtype=float)
        along = np.array([out[1], -out[0]])  # from where it is held to its tip: the disc turns the other way round
        corner = room * out + (BEYOND - LENGTH) * along
        placed = corner + strip.nodes[:, :1] * along - strip.nodes[:, 1:] * out
        elements.append(strip.elements[:, ::-1] + len(strip.nodes) * number)
        nodes.append(placed)
        held = placed[strip.nodes[:, 0] < 1e-6]
        pins.append(Pin(box=(tuple((held.min(axis=0) - 1e-4).tolist()), tuple((held.max(axis=0) + 1e-4).tolist()))))
        stops = np.linspace(2e-3, LENGTH - 3e-3, 6)
        for side, off in (("a", -4e-3), ("b", 4e-3)):
            points = tuple(tuple((corner + x * along + off * out).tolist()) for x in stops)
            cables.append(Cable(winch=f"{name} {side}", points=points, smoothing=0.2e-3))
    mesh = Mesh(np.concatenate(nodes), np.concatenate(elements))
    body = Body(source=Source.MESH, file="flat_gripper.vtk", content=b"", material=FOAM, thickness=0.03, mesh=mesh)
    return Robot(
        name="flat_gripper",
        body=body,
        pins=tuple(pins),
        winches=tuple(Winch(name=cable.winch, at=cable.points[0], travel=45e-3) for cable in cables),
        cables=tuple(cables),
        poses={},
        obstacles=(disc,),
    )


def _strip(cells: int) -> Mesh:
    """A strip [0, LENGTH] x [-BREADTH/2, BREADTH/2]; its diagonals alternate."""
    x, y = np.meshgrid(np.linspace(0, LENGTH, cells + 1), np.linspace(-BREADTH / 2, BREADTH / 2, 3))
    elements = []
    for row in range(2):
        for column in range(cells):
            a = row * (cells + 1) + column
            b, c, d = a + 1, a + cells + 2, a + cells + 1
            even = (row + column) % 2 == 0
            elements += [(a, b, c), (a, c, d)] if even else [(a, b, d), (b, c, d)]
    return Mesh(np.column_stack([x.ravel(), y.ravel()]), np.array(elements))
