"""`find_inserts`: parts of other materials, rigid parts, rods and sheets, with the sizes that a maker needs."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.robot import Body, Membrane, Robot, Rod


class InsertKind(StrEnum):
    """Kind of a part that is put into the body."""

    RIGID = "rigid part"
    SOFT = "part of another material"
    ROD = "rod"
    SHEET = "sheet on the skin"


@dataclass(frozen=True, kw_only=True)
class Insert:
    """Part or rod in the body, or sheet on it; lengths in millimeters."""

    mark: str  # P1, P2, ... for parts, R1, R2, ... for rods, S1, S2, ... for sheets
    name: str  # name in robot.toml
    kind: InsertKind
    material: str  # material, or the stiffness or density that it must have
    sides: tuple[float, ...] = ()  # sides of the box about a part
    length: float | None = None  # length of a rod
    diameter: float | None = None  # diameter of a round rod
    area: float | None = None  # area of a sheet [mm^2]
    thickness: float | None = None  # thickness of a sheet
    volume: float | None = None  # [mm^3]
    mass: float | None = None  # [g]; None if it is unknown
    places: tuple[tuple[float, ...], ...]  # corners of a rod, or the middle of a part

    @property
    def size(self) -> str:
        """Size in words."""
        if self.area is not None:
            return f"{self.thickness:.3g} mm thick, {1e-2 * self.area:.0f} cm²"
        if self.length is None:
            return " × ".join(f"{side:.0f}" for side in self.sides) + " mm"
        thick = "" if self.diameter is None else f"{self.diameter:.3g} mm thick, "
        return f"{thick}{self.length:.0f} mm long"

    @property
    def where(self) -> str:
        """Place in words, in the coordinates of the robot file."""
        places = [f"[{', '.join(f'{value + 0.0:.0f}' for value in place)}]" for place in self.places]
        return f"{' to '.join(places)} mm" if self.kind is InsertKind.ROD else f"middle at {places[0]} mm"

    @property
    def words(self) -> str:
        """Mark, name, material and size in words."""
        return f"{self.mark} {self.name} ({self.material}, {self.size})"


def find_inserts(robot: Robot) -> tuple[Insert, ...]:
    """Parts, rods and sheets of a robot, in this order; a rod has the mass of the material of its Young's modulus."""
    body = robot.body
    parts = [_insert_of_part(body, index) for index, part in enumerate(body.parts) if not part.winch]
    rods = [_insert_of_rod(rod, number) for number, rod in enumerate(robot.rods, start=1)]
    return (*parts, *rods, *(_insert_of_sheet(body, sheet, n) for n, sheet in enumerate(robot.sheets, start=1)))


def insert_title(inserts: Iterable[Insert]) -> str:
    """Title of the step that puts them in."""
    rods = [insert.kind is InsertKind.ROD for insert in inserts if insert.kind is not InsertKind.SHEET]
    return "Put the rods in" if all(rods) else "Put parts and rods in" if any(rods) else "Put the parts in"


def filling_volume(body: Body) -> float:
    """Volume of the body without its parts [mm^3]."""
    return 1e9 * (body.thickness or 1.0) * float(body.mesh.volumes[~_find_made(body)].sum())


def displaced_volume(body: Body) -> float:
    """Volume of all parts of the body but its winches [mm^3]."""
    return 1e9 * (body.thickness or 1.0) * float(body.mesh.volumes[_find_made(body)].sum())


def _find_made(body: Body) -> np.ndarray:
    """Mask of the elements of parts, without winches, for which a kit has its own rooms, (elements,)."""
    made = [index for index, part in enumerate(body.parts, start=1) if not part.winch]
    return np.isin(body.element_materials, made)


def rod_problems(robot: Robot) -> tuple[str, ...]:
    """Return a line for each rod that is thicker than the body."""
    if robot.body.thickness is None:
        return ()
    thick = 1e3 * robot.body.thickness
    return tuple(
        f"rod[{index}] {rod.name} is {1e3 * rod.diameter:.3g} mm thick, the body only {thick:.3g} mm. "
        "Take a thinner rod or a thicker body"
        for index, rod in enumerate(robot.rods)
        if rod.diameter is not None and 1e3 * rod.diameter > thick
    )


