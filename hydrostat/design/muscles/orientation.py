"""`wanted_directions`: along which direction each element should shorten to bring a pose nearer."""

import numpy as np
from jaxtyping import Float

from hydrostat.geometry.anchors import locate
from hydrostat.mechanics import Assembly
from hydrostat.robot import Pose, Robot
from hydrostat.simulation import body_energies


def wanted_directions(robot: Robot, pose: Pose) -> Float[np.ndarray, "elements dim"]:
    """Unit vectors along which a fibre of each element lowers the pose error most (E21a).

    At rest, with the adjoint field w = H^-1 dO/dx of the marker error O, a small tension t along d in an element
    changes O by t times the strain of w along d; the best d is the eigenvector of the largest strain of w.
    """
    mesh = robot.body.mesh
    assembly = Assembly(body_energies(robot), rest=mesh.nodes, control_count=0)
    places = {marker.name: marker.at for marker in robot.markers}
    anchors = locate(mesh, np.array([places[name] for name in pose.targets]))
    miss = anchors.positions(mesh.nodes) - np.array(list(pose.targets.values()), dtype=float)
    slope = anchors.matrix(len(mesh.nodes)).T @ miss
    field = assembly.stiffness(mesh.nodes, np.zeros(0)).solve(-slope.ravel()).reshape(mesh.nodes.shape)
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    moved = field[mesh.elements]
    gradient = inverse @ (moved[:, 1:] - moved[:, :1])
    strain = 0.5 * (gradient + np.swapaxes(gradient, 1, 2))
    return np.linalg.eigh(strain)[1][:, :, 0]
