"""STEP: true solids, the same as the triangles; and what is told where build123d is missing.

What needs build123d (the extra `cad`, 1 GB installed) is skipped without it.
"""

import math
import re
import sys
from importlib.util import find_spec

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.fabrication.solids.construct import Box, Construction, Cylinder, Prism, Revolve, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.solids.step import model_of, step_bytes
from hydrostat.version import install_command

needs_cad = pytest.mark.skipif(find_spec("build123d") is None, reason="needs build123d (extra cad)")

LETTER = ((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
SPOOL = ((0.0, 0.0), (9.0, 0.0), (9.0, 1.0), (5.0, 3.0), (5.0, 6.0), (0.0, 6.0))

BODIES: dict[str, tuple[Construction, float]] = {
    "box": (Box((2, 3, 4)), 24.0),
    "cylinder": (Cylinder(5, 2), 20 * math.pi),
    "cone": (Cylinder(6, 3, 1), 26 * math.pi),
    "point": (Cylinder(6, 3, 0), 18 * math.pi),
    "prism": (Prism(LETTER, 2), 12.0),
    "ring": (Revolve(((5.0, 0.0), (8.0, 0.0), (8.0, 2.0), (5.0, 2.0))), 78 * math.pi),
    "spool": (Revolve(SPOOL), math.pi * (81 + 2 * (81 + 45 + 25) / 3 + 3 * 25)),
    "plate": (Box((20, 20, 3)) - Cylinder(9, 4).move(10, 10, -1), 1200 - 48 * math.pi),
    "joined": (Box((4, 4, 4)) + Box((4, 4, 4)).move(2, 0, 0).rotate(z=90), 4.0 * (16 + 16)),
    "common": (Cylinder(4, 3) & Box((9, 9, 9)), 9 * math.pi),
}


def part(model: Construction | None) -> Printed:
    solid = solid_of(Box((1, 1, 1)) if model is None else model)
    return Printed(name="part", title="Part", solid=solid, model=model)


def read_back(content: bytes, folder):
    build123d = pytest.importorskip("build123d")
    path = folder / "part.step"
    path.write_bytes(content)
    return build123d.import_step(str(path))


def box_of(shape) -> np.ndarray:
    box = shape.bounding_box()
    return np.array([tuple(box.min), tuple(box.max)])


@needs_cad
@pytest.mark.parametrize("name", BODIES)
def test_volumes_are_exact_and_triangles_agree(name: str, tmp_path):
    """Oracle: closed forms to 1e-9, of what Open CASCADE reads back; triangles are within 0.02 mm of it."""
    body, volume = BODIES[name]
    seen = read_back(step_bytes(part(body)), tmp_path)
    assert seen.is_valid
    assert seen.volume == pytest.approx(volume, rel=1e-9)
    solid = solid_of(body)
    assert abs(solid.volume() - seen.volume) <= 0.02 * solid.surface_area() + 1e-6
    np.testing.assert_allclose(np.array(solid.bounding_box()).reshape(2, 3), box_of(seen), atol=0.021)


@needs_cad
def test_cylinders_stay_cylinders(tmp_path):
    """Oracle: the faces that Open CASCADE reads back: a plate with two bores and a sunk head."""
    model = Box((30, 10, 4))
    for x in (8, 22):
        model = model - Cylinder(9, 2).move(x, 5, -1)
    model = model - Cylinder(1.5, 2, 3.5).move(22, 5, 2.5)
    seen = read_back(step_bytes(part(model)), tmp_path)
    kinds = [str(face.geom_type).split(".")[-1] for face in seen.faces()]
    assert sorted(kinds) == ["CONE", "CYLINDER", "CYLINDER", *["PLANE"] * 6]


@needs_cad
@pytest.mark.parametrize(
    "placed",
    [
        lambda shape: shape.move(5, -3, 2),
        lambda shape: shape.rotate(x=90),
        lambda shape: shape.rotate(x=90, z=90),
        lambda shape: shape.rotate(x=30, y=-50, z=110),
        lambda shape: shape.move(1, 2, 3).rotate(y=40, x=20),
        lambda shape: shape.rotate(y=40, x=20).move(1, 2, 3),
    ],
)
def test_both_backends_turn_and_move_alike(placed):
    """Oracle: each other, on a shape that is nowhere its own mirror image; its center of mass and its box."""
    shape = placed(Prism(LETTER, 2) + Box((1, 1, 7)))
    model, solid = model_of(shape), solid_of(shape)
    np.testing.assert_allclose(box_of(model), np.array(solid.bounding_box()).reshape(2, 3), atol=1e-6)
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[np.asarray(mesh.tri_verts)]
    wedges = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    middle = (wedges[:, None] * corners.sum(axis=1) / 4).sum(axis=0) / wedges.sum()
    np.testing.assert_allclose(tuple(model.center(_mass())), middle, atol=1e-6)


def _mass():
    return pytest.importorskip("build123d").CenterOf.MASS


@needs_cad
def test_the_same_part_gives_the_same_bytes_without_a_date():
    one = step_bytes(part(BODIES["plate"][0]))
    assert one == step_bytes(part(BODIES["plate"][0]))
    header = one.split(b"ENDSEC")[0].decode()
    assert re.findall(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", header) == ["1970-01-01T00:00:00"]
    assert "FILE_NAME('part'" in header


def test_a_part_without_a_model_has_no_step():
    with pytest.raises(InputError, match="part: has no STEP"):
        step_bytes(part(None))


def test_where_build123d_is_missing_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "build123d", None)
    with pytest.raises(InputError, match=re.escape(install_command("cad"))):
        step_bytes(part(Box((1, 1, 1))))
