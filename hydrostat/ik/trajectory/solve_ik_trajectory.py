"""`solve_ik_trajectory`: one pose after another, within limits on the speed of the winches."""

# Of the thesis (docs/thesis.md): R58, R72, E20

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.objectives.objective import Objective
from hydrostat.ik.search.problem import IKOptions
from hydrostat.ik.trajectory.keys import Found, Key, Keyframe, KeySearch, as_keyframes, check_given
from hydrostat.ik.trajectory.poses import follow
from hydrostat.ik.trajectory.timed_path import ByWinch, MotionLimits, StraightCourse, TimedPath, earliest, linear
from hydrostat.ik.trajectory.trajectory import KeyPose, PathKind, Trajectory, legs_of, path_deviation
from hydrostat.progress import Progress
from hydrostat.simulation import Equilibrium, Simulation


@dataclass(frozen=True, kw_only=True)
class TrajectoryOptions:
    """Options for sampling and accuracy of a trajectory.

    Attributes:
        rate: minimum number of samples per second.
        knots: number of steps of a straight path between keyframes.
        compare: True to search from rest, too, if a keyframe is not reached from the previous one.
        jump: distance of a node from its predicted position, as a share of the body's size, that counts as a
            snap-through if it remains at any step size.
        inverse: options of the search for each keyframe.
    """

    rate: float = 50.0
    knots: int = 12
    compare: bool = True
    jump: float = 2e-3
    inverse: IKOptions = field(default_factory=IKOptions)


