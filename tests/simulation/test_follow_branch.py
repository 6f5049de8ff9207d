"""Branches of equilibria. Oracles: load steps from both sides, dense eigenvalues, work of the winches, the mirror."""

from dataclasses import replace

import numpy as np
import pytest
from arches import arch
from builders import gallery_robot, strip_robot
from test_buckling import column, hessian, mirrored, saddle  # pyright: ignore[reportMissingImports]

from hydrostat.errors import InputError
from hydrostat.simulation import Branch, Equilibrium, Simulation, continue_branch
from hydrostat.simulation.branches.branch import BranchStatus, CriticalKind
from hydrostat.simulation.branches.continue_branch import BranchOptions

GOAL = 0.3
BETWEEN = 0.145
"""Contraction [m] at which the arch can rest up or down."""


def stepped(simulation: Simulation, first: float, last: float) -> Equilibrium:
    """The pose after small load steps between contractions of the arch [m]."""
    pose = simulation.solve({"down": first})
    for contraction in np.linspace(first, last, 61)[1:]:
        pose = simulation.solve({"down": float(contraction)}, start=pose)
    return pose


def least(simulation: Simulation, pose: Equilibrium) -> float:
    """Least eigenvalue of the dense Hessian [N/m]."""
    return float(np.linalg.eigvalsh(hessian(simulation, pose.nodes, pose.contractions))[0])


def through(simulation: Simulation, **options: float) -> Branch:
    """The branch of the arch from rest to full travel."""
    rest = simulation.solve({})
    return continue_branch(simulation, rest, {"down": GOAL}, around_folds=True, options=BranchOptions(**options))


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return Simulation(arch())


@pytest.fixture(scope="module")
def branch(simulation: Simulation) -> Branch:
    return through(simulation)


def test_load_steps_from_both_sides_end_on_the_same_branch(simulation: Simulation) -> None:
    """Up and down lie at one contraction; each is what the branch gives that is followed from its side."""
    rest, full = simulation.solve({}), simulation.solve({"down": GOAL})
    up, down = stepped(simulation, 0.0, BETWEEN), stepped(simulation, GOAL, BETWEEN)
    assert np.linalg.norm(up.markers["top"] - down.markers["top"]) > 0.01
    for start, pose in ((rest, up), (full, down)):
        found = continue_branch(simulation, start, {"down": BETWEEN})
        assert found.reaches_goal
        assert found.critical == ()
        assert np.abs(found.end.nodes - pose.nodes).max() < 1e-8
        assert found.end.energy == pytest.approx(pose.energy, rel=1e-9)


def test_every_point_is_an_equilibrium_and_its_stability_that_of_the_dense_hessian(
    simulation: Simulation, branch: Branch
) -> None:
    critical = {point.index for point in branch.critical}
    assert branch.status is BranchStatus.ARRIVED
    assert branch.end.contractions == pytest.approx([GOAL])
    for index, point in enumerate(branch.points):
        forces = simulation.assembly.gradient(point.pose.nodes, point.pose.contractions)
        assert np.abs(forces).max() <= point.pose.result.allowed
        if index not in critical:
            assert point.stable == (least(simulation, point.pose) > 0)
    assert [stable for _, stable in branch.runs()] == [True, False, True]


def test_folds_are_where_the_hessian_is_singular_and_where_the_arch_snaps(
    simulation: Simulation, branch: Branch
) -> None:
    """Found three ways: by arclength; by the dense eigenvalue there; by where load steps leave the branch."""
    assert [point.kind for point in branch.critical] == [CriticalKind.FOLD, CriticalKind.FOLD]
    stiff = least(simulation, branch.points[0].pose)
    for point in branch.critical:
        assert abs(least(simulation, branch.points[point.index].pose)) < 1e-5 * stiff
    first, second = (point.share * GOAL for point in branch.critical)
    assert [first, second] == pytest.approx([0.1508, 0.1390], abs=5e-5)  # as docs/theory/multistability.md says
    for fold, begin, sign in ((first, branch.points[0].pose, -1), (second, branch.end, 1)):
        near = continue_branch(simulation, begin, {"down": fold + sign * 1e-5}).end
        low, high = fold + sign * 1e-5, fold - sign * 1e-5
        while abs(high - low) > 1e-7:
            middle = 0.5 * (low + high)
            pose = simulation.solve({"down": middle}, start=near)
            moved = np.linalg.norm(pose.markers["top"] - near.markers["top"])
            low, high = (middle, high) if moved < 3e-3 else (low, middle)
        assert low == pytest.approx(fold, abs=3e-7)


