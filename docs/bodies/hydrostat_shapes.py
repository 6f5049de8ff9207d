"""Muscular hydrostats: a trunk, an octopus arm, a tongue; and the tail of a fish."""

from collections.abc import Sequence

import numpy as np

from bodies.field import Field, half_space, intersection, round_cone, union
from bodies.limb import Limb, Shape, limb
from hydrostat.arrays import Float


def trunk() -> Shape:
    """Trunk of an elephant that looks towards -y: down from z = 0, its tip a little raised, its mouth at +y."""
    joints = [(0, 0, 12e-3), (0, 2e-3, -75e-3), (0, 8e-3, -155e-3), (0, -2e-3, -225e-3), (0, -42e-3, -276e-3)]
    arm = limb(
        joints,
        side=(1, 0, 0),
        breadths=[40e-3, 30e-3, 22e-3, 17e-3, 15e-3],
        backs=[41e-3, 30e-3, 22e-3, 16e-3, 13.5e-3],
        bellies=[35e-3, 27e-3, 20e-3, 15e-3, 13e-3],
        caps=(2e-3, 5e-3),
        bend=30e-3,
    )
    finger = round_cone(arm.at(0.96, up=0.3), np.add(arm.at(1.0, up=0.5), (0, -12e-3, -6e-3)), 11e-3, 8e-3)
    return Shape(_flat(union(arm.distance, finger, blend=8e-3), (0, 0, 1)), _box(arm, top=(2, 0.0)), {"trunk": arm})


def octopus_arm() -> Shape:
    """Arm of an octopus along x: a long taper, flattened below where the suckers are, its tip a little raised."""
    arm = limb(
        [(-12e-3, 0, 0), (80e-3, 0, -2e-3), (170e-3, 0, -4e-3), (250e-3, 0, 2e-3), (312e-3, 0, 18e-3)],
        side=(0, 1, 0),
        breadths=[27e-3, 22e-3, 16.5e-3, 12e-3, 8.5e-3],
        backs=[26e-3, 21e-3, 15e-3, 11e-3, 8e-3],
        bellies=[15e-3, 12.5e-3, 10e-3, 8e-3, 6.5e-3],
        caps=(2e-3, 10e-3),
        bend=40e-3,
    )
    return Shape(_flat(arm.distance, (-1, 0, 0)), _box(arm, bottom=(0, 0.0)), {"arm": arm})


def tongue() -> Shape:
    """Tongue along x, twice as long as one of ours: thick at its root, flat and round at its tip."""
    body = limb(
        [(-10e-3, 0, -6e-3), (45e-3, 0, 3e-3), (95e-3, 0, 3e-3), (136e-3, 0, -4e-3)],
        side=(0, 1, 0),
        breadths=[38e-3, 39e-3, 34e-3, 22e-3],
        backs=[24e-3, 19e-3, 13.5e-3, 9e-3],
        bellies=[24e-3, 17e-3, 11.5e-3, 8e-3],
        caps=(2e-3, 16e-3),
        bend=30e-3,
    )
    return Shape(_flat(body.distance, (-1, 0, 0)), _box(body, bottom=(0, 0.0)), {"tongue": body})


def fish_tail() -> Shape:
    """Tail of a fish that swims towards -x: the narrowing peduncle and a forked fin, upright in z."""
    peduncle = limb(
        [(-12e-3, 0, 0), (45e-3, 0, 0), (95e-3, 0, 0), (132e-3, 0, 0)],
        side=(0, 0, 1),
        breadths=[46e-3, 33e-3, 20e-3, 22e-3],
        backs=[30e-3, 21e-3, 12e-3, 9e-3],
        caps=(2e-3, 6e-3),
        bend=20e-3,
    )
    lobes = {name: _lobe(sign) for name, sign in (("upper", 1.0), ("lower", -1.0))}
    fin = union(*(lobe.distance for lobe in lobes.values()), blend=10e-3)
    whole = _flat(union(peduncle.distance, fin, blend=14e-3), (-1, 0, 0))
    limbs = {"peduncle": peduncle, **lobes}
    box = np.array([[0, -34e-3, -100e-3], [215e-3, 34e-3, 100e-3]])
    return Shape(whole, box, limbs)


def _lobe(sign: float) -> Limb:
    """One lobe of the fin, a blade."""
    joints = np.array([[102e-3, 0, 4e-3], [142e-3, 0, 36e-3], [178e-3, 0, 76e-3]]) * (1, 1, sign)
    return limb(
        joints,
        side=(-0.68, 0, 0.73 * sign),
        breadths=[20e-3, 25e-3, 11e-3],
        backs=[9e-3, 9e-3, 8e-3],
        caps=(8e-3, 18e-3),
        bend=20e-3,
    )


def _flat(field: Field, outward: Sequence[float]) -> Field:
    """Cut at the origin, where the body is held."""
    return intersection(field, half_space((0, 0, 0), outward), blend=4e-3)


def _box(
    arm: Limb, *, bottom: tuple[int, float] | None = None, top: tuple[int, float] | None = None
) -> Float[np.ndarray, "2 3"]:
    """Box around a limb; `bottom` and `top` are an axis and where the body ends along it [m]."""
    reach = max(arm.breadths.max(), arm.backs.max(), arm.bellies.max()) + 4e-3
    box = np.array([arm.spine.min(axis=0) - reach, arm.spine.max(axis=0) + reach])
    for row, side in enumerate((bottom, top)):
        if side is not None:
            box[row, side[0]] = side[1] + (2e-3 if row else -2e-3)
    return box
