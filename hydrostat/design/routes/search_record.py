"""`SearchRecord`: steps of a search as plain values, from which a stopped search continues."""

import json
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

import numpy as np

from hydrostat.design.request import DesignRequest
from hydrostat.errors import InputError
from hydrostat.files import read_stranger, replace_file
from hydrostat.robot import Robot, robot_hash
from hydrostat.version import __version__

Step = Mapping[str, Any]
"""Words on a step, the networks it found (None where they must be computed again), and how many were tried."""


class SearchRecord:
    """Steps of a search, in order.

    A search that is given the steps of an earlier one takes them from there, as long as they last, and computes the
    rest: the same robot and request lead to the same network as without a stop. Steps are whole pieces of work, such
    as a refined network, so a search that stops loses the piece it is at.
    """

    def __init__(self, known: Sequence[Step] = ()) -> None:
        """Begin a record; `known` are the steps of an earlier search."""
        self.known = tuple(known)
        self.steps: list[Step] = []
        self.on_step: Callable[[], None] | None = None  # called after each step
        self._paused = 0

    @property
    def is_paused(self) -> bool:
        """True while steps are parts of others, and after the search."""
        return self._paused > 0

    @contextmanager
    def pause(self) -> Generator[None, None, None]:
        """Keep no steps within a block."""
        self._paused += 1
        try:
            yield
        finally:
            self._paused -= 1

    def take(self, words: str) -> Step | None:
        """The next step if it is known; None if not (InputError: it is a step of another search)."""
        number = len(self.steps)
        if number >= len(self.known):
            return None
        step = self.known[number]
        if step["step"] != words:
            raise InputError(f'step {number + 1} is "{step["step"]}", not "{words}": it is of another search')
        return step

    def add(self, step: Step) -> None:
        """Add a step."""
        self.steps.append(step)
        if self.on_step is not None:
            self.on_step()

    def write(self, file: Path, robot: Robot, request: DesignRequest) -> None:
        """Write it as JSON, with the robot and the request (InputError: it cannot be written)."""
        every = [*self.steps, *self.known[len(self.steps) :]]  # a search that stops early forgets no known step
        steps = ",\n".join(json.dumps(step, default=np.ndarray.tolist) for step in every)
        head = json.dumps(_identity(robot, request), indent=1)[:-2]
        replace_file(file, f'{head},\n "steps": [\n{steps}\n]\n}}\n'.encode())

    @classmethod
    def read(cls, file: Path, robot: Robot, request: DesignRequest) -> Self:
        """Read what `write` wrote (InputError: no such file, or that of another robot, request or version)."""
        largest = 2_000_000_000  # maximum size of the file [bytes]
        content = read_stranger(file, most=largest)
        try:
            read = json.loads(content)
            steps = read["steps"]
            known = all(
                isinstance(step["step"], str)
                and isinstance(step["tried"], int)
                and isinstance(step["networks"], list | None)
                for step in steps
            )
        except (ValueError, TypeError, LookupError, RecursionError):
            read, steps, known = {}, [], False
        if not known:
            raise InputError(f"{file}: not the record of a search. Start without --resume.")
        asked = json.loads(json.dumps(_identity(robot, request)))
        if (read.get("version"), _fields(read.get("request"))) != (__version__, _fields(asked["request"])):
            raise InputError(f"{file}: written by another version of hydrostat. Start without --resume.")
        for name, value in asked.items():
            if read.get(name) != value:
                own = _differences(read.get(name), value) if name == "request" else name
                raise InputError(f"{file}: record of another search ({own} differs). Start without --resume.")
        return cls(steps)


def _identity(robot: Robot, request: DesignRequest) -> dict[str, Any]:
    """Values by which a record belongs to a search; the time limit may change, and searches after it."""
    asked = {name: value for name, value in request.as_values().items() if name not in ("seconds", "front")}
    poses = {pose.name: {name: list(at) for name, at in pose.targets.items()} for pose in request.poses}
    return {"version": __version__, "robot": robot_hash(robot), "request": asked | {"poses": poses}}


def _fields(request: object) -> set[str]:
    """Names of the fields of a request and of its records; poses have names of their own."""
    if not isinstance(request, Mapping):
        return set()
    below = (_fields(value) for name, value in request.items() if name != "poses")
    return set(request).union(*below)


def _differences(one: object, other: Mapping[str, Any]) -> str:
    """Names of the fields of a request that differ."""
    own = one if isinstance(one, Mapping) else {}
    return ", ".join(name for name, value in other.items() if own.get(name) != value)
