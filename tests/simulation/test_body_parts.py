"""Bodies of several materials. Oracles: bars in parallel and in series, a moved rigid body, one energy a material."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_mesh
from scipy.spatial.distance import pdist

from hydrostat.mechanics import PATCH_SIZE, NeoHookean, grow_patches
from hydrostat.robot import BodyPart, Cable, FoamTerm, Material, Mount, Pin, Plane, Robot, Volume, Winch
from hydrostat.simulation import Simulation, StepOptions

SOFT = Material(young=30e3, poisson=0.0, density=40.0)
HARD = Material(young=120e3, poisson=0.0, density=400.0)
LENGTH, WIDTH, THICKNESS = 0.2, 0.05, 0.03


def strip(*parts: BodyPart, gravity: tuple[float, float] | None = None) -> Robot:
    """A strip of 200 x 50 mm that a cable along its middle pulls at a rigid end plate."""
    body = replace(mesh_body(strip_mesh(16, 4), material=SOFT), parts=parts)
    points = ((-0.05, 0.0), (0.1999, 0.0))
    return Robot(
        name="strip",
        body=body,
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=1e9),),
        winches=(Winch(name="pull", at=points[0], mount=Mount.WORLD),),
        cables=(Cable(winch="pull", points=points, stiffness=1e9),),
        poses={},
        gravity=gravity,
    )


def tension(robot: Robot, squeeze: float) -> float:
    """Tension of the cable at a contraction [N]."""
    return float(Simulation(robot).solve([squeeze]).tensions[0])


def force(material: Material, width: float, stretch: float) -> float:
    """Neo-Hookean bar without Poisson's effect: mu (s - 1/s)."""
    return material.lame[0] * (1 / stretch - stretch) * width * THICKNESS


PLATE = BodyPart(name="plate", shape="box", at=(0.19, -1.0), to=(1.0, 1.0), density=1000.0)


def test_bars_in_parallel_add_their_forces() -> None:
    upper = BodyPart(name="upper", shape="box", at=(-1.0, 0.0), to=(0.1875, 1.0), material=HARD)
    lower = BodyPart(name="lower", shape="box", at=(-1.0, -1.0), to=(0.1875, 0.0), material=HARD)
    free, squeeze = 0.1875, 0.003
    stretch = 1 - squeeze / free
    whole = tension(strip(upper, lower, PLATE), squeeze)
    assert whole == pytest.approx(force(HARD, WIDTH, stretch), rel=2e-3)
    core = BodyPart(name="core", shape="box", at=(-1.0, -0.0125), to=(0.1875, 0.0125), material=HARD)
    both = force(HARD, WIDTH / 2, stretch) + force(SOFT, WIDTH / 2, stretch)
    assert tension(strip(core, PLATE), squeeze) == pytest.approx(both, rel=2e-3)


def test_bars_in_series_have_one_force() -> None:
    far = BodyPart(name="far", shape="box", at=(0.1, -1.0), to=(0.1875, 1.0), material=HARD)
    found = tension(strip(far, PLATE), 0.003)

    def stretch_at(material: Material) -> float:
        ratio = found / (material.lame[0] * WIDTH * THICKNESS)  # 1 / s - s
        return float((np.sqrt(ratio**2 + 4) - ratio) / 2)

    shorter = 0.1 * (1 - stretch_at(SOFT)) + 0.0875 * (1 - stretch_at(HARD))
    assert shorter == pytest.approx(0.003, rel=2e-3)


def test_graded_bars_in_series_have_one_force() -> None:
    """Young's modulus grows along the bar from once to four times; the rigid plate keeps its own."""
    free, squeeze = 0.1875, 0.003
    robot = strip(PLATE).with_grading(lambda points: 1 + 3 * points[:, 0] / free)
    assert robot.body.stiffness_factors[robot.body.element_materials == 1] == pytest.approx(1.0)
    found = tension(robot, squeeze)
    ratios = found / (SOFT.lame[0] * (1 + 3 * np.linspace(0, 1, 1001)) * WIDTH * THICKNESS)
    stretches = (np.sqrt(ratios**2 + 4) - ratios) / 2
    assert np.trapezoid(1 - stretches, np.linspace(0, free, 1001)) == pytest.approx(squeeze, rel=2e-3)


