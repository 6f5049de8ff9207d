"""Motion in time: closed forms, conservation, orders of convergence, and the statics that it settles to."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import exp, pi, sin

import numpy as np
import pytest
from builders import FOAM, box_mesh, box_robot, mesh_body, strip_mesh, strip_robot

import hydrostat as hs
from hydrostat.mechanics import SCHEMES
from hydrostat.robot import Body, Material, Pin, PronyTerm, Robot, Volume

GRAVITY = 9.80665
LOOSE = 1e-13
"""Stiffness of a pin that lets its body go [N/m]."""

pytestmark = pytest.mark.usefixtures("unchecked")


def with_material(robot: Robot, **changes: object) -> Robot:
    return replace(robot, body=replace(robot.body, material=replace(robot.body.material, **changes)))


def held(body: Body, pins: tuple[Pin, ...], gravity: tuple[float, ...] | None = None) -> hs.Simulation:
    return hs.Simulation(Robot(name="body", body=body, pins=pins, poses={}, gravity=gravity))


def free(dim: int, gravity: tuple[float, ...] | None = None) -> hs.Simulation:
    """A body that nothing holds."""
    mesh = strip_mesh(6, 2) if dim == 2 else box_mesh((3, 1, 1))
    return held(mesh_body(mesh), (Pin(box=((-1.0,) * dim, (1.0,) * dim), stiffness=LOOSE),), gravity)


def steps(
    simulation: hs.Simulation, motion: hs.Motion, count: int, dt: float, scheme: str = "sdirk2", drag: float = 0.0
) -> Iterator[hs.Motion]:
    """The motion while the winches stand still."""
    options = hs.StepOptions(scheme=scheme, drag=drag)
    for _ in range(count):
        motion = simulation.step(motion, motion.contractions, dt, options=options)
        yield motion


@pytest.fixture(scope="module")
def viscous_strip() -> hs.Simulation:
    """Cable-driven, viscous, under gravity."""
    robot = replace(strip_robot(columns=8, rows=2), gravity=(0.0, -GRAVITY))
    return hs.Simulation(with_material(robot, viscosity=50.0, relaxation=(PronyTerm(modulus=1e4, time=0.05),)))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_free_fall(dim: int, scheme: str) -> None:
    """Oracle: closed form, g t^2 / 2; of implicit Euler g t (t + dt) / 2."""
    down = np.array([0.0, -GRAVITY, 0.0][:dim])
    simulation = free(dim, tuple(down))
    start = simulation.motion_at_rest()
    *_, end = steps(simulation, start, 10, 0.01, scheme)
    late = 0.01 if scheme == "euler" else 0.0
    fallen = 0.5 * down * end.time * (end.time + late)
    assert end.time == pytest.approx(0.1)
    assert end.nodes - start.nodes == pytest.approx(np.tile(fallen, (len(start.nodes), 1)), abs=1e-10)
    assert end.velocities == pytest.approx(np.tile(down * end.time, (len(start.nodes), 1)), abs=1e-9)


def test_fall_with_drag_converges_at_second_order() -> None:
    """Oracle: closed form of the fall, g/a (t - (1 - exp(-a t)) / a)."""
    simulation, drag, time = free(2, (0.0, -GRAVITY)), 5.0, 0.4
    expected = -GRAVITY / drag * (time - (1 - exp(-drag * time)) / drag)
    errors = []
    for count in (4, 8, 16):
        start = simulation.motion_at_rest()
        *_, end = steps(simulation, start, count, time / count, drag=drag)
        errors.append(abs(float((end.nodes - start.nodes)[:, 1].mean()) - expected))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.2)


def test_a_pendulum_swings_with_its_period() -> None:
    """Oracle: 2 pi sqrt(I / (m g d)) of a rigid body, its masses being those of the nodes."""
    body = mesh_body(strip_mesh(8, 2), material=Material(young=1e8, poisson=0.3, density=1000))
    pins = (Pin(at=(0.0, 0.0), stiffness=1e7), Pin(box=((-1.0, -1.0), (1.0, 1.0)), stiffness=LOOSE))
    simulation = held(body, pins, (GRAVITY, 0.0))
    masses, arms = simulation.dynamics.masses, body.mesh.nodes
    inertia, moment = masses @ (arms**2).sum(axis=1), masses @ arms[:, 0]
    expected = 2 * pi * np.sqrt(inertia / (moment * GRAVITY))
    spin = 0.05 * np.stack([-arms[:, 1], arms[:, 0]], axis=1)
    times, heights = [0.0], [0.0]
    for motion in steps(simulation, simulation.motion_at_rest(velocities=spin), int(2.2 * expected / 4e-3), 4e-3):
        times.append(motion.time)
        heights.append(float(masses @ motion.nodes[:, 1]))
    rising = [
        t - h * (u - t) / (k - h)
        for (t, u), (h, k) in zip(pairwise(times), pairwise(heights), strict=True)
        if h < 0 <= k
    ]
    assert len(rising) == 2
    assert rising[0] == pytest.approx(expected, rel=3e-3)
    assert rising[1] - rising[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("scheme", ["euler", "sdirk2"])
@pytest.mark.slow
def test_convergence_with_the_time_step(viscous_strip: hs.Simulation, scheme: str) -> None:
    """Oracle: a far finer solution by the method of third order. Cables, gravity and viscosity at once."""
    profile = hs.ContractionProfile.ramp(np.array([0.01, 0.0]), 0.15)
    start = viscous_strip.motion_at_rest(viscous_strip.solve({}))

    def end(dt: float, scheme: str) -> hs.Motion:
        *_, motion = viscous_strip.play(profile, 0.1, dt, start=start, options=hs.StepOptions(scheme=scheme))
        return motion

    fine = end(4e-4, "sdirk3")
    coarse, half = end(2.5e-3, scheme), end(1.25e-3, scheme)
    for name in ("nodes", "velocities", "tensions"):
        errors = [np.abs(getattr(motion, name) - getattr(fine, name)).max() for motion in (coarse, half)]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(SCHEMES[scheme].order, abs=0.25)


def momenta(simulation: hs.Simulation, motion: hs.Motion) -> tuple[np.ndarray, np.ndarray]:
    """Linear and angular momentum."""
    masses = simulation.dynamics.masses
    linear = masses @ motion.velocities
    if motion.nodes.shape[1] == 2:
        return linear, np.atleast_1d(masses @ np.cross(_space(motion.nodes), _space(motion.velocities))[:, 2])
    return linear, masses @ np.cross(motion.nodes, motion.velocities)


def _space(array: np.ndarray) -> np.ndarray:
    return np.pad(array, ((0, 0), (0, 1)))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("viscosity", [0.0, 20.0])
def test_a_free_body_keeps_its_momentum(dim: int, viscosity: float) -> None:
    """Oracle: conservation. Linear: to rounding. Angular: lost at the order of the scheme (spinning, vibrating)."""
    simulation = free(dim)
    simulation = hs.Simulation(with_material(simulation.robot, viscosity=viscosity))
    rest = simulation.robot.body.mesh.nodes
    arms = rest - rest.mean(axis=0)
    velocities = np.full(rest.shape, 0.3)
    velocities[:, :2] += 4.0 * np.stack([-arms[:, 1], arms[:, 0]], axis=1)
    velocities[:, 0] += 3.0 * arms[:, 0]
    start = simulation.motion_at_rest(velocities=velocities)
    linear, angular = momenta(simulation, start)
    for scheme, order in (("euler", 1), ("sdirk2", 2)):
        losses = []
        for count in (25, 50, 100):
            *_, end = steps(simulation, start, count, 0.1 / count, scheme)
            after, turning = momenta(simulation, end)
            assert np.abs(after - linear).max() < 1e-10 * np.abs(linear).max()
            losses.append(np.abs(turning - angular).max() / np.abs(angular).max())
        assert np.log2(losses[-2] / losses[-1]) > order - 0.3
        assert losses[-1] < (0.1 if order == 1 else 1e-2)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_energy_falls_all_the_time(viscous_strip: hs.Simulation, scheme: str) -> None:
    """Oracle: second law, for a viscous body that is let go, with its winches still."""
    start = viscous_strip.motion_at_rest()
    energies = [start.energy, *(motion.energy for motion in steps(viscous_strip, start, 40, 5e-3, scheme))]
    assert (np.diff(energies) < 0).all()
    assert energies[-1] < energies[0] - 1e-4


def patched() -> Robot:
    """A strip whose volume is measured in patches."""
    robot = strip_robot(columns=8, rows=2)
    return replace(robot, body=replace(robot.body, volume=Volume.PATCH))


@pytest.mark.parametrize("make", [lambda: strip_robot(columns=8, rows=2), box_robot, patched])
def test_it_settles_to_the_statics_at_any_step(make: object) -> None:
    """Oracle: `solve`, for places and tensions, and two time steps beside each other."""
    robot = make()
    robot = replace(robot, gravity=(0.0, -GRAVITY, 0.0)[: robot.body.mesh.dim])
    robot = with_material(robot, viscosity=300.0, relaxation=(PronyTerm(modulus=1e4, time=0.02),))
    simulation = hs.Simulation(robot)
    goal = np.array([0.012, 0.0])
    pose = simulation.solve(goal)
    for dt in (0.02, 0.033):
        *_, end = simulation.play(hs.ContractionProfile.ramp(goal, 0.2), 2.0, dt)
        assert end.nodes == pytest.approx(pose.nodes, abs=1e-6 * robot.body.mesh.size)
        assert end.tensions == pytest.approx(pose.tensions, rel=1e-6)
        assert end.potential == pytest.approx(pose.energy, rel=1e-8)
        assert np.abs(end.velocities).max() < 1e-6


def test_a_body_at_rest_stays_at_rest(viscous_strip: hs.Simulation) -> None:
    """Oracle: the equilibrium itself."""
    pose = viscous_strip.solve({"up": 0.01})
    *_, end = steps(viscous_strip, viscous_strip.motion_at_rest(pose), 5, 0.01)
    assert end.nodes == pytest.approx(pose.nodes, abs=1e-10)
    assert end.tensions == pytest.approx(pose.tensions, abs=1e-7)


SIDE, THICKNESS = 0.01, 0.03
MU = FOAM.lame[0]


def sheared(**changes: object) -> hs.Simulation:
    """A square cell whose lower and upper side are held by a pin each, so that they shear it."""
    body = mesh_body(strip_mesh(1, 1, size=(SIDE, SIDE)), thickness=THICKNESS, material=replace(FOAM, **changes))
    edges = (-SIDE / 2, SIDE / 2)
    return held(body, tuple(Pin(box=((-1.0, y - 1e-4), (1.0, y + 1e-4)), stiffness=1e8) for y in edges))


def shear(simulation: hs.Simulation, motion: hs.Motion, strain: float, dt: float) -> hs.Motion:
    return simulation.step(motion, np.zeros(0), dt, pin_shifts={1: np.array([strain * SIDE, 0.0])})


def stress(simulation: hs.Simulation, motion: hs.Motion) -> float:
    """Shear stress by the force of the upper pin, less what accelerates its nodes."""
    pins = simulation.assembly.energies[1]
    upper = motion.nodes[:, 1] > 0
    pull = 0.5e8 * (motion.pin_shifts[1, 0] - (motion.nodes - simulation.robot.body.mesh.nodes)[upper, 0]).sum()
    inert = simulation.dynamics.masses[upper] @ motion.accelerations[upper, 0]
    assert pins.stencils.shape == (4, 3)
    return float((pull - inert) / (SIDE * THICKNESS))


def test_a_sudden_shear_relaxes_as_a_zener_solid() -> None:
    """Oracle: closed form at small strain, after an even ramp; second order in the step."""
    modulus, time, strain, ramp = 2e4, 0.1, 1e-3, 0.05
    simulation = sheared(relaxation=(PronyTerm(modulus=modulus, time=time),))
    carried = modulus * time / ramp * (1 - exp(-ramp / time))
    worst = []
    for count in (2, 4, 8):
        motion, errors = simulation.motion_at_rest(), []
        for step in range(1, 4 * count + 1):
            motion = shear(simulation, motion, strain * min(step / count, 1.0), ramp / count)
            if step > count:
                expected = strain * (MU + carried * exp(-(motion.time - ramp) / time))
                errors.append(stress(simulation, motion) / expected - 1)
        worst.append(np.abs(errors).max())
    assert np.log2(worst[0] / worst[-1]) / 2 == pytest.approx(2.0, abs=0.2)
    assert worst[-1] < 1e-4


def test_an_even_shear_feels_the_viscosity() -> None:
    """Oracle: closed form of Kelvin and Voigt, mu strain + eta rate, at small strain."""
    viscosity, rate = 400.0, 0.02
    simulation = sheared(viscosity=viscosity)
    motion = simulation.motion_at_rest()
    for step in range(1, 21):
        motion = shear(simulation, motion, rate * 5e-3 * step, 5e-3)
        if step > 3:
            assert stress(simulation, motion) == pytest.approx(MU * rate * motion.time + viscosity * rate, rel=1e-3)


@pytest.mark.slow
def test_a_cycle_has_a_loop_unless_it_is_slow_or_fast() -> None:
    """Oracle: closed form of the area, pi strain^2 G'', G'' = mu_1 w tau / (1 + w^2 tau^2), at small strain."""
    modulus, time, strain, count = 2e4, 0.1, 1e-3, 40
    simulation = sheared(relaxation=(PronyTerm(modulus=modulus, time=time),))
    areas = []
    for pace in (0.03, 1.0, 30.0):
        period = 2 * pi * time / pace
        motion, path = simulation.motion_at_rest(), []
        for step in range(1, 3 * count + 1):
            strained = strain * sin(2 * pi * step / count)
            motion = shear(simulation, motion, strained, period / count)
            if step >= 2 * count:
                path.append((strained, stress(simulation, motion)))
        strains, stresses = np.array(path).T
        areas.append(float((0.5 * (stresses[1:] + stresses[:-1]) * np.diff(strains)).sum()))
        expected = pi * strain**2 * modulus * pace / (1 + pace**2)
        assert areas[-1] == pytest.approx(expected, rel=0.02)
    assert min(areas) > 0
    assert max(areas[0], areas[2]) < 0.1 * areas[1]


def test_a_hanging_body_creeps_as_a_zener_solid() -> None:
    """Oracle: closed form at small strain, u(t) / u(end) = 1 - mu_1 / (mu + mu_1) exp(-t mu / ((mu + mu_1) tau)).

    Without lateral contraction branch and body are the same operator, so this holds for any shape.
    """
    young, modulus, time = 30e3, 2e4, 10.0
    material = Material(young=young, poisson=0.0, density=5, relaxation=(PronyTerm(modulus=modulus, time=time),))
    body = mesh_body(strip_mesh(4, 2), material=material)
    simulation = held(body, (Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=1e8),), (0.1, 0.0))
    mu = young / 2
    rest, settled = simulation.motion_at_rest(), simulation.solve({})
    tip = np.argmax(rest.nodes[:, 0])
    whole = settled.nodes[tip, 0] - rest.nodes[tip, 0]
    assert whole > 1e-8
    for motion in steps(simulation, rest, 60, 0.5):
        if motion.time > 2:
            share = (motion.nodes[tip, 0] - rest.nodes[tip, 0]) / whole
            expected = 1 - modulus / (mu + modulus) * exp(-motion.time * mu / ((mu + modulus) * time))
            assert share == pytest.approx(expected, rel=2e-3)


def test_pins_carry_the_body_along(viscous_strip: hs.Simulation) -> None:
    """Oracle: the equilibrium, moved as a whole; pins that are not named stay where they are."""
    pose = viscous_strip.solve({})
    motion, shift = viscous_strip.motion_at_rest(pose), np.array([0.03, -0.02])
    for step in range(1, 6):
        motion = viscous_strip.step(motion, {}, 0.02, pin_shifts={0: shift * step / 5})
    *_, end = steps(viscous_strip, motion, 80, 0.05)
    assert end.pin_shifts == pytest.approx(shift[None])
    assert end.nodes == pytest.approx(pose.nodes + shift, abs=2e-7)


def test_a_step_that_fails_is_cut_in_two(viscous_strip: hs.Simulation) -> None:
    """Oracle: shorter steps, asked for by hand."""
    start = viscous_strip.motion_at_rest()
    whole = viscous_strip.step(start, {"up": 0.02}, 0.04)
    assert whole.result.iterations > 6  # in two stages
    hasty = hs.Simulation(viscous_strip.robot, options=hs.NewtonOptions(iterations=3))
    with pytest.raises(hs.NotConvergedError, match="iteration limit"):
        hasty.step(start, {"up": 0.02}, 0.04, options=hs.StepOptions(halvings=0))
    cut = hasty.step(start, {"up": 0.02}, 0.04)
    assert cut.time == pytest.approx(0.04)
    by_hand = []
    for parts in (2, 4, 8):
        motion = start
        for part in range(1, parts + 1):
            motion = viscous_strip.step(motion, {"up": 0.02 * part / parts}, 0.04 / parts)
        by_hand.append(np.abs(cut.nodes - motion.nodes).max())
    assert min(by_hand) < 1e-9 < np.abs(cut.nodes - whole.nodes).max()
    stuck = hs.Simulation(viscous_strip.robot, options=hs.NewtonOptions(iterations=0))
    with pytest.raises(hs.NotConvergedError, match=r"no step found at 0 s, not even one of 0\.0013 s: iteration limit"):
        stuck.step(start, {"up": 0.02}, 0.04)


def test_a_step_depends_on_the_motion_alone(viscous_strip: hs.Simulation) -> None:
    """Oracle: the same step again, after others; bit by bit."""
    first = viscous_strip.step(viscous_strip.motion_at_rest(), {"up": 0.005}, 0.01)
    viscous_strip.step(first, {"up": 0.01}, 0.02)
    again = viscous_strip.step(viscous_strip.motion_at_rest(), {"up": 0.005}, 0.01)
    assert (first.nodes == again.nodes).all()


def test_what_cannot_be_is_refused(viscous_strip: hs.Simulation) -> None:
    still = viscous_strip.motion_at_rest()
    for dt in (0.0, -1.0, np.nan):
        with pytest.raises(hs.InputError, match="time step must be above 0"):
            viscous_strip.step(still, {}, dt)
    with pytest.raises(hs.InputError, match="duration and time step"):
        list(viscous_strip.play(hs.ContractionProfile.ramp(np.zeros(2), 1.0), 1.0, 0.0))
    with pytest.raises(hs.InputError, match="unknown pin 3"):
        viscous_strip.step(still, {}, 0.01, pin_shifts={3: np.zeros(2)})
    with pytest.raises(hs.InputError, match="shift of pin 0"):
        viscous_strip.step(still, {}, 0.01, pin_shifts={0: np.zeros(3)})
    with pytest.raises(hs.InputError, match="euler, sdirk2, sdirk3"):
        hs.StepOptions(scheme="leapfrog")
    with pytest.raises(hs.InputError, match="drag"):
        hs.StepOptions(drag=-1.0)
