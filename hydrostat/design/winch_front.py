"""`winch_front`: the best networks by number and kind of winches, with what each takes to build."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hydrostat.design.build_cost import BuildCost
from hydrostat.design.network import Alternative, Network


@dataclass(frozen=True, kw_only=True)
class FrontRow:
    """Best network of a number of winches that pull one way, or both ways."""

    winches: int  # number of winches
    two_way: bool  # True if a winch pulls both ways
    cables: int  # number of cables
    expected_error: float  # rms error expected of a robot as it is built [m]
    cost: BuildCost  # money and labor to build it
    is_chosen: bool  # True for the network that the design returns
    is_best: bool  # True if no other row has as small an error for as little money and as few minutes

    @property
    def title(self) -> str:
        """Such as "1" or "2, both ways"."""
        return f"{self.winches}{', both ways' if self.two_way else ''}"

    @property
    def note(self) -> str:
        """The note "chosen" or "no better"; empty for others."""
        return "chosen" if self.is_chosen else "" if self.is_best else "no better"

    @property
    def as_values(self) -> Mapping[str, Any]:
        """Plain values for score.json."""
        return {
            "winches": self.winches,
            "two_way": self.two_way,
            "cables": self.cables,
            "rms_error_as_built": self.expected_error,
            "best": self.is_best,
            "craft": self.cost.as_values,
        }


def winch_front(network: Network) -> tuple[FrontRow, ...]:
    """The network of the least as-built error for each number and kind of winches; the chosen one for its own."""
    best: dict[tuple[int, bool], Alternative | Network] = {}
    for one in (*sorted(network.alternatives, key=lambda one: -one.expected_error), network):  # the last one stays
        best[len(one.robot.winches), any(cable.reverse for cable in one.robot.cables)] = one
    costs = {kind: one.cost for kind, one in best.items()}
    points = {kind: (one.expected_error, costs[kind].price, costs[kind].minutes) for kind, one in best.items()}
    return tuple(
        FrontRow(
            winches=kind[0], two_way=kind[1], cables=len(one.robot.cables), expected_error=one.expected_error,
            cost=costs[kind], is_chosen=one is network,
            is_best=not any(
                other != kind and all(a <= b for a, b in zip(point, points[kind], strict=True))
                for other, point in points.items()
            ),
        )
        for kind, one in sorted(best.items(), key=lambda item: item[0])
    )  # fmt: skip
