"""`Kit`: what a robot is built from, as files (R9 to R14, R50 to R57); its manifest, folder and self-check."""

import hashlib
import html
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path, PurePosixPath
from typing import Any

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.files import replace_files
from hydrostat.robot import Robot, robot_hash
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True)
class Check:
    """A claim that was measured on the finished drawing or solid, not on its inputs."""

    what: str  # the claim, such as "pinholes are where the cables pass"
    measured: str  # measured value with its unit, such as "at most 0.004 mm off"
    allowed: str  # tolerance, such as "0.1 mm"
    passed: bool  # True if the measured value is allowed


MANIFEST = "manifest.json"  # its file in a kit; written last, so that a kit without it is not whole

_MAKERS = ("hydrostat", "ezdxf", "libigl", "manifold3d", "numpy", "scipy", "shapely", "typst")
"""Packages on which the bytes of a kit depend."""


class UnbuildableError(InputError):
    """Error for a robot that cannot be built well.

    Attributes:
        reasons: problems, one line each.
    """

    def __init__(self, reasons: tuple[str, ...]) -> None:
        count = f"{plural(len(reasons), 'problem')} {'prevents' if len(reasons) == 1 else 'prevent'}"
        super().__init__(f"{count} fabrication: {'; '.join(reasons)}")
        self.reasons = reasons


@dataclass(frozen=True, eq=False, kw_only=True)
class Kit:
    """Build kit: all files and parts for a robot.

    Attributes:
        robot: robot of the kit.
        method: fabrication method of the body.
        motor: key of the motor in its winches.
        torques: largest torque of each winch in its poses [N m], for `motor_offers`.
        printed: all 3D-printed parts.
        files: content by path.
        summary: contents, one line each.
        problems: reasons why it cannot be built well; empty without `force`.
        warnings: warnings for the builder, one line each.
        notes: information for the builder, one line each.
        checks: comparisons of the files with the simulated robot.
    """

    robot: Robot
    method: Method
    motor: str
    torques: tuple[float, ...] = ()
    printed: tuple[Printed, ...]
    files: Mapping[str, bytes]
    summary: tuple[str, ...]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]
    notes: tuple[str, ...] = ()
    checks: tuple[Check, ...]

    def __repr__(self) -> str:
        """Return a one-line summary."""
        passed = sum(check.passed for check in self.checks)
        return f"<Kit of {self.robot.name}: {len(self.files)} files, {passed} of {len(self.checks)} checks passed>"

    def _repr_html_(self) -> str:
        """Contents, problems and warnings, for a notebook."""
        lines = (repr(self), *self.summary, *self.problems, *self.warnings)
        return f"<pre>{html.escape(chr(10).join(lines))}</pre>"

    def write(self, folder: str | Path) -> list[Path]:
        """Write all files to a folder, replacing an earlier kit (InputError: a file cannot be written)."""
        return write_files(self.files, folder)

    @staticmethod
    def forget_files(folder: str | Path) -> None:
        """Remove a kit from a folder, except files that were changed or added since."""
        folder = Path(folder)
        for path in (*_written_before(folder), MANIFEST):
            _remove(folder / path, folder)
        with suppress(OSError):
            folder.rmdir()


def manifest(
    robot: Robot, options: KitOptions, files: Mapping[str, bytes], *, checks: Sequence[Check], told: Mapping[str, Any]
) -> bytes:
    """Return the text of manifest.json; `told` holds further entries, such as warnings and sizes."""
    told = {
        "robot": {"name": robot.name, "sha256": robot_hash(robot)},
        **told,
        "options": asdict(options),
        "checks": [asdict(check) for check in checks],
        "versions": {name: version(name) for name in _MAKERS},
        "files": {
            path: {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
            for path, content in sorted(files.items())
        },
    }
    return (json.dumps(told, indent=2, ensure_ascii=False) + "\n").encode()


def write_files(files: Mapping[str, bytes], folder: str | Path) -> list[Path]:
    """Write all files of a kit, by path, the manifest last, into a folder made if need be; returns them sorted.

    An earlier kit stays whole until all files are on the disk. What it left in the folder and this one has not is then
    removed, unless it was changed since. Raises InputError if the folder or a file cannot be written.
    """
    folder = Path(folder)
    stale = [path for path in _written_before(folder) if path not in files]
    places = {folder / path: files[path] for path in sorted(files, key=lambda path: (path == MANIFEST, path))}
    made: list[Path] = []
    try:
        for parent in sorted({place.parent for place in places}):
            made += [above for above in (*reversed(parent.parents), parent) if not above.exists() and above not in made]
            parent.mkdir(parents=True, exist_ok=True)
        replace_files(places, outdated=folder / MANIFEST)
    except (OSError, InputError) as error:
        for empty in reversed(made):
            with suppress(OSError):
                empty.rmdir()
        if isinstance(error, InputError):
            raise
        raise InputError(f"{error.filename or folder}: cannot be written ({error.strerror})") from None
    for path in stale:
        _remove(folder / path, folder)
    return sorted(places)


def _written_before(folder: Path) -> Iterator[str]:
    """Files of the kit whose manifest is in a folder, as far as they are unchanged."""
    try:
        told = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        known = {str(path): str(facts["sha256"]) for path, facts in told.items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return
    for path, digest in known.items():
        inside = not PurePosixPath(path).is_absolute() and ".." not in PurePosixPath(path).parts
        with suppress(OSError):
            if inside and hashlib.sha256((folder / path).read_bytes()).hexdigest() == digest:
                yield path


def _remove(path: Path, folder: Path) -> None:
    """Remove a file, and its folder if that leaves it empty."""
    with suppress(OSError):
        path.unlink()
        if path.parent != folder:
            path.parent.rmdir()
