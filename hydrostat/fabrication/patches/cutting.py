"""`cut_skin`: the skin of a body in as few patches as lie flat well enough."""

from dataclasses import dataclass

import numpy as np

from hydrostat.fabrication.patches.chord import best_chord, cut_chord
from hydrostat.fabrication.patches.distortion import distortion
from hydrostat.fabrication.patches.flatten import flatten
from hydrostat.fabrication.patches.front_and_back import front_and_back
from hydrostat.fabrication.patches.patch import Patch, disc_of
from hydrostat.fabrication.patches.seams import find_seams
from hydrostat.fabrication.patches.skin_mesh import SkinMesh

MOST_GIVE = 0.12
"""How much the cloth may have to give in 95 % of a patch. Felt and woven plush give about that much; assumed, measured
on none."""

MOST_EASE = 0.05
"""How much longer one side of a seam may be than the other: the longer is eased in with pins. Assumed."""

MOST_PATCHES = 6
"""A person loses track of more."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cutting:
    """A skin in patches.

    Attributes:
        mesh: of the whole skin.
        patches: in the order of their numbers.
        back: of each whether it was cut from the back.
    """

    mesh: SkinMesh
    patches: tuple[Patch, ...]
    back: tuple[bool, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Front and back, numbered where there are several."""
        names = []
        for number, back in enumerate(self.back):
            side = "back" if back else "front"
            alone = self.back.count(back) == 1
            names.append(side if alone else f"{side}-{self.back[: number + 1].count(back)}")
        return tuple(names)


def cut_skin(mesh: SkinMesh) -> Cutting:
    """Front and back, cut on where the cloth would have to give too much, or where the two sides of a seam differ.

    No further than patches are few enough.
    """
    mesh = front_and_back(mesh)
    back = [False, True]
    patches = [flatten(disc_of(mesh, number)) for number in (0, 1)]
    given_up: set[int] = set()
    while len(patches) < MOST_PATCHES:
        wanting = {number: _excess(patch) for number, patch in enumerate(patches) if number not in given_up}
        worst = max(wanting, key=lambda number: wanting[number], default=-1)
        if worst < 0 or wanting[worst] <= 0:
            worst = _uneasy(mesh, patches)
            if worst < 0 or worst in given_up:
                break
        chord = best_chord(patches[worst], min(MOST_GIVE, distortion(patches[worst]).give(0.9)))
        if chord is None:
            given_up.add(worst)
            continue
        mesh = cut_chord(mesh, patches[worst], worst, chord)
        back.append(back[worst])
        patches[worst] = flatten(disc_of(mesh, worst))
        patches.append(flatten(disc_of(mesh, len(patches))))
        patches = [_on(mesh, number, patch) for number, patch in enumerate(patches)]
    return Cutting(mesh=mesh, patches=tuple(patches), back=tuple(back))


def _uneasy(mesh: SkinMesh, patches: list[Patch]) -> int:
    """The patch that spoils the worst seam, of which it has one side; -1 if all seams can be sewn."""
    seams = find_seams(mesh, tuple(patches), np.eye(3)[2])
    worst = max(seams, key=lambda seam: seam.mismatch)
    if worst.mismatch <= MOST_EASE:
        return -1
    off = [abs(length / worst.length - 1) for length in worst.lengths]
    return worst.patches[int(np.argmax(off))]


def _excess(patch: Patch) -> float:
    """Area that is distorted too much [mm^2], 0 if the patch is good enough."""
    bent = distortion(patch)
    if bent.give(0.95) <= MOST_GIVE and patch.outline.is_valid:
        return 0.0
    return float(bent.areas[bent.gives > MOST_GIVE].sum())


def _on(mesh: SkinMesh, number: int, patch: Patch) -> Patch:
    """The patch on the final mesh: a later cut beside it may have put vertices on its rim."""
    disc = disc_of(mesh, number)
    return patch if len(disc.vertices) == len(patch.disc.vertices) else flatten(disc)
