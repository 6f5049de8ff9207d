"""`Kit`: everything that a robot is built from, as files (R9 to R14, R50 to R57)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_folder import write_files
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.self_check import Check
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot
from hydrostat.units import counted


class UnbuildableError(InputError):
    """A robot cannot be built well as it is.

    Attributes:
        reasons: a line each.
    """

    def __init__(self, reasons: tuple[str, ...]) -> None:
        super().__init__(f"it cannot be built well, for {counted(len(reasons), 'reason')}: {'; '.join(reasons)}")
        self.reasons = reasons


@dataclass(frozen=True, eq=False, kw_only=True)
class Kit:
    """Everything that a robot is built from.

    Attributes:
        robot: that is built.
        method: how its body is made.
        motor: key of the motor in its winches.
        printed: all parts for a 3D printer.
        files: content by path.
        summary: what is in it, a line each.
        problems: why it cannot be built well; only with `force`.
        warnings: what to mind.
        checks: whether the files are true to the robot that was simulated.
    """

    robot: Robot
    method: Method
    motor: str
    printed: tuple[Printed, ...]
    files: Mapping[str, bytes]
    summary: tuple[str, ...]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]

    def write(self, folder: str | Path) -> list[Path]:
        """Write all files into a folder, made if need be; what an earlier kit left there is removed.

        Raises:
            InputError: the folder or a file cannot be written.
        """
        return write_files(self.files, folder)
