"""Friction between parts of one body. Oracles: Coulomb, differences, balance of forces, the step of the way."""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from touching import DISTANCE, fork_robot

from hydrostat.arrays import Nodes
from hydrostat.geometry.mesh import Mesh
from hydrostat.mechanics import (
    Assembly,
    ContactEnergy,
    NeoHookean,
    NewtonOptions,
    NewtonResult,
    PinEnergy,
    RoundOff,
    RubbingEnergy,
    Stiffness,
    minimise,
)
from hydrostat.simulation.balanced import balanced
from hydrostat.testing import check_energy

IDLE, FRICTION, YOUNG = np.zeros(0), 0.4, 1e5


def two_blocks(dim: int, lean: float = 0.0) -> Mesh:
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
    friction: float = FRICTION
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
        contact = ContactEnergy.of(mesh, distance=DISTANCE, young=YOUNG, thickness=0.02 if self.dim == 2 else None)
        body = NeoHookean(
            mesh.nodes, mesh.elements, mu=YOUNG / 2.6, lame=YOUNG, thickness=0.02 if self.dim == 2 else 1.0
        )
        self.rubbing = RubbingEnergy.of(mesh, contact, self.friction)
        self.assembly = Assembly([body, self.pins, self.rubbing], rest=mesh.nodes, control_count=0)
        self.nodes, self.at = mesh.nodes, np.zeros(self.dim)

    def to(self, *place: float) -> np.ndarray:
        """Force [N] on the upper side after a step there."""
        pins = self.pins.with_supports_moved(np.array([np.zeros(self.dim), place]))
        body, _, rubbing = self.assembly.energies
        start = self.assembly.near(self.nodes).with_energies([body, pins, rubbing])

        def relax(assembly: Assembly, nodes: Nodes, known: Stiffness | None) -> NewtonResult:
            noise = RoundOff(force=1e-11, energy=1e-16)
            return minimise(assembly, nodes, IDLE, round_off=noise, options=NewtonOptions(tolerance=1e-9))

        found, result = balanced(start, (self.nodes, None), IDLE, relax, 1e-9)
        assert result.converged, result.reason
        self.iterations = result.iterations
        self.nodes, self.at = result.nodes, np.array(place)
        self.assembly = found.after(self.nodes, IDLE)
        forces = pins.gradient(self.nodes, IDLE)[:, 0]
        return -(self.moved[:, None] * forces).sum(axis=0)

    def path(self, *places: tuple[float, ...], step: float = 2e-4) -> np.ndarray:
        """Forces along a way, in even steps."""
        forces = []
        for place in places:
            begin, count = self.at, max(1, int(np.ceil(np.linalg.norm(np.array(place) - self.at) / step - 1e-9)))
            forces += [self.to(*(begin + (np.array(place) - begin) * (k + 1) / count)) for k in range(count)]
        return np.array(forces)
