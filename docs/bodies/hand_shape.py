"""Hands after human measures: bones, joints and flesh, in any posture.

The hand stands on its wrist as on a table: x runs to the side of the thumb, y from the palm to the back, z from the
crease of the wrist (z = 0) to the fingers. It is a right hand.

Lengths of bones: means of radiographs of 66 adults (Buryanov and Kotiuk 2010, "Proportions of hand segments", Int. J.
Morphol. 28(3), 755-758), from the base of the metacarpal to the tip of the distal phalanx, with the soft tissue beyond.
Outer sizes: median of British men (Pheasant and Haslegrave 2006, "Bodyspace", 3rd edition, table of the hand), as it is
commonly quoted. A survey in the USA agrees where it has the same sizes (FAA Human Factors Design Standard, appendix on
the anthropometry of technical staff; men, median): length 196 mm, breadth 88 mm, index finger 21 mm broad.
Assumed, for no table gives them: where the metacarpals begin, the arch of the palm, the breadth of middle, ring and
little finger, the flesh of thumb and little finger, the size of the forearm.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from bodies.field import Field, Place, chain, half_space, intersection, turn_about, union
from bodies.limb import Limb, Shape, limb
from hydrostat.arrays import Float

FINGERS = ("thumb", "index", "middle", "ring", "little")  # names in the order of the rays

METACARPALS = MappingProxyType(
    {"thumb": 46.22e-3, "index": 68.12e-3, "middle": 64.60e-3, "ring": 58.00e-3, "little": 53.69e-3}
)
"""Length of the metacarpal bones [m] (Buryanov and Kotiuk 2010)."""

PHALANGES = MappingProxyType(
    {
        "thumb": (31.57e-3, 21.67e-3),
        "index": (39.78e-3, 22.38e-3, 15.82e-3),
        "middle": (44.63e-3, 26.33e-3, 17.40e-3),
        "ring": (41.37e-3, 25.65e-3, 17.30e-3),
        "little": (32.74e-3, 18.11e-3, 15.96e-3),
    }
)
"""Length of the phalanges from the knuckle on [m] (Buryanov and Kotiuk 2010)."""

SOFT_TIPS = MappingProxyType(
    {"thumb": 5.67e-3, "index": 3.84e-3, "middle": 3.95e-3, "ring": 3.95e-3, "little": 3.73e-3}
)
"""Soft tissue beyond the last bone [m] (Buryanov and Kotiuk 2010)."""

HAND_LENGTH = 189e-3
"""Length from the crease of the wrist to the tip of the middle finger [m] (Pheasant and Haslegrave 2006)."""

HAND_BREADTH = 87e-3  # across the knuckles of the four fingers [m] (Pheasant and Haslegrave 2006)

HAND_THICKNESS = 33e-3
"""Thickness from back to palm at the knuckle of the middle finger [m] (Pheasant and Haslegrave 2006)."""

INDEX_BREADTH, INDEX_THICKNESS = 21e-3, 19e-3
"""Sizes of the index finger at its middle joint [m] (Pheasant and Haslegrave 2006)."""

THUMB_BREADTH, THUMB_THICKNESS = 23e-3, 22e-3  # sizes of the thumb at its last joint [m] (Pheasant and Haslegrave 2006)


FOREARM = 20e-3  # how much of the forearm stands below the crease of the wrist, to be held by [m]

Direction = Float[np.ndarray, " 3"]

_ACROSS = np.array([1.0, 0.0, 0.0])
_LENGTH_TO_KNUCKLE = HAND_LENGTH - sum(PHALANGES["middle"]) - SOFT_TIPS["middle"]
_SPREAD = (HAND_BREADTH - INDEX_BREADTH) / 3
"""Distance from knuckle to knuckle, so that the breadth of the hand is right [m]."""

_SIZES = MappingProxyType({"index": 1.0, "middle": 1.0, "ring": 0.95, "little": 0.86})
"""Breadth and thickness of the fingers as shares of those of the index finger; but for that one assumed."""


@dataclass(frozen=True, kw_only=True)
class HandPosture:
    """Posture of the fingers of a hand."""

    # angle of each finger in the plane of the palm, towards the thumb [degrees]
    fans: tuple[float, float, float, float]
    # of knuckle, middle and last joint of each finger towards the palm [degrees]
    bends: tuple[tuple[float, float, float], ...]
    # how far each knuckle lies towards the palm from that of the middle finger [m]
    arch: tuple[float, float, float, float]
    thumb: tuple[float, float, float]  # direction of the metacarpal of the thumb
    thumb_pad: tuple[float, float, float]  # approximate direction that the pad of the thumb faces
    thumb_bends: tuple[float, float]  # bend of its two outer joints towards its pad [degrees]


CUPPING = HandPosture(
    fans=(11, 2, -7, -18),
    bends=((28, 34, 18), (32, 36, 20), (36, 38, 20), (38, 38, 20)),
    arch=(3e-3, 0.0, 3e-3, 9e-3),
    thumb=(0.66, -0.46, 0.60),
    thumb_pad=(-0.8, -0.35, 0.45),
    thumb_bends=(14, 18),
)
"""Half way between open and closed, as a hand at rest: it can both open and close."""

EXTENDED = HandPosture(
    fans=(12, 2, -8, -20),
    bends=((2, 3, 2),) * 4,
    arch=(1e-3, 0.0, 1e-3, 4e-3),
    thumb=(0.74, -0.24, 0.63),
    thumb_pad=(-0.65, -0.6, 0.5),
    thumb_bends=(4, 4),
)
"""Fingers straight and spread, thumb out."""


def hand(posture: HandPosture) -> Shape:
    """Right hand of human size in a posture; its limbs are thumb, index, middle, ring and little.

    The joints of a finger are base and head of its metacarpal (the knuckle), its middle and last joint and the tip of
    its last bone; the thumb has one less. They lie as far from one another as the bones are long.
    """
    limbs = {"thumb": _thumb(posture)}
    for place, name in enumerate(FINGERS[1:]):
        limbs[name] = _finger(name, place, posture)
    rays = union(*(limbs[name].distance for name in FINGERS[1:]), *_palm(limbs), blend=6e-3)
    flesh = union(rays, *_flesh(limbs), blend=12e-3)
    body = union(flesh, limbs["thumb"].distance, blend=14e-3)
    whole = intersection(union(body, _forearm(), blend=16e-3), half_space((0, 0, -FOREARM), (0, 0, -1)), blend=6e-3)
    return Shape(whole, _box(limbs), limbs)


def cupping_hand() -> Shape:
    """First foam hand: slightly cupped, at rest between open and closed."""
    return hand(CUPPING)


def extended_hand() -> Shape:
    """Second foam hand: fingers extended."""
    return hand(EXTENDED)


def _finger(name: str, place: int, posture: HandPosture) -> Limb:
    """Finger with its metacarpal, through its joints."""
    knuckle = np.array(
        [_SPREAD * (1.5 - place), -posture.arch[place], _LENGTH_TO_KNUCKLE - (3e-3, 0.0, 6e-3, 15e-3)[place]]
    )
    base = _metacarpal_base(knuckle, name)
    fan = turn_about((0, 1, 0), posture.fans[place])
    side, way = fan @ _ACROSS, fan @ np.array([0.0, 0.0, 1.0])
    joints = [base, knuckle]
    for length, bend in zip(PHALANGES[name], posture.bends[place], strict=True):
        way = turn_about(side, bend) @ way
        joints.append(joints[-1] + length * way)
    broad, deep = (size * _SIZES[name] / 2 for size in (INDEX_BREADTH, INDEX_THICKNESS))
    palm = HAND_THICKNESS / 2
    cap = 0.9 * broad
    end = joints[-1] + (SOFT_TIPS[name] - cap) * way
    drawn = limb(
        [*joints[:-1], end],
        side=side,
        breadths=[0.95 * broad, 1.02 * broad, broad, 0.90 * broad, 0.80 * broad],
        backs=[0.92 * palm, 0.95 * palm * _SIZES[name], deep, 0.88 * deep, 0.72 * deep],
        bellies=[0.95 * palm, 1.05 * palm * _SIZES[name], deep, 0.95 * deep, 0.88 * deep],
        caps=(8e-3, cap),
    )
    return replace(drawn, joints=np.array(joints))


def _metacarpal_base(knuckle: Direction, name: str) -> Direction:
    """Place where the metacarpal of a finger begins: near the middle of the wrist, its length away from the knuckle."""
    lean = np.array([0.62 * knuckle[0] - knuckle[0], -4e-3 - knuckle[1], 0.0])
    lean[2] = -np.sqrt(METACARPALS[name] ** 2 - lean @ lean)
    return knuckle + lean


def _thumb(posture: HandPosture) -> Limb:
    """Thumb with its metacarpal, through its joints."""
    way = _unit(posture.thumb)
    pad = np.array(posture.thumb_pad)
    back = _unit(way * (pad @ way) - pad)
    side = np.cross(back, way)
    joints = [np.array([21e-3, -8e-3, 21e-3])]
    for length, bend in zip((METACARPALS["thumb"], *PHALANGES["thumb"]), (0, *posture.thumb_bends), strict=True):
        way = turn_about(side, bend) @ way
        joints.append(joints[-1] + length * way)
    broad, deep = THUMB_BREADTH / 2, THUMB_THICKNESS / 2
    cap = 0.85 * broad
    end = joints[-1] + (SOFT_TIPS["thumb"] - cap) * way
    drawn = limb(
        [*joints[:-1], end],
        side=side,
        breadths=[1.2 * broad, 1.02 * broad, broad, 0.86 * broad],
        backs=[1.1 * deep, 1.05 * deep, deep, 0.72 * deep],
        bellies=[1.4 * deep, 1.10 * deep, deep, 0.90 * deep],
        caps=(8e-3, cap),
    )
    return replace(drawn, joints=np.array(joints))


def _palm(limbs: dict[str, Limb]) -> list[Field]:
    """Flesh that fills the palm between the metacarpals and makes the webs between the fingers."""
    between = []
    for one, two in pairwise(FINGERS[1:]):
        root, knuckle, joint = (limbs[one].joints[:3] + limbs[two].joints[:3]) / 2
        between.append(chain([root, knuckle, 0.76 * knuckle + 0.24 * joint], [13.5e-3, 12.5e-3, 6.5e-3], blend=3e-3))
    return between


def _flesh(limbs: dict[str, Limb]) -> tuple[Field, ...]:
    """Balls of thumb and little finger on the palm, and the web between thumb and index finger."""
    root, knuckle = limbs["thumb"].joints[:2]
    towards_palm = np.array([-4e-3, -3e-3, 0.0])
    base, little = limbs["little"].joints[:2]
    ball_of_thumb = chain([root + towards_palm, 0.35 * root + 0.65 * knuckle + towards_palm], [14e-3, 12.5e-3])
    outward, low = np.array([-1e-3, -4e-3, 0.0]), np.array([0.0, 0.0, -6e-3])
    ball_of_little = chain([base + outward + low, 0.4 * base + 0.6 * little + outward], [13e-3, 11e-3])
    index = limbs["index"].joints
    web = chain([0.35 * root + 0.65 * knuckle, 0.45 * index[0] + 0.55 * index[1]], [7e-3, 9e-3])
    return ball_of_thumb, ball_of_little, web


def _forearm() -> Field:
    """Forearm up to the wrist, broader than deep."""
    return limb(
        [(0, -2e-3, -FOREARM - 20e-3), (0, -2e-3, 0), (0, -3e-3, 26e-3)],
        side=_ACROSS,
        breadths=[31e-3, 29e-3, 30e-3],
        backs=[21e-3, 19e-3, 15e-3],
        bellies=[21e-3, 19e-3, 16e-3],
        caps=(1e-3, 10e-3),
    ).distance


def _unit(vector: Place) -> Direction:
    return np.array(vector, dtype=float) / np.linalg.norm(vector)


def _box(limbs: dict[str, Limb]) -> Float[np.ndarray, "2 3"]:
    joints = np.concatenate([one.joints for one in limbs.values()])
    low, high = joints.min(axis=0) - 30e-3, joints.max(axis=0) + 30e-3
    low[2] = -FOREARM - 2e-3
    return np.array([low, high])
