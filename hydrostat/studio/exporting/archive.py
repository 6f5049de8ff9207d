"""`archive`: files as one zip; the same files give the same bytes."""

import io
import re
from collections.abc import Mapping
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The date of all files: the first that a zip can have."""

MODE = 0o644 << 16
"""Everybody may read what is unpacked."""


def archive(files: Mapping[str, bytes], *, folder: str) -> bytes:
    """Files as a zip, sorted by their names.

    Args:
        files: content by path.
        folder: that all of them are put in.
    """
    buffer = io.BytesIO()
    with ZipFile(buffer, "w") as zipped:
        for path in sorted(files):
            entry = ZipInfo(f"{folder}/{path}", EPOCH)
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, MODE
            zipped.writestr(entry, files[path])
    return buffer.getvalue()


def file_name(name: str) -> str:
    """A name of a robot or pose as part of the name of a file: letters, digits, "-" and "_"."""
    return re.sub(r"[^\w-]+", "_", name).strip("_") or "robot"
