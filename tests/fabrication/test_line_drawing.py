"""Line drawings against what geometry says is seen."""

import numpy as np
import pytest
import shapely
from manifold3d import Manifold

from hydrostat.drawing import Camera, LineDrawing
from hydrostat.fabrication.sheets.solid_pictures import drawn_solid
from hydrostat.fabrication.solids.construct import Box, Cylinder, solid_of

SIDE = 10.0


def lines_of(drawing):
    """All that is drawn, as one geometry."""
    return shapely.union_all([shapely.linestrings(way) for way in (*drawing.outlines, *drawing.lines)])


def drawn_share(drawing, start, end):
    """How much of an edge in space is on the drawing, from 0 to 1."""
    edge = shapely.linestrings(drawing.camera.see(np.array([start, end], dtype=float))[:, :2])
    return edge.intersection(lines_of(drawing).buffer(0.05)).length / edge.length


def cube_edges(low=(0.0, 0.0, 0.0)):
    corners = [np.array([x, y, z]) * SIDE + low for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    return [
        (one, two)
        for i, one in enumerate(corners)
        for two in corners[i + 1 :]
        if np.linalg.norm(one - two) < SIDE + 1e-9
    ]


def test_a_cube_shows_nine_of_its_edges():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((SIDE, SIDE, SIDE))))], Camera.isometric())
    shares = sorted(drawn_share(drawing, *edge) for edge in cube_edges())
    assert len(shares) == 12
    # The hidden three meet in one corner behind the front one, and touch drawn lines at their ends only.
    assert max(shares[:3]) < 0.02
    assert min(shares[3:]) > 0.98


def test_lines_are_as_long_as_nine_edges():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((SIDE, SIDE, SIDE))))], Camera.isometric())
    total = sum(shapely.linestrings(way).length for way in (*drawing.outlines, *drawing.lines))
    assert total == pytest.approx(9 * SIDE * np.sqrt(2 / 3), rel=0.01)


def test_six_of_them_are_the_thick_outline():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((SIDE, SIDE, SIDE))))], Camera.isometric())
    outline = sum(shapely.linestrings(way).length for way in drawing.outlines)
    assert outline == pytest.approx(6 * SIDE * np.sqrt(2 / 3), rel=0.02)


def test_no_line_is_drawn_within_a_flat_side():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((SIDE, SIDE, SIDE))))], Camera.isometric())
    assert drawn_share(drawing, (1, 1, SIDE), (SIDE - 1, SIDE - 1, SIDE)) < 0.02


def test_a_cube_in_front_hides_what_is_behind_it():
    view = Camera.isometric()
    ahead = 60 * view.axes[2] + 0.55 * SIDE * view.axes[0]
    cube = solid_of(Box((SIDE, SIDE, SIDE)))
    alone = LineDrawing.of_solids([drawn_solid(cube)], view)
    both = LineDrawing.of_solids([drawn_solid(cube), drawn_solid(cube, shift=ahead.tolist())], view)
    flat = shapely.convex_hull(
        shapely.multipoints(view.see(np.array([c for e in cube_edges(ahead) for c in e]))[:, :2])
    )
    for start, end in cube_edges():
        if drawn_share(alone, start, end) < 0.5:
            continue
        edge = shapely.linestrings(view.see(np.array([start, end]))[:, :2])
        covered = edge.intersection(flat).length / edge.length
        assert drawn_share(both, start, end) == pytest.approx(1 - covered, abs=0.03)
    for start, end in cube_edges(ahead):
        if drawn_share(alone, start - ahead, end - ahead) > 0.5:
            assert drawn_share(both, start, end) > 0.98


def test_a_cube_behind_changes_nothing():
    view, cube = Camera.isometric(), solid_of(Box((SIDE, SIDE, SIDE)))
    small = solid_of(Box((2, 2, 2)).move(4, 4, 4))
    alone = LineDrawing.of_solids([drawn_solid(cube)], view)
    both = LineDrawing.of_solids([drawn_solid(cube), drawn_solid(small)], view)
    assert lines_of(both).hausdorff_distance(lines_of(alone)) < 0.05


