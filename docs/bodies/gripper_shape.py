"""A gripper that is no hand: four fingers around a palm, curved into a cage at rest."""

import numpy as np

from bodies.field import half_space, intersection, turn_about, union
from bodies.limb import Limb, Shape, limb

SIDES = {"right": 0, "back": 90, "left": 180, "front": 270}
"""Fingers and their directions about z [degrees]; x runs to the right, y to the back."""

BASE = 28e-3  # how far the base reaches below the middle of the palm, to be held by [m]


def caging_gripper() -> Shape:
    """Third foam hand: a round palm that looks up, four fingers of four joints, room for a tennis ball (67 mm)."""
    limbs = {name: _finger(degrees) for name, degrees in SIDES.items()}
    fingers = union(*(finger.distance for finger in limbs.values()), blend=10e-3)
    whole = union(fingers, _palm().distance, blend=14e-3)
    whole = union(whole, _foot().distance, blend=10e-3)
    whole = intersection(whole, half_space((0, 0, -BASE), (0, 0, -1)), blend=5e-3)
    box = np.array([[-78e-3, -78e-3, -BASE - 2e-3], [78e-3, 78e-3, 140e-3]])
    return Shape(whole, box, limbs)


def _finger(degrees: float) -> Limb:
    """Finger in the direction of x, turned about z."""
    turn = turn_about((0, 0, 1), degrees)
    joints = np.array([[18e-3, 0, 2e-3], [53e-3, 0, 14e-3], [61e-3, 0, 58e-3], [52e-3, 0, 98e-3], [33e-3, 0, 122e-3]])
    return limb(
        joints @ turn.T,
        side=turn @ np.array([0.0, -1.0, 0.0]),
        breadths=[15e-3, 13.5e-3, 12.5e-3, 11.5e-3, 10e-3],
        backs=[13e-3, 11.5e-3, 10.5e-3, 9.5e-3, 8e-3],
        caps=(8e-3, 8e-3),
        bend=20e-3,
    )


def _palm() -> Limb:
    """Thick disc."""
    return _upright([-4e-3, 4e-3], [42e-3, 42e-3], cap=12e-3)


def _foot() -> Limb:
    """Round base below the palm."""
    return _upright([-BASE - 20e-3, -10e-3], [31e-3, 31e-3], cap=5e-3)


def _upright(heights: list[float], radii: list[float], cap: float) -> Limb:
    return limb([(0, 0, height) for height in heights], side=(1, 0, 0), breadths=radii, backs=radii, caps=(cap, cap))
