"""Whole molds: oracles are closed forms, boolean intersection, trimesh, and a search for air slice by slice."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import trimesh
from builders import gallery_robot, mesh_body, strip_mesh
from manifold3d import Manifold
from mould_robots import blob_body, foam_robot, slab_body

from hydrostat.errors import InputError
from hydrostat.fabrication.body_work import MANY_PIECES, foam_work
from hydrostat.fabrication.checks.mold_checks import mold_checks
from hydrostat.fabrication.kit_options import KitOptions, Method, MoldKind, MoldOptions
from hydrostat.fabrication.moulds import mould as mould_module
from hydrostat.fabrication.moulds.closing import Closing, make_closing
from hydrostat.fabrication.moulds.halves import Halves
from hydrostat.fabrication.moulds.mould import TOP_RIM, Mold, make_mold, mold_problems
from hydrostat.fabrication.moulds.openings import Sprue, make_sprue
from hydrostat.fabrication.moulds.pull import Pull, find_pull
from hydrostat.fabrication.solids.assembly import interferences
from hydrostat.robot import MATERIALS, Pin, Robot

PARTS = ("upper", "lower", "cavity", "sprue", "vents", "bolts", "slots", "keys")
BIG = (1000.0, 1000.0, 1000.0)


@pytest.fixture(scope="module")
def blob() -> Mold:
    body = blob_body()
    robot = foam_robot(body, (0.0, 0.0, 0.0), at=(0.02, 0.0, 0.02))
    return make_mold(robot, MoldOptions(bed=BIG), pockets={"w0": (14.0, 12.0, 10.0)})


@pytest.fixture(scope="module")
def slab() -> Mold:
    return make_mold(foam_robot(slab_body()), MoldOptions(wall=9.0, bed=BIG))


@pytest.fixture(scope="module")
def trunk() -> Mold:
    return make_mold(gallery_robot("trunk"), MoldOptions())


def left_over(mould: Mold) -> float:
    return sum(mould.volumes[part] for part in PARTS) / mould.volumes["box"] - 1


@pytest.mark.slow
def test_account_is_exact_on_tetrahedra(blob: Mold) -> None:
    volumes = blob.volumes
    assert volumes["body"] == pytest.approx(1e9 * blob_body().mesh.volumes.sum(), rel=1e-9)
    assert volumes["cavity"] == pytest.approx(volumes["body"] - volumes["dents"] - volumes["pockets"], rel=1e-9)
    assert volumes["box"] == pytest.approx(np.prod(blob.box), rel=1e-9)
    assert abs(left_over(blob)) < 1e-9
    assert volumes["dents"] > 0
    assert volumes["pockets"] > 14 * 12 * 10 / 2
    whole = blob.assembly.pieces
    assert whole[0].solid.volume() == pytest.approx(volumes["lower"])
    assert whole[2].solid.volume() == pytest.approx(volumes["upper"])


def failed(robot: Robot, mould: Mold) -> list[str]:
    """Beginnings of the checks that do not hold."""
    return [check.what[:8] for check in mold_checks(robot, mould) if not check.passed]


@pytest.mark.slow
def test_checks_of_a_mould_hold_and_fail_on_geometry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys that fill the cavity, a sprue beside the mold, one that ends in the wall, a half with a hole too many."""
    robot = foam_robot(slab_body())
    for kind in MoldKind:
        assert failed(robot, make_mold(robot, MoldOptions(kind=kind, bed=BIG))) == []
    whole = make_mold(robot, MoldOptions(bed=BIG))

    def with_cube(*args: Any, **options: Any) -> Closing:
        return replace(make_closing(*args, **options), bumps=Manifold.cube((40, 40, 40), True))

    with monkeypatch.context() as swapped:
        swapped.setattr(mould_module, "make_closing", with_cube)
        assert failed(robot, make_mold(robot, MoldOptions(bed=BIG))) == ["pieces, "]
    for away in ((500, 0, 0), (0, 15, 0)):

        def moved(*args: Any, away: tuple[int, int, int] = away, **options: Any) -> Sprue | None:
            sprue = make_sprue(*args, **options)
            return sprue and replace(sprue, solid=sprue.solid.translate(away))

        with monkeypatch.context() as swapped:
            swapped.setattr(mould_module, "make_sprue", moved)
            assert failed(robot, make_mold(robot, MoldOptions(bed=BIG))) == ["sprue, c"]
    printed = (replace(whole.printed[0], solid=whole.printed[0].solid - Manifold.cube((2, 2, 2))), *whole.printed[1:])
    assert failed(robot, replace(whole, printed=printed)) == ["pieces, "]


