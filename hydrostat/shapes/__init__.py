"""Shapes to begin from: signed distances, limbs, and the bodies of the gallery."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.shapes.field import (
        Field,
        Place,
        chain,
        ellipsoid,
        half_space,
        intersection,
        place_field,
        round_cone,
        rounded_box,
        turn_about,
        union,
    )
    from hydrostat.shapes.gripper import BASE, SIDES, caging_gripper
    from hydrostat.shapes.hand import CUPPING, EXTENDED, FOREARM, HandPosture, cupping_hand, extended_hand, hand
    from hydrostat.shapes.hydrostats import fish_tail, octopus_arm, tongue, trunk
    from hydrostat.shapes.limb import Limb, Shape, limb

__all__ = [
    "BASE",
    "CUPPING",
    "EXTENDED",
    "FOREARM",
    "SIDES",
    "Field",
    "HandPosture",
    "Limb",
    "Place",
    "Shape",
    "caging_gripper",
    "chain",
    "cupping_hand",
    "ellipsoid",
    "extended_hand",
    "fish_tail",
    "half_space",
    "hand",
    "intersection",
    "limb",
    "octopus_arm",
    "place_field",
    "round_cone",
    "rounded_box",
    "tongue",
    "trunk",
    "turn_about",
    "union",
]

open_package(__name__)
