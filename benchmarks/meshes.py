"""How good the meshes are, of every gallery body, and of surfaces in files.

    python benchmarks/meshes.py [--fine] [FILE or FOLDER ...]

prints for each body its nodes and elements, the smallest angle (of tetrahedra between two faces, of triangles between
two sides), how its volume or area compares with that of the surface or drawing, the largest distance between the two
boundaries either way in element sizes, and CPU time with reading and healing. --fine meshes the hands with ten times
their nodes and one with 20,000 as well.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time

from machine import machine

import numpy as np  # isort: skip
from shapely import Polygon

from hydrostat.geometry import (
    SURFACE_SUFFIXES,
    Mesh,
    Solid,
    Surface,
    fit,
    heal,
    read_surface,
    size_for,
    tetrahedralize,
)
from hydrostat.robot import Body, gallery_folder, list_gallery, load_robot

HANDS = ("cupping_hand", "extended_hand", "caging_gripper")


@dataclass(frozen=True)
class Quality:
    """What counts of a mesh.

    Attributes:
        nodes: their number.
        elements: their number.
        angle: the smallest [degrees].
        content: volume or area, as a fraction of that of the shape.
        distance: largest between boundary and shape, either way [element sizes].
        manifold: whether every edge of the boundary has two facets.
    """

    nodes: int
    elements: int
    angle: float
    content: float
    distance: float
    manifold: bool


def quality(mesh: Mesh, surface: Surface, element_size: float) -> Quality:
    """Of tetrahedra in a closed surface [m]."""
    found = fit(mesh, Solid(surface), element_size / 4)
    sides = np.sort(np.concatenate([np.delete(mesh.boundary, corner, axis=1) for corner in range(3)]), axis=1)
    return Quality(
        len(mesh.nodes),
        len(mesh.elements),
        float(mesh.dihedral_angles().min()),
        found.volume,
        found.largest / element_size,
        bool((np.unique(sides, axis=0, return_counts=True)[1] == 2).all()),
    )


def flat_quality(body: Body) -> Quality:
    """Of triangles in a drawing."""
    mesh, outline = body.mesh, body.outline
    assert outline is not None
    assert body.element_size is not None
    rim = Polygon(outline.exterior).exterior
    ring = Polygon(mesh.nodes[_ring(mesh)]).exterior
    return Quality(
        len(mesh.nodes),
        len(mesh.elements),
        mesh.smallest_angle(),
        float(mesh.volumes.sum()) / outline.area,
        float(rim.hausdorff_distance(ring)) / body.element_size,
        True,
    )


def _ring(mesh: Mesh) -> list[int]:
    """The longest ring of the boundary of a flat mesh."""
    follow = {int(start): int(end) for start, end in mesh.boundary}
    rings: list[list[int]] = []
    while follow:
        ring = [next(iter(follow))]
        while (after := follow.pop(ring[-1])) != ring[0]:
            ring.append(after)
        rings.append(ring)
    return max(rings, key=len)


def bodies(fine: bool) -> Iterator[tuple[str, Quality, float]]:
    """Name, quality and CPU seconds of every gallery body."""
    for name in list_gallery():
        start = process_time()
        body = load_robot(gallery_folder(name)).body
        seconds = process_time() - start
        if body.healing is None:
            yield name, flat_quality(body), seconds
            continue
        assert body.element_size is not None
        surface = body.healing.surface
        yield name, quality(body.mesh, surface, body.element_size), seconds
        counts = [10 * len(body.mesh.nodes)] * (name in HANDS) + [20_000] * (name == HANDS[0])
        for count in counts if fine else []:
            yield _sized(f"{name}, about {count} nodes", surface, count)


def _sized(name: str, surface: Surface, count: int) -> tuple[str, Quality, float]:
    """A surface with about a number of nodes; the time is that of the last mesh."""
    size = size_for(count, lambda trial: tetrahedralize(surface, trial), content=surface.volume, dim=3)
    start = process_time()
    mesh = tetrahedralize(surface, size)
    seconds = process_time() - start
    return name, quality(mesh, surface, size), seconds


def surfaces(paths: Sequence[Path]) -> Iterator[tuple[str, Quality, float]]:
    """Name, quality and CPU seconds of every surface in files and folders, with about 900 nodes."""
    files = [file for path in paths for file in (sorted(path.rglob("*")) if path.is_dir() else [path])]
    for file in files:
        if file.suffix.lower() in SURFACE_SUFFIXES:
            start = process_time()
            surface = read_surface(file.read_bytes(), name=file.name)
            closed = heal(surface, resolution=surface.size / 100).surface
            seconds = process_time() - start
            name, found, meshing = _sized(file.name, closed, 900)
            yield name, found, seconds + meshing


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path, help="surfaces, or folders with some")
    parser.add_argument("--fine", action="store_true", help="hands with 9,000 and 20,000 nodes too")
    options = parser.parse_args(arguments)
    load_robot(gallery_folder(HANDS[0]))  # compiled functions are loaded before any time is taken
    print(machine())
    print("| body | nodes | elements | smallest angle | volume or area | largest distance | manifold | CPU s |")
    print("|---|---|---|---|---|---|---|---|")
    for rows in (bodies(options.fine), surfaces(options.paths)):
        for name, found, seconds in rows:
            print(
                f"| {name} | {found.nodes} | {found.elements} | {found.angle:.1f} | {100 * (found.content - 1):+.2f} % "
                f"| {found.distance:.2f} | {'yes' if found.manifold else 'NO'} | {seconds:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
