"""`Body`: the soft part of a robot, its file, its mesh and its treatment of volumetric locking."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import TypedDict, Unpack

import numpy as np

from hydrostat.arrays import Float, Int, Points
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError, OutlineError, SurfaceError
from hydrostat.geometry import Anchors, Healing, Inner, Mesh, Outline, Solid, Thickness, locate
from hydrostat.given import check_positive
from hydrostat.robot.body_cache import Arrays, keep_body
from hydrostat.robot.element_kind import ElementKind, Plane, Volume
from hydrostat.robot.grading import Grading
from hydrostat.robot.material import Material
from hydrostat.robot.materials import get_material
from hydrostat.robot.part import BodyPart
from hydrostat.robot.part_elements import find_part_elements, find_rings


class Source(StrEnum):
    """Kind of file that a body comes from; also its key in robot.toml."""

    OUTLINE = "outline"
    SURFACE = "surface"
    MESH = "mesh"


@dataclass(frozen=True, kw_only=True)
class Body:
    """Meshed body. Two bodies are equal if they come from the same file with the same values.

    `source`, `material`, `volume`, `plane` and `elements` also accept the name of a value.

    Raises InputError: a missing or unexpected thickness, a length out of its range, or an unknown name.
    """

    source: Source  # kind of content of the file
    file: str  # name of the file in the robot's folder
    content: bytes = field(repr=False)  # bytes of the file, so that a robot can be saved anywhere
    material: Material  # material of the body
    size: float | None = None  # longest side of the bounding box [m]; None: as the file says
    element_size: float | None = None  # length of a mesh edge [m]; None for a ready mesh
    thickness: float | None = None  # thickness of a flat body [m]; None in space
    volume: Volume = Volume.ELEMENT  # measure of volume change in linear elements
    plane: Plane = Plane.STRAIN  # freedom of a flat body across its plane
    elements: ElementKind = ElementKind.LINEAR  # shape functions; change them by `with_elements`
    inner: Inner = Inner.HOLES  # meaning of shapes within the outer line of a drawing
    drawing_part: int | None = None  # number of the closed shape of a drawing that is the body; None: 1, the largest
    parts: tuple[BodyPart, ...] = ()  # regions of other materials, or rigid
    grading: Grading | None = None  # factor of Young's modulus by place; rigid parts keep theirs
    mesh: Mesh = field(compare=False, repr=False)  # nodes and elements
    outline: Outline | None = field(default=None, compare=False, repr=False)  # outline of a flat drawn body
    marks: tuple[Float[np.ndarray, "_ 2"], ...] = field(
        default=(), compare=False, repr=False
    )  # lines drawn on a flat body [m]
    # labels of a ready mesh, each with the indices of its linear elements
    labels: Mapping[str, Int[np.ndarray, " _"]] = field(default_factory=dict, compare=False, repr=False)
    # of a body in space that came as a surface: that surface closed, and what that took
    healing: Healing | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        make_member(self, "source", Source)
        make_member(self, "volume", Volume)
        make_member(self, "inner", Inner)
        make_member(self, "elements", ElementKind)
        make_member(self, "plane", Plane)
        if self.plane is Plane.STRESS and self.mesh.dim == 3:
            raise InputError("plane is only for flat bodies; remove it")
        if self.plane is Plane.STRESS and self.volume is Volume.PATCH:
            raise InputError('volume = "patch" is for plane strain; plane stress does not lock. Remove volume or plane')
        if (self.elements is ElementKind.QUADRATIC) != (self.mesh.quadratic is not None):
            raise InputError('elements do not fit the mesh; use body.with_elements("quadratic")')
        if self.elements is ElementKind.QUADRATIC and self.volume is Volume.PATCH:
            raise InputError('volume = "patch" is for linear elements; quadratic ones do not lock. Remove volume')
        if self.inner is Inner.DRAWN and self.source is not Source.OUTLINE:
            raise InputError('inner = "drawn" is for bodies with an outline; remove it')
        if self.drawing_part is not None and self.source is not Source.OUTLINE:
            raise InputError("drawing_part is for bodies with an outline; remove it")
        if isinstance(self.material, str):
            object.__setattr__(self, "material", get_material(self.material))
        if self.mesh.dim == 2 and self.thickness is None:
            raise InputError('thickness is missing; a flat body needs one, for example thickness = "40 mm"')
        if self.mesh.dim == 3 and self.thickness is not None:
            raise InputError("thickness is only for flat bodies; remove it")
        _check_lengths(size=self.size, element_size=self.element_size, thickness=self.thickness)
        if self.parts:
            _ = self.element_materials  # checks the parts
        if self.grading is not None and self.grading.dim > self.mesh.dim:
            raise InputError("grading has coordinates in space, but the body is flat")

    def with_parts(self, parts: Iterable[BodyPart]) -> "Body":
        """Return the body with these parts in place of its own, its mesh fitted to their borders.

        Raises InputError: parts that do not fit, see `find_part_elements`.
        """
        from hydrostat.robot.part_elements import conform

        parts = tuple(parts)
        linear = self.with_elements(ElementKind.LINEAR)
        whole = replace(linear, parts=parts)  # parts that do not fit raise before the mesh is changed
        return (replace(whole, mesh=conform(linear.mesh, parts)) if parts else whole).with_elements(self.elements)

    def with_elements(self, kind: "ElementKind | str") -> "Body":
        """Return the body with linear or quadratic elements that have the same corners.

        Raises InputError: quadratic elements and volume = "patch", or an unknown name.
        """
        kind = ElementKind(kind)
        if kind is self.elements:
            return self
        mesh = self.mesh.to_quadratic() if kind is ElementKind.QUADRATIC else self.mesh.to_linear()
        return replace(self, elements=kind, mesh=mesh)

    @property
    def materials(self) -> tuple[Material, ...]:
        """Material of the body, then that of each part."""
        return (self.material, *(part.material_in(self.material) for part in self.parts))

    @property
    def has_hysteresis(self) -> bool:
        """True if any material has hysteresis."""
        return any(material.hysteresis for material in self.materials)

    @cached_property
    def element_materials(self) -> Int[np.ndarray, " elements"]:
        """Index in `materials` of each element (InputError: parts that do not fit, see `find_part_elements`)."""
        if self.mesh.quadratic is not None:
            return np.repeat(self.with_elements(ElementKind.LINEAR).element_materials, 2**self.mesh.dim)
        found = find_part_elements(self.mesh, self.parts, self.labels)
        found.setflags(write=False)
        return found

    @cached_property
    def stiffness_factors(self) -> Float[np.ndarray, " elements"]:
        """Factor on Young's modulus of each element from the grading; 1 without grading."""
        if self.grading is None:
            return np.ones(len(self.mesh.elements))
        if self.mesh.quadratic is not None:
            return np.repeat(self.with_elements(ElementKind.LINEAR).stiffness_factors, 2**self.mesh.dim)
        rigid = np.array([False, *(part.is_rigid for part in self.parts)])[self.element_materials]
        return np.where(rigid, 1.0, self.grading.find_factors(self.mesh.nodes[self.mesh.elements].mean(axis=1)))

    @cached_property
    def part_rings(self) -> tuple[tuple[Int[np.ndarray, " _"], ...], ...]:
        """Nodes along the closed borders of each part of a flat body, with the part on the left; empty in space."""
        if self.mesh.dim == 3:
            return tuple(() for _ in self.parts)
        own = [self.mesh.elements[self.element_materials == index + 1] for index in range(len(self.parts))]
        return tuple(tuple(find_rings(Mesh(self.mesh.nodes, elements).boundary)) for elements in own)

    @cached_property
    def element_masses(self) -> Float[np.ndarray, " elements"]:
        """Mass of each element [kg]."""
        densities = np.array([material.density for material in self.materials])
        return densities[self.element_materials] * (self.thickness or 1.0) * self.mesh.volumes

    @cached_property
    def element_foams(self) -> np.ndarray:
        """Mask of the elements whose material has a foam law (elements,)."""
        return np.array([bool(material.foam) for material in self.materials])[self.element_materials]

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self.element_masses.sum())

    def lame(self) -> tuple[Float[np.ndarray, " elements"], Float[np.ndarray, " elements"]]:
        """Lame's parameters mu and lambda of the material of each element [Pa], without its grading."""
        mu, lame = np.array([material.lame for material in self.materials])[self.element_materials].T
        return mu, lame

    def element_size_for(self, nodes: int) -> float:
        """Return the element size [m] for a number of nodes (InputError: a ready mesh, or nodes out of range)."""
        from hydrostat.geometry import size_for, tetrahedralize, triangulate

        if self.outline is not None:
            outline = self.outline
            return size_for(
                nodes,
                lambda trial: triangulate(outline, trial),
                content=outline.area,
                rim=outline.polygon.length,
                dim=2,
            )
        if self.healing is not None:
            closed = self.healing.surface
            return size_for(
                nodes, lambda trial: tetrahedralize(closed, trial), content=closed.volume, rim=closed.area, dim=3
            )
        raise InputError("a ready mesh has its own elements, their number cannot be chosen")

    @cached_property
    def solid(self) -> Solid | None:
        """Solid enclosed by the closed surface of a body in space; None for other bodies."""
        return None if self.healing is None else Solid(self.healing.surface)

    @cached_property
    def mark_anchors(self) -> tuple[Anchors, ...]:
        """Nodes and weights that anchor each line drawn on the body."""
        return tuple(locate(self.mesh, line) for line in self.marks)

    @cached_property
    def measured_thickness(self) -> Thickness:
        """Thickness of the body along the inward normal of each facet of its boundary."""
        return Thickness.measure(self.mesh)

    def distances(self, points: Points) -> Float[np.ndarray, " points"]:
        """Return the distance of points from the body [m], 0 inside its drawing, surface or mesh."""
        distances = locate(self.mesh, points).distances
        beyond = distances > 0
        if not beyond.any():
            return distances
        if self.solid is not None:
            distances[beyond] = np.maximum(self.solid.distances(points[beyond]), 0.0)
            return distances
        if self.outline is None:
            return distances
        from shapely import distance
        from shapely import points as shapely_points

        distances[beyond] = distance(self.outline.polygon, shapely_points(points[beyond]))
        return distances

    @staticmethod
    def from_mesh(
        path: Path,
        *,
        unit: float,
        material: Material,
        size: float | None = None,
        thickness: float | None = None,
        volume: Volume = Volume.ELEMENT,
    ) -> "Body":
        """Create a body from a ready mesh, in units of `unit` meters (InputError: no such file, or not a mesh)."""
        from hydrostat.files import read_stranger
        from hydrostat.geometry import read_labeled_mesh

        _check_lengths(size=size, thickness=thickness)
        mesh, labels = read_labeled_mesh(path, unit=unit, size=size)
        return Body(
            source=Source.MESH,
            file=path.name,
            content=read_stranger(path, name=path.name),
            material=material,
            size=size,
            thickness=thickness,
            volume=volume,
            mesh=mesh,
            labels=labels,
        )

    @staticmethod
    def from_outline(
        content: bytes,
        *,
        file: str,
        material: Material,
        element_size: float,
        thickness: float,
        volume: Volume = Volume.ELEMENT,
        **reading: Unpack["DrawingReading"],
    ) -> "Body":
        """Create a body from a drawing or picture (InputError: no closed outline, or a value out of range)."""
        size, inner, drawing_part = (
            reading.get("size"),
            Inner(reading.get("inner", "holes")),
            reading.get("drawing_part"),
        )
        part = drawing_part or 1
        _check_lengths(size=size, element_size=element_size)

        def make() -> Arrays:
            from hydrostat.geometry import read_drawing, triangulate

            drawing = read_drawing(content, name=file, size=size, inner=inner, part=part)
            with _blaming_the_element_size():
                mesh = triangulate(drawing.outline, element_size)
            rings, marks = drawing.outline.rings, drawing.marks
            return _mesh_arrays(mesh) | _number("ring", rings) | _number("mark", marks)

        kept = keep_body(("outline", Path(file).suffix, size, str(inner), part, element_size), content, make)
        exterior, *holes = _numbered_arrays("ring", kept)
        return Body(
            source=Source.OUTLINE,
            file=file,
            content=content,
            material=material,
            size=size,
            element_size=element_size,
            thickness=thickness,
            volume=volume,
            inner=inner,
            drawing_part=drawing_part,
            mesh=Mesh(kept["nodes"], kept["elements"]),
            outline=Outline(exterior, tuple(holes)),
            marks=_numbered_arrays("mark", kept),
        )

    @staticmethod
    def from_surface(
        content: bytes,
        *,
        file: str,
        unit: float,
        material: Material,
        element_size: float,
        size: float | None = None,
        thickness: float | None = None,
        volume: Volume = Volume.ELEMENT,
    ) -> "Body":
        """Create a body in space from a scan or CAD model (STL, OBJ, PLY, OFF or 3MF, by its name), repaired.

        Args:
            content: bytes of the file.
            file: file name.
            unit: length of one coordinate unit [m], if the file does not define it.
            material: material of the body.
            element_size: mean length of a mesh edge [m].
            size: longest side of the bounding box after scaling [m]; None to keep the size of the file.
            thickness: must be None, because bodies in space have none.
            volume: measure of volume change.

        Raises:
            InputError: the file has no surface, the surface encloses no body, or a value is out of range.
        """
        _check_lengths(size=size, element_size=element_size, thickness=thickness)

        def make() -> Arrays:
            from hydrostat.geometry import heal, read_surface, tetrahedralize

            healing = heal(read_surface(content, name=file, unit=unit, size=size), resolution=element_size / 4)
            with _blaming_the_element_size():
                mesh = tetrahedralize(healing.surface, element_size)
            return _mesh_arrays(mesh) | healing.arrays()

        kept = keep_body(("surface", Path(file).suffix, unit, size, element_size), content, make)
        return Body(
            source=Source.SURFACE,
            file=file,
            content=content,
            material=material,
            size=size,
            element_size=element_size,
            thickness=thickness,
            volume=volume,
            mesh=Mesh(kept["nodes"], kept["elements"]),
            healing=Healing.of_arrays(kept),
        )


