"""`touches`: where a pose touches itself and obstacles, and with what force."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics import ContactEnergy, Energy, ObstacleEnergy
from hydrostat.mechanics.energy import Stencils
from hydrostat.simulation.simulation import Simulation
from hydrostat.simulation.solved_pose import SolvedPose


@dataclass(frozen=True, kw_only=True, eq=False)
class Touch:
    """A patch of the body's skin that touches an obstacle, or two of its patches that touch each other.

    Attributes:
        place: middle of the patch, weighted by force [m].
        force: on the body there [N]; where the body touches itself on one of both sides, the other feels its opposite.
        obstacle: name of what it touches; None: the body itself.
    """

    place: Vector
    force: Vector
    obstacle: str | None

    @property
    def strength(self) -> float:
        """How hard it presses [N]."""
        return float(np.linalg.norm(self.force))


def touches(simulation: Simulation, pose: SolvedPose) -> tuple[Touch, ...]:
    """Find where a pose touches itself and obstacles, the hardest first; nothing where contact is off.

    Pairs and samples that have a node in common are one patch. Forces on the body by an obstacle add up to what it
    feels, friction included (`Simulation.obstacle_forces` with the other sign); those of the body on itself are normal.

    Args:
        simulation: of the robot.
        pose: an equilibrium of it.
    """
    where = pose.unknowns
    assembly = simulation.path.resumed(pose) if simulation.assembly.has_history else simulation.assembly
    met = [assembly.energies[slot] for slot in simulation.body.obstacles]
    found = chain(
        _own(assembly.energies, where),
        *(_on(energy, where, each.name) for each, energy in zip(simulation.robot.obstacles, met, strict=True)),
    )
    return tuple(sorted(found, key=lambda touch: -touch.strength))


def touch_words(found: Sequence[Touch]) -> str:
    """What touches what and how hard, in one sentence; empty where nothing touches."""
    parts = []
    for name in dict.fromkeys(touch.obstacle for touch in found):
        own = [touch for touch in found if touch.obstacle == name]
        if name is None:
            places = "in one place" if len(own) == 1 else f"in {len(own)} places, the hardest"
            parts.append(f"itself {places} with {_newtons(own[0].strength)}")
        else:
            total = np.linalg.norm(np.sum([touch.force for touch in own], axis=0))
            parts.append(f"{name!r} with {_newtons(float(total))}")
    return f"the body touches {', '.join(parts)}" if parts else ""


def _newtons(force: float) -> str:
    return f"{force:.2g} N" if force >= _LITTLE else f"less than {_LITTLE:g} N"


def _own(energies: Sequence[Energy], where: Nodes) -> Iterator[Touch]:
    """Where the body touches itself."""
    for energy in energies:
        if isinstance(energy, ContactEnergy):
            here = energy.near(where)
            blocks = -here.gradient(where, np.zeros(0))
            felt = np.abs(blocks).max(axis=(1, 2), initial=0.0) > 0
            stencils, blocks, lines = here.pairs.stencils[felt], blocks[felt], here.pairs.edges[felt]
            first = np.arange(stencils.shape[1]) < np.where(lines, 2, 1)[:, None]
            shares = np.linalg.norm(blocks, axis=2)
            forces = np.einsum("pc,pcd->pd", first, blocks)
            sides = [
                np.einsum("pc,pcd->pd", side * shares, where[stencils]) / (side * shares).sum(axis=1)[:, None]
                for side in (first, ~first)
            ]
            for patch in _patches(stencils, len(where)):
                hardest = forces[patch][np.argmax(np.linalg.norm(forces[patch], axis=1))]
                turned = np.where(forces[patch] @ hardest < 0, -1.0, 1.0)[:, None] * forces[patch]
                yield _touch(0.5 * (sides[0] + sides[1])[patch], turned, None)


def _on(energy: Energy, where: Nodes, name: str) -> Iterator[Touch]:
    """Where the body touches an obstacle."""
    assert isinstance(energy, ObstacleEnergy)
    points, forces = energy.pressed(where)
    felt = np.flatnonzero(forces.any(axis=1))
    for patch in _patches(energy.stencils[felt, : where.shape[1]], len(where)):
        yield _touch(points[felt[patch]], -forces[felt[patch]], name)


def _patches(stencils: Stencils, count: int) -> Iterator[np.ndarray]:
    """Stencils that hang together by their nodes, of so many."""
    many = stencils.shape[1] - 1
    links = np.repeat(stencils[:, 0], many), stencils[:, 1:].ravel()
    graph = coo_array((np.ones(len(links[0])), links), shape=(count, count))
    labels = connected_components(graph, directed=False)[1][stencils[:, 0]]
    for label in np.unique(labels):
        yield np.flatnonzero(labels == label)


def _touch(points: Points, forces: Points, obstacle: str | None) -> Touch:
    weights = np.linalg.norm(forces, axis=1)
    return Touch(place=weights @ points / weights.sum(), force=forces.sum(axis=0), obstacle=obstacle)


_LITTLE = 0.001
"""Force below which no figure is told [N]."""
