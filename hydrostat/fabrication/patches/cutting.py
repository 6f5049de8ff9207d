"""`cut_skin`: the skin of a body in as few patches as lie flat well enough, and what is wrong with them."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.patches.chord import MIN_NECK, best_chord, cut_chord, is_narrow
from hydrostat.fabrication.patches.flatten import distortion, flatten
from hydrostat.fabrication.patches.patch import Patch, disc_of
from hydrostat.fabrication.patches.seams import Seam, find_seams
from hydrostat.fabrication.patches.skin_mesh import SkinMesh, cut_at_zero
from hydrostat.fabrication.patterns.skin import Skin

LOOSE, HELD = 0.1, 0.03
"""The unit in which edges of the rim are counted that are longer or shorter than on the body: where only the cloth
matters, and where the two sides of a seam differ too much."""
_SPARED = 4.0  # a place whose square is so many times more counts less than by its third power: corners may give more


def relax_patch(patch: Patch, *, ease: float = LOOSE) -> Patch:
    """The flat image of least mean sixth power of the give; the rim keeps its length, edge by edge, as well as it can.

    `flatten` has the least mean square, which leaves some places with far more than others. Here s = (|J|^2 +
    |J^-1|^2 - 4) / 4 is about the square of the give of a triangle with the map J from body to cloth; the mean of s^3,
    in units of what cloth gives, is brought down from the patch as it lies by L-BFGS. Where s is far above that unit it
    counts less. No triangle turns over, for s grows without bound before. `ease` is the unit of the rim.
    """
    energy = PatchEnergy(patch, ease)
    from scipy.optimize import minimize  # Imported here: only what is sewn in space needs it.

    energy.turned_over = _FOLDED_ENERGY * energy(patch.flat.ravel())[0]
    options = {"maxiter": 300, "maxcor": 20}
    found = minimize(energy, patch.flat.ravel(), jac=True, method="L-BFGS-B", options=options)
    return replace(patch, flat=found.x.reshape(-1, 2)) if found.fun < energy.turned_over else patch


_FOLDED_ENERGY = 3.0
"""Energy of an image with a triangle on its back, as a multiple of that at the start: a line search goes back from
there by a share of its step. From 1e12 it went back to where it was, and ended."""


class PatchEnergy:
    """Energy that `relax_patch` minimizes, with its gradient: mean of s^3 over the cloth, and error of the rim.

    Attributes:
        turned_over: energy where a triangle lies on its back.
    """

    def __init__(self, patch: Patch, ease: float) -> None:
        disc, self._ease, self.turned_over = patch.disc, ease, np.inf
        self._corners, self._count = np.ascontiguousarray(disc.triangles.T), len(disc.vertices)
        back = np.linalg.inv(_in_plane(disc.vertices[disc.triangles]))
        self._back = np.ascontiguousarray(back.transpose(1, 2, 0))
        self._weights = disc.areas / disc.areas.sum()
        self._ends = np.stack([disc.rim, np.roll(disc.rim, -1)])
        self._lengths = np.linalg.norm(disc.vertices[self._ends[1]] - disc.vertices[self._ends[0]], axis=1)
        self._shares = self._lengths / self._lengths.sum()

    def __call__(self, numbers: Float[np.ndarray, " numbers"]) -> tuple[float, Float[np.ndarray, " numbers"]]:
        """The sum of both at the places of all vertices, and its derivative by each of these numbers."""
        flat = numbers.reshape(-1, 2)
        bent, derivative = self._cloth(flat)
        off, pull = self._rim(flat)
        return bent + off, (derivative + pull).ravel()

    def _cloth(self, flat: Float[np.ndarray, "vertices 2"]) -> tuple[float, Float[np.ndarray, "vertices 2"]]:
        """Number by number of the matrices: twice as fast as with arrays of small matrices."""
        (p, q), (r, s) = self._back
        (x0, x1, x2), (y0, y1, y2) = flat[:, 0][self._corners], flat[:, 1][self._corners]
        x1, x2, y1, y2 = x1 - x0, x2 - x0, y1 - y0, y2 - y0
        a, b, c, d = x1 * p + x2 * r, x1 * q + x2 * s, y1 * p + y2 * r, y1 * q + y2 * s
        area = a * d - b * c
        if area.min() <= 1e-6:
            return self.turned_over, np.zeros_like(flat)
        square, inverse = a * a + b * b + c * c + d * d, 1 / (area * area)
        give = 0.12  # unit of the cloth's stretch
        bent = np.maximum(square * (1 + inverse) / 4 - 1, 0.0) / give**2
        over = bent / _SPARED
        spared = 1 + over * over
        steep = self._weights * bent * bent * (3 * spared - 2 * over * over) / (spared * spared) / (4 * give**2)
        grow, turn = 2 * steep * (1 + inverse), 2 * steep * square * inverse / area
        a, b, c, d = grow * a - turn * d, grow * b + turn * c, grow * c + turn * b, grow * d - turn * a
        ahead, aside = (a * p + b * q, c * p + d * q), (a * r + b * s, c * r + d * s)
        forces = [np.concatenate([-one - other, one, other]) for one, other in zip(ahead, aside, strict=True)]
        return float(self._weights @ (bent * bent * bent / spared)), self._sum_corners(self._corners, forces)

    def _rim(self, flat: Float[np.ndarray, "vertices 2"]) -> tuple[float, Float[np.ndarray, "vertices 2"]]:
        x, y = (flat[self._ends[1]] - flat[self._ends[0]]).T
        squares = x * x + y * y
        off = np.log(np.sqrt(squares) / self._lengths) / self._ease
        pulls = 2 * self._shares * off / self._ease / squares
        forces = [np.concatenate([-pulls * way, pulls * way]) for way in (x, y)]
        return float(self._shares @ (off * off)), self._sum_corners(self._ends, forces)

    def _sum_corners(self, at: np.ndarray, forces: list[np.ndarray]) -> Float[np.ndarray, "vertices 2"]:
        """Sums over the corners at each vertex; forces along both axes, corner by corner."""
        return np.stack([np.bincount(at.ravel(), force, self._count) for force in forces], axis=1)


def _in_plane(corners: Float[np.ndarray, "triangles 3 3"]) -> Float[np.ndarray, "triangles 2 2"]:
    """Two sides of each triangle as columns, in a frame of its own plane, its normal up."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    length = np.linalg.norm(one, axis=1)
    along = (one * other).sum(axis=1) / length
    height = np.linalg.norm(np.cross(one, other), axis=1) / length
    return np.stack([np.stack([length, along], axis=1), np.stack([np.zeros_like(length), height], axis=1)], axis=1)


