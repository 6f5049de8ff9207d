"""Bodies of quadratic elements bend as they should, at any Poisson's ratio.

Oracles: Timoshenko's beam; finite flexure in one dimension (flexure.py) for a strip pulled by its cable; a finer mesh.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import FOAM, box_mesh, box_robot, mesh_body, strip_mesh, strip_robot
from flexure import curvature
from scipy.sparse.linalg import splu
from touching import fork_robot

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, find_crossings
from hydrostat.mechanics import Assembly, NeoHookean, QuadraticSolid
from hydrostat.robot import (
    Cable,
    ElementKind,
    Load,
    Marker,
    Material,
    Pin,
    PronyTerm,
    Robot,
    Volume,
    Winch,
    robot_text,
    sketch_robot,
)
from hydrostat.simulation import ContractionProfile, Simulation
from hydrostat.simulation.mesh_error import estimate_stiffening

HEIGHT, LENGTH, OFFSET, THICKNESS = 0.02, 0.16, 0.005, 0.03
RATIOS = (0.0, 0.3, 0.45, 0.49, 0.499)


def bar(dim: int, rows: int, length: float) -> Mesh:
    columns = round(length / HEIGHT * rows)
    if dim == 3:
        return box_mesh((columns, rows, rows), size=(length, HEIGHT, HEIGHT))
    return strip_mesh(columns, rows, size=(length, HEIGHT))


def sag(mesh: Mesh, poisson: float, *, quadratic: bool = True) -> float:
    """Work of a cantilever's weight over Timoshenko's, less 1; its root is free to become thicker or thinner."""
    dim, length = mesh.dim, float(mesh.nodes[:, 0].max())
    mu, lame = replace(FOAM, poisson=poisson).lame
    if quadratic:
        mesh = mesh.to_quadratic()
        energy = QuadraticSolid(mesh.nodes, mesh.quadratic, mu=mu, lame=lame)
    else:
        energy = NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=lame)
    hessian = Assembly([energy], rest=mesh.nodes, control_count=0).hessian(mesh.nodes, np.zeros(0))
    weight = np.zeros_like(mesh.nodes)
    np.add.at(weight[:, 1], mesh.elements, np.repeat(mesh.volumes[:, None] / (dim + 1), dim + 1, 1))
    aside = np.abs(mesh.nodes - [0.0, *mesh.nodes.mean(axis=0)[1:]])
    held = np.zeros(weight.shape, dtype=bool)
    held[aside[:, 0] < 1e-9, 0] = True
    held[np.argmin(aside.sum(axis=1))] = True
    if dim == 3:
        held[np.argmin(aside[:, 0] + aside[:, 1] - aside[:, 2]), 1] = True
    free, right = ~held.ravel(), weight.ravel()
    work = float(right[free] @ splu(hessian[free][:, free].tocsc()).solve(right[free]))
    young, width = (FOAM.young, HEIGHT) if dim == 3 else (FOAM.young / (1 - poisson**2), 1.0)
    area = HEIGHT * width
    bending, shearing = young * area * HEIGHT**2 / 12, 5 / 6 * mu * area
    return work / (area**2 * (length**5 / (20 * bending) + length**3 / (3 * shearing))) - 1


@pytest.mark.parametrize("poisson", RATIOS)
@pytest.mark.slow
def test_a_bar_of_two_elements_bends_like_a_beam(poisson: float) -> None:
    """Within 2 % and the theory's own share, which is 0.4 % in this slender bar."""
    for dim in (2, 3):
        assert abs(sag(bar(dim, 2, 16 * HEIGHT), poisson)) < 0.024


def test_linear_elements_would_fail() -> None:
    """The check can fail: four linear elements across, which have as many nodes."""
    assert sag(bar(3, 4, 8 * HEIGHT), 0.3, quadratic=False) < -0.15
    assert sag(bar(3, 4, 8 * HEIGHT), 0.499, quadratic=False) < -0.8


