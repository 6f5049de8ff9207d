"""`temporary_path`: name of a file or folder while it is written; `clear_unfinished`: remove those never completed."""

import os
import platform
import re
import shutil
import threading
from contextlib import suppress
from pathlib import Path

_HOST = re.sub(r"\W", "_", platform.node())[:24] or "here"
_NAME = re.compile(rf"\..*\.{_HOST}-(\d+)-\d+\.part", re.DOTALL)


def temporary_path(path: Path) -> Path:
    """Return the hidden path next to a path at which it is written first: unique to each writer on each machine."""
    longest = 40  # letters of the name that are kept, as no name has more than 255 bytes
    return path.with_name(f".{path.name[:longest]}.{_HOST}-{os.getpid()}-{threading.get_native_id()}.part")


def clear_unfinished(folder: Path) -> None:
    """Remove from a folder the unfinished files of this machine's writers that no longer run, such as killed ones."""
    try:
        found = [(entry, _NAME.fullmatch(entry.name)) for entry in os.scandir(folder)]
    except OSError:
        return
    for entry, named in found:
        if named is None or _lives(int(named[1])):
            continue
        with suppress(OSError):
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                os.unlink(entry.path)


def _lives(process: int) -> bool:
    if os.name != "posix":
        return True  # there a signal 0 would end it
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
