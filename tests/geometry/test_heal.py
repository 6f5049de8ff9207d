"""Healing: dirty surfaces become one closed body of a volume known in closed form, or are refused with a reason."""

import numpy as np
import pytest
from geometry.dirty import (
    both,
    cuboid,
    inside_out,
    lens,
    sphere,
    torus,
    unmerged,
    with_duplicates,
    with_flipped,
    with_hole,
    with_noise,
    with_slivers,
    with_small_holes,
    with_specks,
)

from hydrostat.errors import SurfaceError
from hydrostat.geometry.contour import contour
from hydrostat.geometry.healing.faults import crossing_pairs
from hydrostat.geometry.healing.heal import heal
from hydrostat.geometry.healing.healing import Healing
from hydrostat.geometry.healing.mend import holes_of, sides_of, weld
from hydrostat.geometry.healing.remake import WindingField
from hydrostat.geometry.surface import Surface

_BALL = sphere(divisions=3)
_FINE = 0.002
_TOP = np.array([0.0, 0.0, 0.03])


def _healed(surface: Surface, resolution: float = _FINE) -> Healing:
    """What `heal` makes, which is closed, manifold, outward and does not cross itself, whatever it was made of."""
    import igl

    healing = heal(surface, resolution=resolution)
    triangles = healing.surface.triangles
    sides = sides_of(triangles)
    assert (sides.counts == 2).all()
    assert not sides.is_misoriented.any()
    assert np.all(igl.is_vertex_manifold(triangles))
    assert len(np.unique(triangles)) == len(healing.surface.vertices)
    assert not len(crossing_pairs(healing.surface))
    assert healing.volume_after == healing.surface.volume > 0.0
    assert all("\n" not in line for line in healing.lines())
    return healing


def _says(healing: Healing, *words: str) -> bool:
    return all(any(word in line for line in healing.lines()) for word in words)


@pytest.mark.parametrize("shape", [_BALL, torus(spacing=0.004), cuboid((0, 0, 0), (0.1, 0.02, 0.03))])
def test_a_clean_surface_passes_through_unchanged(shape: Surface) -> None:
    healing = _healed(shape)
    assert healing.clean
    assert healing.removed == healing.done == ()
    assert healing.largest_distance == 0.0
    np.testing.assert_array_equal(healing.surface.vertices, shape.vertices)
    np.testing.assert_array_equal(healing.surface.triangles, shape.triangles)


def test_vertices_in_one_place_are_merged_and_nothing_else() -> None:
    """Those that rounding has moved apart, too; twice the tolerance apart they stay two."""
    healing = _healed(with_noise(unmerged(_BALL), 1e-9))
    assert healing.clean
    assert _says(healing, f"{3 * len(_BALL.triangles) - len(_BALL.vertices)} corners in the place of another")
    assert len(healing.surface.vertices) == len(_BALL.vertices)
    assert weld(with_noise(unmerged(_BALL), 1e-6)).merged < 100


def test_slivers_are_told_and_stay() -> None:
    healing = _healed(with_slivers(_BALL, 5))
    assert healing.clean
    assert _says(healing, "slivers")
    assert healing.volume_after == pytest.approx(_BALL.volume, rel=1e-9)


def test_repeated_triangles_and_such_without_area_go() -> None:
    healing = _healed(with_duplicates(_BALL, 7))
    assert not healing.clean
    assert _says(healing, "7 triangles without an area", "7 triangles that stand there twice")
    assert healing.volume_after == pytest.approx(_BALL.volume, rel=1e-12)


def test_a_surface_saved_with_both_its_sides_keeps_one() -> None:
    assert _healed(both(_BALL, inside_out(_BALL))).volume_after == pytest.approx(_BALL.volume, rel=1e-12)


def test_a_wall_between_two_rooms_goes() -> None:
    """Two boxes with a face in common are one box of both volumes, with its sharp edges."""
    rooms = both(cuboid((0, 0, 0), (0.1, 0.1, 0.1)), cuboid((0.1, 0, 0), (0.2, 0.1, 0.1)))
    healing = _healed(rooms)
    assert _says(healing, "4 triangles back to back")
    assert healing.volume_after == pytest.approx(2e-3, rel=1e-12)


