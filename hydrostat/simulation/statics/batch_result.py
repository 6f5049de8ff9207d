"""`BatchResult`: equilibria at many contractions, computed by several threads, for sampling and learning."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Bool, Float, Nodes, Points, Vector
from hydrostat.errors import HydrostatError, InputError
from hydrostat.geometry import Anchors
from hydrostat.mechanics import NewtonStatus
from hydrostat.result_table import Columns, Tabular, control_columns, marker_columns, named_columns
from hydrostat.robot import Robot
from hydrostat.simulation.equilibrium import Equilibrium

Derivatives = Float[np.ndarray, "markers dim winches"]
"""Jacobian of the marker positions by the contractions."""


LONG_ENOUGH = 2e-4
"""Modelled time of a factorization [s] from which on threads pay: below, they mostly wait for Python's lock."""


class PoseRow(NamedTuple):
    """One equilibrium of a batch.

    Attributes:
        markers: marker positions [m]; None without an equilibrium, as for all fields below.
        tensions: tension of each cable [N].
        jacobian: Jacobian of the markers by the contractions; None if not requested or undefined.
        nodes: node positions [m]; None if not requested.
        stable: True if it is an energy minimum.
        status: stop reason of the solver; None after an error.
        trouble: error text; empty without an error.
        warnings: warnings of the equilibrium, as in `BatchResult`.
    """

    markers: Points | None = None
    tensions: Vector | None = None
    jacobian: Derivatives | None = None
    nodes: Nodes | None = None
    stable: bool = False
    status: NewtonStatus | None = None
    trouble: str = ""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class BatchResult(Tabular):
    """Equilibria at many contractions, one row each; NaN marks a missing value.

    Attributes:
        contractions: contractions [m], (poses, winches).
        markers: marker positions [m], (poses, markers, dim), in the robot's order.
        tensions: tension of each cable [N], (poses, cables).
        jacobians: exact Jacobians of the markers with respect to the contractions, (poses, markers, dim, winches); None
            if not requested.
        nodes: node positions [m], (poses, nodes, dim); None if not requested.
        statuses: stop reason of each solve; None after an error.
        stable: True where the equilibrium is an energy minimum, not a saddle, (poses,).
        errors: error text of each solve; empty without an error.
        warnings: `Equilibrium.warnings` of each solve; empty after an error. Self-intersection is checked in flat
            bodies only: in space, this takes as long as the solve.
        robot: simulated robot.
    """

    contractions: Float[np.ndarray, "poses winches"]
    markers: Float[np.ndarray, "poses markers dim"]
    tensions: Float[np.ndarray, "poses cables"]
    jacobians: Float[np.ndarray, "poses markers dim winches"] | None
    nodes: Float[np.ndarray, "poses nodes dim"] | None
    statuses: tuple[NewtonStatus | None, ...]
    stable: Bool[np.ndarray, " poses"]
    errors: tuple[str, ...]
    warnings: tuple[tuple[str, ...], ...]
    robot: Robot

    def columns(self) -> Columns:
        """Return a table of contractions, drive values, markers and tensions, one row for each pose."""
        robot = self.robot
        drives = {drive.name: drive.unit for drive in robot.drives}
        columns = control_columns([winch.name for winch in robot.winches], drives, self.contractions)
        columns |= marker_columns({m.name: self.markers[:, row] for row, m in enumerate(robot.markers)})
        return columns | named_columns("tension", [cable.name for cable in robot.cables], self.tensions, "N")

    def texts(self) -> dict[str, list[str]]:
        """Return the status of each row, and its error and warnings as one text."""
        told = zip(self.errors, self.warnings, strict=True)
        return {
            "status": [str(status or "error") for status in self.statuses],
            "warnings": ["; ".join(filter(None, (error, *warnings))) for error, warnings in told],
        }

    @property
    def converged(self) -> Bool[np.ndarray, " poses"]:
        """Mask of the rows with an equilibrium."""
        return np.array([status is NewtonStatus.CONVERGED for status in self.statuses], dtype=bool)

    def __len__(self) -> int:
        return len(self.statuses)

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<BatchResult: {self.converged.sum()} of {len(self)} converged; markers {self.markers.shape}>"


