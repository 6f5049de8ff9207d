"""Inverse kinematics of robots with drives. Oracles: a forward solve at the answer, differences of poses."""

import numpy as np
import pytest
from builders import box_mesh, mesh_body

from hydrostat.errors import InputError
from hydrostat.ik import (
    EquilibriumState,
    IKStatus,
    StateJacobian,
    TrajectoryOptions,
    correct_contractions,
    solve_ik,
    solve_ik_trajectory,
)
from hydrostat.robot import Cable, Marker, Material, Pin, PinDrive, Robot, Winch
from hydrostat.simulation import Simulation

SILICONE = Material(young=200e3, poisson=0.3, density=1070.0)
AXIS = (0.0, 0.01, 0.01)
COARSE = TrajectoryOptions(rate=4.0)


def arm(*, cabled: bool) -> Robot:
    """A bar on a servo that turns it about y and a stage that slides it along y, with a cable below if asked."""
    pin = Pin(box=((-1e-4, -1.0, -1.0), (1e-4, 1.0, 1.0)), stiffness=1e6)
    far = Pin(box=((0.1199, -1.0, -1.0), (0.1201, 1.0, 1.0)), stiffness=1e6)
    servo = PinDrive(name="servo", at=AXIS, axis=(0.0, 1.0, 0.0), min=-1.0, max=1.0)
    stage = PinDrive(name="stage", slide=(0.0, 0.0, 1.0), min=-0.03, max=0.03)
    route = ((0.005, 0.01, 0.003), (0.06, 0.01, 0.003), (0.115, 0.01, 0.003))
    ends = (Pin(**{**vars(pin), "drive": "servo"}), *(() if cabled else (Pin(**{**vars(far), "drive": "stage"}),)))
    return Robot(
        name="arm",
        body=mesh_body(box_mesh((12, 2, 2), size=(0.12, 0.02, 0.02)), material=SILICONE),
        pins=ends,
        drives=(servo,) if cabled else (servo, stage),
        winches=(Winch(name="below", at=route[0], spool_radius=5e-3, travel=0.03),) if cabled else (),
        cables=(Cable(winch="below", points=route),) if cabled else (),
        markers=(Marker(name="tip", at=(0.12, 0.01, 0.01)), Marker(name="mid", at=(0.06, 0.01, 0.01))),
        poses={},
    )


@pytest.mark.parametrize(("cabled", "asked"), [(True, (0.012, -0.5)), (False, (0.4, 0.01))])
def test_angles_that_reach_a_target_are_found(cabled: bool, asked: tuple[float, float]) -> None:
    """The target is the pose of other values; both controls are needed to reach it."""
    simulation = Simulation(arm(cabled=cabled))
    target = simulation.solve(np.array(asked)).markers
    found = solve_ik(simulation, target)
    assert found.status is IKStatus.REACHED
    again = simulation.solve(found.pose.controls)
    for marker, place in target.items():
        np.testing.assert_allclose(again.markers[marker], place, atol=2e-5)
    np.testing.assert_allclose(found.pose.controls, asked, atol=2e-3)


def test_a_limit_of_a_drive_holds_and_is_told() -> None:
    simulation = Simulation(arm(cabled=True))
    found = solve_ik(simulation, {"tip": (0.0, 0.01, -0.2)})
    assert found.pose.drives[0] == pytest.approx(1.0)
    assert any("servo: at maximum, 57.3 deg" in words for words in found.active_limits)


def test_state_jacobian_is_that_of_differences() -> None:
    simulation = Simulation(arm(cabled=True))
    at, step = np.array([0.01, 0.3]), 1e-5
    moves = StateJacobian.at(simulation, simulation.solve(at))
    ends = [
        [EquilibriumState.at(simulation, simulation.solve(at + sign * way)) for sign in (1, -1)]
        for way in step * np.eye(2)
    ]
    tensions = np.stack([(up.tensions - down.tensions) / (2 * step) for up, down in ends], axis=1)
    nodes = np.stack([(up.nodes - down.nodes) / (2 * step) for up, down in ends], axis=2)
    np.testing.assert_allclose(moves.nodes, nodes, atol=1e-5)
    np.testing.assert_allclose(moves.tensions, tensions, rtol=1e-5, atol=1e-6)


def test_a_trajectory_moves_winches_and_drives_within_their_speeds() -> None:
    """Oracle: forward solves at samples; the slowest control sets the time."""
    simulation = Simulation(arm(cabled=True))
    target = simulation.solve(np.array([0.004, -0.5])).markers
    found = solve_ik_trajectory(simulation, [target], speed={"servo": 0.2, "below": 0.5}, options=COARSE)
    assert found.keyframes[0].rms_error < 2e-5
    assert found.peak_speeds[1] == pytest.approx(0.2, rel=1e-6)
    assert np.abs(found.speeds[:, 1]).max() <= 0.2 + 1e-9
    middle = len(found.times) // 2
    pose = simulation.solve(found.contractions[middle])
    np.testing.assert_allclose(found.poses[middle].markers["tip"], pose.markers["tip"], atol=1e-6)
    table = found.columns()
    np.testing.assert_array_equal(table["drive_servo_rad"], found.contractions[:, 1])
    assert "largest speed of drive servo: 11.46 deg a second" in found.lines()
    usual = solve_ik_trajectory(simulation, [target], options=COARSE)
    assert usual.limits.speed.tolist() == [0.05, 1.0]
    assert usual.limits.acceleration.tolist() == [0.2, 4.0]
    with pytest.raises(InputError, match=r"drive servo: 62\.45 deg is outside its range"):
        solve_ik_trajectory(simulation, [simulation.solve([0.0, 1.09])])


def test_a_correction_takes_back_an_error_by_drives() -> None:
    simulation = Simulation(arm(cabled=True))
    target = simulation.solve(np.array([0.004, -0.5])).markers
    played = solve_ik(simulation, target)
    off = simulation.solve(played.pose.controls + np.array([0.0, 0.05])).markers
    corrected = correct_contractions(simulation, played, off, damping=1e-3)
    np.testing.assert_allclose(corrected, played.pose.controls - np.array([0.0, 0.05]), atol=5e-3)
