"""A surface as a binary PLY file in millimeters, with fewer triangles."""

import numpy as np

from hydrostat.geometry import Surface


def decimated(surface: Surface, faces: int) -> Surface:
    """The surface with about as many triangles as asked for, by quadrics of error (Garland and Heckbert 1997).

    Edges whose collapse would let triangles cross are left alone.
    """
    import igl

    vertices, triangles = (
        np.asfortranarray(surface.vertices * 1e3),
        np.asfortranarray(surface.triangles, dtype=np.int32),
    )
    fewer, corners, _, _ = igl.qslim(vertices, triangles, faces, True)
    return Surface(np.array(fewer) * 1e-3, np.array(corners).astype(np.int64))


def ply_bytes(surface: Surface) -> bytes:
    """Vertices in millimeters as 4-byte floats, triangles as 4-byte integers."""
    corners = np.zeros(len(surface.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    corners["count"], corners["corners"] = 3, surface.triangles
    head = (
        "ply\nformat binary_little_endian 1.0\ncomment millimeters\n"
        f"element vertex {len(surface.vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(corners)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    return head.encode() + (1e3 * surface.vertices).astype("<f4").tobytes() + corners.tobytes()
