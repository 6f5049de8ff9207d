"""Tetrahedra of bodies in space. Oracles: closed forms, the surface itself, libigl's idea of a manifold."""

import hashlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from solids import (
    Maker,
    assert_proper,
    ball,
    boundary,
    brick,
    capsules,
    ellipsoid,
    euler,
    hollow,
    make,
    mirrored,
    moved,
    ring,
    surface,
    two_fingers,
)

from hydrostat.errors import InputError, SurfaceError
from hydrostat.geometry.mesh import Mesh, dihedral_angles
from hydrostat.geometry.surface import Solid, Surface
from hydrostat.geometry.tetrahedra.tetrahedralize import BOUNDARY_TOLERANCE, fit, tetrahedralize

BODIES: dict[str, tuple[Maker, float]] = {
    "ball": (ball, 0.02),
    "fine ball": (ball, 0.012),
    "box on the lattice": (lambda: brick(0.1, 0.06, 0.04), 0.01),
    "box beside the lattice": (lambda: moved(brick(0.1, 0.06, 0.04), turned=0.7), 0.0124),
    "ring": (ring, 0.012),
    "long ellipsoid": (lambda: ellipsoid(0.2, 0.01, 0.01), 0.008),
    "flat ellipsoid": (lambda: ellipsoid(0.06, 0.06, 0.01), 0.01),
    "plate": (lambda: brick(0.1, 0.08, 0.008), 0.01),
    "rod": (lambda: brick(0.5, 0.01, 0.01), 0.01),
    "needle triangles": (lambda: surface(make.cylinder(0.02, 0.1, sections=200)), 0.01),
    "near fingers": (lambda: two_fingers(0.002), 0.01),
    "hollow": (hollow, 0.012),
}


def assert_good(mesh: Mesh, body: Surface, element_size: float) -> None:
    """What is promised of every mesh: shapes, volume, both distances, one proper boundary with as many handles."""
    assert dihedral_angles(mesh.nodes, mesh.elements).min() >= 12
    found = fit(mesh, Solid(body), element_size / 3)
    assert found.volume == pytest.approx(1, abs=0.02)
    assert found.largest <= BOUNDARY_TOLERANCE * element_size
    assert_proper(mesh)
    assert euler(boundary(mesh)) == euler(body)


@pytest.mark.parametrize("name", BODIES)
def test_meshes_are_good(name: str) -> None:
    maker, element_size = BODIES[name]
    body = maker()
    assert_good(tetrahedralize(body, element_size), body, element_size)


@pytest.mark.parametrize("name", ["ball", "box on the lattice", "ring"])
def test_edges_are_as_long_as_asked_for(name: str) -> None:
    """Bodies of few elements have many outer edges, which are shorter."""
    maker, element_size = BODIES[name]
    assert tetrahedralize(maker(), element_size).edge_lengths.mean() == pytest.approx(element_size, rel=0.15)


@pytest.mark.slow
def test_volume_area_and_distance_converge_with_order_two() -> None:
    """Closed forms of the ball; its 20,480 triangles are 0.04 % smaller than it, much less than the errors here."""
    body = ball(divisions=5)
    sizes = np.array([0.03, 0.015, 0.0075])
    volume, area, away = [], [], []
    for size in sizes:
        mesh = tetrahedralize(body, float(size))
        outer = boundary(mesh)
        volume.append(abs(outer.volume / body.volume - 1))
        area.append(abs(outer.area / body.area - 1))
        away.append(
            np.sqrt(np.mean((np.linalg.norm(outer.vertices[outer.triangles].mean(axis=1), axis=1) - 0.05) ** 2))
        )
    for errors in (area, away):
        assert (np.log2(np.array(errors)[:-1] / np.array(errors)[1:]) > 1.6).all(), errors
    assert volume[0] < 5e-3
    assert volume[-1] < 5e-4
    assert away[0] < 0.05 * sizes[0]


