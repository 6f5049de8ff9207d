"""How solves end where it is hard. Oracles: residual, J and eigenvalues judged afresh; the same body elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from builders import mesh_body, strip_mesh, strip_robot
from robustness import fault  # pyright: ignore[reportMissingImports]
from test_buckling import column, hessian  # pyright: ignore[reportMissingImports]

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Material, Pin, Robot
from hydrostat.simulation import Simulation


def cantilever(young: float, *, shift: float = 0.0) -> Robot:
    """A strip held at one end that bends under its weight alone, so far from 0 as asked."""
    mesh = strip_mesh(40, 4, size=(0.4, 0.04))
    mesh = Mesh(mesh.nodes + shift, mesh.elements)
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    box = (tuple(low - 1e-3), (float(low[0]) + 1e-3, float(high[1]) + 1e-3))
    body = mesh_body(mesh, material=Material(young=young, poisson=0.3, density=1000.0), thickness=0.04)
    return Robot(name="cantilever", body=body, pins=(Pin(box=box),), poses={}, gravity=(0.0, -9.81))


@pytest.mark.parametrize("young", [30e3, 5e3, 3e3, 1e3])
def test_a_soft_body_comes_to_rest_under_its_weight(young: float) -> None:
    """At 3 kPa it hangs straight down; contractions cannot be ramped, so the weight is."""
    simulation = Simulation(cantilever(young))
    pose = simulation.solve({})
    assert pose.result.converged
    assert "J" not in fault(simulation, pose)


@pytest.mark.parametrize("shift", [0.0, 10.0, 100.0])
def test_it_does_not_matter_where_a_body_lies(shift: float) -> None:
    here, there = (Simulation(cantilever(30e3, shift=at)) for at in (0.0, shift))
    moved = there.solve({}).nodes - shift
    assert np.abs(moved - here.solve({}).nodes).max() < 1e-9


@pytest.mark.parametrize(("stiffness", "taken"), [(1e6, 1e-4), (1e7, 1e-3), (1e7, 1e-4)])
def test_very_stiff_cables_on_foam_are_judged_by_what_rounding_leaves(stiffness: float, taken: float) -> None:
    """Oracle: a length of the robot's size is known to 1e-16 of it, and so is a tension to that times the stiffness."""
    robot = strip_robot()
    cables = tuple(replace(cable, stiffness=stiffness, smoothing=1e-9) for cable in robot.cables)
    pose = Simulation(replace(robot, cables=cables)).solve(np.array([taken, 0.0]))
    assert pose.result.residual < max(1e-8 * pose.tensions.max(), 1e-16 * stiffness * robot.body.mesh.size)


def test_a_chain_of_hair_steps_does_not_freeze_what_is_known_of_stability() -> None:
    """Across the buckling load in steps of 1 nm: the sign of the smallest eigenvalue, by dense eigenvalues."""
    simulation, pose = Simulation(column(4)), None
    for step in range(60):
        both = np.full(2, 0.0108569 + 5e-9 * step)
        pose = simulation.solve(both, start=pose, strict=False)
        least = np.linalg.eigvalsh(hessian(simulation, pose.nodes, both))[0]
        assert pose.result.stable == bool(least > 0) or abs(least) < 1e-9


def test_a_start_that_is_no_pose_of_the_robot_is_refused() -> None:
    simulation = Simulation(strip_robot())
    pose = simulation.solve(np.zeros(2))
    broken = pose.nodes.copy()
    broken[0] = np.nan
    for nodes in (broken, pose.nodes[:-1]):
        with pytest.raises(InputError, match="start"):
            simulation.solve(np.zeros(2), start=replace(pose, nodes=nodes))


def test_a_failure_still_has_every_element_upright() -> None:
    """From a mirrored start, with one iteration: what is returned is finite, J > 0, at the contractions asked."""
    simulation = Simulation(strip_robot(), options=NewtonOptions(iterations=1))
    rest = simulation.solve(np.zeros(2))
    mirrored = replace(rest, nodes=rest.nodes * np.array([1.0, -1.0]))
    pose = simulation.solve(np.array([0.1, 0.0]), start=mirrored, strict=False)
    assert not pose.result.converged
    assert np.isfinite(pose.nodes).all()
    assert np.linalg.det(simulation.assembly.energies[0].deformation_gradients(pose.nodes)).min() > 0
    found = np.abs(simulation.assembly.gradient(pose.nodes, pose.contractions)).max()
    assert found == pytest.approx(pose.result.residual)


def test_a_part_that_no_pin_holds_is_refused() -> None:
    robot = strip_robot()
    mesh = robot.body.mesh
    away = Mesh(
        np.concatenate([mesh.nodes, mesh.nodes + 1.0]), np.concatenate([mesh.elements, mesh.elements + len(mesh.nodes)])
    )
    with pytest.raises(InputError, match="no pin"):
        Simulation(replace(robot, body=replace(robot.body, mesh=away)))
