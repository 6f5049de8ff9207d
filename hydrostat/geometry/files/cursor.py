"""`Cursor`: reader of the bytes of a mesh file, which trusts no count before the bytes for it are present."""

import re
from array import array
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.errors import InputError


@dataclass(frozen=True, eq=False)
class Cells:
    """Points and the simplices among the cells of a file."""

    points: Float[np.ndarray, "points 3"]  # places in the file's own unit
    tetrahedra: Int[np.ndarray, "tetrahedra 4"]  # indices of four points each, as declared, not yet checked
    triangles: Int[np.ndarray, "triangles 3"]  # indices of three points each
    # whole numbers of each tetrahedron and each triangle by the name of their array, and names of some numbers
    labels: tuple[dict[str, np.ndarray], dict[str, np.ndarray]] = field(default=({}, {}))
    names: tuple[dict[str, int], dict[str, int]] = field(default=({}, {}))


_MAX_WORD = 10_000  # characters of a word
_SPACE = re.compile(rb"\s")
_BLANK = re.compile(rb"\s*")
_WORD = re.compile(rb"\S+")


def whole_numbers(values: np.ndarray, kind: str = "i8") -> np.ndarray:
    """Convert to integers of a type; a number that is none becomes the largest, which is no valid index."""
    if values.dtype.kind == "f":
        least, most = np.iinfo(kind).min, min(np.iinfo(kind).max, 2**62)
        values = np.where((values >= least) & (values <= most), values, float(most))
    return values.astype(kind)


def make_damage_error(name: str, what: str) -> InputError:
    """Make the error for a file that is not as it should be."""
    return InputError(f"{name}: {what}: the file is damaged or cut short, save or copy it again")


class Cursor:
    """Reader of the bytes of a file, from the front.

    Attributes:
        content: content of the file.
        name: name of the file, for errors.
        at: position of the next read.
        text: True if numbers are written as text, False for bytes.
        order: byte order of numbers, "<" or ">".
    """

    def __init__(self, content: bytes, name: str) -> None:
        self.content, self.name = content, name
        self.at, self.text, self.order = 0, True, "<"

    def line(self, *, blank: bool = False) -> bytes | None:
        """Next line with anything in it, or the very next; None at the end."""
        if not blank:
            self.at = _BLANK.match(self.content, self.at).end()  # pyright: ignore[reportOptionalMemberAccess]
        if self.at >= len(self.content):
            return None
        end = self.content.find(b"\n", self.at)
        end = len(self.content) if end < 0 else end
        line, self.at = self.content[self.at : min(end, self.at + _MAX_WORD)].strip(), end + 1
        return line

    def seek_after(self, mark: bytes) -> None:
        """Go on behind a mark (InputError: it is not there)."""
        place = self.content.find(mark, self.at)
        if place < 0:
            raise self.make_damage_error(f"has no {mark.decode('latin-1', 'replace')!r}")
        self.at = place + len(mark)

    def numbers(self, count: int, kind: str) -> np.ndarray:
        """Next numbers, of a kind given by NumPy's code without order; InputError if there are fewer, or others."""
        dtype = np.dtype(self.order + kind)
        room = (len(self.content) - self.at + 1) // 2 if self.text else (len(self.content) - self.at) // dtype.itemsize
        if not 0 <= count <= room:
            raise self.make_damage_error(f"declares {count} numbers, but has bytes for {max(room, 0)} at most")
        if not self.text:
            values = np.frombuffer(self.content, dtype, count, self.at)
            self.at += count * dtype.itemsize
            return values.astype(kind)
        values = np.array(self._words(count))
        return values.astype(kind) if dtype.kind == "f" else whole_numbers(values, kind)

    def _words(self, count: int) -> array:
        """Next numbers of text."""
        values = array("d")
        piece = 1_000_000  # bytes of text taken apart at once
        while len(values) < count:
            need = count - len(values)
            words, end = self._piece(min(piece, 32 * need))
            if not words:
                raise self.make_damage_error(f"ends where {need} more numbers belong")
            if len(words) > need:
                last = next(islice(_WORD.finditer(self.content, self.at, end), need - 1, None))
                words, end = words[:need], last.end()
            try:
                values.extend(map(float, words))
            except ValueError:
                raise self.make_damage_error("has text where numbers belong") from None
            self.at = end
        return values

    def _piece(self, size: int) -> tuple[list[bytes], int]:
        """Words of the next piece of text of about a size, and where it ends; none at the end of the file."""
        end = self.at
        while end < len(self.content):
            space = _SPACE.search(self.content, end + size)
            end = space.start() if space else len(self.content)
            if end - self.at > size + _MAX_WORD:
                raise self.make_damage_error("has a very long word")
            words = self.content[self.at : end].split()
            if words:
                return words, end
            self.at = end
        return [], end

    def all_numbers(self, end: int, kind: str) -> np.ndarray:
        """Read all numbers up to a position in a text file (InputError: there is something else)."""
        part = Cursor(self.content[self.at : end], self.name)
        self.at = end
        return part.numbers(sum(1 for _ in _WORD.finditer(part.content)), kind)

    def make_damage_error(self, what: str) -> InputError:
        """Return the error for this damaged file."""
        return make_damage_error(self.name, what)
