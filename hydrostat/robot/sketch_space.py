"""First robots from nothing but a body in space, to be edited from there."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Healing, Mesh, Outline, Solid, Surface, clearance, heal, locate, size_for
from hydrostat.given import Point
from hydrostat.robot.body import Body, Source
from hydrostat.robot.cable import Cable
from hydrostat.robot.limb_tips import find_limb_tips, measure_geodesics, name_tips
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.materials import get_material
from hydrostat.robot.pin import Pin
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Winch

NODES = 900
"""Nodes of a sketch, if neither a number nor an element size is asked for: as many as the thesis's hand (N3)."""


@dataclass(frozen=True, eq=False)
class SurfaceSketch:
    """Robot created from a surface, with the report of its healing."""

    robot: Robot  # robot whose body file is the input if that was clean, else the healed surface as PLY
    before: Surface  # surface before healing
    healing: Healing  # report of the healing
    notes: tuple[str, ...] = ()  # notes on the mesh

    @staticmethod
    def of_scan(
        content: bytes,
        *,
        file: str,
        name: str,
        size: float | None = None,
        element_size: float | None = None,
        nodes: int | None = None,
        material: str = "flexfoam-it x",
        tell: Callable[[str], None] | None = None,
    ) -> "SurfaceSketch":
        """Robot from the bytes of a scan or CAD model; coordinates count in mm if the file does not say.

        Args:
            content: bytes of an STL, OBJ, PLY, OFF or 3MF file.
            file: its name.
            name: name of the robot.
            size: longest side of the bounding box [m]; None: as the file says.
            element_size: [m]; None: so that there are about as many nodes as asked for.
            nodes: wanted; None: as many as the thesis's hand has; not used with an element size.
            material: a name from the table.
            tell: called with what is done next, such as "healing 12,000 triangles".

        Raises:
            InputError: the file is no body.
        """
        from hydrostat.geometry import read_surface, tetrahedralize, write_ply

        known, nodes = get_material(material), NODES if nodes is None else nodes
        before = read_surface(content, name=file, size=size)
        _check_scale(before.size, size)
        told = tell or _silent
        told(f"healing {len(before.triangles):,} triangles")
        healing = heal(before, resolution=(element_size or _guess(before, nodes)) / 4)
        closed, meshes = healing.surface, {}

        def fill(trial: float) -> Mesh:
            told(f"filling it with elements of {1e3 * trial:.3g} mm" + f", try {len(meshes) + 1}" * bool(meshes))
            most = 1.6 if meshes else 4.0
            thin = 0.1  # where as much breaks off a coarser lattice, finer elements there make as many nodes again
            meshes[trial] = tetrahedralize(
                closed,
                trial,
                most_nodes=np.inf if element_size else most * nodes,
                most_lost=thin if meshes and trial > min(meshes) else 1.0,
            )
            return meshes[trial]

        length = element_size or size_for(nodes, fill, content=closed.volume, rim=closed.area, dim=3, is_hasty=True)
        if not healing.clean:
            content, file, size = write_ply(closed), f"{PurePath(file).stem}_healed.ply", None
        body = Body(
            source=Source.SURFACE,
            file=file,
            content=content,
            material=known,
            size=size,
            element_size=length,
            mesh=meshes[length] if length in meshes else fill(length),
            healing=healing,
        )
        told("finding ends, winches and cables")
        filled = describe_filled_holes(body)
        return SurfaceSketch(_first_robot(body, name), before, healing, (filled,) if filled else ())


def _silent(stage: str) -> None:
    """Nobody listens."""


def inflate_outline(outline: Outline, height: float) -> bytes:
    """Inflate an outline to a body of this largest thickness [m]; return a PLY file for `SurfaceSketch.of_scan`.

    Raises:
        InputError: the height does not fit the outline, or that is too thin somewhere.
    """
    from hydrostat.geometry import inflate, write_ply

    return write_ply(inflate(outline, height, spacing=outline.size / 80))


def sketch_mesh(path: Path, *, name: str, size: float | None = None, material: str = "flexfoam-it x") -> Robot:
    """Robot from a ready mesh of tetrahedra, in mm unless a size [m] is given (InputError: no mesh in space)."""
    body = Body.from_mesh(path, unit=1e-3, material=get_material(material), size=size)
    _check_scale(body.mesh.size, size)
    return _first_robot(body, name)


def _check_scale(length: float, size: float | None) -> None:
    """Refuse bodies so small or large that the file probably counts in another unit."""
    shortest, longest = 0.002, 20.0  # bodies are as long [m]; what is not was probably meant in another unit
    if shortest <= length <= longest:
        return
    meant = 1e3 * length if length < shortest else 1e-3 * length
    hint = f'; files without a unit are read as mm: give a size, perhaps "{1e3 * meant:.3g} mm"' if size is None else ""
    raise InputError(f"the body would be {1e3 * length:.3g} mm long, not {1e3 * shortest:g} mm to {longest:g} m{hint}")


