"""`Download`, `archive`, `work_zip`: a file to take home, many files as one, a robot as one."""

import io
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from hydrostat.project import Work


@dataclass(frozen=True, kw_only=True)
class Download:
    """A file in memory; it is written nowhere until a person downloads it."""

    name: str  # of the file
    content: bytes = field(repr=False)  # of it
    title: str = ""  # what it is, as a person would say it

    @property
    def media_type(self) -> str:
        """Name that browsers have for its kind, such as "image/png"."""
        return MEDIA_TYPES.get(self.name.rpartition(".")[2], "application/octet-stream")

    @property
    def size(self) -> str:
        """In words, such as "1.4 MB"."""
        count = len(self.content)
        return f"{count / 1e6:.1f} MB" if count >= 100_000 else f"{max(count / 1e3, 0.1):.3g} kB"


MEDIA_TYPES = {"zip": "application/zip", "png": "image/png", "svg": "image/svg+xml", "html": "text/html"}


def archive(files: Mapping[str, bytes], *, folder: str) -> bytes:
    """Files, content by path, as a zip with all of them in one folder, sorted by their names."""
    buffer = io.BytesIO()
    epoch = (1980, 1, 1, 0, 0, 0)  # the date of all files: the first that a zip can have
    mode = 0o644 << 16  # everybody may read what is unpacked
    with ZipFile(buffer, "w") as zipped:
        for path in sorted(files):
            entry = ZipInfo(f"{folder}/{path}", epoch)
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, mode
            zipped.writestr(entry, files[path])
    return buffer.getvalue()


def work_files(work: Work, text: str) -> dict[str, bytes]:
    """Files of the folder of a robot by their paths; the text is that of the robot.toml that it was opened from."""
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        work.save(folder, text)
        paths = [path for path in folder.rglob("*") if path.is_file()]
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def work_zip(work: Work, text: str) -> Download:
    """The folder of a robot in one file."""
    name = file_name(work.robot.name)
    return Download(name=f"{name}.zip", content=archive(work_files(work, text), folder=name), title="Robot")


def file_name(name: str) -> str:
    """A name of a robot or pose as part of the name of a file: letters, digits, "-" and "_"."""
    return re.sub(r"[^\w-]+", "_", name).strip("_") or "robot"
