"""`PortablePolicy`: what a robot learned to do by trial, in any task; one file, which runs without PyTorch."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.portable_file import PortableFile, check_fact


@dataclass(frozen=True, kw_only=True, eq=False)
class PortablePolicy:
    """Policy network with a tanh output, from an observation to an action.

    Attributes:
        facts: task, robot and its physics hash, observations, and accuracy.
        network: network from the observations, joined in order, to the components of an action.
    """

    facts: Mapping[str, Any]
    network: Perceptrons

    def act(self, seen: Mapping[str, Vector]) -> Vector:
        """Return the action for an observation, values from -1 to 1.

        Raises:
            InputError: an observation is missing or has a wrong number of coordinates, or the network returns a value
                that is not finite.
        """
        parts = []
        for name, count in self.facts["sees"]:
            part = np.asarray(seen.get(name, ()), dtype=float).ravel()
            if part.shape != (count,) or not np.isfinite(part).all():
                raise InputError(f"the policy must see {count} finite numbers of {name}")
            parts.append(part)
        action = np.tanh(self.network.values(np.concatenate(parts))[0])
        if not np.isfinite(action).all():
            raise InputError("the policy answers with no number: it was never learned; use another")
        return action

    def save(self, path: str | Path) -> Path:
        """Write the policy to a file atomically (InputError: the file cannot be written)."""
        arrays = {"actor.sizes": self.network.sizes, "actor.numbers": self.network.numbers}
        return _FILE.write(path, self.facts, arrays)

    @staticmethod
    def load(path: str | Path) -> "PortablePolicy":
        """Load a policy that `hydrostat train` has written.

        Raises:
            InputError: no such file, a file that was changed after it was written, or a format that this version cannot
                read.
        """
        return _FILE.read(path, _policy)


def _policy(facts: dict[str, Any], arrays: dict[str, np.ndarray]) -> PortablePolicy:
    """The policy of its parts (ValueError: they do not fit one another)."""
    for name, kind in _FACTS.items():
        check_fact(name, facts.get(name), kind)
    sees, actions = facts["sees"], facts["actions"]
    sound = all(isinstance(name, str) and type(count) is int and count > 0 for name, count in sees)
    if not (sees and sound and actions > 0 and isfinite(facts["error"])):
        raise ValueError("what it sees or does is nothing")
    inputs = sum(count for _, count in sees)
    return PortablePolicy(facts=facts, network=Perceptrons.of(arrays, "actor", inputs, actions))


_FACTS: Mapping[str, Any] = {
    "task": str,
    "robot": str,
    "physics": str,
    "sees": list,
    "actions": int,
    "error": (int, float),
}
"""Facts of a policy, and their kinds."""

_FILE = PortableFile(
    magic=b"HSPOLICY",
    word="policy",
    writer="hydrostat train",
    kinds={"actor.sizes": ("<i8", 1), "actor.numbers": ("<f4", 2)},
)