@pytest.mark.slow
def test_check_of_a_silicone_mould_fails_on_its_positive() -> None:
    robot = foam_robot(slab_body())
    mould = make_mold(robot, MoldOptions(kind=MoldKind.SILICONE, bed=BIG))
    assert not any("halves" in check.what for check in mold_checks(robot, mould))
    assert failed(robot, replace(mould, printed=mould.printed[1:])) == ["pieces o"]


@pytest.mark.slow
def test_much_printing_is_a_warning() -> None:
    """Oracle: pieces and mass, counted here."""
    robot = foam_robot(slab_body((1.2, 0.9, 0.03)))
    work = foam_work(robot, KitOptions(method=Method.FOAM), ())
    kilograms = 1e-3 * sum(part.count * part.mass for part in work.printed)
    count = sum(part.count for part in work.printed)
    assert count > MANY_PIECES
    assert f"{count} pieces and {kilograms:.1f} kg" in " ".join(work.warnings)
    assert foam_work(foam_robot(slab_body()), KitOptions(method=Method.FOAM), ()).warnings == ()


@pytest.mark.slow
def test_material_that_is_not_poured_is_a_problem() -> None:
    mould = make_mold(foam_robot(slab_body(material="polyester fibre")), MoldOptions(bed=BIG))
    assert len(mould.problems) == 1
    assert "would differ from the simulated one" in mould.problems[0]


@pytest.mark.slow
def test_slab_has_the_mould_of_the_closed_form(slab: Mold) -> None:
    mould = slab
    assert mould.pull.share == 0
    assert abs(mould.pull.direction) == pytest.approx([0, 0, 1])
    assert mould.pull.height == pytest.approx(0, abs=1)
    assert sorted(mould.box) == pytest.approx(sorted([60 + 18, 80 + 26, 100 + 13 + TOP_RIM]))
    assert mould.volumes["cavity"] == pytest.approx(100 * 80 * 60)
    key, odd = 4.0, 3.0
    cone = [np.pi / 3 * h * (a * a + a * b + b * b) for r in (key, odd) for a, b, h in ((r, 0.8 * r, 4.0),)]
    wide = [np.pi / 3 * h * (a * a + a * b + b * b) for r in (key, odd) for a, b, h in ((r + 0.2, 0.8 * r + 0.2, 4.2),)]
    gaps = 3 * (wide[0] - cone[0]) + wide[1] - cone[1]
    assert mould.volumes["keys"] == pytest.approx(gaps, rel=0.02)
    assert mould.volumes["bolts"] == pytest.approx(mould.bolts * np.pi * 2.25**2 * 78, rel=0.02)


def test_keys_have_their_clearance_and_holes_meet(blob: Mold) -> None:
    lower, upper = blob.assembly.pieces[0].solid, blob.assembly.pieces[2].solid
    bumps = lower.trim_by_plane((0, 0, 1), 0.01).decompose()
    keys = [bump for bump in bumps if bump.bounding_box()[5] == pytest.approx(4.0)]
    assert len(keys) == 4
    for key in keys:
        assert 0.15 < key.min_gap(upper, 1.0) <= 0.2001
    assert len({round(key.volume()) for key in keys}) == 2  # one is smaller


@pytest.mark.slow
def test_nothing_is_in_the_way_of_anything(blob: Mold, trunk: Mold) -> None:
    assert not interferences(blob.assembly)
    assert not interferences(trunk.assembly)
    pieces = list(blob.assembly.pieces)
    pieces[2] = replace(pieces[2], solid=pieces[2].solid.translate((0, 0, -1)))
    assert interferences(replace(blob.assembly, pieces=tuple(pieces)))


