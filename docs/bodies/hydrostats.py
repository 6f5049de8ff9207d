"""Trunk, octopus arm, tongue and fish tail."""

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np

from bodies.field import Place
from bodies.hydrostat_shapes import fish_tail, octopus_arm, tongue, trunk
from bodies.limb import Limb
from bodies.sheet import Line, Play, Sheet

MOTORS = 'motors stand beside the held end, outside the foam, so they stay where they are (mount = "world").'


def elephant_trunk() -> Sheet:
    """Four cables to the tip, two to the middle: the two halves can bend against each other."""
    shape = trunk()
    arm = shape.limbs["trunk"]
    up = (0.0, 0.0, 1.0)
    long = np.linspace(0.07, 0.96, 10)
    sides = {"left": (-1, 0, "left"), "right": (1, 0, "right"), "front": (0, 1, "forwards"), "back": (0, -1, "back")}
    lines = [
        _line(arm, name, f"bends all of it {way}" if y else f"bends it to the {way}", up, long, 0.55 * x, 0.55 * y)
        for name, (x, y, way) in sides.items()
    ]
    short = np.linspace(0.07, 0.52, 6)
    lines += [
        _line(arm, f"upper {name}", f"bends its upper half {way}", up, short, 0.0, 0.3 * y)
        for name, y, way in (("front", 1, "forwards"), ("back", -1, "back"))
    ]
    return Sheet(
        name="trunk",
        words=(
            "The trunk of an elephant that looks at you. Six winches: four cables run to the tip, two only half "
            "way, so that the halves can bend against each other. Lengths are in mm; x runs to the right, y away "
            "from you to the mouth, z up; it hangs from z = 0."
        ),
        surface=partial(shape.surface, 2.5e-3),
        faces=4000,
        element_size=13,
        held=("the end at the head.", [-60, -60, -14], [60, 60, 5]),
        winch_words=MOTORS,
        lines=lines,
        markers={"tip": arm.at(1.0), "middle": arm.at(0.55)},
        marker_words="the tip, and a point half way down.",
        plays={
            "feed": Play(words="It curls back to the mouth.", contractions={"back": 75}),
            "trumpet": Play(words="It lifts to the front.", contractions={"front": 70, "upper front": 20}),
            "wave": Play(words="It swings to one side.", contractions={"right": 60}),
            "swan": Play(words="An S: forwards above, back below.", contractions={"upper front": 36, "back": 46}),
        },
    )


def arm_of_octopus() -> Sheet:
    """Three cables along the arm and one that winds about it."""
    shape = octopus_arm()
    arm = shape.limbs["arm"]
    along = np.linspace(0.06, 0.95, 11)
    root = (-1.0, 0.0, 0.0)
    turns = np.radians(np.linspace(90, 450, 11))
    ways = zip(along, np.cos(turns), np.sin(turns), strict=True)
    winding = [arm.at(share, 0.52 * across, 0.52 * up) for share, across, up in ways]
    lines = [
        _line(arm, "suckers", "bends it down to the side of the suckers", root, along, 0.0, -0.45, 110),
        _line(arm, "left", "bends it up and to the left", root, along, 0.45, 0.4, 50),
        _line(arm, "right", "bends it up and to the right", root, along, -0.45, 0.4, 50),
        _from(winding, "oblique", "winds once about the arm: it twists and curls it", root, 50),
    ]
    return Sheet(
        name="octopus_arm",
        words=(
            "An arm of an octopus, flat below where its suckers would be. Four winches: three cables run along "
            "it, one winds about it like an oblique muscle. Lengths are in mm; x runs along the arm, y to the "
            "left, z up; it is held at x = 0."
        ),
        surface=partial(shape.surface, 2.5e-3),
        faces=4000,
        element_size=10,
        held=("the end at the body.", [-5, -40, -40], [14, 40, 40]),
        winch_words=MOTORS,
        lines=lines,
        markers={"tip": arm.at(0.98), "outer": arm.at(0.7), "inner": arm.at(0.4)},
        marker_words="the tip, and two points on the way there.",
        plays={
            "curl": Play(words="It rolls up round its suckers.", contractions={"suckers": 67}),
            "reach_left": Play(words="It reaches up and to the left.", contractions={"left": 42}),
            "wave": Play(words="It lifts its tip.", contractions={"left": 45, "right": 45}),
            "corkscrew": Play(words="It winds like a corkscrew.", contractions={"oblique": 37}),
        },
    )


