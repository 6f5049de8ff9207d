"""`recall_code`: the code of a class, the same in each lesson."""

import os
import time
from contextlib import suppress
from datetime import date
from pathlib import Path
from secrets import choice

from hydrostat.errors import InputError
from hydrostat.files import replace_file

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # of a code: without i, l, o, 0 and 1
LENGTH = 8  # letters of a code: at 2,000 guesses a second, 13 years for all of them
FILE = "class_code"
CODE_LIFETIME = 90 * 24 * 3600  # browsers keep their code, room and nickname so long, and a laptop its code [s]


def new_code() -> str:
    """Return a token that pupils can copy from the board."""
    return "".join(choice(LETTERS) for _ in range(LENGTH))


def recall_code(state: Path | None) -> str:
    """Return the code of the last lesson, kept in a folder.

    It is a new one if that is lost, damaged or too old, or if other people on this computer could read it.
    """
    if state is None:
        return new_code()
    file = state / FILE
    with suppress(OSError, ValueError):
        code = file.read_text(encoding="ascii")
        facts = file.stat()
        is_private = os.name != "posix" or not facts.st_mode & 0o077
        if is_private and 0 <= time.time() - facts.st_mtime < CODE_LIFETIME and _is_code(code):
            return code
    code = new_code()
    with suppress(OSError, InputError):  # a full disk, a folder in its place: the next lesson has another code
        state.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(file, code.encode(), mode=0o600)
    return code


def forget_code(state: Path) -> None:
    """Remove the code of the last lesson from a folder (InputError: it cannot be removed)."""
    try:
        (state / FILE).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"--new-code: {state / FILE} cannot be removed ({error.strerror}).") from None


def find_code_date(state: Path) -> date | None:
    """Return the day on which the code in a folder was made; None if none is kept."""
    try:
        return date.fromtimestamp((state / FILE).stat().st_mtime)
    except OSError:
        return None


def _is_code(text: str) -> bool:
    return len(text) == LENGTH and set(text) <= set(LETTERS)