@pytest.mark.parametrize("share", [0.01, 0.3])
def test_flipped_triangles_are_turned(share: float) -> None:
    dirty = with_flipped(_BALL, share)
    count = int((dirty.triangles != _BALL.triangles).any(axis=1).sum())
    healing = _healed(dirty)
    assert _says(healing, f"{count} flipped triangle")
    np.testing.assert_array_equal(healing.surface.crosses, _BALL.crosses)


def test_what_is_inside_out_is_turned() -> None:
    healing = _healed(inside_out(_BALL))
    assert _says(healing, "1 part inside out")
    assert healing.volume_after == pytest.approx(_BALL.volume, rel=1e-12)


def test_small_holes_are_closed_and_the_rest_stays_as_it_is() -> None:
    """Oracle: every triangle that was there is there, and a missing one of a sphere is closed by the same one."""
    box = cuboid((0, 0, 0), (0.1, 0.1, 0.1))
    pierced = with_small_holes(_BALL, 12)
    healing = _healed(pierced, 0.004)
    assert not healing.clean
    assert _says(healing, "12 small holes closed")
    assert healing.volume_after == pytest.approx(_BALL.volume, rel=1e-3)
    kept = {tuple(corners) for corners in healing.surface.vertices[healing.surface.triangles].reshape(-1, 9).tolist()}
    assert kept >= {tuple(corners) for corners in pierced.vertices[pierced.triangles].reshape(-1, 9).tolist()}
    assert len(holes_of(with_small_holes(box, 1))) == 1
    assert not len(holes_of(box))


def test_holes_that_touch_in_a_corner_are_told_apart() -> None:
    """Two of the six triangles around a vertex: next to each other they are one hole of four sides, else two holes."""
    corner = int(np.bincount(_BALL.triangles.ravel()).argmax())
    ring = np.flatnonzero((_BALL.triangles == corner).any(axis=1))
    shared = [len(np.intersect1d(_BALL.triangles[ring[0]], _BALL.triangles[other])) for other in ring]
    for count, sides in ((1, [3, 3]), (2, [4])):
        gone = [ring[0], ring[shared.index(count)]]
        holes = holes_of(Surface(_BALL.vertices, np.delete(_BALL.triangles, gone, axis=0)))
        assert np.bincount(holes.label).tolist() == sides
        assert holes.simple.all()


def test_a_large_hole_is_closed_about_flat() -> None:
    """The cap that is missing has a closed form; the patch lies between the flat cut and the sphere."""
    height = 0.008
    angle = np.arccos(1 - height / 0.03)
    dirty = with_hole(sphere(divisions=4), _TOP, 2 * 0.03 * np.sin(angle / 2))
    healing = _healed(dirty)
    cap = np.pi * height**2 * (3 * 0.03 - height) / 3
    assert _says(healing, "1 hole", "made again")
    assert 4 / 3 * np.pi * 0.03**3 - 1.1 * cap < healing.volume_after < 4 / 3 * np.pi * 0.03**3
    assert 0.02 < healing.patched < 0.15
    assert healing.largest_distance < _FINE / 2


def test_the_volume_of_a_tube_without_ends_is_as_if_they_were_closed() -> None:
    """Oracle: half the base times the height of a prism; one fan about the middle of both borders gives two thirds."""
    around, height = 0.01 * np.exp(2j * np.pi * np.arange(24) / 24), 0.1
    rings = [np.column_stack([around.real, around.imag, np.full(24, z)]) for z in np.linspace(0.0, height, 11)]
    one = np.arange(240)
    other = np.where(one % 24 == 23, one - 23, one + 1)
    sides = np.concatenate([np.stack([one, other, other + 24], axis=1), np.stack([one, other + 24, one + 24], axis=1)])
    healing = _healed(Surface(np.concatenate(rings), sides))
    assert healing.volume_before == pytest.approx(12 * 0.01**2 * np.sin(np.pi / 12) * height, rel=1e-6)


