"""BLAS for compiled loops: SciPy's own, called without Python.

SciPy publishes the addresses of its BLAS for Cython. Registered under a name of ours they are external symbols to
numba, so that compiled code is cached on disk and finds them again in the next process, wherever they then are.

Fortran takes every argument by address, so scalars go through a `Scratch`. Matrices are column by column, given as the
address of their first entry and the distance of two columns.
"""

from typing import Any, NamedTuple, no_type_check

import numpy as np

from hydrostat.kernel import INNER, Late, njit


class Scratch(NamedTuple):
    """Where scalars lie while a routine reads them; one for each thread of execution.

    Attributes:
        integers: sizes, (8,) int32.
        reals: 1, -1 and 0.
        letters: the bytes of "LRNTU".
    """

    integers: np.ndarray
    reals: np.ndarray
    letters: np.ndarray


def scratch() -> Scratch:
    """A new place for scalars."""
    return Scratch(np.zeros(8, np.int32), np.array([1.0, -1.0, 0.0]), np.frombuffer(b"LRNTU", np.uint8).copy())


def _routine(name: str, arguments: int) -> Any:
    """A Fortran routine as a symbol that compiled code may call."""
    import llvmlite.binding
    from numba import types
    from numba.extending import get_cython_function_address

    symbol = f"hydrostat_{name}"
    address = get_cython_function_address("scipy.linalg.cython_blas", name)
    llvmlite.binding.add_symbol(symbol, address)
    return types.ExternalFunction(symbol, types.void(*[types.intp] * arguments))


_dgemm = Late(lambda: _routine("dgemm", 13))
_dsyrk = Late(lambda: _routine("dsyrk", 10))
_dtrsm = Late(lambda: _routine("dtrsm", 11))


@njit(inline="never", **INNER)
@no_type_check
def subtract_product(call, rows, columns, depth, a, lda, b, ldb, c, ldc):
    """C -= A B^T, with A (rows, depth), B (columns, depth)."""
    integers = call.integers
    integers[0], integers[1], integers[2] = rows, columns, depth
    integers[3], integers[4], integers[5] = lda, ldb, ldc
    at, one, letter = integers.ctypes.data, call.reals.ctypes.data, call.letters.ctypes.data
    _dgemm(letter + 2, letter + 3, at, at + 4, at + 8, one + 8, a, at + 12, b, at + 16, one, c, at + 20)


@njit(inline="never", **INNER)
@no_type_check
def subtract_plain_product(call, rows, columns, depth, a, lda, b, ldb, c, ldc):
    """C -= A B, with A (rows, depth), B (depth, columns)."""
    integers = call.integers
    integers[0], integers[1], integers[2] = rows, columns, depth
    integers[3], integers[4], integers[5] = lda, ldb, ldc
    at, one, letter = integers.ctypes.data, call.reals.ctypes.data, call.letters.ctypes.data
    _dgemm(letter + 2, letter + 2, at, at + 4, at + 8, one + 8, a, at + 12, b, at + 16, one, c, at + 20)


@njit(inline="never", **INNER)
@no_type_check
def subtract_square(call, size, depth, a, lda, c, ldc):
    """C -= A A^T in the lower triangle, with A (size, depth)."""
    integers = call.integers
    integers[0], integers[1], integers[2], integers[3] = size, depth, lda, ldc
    at, one, letter = integers.ctypes.data, call.reals.ctypes.data, call.letters.ctypes.data
    _dsyrk(letter, letter + 2, at, at + 4, one + 8, a, at + 8, one, c, at + 12)


@njit(inline="never", **INNER)
@no_type_check
def divide_right(call, transposed, rows, size, lower, lda, b, ldb):
    """B := B L^-1, or B L^-T where `transposed`, with L lower triangular (size, size), B (rows, size)."""
    integers = call.integers
    integers[0], integers[1], integers[2], integers[3] = rows, size, lda, ldb
    at, one, letter = integers.ctypes.data, call.reals.ctypes.data, call.letters.ctypes.data
    trans = letter + 3 if transposed else letter + 2
    _dtrsm(letter + 1, letter, trans, letter + 2, at, at + 4, one, lower, at + 8, b, at + 12)
