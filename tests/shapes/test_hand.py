"""Hands against the tables of human sizes that they are made from."""

from functools import cache

import numpy as np
import pytest
from bodies.hand_shape import (
    CUPPING,
    EXTENDED,
    FINGERS,
    HAND_BREADTH,
    HAND_LENGTH,
    HAND_THICKNESS,
    INDEX_BREADTH,
    INDEX_THICKNESS,
    METACARPALS,
    PHALANGES,
    SOFT_TIPS,
    THUMB_BREADTH,
    THUMB_THICKNESS,
    HandPosture,
    hand,
)
from bodies.limb import Shape

POSTURES = {
    "cupping": CUPPING,
    "extended": EXTENDED,
    "straight": HandPosture(
        fans=(0, 0, 0, 0),
        bends=((0, 0, 0),) * 4,
        arch=(0, 0, 0, 0),
        thumb=(1, 0, 1),
        thumb_pad=(-1, 0, 1),
        thumb_bends=(0, 0),
    ),
}


@cache
def shape(name: str) -> Shape:
    return hand(POSTURES[name])


def across(body: Shape, middle: np.ndarray, way: np.ndarray) -> float:
    """How thick the body is through a point in it [m], by the first places outside on both sides."""
    steps = np.linspace(0, 0.04, 4001)
    way = way / np.linalg.norm(way)
    return sum(float(steps[np.argmax(body.field(middle + steps[:, None] * one) > 0)]) for one in (way, -way))


@pytest.mark.parametrize("name", POSTURES)
@pytest.mark.parametrize("finger", FINGERS)
def test_bones_are_as_long_as_in_the_table(name: str, finger: str) -> None:
    """Oracle: Buryanov and Kotiuk (2010), in every posture."""
    joints = shape(name).limbs[finger].joints
    lengths = np.linalg.norm(np.diff(joints, axis=0), axis=1)
    assert lengths == pytest.approx([METACARPALS[finger], *PHALANGES[finger]], abs=1e-9)


@pytest.mark.parametrize("finger", FINGERS)
def test_soft_tips(finger: str) -> None:
    """Oracle: the soft tissue beyond the last bone, in the table; there the surface of the body lies."""
    body = shape("extended")
    one = body.limbs[finger]
    assert np.linalg.norm(one.tip - one.joints[-1]) == pytest.approx(SOFT_TIPS[finger], abs=1e-6)
    assert body.field(one.tip[None]) == pytest.approx([0.0], abs=3e-4)


def test_outer_sizes_of_the_hand() -> None:
    """Oracle: length, breadth and thickness of the hand as in the table."""
    body = shape("straight")
    index, middle, little = (body.limbs[name] for name in ("index", "middle", "little"))
    assert middle.tip[2] == pytest.approx(HAND_LENGTH, abs=1e-6)
    assert across(body, middle.joints[1], np.array([0.0, 1.0, 0.0])) == pytest.approx(HAND_THICKNESS, rel=0.05)
    steps = np.linspace(0, 0.03, 3001)[:, None]
    right, left = (
        joint + steps[np.argmax(body.field(joint + steps * way) > 0)] * way
        for joint, way in ((index.joints[1], np.array([1.0, 0, 0])), (little.joints[1], np.array([-1.0, 0, 0])))
    )
    assert (right - left)[0] == pytest.approx(HAND_BREADTH, rel=0.05)


@pytest.mark.parametrize(
    ("finger", "breadth", "thickness"),
    [("index", INDEX_BREADTH, INDEX_THICKNESS), ("thumb", THUMB_BREADTH, THUMB_THICKNESS)],
)
def test_outer_sizes_of_a_finger(finger: str, breadth: float, thickness: float) -> None:
    """Oracle: the table, at the middle joint of the index finger and the last one of the thumb."""
    body = shape("extended")
    one = body.limbs[finger]
    share = one.share_of(2)
    middle, side, back = (np.array(one.at(share, *offset)) for offset in ((0, 0), (1, 0), (0, 1)))
    assert across(body, middle, side - middle) == pytest.approx(breadth, rel=0.05)
    assert across(body, middle, back - middle) == pytest.approx(thickness, rel=0.05)


@pytest.mark.parametrize("name", ["cupping", "extended"])
def test_fingers_are_apart(name: str) -> None:
    """Oracle: from its middle joint on no finger is nearer to another than 6 mm; tips: 12 mm, a foam element."""
    limbs = shape(name).limbs
    for finger, one in limbs.items():
        shares = np.linspace(one.share_of(2), 1.0, 20)
        skin = np.array([one.at(share, np.cos(turn), np.sin(turn)) for share in shares for turn in range(7)])
        for other in limbs:
            if other != finger:
                gaps = limbs[other].distance(skin)
                assert gaps.min() > 6e-3
                assert gaps[-7:].min() > 12e-3


def test_neutral_between_open_and_closed() -> None:
    """Oracle (R51): each joint of the first hand is bent by a fifth to a half of its range of 90, 100, 80 degrees."""
    shares = np.array(CUPPING.bends) / (90, 100, 80)
    assert shares.min() > 0.2
    assert shares.max() < 0.5


def test_it_is_a_right_hand() -> None:
    """Oracle: seen from the palm (-y) with the fingers up, the thumb of a right hand is on the right."""
    tips = {name: one.tip for name, one in shape("extended").limbs.items()}
    assert tips["thumb"][0] > tips["index"][0] > tips["middle"][0] > tips["ring"][0] > tips["little"][0]
    bent = shape("cupping").limbs
    assert all(bent[name].tip[1] < bent[name].joints[1][1] - 0.02 for name in FINGERS[1:])
