"""Muscle activation. Oracles: scipy's nnls, the conditions of an optimum, central differences."""

import numpy as np
import pytest
from builders import strip_robot
from scipy.optimize import nnls

from hydrostat.design import activate, edge_fibres
from hydrostat.design.muscles.activation import _Activation, element_fibres, least_effort, wanted_directions
from hydrostat.geometry import find_crossings
from hydrostat.mechanics import NewtonOptions, minimize
from hydrostat.robot import PoseTarget, sketch_robot
from hydrostat.simulation import BodyPhysics

BENT = PoseTarget(name="bent", targets={"tip": (0.18, 0.06)})


@pytest.mark.parametrize("seed", range(12))
def test_least_effort_against_nnls(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, fibres = int(random.integers(1, 12)), int(random.integers(1, 60))
    jacobian, wanted = random.normal(size=(rows, fibres)), random.normal(size=rows)
    rho = 10 ** random.uniform(-4, 1)
    found = least_effort(jacobian, wanted, rho)
    stacked = np.vstack([jacobian, np.sqrt(rho) * np.eye(fibres)])
    expected = nnls(stacked, np.concatenate([wanted, np.zeros(fibres)]), maxiter=100 * fibres)[0]
    assert np.abs(found - expected).max() <= 1e-8 * max(np.abs(expected).max(), 1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_least_effort_meets_the_conditions_of_an_optimum(seed: int) -> None:
    """As in a design: few rows, 600 fibres, a small rho. KKT: t >= 0, slope >= 0, t x slope = 0."""
    random = np.random.default_rng(seed)
    jacobian, wanted = 1e-3 * random.normal(size=(10, 600)), 0.05 * random.normal(size=10)
    rho = 1e-4 * (jacobian**2).sum(axis=0).max()
    found = least_effort(jacobian, wanted, rho)
    slope = jacobian.T @ (jacobian @ found - wanted) + rho * found
    scale = np.abs(jacobian.T @ wanted).max()
    assert found.min() >= 0
    assert slope.min() >= -1e-8 * scale
    assert np.abs(found * slope).max() <= 1e-8 * scale * found.max()


def test_nothing_wanted_or_only_pushing_helps() -> None:
    assert not least_effort(np.ones((1, 3)), np.zeros(1), 0.1).any()
    assert not least_effort(np.ones((1, 3)), -np.ones(1), 0.1).any()


@pytest.mark.parametrize("kind", ["edges", "elements"])
def test_a_reachable_pose_is_reached_by_muscles_that_pull(kind: str) -> None:
    robot = strip_robot()
    mesh = robot.body.mesh
    fibres = edge_fibres(mesh) if kind == "edges" else element_fibres(mesh, wanted_directions(robot, BENT))
    found = activate(robot, BENT, fibres)
    assert found.rms_error < 2e-3 * mesh.size
    assert found.tensions.min() >= 0
    assert found.errors == {"tip": pytest.approx(found.rms_error)}


def test_more_effort_leaves_more_error_and_weaker_muscles() -> None:
    robot = strip_robot(columns=8, rows=2)
    fibres = edge_fibres(robot.body.mesh)
    free, dear = (activate(robot, BENT, fibres, effort=effort) for effort in (1e-5, 1e-1))
    assert free.rms_error < dear.rms_error
    assert np.linalg.norm(free.tensions) > np.linalg.norm(dear.tensions)


def test_the_jacobian_by_the_adjoint() -> None:
    robot = strip_robot(columns=6, rows=2)
    fibres = edge_fibres(robot.body.mesh)
    run = _Activation(robot, BENT, fibres, 1e-4, 5, None)
    random = np.random.default_rng(0)
    tensions = np.where(random.random(len(fibres)) < 0.4, random.uniform(0, 1.0, len(fibres)), 0.0)

    def rest(tensions: np.ndarray, start: np.ndarray) -> np.ndarray:
        solved = minimize(
            run.assembly,
            start,
            tensions,
            round_off=BodyPhysics(robot).round_off(),
            options=NewtonOptions(tolerance=1e-13),
        )
        assert solved.converged
        return solved.nodes

    nodes = rest(tensions, robot.body.mesh.nodes)
    jacobian = run._jacobian(nodes, tensions)
    step = 1e-4
    for fibre in random.choice(len(fibres), 8, replace=False):
        shift = step * np.eye(len(fibres))[fibre]
        ahead, behind = (run.anchors.positions(rest(tensions + side * shift, nodes)) for side in (1, -1))
        expected = (ahead - behind).ravel() / (2 * step)
        assert jacobian[:, fibre] == pytest.approx(expected, abs=1e-6 * np.abs(jacobian).max())


FISH = "M10,60 C40,10 110,10 140,52 L185,20 C175,45 175,75 185,100 L140,68 C110,110 40,110 10,60Z"
BELL = "M10,20 H80 V55 H120 V20 H190 V100 H120 V65 H80 V100 H10Z"


@pytest.mark.parametrize("path", [FISH, BELL], ids=["fish", "bell"])
def test_the_first_pose_of_a_drawing_is_within_the_squeeze_of_its_material(path: str) -> None:
    """Oracle: muscles everywhere; no self-intersection, and no edge squeezed by more than half of what is known."""
    size = 'width="200mm" height="120mm" viewBox="0 0 200 120"'
    drawing = f'<svg xmlns="http://www.w3.org/2000/svg" {size}><path d="{path}"/></svg>'
    robot = sketch_robot(drawing.encode(), file="body.svg", name="body")
    mesh = robot.body.mesh
    bent = activate(robot, robot.pose("bend"), edge_fibres(mesh))
    assert not str(find_crossings(mesh, bent.nodes))
    lengths = [np.linalg.norm(np.diff(nodes[mesh.edges], axis=1), axis=2) for nodes in (mesh.nodes, bent.nodes)]
    squeeze = 1 - float((lengths[1] / lengths[0]).min())
    assert robot.body.material.largest_squeeze is not None
    assert squeeze < 0.5 * robot.body.material.largest_squeeze