@pytest.mark.parametrize("poisson", [0.3, 0.499])
def test_order_of_convergence(poisson: float) -> None:
    """Second order at least: the weight that stands at nodes has it, and the mean volume."""
    errors = np.array([sag(bar(2, rows, 8 * HEIGHT), poisson) for rows in (1, 2, 4)])
    one, two = np.abs(np.diff(errors))
    assert np.log2(one / two) > 1.8


@cache
def bent(rows: int, poisson: float) -> float:
    """Curvature of the middle half of a strip with a cable, over that of finite flexure at its tension, less 1."""
    mesh = strip_mesh(round(LENGTH / HEIGHT * rows), rows, size=(LENGTH, HEIGHT))
    along = np.linspace(0, LENGTH, round(LENGTH / HEIGHT * 4 * rows) + 1)
    points = tuple((float(x), -OFFSET) for x in along)
    material = replace(FOAM, poisson=poisson)
    robot = Robot(
        name="beam",
        body=mesh_body(mesh, thickness=THICKNESS, material=material).with_elements("quadratic"),
        pins=(Pin(at=(0.0, 0.0)), Pin(at=(0.0, HEIGHT / 4))),
        winches=(Winch(name="only", at=points[0]),),
        cables=(Cable(winch="only", points=points),),
        poses={},
    )
    pose, nodes = Simulation(robot).solve([0.015]), robot.body.mesh.nodes
    order = np.lexsort(nodes.T.round(9))
    shape = (2 * rows + 1, -1, 2)
    rest, now = nodes[order].reshape(shape), pose.nodes[order].reshape(shape)
    slopes = np.einsum("r,rcd->cd", rest[:, 0, 1], now)
    turns = np.unwrap(np.arctan2(slopes[:, 0], slopes[:, 1]))
    middle = np.abs(rest[0, :, 0] - LENGTH / 2) <= LENGTH / 4 + 1e-9
    found = float(np.polyfit(rest[0, middle, 0], turns[middle], 1)[0])
    mu, lame = material.lame
    tension = float(pose.tensions[0])
    return found / curvature(tension, height=HEIGHT, offset=OFFSET, thickness=THICKNESS, mu=mu, lame=lame) - 1


@pytest.mark.parametrize("poisson", [0.3, 0.45, 0.49])
@pytest.mark.slow
def test_a_strip_follows_finite_flexure(poisson: float) -> None:
    """Bent by far, of two elements across; 4 of them are nearer."""
    assert abs(bent(2, poisson)) < 0.03
    assert abs(bent(4, poisson)) < abs(bent(2, poisson))


@pytest.mark.parametrize("dim", [2, 3])
def test_prongs_meet_and_do_not_cross(dim: int) -> None:
    """Contact, cables and pins at nodes in the middle of edges."""
    robot = fork_robot(dim)
    touching = Simulation(replace(robot, body=robot.body.with_elements("quadratic")))
    pose = touching.solve({"up": 0.02, "down": 0.016})
    assert pose.result.stable
    assert len(find_crossings(touching.robot.body.mesh, pose.nodes)) == 0
    assert np.abs(touching.forces(pose.nodes, pose.contractions)).max() <= pose.result.allowed


@pytest.mark.parametrize("make", [strip_robot, box_robot])
def test_the_jacobian_is_the_derivative(make) -> None:
    """Oracle: central differences of whole solves."""
    robot = make()
    body = replace(robot.body, material=replace(FOAM, poisson=0.49)).with_elements("quadratic")
    simulation = Simulation(replace(robot, body=body))
    goal, step = np.array([0.01, 0.002]), 1e-6
    jacobian = simulation.jacobian(simulation.solve(goal))
    for winch in range(2):
        ahead, behind = (simulation.solve(goal + sign * step * np.eye(2)[winch]).nodes for sign in (1, -1))
        found = (ahead - behind) / (2 * step)
        assert np.abs(jacobian[:, :, winch] - found).max() < 1e-5 * np.abs(found).max()


