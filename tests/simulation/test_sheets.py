"""Sheets on a body. Oracles: minimization of a solid's energy by SciPy, composite sections, differences."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh
from scipy.optimize import minimize

from hydrostat.mechanics import SheetEnergy
from hydrostat.robot import Load, Marker, Material, Membrane, Pin, Robot
from hydrostat.simulation import Simulation

LENGTH, WIDTH, THICKNESS = 0.1, 0.01, 1e-4
SOFT = Material(young=50e3, poisson=0.0, density=1.0)
SKIN = Material(young=5e6, poisson=0.0, density=1000.0)


def solid_energy(stretches: np.ndarray, mu: float, lame: float) -> float:
    """Neo-Hookean energy of a block of 1 m^3 [J]."""
    change = float(np.log(stretches).sum())
    return 0.5 * mu * float((stretches**2).sum() - 3) - mu * change + 0.5 * lame * change**2


@pytest.mark.parametrize("wrinkles", [False, True])
@pytest.mark.parametrize("stretches", [(1.4, 1.1), (1.4, 0.95), (1.4, 0.7), (0.8, 0.9)])
def test_a_sheet_is_a_thin_solid_without_stress_across(stretches: tuple[float, float], wrinkles: bool) -> None:
    """Where it wrinkles its own stretches may be larger than those of the body, as tension field theory has it."""
    mu, lame = 3.0, 5.0
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    given = {"lame": (mu, lame), "thickness": 0.1, "wrinkles": wrinkles}
    sheet = SheetEnergy(nodes, np.array([[0, 1, 2], [0, 2, 3]]), **given)
    turn = np.linalg.qr(np.random.default_rng(4).standard_normal((3, 3)))[0]
    bounds = [(value, None if wrinkles else value) for value in stretches] + [(0.1, 3.0)]
    best = minimize(solid_energy, [*stretches, 1.0], args=(mu, lame), bounds=bounds, options={"ftol": 1e-15})
    moved = nodes * [*stretches, 1.0] @ turn.T + 0.3
    assert sheet.value(moved, np.zeros(0)) == pytest.approx(0.1 * best.fun, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize(("plane", "free"), [("strain", 0.0), ("stress", 1.0)])
def test_a_strip_on_the_outline_is_as_wide_as_its_body(plane: str, free: float) -> None:
    mu, lame, stretch = 3.0, 5.0, 1.3
    nodes, edge = np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[0, 1]])
    strip = SheetEnergy(
        nodes, edge, lame=(mu, lame), thickness=0.1, width=2.0, is_held_across=plane == "strain", wrinkles=True
    )
    bounds = [(stretch, stretch), (0.3 if free else 1.0, 1.0), (0.1, 1.0)]
    best = minimize(solid_energy, [stretch, 1.0, 1.0], args=(mu, lame), bounds=bounds, options={"ftol": 1e-15})
    assert strip.value(nodes * stretch, np.zeros(0)) == pytest.approx(0.2 * best.fun, rel=1e-6)
    assert strip.value(nodes * 0.9, np.zeros(0)) == 0.0


def bar(dim: int, count: int, gravity: tuple[float, ...], *, kind: str = "quadratic") -> Robot:
    """A bar clamped at its left end, with a sheet all around but at its ends."""
    if dim == 3:
        body = mesh_body(box_mesh((5 * count, count, count), size=(LENGTH, WIDTH, WIDTH)), material=SOFT)
    else:
        mesh = strip_mesh(5 * count, count, size=(LENGTH, WIDTH))
        body = replace(mesh_body(mesh, material=SOFT), thickness=WIDTH)
    far = (1.0,) * (dim - 1)
    low = tuple(-value for value in far)
    return Robot(
        name="bar",
        body=body.with_elements(kind),
        pins=(Pin(box=((-1e-6, *low), (1e-6, *far)), stiffness=1e8),),
        markers=(Marker(name="tip", at=(LENGTH, *((WIDTH / 2,) * (dim - 1)))),),
        poses={},
        gravity=gravity,
        sheets=(
            Membrane(
                name="skin", material=SKIN, thickness=THICKNESS, shape="box", at=(1e-6, *low), to=(LENGTH - 1e-6, *far)
            ),
        ),
    )


AREA = 4 * WIDTH * THICKNESS
WEIGHT = 0.01 * (SOFT.density * WIDTH**2 + SKIN.density * AREA)
"""Per length [N/m]."""
STRETCH = WEIGHT * LENGTH**2 / 2 / (SOFT.young * WIDTH**2 + SKIN.young * AREA)
SECTION = SOFT.young * WIDTH**4 / 12 + SKIN.young * 2 * THICKNESS * (WIDTH**3 / 4 + WIDTH**3 / 12)
BEND = WEIGHT * LENGTH**4 / 8 / SECTION


@pytest.mark.parametrize("dim", [2, 3])
def test_a_bar_with_a_skin_is_stretched_as_its_composite_section(dim: int) -> None:
    """Its weight is that of the skin, nearly."""
    tip = Simulation(bar(dim, 2, (0.01, 0.0, 0.0)[:dim], kind="linear")).solve([]).markers["tip"]
    assert tip[0] - LENGTH == pytest.approx(STRETCH, rel=0.005)


def test_a_bar_with_a_skin_bends_as_its_composite_section() -> None:
    """The error falls with the square of the element size; without effect sideways a flat bar is one in space."""
    tips = [Simulation(bar(2, count, (0.0, 0.01))).solve([]).markers["tip"][1] for count in (1, 2, 4)]
    errors = 1 - (np.array(tips) - WIDTH / 2) / BEND
    assert errors == pytest.approx([0.283, 0.077, 0.006], abs=0.002)
    deep = Simulation(bar(3, 2, (0.0, 0.0, 0.01))).solve([]).markers["tip"][2]
    assert deep == pytest.approx(tips[1], abs=0.005 * BEND)


def test_sensitivities_of_a_sheet_are_differences_of_poses() -> None:
    """By Young's modulus of the sheet, and by the thickness of the body, with which its strip grows."""
    robot = replace(bar(2, 2, (0.0, 3.0)), loads=(Load(name="p", marker="tip", force=(0.02, 0.05)),))
    robot = replace(robot, sheets=(replace(robot.sheets[0], material=replace(SKIN, young=2e5, poisson=0.3)),))
    simulation = Simulation(robot)
    pose = simulation.solve([])
    anchors, cotangent = simulation.marker_anchors, np.zeros_like(pose.nodes)
    np.add.at(cotangent[:, 1], anchors.stencils[0], anchors.weights[0])
    found = simulation.adjoint(pose, cotangent)

    def slope(change: Callable[[float], Robot]) -> float:
        ends = [Simulation(change(1 + step)).solve([]).markers["tip"][1] for step in (1e-4, -1e-4)]
        return (ends[0] - ends[1]) / 2e-4

    sheet = robot.sheets[0]
    stiffer = slope(
        lambda factor: replace(
            robot, sheets=(replace(sheet, material=replace(sheet.material, young=factor * sheet.material.young)),)
        )
    )
    assert found.sheet_young[0] * sheet.material.young == pytest.approx(stiffer, rel=1e-5)
    weightless = replace(robot, gravity=None)
    simulation = Simulation(weightless)
    by_thickness = simulation.adjoint(simulation.solve([]), cotangent).thickness
    assert by_thickness is not None
    thicker = slope(lambda factor: replace(weightless, body=replace(robot.body, thickness=factor * WIDTH)))
    assert by_thickness * WIDTH == pytest.approx(thicker, rel=1e-5)
