"""Bodies that touch themselves: a tuning fork whose prongs cables pull together, in the plane and in space."""

import numpy as np
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.robot import Cable, Contact, Marker, Pin, Robot, Winch

DISTANCE = 1e-3


def fork_mesh(dim: int, columns: int = 12) -> Mesh:
    """A plate 120 x 40 mm (x 20 mm) with a slot 6.7 mm wide from its right end to 30 mm before its left one."""
    if dim == 2:
        whole = strip_mesh(columns, 6, size=(0.12, 0.04))
        nodes = whole.nodes
    else:
        whole = box_mesh((columns, 6, 2), size=(0.12, 0.04, 0.02))
        nodes = whole.nodes - np.array([0.0, 0.02, 0.0])
    middles = nodes[whole.elements].mean(axis=1)
    slot = (middles[:, 0] > 0.03) & (np.abs(middles[:, 1]) < 0.04 / 6)
    kept, elements = np.unique(whole.elements[~slot], return_inverse=True)
    return Mesh(nodes[kept], elements.reshape(-1, dim + 1))


def fork_robot(dim: int, *, contact: bool = True, columns: int = 12) -> Robot:
    """The fork, held at its left end, with one cable in each prong, on the side of the slot."""
    xs, deep = np.linspace(0.035, 0.115, 5), (0.01,) * (dim - 2)
    routes = {name: tuple((float(x), side * 0.009, *deep) for x in xs) for name, side in (("up", 1), ("down", -1))}
    ends = (-0.001, *(-1.0,) * (dim - 1)), (0.001, *(1.0,) * (dim - 1))
    return Robot(
        name="fork",
        body=mesh_body(fork_mesh(dim, columns), thickness=0.02 if dim == 2 else None),
        pins=(Pin(box=ends),),
        winches=tuple(Winch(name=name, at=route[0], travel=0.03) for name, route in routes.items()),
        cables=tuple(Cable(winch=name, points=route) for name, route in routes.items()),
        markers=(Marker(name="tip", at=(0.12, 0.015, *deep)),),
        poses={},
        contact=Contact(distance=DISTANCE) if contact else None,
    )
