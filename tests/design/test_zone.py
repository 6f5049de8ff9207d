"""Zones. Oracles: closed form, brute force over points of the rim, finite differences."""

from typing import Any

import numpy as np
import pytest
from shapely import Point, Polygon

from hydrostat.design.zone import Zone, ZoneUnion
from hydrostat.errors import InputError

L_SHAPE = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.02), (0.02, 0.02), (0.02, 0.05), (0.0, 0.05))
ZONES = {
    "disc": Zone(at=(0.01, -0.02), radius=0.03),
    "ball": Zone(at=(0.01, -0.02, 0.03), radius=0.03),
    "rectangle": Zone(box=((-0.01, -0.02), (0.05, 0.01))),
    "box": Zone(box=((-0.01, -0.02, 0.0), (0.05, 0.01, 0.02))),
    "polygon": Zone(outline=L_SHAPE),
    "polygon the other way round": Zone(outline=L_SHAPE[::-1]),
}


def places(zone: Zone, count: int = 400) -> np.ndarray:
    return np.random.default_rng(0).uniform(-0.08, 0.1, (count, zone.dim))


@pytest.mark.parametrize("name", ["disc", "ball"])
def test_a_ball_by_hand(name: str) -> None:
    zone, points = ZONES[name], places(ZONES[name])
    assert zone.at is not None
    expected = np.sqrt(((points - zone.at) ** 2).sum(axis=1)) - 0.03
    assert zone.distances(points) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("name", ["rectangle", "box"])
def test_a_box_by_hand(name: str) -> None:
    """Outside, the way to the clipped point; inside, the least of the ways to the sides."""
    zone = ZONES[name]
    assert zone.box is not None
    low, high = np.array(zone.box)
    for point, found in zip(places(zone), zone.distances(places(zone)), strict=True):
        out = float(np.linalg.norm(point - np.clip(point, low, high)))
        assert found == pytest.approx(out if out > 0 else -min((point - low).min(), (high - point).min()), abs=1e-15)


@pytest.mark.parametrize("name", ["polygon", "polygon the other way round"])
def test_a_polygon_as_shapely_has_it(name: str) -> None:
    zone, shape = ZONES[name], Polygon(L_SHAPE)
    points = np.vstack([places(zone), [[0.01, 0.01], [0.02, 0.01], [0.01, 0.02], [0.03, 0.02]]])
    for point, found in zip(points, zone.distances(points), strict=True):
        away = shape.exterior.distance(Point(point))
        assert found == pytest.approx(-away if shape.contains(Point(point)) else away, abs=1e-12)


@pytest.mark.parametrize("name", ZONES)
def test_away_is_the_gradient(name: str) -> None:
    """Finite differences; where the halves of one disagree, the point is on the skeleton, where there is none."""
    zone, points, step = ZONES[name], places(ZONES[name]), 1e-7
    slopes = []
    for sign in (1, -1):
        ahead = [zone.distances(points + sign * step * axis) - zone.distances(points) for axis in np.eye(zone.dim)]
        slopes.append(sign * np.array(ahead).T / step)
    smooth = np.abs(slopes[0] - slopes[1]).max(axis=1) < 1e-3
    assert smooth.mean() > 0.98
    assert zone.away(points)[smooth] == pytest.approx(slopes[0][smooth], abs=1e-4)
    assert np.linalg.norm(zone.away(points), axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ZONES)
def test_on_the_rim_and_in_the_middle_there_is_a_direction_too(name: str) -> None:
    zone = ZONES[name]
    points = places(zone, 50)
    rim = points - zone.distances(points)[:, None] * zone.away(points)
    middle = np.array([zone.at or np.mean(zone.box or zone.outline, axis=0)])
    found = zone.away(np.vstack([rim, middle]))
    assert np.linalg.norm(found, axis=1) == pytest.approx(1.0)
    outside = zone.distances(points) > 1e-3
    sharp = np.einsum("pd,pd->p", found[:-1], zone.away(points)) > 0
    assert sharp[outside].all()


@pytest.mark.parametrize("name", ZONES)
def test_the_least_along_segments(name: str) -> None:
    """Brute force over 2001 places of each segment."""
    zone = ZONES[name]
    starts, ends = places(zone, 400).reshape(2, 200, zone.dim)
    shares = np.linspace(0, 1, 2001)[:, None]
    brute = np.array(
        [zone.distances(start + shares * (end - start)).min() for start, end in zip(starts, ends, strict=True)]
    )
    for limit in (0.0, 0.01):
        found = zone.least(starts, ends, limit=limit)
        below = brute < limit
        assert below.any()
        assert not below.all()
        assert (found[~below] >= limit - 2e-5).all()
        assert found[below] == pytest.approx(brute[below], abs=1.5e-4)


BAD: dict[str, tuple[dict[str, Any], str]] = {
    "nothing": ({}, "one of these only"),
    "two forms": ({"at": (0.0, 0.0), "radius": 1.0, "box": ((0.0, 0.0), (1.0, 1.0))}, "one of these only"),
    "no radius": ({"at": (0.0, 0.0)}, "needs both"),
    "no middle": ({"radius": 1.0}, "needs both"),
    "radius 0": ({"at": (0.0, 0.0), "radius": 0.0}, "above 0"),
    "endless radius": ({"at": (0.0, 0.0), "radius": np.inf}, "finite"),
    "middle not finite": ({"at": (0.0, np.nan), "radius": 1.0}, "finite coordinates"),
    "text": ({"at": ("5 mm", 0.0), "radius": 1.0}, "finite coordinates"),
    "one coordinate": ({"at": (0.0,), "radius": 1.0}, "two or three"),
    "corners the wrong way round": ({"box": ((0.0, 1.0), (1.0, 0.0))}, "y of the first corner"),
    "flat box": ({"box": ((0.0, 0.0), (0.0, 1.0))}, "x of the first corner"),
    "box of two dimensions": ({"box": ((0.0, 0.0), (1.0, 1.0, 1.0))}, "equally many"),
    "no box": ({"box": 5.0}, "two corners"),
    "two corners": ({"outline": ((0.0, 0.0), (1.0, 0.0))}, "at least 3"),
    "bow tie": ({"outline": ((0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0))}, "cross itself"),
    "no area": ({"outline": ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0))}, "cross itself"),
    "a corner twice": ({"outline": ((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0))}, "same as the corner before"),
    "polygon in space": ({"outline": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))}, "in the plane"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_zone_is_told_in_one_line(case: str, unchecked: None) -> None:
    values, words = BAD[case]
    with pytest.raises(InputError, match=words) as error:
        Zone(**values)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("others", [(), (Zone(at=(0.05, 0.05), radius=0.02),)])
def test_a_union_measures_the_nearest_zone(others: tuple[Zone, ...]) -> None:
    """Oracle: each zone by itself."""
    corners = ((0.0, 0.0), (0.04, 0.0), (0.05, 0.03), (0.0, 0.02))
    zones = (Zone(outline=corners), Zone(outline=tuple((x + 0.1, 0.01 - y) for x, y in corners)), *others)
    points = np.random.default_rng(1).uniform(-0.05, 0.2, (200, 2))
    distances, ways = ZoneUnion(zones).measure(points)
    alone = np.array([zone.distances(points) for zone in zones])
    np.testing.assert_array_equal(distances, alone.min(axis=0))
    nearest = np.array([zone.away(points) for zone in zones])[alone.argmin(axis=0), np.arange(len(points))]
    np.testing.assert_array_equal(ways, nearest)