def _guess(surface: Surface, nodes: int) -> float:
    """Element size [m] for a number of nodes in a surface that may be open."""
    box = float(np.prod(np.ptp(surface.box, axis=0)))
    return float((max(min(abs(surface.volume), box), 0.05 * box, 1e-3 * surface.size**3) / nodes) ** (1 / 3))


_STOUT = 0.35
"""An end with such a share of the largest cross section is a good place to hold: a wrist, not the tip of an arm."""

_STATIONS = np.linspace(0.06, 0.9, 12)

_SPOOL, _MIN_SPOOL = 0.006, 0.002


def _first_robot(body: Body, name: str) -> Robot:
    """Body with first boundary conditions (a pin) and one tendon: a cable along its longest limb, a marker at each tip.

    It is held at the stouter end of its longest side, or, if both ends are slender as of a starfish, round its deepest
    point. The limb is the longest way through the body from there; the cable lies on one side of it, and the pose bends
    it to that side.
    """
    mesh = body.mesh
    solid = Solid(Surface(mesh.nodes, mesh.boundary) if body.healing is None else body.healing.surface)
    pin = _hold(mesh)
    limb = _limb(mesh, pin.holds(mesh))
    middles = _smooth_line(np.array([limb.middle(mesh, share) for share in _STATIONS]))
    side = _side(mesh, middles[-1] - middles[0])
    leave = np.minimum(np.arange(len(_STATIONS)) / 3, 1.0)  # winch in the middle, where there is most room for it
    ways = [part * limb.reach(mesh, share, side) * side for part, share in zip(leave, _STATIONS, strict=True)]
    covered = [_cover_offset(mesh, solid, middle, way) for middle, way in zip(middles, ways, strict=True)]
    route = _drop_sharp_turns(_space_points(covered))
    ends = [
        limb.middle(mesh, 0.97),
        *(_end_middle(mesh, node) for node in find_limb_tips(mesh, limb.longest * limb.away)[1:]),
    ]
    tips = np.array([_cover_offset(mesh, solid, end, 0 * side) for end in ends])
    tip, names = tips[0], name_tips(mesh, tips)
    spool = min(_SPOOL, max(_MIN_SPOOL, -0.9 * float(solid.distances(route[:1])[0])))
    cable = Cable(winch="pull", points=tuple(map(_point, route)))
    travel = max(round(0.4 * cable.length, 3), 1e-3)
    winch = Winch(name="pull", at=cable.points[0], spool_radius=round(spool, 4), travel=travel)
    arm = tip - middles[0]
    bent = middles[0] + 0.95 * (np.cos(0.4) * arm + np.sin(0.4) * np.linalg.norm(arm) * side)
    return Robot(
        name=name,
        body=body,
        pins=(pin,),
        winches=(winch,),
        cables=(cable,),
        markers=tuple(Marker(name=name, at=_point(at)) for name, at in zip(names, tips, strict=True)),
        poses={"bend": PoseTarget(name="bend", targets={names[0]: _point(bent)})},
    )


def _end_middle(mesh: Mesh, tip: int) -> Vector:
    """Center of the elements at the tip of a limb [m]."""
    centers = mesh.nodes[mesh.elements].mean(axis=1)
    away = np.linalg.norm(centers - mesh.nodes[tip], axis=1)
    return centers[away <= max(0.03 * mesh.size, 1.01 * float(away.min()))].mean(axis=0)


def _hold(mesh: Mesh) -> Pin:
    """Box about the stouter end, or a ball about the deepest node."""
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    axis = int(np.argmax(high - low))
    along = (mesh.nodes[mesh.elements].mean(axis=1)[:, axis] - low[axis]) / (high[axis] - low[axis])
    end = 0.12  # an end is as much of the longest side
    slabs = np.bincount(np.minimum(along / end, 1 / end - 1).astype(int), weights=mesh.volumes)
    ends = [float(mesh.volumes[chosen].sum()) for chosen in (along < end, along > 1 - end)]
    if max(ends) < _STOUT * slabs.max():
        inner = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.boundary_nodes)
        if not len(inner):  # one element across everywhere
            inner = np.argmin(np.linalg.norm(mesh.nodes - mesh.nodes.mean(axis=0), axis=1), keepdims=True)
        depths = clearance(mesh, mesh.nodes[inner])
        center = mesh.nodes[inner[np.argmax(depths)]]
        return Pin(at=_point(center), radius=round(max(0.8 * float(depths.max()), _least_radius(mesh, center)), 4))
    box = np.array([low, high]) + 0.05 * (high - low) * [[-1.0], [1.0]]
    last = ends[1] > ends[0]
    box[0 if last else 1, axis] = (high if last else low)[axis] + (-1 if last else 1) * end * (high - low)[axis]
    return Pin(box=(_point(box[0]), _point(box[1])))


def _least_radius(mesh: Mesh, center: Vector) -> float:
    """Radius of a ball about a place [m] whose nodes span a plane at least, so that the body cannot turn about them."""
    away = np.linalg.norm(mesh.nodes - center, axis=1)
    order = np.argsort(away)
    for count in range(4, len(order)):
        spread = np.linalg.svd(mesh.nodes[order[:count]] - mesh.nodes[order[:count]].mean(axis=0), compute_uv=False)
        if spread[1] > 0.02 * mesh.size:
            return 1.01 * float(away[order[count - 1]])
    return float(away.max())


