"""Checks whether printed parts can be sliced, fit together, and take in cable as the robot file says."""

from collections.abc import Iterable

import numpy as np
from manifold3d import Error

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.solids.assembly import MIN_OVERLAP, PartAssembly, interferences
from hydrostat.fabrication.solids.construct import sides_text
from hydrostat.fabrication.solids.printed import Printed, loose_edges, number_groups
from hydrostat.robot import Robot
from hydrostat.units import plural


def watertight_problems(printed: Printed) -> tuple[str, ...]:
    """A sentence for each thing that is wrong with a part; none if it can be sliced.

    The triangles are those of the files, counted here, whatever the boolean engine says of its own work: each edge is
    used twice, in opposite directions; together they enclose the volume of the solid, in one piece; it stands on the
    bed.
    """
    if printed.solid.status() != Error.NoError:
        return (f"{printed.name}: the solid is no solid ({printed.solid.status().name})",)
    vertices, triangles = printed.file_mesh
    if len(triangles) == 0:
        return (f"{printed.name}: the solid is empty",)
    problems = []
    if loose := loose_edges(triangles):
        problems.append(f"{printed.name}: {loose} edges do not have exactly one triangle on either side")
    volume = compute_volume(vertices, triangles)
    change = 1e-4  # by how much of itself a volume may change when a part is written
    if not volume > 0:
        problems.append(f"{printed.name}: its triangles enclose no volume, or are inside out")
    elif abs(volume - printed.volume) > change * volume:
        problems.append(f"{printed.name}: {printed.volume:.6g} mm^3 became {volume:.6g} mm^3 in its files")
    if (pieces := _pieces(vertices, triangles)) > 1:
        problems.append(f"{printed.name}: falls into {pieces} pieces")
    lowest = float(vertices[:, 2].min())
    on_bed = 1e-4  # maximum distance of the lowest point from the bed [mm]
    if abs(lowest) > on_bed:
        problems.append(f"{printed.name}: its lowest point is at z = {lowest:.4f} mm, not on the bed")
    return tuple(problems)


def compute_volume(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> float:
    """Volume within triangles [mm^3] by the divergence theorem; negative if they are inside out."""
    corners = vertices[triangles] - vertices.mean(axis=0)
    return float(_wedges(corners).sum())


def _wedges(corners: Float[np.ndarray, "triangles 3 3"]) -> Float[np.ndarray, " triangles"]:
    """Volumes between each triangle and the origin [mm^3]."""
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6


def _pieces(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> int:
    """Bodies that share no vertex; hollows within a body are inside out and do not count."""
    links = np.stack([triangles, np.roll(triangles, 1, axis=1)], axis=2).reshape(-1, 2)
    body = number_groups(links, len(vertices))
    volumes = np.bincount(body[triangles[:, 0]], _wedges(vertices[triangles] - vertices.mean(axis=0)))
    # volume below which a body of its own is no piece of a part, only a leftover of rounding [mm^3]
    crumb = 1e-3
    return int(np.count_nonzero(volumes > crumb))


def solid_checks(printed: Iterable[Printed], assemblies: Iterable[PartAssembly]) -> tuple[Check, ...]:
    """Every part watertight, by its edges as they are written; no two of an assembly in one place, by booleans."""
    printed, assemblies = tuple(printed), tuple(assemblies)
    faults = [fault for part in printed for fault in watertight_problems(part)]
    clashes = [
        f"{clash.one} and {clash.other} share {clash.volume:.2f} mm^3"
        for assembly in assemblies
        for clash in interferences(assembly)
    ]
    pieces = sum(len(assembly.pieces) for assembly in assemblies)
    return (
        Check(
            what=f"all {len(printed)} printed parts are watertight",
            measured="; ".join(faults) or "each edge joins two triangles",
            allowed="no hole",
            passed=not faults,
        ),
        Check(
            what=f"no overlap among {plural(pieces, 'piece')} of {plural(len(assemblies), 'unit')}",
            measured="; ".join(clashes) or "nothing shared",
            allowed=f"a film of {1e3 * MIN_OVERLAP:g} micrometer",
            passed=not clashes,
        ),
    )


def too_large(printed: Iterable[Printed], bed: tuple[float, float, float]) -> tuple[str, ...]:
    """Return a line for each part that does not fit on the printer's bed [mm]; it may be rotated, not tilted."""
    return tuple(
        f"{part.name} of {sides_text(part.size)} mm does not fit the printer ({sides_text(bed)} mm). Use a "
        "larger printer"
        for part in printed
        if not part.fits(bed)
    )


def spool_checks(robot: Robot, units: Iterable[WinchUnit]) -> tuple[Check, ...]:
    """Each groove cut across its middle: the floor that is measured there, and half a cable, against the robot file."""
    gaps = [gap for unit in units for gap in _gaps(robot, unit)]
    if not gaps:
        return ()
    worst = max(gaps)
    radius = 0.1  # maximum error of the radius at which a cable is wound [mm]
    return (
        Check(
            what=f"radius of {plural(len(gaps), 'groove')} of the printed spools as simulated",
            measured=f"at most {worst:.3f} mm off",
            allowed=f"{radius:g} mm",
            passed=worst <= radius,
        ),
    )


def _gaps(robot: Robot, unit: WinchUnit) -> Iterable[float]:
    solid = next(part.solid for part in unit.printed if part.name.startswith("spool"))
    usual = robot.winch(unit.winch).spool_radius
    for (cable, *_), middle in zip(unit.wound, unit.spool.middles, strict=True):
        rings = solid.slice(middle).to_polygons()
        floor = max(float(np.linalg.norm(ring, axis=1).max()) for ring in rings)
        yield abs(floor + unit.spool.cable / 2 - 1e3 * (robot.cables[cable].spool_radius or usual))
