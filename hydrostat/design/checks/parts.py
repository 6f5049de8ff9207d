"""`Parts`: the winches and cables of a network that constraints are for, and how what breaks them is told."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hydrostat.arrays import Float
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.robot import Cable, Mount, Robot, Winch

LENGTH = 2e-5  # lengths may miss a limit by so much [m], for coordinates are rounded to half of it
ANGLE = 0.1  # angles may miss a limit by so much [degrees], for the same reason


@dataclass(frozen=True, eq=False)
class Parts:
    """A network within constraints."""

    robot: Robot  # with the network
    constraints: Constraints  # that it should keep
    region: Region  # of its body
    sewn: frozenset[int] = frozenset()  # numbers of the cables that a kit sews to the skin: they need no clearance

    @cached_property
    def new_winches(self) -> tuple[int, ...]:
        """Numbers of the winches that are not locked."""
        winches, _ = self.constraints.staying(self.robot)
        return tuple(index for index, winch in enumerate(self.robot.winches) if winch not in winches)

    @cached_property
    def new_cables(self) -> tuple[int, ...]:
        """Numbers of the cables that are not locked."""
        locked = self.constraints.locked_cables
        return tuple(index for index, cable in enumerate(self.robot.cables) if cable.name not in locked)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Number of each winch by its name."""
        return {winch.name: index for index, winch in enumerate(self.robot.winches)}

    @cached_property
    def points(self) -> tuple[Float[np.ndarray, "_ dim"], ...]:
        """Points of each cable [m]."""
        return tuple(np.array(cable.points, dtype=float) for cable in self.robot.cables)

    def winch_of(self, cable: Cable) -> Winch:
        """The winch that pulls a cable."""
        return self.robot.winches[self.numbers[cable.winch]]

    def outside(self, cable: Cable) -> bool:
        """True if a cable begins in the world."""
        return self.winch_of(cable).mount is Mount.WORLD

    def winch_name(self, index: int) -> str:
        """A winch as a sentence begins with it."""
        return f"winch[{index}] {self.robot.winches[index].name}"

    @cached_property
    def edge(self) -> str:
        """Return the word for the boundary of a body."""
        return "edge" if self.robot.body.mesh.dim == 2 else "surface"

    def within(self, depth: float) -> str:
        """Return the depth in the body [m], in words; negative is outside."""
        return f"{mm(abs(depth))} {'inside' if depth >= 0 else 'outside'} the {self.edge}"


def mm(length: float) -> str:
    """A length [m] in millimeters, to a hundredth."""
    return f"{round(1e3 * float(length), 2) + 0.0:g} mm"


def place(point: Iterable[float]) -> str:
    """A place [m] in millimeters, to a tenth."""
    return "[" + ", ".join(f"{round(1e3 * float(value), 1) + 0.0:g}" for value in point) + "] mm"
