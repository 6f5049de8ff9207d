"""What a drawing shows that is written: its SVG and DXF, read back in millimetres from the lower left corner."""

import io
import re
from functools import cached_property
from xml.etree import ElementTree

import numpy as np
from jaxtyping import Float

from hydrostat.errors import InputError
from hydrostat.fabrication.patterns.shape import Layer, PatternPart
from hydrostat.fabrication.self_check import Check

SCALE = 0.1  # how much the bar of 100 mm may be too long or too short [mm]

_SVG = "{http://www.w3.org/2000/svg}"

_MILLIMETRES = 4  # how a DXF says that it counts millimetres ($INSUNITS)


class SeenSvg:
    """An SVG as it is written. Raises InputError: it has no size in millimetres."""

    def __init__(self, content: bytes) -> None:
        self._root = ElementTree.fromstring(content)
        width = re.fullmatch(r"([\d.]+)mm", self._root.get("width", ""))
        box = [float(number) for number in self._root.get("viewBox", "").split()]
        if width is None or len(box) != 4:
            raise InputError("pattern.svg: no size in millimetres")
        self._scale, self._height = float(width[1]) / box[2], box[3]

    def circles(self, part: PatternPart, *, panel: str = "") -> Float[np.ndarray, "circles 3"]:
        """Middle and radius of each circle that stands for a part [mm], of all panels or of one."""
        found = [
            (float(item.get("cx", 0)), self._height - float(item.get("cy", 0)), float(item.get("r", 0)))
            for group in self._root.iter(f"{_SVG}g")
            if group.get("id", "").endswith(f"-{panel}") or (not panel and "-" in group.get("id", ""))
            for item in group.findall(f"{_SVG}circle")
            if item.get("class") == part
        ]
        return self._scale * np.array(found, dtype=float).reshape(-1, 3)

    def paths(self, part: PatternPart) -> list[Float[np.ndarray, "_ 2"]]:
        """Corners of all paths that stand for a part [mm]."""
        found = []
        for item in self._root.iter(f"{_SVG}path"):
            if item.get("class") == part:
                numbers = np.array(re.findall(r"-?[\d.]+", item.get("d", "")), dtype=float).reshape(-1, 2)
                found.append(self._scale * np.column_stack([numbers[:, 0], self._height - numbers[:, 1]]))
        return found


class SeenDxf:
    """A DXF as it is written."""

    def __init__(self, content: bytes) -> None:
        from ezdxf.filemanagement import read

        self._document = read(io.StringIO(content.decode()))

    @property
    def millimetres(self) -> bool:
        """Tell whether it says that it counts millimetres."""
        return self._document.header.get("$INSUNITS") == _MILLIMETRES

    @cached_property
    def pinholes(self) -> Float[np.ndarray, "circles 3"]:
        """Middle and radius of each circle that is cut as a pinhole [mm]."""
        found = [
            (*item.dxf.center.vec2, item.dxf.radius)
            for item in self._document.modelspace().query("CIRCLE")
            if item.dxf.layer == Layer.PINHOLE.upper()
        ]
        return np.array(found, dtype=float).reshape(-1, 3)

    @cached_property
    def level_lines(self) -> Float[np.ndarray, " lines"]:
        """Lengths of the lines that are marked from left to right [mm], each of two ends."""
        lines = self._document.modelspace().query(f'LWPOLYLINE[layer=="{Layer.MARK.upper()}"]')
        ends = [np.array(item.get_points("xy")) for item in lines]  # type: ignore[attr-defined]
        found = [abs(end[1, 0] - end[0, 0]) for end in ends if len(end) == 2 and end[0, 1] == end[1, 1]]
        return np.array(found, dtype=float)


def drawing_checks(svg: SeenSvg, dxf: SeenDxf) -> tuple[Check, ...]:
    """Tell whether both drawings show the same holes, and the bar of 100 mm at its length."""
    return _same_holes(svg.circles(PatternPart.PINHOLE), dxf.pinholes), _bar(svg, dxf)


def farthest(one: Float[np.ndarray, "ones d"], other: Float[np.ndarray, "others d"]) -> float:
    """The largest distance from a place of either to the nearest of the other; infinite if one has none."""
    if not len(one) and not len(other):
        return 0.0
    away = np.linalg.norm(one[:, None] - other[None], axis=2)
    return max(float(away.min(axis=side, initial=np.inf).max(initial=0.0)) for side in (0, 1))


def _same_holes(svg: Float[np.ndarray, "holes 3"], dxf: Float[np.ndarray, "others 3"]) -> Check:
    """Each hole of one has one of the other in its place, of its size."""
    gap = farthest(svg, dxf) if len(svg) == len(dxf) else np.inf
    return Check(
        what=f"SVG and DXF show the same {len(svg)} holes",
        measured=f"at most {gap:.3f} mm apart" if np.isfinite(gap) else f"{len(svg)} and {len(dxf)} holes",
        allowed="0.01 mm",
        passed=gap <= 0.01,
    )


def _bar(svg: SeenSvg, dxf: SeenDxf) -> Check:
    drawn = max((float(np.ptp(points[:, 0])) for points in svg.paths(PatternPart.RULER)), default=0.0)
    near = dxf.level_lines[np.argmin(np.abs(dxf.level_lines - 100.0))] if len(dxf.level_lines) else 0.0
    unit = "" if dxf.millimetres else ", but the DXF does not count millimetres"
    return Check(
        what="the check bar of the pattern is as long as it says",
        measured=f"{drawn:.3f} mm in the SVG, {near:.3f} mm in the DXF{unit}",
        allowed=f"100 mm, {SCALE:g} mm more or less",
        passed=max(abs(drawn - 100.0), abs(float(near) - 100.0)) <= SCALE and dxf.millimetres,
    )
