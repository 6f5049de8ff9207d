"""Where cables may be. Oracles: closed form, brute force, finite differences; examples as they are shipped."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.design.polyline import least_along
from hydrostat.design.region import FlatRegion, Region
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, Solid
from hydrostat.robot import Body, load_robot

EXAMPLES = Path(__file__).parents[2] / "examples"
STRIP = np.array([[0.0, -0.025], [0.2, 0.025]])
BOX = np.array([[0.0, 0.0, 0.0], [0.1, 0.05, 0.05]])


@cache
def body(name: str) -> Body:
    if name == "strip":
        return mesh_body(strip_mesh(8, 2))
    return mesh_body(box_mesh((4, 2, 2))) if name == "box" else load_robot(EXAMPLES / name).body


@cache
def region(name: str, clearance: float = 0.005) -> Region:
    return Region.of_body(body(name), clearance)


def some_places(name: str, count: int, *, beyond: float = 0.01) -> np.ndarray:
    nodes = body(name).mesh.nodes
    low, high = nodes.min(axis=0) - beyond, nodes.max(axis=0) + beyond
    return np.random.default_rng(1).uniform(low, high, (count, nodes.shape[1]))


@pytest.mark.parametrize(("name", "corners"), [("strip", STRIP), ("box", BOX)])
def test_depths_in_a_box(name: str, corners: np.ndarray) -> None:
    low, high = corners
    points = some_places(name, 300)
    inner = np.minimum(points - low, high - points).min(axis=1)
    outer = np.linalg.norm(points - np.clip(points, low, high), axis=1)
    assert region(name).depths(points) == pytest.approx(np.where(outer > 0, -outer, inner), abs=1e-12)


@pytest.mark.slow
def test_depths_in_a_hand_as_solids_have_them(unchecked: None) -> None:
    """`Solid` tells inside from outside by winding numbers, a region by mean normals."""
    healing = body("cupping_hand").healing
    assert healing is not None
    points = some_places("cupping_hand", 2000)
    assert region("cupping_hand").depths(points) == pytest.approx(-Solid(healing.surface).distances(points), abs=1e-12)


@pytest.mark.parametrize("name", ["strip", "box", "starfish", "cupping_hand"])
def test_inward_is_the_gradient_of_depth(name: str) -> None:
    """Central differences; on the skeleton, where two places are the nearest, there is none."""
    points, step = some_places(name, 300), 1e-7
    here = region(name)
    steps = step * np.eye(points.shape[1])
    ahead = np.array([here.depths(points + one) - here.depths(points) for one in steps]).T / step
    back = np.array([here.depths(points) - here.depths(points - one) for one in steps]).T / step
    smooth = np.abs(ahead - back).max(axis=1) < 1e-3
    assert smooth.mean() > 0.95
    assert here.inward(points)[smooth] == pytest.approx(ahead[smooth], abs=1e-3)
    assert np.linalg.norm(here.inward(points), axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["strip", "box", "starfish", "cupping_hand"])
def test_points_pushed_inside_are_deep_enough(name: str, unchecked: None) -> None:
    """1.02 clearances; arcs about inner corners are cut by chords, half a percent nearer."""
    nodes = body(name).mesh.nodes
    pushed = region(name).push_inside(nodes)
    assert region(name).depths(pushed).min() >= 1.014 * 0.005
    deep = region(name).depths(nodes) >= 1.021 * 0.005
    assert np.array_equal(pushed[deep], nodes[deep])
    assert np.linalg.norm(pushed - nodes, axis=1).max() < 4 * 0.005


def test_points_outside_come_in() -> None:
    """To the nearest place that is deep enough: in front of a side, straight in."""
    for name, outside, inside in [
        ("strip", [0.1, 0.04], [0.1, 0.0199]),
        ("box", [0.05, 0.02, 0.07], [0.05, 0.02, 0.0449]),
        ("box", [-0.01, 0.02, 0.03], [0.0051, 0.02, 0.03]),
    ]:
        assert region(name).push_inside(np.array([outside]))[0] == pytest.approx(inside, abs=1e-6)


def test_a_thin_part_gives_its_deepest_place() -> None:
    """A plate 8 mm thick on a block 40 mm high: with 5 mm clearance points of the plate come to its middle plane."""
    block = box_mesh((4, 4, 4), size=(0.04, 0.04, 0.04))
    plate = box_mesh((6, 4, 1), size=(0.06, 0.04, 0.008))
    apart = plate.nodes + np.array([0.06, 0.0, 0.0])
    both = Mesh(np.vstack([block.nodes, apart]), np.vstack([block.elements, plate.elements + len(block.nodes)]))
    here = Region.of_body(mesh_body(both), 0.005)
    points = np.array([[0.09, 0.02, 0.001], [0.08, 0.015, 0.0065], [0.1, 0.02, 0.0]])
    pushed = here.push_inside(points)
    assert here.depths(pushed) == pytest.approx(0.004, abs=1e-4)
    assert pushed[:, :2] == pytest.approx(points[:, :2], abs=0.008)


@pytest.mark.parametrize("name", ["strip", "box", "starfish", "cupping_hand"])
def test_what_is_seen(name: str, unchecked: None) -> None:
    """Brute force over 401 places of each segment; what is within 0.02 mm of the limit may be either."""
    here, nodes = region(name), body(name).mesh.nodes
    random = np.random.default_rng(2)
    starts, ends = here.push_inside(nodes[random.integers(0, len(nodes), (2, 150))].reshape(300, -1)).reshape(
        2, 150, -1
    )
    shares = np.linspace(0, 1, 401)[:, None]
    least = np.array([here.depths(a + shares * (b - a)).min() for a, b in zip(starts, ends, strict=True)])
    clear = np.abs(least - 0.0025) > 4e-5
    seen = here.sees(starts, ends)
    assert np.array_equal(seen[clear], least[clear] >= 0.0025)
    assert seen.any()
    found = least_along(here.depths, starts, ends, 0.0025, resolution=1e-4)
    low = clear & (least < 0.0025)
    assert found[low] == pytest.approx(least[low], abs=5e-4)


def test_few_places_tell() -> None:
    """A straight way at one depth: two places if it is far from the limit or beyond it, many if it is close."""
    here, asked = region("strip"), []

    def measure(points: np.ndarray) -> np.ndarray:
        asked.append(len(points))
        return here.depths(points)

    for depth, limit, most in ((0.02, 0.0025, 150), (0.02, 0.021, 2), (0.02, 0.0199, 4000)):
        asked.clear()
        way = np.array([[0.03, 0.025 - depth]]), np.array([[0.17, 0.025 - depth]])
        assert least_along(measure, *way, limit) == pytest.approx(depth)
        assert sum(asked) <= most


def test_segments_along_a_wall() -> None:
    """A way 2.4 mm inside the side of a box is seen with 4.7 mm clearance, not with 5 mm."""
    for name, start, end in [
        ("strip", [0.02, 0.0226], [0.18, 0.0226]),
        ("box", [0.02, 0.0024, 0.02], [0.08, 0.0024, 0.02]),
    ]:
        ends = np.array([start]), np.array([end])
        assert region(name, 0.0047).sees(*ends).all()
        assert not region(name, 0.005).sees(*ends).any()


def test_a_short_cut_across_a_corner_is_seen_through() -> None:
    """Both ends of a segment lie well inside an arm of the letter E, its middle outside."""
    here = region("letter_e")
    assert isinstance(here, FlatRegion)
    nodes = body("letter_e").mesh.nodes
    inside = nodes[here.depths(nodes) > 0.005]
    starts, ends = inside[np.triu_indices(len(inside), 1)[0]], inside[np.triu_indices(len(inside), 1)[1]]
    outside = here.depths(0.5 * (starts + ends)) < 0
    assert outside.any()
    assert not here.sees(starts[outside], ends[outside]).any()


@pytest.mark.parametrize("name", ["strip", "box"])
def test_a_route_is_held_if_all_of_it_is(name: str) -> None:
    here = region(name)
    low, high = body(name).mesh.nodes.min(axis=0), body(name).mesh.nodes.max(axis=0)
    route = np.linspace(0.2 * high + 0.8 * low, 0.8 * high + 0.2 * low, 5)
    assert here.holds(route)
    bent = route.copy()
    bent[2, -1] = high[-1] - 0.002
    assert not here.holds(bent)


@pytest.mark.parametrize(("name", "where"), [("strip", "edge"), ("box", "surface")])
def test_too_thin_a_body_is_told(name: str, where: str) -> None:
    with pytest.raises(InputError, match=f"too thin for cables 30 mm inside its {where}; lower the clearance"):
        Region.of_body(body(name), 0.03)
    assert Region.of_body(body(name), 0.02).clearance == 0.02
