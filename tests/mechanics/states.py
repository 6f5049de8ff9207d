"""Energies of body, cable, pin, weight and fibers in random, strongly deformed states; others have their own tests."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from builders import box_mesh, strip_mesh

from hydrostat.geometry import Mesh, locate
from hydrostat.mechanics import (
    CableEnergy,
    CableSegments,
    DeadLoadEnergy,
    DrivenLoadEnergy,
    DrivenPinEnergy,
    Energy,
    FibreEnergy,
    FoamSolid,
    MomentEnergy,
    NeoHookean,
    PinEnergy,
    PrandtlEnergy,
    PressureEnergy,
    RodEnergy,
    RodTwistEnergy,
    SheetEnergy,
    TensionLaw,
    rod_points,
)

SIZE = {2: (0.1, 0.05), 3: (0.1, 0.05, 0.05)}
CONTROLS = 3
LAW = TensionLaw(stiffness=np.array([4e3]), smoothing=np.array([0.5e-3]))


@dataclass(frozen=True)
class State:
    """An energy with positions and controls to check it at."""

    energy: Energy
    nodes: np.ndarray
    controls: np.ndarray


def rough_mesh(dim: int, random: np.random.Generator) -> Mesh:
    """A small mesh whose inner nodes are off the grid."""
    mesh = strip_mesh(4, 2, size=SIZE[2]) if dim == 2 else box_mesh((2, 1, 1), size=SIZE[3])
    return Mesh(mesh.nodes + 0.003 * random.uniform(-1, 1, mesh.nodes.shape), mesh.elements)


def deform(mesh: Mesh, random: np.random.Generator) -> np.ndarray:
    """Positions after stretches of 0.6 to 1.7, a rotation and a jitter, with J > 0.15 in every element."""
    dim = mesh.dim
    while True:
        first, second = (np.linalg.qr(random.standard_normal((dim, dim)))[0] for _ in range(2))
        affine = first @ np.diag(random.uniform(0.6, 1.7, dim)) @ second
        if np.linalg.det(affine) < 0:
            affine[0] *= -1
        nodes = mesh.nodes @ affine.T + 0.008 * random.uniform(-1, 1, mesh.nodes.shape)
        if (Mesh.volumes.func(_Loose(nodes, mesh.elements)) > 0.15 * mesh.volumes).all():
            return nodes


@dataclass(frozen=True)
class _Loose:
    """Nodes and elements, not yet known to be a mesh."""

    nodes: np.ndarray
    elements: np.ndarray

    @property
    def dim(self) -> int:
        return self.nodes.shape[1]


def neo_hookean(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    thickness = 0.03 if dim == 2 else 1.0
    energy = NeoHookean(mesh.nodes, mesh.elements, mu=11e3, lame=17e3, thickness=thickness)
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def foam(dim: int, random: np.random.Generator, *, poisson: float, is_free_across: bool = False) -> State:
    """A foam of a plateau and a term that stiffens in compression."""
    mesh, lame = rough_mesh(dim, random), 2 * 11e3 * poisson / (1 - 2 * poisson)
    shape = NeoHookean(mesh.nodes, mesh.elements, mu=0.0, lame=0.0, thickness=0.03 if dim == 2 else 1.0)
    energy = FoamSolid(
        mesh.nodes,
        mesh.elements,
        gradients=shape.shape_gradients[:, None],
        volumes=shape.volumes[:, None],
        lame=(11e3, lame),
        terms=((0.8, 6.0), (0.2, -3.0)),
        is_free_across=is_free_across and dim == 2,
    )
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def sliders(dim: int, random: np.random.Generator) -> State:
    """Prandtl elements of which some slip, after a history."""
    mesh = rough_mesh(dim, random)
    shape = NeoHookean(mesh.nodes, mesh.elements, mu=0.0, lame=0.0, thickness=0.03 if dim == 2 else 1.0)
    points = {"gradients": shape.shape_gradients[:, None], "volumes": shape.volumes[:, None]}
    energy = PrandtlEnergy(mesh.nodes, mesh.elements, **points, young=11e3, strain=0.2)
    before = energy.with_advanced_history(deform(mesh, random), np.zeros(0))
    return State(before, deform(mesh, random), np.zeros(CONTROLS))


def rod(dim: int, random: np.random.Generator, *, bent: bool) -> State:
    mesh = rough_mesh(dim, random)
    ends = random.uniform(0.15, 0.85, (3, dim)) * SIZE[dim]
    ends[1] = 0.4 * ends[0] + 0.6 * ends[2] + (0.2 * (ends[1] - ends[0]) if bent else 0.0)
    anchors = locate(mesh, rod_points(mesh, ends))
    energy = RodEnergy(mesh.nodes, anchors, axial_stiffness=30.0, bending_stiffness=4e-3)
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def rod_twist(random: np.random.Generator) -> State:
    mesh = rough_mesh(3, random)
    ends = random.uniform(0.2, 0.8, (2, 3)) * SIZE[3]
    energy = RodTwistEnergy(mesh.nodes, mesh, rod_points(mesh, ends), torsional_stiffness=4e-3)
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def sheet(dim: int, random: np.random.Generator, *, on_faces: bool = False, **given: bool) -> State:
    """A sheet on the skin in space, on the outline or the faces of a flat body."""
    mesh = rough_mesh(dim, random)
    facets, width = (mesh.elements, None) if on_faces and dim == 2 else (mesh.boundary, 0.03 if dim == 2 else None)
    energy = SheetEnergy(mesh.nodes, facets, lame=(11e3, 17e3), thickness=2e-3, width=width, **given)
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def cable(
    dim: int, random: np.random.Generator, *, elongation: float, world: bool = False, sheathed: tuple[int, ...] = ()
) -> State:
    """A cable whose contraction is such that its elongation is as asked."""
    mesh = rough_mesh(dim, random)
    points = random.uniform(0.1, 0.9, (5, dim)) * SIZE[dim]
    anchors = locate(mesh, points)
    weights, offsets = anchors.weights.copy(), np.zeros_like(points)
    if world:
        weights[0], offsets[0] = 0.0, -0.03
    bare = [segment for segment in range(4) if segment not in sheathed]
    ends = np.add(bare, 1)
    energy = CableEnergy(
        mesh.nodes,
        segments=CableSegments(
            stencils=np.concatenate([anchors.stencils[bare], anchors.stencils[ends]], axis=1),
            weights=np.concatenate([-weights[bare], weights[ends]], axis=1),
            offsets=offsets[ends] - offsets[bare],
            cables=np.zeros(len(bare), dtype=np.int64),
        ),
        law=LAW,
        winches=np.array([1]),
        slack=np.array([0.002]),
    )
    nodes, controls = deform(mesh, random), random.uniform(0, 0.02, CONTROLS)
    controls[1] += elongation - float(energy.elongations(nodes, controls)[0])
    return State(energy, nodes, controls)


def cables(dim: int, random: np.random.Generator) -> State:
    """Four cables of different laws: slack, in the cubic zone, and two taut ones on two steps of the same winch."""
    mesh = rough_mesh(dim, random)
    owners = np.array([0, 0, 1, 2, 2, 2, 3])
    ends = [locate(mesh, random.uniform(0.1, 0.9, (len(owners), dim)) * SIZE[dim]) for _ in range(2)]
    law = TensionLaw(stiffness=np.array([4e3, 1e3, 2e3, 8e3]), smoothing=np.array([0.5e-3, 2e-3, 1e-3, 0.1e-3]))
    arguments = {
        "segments": CableSegments(
            stencils=np.concatenate([ends[0].stencils, ends[1].stencils], axis=1),
            weights=np.concatenate([-ends[0].weights, ends[1].weights], axis=1),
            offsets=np.zeros((len(owners), dim)),
            cables=owners,
        ),
        "law": law,
        "winches": np.array([0, 2, 1, 1]),
        "ratios": np.array([0.7, 1.6, 1.0, 2.3]),
    }
    nodes, controls = deform(mesh, random), random.uniform(0, 0.02, CONTROLS)
    elongations = CableEnergy(mesh.nodes, slack=np.zeros(4), **arguments).elongations(nodes, controls)
    wanted = np.array([-0.01, 1.2 * 2e-3, 0.01, 0.02])
    return State(CableEnergy(mesh.nodes, slack=elongations - wanted, **arguments), nodes, controls)


def pins(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    anchors = locate(mesh, random.uniform(0.1, 0.9, (4, dim)) * SIZE[dim])
    energy = PinEnergy(
        stencils=anchors.stencils,
        weights=anchors.weights,
        targets=random.uniform(0, 0.1, (4, dim)),
        stiffness=np.array([1e2, 1e3, 1e4, 1e5]),
    )
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def drives(dim: int, random: np.random.Generator) -> State:
    """Two pins that turn and one that slides, of four."""
    state = pins(dim, random)
    assert isinstance(state.energy, PinEnergy)
    first, second = random.uniform(-0.1, 0.1, (2, 3, dim))
    turns = np.array([True, True, False])
    terms, controls = np.array([0, 2, 3]), np.array([1, 1, 2])
    energy = DrivenPinEnergy(state.energy, terms=terms, controls=controls, directions=(first, second), turns=turns)
    return State(energy, state.nodes, random.uniform(-1.5, 1.5, CONTROLS))


def weight(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    energy = DeadLoadEnergy(mesh.nodes, random.standard_normal(mesh.nodes.shape))
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def pressure(dim: int, random: np.random.Generator) -> State:
    """Pressure on the whole skin, from inside."""
    mesh = rough_mesh(dim, random)
    return State(PressureEnergy(mesh.nodes, mesh.boundary, 2e4, 0.03), deform(mesh, random), np.zeros(CONTROLS))


def moment(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    energy = MomentEnergy(mesh.nodes, mesh.elements[2:6], random.standard_normal(1 if dim == 2 else 3))
    return State(energy, deform(mesh, random), np.zeros(CONTROLS))


def controlled(dim: int, random: np.random.Generator, of: Callable[[int, np.random.Generator], State]) -> State:
    """A load of which a control lets a share act."""
    state = of(dim, random)
    return State(DrivenLoadEnergy(state.energy, 1), state.nodes, random.uniform(-1.5, 1.5, CONTROLS))


def edge_fibres(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    energy = FibreEnergy(stencils=mesh.edges, weights=np.tile([-1.0, 1.0], (len(mesh.edges), 1)))
    return State(energy, deform(mesh, random), random.uniform(0, 5, len(mesh.edges)))


def element_fibres(dim: int, random: np.random.Generator) -> State:
    mesh = rough_mesh(dim, random)
    ends = random.dirichlet(np.ones(dim + 1), (2, len(mesh.elements)))
    energy = FibreEnergy(stencils=mesh.elements, weights=ends[1] - ends[0])
    return State(energy, deform(mesh, random), random.uniform(0, 5, len(mesh.elements)))


_EPS = float(LAW.smoothing[0])
ENERGIES: dict[str, Callable[[int, np.random.Generator], State]] = {
    "neo-hookean": neo_hookean,
    "foam": lambda dim, random: foam(dim, random, poisson=0.25),
    "foam without effect sideways": lambda dim, random: foam(dim, random, poisson=0.0),
    "foam in plane stress": lambda dim, random: foam(dim, random, poisson=0.4, is_free_across=True),
    "sliders": sliders,
    "pins": pins,
    "drives": drives,
    "weight": weight,
    "pressure": pressure,
    "moment": moment,
    "controlled pressure": lambda dim, random: controlled(dim, random, pressure),
    "controlled moment": lambda dim, random: controlled(dim, random, moment),
    "rod": lambda dim, random: rod(dim, random, bent=False),
    "rod that is bent at rest": lambda dim, random: rod(dim, random, bent=True),
    "sheet": sheet,
    "sheet that wrinkles": lambda dim, random: sheet(dim, random, wrinkles=True),
    "sheet on faces that wrinkles": lambda dim, random: sheet(dim, random, on_faces=True, wrinkles=True),
    "strip that becomes narrower": lambda dim, random: sheet(dim, random, is_held_across=False),
    "fibres on edges": edge_fibres,
    "fibres in elements": element_fibres,
    "slack cable": lambda dim, random: cable(dim, random, elongation=-0.01),
    "cable barely taut": lambda dim, random: cable(dim, random, elongation=0.1 * _EPS),
    "cable in the cubic zone": lambda dim, random: cable(dim, random, elongation=1.3 * _EPS),
    "taut cable": lambda dim, random: cable(dim, random, elongation=0.02),
    "cable from the world": lambda dim, random: cable(dim, random, elongation=0.02, world=True),
    "sheathed cable": lambda dim, random: cable(dim, random, elongation=0.02, sheathed=(1, 2)),
    "four cables": cables,
    "sheathed at the winch": lambda dim, random: cable(dim, random, elongation=1.2 * _EPS, sheathed=(0,), world=True),
}
"""Makers of a state, by name: dimension and random numbers in."""
