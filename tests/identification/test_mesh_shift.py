"""Shifts of fitted values by finer meshes. Oracle: the same body with elements of half the size."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.identification import named_model
from hydrostat.identification.identified_robot import start_of
from hydrostat.identification.mesh_shift import soften_cables
from hydrostat.robot import BodyPart, Cable, Mount, Pin, Robot, Winch
from hydrostat.simulation import Simulation

BOX = (0.1, 0.05, 0.05)
ROUTES = {
    "straight": ((0.013, 0.0037), (0.1, 0.004), (0.187, 0.0037)),
    "bent": ((0.013, 0.0037), (0.1, 0.014), (0.187, -0.0037)),
}


SHEATHED = {"sheathed": ((1, 2),)}
ROUTES["sheathed"] = ROUTES["straight"]


def strip(cells: int, route: str, points: tuple[tuple[float, ...], ...] | None = None) -> Robot:
    points = ROUTES[route] if points is None else points
    cable = Cable(winch="w", points=points, stiffness=1e9, smoothing=1e-7, sheathed=SHEATHED.get(route, ()))
    flat = len(points[0]) == 2
    mesh = strip_mesh(4 * cells, cells, size=(0.2, 0.05)) if flat else box_mesh((2 * cells, cells, cells), size=BOX)
    low, high = ((end,) + (end * 1e3,) * (len(points[0]) - 1) for end in (-1e-3, 1e-3))
    return Robot(
        name="strip",
        body=mesh_body(mesh),
        pins=(Pin(box=(low, high), stiffness=1e5),),
        winches=(Winch(name="w", at=cable.points[0], travel=0.02),),
        cables=(cable,),
        markers=(),
        poses={},
    )


def compliance(robot: Robot) -> float:
    """Length that a cable takes in per newton [m/N]."""
    pull = 2e-4
    return float(pull / Simulation(robot).solve([pull]).tensions[0])


@pytest.mark.parametrize("route", ROUTES)
def test_dents_grow_as_elements_are_halved(route: str) -> None:
    """A cable takes in more per newton; of two halvings, as bending converges with the first."""
    coarse, fine = (compliance(strip(cells, route)) for cells in (4, 16))
    softer = soften_cables(strip(4, route)).cables[0]
    assert 2 * (1 / softer.stiffness - 1e-9) == pytest.approx(fine - coarse, rel=0.25)


def test_stiff_bodies_and_winches_in_the_world_have_no_dents() -> None:
    robot = strip(2, "straight")
    world = replace(robot, winches=(replace(robot.winches[0], mount=Mount.WORLD),))
    assert soften_cables(world).cables[0].stiffness > 1.5 * soften_cables(robot).cables[0].stiffness
    stiff = replace(robot, body=replace(robot.body, material=replace(robot.body.material, young=1e15)))
    assert soften_cables(stiff).cables[0].stiffness == pytest.approx(1e9, rel=1e-3)


def test_dents_in_space_are_of_the_size_that_is_told() -> None:
    """Of one halving, on the axis of a box: within a factor of two, as elements differ in shape."""
    robots = [strip(cells, "", ((0.02, 0.024, 0.026), (0.08, 0.024, 0.026))) for cells in (4, 8)]
    grown = compliance(robots[1]) - compliance(robots[0])
    assert 0.5 < (1 / soften_cables(robots[0]).cables[0].stiffness - 1e-9) / grown < 2.0


def test_rigid_disks_have_no_dents() -> None:
    """A cable between two rigid disks that are one element thick."""
    robot = strip(4, "", ((0.0125 / 2, 0.02), (0.2 - 0.0125 / 2, 0.02)))
    disks = [(0.0, 0.0125), (0.1875, 0.2)]
    parts = tuple(
        BodyPart(name=f"disk {low}", shape="box", at=(low, -1.0), to=(high, 1.0), density=1e3) for low, high in disks
    )
    held = replace(robot, body=replace(robot.body, parts=parts))
    assert soften_cables(held).cables[0].stiffness > 1e3 * soften_cables(robot).cables[0].stiffness


@pytest.mark.parametrize(
    ("shifts", "build", "ends", "low", "high"),
    [
        ([[0.0]], 0.0, None, -0.98, 0.98),
        ([[3.0], [1.2]], 0.0, None, -0.98, 1.5 + 1.96 * 3 / 12**0.5),
        ([[-1.0], [2.0]], 0.25, None, 0.5 - 1.96, 0.5 + 1.96),
        ([[0.6], [0.3]], 0.0, (-2.0, 0.1), -2.0, 0.3 + 1.96 * 0.6 / 12**0.5),
    ],
    ids=["residuals alone", "one side", "both sides", "profiled"],
)
def test_intervals_are_the_hull_of_residuals_and_hidden_errors(
    shifts: list[list[float]], build: float, ends: tuple[float, float] | None, low: float, high: float
) -> None:
    """Oracle: ends by hand, for residuals with a standard deviation of a half; a uniform range has a twelfth."""
    model = named_model(strip(1, "straight"), ("gain",))
    (parameter,) = model.parameters
    fitted = replace(
        start_of(model),
        covariance=np.array([[0.25]]),
        spread=1.0,
        mesh_shift=np.array(shifts),
        build_variance=np.array([build]),
        ends=None if ends is None else np.array(ends)[:, None],
    )
    assert fitted.intervals[parameter.name] == pytest.approx((parameter.from_fitted(low), parameter.from_fitted(high)))
