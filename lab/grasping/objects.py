"""Tools as closed surfaces: writes a glue bottle, a screwdriver and a box cutter as STL in millimeters.

    python lab/grasping/objects.py [--out build/objects] [--tilt 90] [bottle screwdriver cutter]

After Fig 4.7 of the thesis, of simple solids with assumed sizes. The grip is about the origin. With a tilt of 0 a tool
lies along the x axis, with 90 degrees it stands along z.
"""

import argparse
from pathlib import Path

import numpy as np
from manifold3d import CrossSection, Manifold

from hydrostat.arrays import Points

TOOLS = ("bottle", "screwdriver", "cutter")
SIDES = 24
"""Sides of a round tool."""


def _turned(*corners: tuple[float, float]) -> Manifold:
    """Turn a profile of (radius, height) corners once round the z axis [mm]."""
    return Manifold.revolve(CrossSection([np.array(corners, dtype=float)]), SIDES)


def solid(tool: str) -> Manifold:
    """Return a tool along z, with its grip about the origin [mm]."""
    if tool == "bottle":  # body of 40 mm, shoulder, neck and nozzle
        return _turned((0, -50), (18, -50), (20, -47), (20, 35), (9, 50), (9, 60), (6, 62), (2, 85), (0, 85))
    if tool == "screwdriver":  # handle of 28 mm, shaft of 6 mm
        return _turned(
            (0, -50), (10, -50), (14, -42), (14, 28), (9, 38), (12, 46), (6, 50), (3, 51), (3, 140), (0, 140)
        )
    if tool == "cutter":  # case of 32 x 12 mm, blade of 1 mm
        case = CrossSection([[(-16, -70), (16, -70), (16, 55), (6, 70), (-16, 70)]]).offset(-1).offset(1)
        blade = CrossSection([[(-10, 65), (4, 65), (4, 75), (-10, 92)]])
        flat = case.extrude(12).translate((0, 0, -6)) + blade.extrude(1).translate((0, 0, -0.5))
        return flat.rotate((90, 0, 0))
    raise ValueError(f'unknown tool "{tool}"')


def tilted(tool: str, tilt: float) -> Manifold:
    """Return a tool along x, tilted about y by an angle [degree] towards +z [mm]."""
    return solid(tool).rotate((0, 90 - tilt, 0))


def triangles_of(whole: Manifold) -> Points:
    """Return the corners of the triangles of a solid."""
    mesh = whole.to_mesh()
    return np.asarray(mesh.vert_properties[:, :3], dtype=float)[np.asarray(mesh.tri_verts)]


def stl_text(whole: Manifold, name: str = "box") -> str:
    """Return a solid as STL in millimeters."""
    lines = [f"solid {name}"]
    for corners in triangles_of(whole):
        points = "".join(f"vertex {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in corners)
        lines.append(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet")
    return "\n".join([*lines, f"endsolid {name}", ""])


def write(folder: Path, tool: str, tilt: float) -> Path:
    """Write a tool; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{tool}.stl"
    path.write_text(stl_text(tilted(tool, tilt), tool), encoding="ascii")
    return path


def main() -> None:
    """Write the tools, print their files."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tools", nargs="*", default=list(TOOLS))
    parser.add_argument("--out", type=Path, default=Path("build/objects"))
    parser.add_argument("--tilt", type=float, default=90.0, help="from the x axis towards z [degree]")
    given = parser.parse_args()
    for tool in given.tools:
        print(f"wrote {write(given.out, tool, given.tilt)}, {solid(tool).volume() / 1e3:.0f} ml")


if __name__ == "__main__":
    main()
