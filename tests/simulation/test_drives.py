"""Pins that drives turn and slide. Oracles: rigid motion, Euler's beam, differences of poses."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.control import Calibration
from hydrostat.errors import InputError
from hydrostat.ik import find_workspaces
from hydrostat.robot import Load, Marker, Material, Pin, PinDrive, Robot
from hydrostat.simulation import ContractionProfile, Simulation, StepOptions, continue_branch, find_equilibria

LENGTH, WIDTH, HEIGHT, YOUNG = 0.2, 0.01, 0.005, 35e6
TPU = Material(young=YOUNG, poisson=0.0, density=1220.0)
STIFF = 1e7
SERVO = PinDrive(name="servo", at=(0.0, WIDTH / 2, HEIGHT / 2), axis=(0.0, 2.0, 0.0))
STAGE = PinDrive(name="stage", slide=(0.0, 0.0, -3.0), min=-0.02, max=0.02)


def bar(*far: Pin, drives: tuple[PinDrive, ...] = (SERVO,), loads: tuple[Load, ...] = ()) -> Robot:
    """A bar whose end at the origin is clamped to a servo."""
    clamp = Pin(box=((-1e-4, -1.0, -1.0), (1e-4, 1.0, 1.0)), stiffness=STIFF, drive="servo")
    return Robot(
        name="bar",
        body=mesh_body(box_mesh((10, 1, 1), size=(LENGTH, WIDTH, HEIGHT)), material=TPU).with_elements("quadratic"),
        pins=(clamp, *far),
        drives=drives,
        loads=loads,
        markers=tuple(Marker(name=name, at=(x, WIDTH / 2, HEIGHT / 2)) for name, x in (("mid", 0.1), ("tip", LENGTH))),
        poses={},
    )


def far_clamp(drive: str | None = None) -> Pin:
    return Pin(box=((LENGTH - 1e-4, -1.0, -1.0), (LENGTH + 1e-4, 1.0, 1.0)), stiffness=STIFF, drive=drive)


@pytest.mark.parametrize("angle", [pi / 2, -2.5])
def test_a_bar_on_one_servo_turns_as_a_rigid_body(angle: float) -> None:
    simulation = Simulation(bar())
    pose = simulation.solve({"servo": angle})
    offsets = simulation.robot.body.mesh.nodes - SERVO.at
    turned = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    assert pose.energy == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(pose.nodes - SERVO.at, offsets @ turned.T, atol=1e-12)
    np.testing.assert_array_equal(pose.controls, [angle])


def test_a_flat_body_on_a_servo_and_a_stage_moves_as_a_rigid_body() -> None:
    """In the plane angles count from x to y."""
    body = mesh_body(strip_mesh(4, 2), thickness=0.02)
    robot = Robot(
        name="strip",
        body=body,
        pins=(Pin(at=(0.0, 0.025), radius=0.03, drive="d"),),
        drives=(PinDrive(name="d", at=(0.0, 0.0)),),
        poses={},
    )
    pose = Simulation(robot).solve([0.4])
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    np.testing.assert_allclose(pose.nodes, body.mesh.nodes @ turn.T, atol=1e-12)


def test_a_turned_and_a_sunken_clamp_bend_a_bar_as_eulers_beam() -> None:
    """M = 4 E I a / L turns one clamp of two, its work is 2 E I a^2 / L; a shift s of the other adds 6 E I s / L^2."""
    simulation = Simulation(bar(far_clamp("stage"), drives=(SERVO, STAGE)))
    rigidity = YOUNG * WIDTH * HEIGHT**3 / 12
    angle, sunk = 0.004, 0.3e-3
    work = rigidity * (2 * angle**2 / LENGTH)
    assert simulation.solve({"servo": angle}).energy == pytest.approx(work, rel=0.01)
    both = work + rigidity * (6 * sunk**2 / LENGTH**3 - 6 * angle * sunk / LENGTH**2)
    pose = simulation.solve({"servo": angle, "stage": sunk})
    assert pose.energy == pytest.approx(both, rel=0.01)
    force = rigidity * (6 * angle / LENGTH**2 - 12 * sunk / LENGTH**3)  # of the clamp that turns, upwards
    assert pose.pin_forces[:, 2] == pytest.approx([-force, force], rel=0.02)
    assert pose.pin_forces.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-8)
    sag = angle * LENGTH / 8 + sunk / 2
    assert HEIGHT / 2 - pose.markers["mid"][2] == pytest.approx(sag, rel=0.01)


def test_derivatives_are_those_of_differences_of_poses() -> None:
    """Jacobian and adjoint, of a bar that a weight bends far; a stiffness of pins too."""
    weight = Load(name="w", marker="mid", force=(0.0, 0.0, -1.0))
    robot = bar(far_clamp("stage"), drives=(SERVO, STAGE), loads=(weight,))
    simulation = Simulation(robot)
    at, step = np.array([0.5, 0.01]), 2e-5
    pose = simulation.solve(at)
    jacobian = simulation.marker_jacobian(pose)
    assert jacobian.shape == (2, 3, 2)
    ends = [[simulation.solve(at + sign * way, start=pose) for sign in (1, -1)] for way in step * np.eye(2)]
    slopes = [(up.markers["mid"] - down.markers["mid"]) / (2 * step) for up, down in ends]
    np.testing.assert_allclose(jacobian[0].T, slopes, atol=1e-5)
    cotangent = np.random.default_rng(0).standard_normal(pose.nodes.shape)
    found = simulation.adjoint(pose, cotangent)
    by_drives = [((up.nodes - down.nodes) * cotangent).sum() / (2 * step) for up, down in ends]
    np.testing.assert_allclose(found.drives, by_drives, rtol=1e-5)
    loose = [
        Simulation(bar(replace(far_clamp("stage"), stiffness=factor * STIFF), drives=robot.drives, loads=robot.loads))
        for factor in (1.01, 0.99)
    ]
    stiffer, softer = (each.solve(at, start=pose).nodes for each in loose)
    by_stiffness = ((stiffer - softer) * cotangent).sum() / (0.02 * STIFF)
    assert found.pin_stiffness[1] == pytest.approx(by_stiffness, rel=1e-3)
    assert found.contractions.shape == (0,)


def test_a_stage_moves_a_bar_in_time_as_shifts_of_its_pin_do() -> None:
    """Oracle: shifts of pins, which dynamics has without drives; loads and other pins stand still."""
    driven = Simulation(bar(far_clamp("stage"), drives=(SERVO, STAGE)))
    shifted = Simulation(bar(far_clamp("stage"), drives=(SERVO, STAGE)))
    one, other = driven.motion_at_rest(), shifted.motion_at_rest()
    for step in range(1, 6):
        place = 1e-4 * step**2
        one = driven.step(one, {"stage": place}, 2e-3)
        other = shifted.step(other, {}, 2e-3, pin_shifts={1: np.array([0.0, 0.0, -place])})
    assert np.linalg.norm(one.nodes - one.robot.body.mesh.nodes, axis=1).max() > 2e-3
    np.testing.assert_allclose(one.nodes, other.nodes, atol=1e-10)
    np.testing.assert_allclose(one.velocities, other.velocities, atol=1e-7)
    np.testing.assert_array_equal(one.drives, [0.0, one.drives[1]])
    assert one.pose.drives[1] == one.drives[1] == pytest.approx(2.5e-3)


@pytest.mark.slow
def test_a_servo_spins_a_bar_with_the_energy_of_a_rigid_one() -> None:
    """Oracle: I w^2 / 2 about the axis, and the turned bar, for a bar that is stiff against its own inertia."""
    simulation = Simulation(bar())
    speed, seconds = 0.5, 1.0
    profile = ContractionProfile(times=np.array([0.0, 4 * seconds]), values=np.array([[0.0], [4 * speed * seconds]]))
    motions = list(simulation.play(profile, seconds, 0.02, options=StepOptions(scheme="euler", drag=0.0)))
    last, offsets = motions[-1], simulation.robot.body.mesh.nodes - SERVO.at
    inertia = simulation.body.masses @ (offsets[:, 0] ** 2 + offsets[:, 2] ** 2)
    assert last.drives[0] == pytest.approx(speed * seconds)
    assert last.kinetic == pytest.approx(0.5 * inertia * speed**2, rel=0.02)
    angle = speed * seconds
    turned = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    np.testing.assert_allclose(last.nodes - SERVO.at, offsets @ turned.T, atol=1e-3 * LENGTH)


def test_values_of_drives_are_written_and_read_in_degrees_and_millimeters(tmp_path: Path) -> None:
    robot = bar(far_clamp("stage"), drives=(SERVO, STAGE))
    profile = ContractionProfile(times=np.array([0.0, 1.0]), values=np.array([[0.0, 0.0], [pi / 6, 5e-3]]))
    file = profile.write(tmp_path / "moves.csv", robot)
    assert file.read_text().splitlines() == ["time_s,servo_deg,stage_mm", "0,0,0", "1,30,5"]
    np.testing.assert_allclose(ContractionProfile.read(file, robot).values, profile.values, rtol=1e-12)
    file.write_text("time_s,servo_deg\n0,left\n")
    with pytest.raises(InputError, match="write a number of degrees, not"):
        ContractionProfile.read(file, robot)
    file.write_text("time_s,servo_rad\n0,1\n")
    with pytest.raises(InputError, match=r'unknown winch or drive "servo_rad".* Did you mean "servo_deg"'):
        ContractionProfile.read(file, robot)


def test_branches_and_workspaces_move_drives() -> None:
    """The tip of an arm on a servo turns on a circle, and its poses at an angle are one."""
    servo = replace(SERVO, min=-1.0, max=1.0)
    simulation = Simulation(bar(drives=(servo,)))
    found = find_equilibria(simulation, {"servo": 0.4}, count=2)
    assert found.unique
    np.testing.assert_allclose(found.poses[0].pose.controls, [0.4])
    branch = continue_branch(simulation, simulation.rest, {"servo": 0.4})
    assert branch.reaches_goal
    np.testing.assert_allclose(branch.end.markers["tip"], found.poses[0].pose.markers["tip"], atol=1e-9)
    reach = find_workspaces(simulation, count=8)[1]
    np.testing.assert_allclose(reach.extents, [2 * LENGTH * np.sin(1), LENGTH * (1 - np.cos(1)), 0], atol=0.004)


def test_wrong_values_are_told_in_one_line() -> None:
    simulation = Simulation(bar())
    with pytest.raises(InputError, match=r'angle of drive "servo", 30 rad, is more than a turn'):
        simulation.solve({"servo": 30.0})
    with pytest.raises(InputError, match='drives, such as "servo", are not available in motors'):
        Calibration.usual(simulation.robot).check(simulation.robot)
    for given in ({"servo": True}, [True]):
        with pytest.raises(InputError, match="contractions must be numbers"):
            simulation.solve(given)
    pose = simulation.solve({"servo": 3.2})
    assert pose.warnings == ("drive servo: 183.3 deg is outside its range (-180 deg to 180 deg)",)
