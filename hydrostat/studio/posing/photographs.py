"""`Photographs`: photographs of the built robot on its poses, compared with the simulation and fitted."""

from collections.abc import Mapping
from pathlib import Path

from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.photograph_work import (
    ComparedPhotograph,
    Comparison,
    PhotographFit,
    PoseFile,
    compare_photographs,
    fit_photographs,
)

MAX_PHOTOGRAPHS = 24
"""Photographs that are kept."""

MAX_BYTES = 25_000_000
"""Bytes of a photograph."""


class Photographs:
    """Photographs, compared and fitted in a process of its own. They belong to this sitting and are not saved.

    A photograph shows the pose that its name holds, such as left=12mm.jpg, or else the one on the screen when it was
    dropped.

    Attributes:
        files: the photographs.
        error: reason why the last comparison or fit failed; "" if it did not.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs
        self.files: tuple[PoseFile, ...] = ()
        self.error = ""
        self._comparison: tuple[Robot, tuple[PoseFile, ...], Comparison] | None = None
        self._fit: tuple[Robot, PhotographFit] | None = None

    @property
    def comparison(self) -> Comparison | None:
        """Comparison of these photographs with the robot as it is now, if it was made."""
        if self._comparison is None:
            return None
        robot, files, found = self._comparison
        return found if robot is self._document.robot and files == self.files else None

    @property
    def fit(self) -> PhotographFit | None:
        """Fit of the robot as it is now, or the one that made it."""
        if self._fit is None:
            return None
        assumed, found = self._fit
        return found if any(self._document.robot is one for one in (assumed, found.robot)) else None

    @property
    def is_applied(self) -> bool:
        """True if the robot has the fitted values."""
        return self._fit is not None and self._document.robot is self._fit[1].robot

    def find(self, name: str) -> ComparedPhotograph | None:
        """Compared photograph of a name; None before the comparison."""
        found = self.comparison
        return next((one for one in found.photographs if one.name == name), None) if found else None

    def add(self, name: str, content: bytes, contractions: Mapping[str, float]) -> None:
        """Take a photograph on a pose (InputError: too many, or too large); one of the same name is replaced."""
        if Path(name).name != name or name in ("", "..") or "\0" in name or len(name.encode()) > 200:
            raise InputError(f"{name[:60]!r}: not a file name. Rename the photograph.")
        if len(content) > MAX_BYTES:
            raise InputError(f"{name}: larger than {MAX_BYTES // 1_000_000} MB. Save it smaller.")
        kept = tuple(file for file in self.files if file.name != name)
        if len(kept) >= MAX_PHOTOGRAPHS:
            raise InputError(f"{name}: {MAX_PHOTOGRAPHS} photographs are here already. Remove one.")
        self.files = (*kept, PoseFile(name=name, content=content, contractions=dict(contractions)))
        self._ring()

    def remove(self, name: str) -> None:
        """Take a photograph away."""
        self.files = tuple(file for file in self.files if file.name != name)
        self._ring()

    def compare(self) -> None:
        """Compare all photographs with the simulation, as a job (InputError: there are none, or other work runs)."""
        if not self.files:
            raise InputError("no photographs. Drop one.")
        robot, files = self._document.robot, self.files

        def keep(found: Comparison) -> None:
            self._comparison = robot, files, found

        self._jobs.start("Comparing photographs", compare_photographs, robot, files, on_done=keep, on_end=self._end)

    def start_fit(self) -> None:
        """Fit the robot to the compared photographs, as a job (InputError: none are compared, or other work runs)."""
        found = self.comparison
        if found is None:
            raise InputError("compare the photographs first.")
        robot = self._document.robot

        def keep(fitted: PhotographFit) -> None:
            self._fit = robot, fitted

        self._jobs.start(
            "Fitting the robot", fit_photographs, robot, found.measurements, on_done=keep, on_end=self._end
        )

    def apply(self) -> None:
        """Give the robot its fitted values, one step to undo (InputError: there is no fit of this robot)."""
        found = self.fit
        if found is None or self.is_applied:
            raise InputError("no fit of this robot. Fit it to photographs first.")
        self._document.change("fitted to photographs", robot=found.robot)
        self._ring()

    def _end(self, error: str) -> None:
        self.error = error
        self._ring()

    def _ring(self) -> None:
        self._document.bell.ring(Topic.JOB, Topic.SCENE)