def test_definiteness_is_lost_at_the_fold(simulation: Simulation, branch: Branch) -> None:
    """Oracle: the root of the least dense eigenvalue, a smooth function of how high the top is, also at a fold."""
    fine = through(simulation, largest_step=0.005)
    assert fine.folds == pytest.approx(branch.folds, abs=1e-9)
    for point in fine.critical:
        around = [fine.points[point.index + offset].pose for offset in (-2, -1, 1, 2)]
        values = [least(simulation, pose) for pose in around]
        assert values[0] * values[-1] < 0
        heights = [float(pose.markers["top"][1]) for pose in around]
        root = np.polyval(np.polyfit(values, heights, 3), 0.0)
        assert fine.points[point.index].pose.markers["top"][1] == pytest.approx(root, abs=1e-7)


def test_the_winch_does_the_work_that_the_energy_gains(simulation: Simulation, branch: Branch) -> None:
    """DE/da is the tension, on unstable parts too: by the trapezoid rule; it would see 1 % more tension."""
    for part, _ in branch.runs():
        points = branch.points[part]
        energies = np.array([point.pose.energy for point in points])
        taken = np.array([point.pose.contractions[0] for point in points])
        tensions = np.array([point.pose.tensions.sum() for point in points])
        steps = np.diff(taken) * 0.5 * (tensions[1:] + tensions[:-1])
        assert np.abs(np.diff(energies) - steps).sum() < 3e-3 * np.abs(steps).sum()
        assert np.abs(np.diff(energies) - 1.01 * steps).sum() > 3e-3 * np.abs(steps).sum()


def test_the_tension_is_the_derivative_of_the_energy(simulation: Simulation, branch: Branch) -> None:
    """Oracle: central differences of converged solves; their error falls with the distance to the folds."""
    folds = [branch.points[point.index].pose.contractions[0] for point in branch.critical]
    checked = 0
    for point in branch.points[2:-1:3]:
        taken, step = float(point.pose.contractions[0]), 1e-5
        if not point.stable or min(abs(taken - fold) for fold in folds) < 5e-3:
            continue
        more, less = (simulation.solve({"down": taken + d}, start=point.pose).energy for d in (step, -step))
        assert (more - less) / (2 * step) == pytest.approx(point.pose.tensions.sum(), rel=1e-6)
        checked += 1
    assert checked >= 5


def test_the_way_back_is_the_way_there(simulation: Simulation, branch: Branch) -> None:
    back = continue_branch(simulation, branch.end, {}, around_folds=True)
    assert back.reaches_goal
    assert [1 - share for share in back.folds[::-1]] == pytest.approx(branch.folds, abs=1e-8)
    assert np.abs(back.end.nodes - branch.points[0].pose.nodes).max() < 1e-9
    assert [stable for _, stable in back.runs()] == [True, False, True]


def test_it_stops_at_a_fold_and_says_where(simulation: Simulation, branch: Branch) -> None:
    found = continue_branch(simulation, simulation.solve({}), {"down": GOAL})
    assert found.status is BranchStatus.FOLD
    assert found.points[-1].share == found.folds[0] == pytest.approx(branch.folds[0], abs=1e-9)
    assert all(point.stable for point in found.points[:-1])
    assert found.lines()[0].startswith("fold: the robot snaps through at 50.")
    assert found.lines()[1].startswith("fold at 50.")