def thin_direction(mesh: SkinMesh) -> Float[np.ndarray, " 3"]:
    """The direction towards which, there and back, most of the skin looks; the axis where it is near one."""
    areas = np.maximum(mesh.areas, 1e-300)[:, None]
    normals = mesh.crosses / (2 * areas)
    direction = np.linalg.eigh((normals * areas).T @ normals)[1][:, -1]
    main = int(np.abs(direction).argmax())
    along_axis = 0.94  # a direction so near to an axis (its cosine) is the axis: 20 degrees
    if abs(direction[main]) > along_axis:
        direction = np.eye(3)[main]
    return direction * np.sign(direction[main])


def front_and_back(mesh: SkinMesh) -> SkinMesh:
    """The mesh in two discs: patch 0 looks against the thin direction (the front), patch 1 along it."""
    direction = thin_direction(mesh)
    field = _smooth_values(mesh, _looks(mesh, direction))
    cut, _, side = cut_at_zero(mesh, field, np.ones(len(mesh.triangles), dtype=bool))
    return cut.relabel_patches(two_discs(cut, side))


def two_discs(mesh: SkinMesh, side: Int[np.ndarray, " triangles"]) -> Int[np.ndarray, " triangles"]:
    """0 below and 1 above, islands given to what is round them, so that both are in one piece.

    On a closed surface without holes through it, a piece whose rest is one piece too is a disc.
    """
    above = _largest(mesh, (side > 0).astype(np.int64), 1)
    return 1 - _largest(mesh, 1 - above, 1)


def _largest(mesh: SkinMesh, label: Int[np.ndarray, " triangles"], value: int) -> Int[np.ndarray, " triangles"]:
    """1 in the largest piece with that label, else 0."""
    pieces = mesh.pieces(label)
    areas = np.bincount(pieces, mesh.areas * (label == value))
    return (pieces == int(areas.argmax())).astype(np.int64)