@pytest.mark.parametrize("kind", ["linear", "quadratic", "stress", "patch", "foam"])
def test_graded_bars_in_parallel_add_their_forces(kind: str) -> None:
    """Stiffer towards the sides, twice as stiff in the mean; the adjoint is by all moduli together."""
    foam = Material(young=30e3, poisson=0.0, density=40.0, foam=(FoamTerm(share=1.0, exponent=2.0),))
    material = foam if kind == "foam" else SOFT if kind != "patch" else replace(SOFT, poisson=0.3)
    whole = strip(PLATE)
    body = replace(whole.body, material=material, **({"plane": Plane.STRESS} if kind == "stress" else {}))
    body = replace(body, volume=Volume.PATCH) if kind == "patch" else body
    whole = replace(whole, body=body.with_elements("quadratic") if kind == "quadratic" else body)
    graded = whole.with_grading(lambda points: 1 + 4 * np.abs(points[:, 1]) / WIDTH)
    if kind != "patch":
        assert tension(graded, 0.003) == pytest.approx(2 * tension(whole, 0.003), rel=0.01)
    simulation = Simulation(graded)
    pose = simulation.solve([0.003])
    slopes = simulation.adjoint(pose, np.zeros_like(pose.nodes), tensions=np.ones(1))
    ends = [tension(graded.with_material(young=30e3 * (1 + step)), 0.003) for step in (1e-4, -1e-4)]
    assert slopes.young * 30e3 == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-5)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_rigid_part_moves_as_a_rigid_body(dim: int) -> None:
    mesh = strip_mesh(16, 4) if dim == 2 else box_mesh((8, 3, 3), size=(LENGTH, WIDTH, WIDTH))
    at, to = (0.07, -1.0, -1.0)[:dim], (0.13, 1.0, 1.0)[:dim]
    height = 0.02 if dim == 2 else 0.045
    points = tuple((float(x), height, 0.021)[:dim] for x in (0.01, 0.06, 0.14, 0.19))
    robot = Robot(
        name="bone",
        body=replace(
            mesh_body(mesh), volume=Volume.PATCH, parts=(BodyPart(name="bone", shape="box", at=at, to=to, density=1e3),)
        ),
        pins=(Pin(box=((-0.001, -1.0, -1.0)[:dim], (0.001, 1.0, 1.0)[:dim])),),
        winches=(Winch(name="pull", at=points[0]),),
        cables=(Cable(winch="pull", points=points),),
        poses={},
    )
    pose = Simulation(robot).solve([0.04])
    held = np.unique(mesh.elements[robot.body.element_materials == 1])
    moved, rest = pose.nodes[held], mesh.nodes[held]
    left, _, right = np.linalg.svd((moved - moved.mean(axis=0)).T @ (rest - rest.mean(axis=0)))
    turn = left @ right
    assert np.degrees(np.arccos(np.clip(turn[0, 0], -1, 1))) > 15  # bent by the cable
    assert np.abs(pdist(moved) / pdist(rest) - 1).max() < 2e-4
    soft = Simulation(replace(robot, body=replace(robot.body, parts=()))).solve([0.04]).nodes[held]
    assert np.abs(pdist(soft) / pdist(rest) - 1).max() > 1e-2


@pytest.mark.parametrize("dim", [2, 3])
def test_moduli_by_element_are_those_of_one_energy_a_material(dim: int) -> None:
    mesh = strip_mesh(7, 3) if dim == 2 else box_mesh((4, 3, 2))
    random = np.random.default_rng(3)
    nodes = mesh.nodes + 0.05 * mesh.size / 8 * random.normal(size=mesh.nodes.shape)
    field, none = random.normal(size=nodes.shape), np.zeros(0)
    kinds = random.integers(0, 3, len(mesh.elements))
    mu, lame = np.array([1e4, 3e4, 2e5]), np.array([2e4, 1e3, 4e5])
    whole = NeoHookean(mesh.nodes, mesh.elements, mu=mu[kinds], lame=lame[kinds], materials=kinds)
    parts = [NeoHookean(mesh.nodes, mesh.elements[kinds == kind], mu=mu[kind], lame=lame[kind]) for kind in range(3)]
    assert whole.value(nodes, none) == pytest.approx(sum(part.value(nodes, none) for part in parts), rel=1e-12)
    work = whole.parameter_derivative(nodes, field)
    for kind, part in enumerate(parts):
        own = kinds == kind
        assert np.allclose(whole.gradient(nodes, none)[own], part.gradient(nodes, none), rtol=1e-12)
        for share in (0.0, 1.0):
            one, other = (energy.projected_hessian(nodes, none, share) for energy in (whole, part))
            assert np.allclose(one[own], other, rtol=1e-12, atol=1e-9 * np.abs(other).max())
        for name in ("mu", "lame"):
            assert work[name][kind] == pytest.approx(part.parameter_derivative(nodes, field)[name][0], rel=1e-10)


def test_parts_have_their_mass_in_motion() -> None:
    """Oracle: sum of density x volume, and free fall."""
    end = BodyPart(name="end", shape="box", at=(0.15, -1.0), to=(1.0, 1.0), density=4e3)
    robot = strip(end, gravity=(0.0, -9.80665))
    simulation = Simulation(robot)
    area = robot.body.mesh.volumes[robot.body.element_materials == 1].sum()
    expected = 4e3 * THICKNESS * area + 40.0 * THICKNESS * (robot.body.mesh.volumes.sum() - area)
    assert simulation.body.masses.sum() == pytest.approx(expected, rel=1e-12)
    assert robot.body.mass == pytest.approx(expected, rel=1e-12)
    motion = simulation.step(simulation.motion_at_rest(), [0.0], 1e-4, options=StepOptions())
    fall = motion.nodes[:, 1] - robot.body.mesh.nodes[:, 1]
    assert fall[robot.body.mesh.nodes[:, 0] > 0.18].mean() == pytest.approx(-0.5 * 9.80665e-8, rel=0.1)


def test_patches_keep_to_one_material() -> None:
    part = BodyPart(name="far", shape="box", at=(0.1, -1.0), to=(1.0, 1.0), material=replace(FOAM, poisson=0.45))
    body = replace(mesh_body(strip_mesh(15, 4)), parts=(part,), volume=Volume.PATCH)
    patches = grow_patches(body.mesh.elements, PATCH_SIZE[2], body.element_materials)
    kinds = [set(body.element_materials[patches == patch].tolist()) for patch in range(patches.max() + 1)]
    assert {len(kind) for kind in kinds} == {1}
