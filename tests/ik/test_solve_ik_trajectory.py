"""Poses in time. Oracles: inverse kinematics of each pose, closed forms, the fold of a branch, play."""

from dataclasses import replace

import numpy as np
import pytest
from arches import arch
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.ik import IKOptions, Keyframe, Limits, Trajectory, TrajectoryOptions, solve_ik, solve_ik_trajectory
from hydrostat.ik.trajectory.trajectory import path_deviation
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation, continue_branch

pytestmark = pytest.mark.usefixtures("unchecked")

COARSE = TrajectoryOptions(rate=20)


def strip() -> Robot:
    return strip_robot(columns=10, rows=2)


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return Simulation(strip())


def poses(simulation: Simulation) -> list[PoseTarget]:
    """Poses with contractions that are known."""
    hidden = {"up": [0.03, 0.0], "half": [0.015, 0.0], "down": [0.0, 0.02]}
    return [
        PoseTarget(name=name, targets={"tip": tuple(simulation.solve(np.array(values)).markers["tip"].tolist())})
        for name, values in hidden.items()
    ]


def moved(trajectory: Trajectory) -> float:
    return float(np.ptp(trajectory.contractions, axis=0).max())


@pytest.mark.parametrize("path", ["smooth", "linear", "straight"])
def test_every_keyframe_is_the_pose_that_inverse_kinematics_finds(simulation: Simulation, path: str) -> None:
    wanted = poses(simulation)
    found = solve_ik_trajectory(simulation, wanted, path=path, options=COARSE)
    start = None
    for key, pose in zip(found.keyframes, wanted, strict=True):
        alone = solve_ik(simulation, pose, start=start, options=IKOptions(restarts=0))
        start = alone.pose
        assert key.name == pose.name
        assert key.same
        assert key.rms_error < 2e-6
        assert found.times[key.index] == key.time
        assert np.abs(key.pose.nodes - alone.pose.nodes).max() < 1e-5
        assert (found.poses[key.index].nodes == key.pose.nodes).all()
    assert found.branch_jumps == ()
    assert found.keyframes[-1].time == found.seconds


def test_each_sample_is_an_equilibrium_at_its_contractions(simulation: Simulation) -> None:
    found = solve_ik_trajectory(simulation, poses(simulation)[:1], options=COARSE)
    for contractions, pose in zip(found.contractions, found.poses, strict=True):
        assert (pose.contractions == contractions).all()
        alone = simulation.solve(contractions)
        assert np.abs(alone.nodes - pose.nodes).max() < 1e-7
    assert found.markers["tip"].shape == (len(found.times), 2)
    assert found.tensions[-1] == pytest.approx(found.poses[-1].tensions)


def test_the_samples_keep_to_the_limits_by_winch(simulation: Simulation) -> None:
    limits = {"up": 0.02, "down": 0.05}
    found = solve_ik_trajectory(simulation, poses(simulation), speed=limits, acceleration=0.1, options=COARSE)
    speeds = np.abs(found.speeds).max(axis=0)
    assert speeds[0] <= 0.02 * (1 + 1e-9)
    assert speeds[1] <= 0.05 * (1 + 1e-9)
    assert np.abs(found.accelerations).max() <= 0.1 * (1 + 1e-9)
    steps = np.diff(found.contractions, axis=0) / np.diff(found.times)[:, None]
    assert (np.abs(steps).max(axis=0) <= np.array([0.02, 0.05]) * (1 + 1e-9)).all()


def test_what_needs_no_motion_does_not_move(simulation: Simulation) -> None:
    rest = {"tip": tuple(simulation.rest.markers["tip"].tolist())}
    found = solve_ik_trajectory(simulation, [rest, simulation.rest])
    assert moved(found) == 0.0
    assert (found.poses[-1].nodes == simulation.rest.nodes).all()


