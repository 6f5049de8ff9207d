"""Inverse kinematics. Oracles: hidden contractions, central differences, scipy's optimizers on the same objective."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, gallery_robot, strip_robot
from robustness import example_folders
from scipy.optimize import least_squares, minimize

from hydrostat.errors import InputError
from hydrostat.geometry import find_crossings
from hydrostat.ik import IKOptions, IKResult, IKStatus, solve_ik
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.objectives.marker_target import MarkerTarget
from hydrostat.ik.search.inverse_search import InverseSearch
from hydrostat.ik.search.problem import InverseProblem
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Marker, PoseTarget, Robot, load_robot
from hydrostat.simulation import Simulation

TIGHT = NewtonOptions(tolerance=1e-13)


def two_markers(robot: Robot) -> Robot:
    """A strip with markers at its tip and at the middle of its upper side."""
    return replace(robot, markers=(*robot.markers, Marker(name="top", at=(0.1, 0.025))))


def with_release(robot: Robot, release: float) -> Robot:
    return replace(robot, winches=tuple(replace(winch, release=release) for winch in robot.winches))


def targets(simulation: Simulation, contractions: list[float]) -> dict[str, tuple[float, ...]]:
    pose = simulation.solve(np.array(contractions))
    return {name: tuple(place.tolist()) for name, place in pose.markers.items()}


def marker_search(simulation: Simulation, goals: dict[str, tuple[float, ...]]) -> InverseSearch:
    terms = [MarkerTarget(targets=goals).bind(simulation)]
    return InverseSearch(InverseProblem(simulation, terms, bounds(simulation, Limits()), IKOptions()))


def size(simulation: Simulation) -> float:
    return simulation.robot.body.mesh.size


HIDDEN = {
    "one pulls": (two_markers(strip_robot()), [0.02, 0.0]),
    "the other pulls": (two_markers(strip_robot()), [0.0, 0.015]),
    "both pull": (two_markers(strip_robot()), [0.02, 0.008]),
    "far": (two_markers(strip_robot()), [0.045, 0.0]),
    "sheathed": (two_markers(strip_robot(sheathed=((1, 3),))), [0.015, 0.006]),
    "space": (box_robot(), [0.01, 0.006]),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_hidden_contractions_are_found(name: str) -> None:
    robot, hidden = HIDDEN[name]
    simulation = Simulation(robot)
    reached = solve_ik(simulation, targets(simulation, hidden))
    assert max(reached.errors.values()) < 1e-6 * size(simulation)
    assert np.abs(reached.pose.contractions - hidden).max() < 1e-4 * max(hidden)
    assert reached.status is IKStatus.REACHED


def test_the_regularizer_hides_no_target() -> None:
    """It falls with the error, so that any tolerance can be met."""
    simulation = Simulation(two_markers(strip_robot()))
    options = IKOptions(tolerance=1e-9)
    reached = solve_ik(simulation, targets(simulation, [0.02, 0.008]), options=options)
    assert reached.status is IKStatus.REACHED
    assert max(reached.errors.values()) < 1e-9 * size(simulation)
    assert reached.pose.contractions == pytest.approx([0.02, 0.008], rel=1e-6)


@pytest.mark.parametrize("contractions", [[0.02, 0.008], [0.03, 0.012], [0.005, 0.015]])
def test_the_gradient_of_the_objective(contractions: list[float]) -> None:
    """J^T r against central differences of fully converged solves."""
    simulation = Simulation(two_markers(strip_robot()), options=TIGHT)
    search = marker_search(simulation, {"tip": (0.15, 0.1), "top": (0.1, 0.05)})
    given, step = np.array(contractions), 1e-5
    start = simulation.solve(given)

    def objective(contractions: np.ndarray) -> float:
        return search.problem.objective(search.begin(simulation.solve(contractions, start=start)), 0.0)

    here = search.begin(start)
    gradient = search.problem.jacobian(here).T @ here.residual
    found = [(objective(given + d) - objective(given - d)) / (2 * step) for d in step * np.eye(2)]
    assert gradient == pytest.approx(found, rel=1e-5, abs=1e-7 * np.abs(gradient).max())


OPTIMA = {
    "out of reach": (two_markers(strip_robot()), {"tip": (0.17, 0.09), "top": (0.1, 0.03)}),
    "one marker": (strip_robot(), {"tip": (0.18, 0.06)}),
    "against the bound": (strip_robot(), {"tip": (0.0, 0.15)}),
    "released": (with_release(two_markers(strip_robot()), 0.02), {"tip": (0.16, 0.1), "top": (0.1, 0.06)}),
    "stretched": (with_release(two_markers(strip_robot()), 0.02), {"tip": (0.25, 0.0), "top": (0.12, 0.02)}),
    "space": (box_robot(), {"tip": (0.11, 0.05, 0.03)}),
}


@pytest.mark.parametrize("name", OPTIMA)
def test_scipy_finds_nothing_better(name: str, unchecked: None) -> None:
    """Our objective is at most that of two bounded optimizers of another kind, begun at our answer and elsewhere."""
    robot, goals = OPTIMA[name]
    simulation = Simulation(robot)
    reached = solve_ik(simulation, PoseTarget(name="any", targets=goals))
    ours = sum(error**2 for error in reached.errors.values()) / 2
    low = np.array([-winch.release for winch in robot.winches])
    high = np.array([winch.travel for winch in robot.winches])
    bounds = np.column_stack([low, high])

    def residual(contractions: np.ndarray) -> np.ndarray:
        markers = simulation.solve(contractions, start=reached.pose).markers
        return np.concatenate([markers[name] - goals[name] for name in goals])

    def objective(contractions: np.ndarray) -> float:
        return float(residual(contractions) @ residual(contractions)) / 2

    inner = np.clip(reached.pose.contractions, low + 1e-4, high - 1e-4)
    squares = least_squares(residual, inner, bounds=bounds.T, x_scale=0.01, diff_step=1e-4)
    free = minimize(objective, inner, method="Nelder-Mead", bounds=bounds, options={"maxfev": 60})
    elsewhere = least_squares(residual, np.full(len(inner), 0.01), bounds=bounds.T, x_scale=0.01, diff_step=1e-4)
    assert ours <= min(squares.cost, free.fun, elsewhere.cost) * (1 + 1e-4)
    assert reached.status is IKStatus.LOCAL_OPTIMUM
    assert reached.optimality < 1e-3
    size = robot.body.mesh.size
    for error, words in ((2.1e-4, "reached within 0.3 mm"), (9.5e-6, "reached within 0.01 mm"), (4e-3 * size, None)):
        assert replace(reached, errors={"tip": error}).outcome == (words or "local optimum: target not reached")


def test_optimality_tells_an_optimum_from_a_pose_on_the_way() -> None:
    """The check can fail."""
    simulation = Simulation(strip_robot())
    goals = {"tip": (0.18, 0.06)}
    early = solve_ik(simulation, goals, options=IKOptions(iterations=1, restarts=0))
    assert early.status is IKStatus.ITERATION_LIMIT
    assert early.optimality > 0.1
    assert early.optimality > 100 * solve_ik(simulation, goals).optimality


def kept(simulation: Simulation, reached: IKResult) -> bool:
    winches = simulation.robot.winches
    pairs = zip(reached.pose.contractions, winches, strict=True)
    return all(-winch.release <= value <= winch.travel for value, winch in pairs)


@pytest.mark.parametrize("release", [0.0, 0.01])
def test_contractions_stay_within_travel_and_release(release: float) -> None:
    """Active where the target is out of reach."""
    robot = with_release(strip_robot(), release)
    robot = replace(robot, winches=tuple(replace(winch, travel=0.02) for winch in robot.winches))
    simulation = Simulation(robot)
    reached = solve_ik(simulation, {"tip": (0.05, 0.2)})
    assert kept(simulation, reached)
    assert reached.pose.contractions[0] == 0.02
    assert reached.status is IKStatus.LOCAL_OPTIMUM
    # The lower cable is in the way: it lets out until it is slack or at its end.
    assert reached.pose.tensions[1] < 1e-3 * reached.pose.tensions[0] or reached.pose.contractions[1] == -release


def test_cables_that_all_hang_loose_are_recruited() -> None:
    """E15: there is no sensitivity at rest at all."""
    robot = strip_robot(slack=0.01)
    robot = replace(robot, cables=tuple(replace(cable, slack=0.01) for cable in robot.cables))
    simulation = Simulation(robot)
    assert not simulation.jacobian(simulation.solve(np.zeros(2))).any()
    for hidden in ([0.03, 0.0], [0.0, 0.025]):
        reached = solve_ik(simulation, targets(simulation, hidden))
        assert max(reached.errors.values()) < 1e-6 * size(simulation)


def test_the_antagonist_stays_at_rest() -> None:
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, {"tip": tuple(simulation.solve(np.array([0.02, 0.0])).markers["tip"].tolist())})
    assert reached.pose.contractions[1] == 0.0


def test_a_pose_that_cables_cannot_push_to_ends_at_rest() -> None:
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, {"tip": (0.25, 0.0)})
    assert reached.status is IKStatus.LOCAL_OPTIMUM
    assert reached.pose.contractions == pytest.approx([0.0, 0.0], abs=1e-6)
    assert reached.rms_error == pytest.approx(0.05, rel=1e-3)


def test_at_rest_already() -> None:
    reached = solve_ik(Simulation(strip_robot()), {"tip": (0.2, 0.0)})
    assert (reached.status, reached.iterations, reached.solves) == (IKStatus.REACHED, 0, 0)


@pytest.mark.parametrize("begin", [[0.05, 0.0], [0.0, 0.02], [0.08, -0.01]])
def test_a_start_is_taken_up_within_the_bounds(begin: list[float]) -> None:
    simulation = Simulation(strip_robot())
    start = simulation.solve(np.array(begin))
    goals = targets(simulation, [0.02, 0.0])
    reached = solve_ik(simulation, goals, start=start)
    assert kept(simulation, reached)
    assert reached.rms_error < 1e-6 * size(simulation)
    none = solve_ik(simulation, goals, start=start, options=IKOptions(iterations=0, restarts=0))
    assert none.pose.contractions == pytest.approx(np.clip(begin, 0.0, 0.06))


def test_an_answer_is_no_worse_than_its_start_or_a_plain_descent() -> None:
    """Two cables of one winch differ in slack, so that approaching with least effort ends 25 mm away."""
    robot = gallery_robot("starfish")
    simulation = Simulation(robot)
    top = next(marker for marker in robot.markers if marker.name == "top")
    target = {"top": (top.at[0] - 24.5e-3, top.at[1] - 8.2e-3)}
    start = simulation.solve({"left": 0.02})
    begun = float(np.linalg.norm(start.markers["top"] - np.array(target["top"])))
    assert solve_ik(simulation, target, start=start).errors["top"] < begun < 0.012
    assert solve_ik(simulation, target).errors["top"] < 2.1e-3


def test_a_good_start_saves_solves() -> None:
    simulation = Simulation(strip_robot())
    goals = {"tip": (0.17, 0.08)}
    cold = solve_ik(simulation, goals)
    warm = solve_ik(simulation, goals, start=cold.pose)
    assert warm.rms_error == pytest.approx(cold.rms_error, rel=1e-6)
    assert warm.solves < cold.solves


@pytest.mark.parametrize(("shift", "restarts"), [(0.0029, 0), (0.0031, 3)])
def test_what_is_nearly_reached_is_not_restarted(shift: float, restarts: int) -> None:
    """One marker, moved along the one cable by shares of the size that no contraction makes up. Oracle: the solves."""
    simulation = Simulation(strip_robot())
    tip, far = targets(simulation, [0.0, 0.0])["tip"], shift * size(simulation)
    goals = {"tip": (tip[0] + far, tip[1])}
    default = solve_ik(simulation, goals)
    light = [MarkerTarget(targets=goals, weights={"tip": 0.1})]
    once = solve_ik(simulation, objectives=light, options=IKOptions(restarts=0))
    assert solve_ik(simulation, objectives=light).solves > once.solves
    assert max(default.errors.values()) == pytest.approx(far, rel=1e-3)
    assert default.solves == solve_ik(simulation, goals, options=IKOptions(restarts=restarts, restart_error=0.0)).solves


@pytest.mark.parametrize("folder", example_folders(), ids=lambda folder: folder.name)
@pytest.mark.slow
def test_all_poses_of_all_examples(folder, unchecked: None) -> None:
    """They end at an optimum no worse than rest, at an equilibrium that can be solved for again and crosses nothing.

    Of a body in space the first two poses, with one restart each, and of quadratic elements one: they take seconds.
    """
    robot = load_robot(folder)
    simulation = Simulation(robot)
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    poses, options = list(robot.poses.values()), IKOptions()
    if robot.body.mesh.dim == 3:
        poses, options = poses[:2], IKOptions(restarts=1)
    if robot.body.mesh.quadratic is not None:
        poses, options = poses[:1], IKOptions(restarts=0)
    for pose in poses:
        reached = solve_ik(simulation, pose, options=options)
        rest = np.sqrt(np.mean([np.sum((places[name] - at) ** 2) for name, at in pose.targets.items()]))
        assert reached.status in (IKStatus.REACHED, IKStatus.LOCAL_OPTIMUM)
        # flat valleys: "bend" ends at 1.003e-4; "lean" at 7e-9, or 1.1e-4 with rigid parts a hundred times softer
        steep = 2e-4 if (folder.name, pose.name) in {("spine", "lean"), ("finger", "bend")} else 1e-4
        assert reached.optimality < steep
        assert reached.rms_error <= rest * (1 + 1e-12)
        assert kept(simulation, reached)
        assert not len(find_crossings(robot.body.mesh, reached.pose.nodes))
        again = simulation.solve(reached.pose.controls, start=reached.pose)
        assert np.abs(again.nodes - reached.pose.nodes).max() < 1e-8 * size(simulation)
        assert np.abs(again.tensions - reached.pose.tensions).max(initial=0.0) < 1e-6 * again.tensions.max(initial=1.0)


def test_an_unknown_marker_and_a_robot_without_cables() -> None:
    robot = strip_robot()
    with pytest.raises(InputError, match=r'unknown marker "nose"\. Available: tip'):
        solve_ik(Simulation(robot), {"nose": (0.2, 0.0)})
    with pytest.raises(InputError, match="no cables to pull"):
        solve_ik(Simulation(replace(robot, winches=(), cables=())), {"tip": (0.2, 0.0)})
    with pytest.raises(InputError, match="nothing to reach"):
        solve_ik(Simulation(robot))


@pytest.mark.slow
def test_targets_far_out_of_reach_take_few_steps() -> None:
    """Where much is left over Gauss-Newton alone creeps; the curvature of the residual is learned."""
    simulation = Simulation(load_robot(next(folder for folder in example_folders() if folder.name == "starfish")))
    draw = np.random.default_rng(0)
    for _ in range(4):
        goals = {m.name: tuple((np.array(m.at) + draw.normal(0, 0.05, 2)).tolist()) for m in simulation.robot.markers}
        reached = solve_ik(simulation, goals, options=IKOptions(restarts=0))
        assert reached.status is IKStatus.LOCAL_OPTIMUM
        assert reached.optimality < 1e-4
        assert reached.iterations < 40


def test_a_start_of_another_material_is_relaxed_first(unchecked: None) -> None:
    """It rests there, but not here: a pose of twice the modulus under a weight."""
    robot = replace(two_markers(strip_robot()), gravity=(0.0, -9.81))
    stiffer = replace(robot, body=replace(robot.body, material=replace(robot.body.material, young=60e3)))
    start = Simulation(stiffer).solve(np.array([0.02, 0.0]))
    simulation = Simulation(robot)
    goals = {name: tuple(place.tolist()) for name, place in start.markers.items()}
    reached = solve_ik(simulation, goals, start=start)
    force = np.abs(simulation.assembly.gradient(reached.pose.nodes, reached.pose.contractions)).max()
    assert force <= simulation.solver.force_tolerance(reached.pose.nodes, reached.pose.contractions)
    with pytest.raises(InputError, match="pose of this robot"):
        solve_ik(simulation, goals, start=Simulation(strip_robot(columns=8)).solve(np.zeros(2)))
    with pytest.raises(InputError, match="a result's"):
        solve_ik(simulation, goals, start=reached)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "wrong",
    [{"restarts": -1}, {"iterations": 1.5}, {"largest_step": 0}, {"largest_step": float("nan")}, {"effort": -1.0},
     {"tolerance": "1e-3"}, {"tolerance": float("nan")}],
    ids=str,
)  # fmt: skip
def test_wrong_options_are_told_in_one_line(wrong: dict, unchecked: None) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        IKOptions(**wrong)


def test_every_answer_rests_within_its_limits() -> None:
    """Residual, stability and bounds of answers that are reached, not reached, and stopped early."""
    simulation = Simulation(two_markers(strip_robot(slack=0.003)))
    draw = np.random.default_rng(1)
    for steps in (0, 1, 2, 3, 100):
        goals = {"tip": tuple(draw.uniform(0.05, 0.2, 2).tolist())}
        reached = solve_ik(simulation, goals, options=IKOptions(iterations=steps, restarts=0))
        force = np.abs(simulation.assembly.gradient(reached.pose.nodes, reached.pose.contractions)).max()
        assert force <= simulation.solver.force_tolerance(reached.pose.nodes, reached.pose.contractions)
        assert simulation.assembly.stiffness(reached.pose.nodes, reached.pose.contractions).definite
        assert kept(simulation, reached)
