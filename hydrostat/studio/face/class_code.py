"""`recall_code`: the code of a class, the same in each lesson."""

import time
from contextlib import suppress
from pathlib import Path
from secrets import choice

from hydrostat.files import replace_file

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"  # of a code: without i, l, o, 0 and 1
LENGTH = 8  # letters of a code: at 2,000 guesses a second, 13 years for all of them
KEPT = 90 * 24 * 3600  # browsers keep their code, room and nickname so long, and a laptop its code [s]


def new_code() -> str:
    """Return a token that pupils can copy from the board."""
    return "".join(choice(LETTERS) for _ in range(LENGTH))


def recall_code(state: Path | None) -> str:
    """Return the code of the last lesson, kept in a folder; a new one if that is lost, damaged or too old."""
    if state is None:
        return new_code()
    file = state / "class_code"
    with suppress(OSError, ValueError):
        code = file.read_text(encoding="ascii")
        age = time.time() - file.stat().st_mtime
        if 0 <= age < KEPT and len(code) == LENGTH and set(code) <= set(LETTERS):
            return code
    code = new_code()
    with suppress(OSError):  # of a full disk: the next lesson has another code
        state.mkdir(parents=True, exist_ok=True)
        replace_file(file, code.encode())
        file.chmod(0o600)
    return code