def test_the_profile_is_what_a_motion_plays(simulation: Simulation) -> None:
    """Played slowly, the robot ends where the trajectory ends."""
    found = solve_ik_trajectory(simulation, poses(simulation)[:1], speed=0.02, options=COARSE)
    profile = found.profile()
    for time, contractions in zip(found.times, found.contractions, strict=True):
        assert profile.at(float(time)) == pytest.approx(contractions, abs=1e-15)
    *_, last = simulation.play(profile, found.seconds + 1.0, 0.05)
    assert last.markers["tip"] == pytest.approx(found.keyframes[-1].pose.markers["tip"], abs=2e-3)


def test_times_are_kept_or_refused(simulation: Simulation) -> None:
    up, _, down = poses(simulation)
    found = solve_ik_trajectory(simulation, [(2.0, up), (5.0, down)], options=COARSE)
    assert [key.time for key in found.keyframes] == pytest.approx([2.0, 5.0])
    with pytest.raises(InputError, match=r"0\.3 s on the way to up are too short .* it takes about 1\.\d* s"):
        solve_ik_trajectory(simulation, [(0.3, up)], options=COARSE)


def test_a_hold_stays_and_a_loop_comes_back(simulation: Simulation) -> None:
    up, _, down = poses(simulation)
    found = solve_ik_trajectory(simulation, [up, down], hold=0.5, loop=True, options=COARSE)
    stays = (found.times >= found.keyframes[0].time) & (found.times <= found.keyframes[0].time + 0.5)
    assert (found.contractions[stays] == found.contractions[found.keyframes[0].index]).all()
    assert np.ptp(found.times[stays]) == pytest.approx(0.5)
    assert found.keyframes[-1].name == "rest"
    assert not found.contractions[-1].any()
    assert np.abs(found.poses[-1].nodes - simulation.rest.nodes).max() < 1e-7


def test_markers_go_straight(simulation: Simulation) -> None:
    """Two winches can hold the tip of a strip on a line; by contractions along lines it leaves that line."""
    robot = replace(strip(), winches=tuple(replace(winch, release=0.02) for winch in strip().winches))
    free = Simulation(robot)
    tip = free.solve({"up": 0.03, "down": 0.01}).markers["tip"]
    first = solve_ik(free, {"tip": tuple(tip.tolist())}).pose
    target = {"tip": (float(tip[0]), float(tip[1]) - 0.02)}
    straight = solve_ik_trajectory(free, [target], start=first, path="straight", options=COARSE).keyframes[0]
    smooth = solve_ik_trajectory(free, [target], start=first, options=COARSE).keyframes[0]
    assert straight.path_deviation < 2e-5
    assert smooth.path_deviation > 10 * straight.path_deviation
    assert straight.rms_error < 1e-5


def test_stray_is_the_distance_from_the_line() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.5], [2.0, -0.75], [3.0, 0.0]])
    assert path_deviation({"tip": places}) == pytest.approx(0.75)
    assert path_deviation({"tip": places[:1], "nose": places[[0, 3]]}) == 0.0
    assert path_deviation({"tip": places[[0, 1, 0]]}) == pytest.approx(np.hypot(1.0, 0.5))


def test_a_snap_is_told_where_the_branch_folds() -> None:
    """Oracle: the fold of the same branch, followed by arclength."""
    simulation = Simulation(arch())
    goal = np.array([0.25])
    branch = continue_branch(simulation, simulation.rest, goal)
    assert len(branch.folds) == 1
    through = simulation.solve(goal, start=simulation.rest)
    found = solve_ik_trajectory(simulation, [through], path="linear", options=COARSE)
    (snap,) = found.branch_jumps
    fold = branch.folds[0] * goal[0]
    sample = int(np.flatnonzero(found.times == snap.time)[0])
    assert found.contractions[sample - 1, 0] < fold <= found.contractions[sample, 0] + 1e-4
    assert snap.distance > 0.01
    assert "snaps" in " ".join(found.lines())


