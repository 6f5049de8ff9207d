"""Risks of the body's mesh."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.geometry import (
    BOUNDARY_TOLERANCE,
    HOLE_SHARE,
    BoundaryTree,
    Mesh,
    Solid,
    euler,
    fill_small_holes,
    find_crossings,
    fit,
)
from hydrostat.kernel import native
from hydrostat.robot.body import Body
from hydrostat.robot.element_kind import Plane, Volume
from hydrostat.robot.risks.words import mm, place
from hydrostat.robot.robot import Robot

LOCKING_POISSON = 0.35
"""From this Poisson's ratio on, what locking adds to the bending stiffness of linear elements is worth a word."""

LOCKING = {
    2: {0.35: 0.14, 0.4: 0.20, 0.43: 0.27, 0.45: 0.35, 0.47: 0.54, 0.49: 1.4},
    3: {0.35: 0.12, 0.4: 0.20, 0.43: 0.31, 0.45: 0.45, 0.47: 0.77, 0.49: 2.4},
}
"""Relative bending stiffness added by locking, 4 elements across a limb, in 2D and 3D (`lab/locking/locking.py`)."""

MIN_ELEMENTS_ACROSS = {2: 2.0, 3: 3.0}
"""A limb with fewer elements across bends much too stiffly, in the plane and in space (docs/decisions/0012)."""


FEW_ELEMENTS = " elements across ("
"""Words of the sentence on a limb of few elements alone, whatever its elements are."""

MIN_QUADRATIC = 0.8
"""A limb with fewer quadratic elements across may bend 10 % too little or too much (docs/decisions/0044)."""

GOOD_ACROSS = 4
"""Elements across a limb that are enough: 14 % too stiff in the plane, 5 to 27 % in space, by the mesh's pattern."""

TOO_STIFF = {2: {2: "50 % or more"}, 3: {2: "20 to 100 % or more", 3: "10 to 100 %"}}
"""Excess bending stiffness of a limb with fewer elements across than the key, depending on the mesh pattern."""


def body_risks(robot: Robot) -> Iterator[str]:
    """Bad angles, meshes unlike their surface, locking, and limbs of few elements."""
    mesh = robot.body.mesh
    yield from _flat_angles(mesh) if mesh.dim == 2 else _slivers(mesh)
    yield from _unlike(robot.body)
    yield from _locking(robot.body)
    yield from _crossing(mesh)
    yield from _thin(robot.body)
    if robot.body.thickness is not None and robot.body.thickness > mesh.size:
        yield f"body.thickness: {mm(robot.body.thickness)}, more than the size of {mm(mesh.size)}; check its unit"


def _flat_angles(mesh: Mesh) -> Iterator[str]:
    least_angle = 20.0  # triangles with a smaller angle [degrees] make the simulation less exact
    if mesh.smallest_angle() < least_angle:
        yield f"body: the mesh has an angle of {mesh.smallest_angle():.0f} degrees; try another element_size"


def _crossing(mesh: Mesh) -> Iterator[str]:
    """Body that passes through itself, or touches itself, before it moves."""
    found = find_crossings(mesh, mesh.nodes)
    if len(found):
        where = place(found.places[0])
        yield f"body: at rest it passes through itself, for instance at {where}; contact does not mend that"
        return
    near = _touching(mesh)
    if len(near):
        yield (
            f"body: at rest it touches itself, for instance at {place(near[0])}; contact counts what touches at rest "
            f"as grown together: leave a gap there, or join the parts"
        )


def _touching(mesh: Mesh) -> Points:
    """Places at which parts of the boundary that have no node in common lie on one another [m]."""
    touches = 1e-6  # Parts that are nearer than this share of the size of the body touch
    reach = touches * mesh.size
    pairs = BoundaryTree(mesh).pairs(mesh.nodes, reach)
    squared = np.empty(len(pairs.edges))
    native.squared_distances(mesh.nodes, *pairs, 0.0, squared)
    return mesh.nodes[pairs.stencils[squared < reach**2, 0]]


