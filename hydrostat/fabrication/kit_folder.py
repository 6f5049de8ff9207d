"""`write_files`: a kit as a folder, without leftovers of the kit that was there before."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath

from hydrostat.errors import InputError
from hydrostat.fabrication.manifest import NAME
from hydrostat.robot import replace_file


def write_files(files: Mapping[str, bytes], folder: str | Path) -> list[Path]:
    """Write all files of a kit, the manifest last.

    What an earlier kit left in the folder and this one has not is removed, unless it was changed since.

    Args:
        files: content by path in the kit, the manifest among them.
        folder: made if need be.

    Returns:
        The files, sorted.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    folder = Path(folder)
    stale = [path for path in _written_before(folder) if path not in files]
    try:
        (folder / NAME).unlink(missing_ok=True)
        for path in sorted(files):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{error.filename or folder}: cannot be written ({error.strerror})") from None
    for path in stale:
        _remove(folder / path, folder)
    last = sorted(files, key=lambda path: (path == NAME, path))
    return sorted(replace_file(folder / path, files[path]) for path in last)


def forget_files(folder: str | Path) -> None:
    """Remove a kit from a folder, but for what was changed or added since."""
    folder = Path(folder)
    for path in (*_written_before(folder), NAME):
        _remove(folder / path, folder)
    with suppress(OSError):
        folder.rmdir()


def _written_before(folder: Path) -> Iterator[str]:
    """Files of the kit whose manifest is in a folder, as far as they are unchanged."""
    try:
        told = json.loads((folder / NAME).read_text(encoding="utf-8"))["files"]
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