def _looks(mesh: SkinMesh, direction: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " vertices"]:
    """Cosine between the skin's normal at each vertex and a direction."""
    normals = mesh.facing
    return (normals @ direction) / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)


def _smooth_values(mesh: SkinMesh, values: Float[np.ndarray, " vertices"]) -> Float[np.ndarray, " vertices"]:
    """One implicit step of diffusion over the skin."""
    import igl

    # smoothing length of the normals before the silhouette is drawn, as a share of the body's diagonal
    smooth = 0.02
    reach = smooth * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu  # Imported here: not every command needs it.

    spread = csc_array(igl.intrinsic_delaunay_cotmatrix(mesh.vertices, mesh.triangles)[0])
    mass = np.bincount(mesh.triangles.ravel(), np.repeat(mesh.areas / 3, 3), len(mesh.vertices))
    return splu(csc_array(diags_array(mass) - reach**2 * spread)).solve(mass * values)


MAX_STRETCH = 0.12
"""Maximum stretch of the cloth in 95 % of a patch. Felt and woven plush stretch about that much; assumed, not
measured."""

MAX_EASE = 0.05  # How much longer one side of a seam may be than the other: the longer is eased in with pins. Assumed.


@dataclass(frozen=True, eq=False, kw_only=True)
class Cutting:
    """A skin in patches."""

    mesh: SkinMesh  # mesh of the whole skin
    patches: tuple[Patch, ...]  # in the order of their numbers
    back: tuple[bool, ...]  # True for each patch that was cut from the back

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
    """Cut front and back where cloth would give too much, or a seam's sides differ, while patches are few enough.

    Where to cut is seen on patches of least mean distortion: once evened out they have no worst place. The results of
    the last skins are kept: other cables on a body need no new search.
    """
    return _cut_skin(mesh.vertices.tobytes(), mesh.triangles.tobytes(), mesh.patch.tobytes())


@lru_cache(maxsize=4)
def _cut_skin(vertices: bytes, triangles: bytes, patch: bytes) -> Cutting:
    """Cut a skin whose arrays are given as bytes."""
    corners = np.frombuffer(triangles, int).reshape(-1, 3)
    mesh = SkinMesh(vertices=np.frombuffer(vertices).reshape(-1, 3), triangles=corners, patch=np.frombuffer(patch, int))
    mesh = front_and_back(mesh)
    back = [False, True]
    plain = [flatten(disc_of(mesh, number)) for number in (0, 1)]
    patches = [_lay_patch(patch) for patch in plain]
    given_up: set[int] = set()
    most_patches = 6  # a person loses track of more
    while True:
        wanting = {number: _excess(patch) for number, patch in enumerate(patches) if number not in given_up}
        worst = max(wanting, key=lambda number: wanting[number], default=-1)
        if worst < 0 or wanting[worst] <= 0:
            patches = _ease_patches(mesh, patches)
            worst = _uneasy(mesh, patches)
        if worst < 0 or worst in given_up or len(patches) == most_patches:
            break
        chord = best_chord(plain[worst], min(MAX_STRETCH, distortion(plain[worst]).give(0.9)))
        if chord is None:
            given_up.add(worst)
            continue
        mesh = cut_chord(mesh, plain[worst], worst, chord)
        back.append(back[worst])
        before, plain = plain, [_on(mesh, number, patch) for number, patch in enumerate([*plain, plain[worst]])]
        kept = [*zip(before, patches, strict=True)]
        patches = [next((own for old, own in kept if old is patch), None) or _lay_patch(patch) for patch in plain]
    return Cutting(mesh=mesh, patches=tuple(_ease_patches(mesh, patches)), back=tuple(back))


def _lay_patch(patch: Patch) -> Patch:
    """A patch as it is where that will do, else evened out where that gives less."""
    if _excess(patch) <= 0:
        return patch
    even = relax_patch(patch)
    gives = [distortion(one).give(0.95) if one.outline.is_valid else np.inf for one in (patch, even)]
    return even if gives[1] < gives[0] else patch