@pytest.mark.slow
def test_closed_forms_of_box_cone_and_ring() -> None:
    """Volumes and areas."""
    for made, element_size, volume, area in (
        (brick(0.08, 0.06, 0.04), 0.01, 0.08 * 0.06 * 0.04, 2 * (0.0048 + 0.0032 + 0.0024)),
        (surface(make.cone(0.03, 0.06, sections=96)), 0.008, np.pi * 0.03**2 * 0.02, np.pi * 0.03 * (0.03 + 0.0670820)),
        (ring(), 0.01, 2 * np.pi**2 * 0.05 * 0.02**2, 4 * np.pi**2 * 0.05 * 0.02),
    ):
        outer = boundary(tetrahedralize(made, element_size))
        assert outer.volume == pytest.approx(volume, rel=0.015)
        assert outer.area == pytest.approx(area, rel=0.02)


def test_corners_and_edges_of_a_box_are_found() -> None:
    """Closed form: the distance of its corners, and of points on its edges, from the mesh."""
    mesh = tetrahedralize(brick(0.1, 0.06, 0.04), 0.01)
    outer = Solid(boundary(mesh))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = signs * [0.05, 0.03, 0.02]
    assert np.linalg.norm(outer.nearest(corners)[0] - corners, axis=1).max() < 0.15 * 0.01
    along = np.linspace(-0.9, 0.9, 40)[:, None] * [0.05, 0, 0] + [0, 0.03, 0.02]
    gaps = np.linalg.norm(outer.nearest(along)[0] - along, axis=1)
    assert gaps.max() < 0.15 * 0.01
    assert gaps.mean() < 0.06 * 0.01


def _digest(mesh: Mesh) -> str:
    return hashlib.sha256(mesh.nodes.tobytes() + mesh.elements.tobytes()).hexdigest()


@pytest.mark.slow
def test_the_same_bytes_on_two_runs_and_in_a_fresh_process() -> None:
    digest = _digest(tetrahedralize(two_fingers(0.005), 0.012))
    assert _digest(tetrahedralize(two_fingers(0.005), 0.012)) == digest
    script = (
        "from solids import two_fingers; from test_tetrahedralize import _digest; "
        "from hydrostat.geometry.tetrahedra.tetrahedralize import tetrahedralize; "
        "print(_digest(tetrahedralize(two_fingers(0.005), 0.012)))"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=Path(__file__).parent, capture_output=True, check=True)
    assert done.stdout.decode().strip() == digest


@pytest.mark.slow
@pytest.mark.parametrize("name", ["box on the lattice", "ring"])
def test_turned_shifted_and_mirrored_bodies_are_as_good(name: str) -> None:
    maker, element_size = BODIES[name]
    body = maker()
    for other in (
        moved(body, turned=0.4),
        moved(body, turned=1.3, about=(3, -1, 1), shift=(0.013, -0.4, 1)),
        mirrored(body),
    ):
        assert_good(tetrahedralize(other, element_size), other, element_size)


@pytest.mark.parametrize("scale", [1e-5, 1e-2, 200.0])
def test_scale_does_not_matter(scale: float) -> None:
    """The same mesh, scaled: bodies of a micrometer and of 20 m."""
    body = brick(0.1, 0.06, 0.04)
    expected, mesh = tetrahedralize(body, 0.0124), tetrahedralize(moved(body, scale=scale), 0.0124 * scale)
    np.testing.assert_array_equal(mesh.elements, expected.elements)
    np.testing.assert_allclose(mesh.nodes / scale, expected.nodes, atol=1e-6)


def test_far_from_the_origin() -> None:
    """100 m away rounding is a hundred-thousandth of a nanometer."""
    body = moved(ball(), shift=(100, -100, 100))
    assert_good(tetrahedralize(body, 0.02), body, 0.02)


@pytest.mark.slow
def test_tiny_triangles_do_not_matter() -> None:
    """A ball of 80,000 triangles beside one of 20,000: within what both are off the ball."""
    fine, coarse = (tetrahedralize(ball(divisions=divisions), 0.025) for divisions in (6, 5))
    assert_good(fine, ball(divisions=6), 0.025)
    assert fine.volumes.sum() == pytest.approx(coarse.volumes.sum(), rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "turned"), [(0.002, 0.4), (0.002, 1.3), (0.005, 0.4)])