@pytest.mark.slow
def test_overlapping_spheres_are_united() -> None:
    """Oracle: closed form of what two spheres share. The input counts it twice."""
    apart = 0.03
    pair = both(sphere(divisions=4), sphere(0.03, (apart, 0.0, 0.001), 4))
    exact = 8 / 3 * np.pi * 0.03**3 - lens(0.03, np.hypot(apart, 0.001))
    healing = _healed(pair)
    assert _says(healing, "run through each other", "2 parts", "made again")
    assert healing.volume_after == pytest.approx(exact, rel=0.005)
    assert healing.volume_before == pytest.approx(8 / 3 * np.pi * 0.03**3, rel=0.005)
    assert healing.largest_distance < _FINE


@pytest.mark.slow
def test_self_intersections_are_found_and_mended() -> None:
    """A sphere with a dent pushed out through the other side runs through itself."""
    vertices = _BALL.vertices.copy()
    vertices[vertices[:, 2] > 0.024, 2] -= 0.051
    dirty = Surface(vertices, _BALL.triangles)
    assert len(crossing_pairs(dirty)) > 10
    assert _says(_healed(dirty), "run through each other")


def test_crossings_of_single_triangles() -> None:
    """Oracle: pairs drawn by hand: crossing, apart, touching, sharing a corner, folded."""
    flat = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    cases = {
        "crosses": ([(0.2, 0.2, -1.0), (0.3, 0.2, 1.0), (0.2, 0.3, 1.0)], True),
        "crosses from inside": ([(0.2, -0.5, -0.1), (0.2, 2.0, -0.1), (0.2, 0.2, 0.5)], True),
        "above": ([(0.2, 0.2, 0.1), (0.3, 0.2, 1.0), (0.2, 0.3, 1.0)], False),
        "beside": ([(2.0, 0.2, -1.0), (2.3, 0.2, 1.0), (2.2, 0.3, 1.0)], False),
        "touches": ([(0.2, 0.2, 0.0), (0.3, 0.2, 1.0), (0.2, 0.3, 1.0)], False),
        "corner, away": ([(0.0, 0.0, 0.0), (-1.0, 0.0, 1.0), (-1.0, 0.1, -1.0)], False),
        "corner, through": ([(0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.4, 0.5, -0.5)], True),
        "side, folded": ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.2, 0.4, 0.0)], True),
        "side, flat": ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.2, -0.4, 0.0)], False),
    }
    for name, (other, crosses) in cases.items():
        pair = weld(both(*(Surface(np.array(one), np.array([[0, 1, 2]])) for one in (flat, other)))).surface
        assert len(crossing_pairs(pair)) == crosses, name


def test_cavities_stay_if_they_are_clean() -> None:
    """Volumes of the shells add up. Inward is a cavity, with all turned inside out, too; outward is overlap."""
    hollow = both(_BALL, inside_out(sphere(0.01, (0.005, 0.0, 0.0), 2)))
    inner = sphere(0.01, divisions=2).volume
    healing = _healed(hollow)
    assert healing.clean
    assert _says(healing, "1 pocket of air")
    assert healing.volume_after == pytest.approx(_BALL.volume - inner, rel=1e-12)
    assert _healed(inside_out(hollow)).volume_after == pytest.approx(_BALL.volume - inner, rel=1e-12)
    filled = _healed(both(_BALL, sphere(0.01, (0.005, 0.0, 0.0), 2)))
    assert filled.volume_after == pytest.approx(_BALL.volume, rel=1e-12)
    assert _says(filled, "inside the body")
    assert filled.removed[0].size == pytest.approx(0.02, rel=0.05)


