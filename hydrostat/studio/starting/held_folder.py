"""`HeldFolder`: a folder that belongs to a process as long as that lives, however it ends."""

import os
import sys
from pathlib import Path
from secrets import token_hex
from shutil import rmtree
from typing import IO

LOCK = "lock"


class HeldFolder:
    """A new folder with a locked file in it. The system lets go of the lock when the process is gone, even if killed.

    Attributes:
        path: of the folder.
    """

    def __init__(self, parent: Path) -> None:
        """Make it.

        Raises:
            OSError: it cannot be made.
        """
        self.path = parent / f"{os.getpid()}-{token_hex(4)}"
        self.path.mkdir(parents=True)
        self._file: IO[bytes] = (self.path / LOCK).open("wb")
        _lock(self._file)

    def remove(self) -> None:
        """Remove the folder with all that is in it."""
        self.let_go()
        rmtree(self.path, ignore_errors=True)

    def let_go(self) -> None:
        """Leave the folder behind; another process may have it."""
        self._file.close()


def is_held(folder: Path) -> bool:
    """Whether a process that lives holds a folder."""
    try:
        with (folder / LOCK).open("r+b") as file:
            _lock(file)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False


def _lock(file: IO[bytes]) -> None:
    """Lock a file until it is closed.

    Raises:
        OSError: another has locked it.
    """
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
