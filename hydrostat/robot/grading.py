"""`Grading`: stiffness of a body as a function of place."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError

FILE = "grading.csv"
MAX_RATIO = 1e4


@dataclass(frozen=True, kw_only=True)
class Grading:
    """Factor of Young's modulus at points of a body at rest; an element takes that of the point next to its middle.

    Points in the plane go through all of a body in space.

    Attributes:
        content: CSV file with the columns x_mm, y_mm, in space z_mm, and factor.
        file: name of the file in the robot's folder.

    Raises:
        InputError: columns of other names, a row that does not fit them, or a factor that is not above 0 or more than
            `MAX_RATIO` times another one.
    """

    content: bytes = field(repr=False)
    file: str = FILE

    def __post_init__(self) -> None:
        places, factors = self._table
        if (wrong := np.flatnonzero(~(factors > 0))).size:
            at = ", ".join(f"{1e3 * value:.4g}" for value in places[wrong[0]])
            raise InputError(f"{self.file}: each factor must be above 0; at {at} mm it is {factors[wrong[0]]:.4g}")
        if factors.max() > MAX_RATIO * factors.min():
            raise InputError(f"{self.file}: the largest factor is {factors.max() / factors.min():.3g} times the least")

    @staticmethod
    def from_function(factor: Callable[[Points], Vector], points: Points) -> "Grading":
        """Grading by a function of places [m], (points, dim), that gives the factor at each, evaluated at points.

        Raises InputError: it does not give one number above 0 for each.
        """
        try:
            factors = np.asarray(factor(points.copy()), dtype=float)
        except (TypeError, ValueError) as error:
            raise InputError(f"the grading must give one number for each point ({error})") from None
        if factors.shape not in ((), (len(points),)):
            raise InputError(f"the grading must give {len(points)} numbers, one for each point, not {factors.shape}")
        if not np.isfinite(factors).all():
            raise InputError("the grading must give finite numbers")
        rows = np.column_stack([1e3 * points, np.broadcast_to(factors, len(points))]).tolist()
        head = ",".join([*(f"{axis}_mm" for axis in "xyz"[: points.shape[1]]), "factor"])
        return Grading(content="\n".join([head, *(",".join(map(repr, row)) for row in rows), ""]).encode())

    @property
    def dim(self) -> int:
        """Number of coordinates of its points."""
        return self._table[0].shape[1]

    def find_factors(self, points: Points) -> Vector:
        """Factor at some points [m]."""
        from scipy.spatial import KDTree

        places, factors = self._table
        return factors[KDTree(places).query(points[:, : self.dim])[1]]

    def with_scale(self, scale: float) -> "Grading":
        """Return the same grading of a body whose lengths are multiplied by `scale`."""
        places, factors = self._table
        return Grading.from_function(lambda _: factors, scale * places)

    @cached_property
    def _table(self) -> tuple[Points, Vector]:
        lines = self.content.decode("utf-8-sig", "replace").replace(" ", "").strip().splitlines()
        head = lines[0].split(",") if lines else []
        if head not in (["x_mm", "y_mm", "factor"], ["x_mm", "y_mm", "z_mm", "factor"]) or len(lines) < 2:
            raise InputError(f"{self.file}: needs the columns x_mm, y_mm, in space z_mm, and factor, and a row")
        rows = []
        for number, line in enumerate(lines[1:], start=2):
            try:
                rows.append(list(map(float, line.split(","))))
            except ValueError:
                rows.append([])
            if len(rows[-1]) != len(head):
                raise InputError(f"{self.file}, line {number}: must be {len(head)} numbers, not {line:.40}")
        table = np.array(rows)
        if not np.isfinite(table).all():
            raise InputError(f"{self.file}: has a number that is not finite")
        return 1e-3 * table[:, :-1], table[:, -1]
