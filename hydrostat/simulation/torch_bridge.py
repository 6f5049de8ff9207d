"""`solve_torch`: an equilibrium as a function of tensors, with derivatives for PyTorch.

It needs PyTorch, which the extra `learn` brings; nothing else in hydrostat imports this file.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.robot import Cable, Mount, Robot, Winch
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.simulation import Simulation
from hydrostat.version import install_command

try:
    import torch  # pyright: ignore[reportMissingImports]
    from torch import Tensor  # pyright: ignore[reportMissingImports]
    from torch.autograd.function import once_differentiable  # pyright: ignore[reportMissingImports]
except ImportError:
    raise InputError(f"solve_torch needs PyTorch. Install it: {install_command('learn')}") from None


@dataclass(frozen=True, kw_only=True, eq=False)
class TorchPose:
    """Equilibrium as float64 tensors that carry their derivatives; fields as in `Equilibrium`.

    Attributes:
        nodes: node positions [m], (nodes, dim).
        markers: position of each marker [m].
        tensions: tension of each cable [N].
        solved: the same equilibrium without derivatives, to warm-start the next solve.
    """

    nodes: Tensor
    markers: Mapping[str, Tensor]
    tensions: Tensor
    solved: Equilibrium


def solve_torch(
    simulation: Simulation,
    contractions: Tensor,
    *,
    slack: Tensor | None = None,
    routes: Sequence[Tensor] | None = None,
    young: Tensor | None = None,
    poisson: Tensor | None = None,
    start: Equilibrium | None = None,
) -> TorchPose:
    """Equilibrium as `Simulation.solve` finds it; `backward` costs one solve with the factorized Hessian.

    Tensors of any float type and device are taken; all is computed in float64 on the CPU. What is left out stays as
    in the robot; what is given takes its place, for which a simulation is built again, on the same body physics unless
    `young` or `poisson` is given. Second derivatives are refused.

    Args:
        simulation: simulation of the robot.
        contractions: cable taken in by each winch [m], (winches,).
        slack: slack of each cable [m], (cables,).
        routes: rest positions of the points of each cable [m], (points, dim) each. The winch of a cable that begins
            in the world goes with its first point.
        young: Young's modulus [Pa], one number.
        poisson: Poisson's ratio, one number.
        start: a pose to begin from; the rest pose if left out.

    Raises:
        InputError: values that the robot refuses, or a wrong shape.
        NotConvergedError: as for `Simulation.solve`; in `backward` as for `Simulation.jacobian`.
    """
    check_type(simulation, Simulation, "simulation must be a Simulation(robot)")
    robot = simulation.robot
    check_type(contractions, Tensor, "contractions must be a tensor [m], such as torch.tensor([0.01, 0.0])")
    for what, value in (("slack", slack), ("young", young), ("poisson", poisson)):
        check_type(value, (Tensor, type(None)), f"{what} must be a tensor, such as torch.tensor(0.3)")
    joint = None
    if routes is not None:
        _check_routes(robot, routes)
        joint = torch.cat([_plain(route) for route in routes]) if routes else None
    others = (slack, joint, young, poisson)
    given = [None if value is None else _plain(value) for value in (contractions, *others)]
    nodes, tensions, solved = _Equilibrium.apply(simulation, start, *given)
    anchors = simulation.marker_anchors
    corners = nodes[torch.from_numpy(anchors.stencils)]
    places = (torch.from_numpy(anchors.weights)[:, :, None] * corners).sum(dim=1)
    markers = {marker.name: place for marker, place in zip(robot.markers, places, strict=True)}
    return TorchPose(nodes=nodes, markers=markers, tensions=tensions, solved=solved)


class _Equilibrium(torch.autograd.Function):
    """Nodes and tensions of an equilibrium; backwards by the adjoint."""

    @staticmethod
    def forward(ctx: Any, *given: Any) -> tuple[Tensor, Tensor, Equilibrium]:
        simulation, start, contractions, *others = given
        if any(value is not None for value in others):
            numbers = (None if value is None else value.detach().numpy() for value in others)
            robot = _alter_robot(simulation.robot, *numbers)
            body = simulation.body if simulation.body.fits(robot) else None
            simulation = Simulation(robot, options=simulation.options, body=body)
        pose = simulation.solve(contractions.detach().numpy(), start=start)
        ctx.simulation, ctx.pose = simulation, pose
        ctx.shapes = [None if value is None else value.shape for value in (contractions, *others)]
        return torch.tensor(pose.nodes), torch.tensor(pose.tensions), pose

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *derivatives: Any) -> tuple[Tensor | None, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        nodes, tensions, _ = derivatives
        found = ctx.simulation.adjoint(ctx.pose, nodes.numpy(), tensions=tensions.numpy())
        routes = np.concatenate([np.zeros((0, nodes.shape[1])), *found.routes])
        values = found.contractions, found.slack, routes, found.young, found.poisson
        grads = (
            None if shape is None else torch.as_tensor(value, dtype=torch.float64).reshape(shape)
            for value, shape in zip(values, ctx.shapes, strict=True)
        )
        return None, None, *grads


def _plain(tensor: Tensor) -> Tensor:
    return tensor.to("cpu", torch.float64)


def _check_routes(robot: Robot, routes: Sequence[Tensor]) -> None:
    wanted = [(len(cable.points), robot.body.mesh.dim) for cable in robot.cables]
    for route in routes:
        check_type(route, Tensor, "routes must be tensors of points [m], one for each cable")
    given = [tuple(route.shape) for route in routes]
    if given != wanted:
        raise InputError(f"routes must hold the points of each cable, of shapes {wanted}, not {given}")


def _alter_robot(
    robot: Robot,
    slack: np.ndarray | None,
    routes: np.ndarray | None,
    young: np.ndarray | None,
    poisson: np.ndarray | None,
) -> Robot:
    """Robot with other numbers.

    Raises:
        InputError: numbers that it refuses.
    """
    cables = robot.cables
    if slack is not None:
        if slack.shape != (len(cables),):
            raise InputError(f"slack must be a number for each of the {len(cables)} cables, not of shape {slack.shape}")
        cables = tuple(replace(cable, slack=float(value)) for cable, value in zip(cables, slack, strict=True))
    if routes is not None:
        ends = np.cumsum([len(cable.points) for cable in cables])
        parts = np.split(routes, ends[:-1])
        cables = tuple(
            replace(cable, points=tuple(tuple(point) for point in part.tolist()))
            for cable, part in zip(cables, parts, strict=True)
        )
    moduli = {
        name: _number(name, value) for name, value in (("young", young), ("poisson", poisson)) if value is not None
    }
    body = (
        replace(robot.body, material=replace(robot.body.material, **moduli, young_interval=None))
        if moduli
        else robot.body
    )
    winches = robot.winches if routes is None else _moved_winches(robot, cables)
    return replace(robot, body=body, cables=cables, winches=winches)


def _number(name: str, value: np.ndarray) -> float:
    if value.size != 1:
        raise InputError(f"{name} must be one number, not {value.size}")
    return float(value.reshape(()))


def _moved_winches(robot: Robot, cables: Sequence[Cable]) -> tuple[Winch, ...]:
    """Winches, those in the world at the first point of their first cable."""
    first = {cable.winch: cable.points[0] for cable in reversed(cables)}
    return tuple(
        replace(winch, at=first.get(winch.name, winch.at)) if winch.mount is Mount.WORLD else winch
        for winch in robot.winches
    )
