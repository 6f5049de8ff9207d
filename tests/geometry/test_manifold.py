"""Boundaries that are proper surfaces. Oracle: what libigl calls a manifold, and counting by hand on cubes."""

from itertools import product

import numpy as np
import pytest
from builders import box_mesh
from solids import assert_proper, boundary, euler

from hydrostat.geometry.tetrahedra.manifold import manifold

Cubes = list[tuple[int, int, int]]


def _cubes(places: Cubes) -> tuple[np.ndarray, np.ndarray]:
    """Unit cubes of six tetrahedra each at whole-numbered places; nodes in the same place are one."""
    count = np.max(places, axis=0) + 1
    block = box_mesh(tuple(map(int, count)), size=tuple(map(float, count)))
    chosen = [np.ravel_multi_index(place, tuple(count)) for place in places]
    elements = block.elements.reshape(-1, 6, 4)[chosen].reshape(-1, 4)
    used, elements = np.unique(elements, return_inverse=True)
    return block.nodes[used], elements.reshape(-1, 4)


def test_cubes_joined_at_a_face_stay_as_they_are() -> None:
    nodes, elements = _cubes([(0, 0, 0), (1, 0, 0)])
    mesh, breaks = manifold(nodes, elements)
    np.testing.assert_array_equal(mesh.nodes, nodes)
    np.testing.assert_array_equal(mesh.elements, elements)
    assert breaks.shape == (0, 3)


@pytest.mark.parametrize(
    ("lone", "touch"),
    [((1, 1, 0), [(1, 1, 0), (1, 1, 1)]), ((1, 1, 1), [(1, 1, 1)])],
    ids=["at an edge", "at a node"],
)
def test_of_what_only_touches_the_largest_is_left(lone: tuple[int, int, int], touch: list) -> None:
    """By hand: two cubes have 12 nodes and volume 2; the third goes, and the break is where it touched."""
    mesh, breaks = manifold(*_cubes([lone, (0, 0, 0), (0, 0, 1) if lone[2] == 0 else (0, 1, 0)]))
    assert mesh.volumes.sum() == pytest.approx(2)
    assert len(mesh.nodes) == 12
    assert_proper(mesh)
    expected = touch if lone[2] == 1 else [*touch]
    np.testing.assert_array_equal(np.unique(breaks, axis=0)[: len(expected)], expected)


def test_a_part_apart_breaks_where_it_is_nearest() -> None:
    mesh, breaks = manifold(*_cubes([(0, 0, 0), (1, 0, 0), (3, 0, 0)]))
    assert mesh.volumes.sum() == pytest.approx(2)
    np.testing.assert_array_equal(np.unique(breaks, axis=0), [[3, y, z] for y in (0, 1) for z in (0, 1)])


def test_fingers_that_touch_at_an_edge_are_parted() -> None:
    """By hand: the palm keeps both fingers, and only the node at the tip of the common edge is there twice."""
    nodes, elements = _cubes([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 0, 1), (1, 1, 1)])
    mesh, breaks = manifold(nodes, elements)
    assert not len(breaks)
    assert mesh.volumes.sum() == pytest.approx(5)
    assert len(mesh.nodes) == len(nodes) + 1
    places, counts = np.unique(mesh.nodes, axis=0, return_counts=True)
    np.testing.assert_array_equal(places[counts == 2], [[1, 1, 2]])
    np.testing.assert_array_equal(mesh.nodes[mesh.elements], nodes[elements])
    assert_proper(mesh)
    assert euler(boundary(mesh)) == 2


def test_an_edge_between_two_that_are_joined_at_both_its_ends_loses_the_smaller() -> None:
    """By hand: the fingers of above with a second palm on top; all but some of the six tetrahedra of a cube stay."""
    palms = [(x, y, z) for z in (0, 2) for x, y in ((0, 0), (1, 0), (1, 1))]
    nodes, elements = _cubes([*palms, (0, 0, 1), (1, 1, 1)])
    mesh, _ = manifold(nodes, elements)
    assert_proper(mesh)
    assert 7 <= mesh.volumes.sum() < 8


def test_a_node_where_two_hollows_meet_is_opened() -> None:
    """Of a block of eight cubes two opposite ones are left out: its middle is one node of two fans."""
    full = [place for place in product((0, 1), repeat=3) if place not in ((0, 0, 0), (1, 1, 1))]
    mesh, _ = manifold(*_cubes(full))
    assert_proper(mesh)
    assert 5 <= mesh.volumes.sum() < 6


@pytest.mark.parametrize("seed", range(12))
def test_random_cubes_leave_a_proper_boundary(seed: int) -> None:
    random = np.random.default_rng(seed)
    chosen = random.random((4, 4, 4)) < random.uniform(0.4, 0.8)
    chosen[-1, -1, -1] = True
    nodes, elements = _cubes([tuple(map(int, place)) for place in np.argwhere(chosen)])
    mesh, breaks = manifold(nodes, elements)
    assert_proper(mesh)
    gone = nodes[elements].mean(axis=1)
    assert len(mesh.elements) == len(elements) or len(breaks)
    assert all(np.linalg.norm(np.concatenate([nodes, gone]) - place, axis=1).min() < 1e-12 for place in breaks)
    again, none = manifold(mesh.nodes, mesh.elements)
    np.testing.assert_array_equal(again.elements, mesh.elements)
    assert not len(none)