@pytest.mark.parametrize("view", [Camera.isometric(), Camera.at(20, 5), Camera.at(130, 80)])
def test_a_sphere_is_a_circle(view):
    drawing = LineDrawing.of_solids([drawn_solid(Manifold.sphere(7.0, 96).translate((1, 2, 3)))], view)
    middle = view.see(np.array([[1.0, 2.0, 3.0]]))[0, :2]
    assert drawing.lines == ()
    radii = np.concatenate([np.linalg.norm(way - middle, axis=1) for way in drawing.outlines])
    assert radii == pytest.approx(7.0, abs=0.03)
    length = sum(shapely.linestrings(way).length for way in drawing.outlines)
    assert length == pytest.approx(2 * np.pi * 7.0, rel=0.01)


def test_a_cylinder_from_the_side_is_a_rectangle():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Cylinder(20, 5)))], Camera.at(30, 0))
    outline = shapely.box(-5, 0, 5, 20).exterior
    assert lines_of(drawing).hausdorff_distance(outline) < 0.05


def test_a_hole_through_a_plate_is_seen_from_above():
    plate = Box((20, 20, 2)) - Cylinder(2, 4).move(10, 10, 0)
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(plate))], Camera.at(0, 90))
    total = sum(shapely.linestrings(way).length for way in (*drawing.outlines, *drawing.lines))
    assert total == pytest.approx(80 + 2 * np.pi * 4, rel=0.01)


def test_tones_are_pale_and_the_top_is_white():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((SIDE, SIDE, SIDE))))], Camera.isometric())
    view = drawing.camera
    middles = {"top": (5, 5, 10), "left": (5, 0, 5), "right": (10, 5, 5)}
    grey = {}
    for name, place in middles.items():
        at = shapely.points(view.see(np.array([place], dtype=float))[0, :2])
        inside = [
            tone for tone, rings in drawing.tones if sum(shapely.Polygon(ring).contains(at) for ring in rings) % 2
        ]
        grey[name] = min(inside, default=1.0)
    assert grey["top"] == 1.0
    assert 0.7 < grey["right"] < grey["left"] < 1.0


def test_a_line_in_space_is_seen_as_far_as_nothing_hides_it():
    drawing = LineDrawing.of_solids([drawn_solid(solid_of(Box((10, 10, 10))))], Camera.at(-90, 0))
    through = np.array([[5.0, -5.0, 5.0], [5.0, -5.0, 5.0 + 10.0]])
    behind = through + np.array([0.0, 30.0, 0.0])
    assert sum(shapely.linestrings(way).length for way in drawing.seen_of(through)) == pytest.approx(10, abs=0.1)
    assert sum(shapely.linestrings(way).length for way in drawing.seen_of(behind)) == pytest.approx(5, abs=0.1)


def test_a_piece_is_pointed_at_where_it_is_seen():
    pieces = [drawn_solid(solid_of(Box((10, 10, 10)))), drawn_solid(solid_of(Box((2, 2, 2)).move(4, 4, 4)))]
    drawing = LineDrawing.of_solids(pieces, Camera.isometric())
    assert drawing.spot_on(1) is None
    spot = drawing.spot_on(0)
    assert spot is not None
    assert shapely.Polygon(np.concatenate(drawing.outlines)).convex_hull.contains(shapely.Point(spot))


def test_the_same_drawing_twice():
    piece = drawn_solid(solid_of(Box((20, 20, 2)) - Cylinder(2, 4).move(10, 10, 0)))
    one, two = (LineDrawing.of_solids([piece], Camera.isometric()) for _ in range(2))
    assert len(one.outlines) == len(two.outlines)
    assert all(np.array_equal(a, b) for a, b in zip(one.outlines, two.outlines, strict=True))