def _insert_of_part(body: Body, index: int) -> Insert:
    part, own = body.parts[index], body.element_materials == index + 1
    whole, held = 1e3 * body.mesh.nodes, 1e3 * body.mesh.nodes[np.unique(body.mesh.elements[own])]
    low, high = (np.append(end(whole, axis=0)[: part.dim], end(held, axis=0)[part.dim :]) for end in (np.min, np.max))
    if part.dim:  # a part in the plane goes through all of a body in space
        drawn = 1e3 * part.grid(100)
        low[: part.dim] = np.maximum(low[: part.dim], drawn.min(axis=0))
        high[: part.dim] = np.minimum(high[: part.dim], drawn.max(axis=0))
    sides = [*(high - low).tolist(), *([] if body.thickness is None else [1e3 * body.thickness])]
    material = part.material_in(body.material)
    rigid = f"a stiff material of {material.density:.0f} kg/m^3"
    soft = material.name or f"{1e-3 * material.young:.3g} kPa and {material.density:.0f} kg/m^3"
    return Insert(
        mark=f"P{index + 1}",
        name=part.name,
        kind=InsertKind.RIGID if part.is_rigid else InsertKind.SOFT,
        material=rigid if part.is_rigid else soft,
        sides=tuple(sides),
        volume=1e9 * (body.thickness or 1.0) * float(body.mesh.volumes[own].sum()),
        mass=1e3 * float(body.element_masses[own].sum()),
        places=(tuple(((low + high) / 2).tolist()),),
    )


_ROD_MATERIALS = (
    ("nylon", 1e9, 4e9, 1140.0),
    ("glass fiber", 30e9, 50e9, 1900.0),
    ("aluminum", 65e9, 75e9, 2700.0),
    ("carbon fiber", 100e9, 160e9, 1600.0),
    ("spring steel", 180e9, 215e9, 7850.0),
)
"""Name, range of Young's modulus [Pa] and density [kg/m^3] of common rods, from textbooks (Ashby)."""


def _insert_of_rod(rod: Rod, number: int) -> Insert:
    length = 1e3 * rod.length
    volume, mass = None, None
    axial, bending = rod.stiffnesses
    material = f"EA {_number(axial)} N, EI {_number(1e6 * bending)} N mm^2"
    if rod.diameter is not None and rod.young is not None:
        volume = float(np.pi / 4 * (1e3 * rod.diameter) ** 2 * length)
        modulus = f"{1e-9 * rod.young:.3g} GPa"
        known = [entry for entry in _ROD_MATERIALS if entry[1] <= rod.young <= entry[2]]
        material = f"{known[0][0]} or alike ({modulus})" if known else f"Young's modulus {modulus}"
        mass = 1e-6 * known[0][3] * volume if known else None
    if rod.torsional_stiffness is not None:
        material += f", GJ {_number(1e6 * rod.torsional_stiffness)} N mm^2: glue it in along its whole length"
    return Insert(
        mark=f"R{number}",
        name=rod.name,
        kind=InsertKind.ROD,
        material=material,
        length=length,
        diameter=None if rod.diameter is None else 1e3 * rod.diameter,
        volume=volume,
        mass=mass,
        places=tuple(tuple(1e3 * value for value in point) for point in rod.points),
    )


def _insert_of_sheet(body: Body, sheet: Membrane, number: int) -> Insert:
    triangles, edges = sheet.find_facets(body.mesh)
    held = 1e3 * body.mesh.nodes[np.unique(np.concatenate([triangles.ravel(), edges.ravel()]))]
    area, material = 1e6 * sheet.find_area(body.mesh, body.thickness), sheet.material
    volume = 1e3 * sheet.thickness * area
    return Insert(
        mark=f"S{number}",
        name=sheet.name,
        kind=InsertKind.SHEET,
        material=material.name or f"{1e-6 * material.young:.3g} MPa and {material.density:.0f} kg/m^3",
        area=area,
        thickness=1e3 * sheet.thickness,
        volume=volume,
        mass=1e-6 * material.density * volume,
        places=(tuple(((held.min(axis=0) + held.max(axis=0)) / 2).tolist()),),
    )


def _number(value: float) -> str:
    """Number to three digits, without an exponent where it is large."""
    return f"{value:.3g}" if value < 1000 else f"{float(f'{value:.3g}'):.0f}"
