"""Foam laws. Oracles: closed forms, the Neo-Hookean solid at rest, rotations, data sheets."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.mechanics import Assembly, FoamSolid, NeoHookean, QuadraticSolid
from hydrostat.robot import FOAMS, FoamTerm, Material, Pin, Plane, Robot
from hydrostat.simulation import BodyPhysics, Simulation, node_stresses
from hydrostat.testing import check_energy

NONE = np.zeros(0)
TERMS = (FoamTerm(share=0.7, exponent=8.0), FoamTerm(share=0.3, exponent=-3.0))
FOAM = Material(young=20e3, poisson=0.2, density=40, foam=TERMS)
MESHES = {2: strip_mesh(4, 2, size=(0.1, 0.05)), 3: box_mesh((2, 1, 1))}


def foam_robot(mesh: Mesh, material: Material, *, kind: str = "linear", plane: Plane = Plane.STRAIN) -> Robot:
    body = replace(mesh_body(mesh, thickness=1.0 if mesh.dim == 2 else None, material=material), plane=plane)
    pin = Pin(box=((-1e-3,) + (-1.0,) * (mesh.dim - 1), (1e-3,) + (1.0,) * (mesh.dim - 1)))
    return Robot(name="foam", body=body.with_elements(kind), pins=(pin,), winches=(), cables=(), markers=(), poses={})


def foam_energy(robot: Robot) -> FoamSolid:
    (found,) = (each for each in BodyPhysics(robot).assembly.energies if isinstance(each, FoamSolid))
    return found


def pull(material: Material, stretch: float) -> float:
    """Stress along one axis, sides free, over the area at rest [Pa]."""
    mu, nu = material.lame[0], material.poisson
    return sum(
        2 * mu * term.share / term.exponent * (stretch ** (term.exponent - 1) - stretch ** (-1 - term.exponent * nu))
        for term in material.foam
    )


@pytest.mark.parametrize("kind", ["linear", "quadratic"])
@pytest.mark.parametrize("stretch", [0.35, 0.9, 1.4])
def test_stretched_along_one_axis(stretch: float, kind: str) -> None:
    """In space, and in plane stress: sides narrow by s^-nu and carry nothing; the force is in closed form."""
    for dim, plane in ((3, Plane.STRAIN), (2, Plane.STRESS)):
        robot = foam_robot(MESHES[dim], FOAM, kind=kind, plane=plane)
        energy, rest = foam_energy(robot), robot.body.mesh.nodes
        aside = stretch**-FOAM.poisson
        nodes = rest * np.array([stretch, aside, aside][:dim])
        forces = np.zeros_like(rest)
        energy.add_gradient(nodes, NONE, forces)
        end = np.isclose(rest[:, 0], rest[:, 0].max())
        area = 0.05 ** (dim - 1)
        assert forces[end, 0].sum() == pytest.approx(area * pull(FOAM, stretch), rel=1e-10)
        assert np.abs(forces[:, 1:]).max() < 1e-11 * area * FOAM.young
        stress = node_stresses(robot, nodes)  # over the area now
        assert stress == pytest.approx(abs(pull(FOAM, stretch)) / aside**2, rel=1e-9)


def test_squeezed_in_plane_strain() -> None:
    """The other side narrows by nu / (1 - nu) in logarithms; Poisson's ratio of plane strain."""
    robot = foam_robot(MESHES[2], FOAM)
    ratio, stretch = FOAM.poisson / (1 - FOAM.poisson), 0.5
    mu, beta = FOAM.lame[0], FOAM.poisson / (1 - 2 * FOAM.poisson)
    volume = stretch ** (1 - ratio)
    rest = robot.body.mesh.nodes
    forces = np.zeros_like(rest)
    foam_energy(robot).add_gradient(rest * [stretch, stretch**-ratio], NONE, forces)
    terms = [(2 * mu * term.share / term.exponent, term.exponent) for term in TERMS]
    told = sum(scale / stretch * (stretch**alpha - volume ** (-alpha * beta)) for scale, alpha in terms)
    end = np.isclose(rest[:, 0], rest[:, 0].max())
    assert forces[end, 0].sum() == pytest.approx(0.05 * told, rel=1e-10)
    assert np.abs(forces[:, 1]).max() < 1e-11 * 0.05 * FOAM.young


@pytest.mark.parametrize("dim", [2, 3])
def test_small_strains_are_those_of_any_elastic_solid(dim: int) -> None:
    """Oracle: the Hessian of `NeoHookean` at rest."""
    energy, mesh = foam_energy(foam_robot(MESHES[dim], FOAM)), MESHES[dim]
    mu, lame = FOAM.lame
    other = NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=lame)
    told = other.hessian(mesh.nodes, NONE)
    assert energy.hessian(mesh.nodes, NONE) == pytest.approx(told, rel=1e-9, abs=1e-9 * np.abs(told).max())


