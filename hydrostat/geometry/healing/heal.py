"""`heal`: one closed body from a faulty surface, as from scans, CAD or damaged files, with a report of repairs."""

import numpy as np

from hydrostat.arrays import Bool, Int
from hydrostat.errors import SurfaceError
from hydrostat.geometry.healing.faults import MAX_PAIRS, crossing_pairs, describe_faults, pieces_of, sliver_count
from hydrostat.geometry.healing.healing import Healing, Piece
from hydrostat.geometry.healing.mend import (
    MERGE_TOLERANCE,
    Holes,
    Welded,
    holes_of,
    members_of,
    one_way,
    sides_of,
    weld,
    with_closed,
)
from hydrostat.geometry.healing.remake import Remade, deviation, remake
from hydrostat.geometry.healing.shells import Role, Shells, shells_of
from hydrostat.geometry.surface import Surface
from hydrostat.units import plural

_MAX_PARTS = 20_000


def heal(surface: Surface, *, resolution: float) -> Healing:
    """One closed body of a surface that may have holes, flipped triangles, crossings, overlaps, slivers and specks.

    Triangles are kept, and with them sharp edges, as long as that gives a closed body: vertices are merged, repeated
    triangles left out, patches turned one way, holes closed that are no longer around than 24 times the resolution [m],
    specks removed. Only where this is not enough (crossings, overlaps, larger holes, edges with more than two
    triangles) the body is made again, as the region whose generalized winding number is above one half (Jacobson et al.
    2013, by the fast sum of Barill et al. 2018), on a grid of the resolution; edges and corners are rounded then by up
    to about half of it. A quarter of the element size is a good choice. What overlaps is united. Cavities stay if they
    are closed and clean: all their triangles look one way, inward; a closed part that looks outward inside another is
    overlap. Raises SurfaceError: it encloses nothing, its holes are too large, it is too thin for the resolution, or it
    is several bodies apart from each other.
    """
    if not (np.isfinite(resolution) and resolution > 0.0):
        raise SurfaceError(f"the resolution to heal with is {resolution!r} m, but has to be above 0")
    _check_loose(surface)
    welded = weld(surface)
    _check_parts(welded.surface)
    triangles, flipped = one_way(welded.surface.triangles)
    turned = Surface(welded.surface.vertices, triangles)
    holes = holes_of(turned)
    small = _small_holes(turned, holes, resolution)
    filled = with_closed(turned, holes, small) if small.any() else turned
    flipped = np.concatenate([flipped, np.zeros(len(filled.triangles) - len(flipped), dtype=bool)])
    crossing = crossing_pairs(filled)
    _check_tangle(crossing)
    shells = shells_of(filled, flipped, crossing, resolution)
    keep = shells.of_role(Role.BODY, Role.CAVITY)[shells.label]
    kept = shells.surface.part(keep)
    removed = pieces_of(shells)
    faults = describe_faults(welded, turned, holes, int(flipped.sum()), crossing, shells, sliver_count(filled))
    found = (*surface.notes, *faults)
    done = _describe_repairs(welded, int(flipped.sum()), shells, int(small.sum()))
    if _is_closed(kept) and not keep[crossing].any() and shells.of_role(Role.BODY).sum() == 1:
        patched = np.linalg.norm(filled.crosses, axis=1)[len(triangles) :].sum() / 2 / filled.area
        clean = not (done or removed)
        return Healing(kept, found, done, removed, kept.volume, kept.volume, 0.0, float(patched), clean)
    return _made_anew(kept, shells, found, done, removed, resolution)


def _check_loose(surface: Surface) -> None:
    """Refuse a soup before its vertices are joined: a part of some triangles has at most two vertices more."""
    cells = np.floor((surface.vertices - surface.box[0]) / (4 * MERGE_TOLERANCE * surface.size)).astype(np.int64)
    places = len(np.unique(cells @ np.array([1 << 36, 1 << 18, 1])))
    parts = (places - len(surface.triangles)) // 2
    if parts > 3 * _MAX_PARTS:  # some that are near are counted twice, as a cell ends between them
        raise _loose(parts)


def _loose(parts: int) -> SurfaceError:
    return SurfaceError(
        f"the surface falls into {parts} loose parts, at most {_MAX_PARTS} are read: this is no surface of a body; in "
        "the program it comes from, join its vertices, and export it again"
    )


def _check_parts(surface: Surface) -> None:
    """Reject input that is no surface and would take long: thousands of loose triangles, or hundreds at one edge."""
    sides = sides_of(surface.triangles)
    most = int(sides.counts.max(initial=0))
    most_at_edge = 200
    if most > most_at_edge:
        raise SurfaceError(
            f"{most} triangles meet at one edge, where a surface has two: this is no surface of a body, perhaps the "
            "file is damaged; export it again"
        )
    parts = int(sides.groups(sides.counts > 1).max(initial=0)) + 1
    if parts > _MAX_PARTS:
        raise _loose(parts)