def test_a_branch_without_folds_does_not_snap() -> None:
    """Half the way to the fold, at so few samples that steps have to be halved."""
    simulation = Simulation(arch())
    branch = continue_branch(simulation, simulation.rest, np.array([0.25]))
    near = simulation.solve(np.array([0.5 * branch.folds[0] * 0.25]))
    options = TrajectoryOptions(rate=1, compare=False)
    found = solve_ik_trajectory(simulation, [near], speed=1.0, acceleration=10.0, options=options)
    assert len(found.times) == 2
    assert found.branch_jumps == ()
    assert found.keyframes[0].same


def test_what_a_search_from_rest_comes_nearer_to_is_taken_on_the_same_branch(simulation: Simulation) -> None:
    """In one step a search from the pose before misses by far; from where the way to the answer from rest ends, not."""
    down = poses(simulation)[2]
    start = simulation.solve({"up": 0.03})
    one = IKOptions(iterations=1, restarts=0)
    alone = solve_ik(simulation, down, start=start, options=one)
    free = solve_ik(simulation, down, options=one)
    assert free.rms_error < 0.5 * alone.rms_error
    options = TrajectoryOptions(rate=20, inverse=one)
    key = solve_ik_trajectory(simulation, [down], start=start, options=options).keyframes[0]
    assert key.rms_error < 0.1 * free.rms_error
    assert key.free_error is None
    assert key.same
    unled = solve_ik_trajectory(simulation, [down], start=start, options=replace(options, compare=False)).keyframes[0]
    assert unled.rms_error == pytest.approx(alone.rms_error, rel=1e-2)


def two_poses() -> tuple[Simulation, Equilibrium, Equilibrium]:
    """The arch up, and snapped through, at the same contractions."""
    simulation = Simulation(arch())
    up = simulation.solve({"down": 0.145})
    through = simulation.solve({"down": 0.145}, start=simulation.solve({"down": 0.25}))
    assert up.markers["top"][1] - through.markers["top"][1] > 0.01
    return simulation, up, through


def test_what_only_another_branch_reaches_is_told() -> None:
    """The winch may not let out so much that the arch snaps back, so from below its top cannot come up."""
    simulation, up, through = two_poses()
    target = {"top": tuple(up.markers["top"].tolist())}
    limits = Limits(contraction={"down": (0.143, 0.3)})
    found = solve_ik_trajectory(simulation, [target], start=through, limits=limits, options=COARSE)
    (key,) = found.keyframes
    assert found.branch_jumps == ()
    assert key.same
    assert key.rms_error > 0.01
    assert key.free_error is not None
    assert key.free_error < 1e-6
    assert "  a search from rest reaches 0.00 mm, on another branch" in found.lines()


def test_a_way_that_leads_to_another_pose_is_told() -> None:
    """At the same contractions the way from rest ends with the arch up."""
    simulation, up, through = two_poses()
    line = "  this path ends in another pose than planned: several poses share these contractions"
    found = solve_ik_trajectory(simulation, [through], options=COARSE)
    assert not found.keyframes[0].same
    assert line in found.lines()
    assert np.abs(found.poses[-1].nodes - up.nodes).max() < 1e-6
    found = solve_ik_trajectory(simulation, [up], options=COARSE)
    assert found.keyframes[0].same
    assert line not in found.lines()


def test_a_limit_on_the_tension_holds_in_keyframes_and_is_told_between(simulation: Simulation) -> None:
    up, _, down = poses(simulation)
    most = 0.5 * float(simulation.solve({"up": 0.03}).tensions.max())
    found = solve_ik_trajectory(simulation, [up, down], limits=Limits(tension=most), options=COARSE)
    for key in found.keyframes:
        assert key.pose.tensions.max() <= most * (1 + 1e-5)
    assert any("at maximum tension" in line for line in found.lines())
    assert not any("more than" in line for line in found.lines())