def _ease_patches(mesh: SkinMesh, patches: list[Patch]) -> list[Patch]:
    """The patches, rims held where seams could not be sewn, as far as the cloth of none gives too much for it."""
    eased, tried = list(patches), set()
    while (worst := _uneasy(mesh, eased)) >= 0 and worst not in tried:
        tried.add(worst)
        held = relax_patch(eased[worst], ease=HELD)
        if _excess(held) <= _excess(eased[worst]):
            eased[worst] = held
    return eased


def _uneasy(mesh: SkinMesh, patches: list[Patch]) -> int:
    """The patch that spoils the worst seam, of which it has one side; -1 if all seams can be sewn."""
    seams = find_seams(mesh, tuple(patches), np.eye(3)[2])
    worst = max(seams, key=lambda seam: seam.mismatch)
    if worst.mismatch <= MAX_EASE:
        return -1
    off = [abs(length / worst.length - 1) for length in worst.lengths]
    return worst.patches[int(np.argmax(off))]


def _excess(patch: Patch) -> float:
    """Area that is distorted too much [mm^2], 0 if the patch is good enough."""
    bent = distortion(patch)
    if bent.give(0.95) <= MAX_STRETCH and patch.outline.is_valid:
        return 0.0
    return float(bent.areas[bent.gives > MAX_STRETCH].sum())


def _on(mesh: SkinMesh, number: int, patch: Patch) -> Patch:
    """The patch on a mesh that was cut: it may be a piece of itself, or have new vertices on its rim."""
    disc = disc_of(mesh, number)
    return patch if len(disc.vertices) == len(patch.disc.vertices) else flatten(disc)


def patch_problems(
    names: tuple[str, ...], patches: tuple[Patch, ...], skins: tuple[Skin, ...], seams: tuple[Seam, ...]
) -> tuple[str, ...]:
    """Return the reasons why the patches cannot be sewn, one line each."""
    problems = []
    for name, patch, skin in zip(names, patches, skins, strict=True):
        give = distortion(patch).give(0.95)
        if give > MAX_STRETCH:
            problems.append(
                f"patch {name} would have to stretch or shrink by {give:.1%} to fit the body, more than "
                f"felt allows ({MAX_STRETCH:.0%}). Cast this body in a mold or simplify its shape"
            )
        if not patch.outline.is_valid:
            problems.append(f"patch {name} overlaps itself when flat. Cast this body in a mold")
        elif is_narrow(patch.outline):
            problems.append(
                f"patch {name} is narrower than {MIN_NECK:g} mm somewhere and cannot be sewn and turned. Cast this "
                "body in a mold or make it larger"
            )
        problems += [f"patch {name}: {problem}" for problem in skin.problems]
    worst = max(seams, key=lambda seam: seam.mismatch)
    if worst.mismatch > MAX_EASE:
        one, other = (names[number] for number in worst.patches)
        lengths = " and ".join(f"{length:.0f} mm" for length in worst.lengths)
        problems.append(
            f"the seam between patches {one} and {other} is {lengths} long on them, {worst.mismatch:.0%} apart. You "
            f"cannot ease in more than {MAX_EASE:.0%}. Cast this body in a mold or simplify its shape"
        )
    return tuple(problems)


def patch_notes(names: tuple[str, ...], skins: tuple[Skin, ...]) -> tuple[str, ...]:
    """Return the notes on sewing the patches, one line each."""
    return tuple(f"patch {name}: {note}" for name, skin in zip(names, skins, strict=True) for note in skin.notes)


def patch_warnings(names: tuple[str, ...], patches: tuple[Patch, ...], seams: tuple[Seam, ...]) -> tuple[str, ...]:
    """Return the warnings about the cloth, one line each."""
    warnings = []
    gives = {name: distortion(patch).give(0.95) for name, patch in zip(names, patches, strict=True)}
    most = max(gives, key=lambda name: gives[name])
    # Stretch of any cloth: above that a pattern requires a stretch fabric. Assumed, not measured
    gives_little = 0.06
    if gives[most] > gives_little:
        warnings.append(
            f"the cloth must stretch by up to {gives[most]:.0%} (patch {most}, 95 % of its area). Choose a cloth that "
            "stretches, such as knitted plush or soft felt"
        )
    ease = max((seam.mismatch for seam in seams), default=0.0)
    if ease > 0.01:
        warnings.append(f"sides of seams differ by up to {ease:.1%}. Pin notch to notch and ease in the longer side")
    return tuple(warnings)
