"""Shapes to begin from: signed distances, limbs, and the bodies of the gallery."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.shapes.field import Field, Place
    from hydrostat.shapes.gripper import BASE, caging_gripper
    from hydrostat.shapes.hand import FOREARM, cupping_hand, extended_hand, hand
    from hydrostat.shapes.hydrostats import fish_tail, octopus_arm, tongue, trunk
    from hydrostat.shapes.limb import Limb, Shape

__all__ = [
    "BASE",
    "FOREARM",
    "Field",
    "Limb",
    "Place",
    "Shape",
    "caging_gripper",
    "cupping_hand",
    "extended_hand",
    "fish_tail",
    "hand",
    "octopus_arm",
    "tongue",
    "trunk",
]

open_package(__name__)