@pytest.mark.slow
def test_a_tension_above_its_limit_is_told_with_its_place() -> None:
    """Past its fold the arch gives way, so the soft cable pulls hardest just before; at 0.25 m harder than there."""
    simulation = Simulation(arch())
    past, far = simulation.solve({"down": 0.155}), simulation.solve({"down": 0.25})
    limits = Limits(tension=float(past.tensions[0]) * 1.02)
    found = solve_ik_trajectory(simulation, [past], limits=limits, options=COARSE)
    sample = int(np.argmax(found.tensions[:, 0]))
    assert 0 < sample < found.keyframes[0].index
    words = f"cable 1 (down) reaches {found.tensions.max():.3g} N, above its limit of {limits.tension:.3g} N"
    assert f"at {found.times[sample]:.2f} s, on the way to keyframe 1, {words}" in found.lines()
    words = f"cable 1 (down) reaches {far.tensions[0]:.3g} N, above its limit of {limits.tension:.3g} N"
    found = solve_ik_trajectory(simulation, [past, far, past], limits=limits, options=COARSE)
    assert f"at {found.keyframes[1].time:.2f} s, in keyframe 2, {words}" in found.lines()
    found = solve_ik_trajectory(simulation, [past], start=far, limits=limits, options=COARSE)
    assert f"at 0.00 s, at the start, {words}" in found.lines()


@pytest.mark.parametrize("path", ["smooth", "straight"])
def test_peaks_between_samples_are_told(simulation: Simulation, path: str) -> None:
    """Oracle: the limits are used up, and from rest to rest at one sample each second none is at a peak."""
    pose = simulation.solve({"up": 0.03})
    options = TrajectoryOptions(rate=1)
    for speed, what, limit in ((1.0, "acceleration", 100), (0.005, "speed", 5)):
        found = solve_ik_trajectory(simulation, [pose], speed=speed, acceleration=0.1, path=path, options=options)
        (line,) = (line for line in found.lines() if line.startswith(f"largest {what}: "))
        told = line.removeprefix(f"largest {what}: ").split(f" of {limit} mm/s")[0]
        assert float(told) == pytest.approx(limit, rel=2e-3)
    assert (np.abs(found.speeds).max(axis=0) <= found.peak_speeds * (1 + 1e-9)).all()
    assert (np.abs(found.accelerations).max(axis=0) <= found.peak_accelerations * (1 + 1e-9)).all()


@pytest.mark.parametrize("as_start", [False, True])
def test_given_poses_keep_to_the_limits(simulation: Simulation, as_start: bool) -> None:
    """A solved pose is streamed as it is, so what the winches may not do is refused."""
    name = "start" if as_start else "keyframe 1"
    travel = simulation.robot.winch("up").travel
    for hidden, limits, words in (
        ({"up": travel + 0.01}, None, rf'winch "up" is {travel + 0.01:g} m, but its limits are 0 to {travel:g} m'),
        ({"up": 0.03}, Limits(contraction={"up": (0.0, 0.005)}), r'winch "up" is 0\.03 m, .* are 0 to 0\.005 m'),
        ({"up": 0.03, "down": 0.01}, Limits(equal=[["up", "down"]]), r'not equal: "up" 0\.03 m, "down" 0\.01 m'),
    ):
        pose = simulation.solve(hidden)
        start, keyframe = (pose, simulation.rest) if as_start else (None, pose)
        with pytest.raises(InputError, match=f"^{name}: .*{words}"):
            solve_ik_trajectory(simulation, [keyframe], start=start, limits=limits)
    with pytest.raises(InputError, match=r'^rest, where it starts: .*winch "down" is 0 m'):
        solve_ik_trajectory(simulation, [pose], limits=Limits(contraction={"down": (0.005, 0.02)}))
    inside = simulation.solve({"up": travel})
    assert solve_ik_trajectory(simulation, [inside], options=COARSE).contractions.max() == travel