def test_halves_come_off_the_body_along_the_pull(slab: Mold) -> None:
    lower, body, upper = (piece.solid for piece in slab.assembly.pieces)
    for lift in (1.0, 10.0, 40.0):
        assert (upper.translate((0, 0, lift)) ^ body).volume() < 1e-3
        assert (lower.translate((0, 0, -lift)) ^ body).volume() < 1e-3
    assert (upper.translate((0, 0, -1.0)) ^ body).volume() > 100


def void_of(mould: Mold) -> tuple[Manifold, Manifold]:
    """What is joined to the outside, a little of which is in it, turned so that up is z; and the block."""
    lower, _, upper = (piece.solid for piece in mould.assembly.pieces)
    both = lower + upper
    low, high = np.reshape(both.bounding_box(), (2, 3))
    block = Manifold.cube(tuple(high - low)).translate(tuple(low))
    around = Manifold.cube(tuple(high - low + 20)).translate(tuple(low - 10))
    void = around - both
    shells = sorted(void.decompose(), key=lambda shell: shell.volume())
    assert shells[0].volume() < 0  # the block's, turned inside out
    for gap in shells[1:-1]:  # between keys and sockets
        assert gap.volume() < 100
        void = void - gap
    return void.rotate((90, 0, 0)), block.rotate((90, 0, 0))


def caught(void: Manifold, block: Manifold, step: float = 1.5) -> list[float]:
    """Heights of rooms in the block that end upwards and are higher than a step, by slices from the top down."""
    low, high = block.bounding_box()[2], block.bounding_box()[5]
    footprint = block.slice((low + high) / 2).offset(-0.01)
    above, ended, found = void.slice(high + step / 2), [], []
    for height in np.arange(high - step / 2, low, -step):
        section = void.slice(float(height))
        rooms = section.decompose()
        for top in ended:
            meeting = [room for room in rooms if (room ^ top).area() > 0]
            if all(((room ^ above) - top).area() < 1e-3 for room in meeting):
                found.append(float(height))
        ended = [room for room in rooms if (room ^ above).area() < 1e-3 and (room - footprint).area() < 1e-3]
        above = section
    return found


@pytest.mark.slow
def test_air_leaves_everywhere(trunk: Mold, blob: Mold) -> None:
    assert caught(*void_of(trunk)) == []
    assert caught(*void_of(blob)) == []


@pytest.mark.slow
def test_search_for_air_can_fail(trunk: Mold) -> None:
    void, block = void_of(trunk)
    lid = block.trim_by_plane((0, 0, 1), block.bounding_box()[5] - 10)
    assert caught(void - lid, block)


@pytest.mark.slow
def test_pieces_fit_the_bed_and_are_watertight_for_trimesh(trunk: Mold) -> None:
    for piece in trunk.printed:
        vertices, triangles = piece.mesh
        other = trimesh.Trimesh(vertices, triangles, process=True)
        assert other.is_watertight
        assert other.is_winding_consistent
        assert other.volume == pytest.approx(piece.volume, rel=1e-6)
        assert other.bounds[0] == pytest.approx([0, 0, 0], abs=1e-6)
        assert max(piece.size[:2]) <= 220
    halves = sum(piece.volume for piece in trunk.printed if piece.name.startswith("mould"))
    expected = trunk.volumes["upper"] + trunk.volumes["lower"] - trunk.volumes["cutting"]
    assert halves == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_trunk_is_poured_into_its_held_end(trunk: Mold) -> None:
    assert "held end at the top" in trunk.stands
    assert trunk.stance.axes[1] @ [0, 0, 1] > 0.9  # it is held at z = 0 and hangs down
    assert trunk.pull.share < 0.01
    assert trunk.problems == ()
    assert trunk.warnings == ()


