"""`Seam`: where two patches are sewn together, as it runs on the body and on both of them; its notches."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.skin_mesh import SkinMesh
from hydrostat.fabrication.patterns.shape import Place
from hydrostat.fabrication.patterns.skin import notch_letters


@dataclass(frozen=True, eq=False, kw_only=True)
class Seam:
    """A stretch of seam between two patches."""

    patches: tuple[int, int]  # their numbers; the first has it on its left, seen from outside
    closed: bool  # True if it ends where it begins
    solid: Float[np.ndarray, "vertices 3"]  # its vertices on the body [mm], the first again at the end of a closed one
    # the same on the first and on the second patch [mm]
    sides: tuple[Float[np.ndarray, "vertices 2"], Float[np.ndarray, "vertices 2"]]

    @cached_property
    def along(self) -> Float[np.ndarray, " vertices"]:
        """Distance of each vertex along the seam on the body [mm]."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.solid, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Length on the body [mm]."""
        return float(self.along[-1])

    @property
    def lengths(self) -> tuple[float, float]:
        """Lengths on the two patches [mm]."""
        one, other = (float(np.linalg.norm(np.diff(side, axis=0), axis=1).sum()) for side in self.sides)
        return one, other

    @property
    def mismatch(self) -> float:
        """Excess length of the longer side over the shorter, less the visible limit (`SEEN`): 0.01 for 1 %."""
        return max(max(self.lengths) - min(self.lengths) - SEEN, 0.0) / min(self.lengths)

    def place(self, along: float, side: int) -> tuple[float, float]:
        """Place of the seam on its first (0) or second (1) patch [mm]."""
        x, y = (float(np.interp(along, self.along, self.sides[side][:, axis])) for axis in (0, 1))
        return x, y

    def on_body(self, along: float) -> tuple[float, float, float]:
        """Place of the seam on the body [mm]."""
        x, y, z = (float(np.interp(along, self.along, self.solid[:, axis])) for axis in range(3))
        return x, y, z

    def nearest(self, point: Float[np.ndarray, " 3"]) -> tuple[float, float]:
        """Distance of a point of the body from the seam, and how far along it is nearest [mm]."""
        starts, ways = self.solid[:-1], np.diff(self.solid, axis=0)
        lengths = np.linalg.norm(ways, axis=1)
        share = np.clip(((point - starts) * ways).sum(axis=1) / lengths**2, 0, 1)
        gaps = np.linalg.norm(starts + share[:, None] * ways - point, axis=1)
        best = int(gaps.argmin())
        return float(gaps[best]), float(self.along[best] + share[best] * lengths[best])


def find_seams(mesh: SkinMesh, patches: tuple[Patch, ...], up: Float[np.ndarray, " 3"]) -> tuple[Seam, ...]:
    """All seams; a closed one begins where it is highest."""
    rims = [_rim(patch) for patch in patches]
    owner = {edge: number for number, rim in enumerate(rims) for edge in rim}
    seams = []
    for number, (patch, rim) in enumerate(zip(patches, rims, strict=True)):
        around = list(rim)
        beyond = np.array([owner[end, start] for start, end in around])
        changes = np.flatnonzero(beyond != np.roll(beyond, 1))
        closed = not len(changes)
        if closed:
            heights = mesh.vertices[[start for start, _ in around]] @ up
            changes = np.array([int(heights.argmax())])
        for first, last in zip(changes.tolist(), [*changes[1:].tolist(), int(changes[0]) + len(around)], strict=True):
            edges = [around[index % len(around)] for index in range(first, last)]
            other = int(beyond[first])
            if other > number:
                local = np.array([*(rim[edge][0] for edge in edges), rim[edges[-1]][1]])
                back = [rims[other][end, start] for start, end in edges]
                theirs = np.array([*(end for _, end in back), back[-1][0]])
                seams.append(_seam((number, other), closed, (patch, patches[other]), (local, theirs)))
    return tuple(seams)


def _rim(patch: Patch) -> dict[tuple[int, int], tuple[int, int]]:
    """Edges of the boundary in order: vertices of the skin, and the patch's own."""
    starts = patch.disc.rim
    ends = np.roll(starts, -1)
    ways = zip(patch.disc.of[starts].tolist(), patch.disc.of[ends].tolist(), strict=True)
    return dict(zip(ways, zip(starts.tolist(), ends.tolist(), strict=True), strict=True))


def _seam(
    numbers: tuple[int, int],
    closed: bool,
    patches: tuple[Patch, Patch],
    local: tuple[Int[np.ndarray, " vertices"], Int[np.ndarray, " vertices"]],
) -> Seam:
    one, other = (patch.flat[vertices] for patch, vertices in zip(patches, local, strict=True))
    return Seam(patches=numbers, closed=closed, solid=patches[0].disc.vertices[local[0]], sides=(one, other))


SEEN = 0.5
"""A difference of lengths [mm] that nobody who cuts and sews cloth sees: that of a line of a pen. Assumed."""


@dataclass(frozen=True, kw_only=True)
class PatchNotch:
    """A mark by which two patches are matched."""

    name: str  # the same letters on both; empty for the second stroke of a double notch
    place: Place  # on the seam line [mm]


def _notch_places(seam: Seam) -> list[tuple[float, bool]]:
    """Return the distance of each notch along a seam [mm], and True if it has a letter."""
    shortest = 10.0  # a seam shorter than that [mm] needs no notch
    if seam.length < shortest:
        return []
    spacing = 60.0  # about how far apart notches are along a seam [mm]
    if not seam.closed:
        count = max(1, round(seam.length / spacing) - 1)
        return [(seam.length * (step + 1) / (count + 1), True) for step in range(count)]
    count = max(4, round(seam.length / spacing))
    pair = 5.0  # distance of the strokes of a double notch [mm]
    return [(0.0, True), (pair, False), *((seam.length * step / count, True) for step in range(1, count))]


def _name_notches(seams: tuple[Seam, ...]) -> list[list[tuple[str, float]]]:
    """Letters and places of the notches of each seam."""
    letters = notch_letters()
    return [[(next(letters) if lettered else "", along) for along, lettered in _notch_places(seam)] for seam in seams]


def patch_notches(seams: tuple[Seam, ...]) -> dict[int, list[PatchNotch]]:
    """The notches of each patch: at the same place of the body on both sides of a seam."""
    found: dict[int, list[PatchNotch]] = {number: [] for seam in seams for number in seam.patches}
    for seam, named in zip(seams, _name_notches(seams), strict=True):
        for side, number in enumerate(seam.patches):
            found[number] += [PatchNotch(name=name, place=seam.place(along, side)) for name, along in named]
    return found


def stuffing_gap(seams: tuple[Seam, ...], names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the sentence on where a body without a zipper is turned and stuffed."""
    lengths = [seam.length for seam in seams]
    longest = int(np.argmax(lengths))
    seam, named = seams[longest], [notch for notch in _name_notches(seams)[longest] if notch[0]]
    if len(named) < 2:
        return ("no seam is long enough to turn the body through: close the last one by hand",)
    stuffing = 80.0  # length of seam left open for turning and stuffing where there is no zipper [mm], about
    first, second = min(pairwise(named), key=lambda pair: (abs(pair[1][1] - pair[0][1] - stuffing), pair[0][1]))
    one, other = (names[number] for number in seam.patches)
    return (
        f"leave the seam between {one} and {other} open from notch {first[0]} to notch {second[0]} "
        f"({second[1] - first[1]:.0f} mm): turn and stuff the body through it, then close it by hand",
    )
