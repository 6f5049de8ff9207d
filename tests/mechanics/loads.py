"""What a block in a textbook stands on and is pulled by."""

import numpy as np

from hydrostat.geometry import Mesh
from hydrostat.mechanics import Energy


class Rollers(Energy):
    """Nodes that slide along the plane on which one of their coordinates is 0."""

    def __init__(self, nodes: np.ndarray, axis: int, stiffness: np.ndarray) -> None:
        self.stencils, self.axis, self.stiffness = nodes[:, None], axis, stiffness

    def value(self, nodes, controls):
        return 0.5 * float(self.stiffness @ nodes[self.stencils[:, 0], self.axis] ** 2)

    def gradient(self, nodes, controls):
        blocks = np.zeros((len(self.stencils), 1, nodes.shape[1]))
        blocks[:, 0, self.axis] = self.stiffness * nodes[self.stencils[:, 0], self.axis]
        return blocks

    def hessian(self, nodes, controls):
        blocks = np.zeros((len(self.stencils), nodes.shape[1], nodes.shape[1]))
        blocks[:, self.axis, self.axis] = self.stiffness
        return blocks


def outward_areas(mesh: Mesh) -> np.ndarray:
    """Area x outward normal that belongs to each node of a body in space, (nodes, 3); faces found by counting."""
    faces: dict[tuple[int, ...], tuple[list[int], int]] = {}
    for element in mesh.elements:
        for left_out in range(4):
            face = [int(node) for index, node in enumerate(element) if index != left_out]
            key = tuple(sorted(face))
            if key in faces:
                del faces[key]
            else:
                faces[key] = face, int(element[left_out])
    areas = np.zeros_like(mesh.nodes)
    for (a, b, c), inside in faces.values():
        p = mesh.nodes
        area = 0.5 * np.cross(p[b] - p[a], p[c] - p[a])
        area *= -np.sign(area @ (p[inside] - p[a]))
        areas[[a, b, c]] += area / 3
    return areas
