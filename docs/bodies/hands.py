"""The two hands of human shape."""

from functools import partial

from bodies.field import Place
from bodies.hand_shape import FOREARM, cupping_hand, extended_hand
from bodies.limb import Limb, Shape
from bodies.sheet import Line, Play, Sheet

FINGERS = ("index", "middle", "ring", "little")
COLUMNS = {"thumb": 34e-3, "index": 17e-3, "middle": 0.0, "ring": -17e-3, "little": -34e-3}
"""Where the winches of each finger stand [m]."""

TUBES = (
    'motors stand on a base below the wrist, outside the foam, so they stay where they are (mount = "world"); a tube '
    "of PTFE leads each cable from its winch into the palm."
)


def cupping() -> Sheet:
    """Hand 1: at rest between open and closed; each finger has a flexor on its belly and an extensor on its back."""
    shape = cupping_hand()
    lines = [_thumb_flexor(shape), _thumb_extensor(shape)]
    for name in FINGERS:
        lines += [_flexor(shape, name), _extensor(shape, name)]
    return Sheet(
        name="cupping_hand",
        words=(
            "A foam hand with human proportions, at rest half way between open and closed: it can both open and "
            "close. After the first foam hand of the thesis. Ten winches, two to a finger: one bends it, one "
            "straightens it. Lengths are in mm; x runs to the thumb, y from the palm to the back, z from the "
            "wrist to the fingers."
        ),
        surface=partial(shape.surface, 2.5e-3),
        element_size=11.6,
        held=_held(),
        winch_words=TUBES,
        lines=lines,
        markers=_tips(shape),
        marker_words="the tips of the fingers.",
        plays={
            "fist": Play(
                words="All fingers close, the thumb lies in front of them.",
                contractions={
                    "index flexor": 24,
                    "middle flexor": 29,
                    "ring flexor": 29,
                    "little flexor": 34,
                    "thumb flexor": 15,
                },
            ),
            "open": Play(
                words="All fingers stretch.",
                contractions={f"{name} extensor": 18 for name in ("thumb", *FINGERS)},
            ),
            "point": Play(
                words="The index finger points, the others close.",
                contractions={
                    "middle flexor": 29,
                    "ring flexor": 30,
                    "little flexor": 35,
                    "thumb flexor": 18,
                    "index extensor": 16,
                },
            ),
            "pinch": Play(
                words="Thumb and index finger close on something small, the others stretch a little.",
                contractions={
                    "index flexor": 24,
                    "thumb flexor": 22,
                    "middle extensor": 6,
                    "ring extensor": 8,
                    "little extensor": 8,
                },
            ),
        },
    )


def extended() -> Sheet:
    """Hand 2: straight fingers; each has a flexor and a cable on one side; the thumb can cross the palm."""
    shape = extended_hand()
    lines = [_thumb_flexor(shape), _opponens(shape)]
    for name, across, towards in zip(FINGERS, (-1, 1, -1, 1), ("middle", "index", "little", "ring"), strict=True):
        lines += [_flexor(shape, name), _side(shape, name, across, towards)]
    return Sheet(
        name="extended_hand",
        words=(
            "A foam hand with human proportions, at rest with straight, spread fingers. After the second foam "
            "hand of the thesis. Ten winches: each finger has one to bend it and one to swing it to a neighbor; "
            "the second cable of the thumb crosses the palm, so that it can stand before the fingers. Lengths are "
            "in mm; x runs to the thumb, y from the palm to the back, z from the wrist to the fingers."
        ),
        surface=partial(shape.surface, 2.5e-3),
        element_size=11.6,
        held=_held(),
        winch_words=TUBES,
        lines=lines,
        markers=_tips(shape),
        marker_words="the tips of the fingers.",
        plays={
            "four": Play(
                words="The thumb lies across the palm: four fingers.",
                contractions={"thumb opponens": 31},
            ),
            "greet": Play(
                words="Live long: index and middle finger together, ring and little finger together.",
                contractions={"index side": 4, "middle side": 5, "ring side": 5, "little side": 7},
            ),
            "point": Play(
                words="The index finger points, the others bend.",
                contractions={
                    "middle flexor": 43,
                    "ring flexor": 42,
                    "little flexor": 40,
                    "thumb opponens": 16,
                    "thumb flexor": 20,
                },
            ),
            "grasp": Play(
                words="All fingers bend round a ball, the thumb stands against them.",
                contractions={
                    **{f"{name} flexor": 34 for name in FINGERS},
                    "thumb opponens": 22,
                    "thumb flexor": 10,
                },
            ),
        },
    )


