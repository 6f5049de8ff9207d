"""Candidate muscles. Oracles: the mesh's own edges, plane geometry, brute force over angles."""

import numpy as np
import pytest
import shapely
from builders import box_mesh, strip_mesh, strip_robot

from hydrostat.design import edge_fibres
from hydrostat.design.muscles.activation import element_fibres, wanted_directions
from hydrostat.mechanics import NewtonOptions, minimize
from hydrostat.robot import PoseTarget
from hydrostat.simulation import BodyPhysics


def turned(count: int, angle: float) -> np.ndarray:
    return np.tile([np.cos(angle), np.sin(angle)], (count, 1))


def test_edge_fibres_are_the_edges() -> None:
    mesh = strip_mesh(5, 3)
    fibres = edge_fibres(mesh)
    assert len(fibres) == len(mesh.edges)
    assert np.array_equal(fibres.ends(mesh.nodes), mesh.nodes[mesh.edges])
    spans = np.diff(mesh.nodes[mesh.edges], axis=1)[:, 0]
    assert fibres.energy().lengths(mesh.nodes) == pytest.approx(np.linalg.norm(spans, axis=1))


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.1, np.pi / 2, 2.9])
def test_element_fibres_run_from_side_to_side_through_the_centroid(angle: float) -> None:
    mesh = strip_mesh(5, 3)
    ends = element_fibres(mesh, turned(len(mesh.elements), angle)).ends(mesh.nodes)
    for corners, (start, end) in zip(mesh.nodes[mesh.elements], ends, strict=True):
        triangle = shapely.Polygon(corners)
        line = shapely.LineString(corners.mean(axis=0) + np.outer([-1, 1], [np.cos(angle), np.sin(angle)]))
        chord = triangle.intersection(line)
        assert np.linalg.norm(end - start) == pytest.approx(chord.length, rel=1e-9)
        for point in (start, end):
            assert triangle.exterior.distance(shapely.Point(point)) < 1e-12
        along = (end - start) / np.linalg.norm(end - start)
        assert along == pytest.approx([np.cos(angle), np.sin(angle)], abs=1e-9)
        assert shapely.LineString([start, end]).distance(triangle.centroid) < 1e-12


def test_element_fibres_in_space_end_on_faces() -> None:
    mesh = box_mesh((2, 1, 1))
    direction = np.array([0.6, 0.48, 0.64])
    fibres = element_fibres(mesh, np.tile(direction, (len(mesh.elements), 1)))
    for weights in (fibres.start, fibres.end):
        assert weights.sum(axis=1) == pytest.approx(np.ones(len(mesh.elements)))
        assert weights.min(axis=1) == pytest.approx(np.zeros(len(mesh.elements)), abs=1e-12)
    spans = np.diff(fibres.ends(mesh.nodes), axis=1)[:, 0]
    assert spans / np.linalg.norm(spans, axis=1)[:, None] == pytest.approx(np.tile(direction, (len(spans), 1)))


def test_wanted_directions_are_the_best_of_all_angles() -> None:
    """Brute force: pull a little along every angle in some elements, solve, and see which lowers the error most."""
    robot = strip_robot(columns=6, rows=2)
    mesh, goal = robot.body.mesh, np.array([0.19, 0.03])
    directions = wanted_directions(robot, PoseTarget(name="up", targets={"tip": tuple(goal.tolist())}))
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(len(directions)))
    tip = int(np.argmin(np.linalg.norm(mesh.nodes - [0.2, 0.0], axis=1)))
    count, angles, tension = len(mesh.elements), np.radians(np.arange(0, 180, 3)), 1e-4
    errors = np.zeros((len(angles), count))
    body = BodyPhysics(robot)
    for row, angle in enumerate(angles):
        fibres = element_fibres(mesh, turned(count, angle))
        assembly = body.assembly.with_added_energies([fibres.energy()], control_count=count)
        for fibre in range(3, count, 5):
            tensions = np.zeros(count)
            # The same couple of forces at the ends of a fibre of unit length, whatever its own length is.
            tensions[fibre] = tension / fibres.energy().lengths(mesh.nodes)[fibre]
            solved = minimize(
                assembly,
                mesh.nodes,
                tensions,
                round_off=body.round_off(),
                options=NewtonOptions(),
            )
            errors[row, fibre] = np.sum((solved.nodes[tip] - goal) ** 2)
    for fibre in range(3, count, 5):
        best = angles[np.argmin(errors[:, fibre])]
        apart = abs(directions[fibre] @ [np.cos(best), np.sin(best)])
        assert apart > np.cos(np.radians(4))