@dataclass(frozen=True, eq=False)
class _Limb:
    """Longest path through a body from where it is held."""

    away: Vector  # distance of each node from there along edges, as a share of the longest one
    longest: float  # that distance [m]
    path: Int[np.ndarray, " path"]  # nodes on the longest path, from its end

    def part(self, mesh: Mesh, share: float) -> Bool[np.ndarray, " elements"]:
        """Elements across the limb at a share of its length that are connected to the path there."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components  # Imported here: not every command needs it.

        away = self.away[mesh.elements].mean(axis=1)
        band = 0.05
        width = band
        while not np.isin(self.path, mesh.elements[near := np.abs(away - share) < width]).any():
            width *= 2  # in a stout body the way has few nodes, with none in a narrow band
        ends = mesh.elements[near]
        joins = coo_array(
            (np.ones(3 * len(ends)), (np.repeat(ends[:, 0], 3), ends[:, 1:].ravel())), shape=2 * (len(mesh.nodes),)
        )
        group = connected_components(joins, directed=False)[1]
        there = self.path[np.argsort(np.abs(self.away[self.path] - share))]
        own = next(group[node] for node in there if np.isin(node, ends))
        near[near] = group[ends[:, 0]] == own
        return near

    def middle(self, mesh: Mesh, share: float) -> Vector:
        """Center of the limb at a share of its length [m]."""
        part = self.part(mesh, share)
        return np.average(mesh.nodes[mesh.elements[part]].mean(axis=1), axis=0, weights=mesh.volumes[part])

    def reach(self, mesh: Mesh, share: float, side: Vector) -> float:
        """Distance that the limb goes from its middle to a side [m]."""
        nodes = mesh.nodes[np.unique(mesh.elements[self.part(mesh, share)])]
        return float(((nodes - self.middle(mesh, share)) @ side).max())


def _limb(mesh: Mesh, held: Bool[np.ndarray, " nodes"]) -> _Limb:
    away, before = measure_geodesics(mesh, held)
    path = [int(np.argmax(np.where(np.isfinite(away), away, -1.0)))]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return _Limb(away / away[path[0]], float(away[path[0]]), np.array(path))


def _side(mesh: Mesh, arm: Vector) -> Vector:
    """Axis across an arm along which the body is thinnest, so that it bends easily."""
    spread = np.var(mesh.nodes, axis=0)
    spread[int(np.argmax(np.abs(arm)))] = np.inf
    return np.eye(3)[int(np.argmin(spread))]


def _smooth_line(points: Points) -> Points:
    """Line without its zigzag, which is that of the elements; its ends stay."""
    smoothings = 3
    for _ in range(smoothings):
        points = np.concatenate([points[:1], (points[:-2] + 2 * points[1:-1] + points[2:]) / 4, points[-1:]])
    return points


def _cover_offset(mesh: Mesh, solid: Solid, middle: Vector, way: Vector) -> Vector:
    """Place off the middle of a limb towards its skin, in the solid, as far as there is cover, or else the best."""
    # how far a cable may lie from the middle of a limb towards its skin, the best first
    offs = (0.3, 0.2, 0.1, 0.0)
    places = middle + np.multiply.outer(offs, way)
    found = locate(mesh, np.concatenate([places, middle[None]]))
    places = np.concatenate([places, mesh.nodes[found.stencils[-1:]].mean(axis=1)])
    depths = np.where(np.append(found.inside[:-1], True), -solid.distances(places), -np.inf)
    cover = 0.004  # a cable should be as deep [m]
    return places[int(np.argmax(depths > cover))] if (depths > cover).any() else places[int(np.argmax(depths))]


def _space_points(points: list[Vector]) -> Points:
    """Points that are at least a millimeter apart."""
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > 1e-3:
            kept.append(point)
    return np.array(kept)


def _drop_sharp_turns(points: Points) -> Points:
    """Points without those at which the line turns by more than a design allows, the sharpest first."""
    most = 25.0  # as 30 degrees are allowed
    while len(points) > 2:
        ways = np.diff(points, axis=0)
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        turns = np.degrees(np.arccos(np.clip(np.einsum("sd,sd->s", ways[:-1], ways[1:]), -1.0, 1.0)))
        if turns.max() <= most:
            break
        points = np.delete(points, 1 + int(np.argmax(turns)), axis=0)
    return points


def _point(place: Float[np.ndarray, " 3"]) -> Point:
    """Place rounded to a hundredth of a millimeter."""
    return tuple(round(float(value), 5) for value in place)


def describe_filled_holes(body: Body) -> str:
    """Describe the holes that are filled in the mesh of a body in space; empty without any."""
    if body.healing is None or body.element_size is None:
        return ""
    from hydrostat.geometry import HOLE_SHARE, fill_small_holes

    return fill_small_holes(body.healing.surface, HOLE_SHARE * body.element_size).describe(body.element_size)