def _check_tangle(crossing: Int[np.ndarray, "pairs 2"]) -> None:
    """Reject input that is no surface: most of the triangles that cross any cross many others."""
    counts = np.bincount(crossing.ravel())
    usual = float(np.median(counts[counts > 0])) if len(crossing) else 0.0
    if len(crossing) >= MAX_PAIRS:  # of the first triangles only, as no more were looked for
        usual = max(usual, len(crossing) / (1 + int(crossing[:, 0].max())))
    most_crossed = 20
    if usual > most_crossed:
        raise SurfaceError(
            f"the triangles run through each other everywhere, most through more than {most_crossed} others: this "
            "is no surface of a body, perhaps the file is damaged; export it again"
        )


def _small_holes(surface: Surface, holes: Holes, resolution: float) -> Bool[np.ndarray, " holes"]:
    """Holes that are closed by fans: simple, short, and small beside the part that they are in."""
    sides = sides_of(surface.triangles)
    label = sides.groups(sides.counts > 1)
    area = np.bincount(label, np.linalg.norm(surface.crosses, axis=1) / 2)
    owner = np.zeros(len(surface.vertices), dtype=np.int64)
    owner[surface.triangles] = label[:, None]
    part = np.zeros(len(holes), dtype=np.int64)
    part[holes.label] = owner[holes.edges[:, 0]]
    small_hole = 24.0  # resolutions around: about two elements across
    return holes.simple & (holes.length <= small_hole * resolution) & (holes.length**2 < area[part])


def _is_closed(surface: Surface) -> bool:
    """Return True if every edge has two triangles of opposite direction, and every vertex one fan of triangles."""
    import igl

    sides = sides_of(surface.triangles)
    return bool(
        (sides.counts == 2).all() and not sides.is_misoriented.any() and np.all(igl.is_vertex_manifold(sides.triangles))
    )


def _describe_repairs(welded: Welded, flipped: int, shells: Shells, closed: int) -> tuple[str, ...]:
    """Describe the repairs so far, a line each."""
    counts = (
        (welded.flat + welded.repeated + welded.walls, "triangle", "without area or that stood there twice left out"),
        (flipped, "flipped triangle", "turned"),
        (int(shells.inside_out.sum()), "part", "turned, as what was inside was outside"),
        (closed, "small hole", "closed"),
    )
    return tuple(f"{plural(count, noun)} {text}" for count, noun, text in counts if count)


def _made_anew(
    kept: Surface,
    shells: Shells,
    found: tuple[str, ...],
    done: tuple[str, ...],
    removed: tuple[Piece, ...],
    want: float,
) -> Healing:
    """Body by its winding number."""
    made = remake(kept, shells.boxes[shells.of_role(Role.CAVITY)], want)
    off = deviation(kept, made.surface, made.spacing)
    most_patched = 0.25
    if off.patched > most_patched:
        raise SurfaceError(
            f"the surface has holes so large that {off.patched:.0%} of the body's surface would be guessed, at most "
            f"{most_patched:.0%} are: scan what is missing, or close the holes in the program it comes from"
        )
    lost = _lost_pieces(kept, off.lost, made)
    anew = [f"made again on a grid of {1e3 * made.spacing:.3g} mm: edges and corners are rounded by up to half of it"]
    if made.spacing > want:
        anew.append(f"the grid is coarser than the {1e3 * want:.3g} mm asked for, which would have too many points")
    holes = holes_of(kept)
    closed = with_closed(kept, holes, holes.simple) if holes.simple.any() else kept
    return Healing(
        surface=made.surface,
        found=found,
        done=(*done, *anew, *made.done),
        removed=(*removed, *made.removed, *lost),
        volume_before=closed.volume,
        volume_after=made.surface.volume,
        largest_distance=off.largest,
        patched=off.patched,
        clean=False,
    )


def _lost_pieces(kept: Surface, lost: Int[np.ndarray, " lost"], made: Remade) -> tuple[Piece, ...]:
    """Pieces that were too thin for the grid; refused if they are much."""
    if not len(lost):
        return ()
    areas = np.linalg.norm(kept.crosses, axis=1)
    share = float(areas[lost].sum() / areas.sum())
    most_lost = 0.1
    if share > most_lost:
        raise SurfaceError(
            f"{share:.0%} of the surface belong to parts that are open, or thinner than the "
            f"{1e3 * made.spacing:.3g} mm that it is healed with: close them where the surface comes from, or use "
            "smaller elements"
        )
    sides = sides_of(kept.triangles[lost])
    label = sides.groups(sides.counts > 1)
    why = "open, or too thin for the grid it was healed with"
    return tuple(Piece.of(kept, lost[numbers], why) for numbers in members_of(label))
