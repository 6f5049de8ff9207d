"""Shifts of fitted values by finer meshes. Oracle: the same body with elements of half the size."""

from dataclasses import replace

import pytest
from builders import mesh_body, strip_mesh

from hydrostat.identification.mesh_shift import soften_cables
from hydrostat.robot import Cable, Mount, Pin, Robot, Winch
from hydrostat.simulation import Simulation

ROUTES = {
    "straight": ((0.013, 0.0037), (0.1, 0.004), (0.187, 0.0037)),
    "bent": ((0.013, 0.0037), (0.1, 0.014), (0.187, -0.0037)),
}


def strip(cells: int, route: str) -> Robot:
    cable = Cable(winch="w", points=ROUTES[route], stiffness=1e9, smoothing=1e-7)
    return Robot(
        name="strip",
        body=mesh_body(strip_mesh(4 * cells, cells, size=(0.2, 0.05))),
        pins=(Pin(box=((-1e-3, -1.0), (1e-3, 1.0)), stiffness=1e5),),
        winches=(Winch(name="w", at=cable.points[0], travel=0.02),),
        cables=(cable,),
        markers=(),
        poses={},
    )


@pytest.mark.parametrize("route", ROUTES)
def test_dents_grow_as_elements_are_halved(route: str) -> None:
    """A cable takes in more per newton; of two halvings, as bending converges with the first."""
    pull = 2e-4
    coarse, fine = (pull / Simulation(strip(cells, route)).solve([pull]).tensions[0] for cells in (4, 16))
    softer = soften_cables(strip(4, route)).cables[0]
    assert 2 * (1 / softer.stiffness - 1e-9) == pytest.approx(fine - coarse, rel=0.25)


def test_stiff_bodies_and_winches_in_the_world_have_no_dents() -> None:
    robot = strip(2, "straight")
    world = replace(robot, winches=(replace(robot.winches[0], mount=Mount.WORLD),))
    assert soften_cables(world).cables[0].stiffness > 1.5 * soften_cables(robot).cables[0].stiffness
    stiff = replace(robot, body=replace(robot.body, material=replace(robot.body.material, young=1e15)))
    assert soften_cables(stiff).cables[0].stiffness == pytest.approx(1e9, rel=1e-3)
