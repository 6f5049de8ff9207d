"""`find_contacts`: self-contact and obstacle contact of a pose, with the forces."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.mechanics import ContactForces, Stencils
from hydrostat.simulation.equilibrium import Equilibrium, check_pose
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactPatch:
    """Patch of the body's surface that touches an obstacle, or pair of patches that touch each other.

    Attributes:
        place: center of the patch, weighted by force [m].
        force: force on the body there [N]. For self-contact: on one of the two sides; the other has the opposite force.
        obstacle: name of the touched obstacle; None for self-contact.
    """

    place: Vector
    force: Vector
    obstacle: str | None

    @property
    def strength(self) -> float:
        """Magnitude of the contact force [N]."""
        return float(np.linalg.norm(self.force))

    @staticmethod
    def describe_all(found: "Sequence[ContactPatch]") -> str:
        """Describe all contacts and their forces in one sentence; empty if nothing touches."""
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


def find_contacts(simulation: Simulation, pose: Equilibrium) -> tuple[ContactPatch, ...]:
    """Find contacts of a pose with itself and with obstacles, largest force first; empty if contact is off.

    Contact pairs and samples with a common node form one patch. Forces from an obstacle include friction and add up to
    its total force on the body (`obstacle_forces` with the opposite sign); forces of self-contact are normal forces.

    Args:
        simulation: simulation of the robot.
        pose: equilibrium of this robot.

    Raises:
        InputError: a pose of another robot.
    """
    check_pose(pose, simulation.robot.body.mesh.nodes.shape, simulation.robot.num_controls, what="the pose")
    where = pose.unknowns
    assembly = simulation.path.with_history(pose) if simulation.assembly.has_history else simulation.assembly
    names = dict(zip(simulation.body.obstacles, (each.name for each in simulation.robot.obstacles), strict=True))
    found = []
    for slot, energy in enumerate(assembly.energies):
        pressed = energy.contact_forces(where)
        if pressed is not None:
            found += [_touch(pressed, patch, names.get(slot)) for patch in _patches(pressed.stencils, len(where))]
    return tuple(sorted(found, key=lambda touch: -touch.strength))


def _newtons(force: float) -> str:
    little = 0.001  # Force below which no figure is told [N]
    return f"{force:.2g} N" if force >= little else f"less than {little:g} N"


def _patches(stencils: Stencils, count: int) -> Iterator[np.ndarray]:
    """Stencils that hang together by their nodes, of so many."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    many = stencils.shape[1] - 1
    links = np.repeat(stencils[:, 0], many), stencils[:, 1:].ravel()
    graph = coo_array((np.ones(len(links[0])), links), shape=(count, count))
    labels = connected_components(graph, directed=False)[1][stencils[:, 0]]
    for label in np.unique(labels):
        yield np.flatnonzero(labels == label)


def _touch(pressed: ContactForces, patch: np.ndarray, obstacle: str | None) -> ContactPatch:
    forces = pressed.forces[patch]
    weights = np.linalg.norm(forces, axis=1)
    if obstacle is None:  # which side of a pair is the first has no meaning
        forces = np.where(forces @ forces[np.argmax(weights)] < 0, -1.0, 1.0)[:, None] * forces
    return ContactPatch(
        place=weights @ pressed.places[patch] / weights.sum(), force=forces.sum(axis=0), obstacle=obstacle
    )
