"""Contractions in time. Oracles: closed forms, finite differences, a fine sampling."""

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.ik.trajectory.timed_path import MotionLimits, StraightCourse, TimedPath, earliest, linear

FREE = np.nan


def pace(speed: float = 0.05, acceleration: float = 0.2) -> MotionLimits:
    return MotionLimits.of(strip_robot(columns=4, rows=2), speed, acceleration)


def random_keys(seed: int, count: int = 6) -> np.ndarray:
    """Keys of two winches [m]: some pass, some turn around, and one winch rests for a leg."""
    keys = np.random.default_rng(seed).uniform(0, 0.05, (count, 2))
    keys[2, 1] = keys[1, 1]
    if seed % 2:
        keys[:, 0] = np.sort(keys[:, 0])
    return keys


def fine(course: TimedPath | StraightCourse, leg: int | None = None) -> np.ndarray:
    ends = (0.0, course.seconds) if leg is None else (course.times[leg], course.times[leg + 1] - 1e-12)
    return np.linspace(*ends, 20_001)


@pytest.mark.parametrize("seed", range(6))
def test_derivatives_by_central_differences(seed: int) -> None:
    course = earliest(random_keys(seed), np.full(5, FREE), pace(), least=0.02)
    times, step = np.linspace(0.01, course.seconds - 0.01, 500), 1e-5
    before, after = course.at(times - step), course.at(times + step)
    _, speeds, accelerations = course.at(times)
    assert (after[0] - before[0]) / (2 * step) == pytest.approx(speeds, abs=1e-9)
    # The third derivative jumps at keys, so a difference across one is a mean of both sides: of the order of the step.
    assert (after[1] - before[1]) / (2 * step) == pytest.approx(accelerations, abs=2e-5)


@pytest.mark.parametrize("seed", range(6))
def test_the_course_is_c2_and_at_rest_at_its_ends(seed: int) -> None:
    course = earliest(random_keys(seed), np.full(5, FREE), pace(), least=0.02)
    hair = 1e-9
    for left, right in zip(course.at(course.times[1:-1] - hair), course.at(course.times[1:-1] + hair), strict=True):
        assert left == pytest.approx(right, abs=1e-7)
    values, speeds, accelerations = course.at(course.times[[0, -1]])
    assert values == pytest.approx(random_keys(seed)[[0, -1]], abs=1e-15)
    assert np.abs(speeds).max() < 1e-12
    assert np.abs(accelerations).max() < 1e-10


def test_a_linear_course_is_not_c2() -> None:
    """The check before can fail."""
    keys = random_keys(0)
    course = linear(keys, np.full(5, FREE), pace(), least=0.02)
    hair = 1e-9
    assert np.abs(course.at(course.times[1:-1] - hair)[1] - course.at(course.times[1:-1] + hair)[1]).max() > 0.01


@pytest.mark.parametrize("seed", range(8))
def test_limits_hold_and_one_of_them_is_used_up(seed: int) -> None:
    allowed = pace(*((0.05, 0.2) if seed < 4 else (0.2, 0.1)))
    course = earliest(random_keys(seed), np.full(5, FREE), allowed, least=0.02)
    _, speeds, accelerations = course.at(fine(course))
    fastest, hardest = np.abs(speeds).max() / allowed.speed[0], np.abs(accelerations).max() / allowed.acceleration[0]
    assert max(fastest, hardest) <= 1 + 1e-9
    assert max(fastest, hardest) > 0.999