def test_a_goal_between_the_folds_is_reached_on_the_branch_first_met(simulation: Simulation) -> None:
    """A long step may lead around the fold beyond the goal; the branch still ends before it."""
    fold = 0.15078
    found = continue_branch(simulation, simulation.solve({}), {"down": fold - 1e-5}, around_folds=True)
    assert found.reaches_goal
    assert found.critical == ()
    assert all(point.stable for point in found.points)


def test_a_fold_in_the_last_step_is_found(simulation: Simulation, branch: Branch) -> None:
    """From just behind a fold one step leads through it, and past the stable pose at the contractions of the start."""
    fold = branch.critical[0]
    start = branch.points[fold.index + 1].pose
    assert not start.result.stable
    back = continue_branch(simulation, start, {"down": GOAL}, around_folds=True)
    assert back.status is BranchStatus.BACK
    assert len(back.points) == 3
    assert [point.kind for point in back.critical] == [CriticalKind.FOLD]
    assert back.points[1].pose.contractions == pytest.approx([fold.share * GOAL], abs=1e-9)
    stable = continue_branch(simulation, branch.points[0].pose, start.contractions)
    assert stable.reaches_goal
    assert np.abs(back.end.nodes - stable.end.nodes).max() < 1e-8
    assert np.abs(back.end.nodes - start.nodes).max() > 1e-6
    assert continue_branch(simulation, start, {"down": GOAL}).status is BranchStatus.FOLD


def test_a_bifurcation_in_the_last_step_is_found() -> None:
    """The way ends a thousandth behind the load at which the straight column is no longer stable."""
    simulation = Simulation(column(4))
    rest = simulation.solve({})
    load = continue_branch(simulation, rest, np.full(2, 0.014)).points[-1].share * 0.014
    found = continue_branch(simulation, rest, np.full(2, 1.001 * load), around_folds=True)
    assert found.reaches_goal
    assert [point.kind for point in found.critical] == [CriticalKind.BIFURCATION]
    assert found.critical[0].index == len(found.points) - 2
    assert found.critical[0].share == pytest.approx(1 / 1.001, abs=1e-8)
    assert continue_branch(simulation, rest, np.full(2, 1.001 * load)).status is BranchStatus.BIFURCATION


@pytest.mark.parametrize("name", ["first_step", "largest_step", "smallest_step", "steps", "distance", "iterations"])
def test_options_that_lead_nowhere_are_refused(name: str) -> None:
    for value in (0, -1):
        with pytest.raises(InputError, match=f"^{name} must be finite and above 0, not {value}; .* is usual$"):
            BranchOptions(**{name: value})
    for turn in (1.0, -1.5, np.nan):
        with pytest.raises(InputError, match=r"^turn must be a cosine"):
            BranchOptions(turn=turn)


def test_without_its_guard_it_jumps(simulation: Simulation, branch: Branch) -> None:
    """The guard is needed: long steps taken on trust miss the folds, or lose the branch."""
    rough = through(simulation, first_step=0.5, largest_step=0.5, distance=1e3, turn=-1.0)
    assert rough.folds != pytest.approx(branch.folds, abs=1e-6)


def test_a_beam_has_no_fold() -> None:
    simulation = Simulation(strip_robot())
    goal = np.array([0.03, 0.0])
    found = continue_branch(simulation, simulation.solve({}), goal, around_folds=True)
    assert found.reaches_goal
    assert found.critical == ()
    assert all(point.stable for point in found.points)
    assert np.abs(found.end.nodes - simulation.solve(goal).nodes).max() < 1e-9
    assert np.all(np.diff([point.share for point in found.points]) > 0)


