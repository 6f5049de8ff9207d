"""Our tetrahedra beside fTetWild's (Hu et al. 2020), on clean and dirty surfaces, at the same element size.

    pip install pytetwild pyvista        # an option of its own, not needed by hydrostat
    python lab/tetwild/tetwild.py

Each shape is meshed three times: by hydrostat (healing included), by fTetWild with its own envelope (a thousandth of
the diagonal), and by fTetWild with an envelope of a tenth of the element size. One thread each. Distances and volumes
are against the clean shape, of which the dirty surface was made.
"""

import sys
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from machine import machine

import numpy as np  # isort: skip
from meshes import quality

from hydrostat.errors import HydrostatError
from hydrostat.geometry import Mesh, Surface, contour, heal, tetrahedralize
from hydrostat.robot import gallery_folder, load_robot

sys.path.append(str(Path(__file__).parents[2] / "tests" / "geometry"))
import dirty


def fingers(gap: float) -> Surface:
    """Two upright capsules on a rounded block, a gap apart."""

    def field(points: np.ndarray) -> np.ndarray:
        result = np.linalg.norm(np.maximum(np.abs(points) - [0.016, 0.004, 0.004], 0), axis=1) - 0.004
        for side in (-1, 1):
            foot = np.array([side * (0.006 + gap / 2), 0.0, 0.0])
            height = np.clip(points[:, 2], 0, 0.05)[:, None] * [0, 0, 1]
            result = np.minimum(result, np.linalg.norm(points - foot - height, axis=1) - 0.006)
        return result

    return contour(field, np.array([[-0.03, -0.02, -0.02], [0.03, 0.02, 0.07]]), 0.001)


def shapes() -> dict[str, tuple[Surface, Surface, float]]:
    """The surface as it comes, the clean shape, and the element size [m]."""
    ball, ring = dirty.sphere(), dirty.torus()
    block, plate = dirty.cuboid((0, 0, 0), (0.1, 0.08, 0.06)), dirty.cuboid((0, 0, 0), (0.1, 0.08, 0.004))
    healed = {name: load_robot(gallery_folder(name)).body.healing for name in ("cupping_hand", "octopus_arm", "bear")}
    hand, arm, bear = (healing.surface for healing in healed.values() if healing is not None)
    pair = dirty.both(ball, dirty.sphere(center=(0.03, 0.0, 0.0)))
    union = heal(pair, resolution=0.0006).surface
    scan = dirty.with_small_holes(dirty.with_noise(dirty.unmerged(hand), 0.0), 40)
    return {
        "sphere": (ball, ball, 0.008),
        "torus": (ring, ring, 0.006),
        "box": (block, block, 0.012),
        "plate, 4 mm": (plate, plate, 0.005),
        "fingers, 2 mm apart": (fingers(0.002), fingers(0.002), 0.004),
        "hand": (hand, hand, 0.0116),
        "octopus arm": (arm, arm, 0.010),
        "bear": (bear, bear, 0.014),
        "dirty: ball with a hole": (dirty.with_hole(ball, np.array([0, 0, 0.03]), 0.012), ball, 0.008),
        "dirty: ring, a fifth flipped": (dirty.with_flipped(ring, 0.2), ring, 0.006),
        "dirty: two balls overlap": (pair, union, 0.008),
        "dirty: hand, 40 holes, unmerged": (scan, hand, 0.0116),
        "dirty: arm, repeated, needles": (dirty.with_duplicates(dirty.with_slivers(arm, 20), 50), arm, 0.010),
    }


def ours(surface: Surface, element_size: float) -> Mesh:
    """Healed and filled by hydrostat."""
    return tetrahedralize(heal(surface, resolution=element_size / 4).surface, element_size)


def wild(*, wide: bool) -> Callable[[Surface, float], Mesh]:
    """FTetWild with its own envelope, or with one that is a tenth of the element size wide."""
    import pytetwild

    def make(surface: Surface, element_size: float) -> Mesh:
        diagonal = float(np.linalg.norm(np.ptp(surface.box, axis=0)))
        nodes, elements = pytetwild.tetrahedralize(
            np.array(surface.vertices), surface.triangles.astype(np.int32), edge_length_abs=element_size,
            epsilon=0.1 * element_size / diagonal if wide else 1e-3, num_threads=1, quiet=True,
        )  # fmt: skip
        corners = nodes[elements]
        is_inverted = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
        return Mesh(nodes, np.where(is_inverted[:, None], elements[:, [1, 0, 2, 3]], elements).astype(np.int64))

    return make


def main() -> None:
    methods = {
        "ours": ours,
        "fTetWild": wild(wide=False),
        "fTetWild, wide": wild(wide=True),
    }
    with TemporaryDirectory() as folder, chdir(folder):  # fTetWild leaves files where it runs
        _print(methods)


def _print(methods: dict[str, Callable[[Surface, float], Mesh]]) -> None:
    for make in methods.values():
        make(dirty.sphere(), 0.012)  # loads and compiles
    print(machine())
    print("| shape | by | nodes | elements | smallest dihedral | volume | largest distance | manifold | same | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, (surface, clean, element_size) in shapes().items():
        for method, make in methods.items():
            print(f"| {name} | {method} | {_row(make, surface, clean, element_size)} |", flush=True)


def _row(make: Callable[[Surface, float], Mesh], surface: Surface, clean: Surface, element_size: float) -> str:
    start = process_time()
    try:
        mesh = make(surface, element_size)
    except (HydrostatError, RuntimeError) as error:
        return f"refused: {error}"
    seconds = process_time() - start
    again = make(surface, element_size)
    same = np.array_equal(mesh.nodes, again.nodes) and np.array_equal(mesh.elements, again.elements)
    found = quality(mesh, clean, element_size)
    return (
        f"{found.nodes} | {found.elements} | {found.angle:.1f} | {100 * (found.content - 1):+.2f} % "
        f"| {found.distance:.2f} | {'yes' if found.manifold else 'NO'} | {'yes' if same else 'NO'} | {seconds:.2f}"
    )


if __name__ == "__main__":
    main()
