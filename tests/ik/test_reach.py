"""What markers can be brought to. Oracles: areas within solved boundaries, closed forms, solves one by one."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, strip_robot

import hydrostat as hs
from hydrostat.ik import find_workspaces
from hydrostat.ik.workspace import _covered_volume, usable_spans, workspace_extent

TRAVEL = 0.02  # of the strip's winches [m]


def strip(friction: float = 0.0) -> hs.Simulation:
    """A strip with a cable on either side, each with 20 mm of travel."""
    robot = strip_robot(columns=12, rows=3)
    winches = [replace(winch, travel=TRAVEL) for winch in robot.winches]
    return hs.Simulation(robot.with_network(winches, [replace(cable, friction=friction) for cable in robot.cables]))


def boundary(simulation: hs.Simulation, count: int = 40) -> np.ndarray:
    """Where the tip is along the border of all contractions [m]."""
    up, none = np.linspace(0.0, TRAVEL, count), np.zeros(count)
    sides = [(up, none), (none + TRAVEL, up), (up[::-1], none + TRAVEL), (none, up[::-1])]
    taken = np.concatenate([np.column_stack(side) for side in sides])
    return simulation.solve_batch(taken, jacobians=False).markers[:, 0]


@pytest.mark.slow
def test_the_area_is_that_within_the_border_of_all_contractions() -> None:
    """Oracle: the shoelace formula over solved places of the border, which two winches map one to one."""
    simulation = strip()
    (tip,) = find_workspaces(simulation, count=100)
    x, y = (border := boundary(simulation)).T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    assert tip.size == pytest.approx(area, rel=0.05)
    assert tip.extents == pytest.approx(np.sort(np.ptp(border, axis=0))[::-1], rel=0.05)
    assert abs(tip.directions[0, 1]) > 0.99, "it bends up and down"
    assert str(tip).startswith(f"{1e4 * tip.size:.2g} cm², ")


def test_one_winch_reaches_a_line() -> None:
    """Oracle: the way of the tip, solved step by step."""
    simulation = strip()
    robot = simulation.robot.with_network(simulation.robot.winches[:1], simulation.robot.cables[:1])
    simulation = hs.Simulation(robot)
    (tip,) = find_workspaces(simulation, count=16)
    way = np.array([simulation.solve(np.array([pull])).markers["tip"] for pull in np.linspace(0, TRAVEL, 21)])
    assert tip.size == pytest.approx(0.0, abs=1e-12)
    assert tip.extents[0] == pytest.approx(np.linalg.norm(way[-1] - way[0]), rel=0.05)


def test_what_pulls_too_hard_is_left_out() -> None:
    """Oracle: each place is that of a pose which keeps the limit, solved by itself."""
    simulation = strip()
    (free,) = find_workspaces(simulation, count=25)
    limit = 0.5 * simulation.solve(np.array([TRAVEL, 0.0])).tensions.max()
    (held,) = find_workspaces(simulation, count=25, tension=limit)
    middles = TRAVEL * (np.arange(5) + 0.5) / 5
    poses = [simulation.solve(np.array([one, other])) for one in middles for other in middles]
    kept = np.array([pose.markers["tip"] for pose in poses if pose.tensions.max() <= limit])
    assert 0 < len(kept) < 25
    assert held.places == pytest.approx(kept, abs=1e-9)
    assert 0 < held.size < free.size


@pytest.mark.slow
def test_cables_that_rub_reach_as_if_smooth_where_friction_is_next_to_none() -> None:
    """Oracle: the cables without friction."""
    (smooth,), (next_to_smooth,) = (find_workspaces(strip(friction), count=9) for friction in (0.0, 1e-12))
    assert next_to_smooth.size == pytest.approx(smooth.size, rel=1e-3)
    assert next_to_smooth.places == pytest.approx(smooth.places, abs=1e-6)


def test_two_winches_fill_no_volume() -> None:
    reaches = find_workspaces(hs.Simulation(box_robot()), count=9, tension=20.0)
    assert {reach.size for reach in reaches} <= {0.0} or max(reach.size for reach in reaches) < 1e-9
    assert all((reach.extents[:-1] >= reach.extents[1:]).all() for reach in reaches)


def test_a_volume_counts_what_overlaps_once() -> None:
    """Oracle: two cubes of 1 that share a half: 1.5. Twenty thousand points measure that to 1 % (three deviations)."""
    cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    flat = cube * [1.0, 1.0, 0.0]
    moved = cube + np.array([0.5, 0.0, 0.0])
    assert _covered_volume(np.array([cube, moved, flat])) == pytest.approx(1.5, rel=0.01)


def test_nothing_to_bring_is_told() -> None:
    robot = strip().robot
    with pytest.raises(hs.InputError, match="at least one of each"):
        find_workspaces(hs.Simulation(replace(robot, markers=())))
    with pytest.raises(hs.InputError, match="count must be at least 1"):
        find_workspaces(strip(), count=0)


def test_the_length_of_an_image() -> None:
    """Oracle: an ellipse of known half-axes; a line counts as the floor across; nothing counts as the floor."""
    moves = np.array([[3.0, 0.0], [0.0, 0.5]])
    assert workspace_extent(moves, np.array([0.1, 0.2]), dim=2, floor=1e-9) == pytest.approx(np.sqrt(0.3 * 0.1))
    assert workspace_extent(moves[:, :1], np.array([0.1]), dim=2, floor=1e-3) == pytest.approx(
        np.sqrt(0.3 * 1e-3), rel=1e-4
    )
    assert workspace_extent(np.zeros((2, 0)), np.zeros(0), dim=2, floor=1e-3) == 1e-3
    twice = workspace_extent(np.vstack([moves, 4 * moves]), np.array([0.1, 0.2]), dim=2, floor=1e-9)
    assert twice == pytest.approx(2 * np.sqrt(0.3 * 0.1)), "the geometric mean of two markers"


def test_a_winch_goes_no_farther_than_its_hardest_cable_lets_it() -> None:
    spans = usable_spans(np.array([[100.0, 0.0], [-400.0, 10.0]]), np.array([0.1, 0.2]), 20.0)
    assert spans == pytest.approx([0.05, 0.2])
