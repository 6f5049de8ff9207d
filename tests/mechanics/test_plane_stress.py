"""Plane stress. Oracles: central differences, a solid in space that chose its stretch across, Bernoulli's beam."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import FOAM, box_mesh, gallery_robot, mesh_body, strip_mesh, strip_robot
from scipy.optimize import minimize_scalar

from hydrostat.errors import InputError
from hydrostat.mechanics import Assembly, NeoHookean, solve_thickening
from hydrostat.robot import Cable, Pin, Plane, Robot, Volume, Winch, find_risks, load_robot, save_robot
from hydrostat.simulation import BodyPhysics, Simulation, node_stresses
from hydrostat.testing import check_energy

NONE = np.zeros(0)


def sheet(poisson: float, kind: str, *, plane: Plane = Plane.STRESS) -> Robot:
    """A strip of linear or quadratic elements."""
    robot = strip_robot(columns=6, rows=2)
    material = replace(FOAM, poisson=poisson)
    body = replace(robot.body, material=material, plane=plane).with_elements(kind)
    return replace(robot, body=body)


def energies(robot: Robot) -> Assembly:
    """Elastic energy of the body alone."""
    physics = BodyPhysics(robot)
    return Assembly([physics.elastic], rest=physics.rest_unknowns, control_count=0)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.499])
@pytest.mark.parametrize("kind", ["linear", "quadratic"])
def test_energy_keeps_its_contract(kind: str, poisson: float) -> None:
    robot = sheet(poisson, kind)
    (energy,) = energies(robot).energies
    random = np.random.default_rng(0)
    for stretches in ((1.4, 0.9), (0.7, 0.8)):
        nodes = robot.body.mesh.nodes
        check_energy(energy, nodes * stretches + 0.002 * random.uniform(-1, 1, nodes.shape), NONE)


@pytest.mark.parametrize("stretches", [(1.5, 0.8), (0.6, 1.1), (1.3, 1.4), (0.8, 0.7)])
@pytest.mark.parametrize("kind", ["linear", "quadratic"])
def test_a_sheet_is_a_plate_that_chose_its_thickness(kind: str, stretches: tuple[float, float]) -> None:
    """Oracle: the least energy of a box over its stretch across, found by a search."""
    robot, size = sheet(0.45, kind), (0.2, 0.05, 0.03)
    mu, lame = robot.body.material.lame
    box = box_mesh((2, 1, 1), size=size)
    solid = NeoHookean(box.nodes, box.elements, mu=mu, lame=lame)
    least = minimize_scalar(lambda s: solid.value(box.nodes * [*stretches, s], NONE), bounds=(0.3, 3), method="bounded")
    nodes = robot.body.mesh.nodes
    assert energies(robot).value(nodes * stretches, NONE) == pytest.approx(least.fun, rel=1e-8)
    area = np.array([np.prod(stretches) - 1])
    assert np.sqrt(1 + solve_thickening(area, np.array([mu]), np.array([lame])))[0] == pytest.approx(least.x, rel=1e-4)


@pytest.mark.parametrize("kind", ["linear", "quadratic"])
def test_a_sheet_pulled_beyond_reason_has_finite_forces(kind: str) -> None:
    """Oracle: nothing is NaN where the area is 1e-8 to 1e16 times that at rest."""
    robot = sheet(0.45, kind)
    for stretch in (1e-4, 1e4, 1e8):
        nodes, energy = robot.body.mesh.nodes * stretch, energies(robot)
        assert np.isfinite(energy.value(nodes, NONE))
        assert np.isfinite(energy.gradient(nodes, NONE)).all()
        assert np.isfinite(energy.hessian(nodes, NONE).data).all()


def test_stress_of_a_sheet_that_is_pulled() -> None:
    """Oracle: mu (l^2 - 1/l) of an incompressible bar, whose stretches across are equal."""
    robot, length = sheet(0.4999, "linear"), 1.3
    stresses = node_stresses(robot, robot.body.mesh.nodes * [length, length**-0.5])
    mu, _ = robot.body.material.lame
    assert stresses == pytest.approx(np.full(len(stresses), mu * (length**2 - 1 / length)), rel=1e-3)


@pytest.mark.parametrize("poisson", [0.3, 0.49])
def test_a_sheet_bends_easier(poisson: float) -> None:
    """Oracle: pure bending, exact for quadratic elements: 1 - nu^2 of the energy of plane strain."""
    found = []
    for plane in Plane:
        robot = sheet(poisson, "quadratic", plane=plane)
        x, y = robot.body.mesh.nodes.T
        ratio = poisson if plane is Plane.STRESS else poisson / (1 - poisson)
        moved = np.column_stack([-x * y, (x**2 + ratio * y**2) / 2]).ravel()
        found.append(moved @ (energies(robot).hessian(robot.body.mesh.nodes, NONE) @ moved))
    assert found[0] > found[1]
    assert found[1] == pytest.approx(FOAM.young * 0.03 * 0.05**3 / 12 * 0.2, rel=1e-6)


@pytest.mark.parametrize("poisson", [0.3, 0.45])
def test_a_cable_pulls_as_hard_as_in_space(poisson: float) -> None:
    """Oracle: the same bar as a body in space, 30 mm thick and 50 wide, with a cable near each face.

    Plane strain pulls by 14 and 29 % harder.
    """
    harder = {0.3: 1.14, 0.45: 1.285}[poisson]
    thick, route = 0.03, [(0.02, 0.015), (0.03, 0.015), (0.08, 0.015), (0.14, 0.015), (0.19, 0.015)]
    box = box_mesh((16, 4, 2), size=(0.2, 0.05, thick))
    solid = mesh_body(replace(box, nodes=box.nodes - [0.0, 0.025, thick / 2]))
    flat, tensions = strip_robot().body, []
    planes = [(replace(flat, thickness=thick, plane=plane), [()]) for plane in (Plane.STRESS, Plane.STRAIN)]
    for body, faces in (*planes, (solid, [(0.0105,), (-0.0105,)])):
        winch = (*route[0], *(0.0,) * len(faces[0]))
        far = (1.0,) * (2 + len(faces[0]))
        robot = Robot(
            name="bar",
            body=replace(body, material=replace(FOAM, poisson=poisson)).with_elements("quadratic"),
            pins=(Pin(box=((-0.001, *(-1.0 for _ in far[1:])), (0.001, *far[1:])), stiffness=1e6),),
            winches=(Winch(name="up", at=winch),),
            cables=tuple(
                Cable(winch="up", points=(winch, *((*point, *face) for point in route[1:]))) for face in faces
            ),
            markers=(),
            poses={},
        )
        tensions.append(float(Simulation(robot).solve([0.01]).tensions.sum()))
    assert tensions[0] == pytest.approx(tensions[2], rel=0.05)
    assert tensions[1] == pytest.approx(harder * tensions[2], rel=0.01)


@pytest.mark.parametrize("kind", ["linear", "quadratic"])
def test_slopes_by_the_material(kind: str) -> None:
    """Oracle: central differences of whole solves."""
    robot = sheet(0.42, kind)
    simulation = Simulation(robot)
    pose = simulation.solve([0.012, 0.0])
    weights = np.random.default_rng(1).standard_normal(pose.nodes.shape)
    found = simulation.adjoint(pose, weights, tensions=np.ones(2))

    def loss(**numbers: float) -> float:
        other = Simulation(replace(robot, body=replace(robot.body, material=replace(robot.body.material, **numbers))))
        near = other.solve([0.012, 0.0], start=pose)
        return float((weights * near.nodes).sum() + near.tensions.sum())

    for name, step in (("young", 30.0), ("poisson", 1e-4)):
        value = getattr(robot.body.material, name)
        slope = (loss(**{name: value + step}) - loss(**{name: value - step})) / (2 * step)
        assert getattr(found, name) == pytest.approx(slope, rel=1e-4)


def test_the_key_is_kept_and_refused_where_it_has_no_meaning(tmp_path: Path) -> None:
    star = gallery_robot("starfish")
    flat = replace(star, body=replace(star.body, plane=Plane.STRESS))
    save_robot(flat, tmp_path)
    assert load_robot(tmp_path) == flat
    assert load_robot(tmp_path).body.plane is Plane.STRESS
    rubber = replace(star.body, material=replace(star.body.material, poisson=0.49))
    assert any("lock" in risk for risk in find_risks(replace(star, body=rubber)))
    assert not any("lock" in risk for risk in find_risks(replace(star, body=replace(rubber, plane=Plane.STRESS))))
    with pytest.raises(InputError, match="for flat bodies"):
        replace(mesh_body(box_mesh((1, 1, 1))), plane=Plane.STRESS)
    with pytest.raises(InputError, match="plane stress does not lock"):
        replace(mesh_body(strip_mesh(2, 2)), plane=Plane.STRESS, volume=Volume.PATCH)
