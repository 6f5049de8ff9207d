"""A column pressed by two cables, about its buckling load. Oracles: dense eigenvalues, a dense Newton on the saddle."""

import numpy as np
import pytest
from builders import mesh_body, strip_mesh

from hydrostat.robot import Cable, Pin, Robot, Winch
from hydrostat.simulation import Simulation

LENGTH, HEIGHT = 0.3, 0.03


def column(rows: int = 3) -> Robot:
    """A strip ten times as long as high; the cables run straight from end to end, without via points.

    With an even number of rows the mesh is its own mirror image.
    """
    tracks = {name: ((0.003, y), (0.99 * LENGTH, y)) for name, y in (("up", HEIGHT / 4), ("down", -HEIGHT / 4))}
    return Robot(
        name="column",
        body=mesh_body(strip_mesh(30, rows, size=(LENGTH, HEIGHT))),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0))),),
        winches=tuple(Winch(name=name, at=points[0]) for name, points in tracks.items()),
        cables=tuple(Cable(winch=name, points=points) for name, points in tracks.items()),
        poses={},
    )


def hessian(simulation: Simulation, nodes: np.ndarray, contractions: np.ndarray) -> np.ndarray:
    """Dense, with the part of low rank."""
    springs = simulation.assembly.low_rank_hessian(nodes, contractions)
    columns, weights = springs.columns, springs.weights
    return simulation.assembly.hessian(nodes, contractions).toarray() + columns @ weights @ columns.T


def mirrored(robot: Robot, nodes: np.ndarray) -> np.ndarray:
    """The pose reflected at the middle of the column."""
    rest = robot.body.mesh.nodes
    images = [int(np.argmin(np.abs(rest - point * [1, -1]).sum(axis=1))) for point in rest]
    return nodes[images] * [1, -1]


def saddle(simulation: Simulation, contraction: float) -> np.ndarray:
    """The straight column at this contraction, by plain dense Newton steps, which keep the symmetry."""
    nodes = simulation.robot.body.mesh.nodes
    for given in np.linspace(0, contraction, 9)[1:]:
        both = np.full(2, given)
        for _ in range(12):
            step = np.linalg.solve(hessian(simulation, nodes, both), -simulation.assembly.gradient(nodes, both))
            nodes = nodes + step.reshape(nodes.shape)
            nodes = 0.5 * (nodes + mirrored(simulation.robot, nodes))
    assert np.abs(simulation.assembly.gradient(nodes, np.full(2, contraction))).max() < 1e-9
    return nodes


@pytest.mark.parametrize("uneven", [1e-6, 1e-4, 1e-3])
@pytest.mark.parametrize("contraction", [0.006, 0.01, 0.012, 0.02, 0.05])
def test_newton_does_not_creep_at_the_buckling_load(contraction: float, uneven: float) -> None:
    """At 12 mm the fully projected Hessian took up to 81 steps; mixing in only what is needed takes about 10."""
    simulation = Simulation(column())
    pose = simulation.solve(np.array([contraction, contraction * (1 - uneven)]))
    assert pose.result.iterations < 50
    least = np.linalg.eigvalsh(hessian(simulation, pose.nodes, pose.contractions))[0]
    assert pose.result.stable == bool(least > 0)
    assert pose.result.stable


@pytest.mark.parametrize("contraction", [0.002, 0.006, 0.01])
def test_under_a_gentle_command_a_symmetric_column_stays_symmetric(contraction: float) -> None:
    simulation = Simulation(column(4))
    pose = simulation.solve(np.full(2, contraction))
    assert np.abs(mirrored(simulation.robot, pose.nodes) - pose.nodes).max() < 1e-9 * LENGTH
    assert pose.result.stable
    assert not pose.result.buckled
    assert np.abs(saddle(simulation, contraction) - pose.nodes).max() < 1e-8 * LENGTH


@pytest.mark.parametrize("contraction", [0.011, 0.012, 0.013, 0.014, 0.02])
def test_above_its_buckling_load_a_symmetric_column_leaves_the_saddle(contraction: float) -> None:
    """The straight column is a saddle. What is found is a minimum, lower, and so is its mirror image."""
    simulation, both = Simulation(column(4)), np.full(2, contraction)
    pose, straight = simulation.solve(both), saddle(simulation, contraction)
    assert np.linalg.eigvalsh(hessian(simulation, straight, both))[0] < 0
    assert pose.result.buckled
    assert pose.result.stable
    assert np.linalg.eigvalsh(hessian(simulation, pose.nodes, both))[0] > 0
    assert pose.energy < simulation.assembly.value(straight, both)
    image = mirrored(simulation.robot, pose.nodes)
    assert np.abs(image - pose.nodes).max() > 0.01 * LENGTH
    assert simulation.assembly.value(image, both) == pytest.approx(pose.energy, rel=1e-9)
    assert np.abs(simulation.assembly.gradient(image, both)).max() < 2 * pose.result.allowed + 1e-9