@pytest.mark.slow
def test_a_column_splits_where_its_straight_shape_becomes_a_saddle() -> None:
    """Oracle: least dense eigenvalue of the straight column, whose root is found by its secant."""
    simulation = Simulation(column(4))
    goal = np.full(2, 0.014)
    found = continue_branch(simulation, simulation.solve({}), goal, around_folds=True)
    assert found.reaches_goal
    assert [point.kind for point in found.critical] == [CriticalKind.BIFURCATION]
    load = found.critical[0].share * 0.014
    beside = np.array([load - 1e-6, load + 1e-6])
    signs = [np.linalg.eigvalsh(hessian(simulation, saddle(simulation, float(at)), np.full(2, at)))[0] for at in beside]
    assert signs[0] > 0 > signs[1]
    assert np.interp(0.0, signs[::-1], beside[::-1]) == pytest.approx(load, abs=5e-9)
    assert not found.points[-1].stable
    assert np.abs(mirrored(simulation.robot, found.end.nodes) - found.end.nodes).max() < 1e-6
    assert np.abs(saddle(simulation, 0.014) - found.end.nodes).max() < 1e-6
    stopped = continue_branch(simulation, simulation.solve({}), goal)
    assert stopped.status is BranchStatus.BIFURCATION
    assert stopped.points[-1].share == pytest.approx(found.critical[0].share, abs=1e-9)


def test_buckled_poses_end_in_a_fold_of_their_own() -> None:
    """On the way back a bent column stays bent far below the load at which it left the straight shape, then snaps."""
    simulation = Simulation(column(4))
    both = np.full(2, 0.014)
    load = continue_branch(simulation, simulation.solve({}), both).points[-1].share * 0.014
    back = continue_branch(simulation, simulation.solve(both), {})
    assert back.status is BranchStatus.FOLD
    fold = float(back.end.contractions[0])
    assert [load, fold] == pytest.approx([10.86e-3, 7.06e-3], abs=5e-6)  # as docs/theory/multistability.md says
    assert abs(least(simulation, back.end)) < 1e-5 * least(simulation, back.points[0].pose)
    bent = [
        np.abs(mirrored(simulation.robot, pose.nodes) - pose.nodes).max()
        for pose in (
            simulation.solve(np.full(2, fold + offset), start=back.points[-3].pose) for offset in (1e-5, -1e-5)
        )
    ]
    assert bent[0] > 0.05
    assert bent[1] < 1e-6


def test_what_cannot_be_followed_is_refused(simulation: Simulation) -> None:
    rest = simulation.solve({})
    with pytest.raises(InputError, match="must be an equilibrium"):
        continue_branch(simulation, replace(rest, contractions=np.array([0.1])), {"down": 0.2})
    with pytest.raises(InputError, match="must be a pose of this robot"):
        continue_branch(simulation, replace(rest, nodes=rest.nodes[1:]), {"down": 0.2})
    robot = strip_robot(columns=8, rows=2)
    rubbing = Simulation(replace(robot, cables=tuple(replace(cable, friction=0.2) for cable in robot.cables)))
    with pytest.raises(InputError, match="with friction"):
        continue_branch(rubbing, rubbing.solve({}), {"down": 0.01})


def test_a_way_of_no_length_is_a_point(simulation: Simulation) -> None:
    rest = simulation.solve({})
    found = continue_branch(simulation, rest, {})
    assert found.reaches_goal
    assert len(found.points) == 1
    assert found.runs() == []


@pytest.mark.usefixtures("unchecked")
@pytest.mark.slow
def test_small_snaps_of_one_limb_are_not_passed_over() -> None:
    """The starfish snaps by 1.6 mm of 280. A looser limit on the mean displacement saw it on the way there only."""
    simulation = Simulation(gallery_robot("starfish"))
    rest, full = simulation.solve({}), np.array([winch.travel for winch in simulation.robot.winches])
    there = continue_branch(simulation, rest, full, around_folds=True)
    back = continue_branch(simulation, there.end, {}, around_folds=True)
    assert len(there.folds) == 2
    assert [1 - share for share in back.folds[::-1]] == pytest.approx(there.folds, abs=1e-8)
    assert np.abs(back.end.nodes - rest.nodes).max() < 1e-9
