"""A shallow arch clamped at both ends, whose top a cable pulls down: it snaps through."""

import numpy as np
from builders import mesh_body, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.robot import Cable, Marker, Mount, Pin, Robot, Winch

LENGTH, RISE = 0.2, 0.02


def arch() -> Robot:
    """200 mm wide, 20 mm high, 8 mm thick; the cable is so soft that the arch feels a force rather than a place."""
    flat = strip_mesh(40, 2, size=(LENGTH, 0.008))
    x, y = flat.nodes.T
    nodes = np.column_stack([x - LENGTH / 2, y + RISE * (1 - (2 * x / LENGTH - 1) ** 2)])
    below = (0.0, -0.08)
    return Robot(
        name="arch",
        body=mesh_body(Mesh(nodes, flat.elements)),
        pins=tuple(Pin(box=((end - 1e-3, -1.0), (end + 1e-3, 1.0))) for end in (-LENGTH / 2, LENGTH / 2)),
        winches=(Winch(name="down", at=below, mount=Mount.WORLD, travel=0.3),),
        cables=(Cable(winch="down", points=(below, (0.0, RISE)), stiffness=0.2),),
        markers=(Marker(name="top", at=(0.0, RISE)),),
        poses={},
    )
