"""`size_for`: the element size that gives about a number of nodes."""

from collections.abc import Callable

import numpy as np

from hydrostat.errors import InputError, SurfaceError
from hydrostat.geometry.mesh import Mesh


class TooManyNodesError(SurfaceError):
    """Mesh that needs many more nodes than were asked for.

    Attributes:
        count: number of nodes that it would have at least.
    """

    def __init__(self, message: str, count: int = 0) -> None:
        super().__init__(message)
        self.count = count


MIN_NODES, MAX_NODES = 10, 200_000  # nodes that may be asked for
COUNT_TOLERANCE = 0.1  # how far the number may be off, as a fraction of it
_HASTY = 0.15  # the same where a few meshes must do and each takes long
_LONG = 500  # nodes from which on it does


_DENSITY = {2: (1.2, 0.6), 3: (1.6, 1.2)}
"""Nodes in a square or cube of the element size, and on a piece of the boundary as long or large, in 2D and 3D."""


def size_for(
    nodes: int,
    make: Callable[[float], Mesh],
    *,
    content: float,
    rim: float = 0.0,
    dim: int,
    is_hasty: bool = False,
) -> float:
    """Element size [m], to three digits, with which a mesh has a number of nodes to within a tenth.

    Steps on logarithms, kept between the sizes that gave too many and too few. Bodies of few elements, or with thin
    places that need finer ones, may jump over the number; then the size that comes nearest.

    Args:
        nodes: wanted.
        make: the mesh for an element size [m]; raises InputError where that is too large or too small.
        content: area [m^2] or volume [m^3] of the body.
        rim: length [m] or area [m^2] of its boundary, for a better first guess.
        dim: 2 or 3.
        is_hasty: settle for a number within a quarter after a few meshes, as of a file that nobody knows; or for more
            where walls are so thin that coarser elements, refined there, need no fewer nodes.

    Raises:
        InputError: fewer nodes than a body so thin can have, or no mesh at all. Where `make` raises only
            TooManyNodesError, the first guess is returned.
    """
    if not MIN_NODES <= nodes <= MAX_NODES:
        raise InputError(f"the number of nodes must be from {MIN_NODES} to {MAX_NODES}, not {nodes}")
    _check_thin(nodes, content, rim, dim)
    size, low, high = _guess(nodes, content, rim, dim), 0.0, np.inf
    refused: InputError | None = None
    tried: dict[float, int] = {}
    above: dict[float, int] = {}
    tries = 8
    # a size refused whose element has less than this share of the body is too fine, others are too coarse
    fine = 0.01
    for _ in range(tries):
        size = _three_digits(size)
        if size in tried or size in (low, high) or (is_hasty and _is_enough(tried, above, nodes)):
            break
        try:
            tried[size] = count = len(make(size).nodes)
        except TooManyNodesError as error:
            refused, count = error, error.count
            above[size] = count
        except InputError as error:
            refused = error
            count = 0 if isinstance(error, SurfaceError) or size**dim > fine * content else 10 * MAX_NODES
        if abs(count / nodes - 1) <= (_HASTY if is_hasty and nodes >= _LONG else COUNT_TOLERANCE):
            return size
        if is_hasty and above and not tried and len(above) == 1:
            size *= 0.8  # walls thinner than the elements were refined: finer ones need less of that
            continue
        low, high = (size, high) if count > nodes else (low, size)
        size *= (max(count, 0.3 * nodes) / nodes) ** (1 / dim)
        if not low < size < high:
            size = np.sqrt(low * high) if low > 0 and high < np.inf else 1.3 * low if low > 0 else 0.7 * high
    if not tried and above:
        return next(iter(above))  # the first guess, by volume and area
    if not tried:
        raise InputError(f"no element size gives about {nodes} nodes: {refused}")
    return min(tried, key=lambda size: abs(np.log(max(tried[size], 1) / nodes)))


def _is_enough(tried: dict[float, int], above: dict[float, int], nodes: int) -> bool:
    """Return True if a number is near enough for the nodes that were made to find it."""
    best = min((abs(count / nodes - 1) for count in tried.values()), default=np.inf)
    if not tried and len(above) == 1:
        return False  # a finer size comes next
    finest = min(tried, default=np.inf)
    if any(size > finest for size in above):
        return True  # coarser elements need more nodes, as walls are thin
    made = sum(tried.values()) + sum(above.values())
    quick = 2000  # nodes that are made in a second or two
    return made >= max(quick, nodes * (2.2 if best <= 0.25 else 7.0 if tried else 4.0))


def _check_thin(nodes: int, content: float, rim: float, dim: int) -> None:
    """Refuse to look for a number that a body so thin cannot have, before any mesh is made."""
    if not rim > 0:
        return
    inside, outside = _DENSITY[dim]
    thick = 2 * content / rim  # of a plate, or half as thick as a rod
    least = inside * content / thick**dim + outside * rim / thick ** (dim - 1)
    # so many times fewer nodes than elements as large as the body is thick would have, are not looked for
    thin = 4.0
    if nodes < least / thin:
        raise InputError(
            f"a body so thin ({1e3 * thick:.3g} mm on average) needs about {_two_digits(least)} nodes, not {nodes}: "
            f'ask for as many, or for an element size of "{1e3 * thick:.2g} mm"'
        )


def _two_digits(count: float) -> int:
    return int(float(f"{count:.1e}"))


def _guess(nodes: int, content: float, rim: float, dim: int) -> float:
    """Size h at which nodes = inside content / h^dim + outside rim / h^(dim - 1), as lattices have them."""
    inside, outside = _DENSITY[dim]
    factors = [nodes, *[0.0] * (dim - 2), -outside * rim, -inside * content]
    return float(np.max(np.roots(factors).real))


def _three_digits(size: float) -> float:
    """Length to three digits."""
    return float(f"{size:.3g}")