@pytest.mark.slow
def test_cavities_stay_and_dirty_pockets_are_filled_when_a_body_is_made_anew() -> None:
    """Oracle: closed forms. The clean cavity is kept; one with a flipped triangle counts as dirt."""
    cavity = inside_out(sphere(0.01, (-0.012, 0.0, 0.0), 3))
    pair = both(_BALL, sphere(0.03, (0.03, 0.0, 0.001), 3), cavity)
    union = 8 / 3 * np.pi * 0.03**3 - lens(0.03, np.hypot(0.03, 0.001))
    volume = 4 / 3 * np.pi * 0.01**3
    assert _healed(pair).volume_after == pytest.approx(union - volume, rel=0.01)
    triangles = pair.triangles.copy()
    triangles[-1] = triangles[-1][::-1]
    filled = _healed(Surface(pair.vertices, triangles))
    assert filled.volume_after == pytest.approx(union, rel=0.01)


def test_specks_are_removed_and_named() -> None:
    places = np.array([[0.05, 0.0, 0.0], [0.0, -0.06, 0.0], [0.0, 0.0, 0.01]])
    healing = _healed(with_specks(_BALL, places, 0.001))
    assert healing.volume_after == pytest.approx(_BALL.volume, rel=1e-12)
    assert [piece.triangles for piece in healing.removed] == [80, 80, 80]
    np.testing.assert_allclose([piece.place for piece in healing.removed], places, atol=1e-9)
    np.testing.assert_allclose([piece.size for piece in healing.removed], 0.002, rtol=0.1)
    assert _says(healing, "loose speck, 2 mm in size at (50, 0, 0) mm, 80 triangles", "inside the body")


def test_many_specks_are_counted() -> None:
    random = np.random.default_rng(0).normal(size=(40, 3))
    places = 0.05 * random / np.linalg.norm(random, axis=1, keepdims=True)
    healing = _healed(with_specks(_BALL, places, 0.0004))
    assert len(healing.removed) == 40
    assert _says(healing, "35 more")


@pytest.mark.slow
def test_a_bump_that_crosses_the_body_is_no_speck() -> None:
    bump = both(sphere(divisions=4), sphere(0.002, (0.03, 0.0, 0.0), 2))
    healing = _healed(bump, 0.0008)
    assert not healing.removed
    assert healing.surface.box[1, 0] == pytest.approx(0.032, abs=2e-4)


@pytest.mark.slow
def test_all_at_once() -> None:
    """A scan-like ball: noise, holes large and small, flipped triangles, loose vertices, specks."""
    dirty = with_small_holes(with_noise(with_hole(sphere(divisions=4), _TOP, 0.01), 2e-4), 30)
    dirty = with_specks(unmerged(with_flipped(dirty, 0.1)), np.array([[0.05, 0.0, 0.0]]), 0.001)
    healing = _healed(dirty)
    assert _says(healing, "flipped", "hole", "loose speck", "made again")
    assert healing.volume_after == pytest.approx(4 / 3 * np.pi * 0.03**3, rel=0.02)
    assert healing.largest_distance < _FINE


@pytest.mark.slow
def test_the_same_bytes_on_every_run() -> None:
    dirty = with_hole(with_noise(_BALL, 2e-4), _TOP, 0.01)
    one, two = (heal(dirty, resolution=_FINE) for _ in range(2))
    assert one.surface.vertices.tobytes() == two.surface.vertices.tobytes()
    assert one.surface.triangles.tobytes() == two.surface.triangles.tobytes()
    assert one.lines() == two.lines()


def test_a_grid_that_would_be_too_fine_is_coarser_and_says_so() -> None:
    pair = both(_BALL, sphere(0.03, (0.03, 0.0, 0.001), 3))
    from hydrostat.geometry.healing import remake

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(remake, "MAX_GRID_POINTS", 30_000)
        assert _says(heal(pair, resolution=0.001), "coarser than the 1 mm asked for")