def tongue_of_foam() -> Sheet:
    """Cables named after the muscles they stand for."""
    shape = tongue()
    body = shape.limbs["tongue"]
    along = np.linspace(0.13, 0.98, 7)
    root = (-1.0, 0.0, 0.0)
    shares = np.linspace(0.16, 0.92, 11)
    zigzag = [body.at(share, (-1) ** turn * 0.66) for turn, share in enumerate(shares)]
    lines = [
        _line(body, "left", "lifts it and bends it to the left", root, along, 0.45, 0.5, 60),
        _line(body, "right", "lifts it and bends it to the right", root, along, -0.45, 0.5, 60),
        _line(body, "lower", "bends it down", root, along, 0.0, -0.5, 60),
        _from(zigzag, "transverse", "goes to and fro: narrows it, so that it grows longer", root, 200),
    ]
    return Sheet(
        name="tongue",
        words=(
            "A tongue, twice as long as yours, of silicone, which keeps its volume. Four winches do the work of "
            "muscles: two cables run above, one below, and one goes to and fro across it. Lengths are in mm; x "
            "runs to the tip, y to the left, z up; it is held at x = 0."
        ),
        surface=partial(shape.surface, 2.5e-3),
        faces=4000,
        material="ecoflex 00-30",
        volume="patch",
        element_size=9,
        held=("the root.", [-5, -60, -60], [12, 60, 60]),
        winch_words=MOTORS,
        lines=lines,
        markers={"tip": body.at(1.0), "left_edge": body.at(0.8, 0.7), "right_edge": body.at(0.8, -0.7)},
        marker_words="the tip and both edges.",
        plays={
            "lick": Play(words="The tip goes up.", contractions={"left": 22, "right": 22}),
            "left": Play(words="To the left corner of the mouth.", contractions={"left": 30}),
            "say_ah": Play(words="Down, so that the doctor sees the throat.", contractions={"lower": 22}),
            "narrow": Play(words="Narrow, and so longer and thicker.", contractions={"transverse": 150}),
        },
    )


def tail_of_fish() -> Sheet:
    """Two cables that pull against each other."""
    shape = fish_tail()
    peduncle = shape.limbs["peduncle"]
    root = (-1.0, 0.0, 0.0)
    along = np.linspace(0.13, 0.98, 7)
    lines = [  # side of the limb: z; its back: -y, which is to the right of a fish that swims towards -x
        _line(peduncle, "left", "bends the tail to the left", root, along, 0.0, 0.5),
        _line(peduncle, "right", "bends the tail to the right", root, along, 0.0, -0.5),
    ]
    return Sheet(
        name="fish_tail",
        words=(
            "The tail of a fish: the narrowing end of its body and the forked fin. Two winches pull one against "
            "the other. Lengths are in mm; x runs to the fin, y to the right of the fish, z up; it is held at x = "
            "0."
        ),
        surface=partial(shape.surface, 2.5e-3),
        faces=4000,
        element_size=9,
        held=("the end at the body.", [-5, -60, -60], [12, 60, 60]),
        winch_words=MOTORS,
        lines=lines,
        markers={
            "fork": peduncle.at(1.0),
            "upper": shape.limbs["upper"].at(1.0),
            "lower": shape.limbs["lower"].at(1.0),
        },
        marker_words="the fork of the fin and both its tips.",
        plays={
            "left": Play(words="A stroke to the left.", contractions={"left": 26}),
            "right": Play(words="A stroke to the right.", contractions={"right": 26}),
        },
    )


def _line(
    arm: Limb,
    name: str,
    words: str,
    outward: Place,
    shares: Iterable[float],
    across: float,
    up: float,
    travel: float | None = None,
) -> Line:
    """A cable along one side of a limb."""
    return _from([arm.at(share, across, up) for share in shares], name, words, outward, travel)


def _from(route: Sequence[Place], name: str, words: str, outward: Place, travel: float | None = None) -> Line:
    """A cable along a route, its winch straight outside the held end and spread out a little."""
    start = np.array(route[0])
    away = np.array(outward)
    flat = start - (start @ away) * away
    winch = 1.75 * flat + 45e-3 * away
    return Line(name=name, words=words, points=[tuple(winch), *route], travel=travel)
