"""`pack_robot`, `unpack_robot_link`: the files of a flat robot as the end of a link, and back as a zip.

What stands after "#robot=" is deflated JSON in letters that links may have. It goes to no server until a page that was
opened reads it; then it is checked as any .zip that a person brings.
"""

import json
import zlib
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Mapping
from io import BytesIO
from zipfile import ZipFile

from hydrostat.errors import InputError

LINK_MARK = "#robot="
MAX_LETTERS = 30_000  # no link is longer
MAX_BYTES = 300_000  # of all files, unpacked
WRONG = "this link is incomplete or holds no robot. Copy all of it again"
MAX_PATH = 255  # letters; a zip holds paths of 65,535 bytes
MAX_FILES = 4  # robot.toml, the drawing, studio.json, and one more


def pack_robot(files: Mapping[str, bytes]) -> str:
    """The end of a link with the files of a robot, by their paths.

    Raises:
        InputError: a file is no text, or they are too many or too large.
    """
    try:
        texts = {path: content.decode() for path, content in files.items()}
    except UnicodeDecodeError:
        raise InputError(
            "a link holds flat robots with a drawing. Press Edit outline and Apply, or send the .zip"
        ) from None
    deflate = zlib.compressobj(9, wbits=-15)
    packed = deflate.compress(json.dumps(texts, ensure_ascii=False, separators=(",", ":")).encode()) + deflate.flush()
    letters = urlsafe_b64encode(packed).rstrip(b"=").decode()
    if len(letters) > MAX_LETTERS or len(files) > MAX_FILES or sum(map(len, files.values())) > MAX_BYTES:
        raise InputError(f"this robot needs {len(letters)} letters (maximum {MAX_LETTERS}). Send the .zip")
    return LINK_MARK + letters


def unpack_robot_link(link: str) -> bytes:
    """The files in a link as a zip, bounded before anything is unpacked.

    Raises:
        InputError: there is no robot in it, or too much.
    """
    letters = link.partition(LINK_MARK)[2].strip()
    if not 0 < len(letters) <= MAX_LETTERS:
        raise InputError(f"no robot in this link (1 to {MAX_LETTERS} letters after {LINK_MARK}). Copy it again")
    inflate = zlib.decompressobj(wbits=-15)
    try:
        packed = urlsafe_b64decode(letters.encode() + b"=" * (-len(letters) % 4))
        text = inflate.decompress(packed, MAX_BYTES + 1)
        files = json.loads(text) if inflate.eof and len(text) <= MAX_BYTES else None
    except (ValueError, zlib.error, RecursionError):
        files = None
    if not isinstance(files, dict) or len(files) > MAX_FILES:
        raise InputError(WRONG)
    if not all(isinstance(content, str) and len(path) <= MAX_PATH for path, content in files.items()):
        raise InputError(WRONG)
    buffer = BytesIO()
    try:
        with ZipFile(buffer, "w") as zipped:
            for path, content in files.items():
                zipped.writestr(path or "?", content.encode())
    except ValueError:  # half of a letter
        raise InputError(WRONG) from None
    return buffer.getvalue()
