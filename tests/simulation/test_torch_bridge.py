"""`solve_torch`. Oracles: PyTorch's gradcheck, by central differences of fully converged solves; `Simulation.solve`."""

import importlib
import subprocess
import sys
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from builders import strip_robot
from test_adjoint import box, heavy_patches, strip

from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Mount, Robot
from hydrostat.simulation import Simulation

TIGHT = NewtonOptions(tolerance=1e-13)
CASES = {
    "flat": (strip(), [0.02, 0.009]),
    "shared winch": (strip(shared=True), [0.01]),
    "world": (strip(mount=Mount.WORLD), [0.015, 0.013]),
    "patches with weight": (heavy_patches(strip(sheathed=((0, 1),))), [0.02, 0.009]),
    "space": (box(), [0.006, 0.008]),
}


@pytest.fixture
def torch() -> ModuleType:
    return pytest.importorskip("torch", exc_type=ImportError)


def solve(*given: Any, **others: Any) -> Any:
    from hydrostat.simulation.torch_bridge import solve_torch

    return solve_torch(*given, **others)


def numbers(torch: ModuleType, robot: Robot, contractions: list[float]) -> tuple:
    """Contractions, slack, Young's modulus over its own, Poisson's ratio, routes; all of them ask for a derivative."""
    routes = [cable.points for cable in robot.cables]
    values = (contractions, [cable.slack for cable in robot.cables], 1.0, robot.body.material.poisson, *routes)
    return tuple(torch.tensor(value, dtype=torch.float64, requires_grad=True) for value in values)


@pytest.mark.parametrize("name", CASES)
def test_gradcheck(name: str, torch: ModuleType, unchecked: None) -> None:
    """By everything at once: how nodes, markers and tensions change, a few random sums of them."""
    robot, contractions = CASES[name]
    simulation = Simulation(robot, options=TIGHT)
    start = simulation.solve(np.array(contractions))
    rng = np.random.default_rng(3)
    weights = torch.tensor(rng.normal(size=(3, *start.nodes.shape)))
    young = robot.body.material.young

    def function(contractions: Any, slack: Any, share: Any, poisson: Any, *routes: Any) -> tuple:
        pose = solve(
            simulation, contractions, slack=slack, young=young * share, poisson=poisson, routes=routes, start=start
        )
        return (weights * pose.nodes).sum(dim=(1, 2)), pose.markers["tip"], 0.1 * pose.tensions

    given = numbers(torch, robot, contractions)
    assert torch.autograd.gradcheck(function, given, eps=1e-6, atol=1e-6, rtol=1e-5)


def test_gradcheck_can_fail(torch: ModuleType) -> None:
    """With a derivative that is 1e-3 wrong."""
    simulation = Simulation(strip(), options=TIGHT)

    def function(contractions: Any) -> Any:
        wrong = 1.001 * contractions - 0.001 * contractions.detach()
        return solve(simulation, wrong).nodes

    given = torch.tensor([0.02, 0.009], dtype=torch.float64, requires_grad=True)
    with pytest.raises(RuntimeError, match="Jacobian mismatch"):
        torch.autograd.gradcheck(function, (given,), eps=1e-6, atol=1e-6, rtol=1e-5)


def test_the_pose_is_that_of_solve(torch: ModuleType) -> None:
    simulation = Simulation(strip_robot())
    expected = simulation.solve(np.array([0.02, 0.008]))
    pose = solve(simulation, torch.tensor([0.02, 0.008], dtype=torch.float64))
    assert (pose.nodes.numpy() == expected.nodes).all()
    assert (pose.tensions.numpy() == expected.tensions).all()
    assert pose.markers["tip"].numpy() == pytest.approx(expected.markers["tip"], rel=1e-14)
    assert pose.solved.energy == expected.energy
    assert not pose.nodes.requires_grad


