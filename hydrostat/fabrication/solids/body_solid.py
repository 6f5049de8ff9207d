"""`body_solid`: the body of a robot as a solid, in millimeters."""

import numpy as np
from manifold3d import CrossSection, Error, Manifold, Mesh64

from hydrostat.arrays import Float, Int
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.robot import Body
from hydrostat.units import MILLIMETERS


def body_solid(body: Body) -> Manifold:
    """Make the solid that is to be cast [mm], in the coordinates of the robot.

    In space it is the healed surface, or the boundary of a ready mesh; a flat body is its outline, raised by its
    thickness half to either side of z = 0, with sharp edges. Raises InputError: the surface encloses no body.
    """
    if body.mesh.dim == 2:
        return _extrude_body(body)
    if body.healing is not None:
        surface = body.healing.surface
        return closed_solid(MILLIMETERS * surface.vertices, surface.triangles)
    return closed_solid(MILLIMETERS * body.mesh.nodes, body.mesh.boundary)


def closed_solid(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> Manifold:
    """The solid inside a closed surface [mm]; vertices in the same place are merged, and it is turned outward.

    Raises:
        InputError: the surface is open, crosses itself so that it encloses nothing, or three triangles share an edge.
    """
    solid = _solid(vertices, triangles)
    if solid.status() != Error.NoError:
        places, number = np.unique(vertices, axis=0, return_inverse=True)
        merged = number.reshape(-1)[triangles]
        kept = (merged != np.roll(merged, 1, axis=1)).all(axis=1)
        solid = _solid(places, merged[kept])
    if solid.status() == Error.NoError and solid.volume() < 0:
        solid = _solid(vertices, triangles[:, ::-1])
    if solid.status() != Error.NoError or not solid.volume() > 0:
        raise InputError(
            "the body's surface is not closed, so that there is nothing to cast: give the robot a surface file, "
            "which is healed when it is read"
        )
    return solid


def _solid(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> Manifold:
    return Manifold(
        Mesh64(
            vert_properties=np.ascontiguousarray(vertices, dtype=float),
            tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
        )
    )


def _extrude_body(body: Body) -> Manifold:
    """A flat body as thick as it is simulated."""
    thickness = MILLIMETERS * (body.thickness or 0.0)
    rings = body.outline.rings if body.outline is not None else _rings(body.mesh)
    profile = CrossSection([np.ascontiguousarray(MILLIMETERS * ring) for ring in rings])
    return Manifold.extrude(profile, thickness).translate((0.0, 0.0, -thickness / 2))


def _rings(mesh: Mesh) -> tuple[np.ndarray, ...]:
    """The edges round a ready mesh of triangles as closed rings, the body to the left."""
    following = {int(start): int(end) for start, end in mesh.boundary}
    if len(following) < len(mesh.boundary):
        raise InputError("the mesh touches itself in a single node: part it there, or make it wider")
    rings = []
    while following:
        node = min(following)
        ring = []
        while node in following:
            ring.append(node)
            node = following.pop(node)
        rings.append(mesh.nodes[ring])
    return tuple(rings)