@pytest.mark.parametrize("dim", [2, 3])
def test_positive_and_blind_to_rotations(dim: int) -> None:
    energy, rest = foam_energy(foam_robot(MESHES[dim], FOAM)), MESHES[dim].nodes
    random = np.random.default_rng(0)
    for size in (1e-6, 1e-2, 0.3):
        strain = size * random.uniform(-1, 1, (dim, dim))
        turn = np.linalg.qr(random.standard_normal((dim, dim)))[0]
        turn[0] *= np.linalg.det(turn)
        stored = energy.value(rest @ (np.eye(dim) + strain), NONE)
        assert stored > 0
        assert energy.value(rest @ (np.eye(dim) + strain) @ turn, NONE) == pytest.approx(stored, rel=1e-7)
    assert energy.value(rest * ([-1.0] + [1.0] * (dim - 1)), NONE) == np.inf


@pytest.mark.parametrize(("dim", "plane"), [(2, Plane.STRAIN), (2, Plane.STRESS), (3, Plane.STRAIN)])
def test_slopes_by_moduli(dim: int, plane: Plane) -> None:
    """Oracle: central differences of the work along a field."""
    random, rest = np.random.default_rng(2), MESHES[dim].nodes
    nodes = rest * [0.6, 1.2, 0.9][:dim] + 1e-3 * random.uniform(-1, 1, rest.shape)
    field = random.standard_normal(rest.shape)

    def work(young: float, poisson: float) -> float:
        material = replace(FOAM, young=young, poisson=poisson)
        energy = foam_energy(foam_robot(MESHES[dim], material, plane=plane))
        return float((energy.gradient(nodes, NONE) * field[energy.stencils]).sum())

    slopes = foam_energy(foam_robot(MESHES[dim], FOAM, plane=plane)).parameter_derivative(nodes, field)
    for key, (up, down) in {"young": ((20.1e3, 0.2), (19.9e3, 0.2)), "poisson": ((20e3, 0.201), (20e3, 0.199))}.items():
        moduli = [np.array(replace(FOAM, young=a, poisson=b).lame) for a, b in (up, down)]
        told = float((moduli[0] - moduli[1]) @ [slopes["mu"][0], slopes["lame"][0]])
        assert told == pytest.approx(work(*up) - work(*down), rel=1e-4), key


@pytest.mark.parametrize("dim", [2, 3])
def test_quadratic_elements_keep_the_contract(dim: int) -> None:
    robot = foam_robot(MESHES[dim], FOAM, kind="quadratic")
    random, nodes = np.random.default_rng(1), robot.body.mesh.nodes
    stretched = nodes * [0.6, 1.2, 0.9][:dim] + 1e-3 * random.uniform(-1, 1, nodes.shape)
    check_energy(foam_energy(robot), stretched, NONE)


def test_what_is_no_foam_keeps_its_energies() -> None:
    """A body of one Neo-Hookean material has no energy more; in one with foam each element counts once."""
    plain = replace(FOAM, foam=())
    assert not any(isinstance(each, FoamSolid) for each in BodyPhysics(foam_robot(MESHES[3], plain)).assembly.energies)
    robot = foam_robot(MESHES[3], FOAM)
    physics = BodyPhysics(robot)
    assert isinstance(physics.elastic, NeoHookean | QuadraticSolid)
    nodes = robot.body.mesh.nodes * [0.7, 1.1, 1.0]
    whole = Assembly([physics.elastic, foam_energy(robot)], rest=robot.body.mesh.nodes, control_count=0)
    assert physics.elastic.value(nodes, NONE) == 0.0
    assert whole.value(nodes, NONE) == foam_energy(robot).value(nodes, NONE) > 0


@pytest.mark.parametrize(
    ("name", "squeeze", "kpa"),
    [
        ("polyethylene foam", 0.25, 40.0),  # data sheet
        ("polyethylene foam", 0.5, 115.0),
        ("polyurethane foam", 0.4, 3.5),  # hardness of a cushion
        ("polyester fibre", 0.5, 10 * (2**3 - 1)),  # van Wyk: E / 3 (1 / s^3 - 1)
        ("polyester fibre", 0.6, 10 * (2.5**3 - 1)),
    ],
)
def test_foams_of_the_table_carry_what_their_sources_say(name: str, squeeze: float, kpa: float) -> None:
    assert -pull(FOAMS[name], 1 - squeeze) == pytest.approx(1e3 * kpa, rel=0.01)


def test_a_block_settles_under_its_weight() -> None:
    """Without effect sideways each height carries what is above: the block is as high as s(P) says, by quadrature."""
    soft, gravity, height = replace(FOAM, young=120.0, poisson=0.0, density=100.0), 9.81, 0.06
    mesh = strip_mesh(12, 6, size=(height, 0.06))
    robot = replace(foam_robot(mesh, soft, kind="quadratic"), gravity=(-gravity, 0.0))
    found = Simulation(robot).solve(NONE).nodes
    stretches = np.linspace(0.05, 1.0, 20_000)
    loads = soft.density * gravity * (height - np.linspace(0, height, 2001))
    told = np.trapezoid(np.interp(-loads, [pull(soft, float(s)) for s in stretches], stretches), dx=height / 2000)
    assert told < 0.8 * height
    assert found[:, 0].max() == pytest.approx(told, rel=1e-3)
