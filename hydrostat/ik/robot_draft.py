"""`new_robot`: a first robot, with a first pose, from corners, a mesh or a file of any kind that hydrostat reads."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.geometry import Inner, Mesh, Outline
from hydrostat.given import check_number, check_type, path_of
from hydrostat.robot import (
    GALLERY,
    PoseTarget,
    Robot,
    SurfaceSketch,
    find_mirror,
    gallery_folder,
    is_of_gallery,
    list_gallery,
    load_robot,
    measure_asymmetry,
    sketch_mesh,
    sketch_robot,
)

MESH_SUFFIXES = (".vtk", ".vtu", ".msh")
CAD_SUFFIXES = (".iges", ".igs", ".f3d", ".sldprt")


@dataclass(frozen=True, kw_only=True)
class NewRobotWish:
    """Requested properties of a new robot, lengths in meters; None for no request."""

    name: str | None = None  # name of the robot; None: that of its file
    size: float | None = None  # longest side of the bounding box
    element_size: float | None = None  # length of a mesh edge
    nodes: int | None = None  # approximate number of nodes, instead of an element size
    thickness: float | None = None  # thickness of a flat body
    inflate: float | None = None  # inflate a drawing to a 3D body of this thickness
    material: str | None = None  # name in the material table
    inner: Inner | str | None = None  # shapes in a drawn body: holes, or lines drawn on it
    drawing_part: int | None = None  # number of the shape of a drawing or STEP file that is the body, 1 is the largest

    def __post_init__(self) -> None:
        longest = 20.0  # nothing of a robot is longer [m]
        for key in ("size", "element_size", "thickness", "inflate"):
            value = getattr(self, key)
            if value is not None:
                check_number(key, value, "m")
                if value > longest:
                    raise InputError(f"{key} must be at most {longest:g} m, not {value:g}; in meters: 200 mm is 0.2")
        check_type(self.nodes, (int, type(None)), "nodes must be a whole number")
        check_type(self.drawing_part, (int, type(None)), "drawing_part must be a whole number")
        check_type(self.material, (str, type(None)), "material must be a name of the table")
        if self.nodes is not None and self.element_size is not None:
            raise InputError("nodes and element_size: give one of them")

    def refuse(self, what: str, *keys: str) -> None:
        """Reject requests that do not apply."""
        for key in keys:
            if getattr(self, key) is not None:
                raise InputError(f"{key}: {what}; leave it out")

    def begin(
        self,
        source: "str | Path | ArrayLike | Mesh",
        *,
        run: "Callable[[Sketch], BegunRobot]" = lambda sketch: sketch(),
    ) -> "BegunRobot":
        """Create a first robot, with notes; see `new_robot`.

        `run` does the part that reads, heals and meshes what may be a stranger's file, perhaps within limits.
        """
        from hydrostat.geometry import OUTLINE_SUFFIXES, STEP_SUFFIXES, SURFACE_SUFFIXES

        if isinstance(source, Mesh):
            return _add_first_pose(_of_mesh_object(source, self))
        if isinstance(source, np.ndarray | list | tuple):
            return _of_drawing(_drawn_bytes(source), Path(f"{self.name or 'body'}.svg"), self)
        if is_of_gallery(source):
            return BegunRobot(_of_gallery(source, self))
        path = path_of(source, 'a robot starts from the path of a file, or "gallery:NAME"')
        surfaces = (*SURFACE_SUFFIXES, *STEP_SUFFIXES)
        kinds = {OUTLINE_SUFFIXES: _of_drawing_file, surfaces: _of_surface, MESH_SUFFIXES: _of_mesh}
        for suffixes, make in kinds.items():
            if path.suffix.lower() in suffixes:
                if not path.is_file():
                    raise InputError(f"{source}: there is no such file")
                return _add_first_pose(run(lambda make=make: make(path, self)))
        if str(source) in list_gallery():
            raise InputError(f"{source}: is a robot of the gallery; write gallery:{source}")
        if path.is_dir():
            raise InputError(f"{source}: is a folder; name a file, or copy the folder if it is a robot")
        if path.suffix.lower() in CAD_SUFFIXES:
            raise InputError(f"{source}: this CAD format is not read; export it as STEP, STL or 3MF")
        known = ", ".join(ending for suffixes in kinds for ending in suffixes)
        raise InputError(f"{source}: cannot be read. Use gallery:NAME or a file that ends in {known}")


@dataclass(frozen=True, eq=False)
class BegunRobot:
    """New robot, with notes on its creation."""

    robot: Robot
    notes: tuple[str, ...] = ()  # notes on repairs and choices
    sketch: SurfaceSketch | None = None  # healing of its surface; None without a surface


class _Wished(TypedDict, total=False):
    """Fields of `NewRobotWish` as keywords."""

    name: str
    size: float
    element_size: float
    nodes: int
    thickness: float
    inflate: float
    material: str
    inner: Inner | str
    drawing_part: int


def new_robot(source: "str | Path | ArrayLike | Mesh", **wished: Unpack[_Wished]) -> Robot:
    """Make a first robot from a file, an outline or a mesh, with sensible numbers where none are given.

    `save_robot` keeps it. An outline or mesh is moved like a drawing or mesh file of the same coordinates.

    Args:
        source: a drawing (SVG, DXF, PNG, JPG), a scan or CAD model (STL, OBJ, PLY, OFF, 3MF, STEP), a ready mesh (VTK,
            VTU, MSH), or "gallery:NAME"; the corners of a flat body, shape (corners, 2) [m], y up; or a `Mesh` of
            tetrahedra.
        wished: `name`, `size`, `element_size`, `nodes`, `thickness`, `inflate`, `material`, `inner` ("holes" or
            "drawn") and `drawing_part`; lengths in meters.

    Raises:
        InputError: a file, corners or a mesh that is no body, or wishes that do not fit it.
    """
    unknown = set(wished) - set(NewRobotWish.__dataclass_fields__)
    if unknown:
        known = ", ".join(NewRobotWish.__dataclass_fields__)
        raise InputError(f'unknown option "{sorted(unknown)[0]}". Allowed: {known}.')
    return NewRobotWish(**wished).begin(source).robot


Sketch = Callable[[], BegunRobot]


def _of_gallery(source: str, wish: NewRobotWish) -> Robot:
    """Return a robot of the gallery, under another name or with another mesh if requested."""
    wish.refuse("a gallery robot has its own; edit robot.toml", "size", "thickness", "inflate", "material", "inner")
    robot = load_robot(gallery_folder(source.removeprefix(GALLERY)))
    if wish.element_size is not None or wish.nodes is not None:
        raise InputError("elements of a gallery robot are chosen by `hydrostat new`, which keeps its comments")
    return robot if wish.name is None else replace(robot, name=wish.name)


def _drawn_bytes(corners: ArrayLike) -> bytes:
    """Drawing (SVG) of an outline, of corners (corners, 2) [m] (InputError: they are no outline)."""
    try:
        places = np.asarray(corners, dtype=float)
    except (TypeError, ValueError):
        raise InputError("outline: corners must be numbers. Give an array of shape (corners, 2), in m") from None
    if places.ndim != 2 or places.shape[1:] != (2,):
        raise InputError(f"outline: shape {places.shape} is no list of corners. Give shape (corners, 2), in m")
    ring = 1e3 * Outline(places).exterior * (1, -1)
    low, extent = ring.min(axis=0), np.ptp(ring, axis=0)
    points = " ".join(f"{x:.9g},{y:.9g}" for x, y in ring)
    size = " ".join(f"{number:.9g}" for number in (*low, *extent))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{extent[0]:.9g}mm" height="{extent[1]:.9g}mm" '
        f'viewBox="{size}"><polygon points="{points}"/></svg>'
    ).encode()


def _of_mesh_object(mesh: Mesh, wish: NewRobotWish) -> BegunRobot:
    from hydrostat.geometry import write_vtu

    if mesh.dim != 3:
        raise InputError("a robot starts from a mesh of tetrahedra. For a flat body, give its outline as an array")
    linear = mesh.to_linear()
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{_file_name(wish.name or 'body')}.vtu"
        path.write_bytes(write_vtu(linear, 1e3 * linear.nodes, {}))
        return _of_mesh(path, wish)


def _of_drawing_file(path: Path, wish: NewRobotWish) -> BegunRobot:
    return _of_drawing(read_stranger(path), path, wish)


def _of_drawing(content: bytes, path: Path, wish: NewRobotWish) -> BegunRobot:
    from hydrostat.geometry import read_drawing
    from hydrostat.robot import inflate_outline

    file = _file_name(path.name)
    inner = parse_choice(Inner, wish.inner or Inner.HOLES, what="inner")
    reading = {"size": wish.size, "inner": inner}
    drawing = read_drawing(content, name=file, part=wish.drawing_part, **reading)
    notes = tuple(f"drawing: {note}" for note in drawing.notes)
    material = wish.material or "polyester fibre"
    if wish.inflate is None:
        sizes = {"element_size": wish.element_size, "nodes": wish.nodes, "thickness": wish.thickness}
        named = {"file": file, "name": _robot_name(path, wish), "material": material}
        robot = sketch_robot(content, drawing_part=wish.drawing_part, **named, **reading, **sizes)
        return BegunRobot(robot, (*notes, *_mirror_notes(robot)))
    wish.refuse("an inflated body is as thick as is asked by inflate", "thickness")
    begun = _of_bytes(
        inflate_outline(drawing.outline, wish.inflate), path.with_suffix(".ply"), wish, material, size=None
    )
    return BegunRobot(begun.robot, (*notes, *begun.notes), begun.sketch)


def _mirror_notes(robot: Robot) -> tuple[str, ...]:
    """Note on the mirror line of a drawn robot; none without one."""
    axis = find_mirror(robot.body)
    if axis is None:
        return ()
    off = 1e3 * measure_asymmetry(robot.body, axis)
    return (f"note: mirror line {'xy'[axis]} = 0, halves equal within {off:.1f} mm. Markers are on it or in pairs",)


def _of_surface(path: Path, wish: NewRobotWish) -> BegunRobot:
    from hydrostat.geometry import STEP_SUFFIXES, convert_step

    wish.refuse("is only for drawings", "thickness", "inflate", "inner")
    content, material, notes = read_stranger(path), wish.material or "flexfoam-it x", ()
    if path.suffix.lower() in STEP_SUFFIXES:
        content, notes = convert_step(content, name=path.name, part=wish.drawing_part)
        path = path.with_suffix(".ply")
    else:
        wish.refuse("is only for drawings and STEP files", "drawing_part")
    begun = _of_bytes(content, path, wish, material, size=wish.size)
    return replace(begun, notes=(*(f"note: {note}" for note in notes), *begun.notes))


def _of_bytes(content: bytes, path: Path, wish: NewRobotWish, material: str, *, size: float | None) -> BegunRobot:
    sketch = SurfaceSketch.of_scan(
        content,
        file=_file_name(path.name),
        name=_robot_name(path, wish),
        size=size,
        element_size=wish.element_size,
        nodes=wish.nodes,
        material=material,
    )
    notes = (*(f"surface: {line}" for line in sketch.healing.lines()), *(f"note: {line}" for line in sketch.notes))
    return BegunRobot(sketch.robot, notes, sketch)


def _of_mesh(path: Path, wish: NewRobotWish) -> BegunRobot:
    wish.refuse("a ready mesh has its own elements", "element_size", "nodes")
    wish.refuse("is only for drawings", "thickness", "inflate", "inner", "drawing_part")
    material = wish.material or "flexfoam-it x"
    robot = sketch_mesh(path, name=_robot_name(path, wish), size=wish.size, material=material)
    return BegunRobot(robot)


def _add_first_pose(begun: BegunRobot) -> BegunRobot:
    """Add a target pose that the robot's cable reaches, if it is in space and small enough to solve quickly."""
    mesh = begun.robot.body.mesh
    if mesh.dim == 2:
        return begun
    if len(mesh.nodes) > _MAX_POSED:
        note = f"no first pose was looked for, as {len(mesh.nodes)} nodes take long: hydrostat pose finds yours"
        return replace(begun, notes=(*begun.notes, note))
    return replace(begun, robot=with_first_pose(begun.robot))


def _robot_name(path: Path, wish: NewRobotWish) -> str:
    return wish.name or _file_name(path.stem)


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.-]", "_", name)


_MAX_POSED = 10_000  # nodes of a body from which on no first pose is looked for
_SHARES, _REACHED = (0.5, 0.25, 0.1), 0.01  # travels to try, in shares of all; how near is near, in sizes of the body


def with_first_pose(robot: Robot) -> Robot:
    """Robot with a pose that its one cable makes, the farthest of a few that inverse kinematics finds again."""
    from hydrostat.ik.inverse_kinematics import solve_ik
    from hydrostat.simulation import Simulation

    if len(robot.body.mesh.nodes) > _MAX_POSED:
        return robot
    simulation = Simulation(robot)
    simulation.solve({}, strict=False)
    for share in _SHARES:
        solved = simulation.solve({"pull": share * robot.winches[0].travel}, strict=False)
        if not solved.result.converged:
            continue
        targets = {name: tuple(round(float(value), 4) for value in place) for name, place in solved.markers.items()}
        pose = PoseTarget(name="bend", targets=targets)
        if solve_ik(simulation, pose).rms_error < _REACHED * robot.body.mesh.size:
            return replace(robot, poses={pose.name: pose})
    return robot