def test_fingers_near_each_other_are_not_grown_together(gap: float, turned: float) -> None:
    """Turned against the lattice, whose edges then pass the gap every way. Oracle: the Euler characteristic."""
    body = moved(two_fingers(gap), turned=turned)
    mesh = tetrahedralize(body, 0.01)
    assert_proper(mesh)
    assert euler(boundary(mesh)) == 2
    assert dihedral_angles(mesh.nodes, mesh.elements).min() >= 12
    assert mesh.volumes.sum() == pytest.approx(body.volume, rel=0.01)


@pytest.mark.parametrize("seed", range(10))
def test_random_bodies_are_good(seed: int) -> None:
    body = capsules(seed)
    assert_good(tetrahedralize(body, 0.01), body, 0.01)


@pytest.mark.slow
def test_a_hollow_stays() -> None:
    """Closed form: the volume of the wall; the cavity is a second part of the boundary."""
    mesh = tetrahedralize(hollow(0.05, 0.03), 0.01)
    assert mesh.volumes.sum() == pytest.approx(hollow(0.05, 0.03).volume, rel=0.01)
    assert euler(boundary(mesh)) == 4
    assert np.linalg.norm(mesh.nodes, axis=1).min() == pytest.approx(0.03, rel=0.05)


@pytest.mark.slow
def test_a_gap_smaller_than_the_elements_stays_open() -> None:
    """Nothing of the mesh is in the gap, and elements are small only about it."""
    mesh = tetrahedralize(two_fingers(0.002), 0.01)
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    assert not ((middles[:, 0] > 0.065) & (np.abs(middles[:, 1] - 0.015) < 0.0005)).any()
    sizes = np.cbrt(8.5 * mesh.volumes)
    far = middles[:, 0] < 0.04
    assert sizes[far].mean() > 0.0085
    assert sizes[(np.abs(middles[:, 1] - 0.015) < 0.003) & ~far].mean() < 0.006


@pytest.mark.slow
def test_all_of_a_body_but_a_crumb_is_there_and_a_fin_too() -> None:
    """A ball with a fin a third as thick as the elements; its four long edges are blunted."""
    import trimesh

    body = surface(trimesh.boolean.union([make.icosphere(3, 0.02), make.box((0.06, 0.003, 0.015))], engine="manifold"))
    assert_good(tetrahedralize(body, 0.009), body, 0.009)


ADVICE = re.compile(r"take ([0-9.e+-]+) mm or (less|more)$")
REFUSED: dict[str, tuple[Maker, float, type, str]] = {
    "too large": (ball, 0.2, InputError, "elements of 200 mm are too large for a body of 52. cm"),
    "larger than the body": (lambda: brick(0.1, 0.01, 0.01), 1.0, InputError, "too large"),
    "too small": (ball, 0.0005, InputError, r"elements of 0.5 mm would be about 3.*, at most 400000"),
    "long and too small": (lambda: moved(brick(1.0, 0.004, 0.004), turned=0.6), 0.001, InputError, "would be about"),
    "thin plate": (
        lambda: brick(0.05, 0.05, 0.002),
        0.01,
        SurfaceError,
        "much of the body is thinner than elements of",
    ),
    "thin wall": (lambda: hollow(0.05, 0.042), 0.025, SurfaceError, "much of the body is thinner than"),
    "thin rod": (lambda: brick(0.3, 0.004, 0.004), 0.012, SurfaceError, "much of the body is thinner than"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_advice_in_a_refusal_is_true(name: str) -> None:
    """One line, with an element size that then works, and is not far from the limit."""
    maker, element_size, kind, text = REFUSED[name]
    body = maker()
    with pytest.raises(kind, match=text) as refused:
        tetrahedralize(body, element_size)
    assert "\n" not in str(refused.value)
    found = ADVICE.search(str(refused.value))
    assert found
    advised = 1e-3 * float(found[1])
    assert (advised < element_size) == (found[2] == "less")
    if not name.endswith("too small"):  # which takes long
        mesh = tetrahedralize(body, advised)
        assert_proper(mesh)
        assert mesh.volumes.sum() == pytest.approx(body.volume, rel=0.05)


@pytest.mark.parametrize("element_size", [0.0, -1.0, float("nan"), float("inf")])
def test_sizes_that_are_none(element_size: float) -> None:
    with pytest.raises(InputError, match="the element size must be positive"):
        tetrahedralize(ball(), element_size)
