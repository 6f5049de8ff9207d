"""Each way in which a part cannot be sliced is found."""

import numpy as np
import pytest
from manifold3d import Manifold, Mesh

from hydrostat.fabrication.checks.solid_checks import compute_volume, watertight_problems
from hydrostat.fabrication.solids.construct import Box, solid_of
from hydrostat.fabrication.solids.printed import Printed


def printed(solid: Manifold) -> Printed:
    return Printed(name="part", title="Part", solid=solid)


CUBE = solid_of(Box((10, 10, 10)))
CORNERS, FACES = printed(CUBE).file_mesh


def written_as(faces: np.ndarray) -> Printed:
    """A sound solid, of which its engine says that all is well, with other triangles in its files."""
    part = printed(CUBE)
    vars(part)["file_mesh"] = CORNERS, faces
    return part


def test_a_cube_on_the_bed_has_no_problem():
    assert watertight_problems(printed(CUBE)) == ()


def test_a_hollow_within_a_body_is_no_piece():
    assert watertight_problems(printed(CUBE - Manifold.cube((4, 4, 4)).translate((3, 3, 3)))) == ()


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (printed(Manifold()), "empty"),
        (printed(Manifold(Mesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], dtype=np.uint32)))), "no solid"),
        (printed(CUBE.translate((0, 0, 0.5))), "z = 0.5000 mm"),
        (printed(CUBE.translate((0, 0, -2))), "z = -2.0000 mm"),
        (printed(CUBE + CUBE.translate((20, 0, 0))), "falls into 2 pieces"),
        (written_as(FACES[1:]), "3 edges"),
        (written_as(np.concatenate([FACES[1:], FACES[:1, ::-1]])), "3 edges"),
        (written_as(np.concatenate([FACES, FACES])), "18 edges"),
        (written_as(np.concatenate([FACES, FACES])), "became 2000 mm^3"),
        (written_as(FACES[:, ::-1]), "inside out"),
    ],
)
def test_each_problem_is_told(part: Printed, told: str):
    """Oracle: solids made wrong on purpose."""
    problems = watertight_problems(part)
    assert any(told in problem for problem in problems), problems


def test_a_volume_that_rounding_spoils_is_told():
    """Oracle: a skin of 0.000001 mm, a tenth of what the files can hold."""
    skin = Manifold.cube((50, 50, 10)) - Manifold.cube((60, 60, 20)).translate((-5, -5, 1e-6))
    assert watertight_problems(printed(skin)) != ()


def test_volumes_by_the_divergence_theorem():
    """Oracle: the corner of a cube, 1/6 of it."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) + 7
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert compute_volume(corners, faces) == pytest.approx(1 / 6, rel=1e-12)
    assert compute_volume(corners, faces[:, ::-1]) == pytest.approx(-1 / 6, rel=1e-12)
