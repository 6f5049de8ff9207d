"""`ToyPicture`: points that a page draws, each an affine map of the coordinates of a learned shape."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points
from hydrostat.plot import Attachments, FlatSkin
from hydrostat.robot import Robot
from hydrostat.toy.learned_shape import LearnedShape


@dataclass(frozen=True, kw_only=True, eq=False)
class ToyPicture:
    """Drawn points of a robot.

    Attributes:
        groups: kind, first point and number of points of each group: outline, seam, surface, drawn, cable, winch and
            marker, in the order in which they are drawn.
        faces: triangles of the surface, as numbers of points from the first of the surface on; none of a flat body.
        mean: the points in the mean shape [m].
        basis: displacement of the points for a coordinate of 1 [m].
    """

    groups: tuple[tuple[str, int, int], ...]
    faces: Int[np.ndarray, "faces 3"]
    mean: Points
    basis: Float[np.ndarray, "coordinates points dim"]

    @classmethod
    def of(cls, robot: Robot, shape: LearnedShape) -> Self:
        """Picture of a robot in a learned shape."""
        mesh, attached = robot.body.mesh, Attachments(robot)

        def parts(nodes: Nodes) -> list[tuple[str, Points]]:
            """Each group of points at nodes; affine in the nodes."""
            found: list[tuple[str, Points]] = []
            if mesh.dim == 2:
                skin = FlatSkin.of(robot.body)
                found += [("outline", ring) for ring in skin.shape(nodes)]
                found += [("seam", ring) for ring in skin.seam(nodes)]
            else:
                found.append(("surface", nodes[mesh.boundary_nodes]))
            found += [("drawn", anchors.positions(nodes)) for anchors in robot.body.mark_anchors]
            found += [("cable", points) for points in attached.cables(nodes)]
            return [*found, ("winch", attached.winches(nodes)), ("marker", attached.markers(nodes))]

        mean = parts(shape.mean)
        whole = np.concatenate([points for _, points in mean])
        moved = [np.concatenate([points for _, points in parts(shape.mean + each)]) - whole for each in shape.basis]
        return cls(groups=_groups(mean), faces=_faces(robot), mean=whole, basis=np.array(moved))

    def facts(self) -> list[list[Any]]:
        """Groups as JSON."""
        return [list(group) for group in self.groups]


def _groups(parts: Sequence[tuple[str, Points]]) -> tuple[tuple[str, int, int], ...]:
    groups, first = [], 0
    for kind, points in parts:
        groups.append((kind, first, len(points)))
        first += len(points)
    return tuple(groups)


def _faces(robot: Robot) -> Int[np.ndarray, "faces 3"]:
    mesh = robot.body.mesh
    if mesh.dim == 2:
        return np.zeros((0, 3), dtype=np.int64)
    return np.searchsorted(mesh.boundary_nodes, mesh.boundary)
