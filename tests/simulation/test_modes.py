"""Modes and linear state spaces. Oracles: beam theory, dense eigenvalues, the motion in time, exact Jacobians."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, mesh_body, strip_mesh, strip_robot
from scipy.linalg import expm

from hydrostat.errors import HydrostatWarning, InputError
from hydrostat.robot import Material, Pin, PronyTerm, Robot
from hydrostat.simulation import Simulation, find_modes, linearize

VISCOUS = replace(FOAM, viscosity=40.0, relaxation=(PronyTerm(modulus=4e3, time=0.03),))


def cantilever(material: Material) -> Robot:
    """A slender bar of quadratic elements, clamped at its left end."""
    mesh = strip_mesh(40, 2, size=(0.2, 0.008))
    body = mesh_body(mesh, thickness=0.01, material=replace(material, poisson=0.0))
    pins = (Pin(box=((-1e-4, -1.0), (1e-4, 1.0)), stiffness=1e9),)
    return Robot(name="bar", body=body.with_elements("quadratic"), pins=pins, poses={})


def viscous_strip() -> Simulation:
    robot = strip_robot(columns=8, rows=2)
    return Simulation(replace(robot, body=replace(robot.body, material=VISCOUS)))


def test_a_bar_vibrates_as_euler_and_bernoulli_say() -> None:
    """Oracle: roots of cos(b) cosh(b) = -1 for a clamped bar; a damping ratio is half the loss factor."""
    robot = cantilever(replace(FOAM, poisson=0.0, loss_factor=0.1).with_damping(5.0))
    modes = find_modes(Simulation(robot), count=3)
    roots = np.array([1.8751, 4.6941, 7.8548])
    material = robot.body.material
    told = (roots / 0.2) ** 2 * np.sqrt(material.young * 0.008**2 / (12 * material.density)) / (2 * np.pi)
    assert modes.frequencies == pytest.approx(told, rel=0.02)
    assert modes.damping == pytest.approx(0.5 * 0.1 * modes.frequencies / 5.0, rel=0.02)
    energy = (modes.shapes**2).sum(axis=2) @ Simulation(robot).body.masses
    assert energy == pytest.approx(np.ones(3))


def test_gains_are_jacobians_and_poles_those_of_the_whole_model() -> None:
    """Oracle: `marker_jacobian`; and eigenvalues of all unknowns, dense, for the slowest mode."""
    simulation = viscous_strip()
    pose = simulation.solve(np.full(simulation.robot.num_controls, 0.004))
    space = linearize(simulation, pose, modes=4)
    count = len(space.outputs)
    assert space.gain == pytest.approx(simulation.marker_jacobian(pose).reshape(count, -1), rel=1e-6, abs=1e-9)
    assert space.inputs == tuple(winch.name for winch in simulation.robot.winches)
    full = linearize(simulation, pose, modes=pose.nodes.size - 3)
    slowest = [one.poles.real.max() for one in (space, full)]
    assert slowest[0] == pytest.approx(slowest[1], rel=0.05)
    assert space.settling_time == pytest.approx(np.log(50) / -slowest[0])


def test_a_small_step_moves_as_in_time() -> None:
    """Oracle: the nonlinear motion under a small step of a winch, with viscosity and a Maxwell branch."""
    simulation = viscous_strip()
    pose = simulation.solve(np.full(simulation.robot.num_controls, 0.004))
    space, step, dt = linearize(simulation, pose, modes=20), np.zeros(simulation.robot.num_controls), 5e-4
    step[0] = 2e-5
    motion, start = simulation.motion_at_rest(pose), np.array(list(pose.markers.values())).ravel()
    seen, told, state = [], [], np.zeros(len(space.A))
    size = len(state)
    every = np.zeros((size + 1, size + 1))
    every[:size, :size], every[:size, size] = space.A, space.B @ step
    ahead = expm(every * dt)
    ahead_half = expm(every * dt / 2)
    for number in range(60):
        motion = simulation.step(motion, pose.contractions + step, dt)
        seen.append(np.array(list(motion.markers.values())).ravel() - start)
        state = (ahead_half if number == 0 else ahead)[:size] @ np.append(state, 1.0)  # the first step is a ramp
        told.append(space.C @ state)
    error = np.abs(np.array(seen) - np.array(told)).max()
    assert error < 0.03 * np.abs(seen).max()
    velocities = motion.velocities
    again = space.project(motion.nodes, velocities)
    modes = space.basis.shape[1]
    assert again[: 2 * modes] == pytest.approx(state[: 2 * modes], abs=0.05 * np.abs(state).max())


@pytest.mark.usefixtures("unchecked")
def test_what_has_no_linear_model_is_refused() -> None:
    simulation = viscous_strip()
    with pytest.raises(InputError, match="from 1 to"):
        find_modes(simulation, count=0)
    for count in (True, 2.0):
        with pytest.raises(InputError, match="whole number"):
            find_modes(simulation, count=count)  # type: ignore[arg-type]
    assert len(find_modes(simulation, count=np.int64(2)).shapes) == 2
    robot = simulation.robot
    rubbing = robot.with_network(robot.winches, [replace(cable, friction=0.2) for cable in robot.cables])
    with pytest.raises(InputError, match="friction has no linear model"):
        find_modes(Simulation(rubbing))


def test_slack_cables_at_rest_are_named() -> None:
    """Oracle: the gain of a slack cable is 0."""
    simulation = viscous_strip()
    robot = simulation.robot
    slack = robot.with_network(robot.winches, [replace(robot.cables[0], slack=0.002), *robot.cables[1:]])
    with pytest.warns(HydrostatWarning, match=f"cables {robot.cables[0].name}"):
        space = linearize(Simulation(slack), modes=2)
    assert not space.gain[:, 0].any()
