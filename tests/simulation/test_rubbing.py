"""Friction between parts of one body. Oracles: Coulomb, differences, balance of forces, the step of the way."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from touching import DISTANCE, fork_robot

from hydrostat.arrays import Nodes
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.ik import solve_ik
from hydrostat.mechanics import (
    Assembly,
    FactorizedHessian,
    FrictionalSelfContactEnergy,
    NeoHookean,
    NewtonOptions,
    NewtonResult,
    PinEnergy,
    RoundOff,
    SelfContactEnergy,
    minimize,
)
from hydrostat.robot import Contact
from hydrostat.simulation import Simulation, find_contacts
from hydrostat.simulation.statics.history_equilibrium import find_history_equilibrium
from hydrostat.testing import check_energy

IDLE, FRICTION, YOUNG, PRESS = np.zeros(0), 0.4, 1e5, 1.4e-3

pytestmark = pytest.mark.usefixtures("unchecked")


def two_blocks(dim: int) -> Mesh:
    """A block 20 mm wide on one of 60 mm, 2 mm apart, with meshes that do not match; 10 mm high each."""
    if dim == 2:
        low, high = strip_mesh(9, 2, size=(0.06, 0.01)), strip_mesh(4, 2, size=(0.02, 0.01))
    else:
        low, high = box_mesh((9, 4, 2), size=(0.06, 0.03, 0.01)), box_mesh((4, 3, 2), size=(0.02, 0.02, 0.01))
    up = dim - 1
    shift = np.full(dim, 0.005)
    shift[0] = 0.01
    shift[up] = low.nodes[:, up].max() - high.nodes[:, up].min() + 2 * DISTANCE
    if dim == 3:
        shift[1] = low.nodes[:, 1].min() - high.nodes[:, 1].min() + 0.0047
    nodes = np.concatenate([low.nodes, high.nodes + shift])
    return Mesh(nodes, np.concatenate([low.elements, high.elements + len(low.nodes)]))


def ends(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    heights = mesh.nodes[:, -1]
    return np.flatnonzero(heights < heights.min() + 1e-9), np.flatnonzero(heights > heights.max() - 1e-9)


@dataclass
class Pressed:
    """The upper block's upper side is moved; the lower block's lower side is held."""

    dim: int
    springs: float = 1.0
    at: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.mesh = mesh = two_blocks(self.dim)
        low, high = ends(mesh)
        held = np.concatenate([low, high])
        self.moved = np.repeat([0.0, 1.0], [len(low), len(high)])
        self.pins = PinEnergy(
            stencils=held[:, None],
            weights=np.ones((len(held), 1)),
            targets=mesh.nodes[held],
            stiffness=np.full(len(held), 1e5),
            supports=np.repeat([0, 1], [len(low), len(high)]),
        )
        contact = SelfContactEnergy.of(mesh, distance=DISTANCE, young=YOUNG, thickness=0.02 if self.dim == 2 else None)
        body = NeoHookean(
            mesh.nodes, mesh.elements, mu=YOUNG / 2.6, lame=YOUNG, thickness=0.02 if self.dim == 2 else 1.0
        )
        rubbing = FrictionalSelfContactEnergy.of(mesh, contact, FRICTION)
        grip = replace(rubbing.clasp.grip, springs=self.springs * rubbing.clasp.grip.springs)
        rubbing = FrictionalSelfContactEnergy(contact, rubbing.clasp.with_grip(grip))
        self.assembly = Assembly([body, self.pins, rubbing], rest=mesh.nodes, control_count=0)
        self.nodes, self.at = mesh.nodes, np.zeros(self.dim)

    def to(self, *place: float) -> np.ndarray:
        """Force [N] on the upper side after a step there."""
        pins = self.pins.with_supports_moved(np.array([np.zeros(self.dim), place]))
        body, _, rubbing = self.assembly.energies
        start = self.assembly.with_active_terms(self.nodes).with_energies([body, pins, rubbing])

        def relax(assembly: Assembly, nodes: Nodes, known: FactorizedHessian | None, tolerance: float) -> NewtonResult:
            noise, options = RoundOff(force=1e-11, energy=1e-16), NewtonOptions(tolerance=max(tolerance, 1e-9))
            return minimize(assembly, nodes, IDLE, round_off=noise, options=options)

        found, result = find_history_equilibrium(start, (self.nodes, None), IDLE, relax, 1e-9)
        assert result.converged, result.status
        self.nodes, self.at = result.nodes, np.array(place)
        self.assembly = found.with_advanced_history(self.nodes, IDLE)
        forces = pins.gradient(self.nodes, IDLE)[:, 0]
        return -(self.moved[:, None] * forces).sum(axis=0)

    def path(self, *places: tuple[float, ...], step: float = 2e-4) -> np.ndarray:
        """Forces along a way, in even steps."""
        forces = []
        for place in places:
            begin, count = self.at, max(1, int(np.ceil(np.linalg.norm(np.array(place) - self.at) / step - 1e-9)))
            forces += [self.to(*(begin + (np.array(place) - begin) * (k + 1) / count)) for k in range(count)]
        return np.array(forces)

    def along(self, way: float, *, step: float = 2e-4) -> np.ndarray:
        """Forces [N] while the upper side goes to a place along the surface [m], pressed as ever."""
        return self.path((way, *np.zeros(self.dim - 2), -PRESS), step=step)

    @classmethod
    def begun(cls, dim: int, *, springs: float = 1.0, step: float = 2e-4) -> "Pressed":
        """Pressed together."""
        blocks = cls(dim, springs=springs)
        blocks.path((*np.zeros(dim - 1), -PRESS), step=step)
        return blocks

    @property
    def rubbing(self) -> FrictionalSelfContactEnergy:
        energy = self.assembly.with_active_terms(self.nodes).energies[2]
        assert isinstance(energy, FrictionalSelfContactEnergy)
        return energy


@pytest.mark.parametrize("dim", [2, 3])
def test_derivatives_and_balance_of_forces(dim: int) -> None:
    """Where half of the nodes stick and the others slip."""
    blocks = Pressed.begun(dim, step=7e-4)
    blocks.along(2e-4)
    nodes = blocks.nodes + 2e-5 * np.random.default_rng(1).normal(size=blocks.nodes.shape)
    energy = blocks.rubbing.with_active_terms(nodes)
    grip = energy.clasp.grip
    lengths = grip.slips(energy.clasp.places(nodes))[1]
    limits = grip.springs * lengths * np.where(np.arange(len(lengths)) % 2, 2.0, 0.5)
    energy = FrictionalSelfContactEnergy(energy.contact, energy.clasp.with_grip(replace(grip, limits=limits)))
    check_energy(energy, nodes, IDLE)
    forces = energy.clasp.forces(nodes)
    assert np.abs(forces.sum(axis=0)).max() < 1e-12 * np.abs(forces).sum()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_block_slips_at_friction_times_what_presses(dim: int) -> None:
    """Half a millimeter on; corners that pass nodes of the other mesh jolt a little, so the middle of all forces."""
    forces = Pressed.begun(dim, step=7e-4).along(2.4e-3, step=3e-4)[3:]
    assert np.median(forces[:, 0] / -forces[:, -1]) == pytest.approx(FRICTION, rel=0.01)


def test_what_sticks_does_not_creep() -> None:
    blocks = Pressed.begun(2)
    force = blocks.along(3.9e-4)[-1]
    assert 0.7 < -force[0] / force[1] / FRICTION < 0.95
    begin = blocks.nodes
    for _ in range(1000):
        blocks.along(3.9e-4)
    assert np.abs(blocks.nodes - begin).max() < 1e-9


def test_force_does_not_depend_on_steps_nor_on_springs() -> None:
    """There, half of the way back, and back."""
    ways = (1.5e-3, 1e-3, 0.0)

    def forces(springs: float, step: float) -> np.ndarray:
        blocks = Pressed.begun(2, springs=springs, step=step)
        return np.array([blocks.along(way, step=step)[-1] for way in ways])

    known = forces(1.0, 2e-4)
    assert forces(1.0, 5e-4) == pytest.approx(known, rel=1e-4)
    assert forces(1.0, 5e-5) == pytest.approx(known, rel=1e-4)
    for springs in (0.3, 3.0):
        assert forces(springs, 5e-4)[[0, 2]] == pytest.approx(known[[0, 2]], rel=0.01)


def test_what_is_remembered_is_enough() -> None:
    """A path that goes on from the numbers of its history is the path."""
    one, other = Pressed.begun(2), Pressed.begun(2)
    for blocks in (one, other):
        blocks.along(1e-3)
    fresh = Pressed(2)
    other.assembly = fresh.assembly.with_active_terms(other.nodes).with_history(one.assembly.history, other.nodes, IDLE)
    assert other.along(6e-4) == pytest.approx(one.along(6e-4), rel=1e-6)


@pytest.mark.parametrize("dim", [2, 3])
def test_robots(dim: int) -> None:
    """Prongs that rub stay where smooth ones slide on; in time too; what inverse kinematics finds is followed."""
    smooth = Simulation(fork_robot(dim))
    rough = Simulation(replace(smooth.robot, contact=Contact(distance=DISTANCE, friction=0.3)))
    pulled = {"up": 0.012, "down": 0.01}
    ends = [simulation.solve(pulled) for simulation in (smooth, rough)]
    assert np.linalg.norm(ends[0].markers["tip"] - ends[1].markers["tip"]) > 1e-3
    assert find_contacts(rough, ends[1])
    motion = rough.motion_at_rest(ends[1])
    for _ in range(3):
        motion = rough.step(motion, pulled, 0.01)
    assert motion.nodes == pytest.approx(ends[1].nodes, abs=1e-5)
    with pytest.raises(InputError, match="derivatives follow"):
        rough.jacobian(ends[1])


def test_inverse_kinematics_is_followed() -> None:
    rough = Simulation(replace(fork_robot(2), contact=Contact(distance=DISTANCE, friction=0.3)))
    goal = rough.solve({"up": 0.0058, "down": 0.0058}).markers["tip"]
    found = solve_ik(rough, {"tip": goal})
    assert found.pose.markers["tip"] == pytest.approx(goal, abs=2e-3)
    assert len(found.pose.history) == len(rough.assembly.history) > 0