def test_single_precision_is_taken_and_gets_its_slopes(torch: ModuleType) -> None:
    simulation = Simulation(strip_robot())
    given = torch.tensor([0.02, 0.008], requires_grad=True)
    pose = solve(simulation, given)
    assert pose.nodes.dtype == torch.float64
    pose.markers["tip"][1].backward()
    nodes = simulation.marker_anchors.matrix(len(pose.nodes)).toarray().T * [0.0, 1.0]
    assert given.grad.dtype == torch.float32
    assert given.grad.numpy() == pytest.approx(simulation.adjoint(pose.solved, nodes).contractions, rel=1e-6)


def test_descent_finds_the_route_and_modulus_of_a_pose(torch: ModuleType, unchecked: None) -> None:
    """Oracle: the numbers that made the target."""
    robot = strip()
    young = robot.body.material.young
    simulation = Simulation(robot, options=TIGHT)
    contractions = torch.tensor([0.02, 0.0], dtype=torch.float64)
    routes = [torch.tensor(cable.points, dtype=torch.float64) for cable in robot.cables]
    lift = torch.zeros((4, 2), dtype=torch.float64)
    lift[1, 1] = 1.0
    goal = solve(
        simulation, contractions, routes=[routes[0] + 0.002 * lift, routes[1]], young=torch.tensor(1.3 * young)
    )
    unknown = torch.tensor([0.0, 1.0], dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.LBFGS([unknown], line_search_fn="strong_wolfe", tolerance_grad=1e-12, tolerance_change=0)

    def closure() -> Any:
        optimizer.zero_grad()
        moved = [routes[0] + 1e-2 * unknown[0] * lift, routes[1]]
        pose = solve(simulation, contractions, routes=moved, young=young * unknown[1], start=goal.solved)
        loss = 1e4 * (pose.nodes - goal.nodes).square().sum()
        loss.backward()
        return loss

    optimizer.step(closure)
    assert unknown.detach().numpy() == pytest.approx([0.2, 1.3], rel=1e-5)


def test_what_does_not_fit_is_refused(torch: ModuleType) -> None:
    robot = strip()
    simulation, plain = Simulation(robot), torch.tensor([0.02, 0.008])
    with pytest.raises(InputError, match="3 contractions given for 2 winches"):
        solve(simulation, torch.zeros(3))
    with pytest.raises(InputError, match="slack must be a number for each of the 2 cables"):
        solve(simulation, plain, slack=torch.zeros(3))
    with pytest.raises(InputError, match=r"routes must hold .* of shapes \[\(4, 2\), \(3, 2\)\], not \[\(4, 2\)\]"):
        solve(simulation, plain, routes=[torch.zeros((4, 2))])
    with pytest.raises(InputError, match="young must be one number, not 2"):
        solve(simulation, plain, young=torch.ones(2))
    with pytest.raises(InputError, match=r"poisson must be at least 0 and below 0\.5"):
        solve(simulation, plain, poisson=torch.tensor(0.6))


def test_with_friction_there_are_slopes_too(torch: ModuleType) -> None:
    """Oracle: the difference of whole ways from rest."""
    robot = strip()
    simulation = Simulation(replace(robot, cables=(replace(robot.cables[0], friction=0.2), robot.cables[1])))
    pull = torch.tensor([0.01, 0.0], dtype=torch.float64, requires_grad=True)
    solve(simulation, pull).tensions[0].backward()
    up, down = (simulation.solve(np.array([0.01 + step, 0.0])).tensions[0] for step in (1e-6, -1e-6))
    assert float(pull.grad[0]) == pytest.approx((up - down) / 2e-6, rel=1e-5)


def test_simulation_does_without_torch(torch: ModuleType) -> None:
    code = "import hydrostat.simulation, sys; print('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


def test_without_torch_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.delitem(sys.modules, "hydrostat.simulation.torch_bridge", raising=False)
    with pytest.raises(InputError, match=r"needs PyTorch\. Install it: pip install .*\[learn\]"):
        importlib.import_module("hydrostat.simulation.torch_bridge")