def _slivers(mesh: Mesh) -> Iterator[str]:
    angles = mesh.dihedral_angles()
    least_dihedral = 10.0  # tetrahedra with a smaller angle between two faces [degrees] do so, too
    count = int((angles < least_dihedral).sum())
    if count:
        flattest = int(np.argmin(angles))
        where = place(mesh.nodes[mesh.elements[flattest]].mean(axis=0))
        yield (
            f"body: {count} of {len(angles)} tetrahedra {'is a sliver' if count == 1 else 'are slivers'} (below "
            f"{least_dihedral:.0f} degrees between two faces; the worst {angles[flattest]:.1f}, at {where}): too stiff "
            f"and slow to solve; mesh the body again"
        )


def _unlike(body: Body) -> Iterator[str]:
    """Find parts of a surface that its mesh does not follow in spite of finer elements there.

    Holes that were filled on purpose do not count.
    """
    if body.healing is None or body.element_size is None:
        return
    surface = fill_small_holes(body.healing.surface, HOLE_SHARE * body.element_size).surface
    found = fit(body.mesh, Solid(surface), body.element_size / 3)
    worst = int(np.argmax(found.distances))
    if found.largest > BOUNDARY_TOLERANCE * body.element_size:
        yield (
            f"body: near {place(found.places[worst])} the mesh is {mm(found.largest)} off the surface, which is "
            f"sharper or thinner there than its elements (volume {100 * (found.volume - 1):+.1f} %); a smaller "
            "element_size follows it"
        )
    if euler(body.mesh.boundary) != euler(surface.triangles):
        yield (
            "body: the mesh has other holes than the surface: limbs with a narrow gap between them have grown "
            "together, or a thin wall is pierced; look at the picture, and take a smaller element_size"
        )


def _locking(body: Body) -> Iterator[str]:
    poisson = body.material.poisson
    if body.plane is Plane.STRESS:
        return
    if poisson >= LOCKING_POISSON and body.volume is Volume.ELEMENT and body.mesh.quadratic is None:
        added = max(part for ratio, part in LOCKING[body.mesh.dim].items() if ratio <= poisson)
        yield (
            f"body.material: Poisson's ratio {poisson:g}: linear elements lock; with 4 of them across a limb it can be "
            f'{100 * added:.0f} % too stiff in bending for that alone; try elements = "quadratic" or volume = "patch"'
        )


def _thin(body: Body) -> Iterator[str]:
    dim, quadratic = body.mesh.dim, body.mesh.quadratic is not None
    thickness = body.measured_thickness
    rigid = np.array([False, *(part.is_rigid for part in body.parts)])
    if rigid.any():  # rigid parts do not bend
        bends = ~rigid[body.element_materials[body.mesh.boundary_elements]]
        thickness = replace(
            thickness,
            chords=thickness.chords[bends],
            middles=thickness.middles[bends],
            spacing=thickness.spacing[bends],
            areas=thickness.areas[bends],
        )
    parts = thickness.thin_parts(2 * MIN_QUADRATIC if quadratic else MIN_ELEMENTS_ACROSS[dim])
    if not parts:
        return
    thinnest = parts[0]
    others = f", and {len(parts) - 1} more such part{'s' if len(parts) > 2 else ''}" if len(parts) > 1 else ""
    if quadratic:
        yield (
            f"body: a limb has only {thinnest.across / 2:.1f} quadratic elements across ({mm(thinnest.thickness)} "
            f"thick at {place(thinnest.place)}{others}): its bending may be 10 % off or more; "
            "take a smaller element_size"
        )
        return
    percent = next(text for count, text in TOO_STIFF[dim].items() if thinnest.across < count)
    size = f"{1e3 * min(part.thickness for part in parts) / GOOD_ACROSS:.2g} mm"
    yield (
        f"body: a limb has only {thinnest.across:.1f} elements across ({mm(thinnest.thickness)} thick at "
        f"{place(thinnest.place)}{others}): linear elements make it {percent} too stiff in bending; "
        + (f'element_size = "{size}" would do' if body.element_size else f"a mesh with edges of {size} would do")
        + ', as would elements = "quadratic"'
    )