def solve_ik_trajectory(
    simulation: Simulation,
    keyframes: Sequence[Key],
    *,
    speed: ByWinch | None = 0.05,
    acceleration: ByWinch | None = None,
    limits: Limits | None = None,
    objectives: Sequence[Objective] = (),
    path: PathKind | str = PathKind.SMOOTH,
    start: Equilibrium | None = None,
    loop: bool = False,
    hold: float = 0.0,
    options: TrajectoryOptions | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """Compute a trajectory from a pose through keyframes, each solved from the previous one, which keeps the branch.

    "smooth": contractions are C2 in time and pass keyframes without a stop where possible. "linear": contractions are
    piecewise linear, as in the thesis; their speed changes instantly. "straight": markers move along straight lines.
    Keyframes without times are reached as soon as the limits allow. With cable friction, each keyframe is solved for a
    straight path from the previous one, and the poses are those of the whole played path.
    docs/theory/trajectories.md.

    Args:
        simulation: simulation of the robot.
        keyframes: targets, or (time [s], target), or `Keyframe`; a solved pose can also be a target.
        speed: maximum speed of each winch [m/s], or by name of winches and drives; drives without a name have 1 rad/s,
            0.05 m/s or a share of 1 per second.
        acceleration: maximum acceleration of each winch [m/s^2], or by name; 0.2 by default, none for a linear path;
            for drives, four times their default speed per second.
        limits: other limits of the winches in keyframes; start and solved poses must keep all of them except the
            tension.
        objectives: objectives in keyframes, in addition to their targets.
        path: quantity that follows a simple path.
        start: start pose, at rest; the rest pose if left out.
        loop: True to return to the start at the end.
        hold: waiting time in each keyframe but the last [s].
        options: options for sampling and the search for keyframes.
        progress: callback for progress.

    Raises:
        InputError: keyframes, limits or options that do not fit, a given pose of another robot or beyond the limits, or
            times that are too short for the limits.
        NotConvergedError: no equilibrium at a point of the path.
    """
    chosen = options or TrajectoryOptions()
    kind = parse_choice(PathKind, path, what="path")
    frames = as_keyframes(keyframes)
    _check(chosen, limits, hold, kind, acceleration, frames, loop)
    hardest = _ACCELERATION if acceleration is None and kind is not PathKind.LINEAR else acceleration
    pace = MotionLimits.of(simulation.robot, speed, hardest)
    given = limits or Limits()
    allowed = bounds(simulation, given)
    begin = start or simulation.rest
    check_given(simulation, allowed, "start" if start else "rest, where it starts", begin)
    for frame in frames:
        if isinstance(frame.target, Equilibrium):
            check_given(simulation, allowed, frame.name or "", frame.target)
    if loop:
        frames.append(Keyframe(target=begin, name="start" if start else "rest"))
    near = chosen.jump * simulation.robot.body.mesh.size
    search = KeySearch(
        simulation=simulation,
        limits=given,
        objectives=tuple(objectives),
        options=chosen.inverse,
        compare=chosen.compare,
        jump=near,
        knots=chosen.knots if kind is PathKind.STRAIGHT else 0,
    )
    found = _find(search, frames, begin, progress)
    course, arrivals = _course(kind, begin, found, pace, hold, 1 / chosen.rate)
    fastest, hardest = course.peaks()
    times, samples = _sample_times(course.times, chosen.rate)
    contractions, speeds, accelerations = course.at(times)
    contractions[samples] = _exact(begin, found, hold)  # as they were found, without rounding
    poses, snaps = follow(simulation, begin, times, contractions, jump=near, progress=progress)
    poses = (*poses[:-1], poses[-1].without_factors())
    return Trajectory(
        path=kind,
        times=times,
        contractions=contractions,
        speeds=speeds,
        accelerations=accelerations,
        peak_speeds=fastest.max(axis=0),
        peak_accelerations=hardest.max(axis=0),
        limits=pace,
        poses=poses,
        keyframes=_keys(found, times, poses, [int(samples[index]) for index in arrivals], near),
        branch_jumps=snaps,
        winches=tuple(winch.name for winch in simulation.robot.winches),
        cables=tuple(cable.winch for cable in simulation.robot.cables),
        tension=allowed.tension,
    )


def _check(
    options: TrajectoryOptions,
    limits: Limits | None,
    hold: float,
    path: PathKind,
    acceleration: ByWinch | None,
    frames: list[Keyframe],
    loop: bool,
) -> None:
    if limits is not None and limits.rate is not None:
        raise InputError("a trajectory has a limit on the speed in place of one on the rate; give it as speed")
    if path is PathKind.LINEAR and acceleration is not None:
        raise InputError(
            "a linear path changes its speed at once, so no limit on the acceleration can hold; "
            "leave it out, or take a smooth path"
        )
    if not (np.isfinite(hold) and hold >= 0):
        raise InputError(f"hold must be 0 s or more, not {hold:g}")
    if loop and frames[0].time is not None:
        raise InputError("loop goes back as soon as the limits allow; with times, give the start as a last keyframe")
    if not 1 <= options.rate <= 10_000:
        raise InputError(f"rate must be from 1 to 10,000 samples in a second, not {options.rate:g}")
    if options.knots < 1 or not options.jump > 0:
        raise InputError(f"knots must be 1 or more and jump above 0, not {options.knots} and {options.jump:g}")


def _find(search: KeySearch, frames: list[Keyframe], begin: Equilibrium, progress: Progress | None) -> list[Found]:
    found: list[Found] = []
    for frame in frames:
        found.append(search.find(frame, found[-1].pose if found else begin))
        if progress is not None:
            progress("solving keyframes", len(found), len(frames))
    return found


def _course(
    path: PathKind, begin: Equilibrium, found: list[Found], pace: MotionLimits, hold: float, least: float
) -> tuple[TimedPath | StraightCourse, list[int]]:
    """Contractions in time, and which of its keys the keyframes are: a hold is one more key."""
    knots, lengths, arrivals, last, clock = [], [], [], begin.controls, 0.0
    for number, one in enumerate(found):
        knots.append(np.array([last, *(pose.controls for pose in one.knots)]))
        time = one.keyframe.time
        lengths.append(np.nan if time is None else time - clock)
        arrivals.append(len(knots))
        last, clock = one.pose.controls, 0.0 if time is None else time
        if hold > 0 and number < len(found) - 1:
            knots.append(np.array([last, last]))
            lengths.append(hold)
            clock += hold
    given = np.array(lengths)
    keys = np.array([begin.controls, *(leg[-1] for leg in knots)])
    if (given <= 0).any():
        raise InputError(f"a keyframe is to be reached before the hold of {hold:g} s in the one before it has ended")
    if path is PathKind.STRAIGHT:
        course = StraightCourse.earliest(knots, given, pace, least=least)
    else:
        course = (linear if path is PathKind.LINEAR else earliest)(keys, given, pace, least=least)
    _check_times(course, pace, [one for one in found if one.keyframe.time is not None], arrivals)
    return course, arrivals


def _check_times(
    course: TimedPath | StraightCourse, pace: MotionLimits, timed: list[Found], arrivals: list[int]
) -> None:
    """Refuse times that are too short."""
    used = pace.share(*course.peaks())
    hair = 1e-9  # limits hold to this share of them
    for one, arrival in zip(timed, arrivals, strict=False):
        share = float(used[arrival - 1])
        if share > 1 + hair:
            length = float(np.diff(course.times)[arrival - 1])
            raise InputError(
                f"{length:.3g} s on the way to {one.keyframe.name} are too short for the limits on speed and "
                f"acceleration; it takes about {share * length:.3g} s"
            )


def _sample_times(times: Vector, rate: float) -> tuple[Vector, np.ndarray]:
    """Even steps in each leg, its ends among them; and where these are."""
    seconds = float(times[-1] - times[0])
    most_samples = 100_000  # a trajectory of more samples is a slip: each is an equilibrium
    if not seconds * rate <= most_samples:
        raise InputError(
            f"the course would take {seconds:.3g} s and {seconds * rate:.3g} samples, more than {most_samples:,}; "
            "allow a larger speed, or hold for less long"
        )
    counts = np.maximum(np.ceil(np.diff(times) * rate - 1e-9).astype(int), 1)
    parts = [
        np.linspace(begin, end, count, endpoint=False)
        for begin, end, count in zip(times[:-1], times[1:], counts, strict=True)
    ]
    return np.concatenate([*parts, times[-1:]]), np.concatenate([[0], np.cumsum(counts)])


def _exact(begin: Equilibrium, found: list[Found], hold: float) -> np.ndarray:
    """Contractions of the keys of a course [m], then values of drives."""
    rows = [begin.controls]
    for number, one in enumerate(found):
        rows += [one.pose.controls] * (2 if hold > 0 and number < len(found) - 1 else 1)
    return np.array(rows)


def _keys(
    found: list[Found], times: Vector, poses: tuple[Equilibrium, ...], samples: list[int], near: float
) -> tuple[KeyPose, ...]:
    keys = []
    for one, leg, sample in zip(found, legs_of([0, *samples]), samples, strict=True):
        target, pose = one.keyframe.pose, poses[sample]
        names = list(target.targets if target else pose.markers)
        places = {name: np.array([step.markers[name] for step in poses[leg]]) for name in names}
        errors = {
            name: float(np.linalg.norm(pose.markers[name] - at))
            for name, at in (target.targets if target else {}).items()
        }
        keys.append(
            KeyPose(
                name=one.keyframe.name or "",
                time=float(times[sample]),
                index=sample,
                target=target,
                found=one.reached.without_factors() if one.reached else None,
                pose=pose,
                errors=errors,
                path_deviation=path_deviation(places),
                free_error=one.free_error,
                same=float(np.linalg.norm(pose.nodes - one.pose.nodes, axis=1).max()) <= near,
            )
        )
    return tuple(keys)


_ACCELERATION = 0.2  # the most that a winch accelerates, unless told otherwise [m/s^2]