@pytest.mark.parametrize("as_start", [False, True])
def test_given_poses_are_of_this_robot(simulation: Simulation, as_start: bool) -> None:
    finer = Simulation(strip_robot(columns=12, rows=2))
    wider = replace(simulation.rest, contractions=np.zeros(3))
    unmarked = replace(simulation.rest, markers={"nose": simulation.rest.markers["tip"]})
    for pose, words in (
        (finer.rest, r"has finite nodes, \(33, 2\), not \(39, 2\)"),
        (wider, "has 2 finite contractions, not 3"),
        (unmarked, "has the markers tip, not nose"),
    ):
        start, keyframe = (pose, simulation.rest) if as_start else (None, pose)
        with pytest.raises(InputError, match=f"{'start' if as_start else 'keyframe 1'}: a pose of this robot {words}"):
            solve_ik_trajectory(simulation, [keyframe], start=start)


BAD = {
    "at least one keyframe": {"keyframes": []},
    "keyframe 1 has no target": {"keyframes": [{}]},
    "give one to all or to none": {"keyframes": [(1.0, {"tip": (0.1, 0.0)}), {"tip": (0.1, 0.0)}]},
    "must rise from above 0 s, not 0 s": {"keyframes": [(0.0, {"tip": (0.1, 0.0)})]},
    r"the time of keyframe 1 must be a finite number \[s\], not inf": {"keyframes": [(np.inf, {"tip": (0.1, 0.0)})]},
    "the time of keyframe 2 must be .*, not nan": {
        "keyframes": [(1.0, {"tip": (0.1, 0.0)}), (np.nan, {"tip": (0.1, 0.0)})]
    },
    "the time of keyframe 1 must be .*, not 'a'": {"keyframes": [("a", {"tip": (0.1, 0.0)})]},
    r"keyframe 1 must be \(time \[s\], target\) or a target, not \(1\.0,\)": {"keyframes": [(1.0,)]},
    r"keyframe 1 must be \(time \[s\], target\) .*, 3\)": {"keyframes": [(1.0, {"tip": (0.1, 0.0)}, 3)]},
    "keyframe 1 needs a target, .* not 5": {"keyframes": [5]},
    "keyframe 1 needs a target, .* not 'tip'": {"keyframes": ["tip"]},
    "keyframe 1 needs a target, .* not None": {"keyframes": [(1.0, None)]},
    "keyframes must be a list of targets, not {'tip'": {"keyframes": {"tip": (0.1, 0.0)}},
    "keyframes must be a list of targets, not 5": {"keyframes": 5},
    "smooth, linear, straight": {"path": "round"},
    "no limit on the acceleration can hold": {"path": "linear", "acceleration": 0.1},
    "hold must be 0 s or more, not -1": {"hold": -1.0},
    "in place of one on the rate": {"limits": Limits(rate=0.1, interval=1.0)},
    "rate must be from 1": {"options": TrajectoryOptions(rate=0.0)},
    "knots must be 1 or more": {"options": TrajectoryOptions(knots=0)},
    "loop goes back as soon": {"keyframes": [(1.0, {"tip": (0.1, 0.0)})], "loop": True},
    "before the hold of 2 s": {
        "keyframes": [(1.0, {"tip": (0.2, 0.0)}), (2.0, {"tip": (0.2, 0.0)}), (9.0, {"tip": (0.2, 0.0)})],
        "hold": 2.0,
    },
}


@pytest.mark.parametrize("words", BAD)
def test_bad_input(simulation: Simulation, words: str) -> None:
    arguments = {"keyframes": [Keyframe(target={"tip": (0.19, 0.01)})], **BAD[words]}
    with pytest.raises(InputError, match=words):
        solve_ik_trajectory(simulation, **arguments)


def test_a_course_without_end_is_refused_before_memory_is_asked_for() -> None:
    simulation = Simulation(strip_robot())
    target = {"tip": tuple(simulation.solve(np.array([0.01, 0.0])).markers["tip"].tolist())}
    for slow in ({"hold": 1e9}, {"speed": 1e-12}):
        with pytest.raises(InputError, match="samples, more than 100,000"):
            solve_ik_trajectory(simulation, [target, target], **slow)