def test_motion_comes_to_rest_where_statics_is() -> None:
    """Oracle: the static pose, for a viscous body with a Maxwell branch."""
    robot = strip_robot(columns=8, rows=2)
    branch = PronyTerm(modulus=5e3, time=0.05)
    material = Material(young=30e3, poisson=0.45, density=40.0, viscosity=100.0, relaxation=(branch,))
    simulation = Simulation(replace(robot, body=replace(robot.body, material=material).with_elements("quadratic")))
    goal = np.array([0.01, 0.0])
    *_, end = simulation.play(ContractionProfile.ramp(goal, 0.2), 3.0, 0.1)
    pose, rest = simulation.solve(goal), simulation.robot.body.mesh.nodes
    assert np.abs(end.nodes - pose.nodes).max() < 1e-3 * np.abs(pose.nodes - rest).max()


def test_elements_fit_the_mesh() -> None:
    body = mesh_body(strip_mesh(4, 2))
    quadratic = body.with_elements("quadratic")
    assert quadratic.with_elements("linear") == body
    assert quadratic.mass == pytest.approx(body.mass)
    with pytest.raises(InputError, match="elements do not fit the mesh"):
        replace(body, elements=ElementKind.QUADRATIC)
    with pytest.raises(InputError, match="for linear elements"):
        replace(body, volume=Volume.PATCH).with_elements("quadratic")


@pytest.mark.parametrize(("dim", "poisson"), [(2, 0.3), (3, 0.3), (2, 0.49), (3, 0.49)])
def test_the_note_of_linear_elements_is_a_lower_bound(dim: int, poisson: float) -> None:
    """Oracle: energy of the same robot of quadratic elements; none is noted for these, nor for a stretch."""
    robot = (strip_robot if dim == 2 else box_robot)()
    body = replace(robot.body, material=replace(FOAM, poisson=poisson))
    linear, quadratic = (Simulation(replace(robot, body=each)) for each in (body, body.with_elements("quadratic")))
    pose, exact = linear.solve([0.01, 0.0]), quadratic.solve([0.01, 0.0])
    excess = pose.energy / exact.energy - 1
    assert 0.1 * excess < estimate_stiffening(body, pose.nodes) < 1.2 * excess
    assert estimate_stiffening(body, body.mesh.nodes * 1.1) < 1e-9
    noise = 1e-9 * np.random.default_rng(0).standard_normal(body.mesh.nodes.shape)
    assert estimate_stiffening(body, body.mesh.nodes + noise) == 0.0  # rounding has no excess
    assert exact.notes == ()
    assert 'elements = "quadratic"' in "".join(pose.notes) or excess < 0.3


@pytest.mark.parametrize("asked", [{}, {"nodes": 200}], ids=str)
def test_a_slender_sketch_bends_right(asked: dict[str, float]) -> None:
    """Oracle: Timoshenko's deflection. Linear elements with these corners bend 0.29 of it."""
    length, height, poisson = 0.2, 0.012, 0.49
    drawing = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="12mm" viewBox="0 0 200 12">'
        '<rect width="200" height="12"/></svg>'
    )
    sketch = sketch_robot(drawing.encode(), file="bar.svg", name="bar", material="ecoflex 00-30", **asked)
    assert sketch.body.elements == "quadratic"
    assert len(sketch.body.mesh.nodes) < 500
    assert 'elements = "quadratic"' in robot_text(sketch)
    young = sketch.body.material.young / (1 - poisson**2)
    inertia = (sketch.body.thickness or 0.0) * height**3 / 12
    force, shear = 6e-3 * young * inertia / length**2, young * (1 - poisson) / 2
    wanted = force * length**3 / (3 * young * inertia)
    wanted += force * length / (5 / 6 * shear * height * (sketch.body.thickness or 0.0))
    held = replace(
        sketch,
        pins=(Pin(box=((-0.101, -0.01), (-0.0999, 0.01)), stiffness=1e7),),
        markers=(Marker(name="tip", at=(0.0999, 0.0)),),
        loads=(Load(name="push", marker="tip", force=(0.0, -force)),),
        poses={},
    )
    assert -Simulation(held).solve({}).markers["tip"][1] == pytest.approx(wanted, rel=0.02)
