"""`packet`: words and arrays as one message of bytes.

A message is: the length of its head in bytes, as a little-endian uint32; the head, JSON in UTF-8 that is padded with
spaces until the arrays begin at a multiple of four; then the arrays one after the other, each again padded to a
multiple of four. `head["arrays"]` names them in this order: {name: [kind, rows, columns]}, kind being "f4" or "u4",
little-endian.
"""

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

KINDS = {"f": "<f4", "i": "<u4", "u": "<u4"}


def packet(head: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """One message; arrays of one or two axes are sent as tables of float32 or uint32."""
    tables, bodies = {}, []
    for name, array in arrays.items():
        kind = KINDS[array.dtype.kind]
        table = np.ascontiguousarray(array if array.ndim == 2 else array[:, None], dtype=kind)
        tables[name] = [kind[1:], *table.shape]
        bodies.append(table.tobytes())
    text = json.dumps({**head, "arrays": tables}, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([struct.pack("<I", len(text)), text, *bodies])


def opened(message: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Head and arrays of a message, for tests and for programs that listen to a studio."""
    (length,) = struct.unpack_from("<I", message)
    head = json.loads(message[4 : 4 + length])
    place, arrays = 4 + length, {}
    for name, (kind, rows, columns) in head.pop("arrays").items():
        arrays[name] = np.frombuffer(message, f"<{kind}", rows * columns, place).reshape(rows, columns)
        place += 4 * rows * columns
    return head, arrays
