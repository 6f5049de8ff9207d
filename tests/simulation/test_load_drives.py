"""Loads as controls. Oracles: a bar under an end force, constant loads, loads along a path, differences of poses."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_robot

from hydrostat.ik import solve_ik, solve_pulls
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Load, LoadDrive, Marker, Pin, Robot
from hydrostat.simulation import ContractionProfile, Equilibrium, Simulation

TIGHT = NewtonOptions(tolerance=1e-13)
PUSH = Load(name="push", marker="tip", force=(0.02, -0.05), drive="thumb")
TURN = Load(name="turn", marker="tip", moment=(4e-3,), drive="wrist")
DRIVES = (LoadDrive(name="thumb", min=-1.0, max=2.0), LoadDrive(name="wrist", min=-1.0, max=1.0))


def strip(loads: tuple[Load, ...] = (PUSH, TURN), drives: tuple[LoadDrive, ...] = DRIVES) -> Robot:
    robot = strip_robot(columns=8, rows=2)
    return replace(robot, markers=(Marker(name="tip", at=(0.19, 0.0)),), loads=loads, drives=drives)


def constant(thumb: float, wrist: float) -> Robot:
    """The same robot with the shares of its loads as constant loads."""
    push, turn = ((thumb * 0.02, thumb * -0.05), (wrist * 4e-3,))
    loads = (replace(PUSH, force=push, drive=None), replace(TURN, moment=turn, drive=None))
    return strip(loads, ())


def test_a_bar_under_a_growing_end_force_grows_as_told() -> None:
    """F L / (E A) at each instant of a slow ramp; F / E A is 1e-4, so the bar is linear to that."""
    length, side = 0.1, 0.02
    mesh = box_mesh((4, 1, 1), size=(length, side, side))
    full = 1e-4 * FOAM.young * side**2
    middle = (length, side / 2, side / 2)
    robot = Robot(
        name="bar",
        body=mesh_body(mesh, material=replace(FOAM, poisson=0.0)),
        pins=(Pin(box=((-1e-6, -1.0, -1.0), (1e-6, 1.0, 1.0)), stiffness=1e9),),
        loads=tuple(
            Load(name=f"{y} {z}", at=(length, y * side, z * side), force=(full * weight, 0.0, 0.0), drive="pull")
            for y, z, weight in end_weights(mesh, length, side)
        ),
        drives=(LoadDrive(name="pull", min=0.0, max=1.0),),
        markers=(Marker(name="end", at=middle),),
        poses={},
    )
    simulation = Simulation(robot)
    profile = ContractionProfile(times=np.array([0.0, 2.0]), values=np.array([[0.0], [1.0]]))
    for motion in simulation.play(profile, 2.0, 0.25):
        share = motion.time / 2.0
        assert motion.drives[0] == pytest.approx(share)
        assert motion.markers["end"][0] - length == pytest.approx(1e-4 * share * length, abs=2e-3 * 1e-4 * length)


def end_weights(mesh, length: float, side: float) -> list[tuple[float, float, float]]:  # type: ignore[no-untyped-def]
    """Share of the end face that each of its corners carries."""
    facets = mesh.boundary[(mesh.nodes[mesh.boundary][:, :, 0] > length - 1e-9).all(axis=1)]
    corners, counts = np.unique(facets, return_counts=True)
    return [(*(mesh.nodes[at][1:] / side), count / counts.sum()) for at, count in zip(corners, counts, strict=True)]


def test_a_share_of_a_load_is_that_load() -> None:
    """Pose, and derivatives by material, thickness, force and moment, are those of the constant loads."""
    shares = {"thumb": 0.6, "wrist": -0.4}
    driven, fixed = Simulation(strip(), options=TIGHT), Simulation(constant(**shares), options=TIGHT)
    pose, told = driven.solve(shares), fixed.solve({})
    np.testing.assert_allclose(pose.nodes, told.nodes, atol=1e-10)
    assert np.abs(pose.nodes - pose.robot.body.mesh.nodes).max() > 5e-3
    cotangent = np.random.default_rng(0).standard_normal(pose.nodes.shape)
    found, right = (one.adjoint(at, cotangent) for one, at in ((driven, pose), (fixed, told)))
    assert found.young == pytest.approx(right.young, rel=1e-6)
    assert found.thickness == pytest.approx(right.thickness, rel=1e-6)
    np.testing.assert_allclose(found.loads, right.loads * [[0.6], [1.0]], rtol=1e-6)
    np.testing.assert_allclose(found.moments, right.moments * [0.6, 0.4], rtol=1e-6)  # the moment itself is negative


def test_derivatives_by_a_share_are_differences() -> None:
    simulation = Simulation(strip(), options=TIGHT)
    at, step = np.array([*np.zeros(len(simulation.robot.winches)), 0.6, -0.4]), 1e-4
    pose = simulation.solve(at)
    cotangent = np.random.default_rng(0).standard_normal(pose.nodes.shape)
    adjoint, jacobian = simulation.adjoint(pose, cotangent).drives, simulation.marker_jacobian(pose)[0]
    for index, way in enumerate(step * np.eye(len(at))[-2:]):
        up, down = (simulation.solve(at + sign * way, start=pose) for sign in (1, -1))
        moved = (up.markers["tip"] - down.markers["tip"]) / (2 * step)
        assert jacobian[:, index - 2] == pytest.approx(moved, rel=1e-5, abs=1e-9)
        assert adjoint[index] == pytest.approx(((up.nodes - down.nodes) * cotangent).sum() / (2 * step), rel=1e-5)


def test_inverse_kinematics_finds_the_force_that_moves_a_marker() -> None:
    simulation = Simulation(strip((PUSH,), DRIVES[:1]))
    simulation = Simulation(simulation.robot.with_network((), ()))
    goal: Equilibrium = simulation.solve({"thumb": 1.3})
    found = solve_ik(simulation, {"tip": goal.markers["tip"]})
    assert found.pose.drives["thumb"] == pytest.approx(1.3, abs=1e-3)
    far = solve_ik(simulation, {"tip": simulation.solve({"thumb": 2.5}, strict=False).markers["tip"]})
    assert far.active_limits == ("thumb: at maximum, 2",)


def test_winches_pull_while_a_drive_pushes() -> None:
    """Oracle: the constant loads; more than one step of Newton keeps the drive where it is."""
    pull = {strip().winches[0].name: 1.5}
    driven = solve_pulls(Simulation(strip()), pull, {"thumb": 0.6, "wrist": -0.4})
    fixed = solve_pulls(Simulation(constant(0.6, -0.4)), pull)
    np.testing.assert_array_equal(driven.drives, [0.6, -0.4])
    np.testing.assert_allclose(driven.nodes, fixed.nodes, atol=1e-7)
    assert driven.tensions[0] == pytest.approx(1.5, rel=1e-5)


def test_a_profile_moves_a_body_as_the_path_of_a_load_does() -> None:
    path = ((0.0, 0.0), (0.1, 1.0), (0.2, 0.2))
    drawn = Simulation(strip((replace(PUSH, drive=None, path=path),), ()).with_network((), ()))
    driven = Simulation(strip((PUSH,), DRIVES[:1]).with_network((), ()))
    times, shares = np.array(path).T
    moves = [(drawn, np.zeros((3, 0))), (driven, shares[:, None])]
    one, other = (list(each.play(ContractionProfile(times=times, values=way), 0.3, 0.02))[-1] for each, way in moves)
    assert np.abs(one.nodes - one.robot.body.mesh.nodes).max() > 1e-3
    np.testing.assert_allclose(one.nodes, other.nodes, atol=1e-9)
    assert one.potential + one.kinetic == pytest.approx(other.potential + other.kinetic, rel=1e-6)