def pose_row(
    pose: Equilibrium,
    anchors: Anchors,
    *,
    keep: bool,
    jacobian_of: Callable[[Equilibrium], np.ndarray] | None,
    diagnose: Callable[[Equilibrium], Sequence[str]],
) -> PoseRow:
    """Return the row of a pose.

    Args:
        pose: result of the solver.
        anchors: nodes and weights that hold the markers.
        keep: True to keep the nodes.
        jacobian_of: returns the Jacobian of the markers by the contractions; None if not requested.
        diagnose: tells why there is no equilibrium.
    """
    status, trouble, jacobian = pose.result.status, "", None
    if not pose.result.converged:
        return PoseRow(status=status, trouble="; ".join([status, *diagnose(pose)]))
    if jacobian_of is not None:
        try:
            jacobian = jacobian_of(pose)
        except HydrostatError as error:
            trouble = str(error)
    return PoseRow(
        markers=anchors.positions(pose.nodes),
        tensions=pose.tensions,
        jacobian=jacobian,
        nodes=pose.nodes if keep else None,
        stable=pose.result.stable,
        status=status,
        trouble=trouble,
        warnings=pose.find_warnings(crossings=pose.robot.body.mesh.dim == 2),
    )


def solve_rows(
    robot: Robot,
    contractions: Float[np.ndarray, "poses winches"],
    solve: Callable[[int], PoseRow],
    *,
    jacobians: bool,
    nodes: bool,
    threads: int,
    cost: float,
) -> BatchResult:
    """Solve each row of contractions, by threads where they pay, and gather the rows in arrays.

    Args:
        robot: robot that is solved.
        contractions: one row for each pose [m].
        solve: returns the row of a number.
        jacobians: True for rows with Jacobians.
        nodes: True for rows with nodes.
        threads: threads that may work.
        cost: time of one factorization of the body [s]; small ones are faster in one thread.

    Raises:
        InputError: no number of threads.
    """
    rows = in_threads(solve, len(contractions), threads, pays=cost >= LONG_ENOUGH)
    mesh, markers = robot.body.mesh, (len(robot.markers), robot.body.mesh.dim)
    return BatchResult(
        contractions=contractions,
        markers=_stack([row.markers for row in rows], markers),
        tensions=_stack([row.tensions for row in rows], (len(robot.cables),)),
        jacobians=_stack([row.jacobian for row in rows], (*markers, contractions.shape[1])) if jacobians else None,
        nodes=_stack([row.nodes for row in rows], mesh.nodes.shape) if nodes else None,
        statuses=tuple(row.status for row in rows),
        stable=np.array([row.stable for row in rows], dtype=bool),
        errors=tuple(row.trouble for row in rows),
        warnings=tuple(row.warnings for row in rows),
        robot=robot,
    )


def in_threads(work: Callable[[int], PoseRow], size: int, threads: int, *, pays: bool) -> list[PoseRow]:
    """Collect the results of `work` for 0 to `size` - 1, by several threads if that pays.

    An error ends its own row alone. Ctrl-C ends all as soon as the rows under way are done.

    Raises:
        InputError: no number of threads.
    """
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise InputError(f"threads must be a whole number from 1 on, not {threads!r}")
    rows = [PoseRow()] * size
    numbers = count()
    stopped = False

    def some() -> None:
        for number in _below(numbers, size):
            if stopped:
                return
            try:
                rows[number] = work(number)
            except Exception as error:  # noqa: BLE001  # one of thousands must not end the others; its text is kept
                rows[number] = PoseRow(trouble=f"{type(error).__name__}: {error}")

    if threads == 1 or size < 2 or not pays:
        some()
        return rows
    look = 0.1  # So often the waiting thread looks for Ctrl-C [s]
    with ThreadPoolExecutor(min(threads, size), thread_name_prefix="hydrostat") as pool:
        try:
            working = [pool.submit(some) for _ in range(min(threads, size))]
            while wait(working, timeout=look).not_done:  # Ctrl-C does not end a wait without limit everywhere
                pass
        finally:
            stopped = True
    return rows


def _below(numbers: Iterator[int], size: int) -> Iterator[int]:
    """Take numbers as long as they are below `size`; `next` of a count is one step that threads cannot share."""
    while (number := next(numbers)) < size:
        yield number


def _stack(parts: Sequence[np.ndarray | None], shape: tuple[int, ...]) -> np.ndarray:
    """One array of all parts; NaN for those that are missing."""
    result = np.full((len(parts), *shape), np.nan)
    for place, part in enumerate(parts):
        if part is not None:
            result[place] = part
    return result