@pytest.mark.parametrize("seed", range(4))
def test_peaks_are_those_of_a_fine_sampling(seed: int) -> None:
    for course in (
        earliest(random_keys(seed), np.full(5, FREE), pace(), least=0.02),
        linear(random_keys(seed), np.full(5, FREE), pace(), least=0.02),
    ):
        speed, acceleration = course.peaks()
        for leg in range(5):
            _, speeds, accelerations = course.at(fine(course, leg))
            assert np.abs(speeds).max(axis=0) == pytest.approx(speed[leg], rel=1e-6)
            assert np.abs(accelerations).max(axis=0) == pytest.approx(acceleration[leg], rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_no_winch_goes_beyond_its_keys(seed: int) -> None:
    keys = random_keys(seed)
    course = earliest(keys, np.full(5, FREE), pace(), least=0.02)
    for leg in range(5):
        values = course.at(fine(course, leg))[0]
        low, high = np.minimum(keys[leg], keys[leg + 1]), np.maximum(keys[leg], keys[leg + 1])
        assert (values >= low - 1e-14).all()
        assert (values <= high + 1e-14).all()


@pytest.mark.parametrize(("speed", "acceleration"), [(0.05, 0.2), (0.01, 10.0), (10.0, 0.01)])
def test_one_move_takes_the_least_time_of_its_polynomial(speed: float, acceleration: float) -> None:
    """T = max(15/8 D / v, sqrt(10 / sqrt(3) D / a))."""
    way = 0.03
    course = earliest(np.array([[0.0, 0.01], [way, 0.0]]), np.array([FREE]), pace(speed, acceleration), least=0.02)
    assert course.seconds == pytest.approx(max(15 / 8 * way / speed, np.sqrt(10 / np.sqrt(3) * way / acceleration)))


def test_one_move_is_the_polynomial_of_least_jerk() -> None:
    course = earliest(np.array([[0.0, 0.01], [0.03, 0.0]]), np.array([FREE]), pace(), least=0.02)
    u = np.linspace(0, 1, 11)
    assert course.at(u * course.seconds)[0][:, 0] == pytest.approx(0.03 * (10 * u**3 - 15 * u**4 + 6 * u**5), abs=1e-15)


@pytest.mark.parametrize("seed", range(6))
def test_passing_takes_no_longer_than_a_stop_at_each_key(seed: int) -> None:
    keys, allowed = random_keys(seed), pace()
    course = earliest(keys, np.full(5, FREE), allowed, least=0.02)
    assert course.seconds <= allowed.rest_to_rest(keys).sum() * (1 + 1e-12)


def test_passing_saves_time_where_a_winch_goes_on() -> None:
    keys = np.array([[0.0, 0.0], [0.02, 0.01], [0.04, 0.02], [0.06, 0.03]])
    allowed = pace()
    assert earliest(keys, np.full(3, FREE), allowed, least=0.02).seconds < 0.75 * allowed.rest_to_rest(keys).sum()


def test_a_linear_course_is_the_thesis_one() -> None:
    """R58, R72: numpy's linear interpolation, as fast as the fastest winch may go."""
    keys = np.array([[0.0, 0.0], [0.02, 0.01], [0.01, 0.04]])
    course = linear(keys, np.full(2, FREE), pace(), least=0.02)
    assert course.times == pytest.approx([0.0, 0.4, 1.0])
    times = fine(course)
    values, speeds, accelerations = course.at(times)
    for winch in range(2):
        assert values[:, winch] == pytest.approx(np.interp(times, course.times, keys[:, winch]), abs=1e-15)
    assert np.abs(speeds).max() == pytest.approx(0.05)
    assert np.abs(accelerations).max() < 1e-9


def test_without_a_way_nothing_moves() -> None:
    course = earliest(np.full((3, 2), 0.01), np.full(2, FREE), pace(), least=0.02)
    values, speeds, accelerations = course.at(fine(course))
    assert (values == 0.01).all()
    assert not speeds.any()
    assert not accelerations.any()
    assert course.seconds == pytest.approx(0.04)


@pytest.mark.parametrize("seed", range(4))
def test_a_straight_course_passes_its_knots_within_the_limits(seed: int) -> None:
    random, allowed = np.random.default_rng(seed), pace()
    knots = [np.cumsum(random.uniform(-0.001, 0.004, (9, 2)), axis=0) for _ in range(2)]
    knots[1] += knots[0][-1] - knots[1][0]
    course = StraightCourse.earliest(knots, np.full(2, FREE), allowed, least=0.02)
    values, speeds, accelerations = course.at(fine(course))
    used = max(np.abs(speeds).max() / 0.05, np.abs(accelerations).max() / 0.2)
    assert 0.995 < used <= 1
    for knot in np.concatenate(knots):
        assert np.linalg.norm(values - knot, axis=1).min() < 2e-5
    assert np.gradient(values[:, 0], fine(course)) == pytest.approx(speeds[:, 0], abs=1e-4)
    assert np.gradient(speeds[:, 1], fine(course)) == pytest.approx(accelerations[:, 1], abs=5e-3)
    ends = course.at(course.times)
    assert np.abs(ends[1]).max() < 1e-12
    assert np.abs(ends[2]).max() < 1e-9


def test_limits_by_winch_and_wrong_ones() -> None:
    robot = strip_robot(columns=4, rows=2)
    found = MotionLimits.of(robot, {"down": 0.02}, None)
    assert found.speed.tolist() == [np.inf, 0.02]
    assert np.isinf(found.acceleration).all()
    with pytest.raises(InputError, match=r"a limit on the speed must be a number above 0 m/s, not 0"):
        MotionLimits.of(robot, 0.0, None)
    with pytest.raises(InputError, match="tail"):
        MotionLimits.of(robot, None, {"tail": 1.0})
