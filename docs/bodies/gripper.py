"""The gripper with four fingers."""

from functools import partial

from bodies.field import Place
from bodies.gripper_shape import BASE, caging_gripper
from bodies.limb import Limb
from bodies.sheet import Line, Play, Sheet

EDGES = {"a": 1, "b": -1}
"""The two cables of a finger, one along each edge of its inner side."""


def caging() -> Sheet:
    """Hand 3: each finger has two cables on the inside, which bend it together and swing it one without the other."""
    shape = caging_gripper()
    lines = [_line(name, finger, edge) for name, finger in shape.limbs.items() for edge in EDGES]
    every = [line.name for line in lines]
    return Sheet(
        name="caging_gripper",
        words=(
            "A foam gripper that is no hand: four fingers round a palm, at rest a cage with room for a tennis "
            "ball (67 mm). After the third foam hand of the thesis. Eight winches: two to a finger, along the "
            "edges of its inner side; together they close it, one alone swings it to its side. Lengths are in mm; "
            "x runs to the right, y to the back, z from the base to the fingers."
        ),
        surface=partial(shape.surface, 2.5e-3),
        element_size=11.5,
        held=("the base below the palm.", [-60, -60, -1e3 * BASE - 5], [60, 60, -17]),
        winch_words="motors stand on a base below the gripper, outside the foam, so they stay where they are\n"
        '# (mount = "world"); a tube of PTFE leads each cable from its winch into the palm.',
        lines=lines,
        markers={name: finger.at(1.0) for name, finger in shape.limbs.items()},
        marker_words="the tips of the fingers.",
        plays={
            "close": Play(words="All fingers close on what is in the cage.", contractions=dict.fromkeys(every, 5.5)),
            "twist": Play(
                words="All fingers swing the same way round, as if to open a jar.",
                contractions={name: 16 if name.endswith("a") else 0 for name in every},
            ),
            "pinch": Play(
                words="Front and back finger meet.",
                contractions={name: 9 for name in every if name.startswith(("front", "back"))},
            ),
        },
    )


def _line(name: str, finger: Limb, edge: str) -> Line:
    entry: Place = finger.at(0.06, EDGES[edge] * 0.5, -0.3)
    below = (0.8 * entry[0], 0.8 * entry[1], -20e-3)
    x, y, _ = finger.at(0.25, EDGES[edge] * 0.75, 0.0)
    route = [finger.at(share, EDGES[edge] * 0.42, -0.4) for share in (0.26, 0.36, 0.46, 0.56, 0.66, 0.76, 0.86, 0.96)]
    return Line(
        name=f"{name} {edge}",
        words=f"closes the {name} finger along one edge",
        points=[(0.9 * x, 0.9 * y, -70e-3), below, entry, *route],
        sheath=2,
    )
