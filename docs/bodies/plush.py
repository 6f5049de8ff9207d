"""A plush bear, blown up from its outline."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bodies.field import Place
from bodies.sheet import Line, Play, Sheet
from hydrostat.geometry import Surface, inflate, read_outline

OUTLINE = Path(__file__).with_name("bear.svg")


def bear() -> Sheet:
    """Four winches in the belly; the first one pulls two cables, one along the front of each arm."""
    lines = [_hug(-1, "left"), _hug(1, "right"), _lift(-1, "left"), _lift(1, "right"), _nod()]
    return Sheet(
        name="bear",
        words=(
            "A plush bear that hugs: its outline is a drawing, blown up as if it were stuffed. Four winches in its "
            "belly pull five cables. Lengths are in mm; x runs to the right, y to its back, z up."
        ),
        surface=_surface,
        faces=5000,
        material="polyester fibre",
        element_size=12,
        held=("by its hips.", [-45, -60, -100], [45, 60, -55]),
        winch_words="little motors in its belly; they move with it.",
        lines=lines,
        markers={
            "left_paw": (-104e-3, 0.0, 30e-3),
            "right_paw": (104e-3, 0.0, 30e-3),
            "nose": (0.0, -20e-3, 66e-3),
            "crown": (0.0, 0.0, 98e-3),
        },
        marker_words="both paws, the nose and the crown of the head.",
        plays={
            "hug": Play(words="Both arms come forward.", contractions={"hug": 40}),
            "wave": Play(words="The right arm goes up.", contractions={"right lift": 38}),
            "cheer": Play(words="Both arms go up.", contractions={"left lift": 36, "right lift": 36}),
            "nod": Play(words="Yes.", contractions={"nod": 30}),
        },
    )


def _surface() -> Surface:
    """The outline blown up to 72 mm, upright, its back to +y."""
    outline = read_outline(OUTLINE.read_bytes(), name=OUTLINE.name)
    surface = inflate(outline, 72e-3, spacing=6e-3)
    x, y, z = surface.vertices.T
    return Surface(np.column_stack([x, -z, y]), surface.triangles)


def _hug(side: int, name: str) -> Line:
    places = [(30, -13, 12), (46, -11, 17), (62, -9, 22), (78, -8.5, 25.5), (92, -8, 29), (103, -6, 31)]
    return _line("hug", f"draws the {name} arm forward", [(0, -14, -2), *_mirrored(side, places)])


def _lift(side: int, name: str) -> Line:
    places = [(26.0, 0.0, -6.0), (42, 0, 26), (57, 0, 36), (72, 0, 39.5), (87, 0, 43), (100, 0, 44)]
    return _line(f"{name} lift", f"lifts the {name} arm", _mirrored(side, places))


def _nod() -> Line:
    return _line("nod", "bows the head", [(0, -16, 18), (0, -14, 32), (0, -16, 50), (0, -18, 70), (0, -14, 90)])


def _line(name: str, words: str, places: list[Place]) -> Line:
    points = [tuple(1e-3 * value for value in place) for place in places]
    return Line(name=name, words=words, points=points, sheath=0, mount="body")


def _mirrored(side: int, places: Sequence[tuple[float, float, float]]) -> list[Place]:
    return [(side * x, y, z) for x, y, z in places]
