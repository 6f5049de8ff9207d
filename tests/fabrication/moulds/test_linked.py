"""Halves that are linked with the body: oracles are rings whose lie is known, and what lifting would cut."""

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from mould_robots import foam_robot, slab_body

from hydrostat.fabrication.kit_options import MoldKind, MoldOptions
from hydrostat.fabrication.moulds import setting
from hydrostat.fabrication.moulds.linked import interlock_count, linking_number, loops_of
from hydrostat.fabrication.moulds.mould import TOLERATED, Mold, make_mold


def ring(radius: float = 30.0, thick: float = 8.0, *, facets: int = 24) -> Manifold:
    """A torus about z."""
    return CrossSection.circle(thick, facets).translate((radius, 0)).revolve(2 * facets)


def ball_with_handles() -> Manifold:
    """Three rings that stick out of a ball; the axes of their holes are x, y and z."""
    small = ring(12.0, 4.0, facets=12)
    flat, upright = small.translate((38, 0, 0)), small.rotate((90, 0, 0)).translate((0, 0, 38))
    return Manifold.sphere(30, 32) + flat + upright + small.rotate((0, 90, 0)).translate((0, 38, 0))


def halves(body: Manifold) -> tuple[Manifold, Manifold]:
    """A block round a body, parted at z = 0: the lower half and the upper."""
    low, high = np.reshape(body.bounding_box(), (2, 3))
    mould = Manifold.cube(tuple(high - low + 20)).translate(tuple(low - 10)) - body
    return mould.trim_by_plane((0, 0, -1), 0.0), mould.trim_by_plane((0, 0, 1), 0.0)


def links(body: Manifold) -> tuple[int, int]:
    lower, upper = halves(body)
    return interlock_count(lower, body), interlock_count(upper, body)


def test_links_of_a_chain_are_counted() -> None:
    """Oracle: circles drawn by hand."""
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    cos, sin, none = np.cos(turn), np.sin(turn), np.zeros(40)
    one = np.column_stack([cos, sin, none])
    assert abs(linking_number(one, np.column_stack([1 + cos, none, sin]))) == 1
    assert linking_number(one, np.column_stack([3 + cos, none, sin])) == 0
    twice = np.column_stack([(2 + cos) * np.cos(2 * turn), (2 + cos) * np.sin(2 * turn), sin])  # round the axis twice
    axis = np.array([[0, 0, -50], [0, 0, 50], [90, 0, 50], [90, 0, -50]], dtype=float)
    assert abs(linking_number(twice, axis)) == 2


def test_two_loops_for_each_handle() -> None:
    """Oracle: the genus that manifold3d counts."""
    for solid in (Manifold.sphere(10, 24), ring(), ball_with_handles()):
        assert len(loops_of(solid)) == 2 * solid.genus()


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (ring(), (0, 0)),
        (ring().rotate((90, 0, 0)), (1, 1)),
        (ring().rotate((90, 0, 0)).translate((0, 0, 50)), (0, 1)),
        (ring().rotate((90, 0, 0)).trim_by_plane((0, 0, 1), -5), (0, 0)),
        (
            Manifold.cube((100, 60, 20), True)
            - ring(20, 5).translate((0, 0, 10))
            - Manifold.cylinder(30, 6, 6, 32, True),
            (0, 0),
        ),
        (ball_with_handles(), (1, 2)),
    ],
    ids=["lying", "standing", "above", "arch", "plate with a hole and a groove", "three handles"],
)
def test_holes_that_a_half_closes_are_counted(body: Manifold, expected: tuple[int, int]) -> None:
    """Oracle: which rings stand and which lie. An arch alone does not hold: it is drawn out end first."""
    assert links(body) == expected


def test_what_is_linked_would_cut_the_body_when_it_is_lifted() -> None:
    """Oracle: booleans; turned and moved it is the same."""
    body = ball_with_handles()
    lower, upper = halves(body)
    assert all((upper.translate((0, 0, lift)) ^ body).volume() > 400 for lift in (2, 5, 10))
    pose = np.array([[0.36, 0.48, -0.8, 7.0], [-0.8, 0.6, 0.0, -3.0], [0.48, 0.64, 0.6, 11.0]])
    assert interlock_count(upper.transform(pose), body.transform(pose)) == 2
    assert interlock_count(lower.transform(pose), body.transform(pose)) == 1


def mould_of(solid: Manifold, kind: MoldKind, monkeypatch: pytest.MonkeyPatch) -> Mold:
    monkeypatch.setattr(setting, "body_solid", lambda body: solid)
    return make_mold(foam_robot(slab_body()), MoldOptions(kind=kind))


@pytest.mark.slow
def test_mould_that_is_linked_with_the_body_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    mould = mould_of(ball_with_handles(), MoldKind.PRINTED, monkeypatch)
    assert mould.pull.share < TOLERATED  # of the skin little is undercut: its area alone does not tell
    (problem,) = mould.problems
    assert "like a link of a chain" in problem


@pytest.mark.slow
def test_silicone_that_is_linked_is_to_be_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    mould = mould_of(ball_with_handles(), MoldKind.SILICONE, monkeypatch)
    assert mould.problems == ()
    assert any("Cut the silicone open" in warning for warning in mould.warnings)


@pytest.mark.slow
def test_ring_is_laid_flat(monkeypatch: pytest.MonkeyPatch) -> None:
    mould = mould_of(ring(facets=12).rotate((70, 20, 0)), MoldKind.PRINTED, monkeypatch)
    assert mould.problems == ()
    assert mould.warnings == ()