@pytest.mark.slow
@pytest.mark.parametrize("dirty", [with_hole(_BALL, _TOP, 0.02), both(_BALL, sphere(0.02, (0.025, 0.0, 0.0), 3))])
def test_settled_blocks_change_nothing(dirty: Surface) -> None:
    """Oracle: the same contour with the winding number summed at every grid point."""
    field = WindingField(dirty)
    box = dirty.box + 0.003 * np.array([[-1.0], [1.0]])
    every, some = contour(field, box, _FINE), contour(field, box, _FINE, settled=field.find_settled_points)
    assert every.vertices.tobytes() == some.vertices.tobytes()
    assert every.triangles.tobytes() == some.triangles.tobytes()
    middle = np.array([[0.0, 0.0, 0.0]])
    assert field.find_settled_points(middle, np.array([0.002])).all()
    assert not field.find_settled_points(_TOP[None], np.array([0.012])).any()


_SHEET = Surface(np.array([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0.0]]), np.array([[0, 1, 2], [0, 2, 3]]))

_CROSS = both(cuboid((0, 0, 0), (0.1, 0.1, 2e-4)), cuboid((0.05, 0.03, -0.05), (0.0502, 0.07, 0.05)))

_TANGLE = Surface(np.random.default_rng(0).random((900, 3)), np.arange(900).reshape(-1, 3))


@pytest.mark.parametrize(
    ("dirty", "word"),
    [
        (_SHEET, "encloses nothing"),
        (Surface(np.eye(3), np.array([[0, 1, 1]])), "none of its triangles has an area"),
        (with_hole(_BALL, _TOP, 0.03 * 2**0.5), "holes so large"),
        (both(_BALL, sphere(0.02, (0.08, 0.0, 0.0), 3)), r"two bodies .* at \(80, "),
        (_CROSS, "smaller elements"),
        (_TANGLE, "run through each other everywhere"),
        (both(with_hole(_BALL, _TOP, 0.005), Surface(0.05 + _SHEET.vertices, _SHEET.triangles)), "are open"),
    ],
    ids=["sheet", "no area", "half", "two bodies", "thin", "tangle", "body and sheet"],
)  # fmt: skip
def test_what_cannot_be_mended_is_refused_with_the_reason(dirty: Surface, word: str) -> None:
    with pytest.raises(SurfaceError, match=word) as caught:
        heal(dirty, resolution=_FINE)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("resolution", [0.0, -1.0, float("nan"), float("inf")])
def test_the_resolution_is_above_0(resolution: float) -> None:
    with pytest.raises(SurfaceError, match="above 0"):
        heal(_BALL, resolution=resolution)


def test_what_is_lost_between_the_corners_of_long_triangles_is_told() -> None:
    """By hand: a web of 1.2 mm, all of whose corners lie inside two blocks, is too thin for a grid of 4 mm."""
    blocks = [cuboid((x - 0.015, -0.015, -0.015), (x + 0.015, 0.015, 0.015)) for x in (-0.04, 0.04)]
    bar = cuboid((-0.035, -0.013, -0.005), (0.035, -0.003, 0.005))
    web = cuboid((-0.035, 0.0084, -0.01), (0.035, 0.0096, 0.01))
    with pytest.raises(SurfaceError, match="of the surface belong to parts that are open, or thinner than the 4 mm"):
        heal(both(*blocks, bar, web), resolution=0.004)
    assert heal(both(*blocks, bar), resolution=0.004).removed == ()


def test_many_vertices_in_one_place_are_merged_in_time() -> None:
    """Oracle: the same ball without them; pairs of 30,000 such would be 450 million."""
    ball = sphere()
    heap = Surface(
        np.concatenate([ball.vertices, np.repeat(ball.vertices[:1], 30_000, axis=0)]),
        np.concatenate([ball.triangles, len(ball.vertices) + np.arange(30_000).reshape(-1, 3)]),
    )
    assert heal(heap, resolution=0.002).volume_after == pytest.approx(ball.volume, rel=1e-9)


def test_a_large_plain_box_through_a_fine_ball_is_no_tangle() -> None:
    """By hand: twelve triangles each cross many small ones, these only one or two: two parts, one body."""
    box = cuboid((-0.05, -0.01, -0.01), (0.05, 0.01, 0.01))
    healing = heal(both(box, sphere(0.02)), resolution=0.002)
    assert healing.volume_after > box.volume
