"""The gallery's cupping hand, finer or coarser: the body in space that benchmarks are measured on."""

from dataclasses import replace

from hydrostat.geometry import Mesh
from hydrostat.robot import Robot, gallery_folder, load_robot, surface_body

HAND = "cupping_hand"

ELEMENT_SIZE = 11.6e-3
"""Of the gallery [m]: about as many nodes and elements as the thesis's hand (N3)."""


def hand_robot(element_size: float = ELEMENT_SIZE) -> Robot:
    """The hand with elements of a size [m]."""
    robot = load_robot(gallery_folder(HAND))
    if element_size == robot.body.element_size:
        return robot
    body = robot.body
    finer = surface_body(
        body.content, file=body.file, unit=1e-3, material=body.material, element_size=element_size, volume=body.volume
    )
    return replace(robot, body=finer)


def hand_mesh(element_size: float = ELEMENT_SIZE) -> Mesh:
    """Its mesh alone."""
    return hand_robot(element_size).body.mesh