def _held() -> tuple[str, list[float], list[float]]:
    return "the stump of the forearm.", [-60, -60, -1e3 * FOREARM - 5], [60, 60, -3]


def _tips(shape: Shape) -> dict[str, Place]:
    return {name: one.at(1.0) for name, one in shape.limbs.items()}


def _winch(name: str, *, back: bool) -> Place:
    return COLUMNS[name], (20e-3 if back else -20e-3), -62e-3


def _entry(name: str, *, back: bool) -> Place:
    return 0.45 * COLUMNS[name], (7e-3 if back else -11e-3), -12e-3


def _along(finger: Limb, shares: list[float], *, across: float = 0.0, up: float = 0.0) -> list[Place]:
    return [finger.at(share, across, up) for share in shares]


def _shares(finger: Limb, metacarpal: float) -> list[float]:
    """From a place on the metacarpal on: the joints, places between them, and the end."""
    joints = [finger.share_of(joint) for joint in range(1, len(finger.joints) - 1)]
    shares = [metacarpal * joints[0]]
    for start, end in zip(joints, [*joints[1:], 0.93], strict=True):
        shares += [start, (start + end) / 2]
    return [*shares, 0.93]


def _flexor(shape: Shape, name: str) -> Line:
    finger = shape.limbs[name]
    route = [_winch(name, back=False), _entry(name, back=False), finger.at(0.06, up=-0.5)]
    return Line(
        name=f"{name} flexor",
        words=f"bends the {name} finger",
        points=[*route, *_along(finger, _shares(finger, 0.6), up=-0.4)],
        sheath=3,
    )


def _extensor(shape: Shape, name: str) -> Line:
    finger = shape.limbs[name]
    route = [_winch(name, back=True), _entry(name, back=True), finger.at(0.06, up=0.5)]
    return Line(
        name=f"{name} extensor",
        words=f"straightens the {name} finger",
        points=[*route, *_along(finger, _shares(finger, 0.6), up=0.45)],
        sheath=3,
    )


def _side(shape: Shape, name: str, across: int, towards: str) -> Line:
    finger = shape.limbs[name]
    route = [_winch(name, back=True), _entry(name, back=True), finger.at(0.06, up=0.3)]
    return Line(
        name=f"{name} side",
        words=f"swings the {name} finger to the {towards} finger",
        points=[*route, *_along(finger, _shares(finger, 0.6), across=0.48 * across)],
        sheath=3,
    )


def _thumb_flexor(shape: Shape) -> Line:
    thumb = shape.limbs["thumb"]
    route = [_winch("thumb", back=False), _entry("thumb", back=False)]
    return Line(
        name="thumb flexor",
        words="bends the thumb towards the fingers",
        points=[*route, *_along(thumb, _shares(thumb, 0.25), up=-0.5)],
        sheath=2,
    )


def _thumb_extensor(shape: Shape) -> Line:
    thumb = shape.limbs["thumb"]
    route = [_winch("thumb", back=True), _entry("thumb", back=True)]
    return Line(
        name="thumb extensor",
        words="straightens the thumb and draws it back (pattern 1: both cables of the thumb run along it)",
        points=[*route, *_along(thumb, _shares(thumb, 0.25), up=0.5)],
        sheath=2,
    )


def _opponens(shape: Shape) -> Line:
    thumb, ring = shape.limbs["thumb"], shape.limbs["ring"]
    heel = ring.at(0.5 * ring.share_of(1), across=-0.2, up=-0.45)
    knuckle = thumb.share_of(1)
    return Line(
        name="thumb opponens",
        words="draws the thumb across the palm (pattern 2: from the heel of the hand, through the palm, to the thumb)",
        points=[
            _winch("thumb", back=True),
            (0.0, 4e-3, -12e-3),
            ring.at(0.04, up=-0.3),
            heel,
            shape.limbs["index"].at(0.42 * shape.limbs["index"].share_of(1), across=0.4, up=-0.5),
            *_along(thumb, [0.8 * knuckle, knuckle, 0.5 + 0.5 * knuckle], across=0.0, up=-0.45),
        ],
        sheath=3,
    )
