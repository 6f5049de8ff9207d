"""`stl_bytes`: a printed part as binary STL, which every slicer opens."""

import numpy as np

from hydrostat.fabrication.solids.printed import Printed

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(printed: Printed) -> bytes:
    """A part as binary STL in millimetres; the header names it. One copy: STL knows no count."""
    vertices, triangles = printed.written
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(triangles), dtype=_TRIANGLE)
    records["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    records["corners"] = corners
    header = f"hydrostat {printed.name} [mm]".encode("ascii", "replace")[:80].ljust(80, b" ")
    return header + np.uint32(len(triangles)).astype("<u4").tobytes() + records.tobytes()