def _check_lengths(**lengths: float | None) -> None:
    for name, length in lengths.items():
        if length is not None:
            check_positive(name, length, "m")


@contextmanager
def _blaming_the_element_size() -> Iterator[None]:
    """Complaints of a mesher begin with the key that is wrong, but for those of the shape itself."""
    try:
        yield
    except (OutlineError, SurfaceError):
        raise
    except InputError as error:
        raise InputError(f"element_size: {error}") from None


class DrawingReading(TypedDict, total=False):
    """Choices that a drawing is read by.

    Attributes:
        size: longest side of the bounding box [m]; as the drawing says if left out.
        inner: meaning of shapes in the body: holes, or lines drawn on it.
        drawing_part: number of the closed shape that is the body; 1 if left out, the largest area.
    """

    size: float | None
    inner: Inner
    drawing_part: int | None


def _mesh_arrays(mesh: Mesh) -> dict[str, np.ndarray]:
    return {"nodes": mesh.nodes, "elements": mesh.elements}


def _number(name: str, arrays: Iterable[np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays under names with a number."""
    return {f"{name} {number}": array for number, array in enumerate(arrays)}


def _numbered_arrays(name: str, kept: Arrays) -> tuple[np.ndarray, ...]:
    """Arrays of names with a number."""
    return tuple(kept[f"{name} {number}"] for number in range(sum(key.startswith(f"{name} ") for key in kept)))
