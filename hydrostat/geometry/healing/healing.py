"""`Healing`: a closed surface, and the report of the repairs that produced it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

import numpy as np

from hydrostat.arrays import Int, Points
from hydrostat.geometry.surface import Surface
from hydrostat.units import plural


@dataclass(frozen=True)
class Piece:
    """Part of the input that is not in the healed surface."""

    size: float  # longest side of its box [m]
    place: tuple[float, float, float]  # middle of its box [m]
    triangles: int  # how many it had
    why: str  # what it was

    @classmethod
    def of(cls, surface: Surface, triangles: Int[np.ndarray, " some"], why: str) -> "Piece":
        """Some triangles of a surface as a piece."""
        corners = surface.vertices[surface.triangles[triangles]].reshape(-1, 3)
        return cls.of_box(np.stack([corners.min(axis=0), corners.max(axis=0)]), len(triangles), why)

    @classmethod
    def of_box(cls, box: np.ndarray, triangles: int, why: str) -> "Piece":
        """Piece by its lowest and highest coordinates [m]."""
        x, y, z = box.mean(axis=0).tolist()
        return cls(float(np.ptp(box, axis=0).max()), (x, y, z), triangles, why)

    @property
    def text(self) -> str:
        """Piece in words."""
        x, y, z = (f"{round(1e3 * coordinate, 2) + 0.0:g}" for coordinate in self.place)
        triangles = plural(self.triangles, "triangle")
        return f"{self.why}, {1e3 * self.size:.3g} mm in size at ({x}, {y}, {z}) mm, {triangles}"


@dataclass(frozen=True, eq=False)
class Healing:
    """Closed surface, and the repairs that produced it."""

    surface: Surface  # closed, manifold, turned outward, not crossing itself: one body, perhaps with cavities
    found: tuple[str, ...]  # faults found, a line each
    done: tuple[str, ...]  # repairs, a line each
    removed: tuple[Piece, ...]  # removed parts
    # volume of the kept parts, once turned [m^3]; overlaps count twice, holes as if closed by fans
    volume_before: float
    volume_after: float  # volume of the body [m^3]
    largest_distance: float  # largest distance from input to result [m], without closed holes and the inside
    patched: float  # share of the result's area that lies over holes of the input
    clean: bool  # True if only vertices in the same place had to be merged

    @property
    def places(self) -> Points:
        """Positions of the removed parts [m]."""
        return np.array([piece.place for piece in self.removed]).reshape(-1, 3)

    def lines(self) -> tuple[str, ...]:
        """Report in plain words."""
        if self.clean:
            return ("the surface is clean", *(f"found: {line}" for line in self.found))
        pieces = sorted(self.removed, key=lambda piece: -piece.size)
        listed = 5
        removed = [f"removed: {piece.text}" for piece in pieces[:listed]]
        if len(pieces) > listed:
            removed.append(f"removed: {len(pieces) - listed} more, up to {1e3 * pieces[listed].size:.3g} mm in size")
        change = f", {self.volume_after / self.volume_before - 1.0:+.2%}" if self.volume_before > 0.0 else ""
        return (
            *(f"found: {line}" for line in self.found),
            *(f"done: {line}" for line in self.done),
            *removed,
            f"volume: {1e6 * self.volume_before:.4g} cm^3 as it came (overlaps twice, holes as if closed), "
            f"{1e6 * self.volume_after:.4g} cm^3 healed{change}",
            f"largest distance to the input: {1e3 * self.largest_distance:.2g} mm"
            + (f"; {self.patched:.1%} of the surface closes holes" if self.patched > 0.0005 else ""),
        )

    def arrays(self) -> dict[str, np.ndarray]:
        """Return all fields as arrays, to be stored in a file."""
        texts = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "surface"}
        texts["removed"] = [asdict(piece) for piece in self.removed]
        return {
            "vertices": self.surface.vertices,
            "triangles": self.surface.triangles,
            "healing": np.array(json.dumps(texts)),
        }

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray]) -> "Healing":
        """Healing that `arrays` gave."""
        texts = json.loads(str(arrays["healing"]))
        pieces = (Piece(**(piece | {"place": tuple(piece["place"])})) for piece in texts["removed"])
        lists = {"found": tuple(texts["found"]), "done": tuple(texts["done"]), "removed": tuple(pieces)}
        return cls(**(texts | lists | {"surface": Surface(arrays["vertices"], arrays["triangles"])}))