@pytest.mark.slow
def test_flat_body_is_parted_at_half_its_thickness() -> None:
    body = mesh_body(strip_mesh(8, 4, size=(0.1, 0.05)), thickness=0.02)
    pin = Pin(box=((-0.01, -0.1), (0.01, 0.1)))
    mould = make_mold(Robot(name="strip", body=body, pins=(pin,), poses={}), MoldOptions(bed=BIG))
    assert mould.pull.share == 0
    assert abs(mould.pull.direction) == pytest.approx([0, 0, 1])
    assert mould.volumes["cavity"] == pytest.approx(100 * 50 * 20)
    for half in (mould.assembly.pieces[0].solid, mould.assembly.pieces[2].solid):
        low, high = (0, 18) if half.bounding_box()[5] > 17 else (-18, 0)
        back = half.slice(high - 1.0 if high else low + 1.0)
        outline = mould.box[0] * mould.box[1] - mould.bolts * np.pi * 2.25**2
        assert back.area() == pytest.approx(outline, rel=2e-3)  # the funnel does not break through
    assert abs(left_over(mould)) < 1e-9


@pytest.mark.slow
def test_same_robot_gives_the_same_numbers(blob: Mold) -> None:
    robot = foam_robot(blob_body(), (0.0, 0.0, 0.0), at=(0.02, 0.0, 0.02))
    again = make_mold(robot, MoldOptions(bed=BIG), pockets={"w0": (14.0, 12.0, 10.0)})
    assert again.volumes == blob.volumes
    for one, other in zip(again.printed, blob.printed, strict=True):
        assert np.array_equal(one.mesh[0], other.mesh[0])
        assert np.array_equal(one.mesh[1], other.mesh[1])


@pytest.mark.slow
def test_silicone_frames_hold_what_the_pours_say() -> None:
    mould = make_mold(foam_robot(slab_body()), MoldOptions(kind=MoldKind.SILICONE, bed=BIG))
    names = [piece.name for piece in mould.printed]
    assert names == ["positive_lower", "positive_upper", "frame_lower", "frame_upper", "key_dome"]
    assert not interferences(mould.assembly)
    first, second = mould.casting.silicone
    block = 124 * 104 * 84
    positive = sum(piece.solid.volume() for piece in mould.assembly.pieces if piece.name.startswith("positive"))
    dowels = 2 * np.pi * 1.6**2 * 16
    assert first.volume + second.volume == pytest.approx(block - positive - dowels, rel=1e-3)
    assert mould.bolts == 0
    assert mould.casting.silicone_cost > 0


@cache
def cube_pull() -> Pull:
    return find_pull(Manifold.cube((50, 50, 50), True), count=1)


def problems_of(share: float, material: str, kind: MoldKind) -> tuple[str, ...]:
    cube = Manifold.cube((50, 50, 50), True)
    pull = replace(cube_pull(), share=share)
    halves = Halves(upper=cube, lower=cube, cavity=cube, poured=cube, volumes={})
    sprue = make_sprue(cube, top=45, room=(-40, 40), deep=33)
    return mold_problems(pull, MATERIALS[material], sprue, (), (), MoldOptions(kind=kind), halves)


@pytest.mark.slow
def test_tight_grip_is_a_problem_of_a_rigid_mould_only() -> None:
    assert problems_of(0.2, "flexfoam-it x", MoldKind.PRINTED) == ()
    assert "40 % of the surface is undercut" in problems_of(0.4, "flexfoam-it x", MoldKind.PRINTED)[0]
    assert "20 % of the surface is undercut" in problems_of(0.2, "mold max 30", MoldKind.PRINTED)[0]
    assert problems_of(0.4, "flexfoam-it x", MoldKind.SILICONE) == ()


def test_half_in_two_and_no_sprue_are_problems() -> None:
    cube = Manifold.cube((50, 50, 50), True)
    two = cube + cube.translate((100, 0, 0))
    halves = Halves(upper=two, lower=cube, cavity=cube, poured=cube, volumes={})
    found = mold_problems(cube_pull(), MATERIALS["flexfoam-it x"], None, (), (), MoldOptions(), halves)
    assert [sentence[:20] for sentence in found] == ["the parting plane do", "the upper half of th"]


def test_options_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="mark_depth must be above 0 mm"):
        MoldOptions(mark_depth=-1.0)
