"""`unpack_robot`: the robot in a .zip, as `Exporter.robot_zip` packs it; no file of the archive goes elsewhere."""

import stat
import zlib
from io import BytesIO
from lzma import LZMAError
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from zipfile import BadZipFile, ZipFile, ZipInfo

from hydrostat.errors import InputError
from hydrostat.project import Work, open_note, open_work, text_of
from hydrostat.robot import FILE
from hydrostat.units import quote

MOST_FILES = 200  # in an archive
MOST_BYTES = 200_000_000  # of all its files, unpacked
DEEPEST = 4  # folders in one another


def unpack_robot(name: str, content: bytes) -> tuple[Work, str]:
    """Return the robot and the text of its robot.toml; sizes are checked before anything is unpacked.

    Raises:
        InputError: no archive, too large, a file that would climb out of its folder, or not one robot in it.
    """
    shown = quote(PurePosixPath(name.replace("\\", "/")).name[:60])
    folder = Path()
    try:
        with ZipFile(BytesIO(content)) as archive, TemporaryDirectory() as scratch:
            folder = Path(scratch)
            entries = _check_entries(archive.infolist(), shown)
            home = _home(list(entries), shown)
            for path, entry in entries.items():
                if path.parent == home or home in path.parents:
                    _write(archive, entry, folder / path.relative_to(home), shown)
            if note := open_note(folder):
                raise InputError(f"{shown}: {note}")
            return open_work(folder), text_of(folder)
    except InputError as error:  # of robot.toml, by the name of a scratch folder that nobody knows
        raise InputError(str(error).replace(f"{folder}/", f"{shown}: ")) from None
    except (BadZipFile, EOFError, NotImplementedError, RuntimeError, OSError, zlib.error, LZMAError) as error:
        words = str(error).replace(f"{folder}/", "")
        raise InputError(f"{shown}: cannot be unpacked ({words}); download the robot again") from None


def _check_entries(entries: list[ZipInfo], shown: str) -> dict[PurePosixPath, ZipInfo]:
    """Files by their paths, none of which leads out of the archive."""
    files = [entry for entry in entries if not entry.is_dir()]
    if len(files) > MOST_FILES:
        raise InputError(f"{shown}: has {len(files)} files, at most {MOST_FILES} are read")
    total = sum(entry.file_size for entry in files)
    if total > MOST_BYTES:
        raise InputError(f"{shown}: has {total / 1e6:.0f} MB unpacked, at most {MOST_BYTES / 1e6:.0f} MB are read")
    found: dict[PurePosixPath, ZipInfo] = {}
    for entry in files:
        path = PurePosixPath(entry.filename)
        odd = path.is_absolute() or ".." in path.parts or "\\" in entry.filename or ":" in entry.filename
        if odd or len(path.parts) > DEEPEST or stat.S_ISLNK(entry.external_attr >> 16):
            raise InputError(f"{shown}: {quote(entry.filename[:60])} would lie outside the robot's folder")
        if path in found:
            raise InputError(f"{shown}: has two files {quote(entry.filename[:60])}")
        found[path] = entry
    return found


def _home(paths: list[PurePosixPath], shown: str) -> PurePosixPath:
    """The folder of the robot in the archive."""
    homes = sorted((path.parent for path in paths if path.name == FILE), key=lambda home: len(home.parts))
    if not homes:
        raise InputError(f"{shown}: no {FILE} found. This is not a robot: use Download robot, not a kit or pictures")
    if len(homes) > 1 and len(homes[1].parts) == len(homes[0].parts):
        raise InputError(f"{shown}: has {len(homes)} robots in it. Import one at a time")
    return homes[0]


def _write(archive: ZipFile, entry: ZipInfo, goal: Path, shown: str) -> None:
    """One file, and no more of it than its entry says."""
    goal.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(entry) as source:
        data = source.read(entry.file_size + 1)
    if len(data) > entry.file_size:
        raise InputError(f"{shown}: {quote(entry.filename[:60])} is larger than it says")
    goal.write_bytes(data)
