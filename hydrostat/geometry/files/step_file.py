"""STEP files: solids of CAD programs, read and divided into triangles by Open CASCADE (extra `cad`)."""

import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError, SeveralPartsError, SurfaceError
from hydrostat.geometry.files.soup import Soup, check_count
from hydrostat.units import plural
from hydrostat.version import install_command

_MAX_SOLIDS = 60
_PART = 0.1  # a second solid apart from the largest is a part of its own where it has this share of the volume
_CONTACT_TOLERANCE = 1e-3  # solids as near as this are one [mm]


def read_step(content: bytes, name: str, part: int | None = None) -> Soup:
    """Read one body of a STEP file; solids that touch are united.

    Args:
        content: bytes of the file.
        name: its name, for errors.
        part: number of the body, the largest volume is 1; None: the largest, if the others are small.

    Raises:
        InputError: Open CASCADE is not installed.
        SeveralPartsError: there are several bodies apart from each other, and none was chosen.
        SurfaceError: no STEP file, no solid in it, too many, or no such part.
    """
    if find_spec("OCP") is None:
        raise InputError(f"{name}: STEP files need build123d, which is not installed: {install_command('cad')}")
    if not content.lstrip().startswith(b"ISO-10303"):
        raise SurfaceError(f"{name}: is no STEP file: export it again")
    solids = _solids(_shape(content, name))
    if not solids:
        raise SurfaceError(f"{name}: holds no solid: export a closed body, not a sketch or a sheet")
    if len(solids) > _MAX_SOLIDS:
        raise SurfaceError(f"{name}: has {len(solids)} solids, at most {_MAX_SOLIDS} are read: export one part")
    bodies = sorted(_unite(solids), key=_volume, reverse=True)
    large = sum(_volume(body) > _PART * _volume(bodies[0]) for body in bodies)
    if part is None and large > 1:
        raise _several(bodies[:large], name)
    if part is not None and not 1 <= part <= len(bodies):
        raise SurfaceError(f"{name}: part {part} is not there. Allowed: 1 to {len(bodies)}, the largest volume first")
    notes = []
    if len(bodies) < len(solids):
        notes.append(f"{len(solids)} solids, united where they touch")
    if len(bodies) > 1:
        notes.append(f"{plural(len(bodies) - 1, 'solid')} apart from the body, left out")
    return _triangles(bodies[(part or 1) - 1], name, tuple(notes))


def _shape(content: bytes, name: str) -> Any:
    """All shapes of a file in millimeters, whatever its unit."""
    from OCP.IFSelect import IFSelect_RetDone  # type: ignore[import-not-found]
    from OCP.Message import Message  # type: ignore[import-not-found]
    from OCP.STEPControl import STEPControl_Reader  # type: ignore[import-not-found]

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "body.step"
        path.write_bytes(content)
        reader = STEPControl_Reader()
        try:
            done = reader.ReadFile(str(path)) == IFSelect_RetDone and reader.TransferRoots() > 0
            shape = reader.OneShape() if done else None
        except Exception:  # noqa: BLE001  # whatever Open CASCADE throws at a damaged file
            shape = None
    if shape is None or shape.IsNull():
        raise SurfaceError(f"{name}: damaged or cut short, or without a body: export it again")
    return shape


def _solids(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_SOLID  # type: ignore[import-not-found]
    from OCP.TopExp import TopExp_Explorer  # type: ignore[import-not-found]

    explorer, found = TopExp_Explorer(shape, TopAbs_SOLID), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def _volume(shape: Any) -> float:
    """Volume [mm^3]."""
    from OCP.BRepGProp import BRepGProp  # type: ignore[import-not-found]
    from OCP.GProp import GProp_GProps  # type: ignore[import-not-found]

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return abs(properties.Mass())


def _box(shape: Any) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest coordinates [mm]."""
    from OCP.Bnd import Bnd_Box  # type: ignore[import-not-found]
    from OCP.BRepBndLib import BRepBndLib  # type: ignore[import-not-found]

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]])


def _unite(solids: list[Any]) -> list[Any]:
    """Bodies of the solids that touch or overlap, each united to one."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse  # type: ignore[import-not-found]
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape  # type: ignore[import-not-found]

    boxes = [_box(solid) for solid in solids]
    bodies: list[Any] = []
    left = list(range(len(solids)))
    while left:
        group, body = [left.pop(0)], None
        for member in group:
            body = solids[member] if body is None else BRepAlgoAPI_Fuse(body, solids[member]).Shape()
            for other in list(left):
                apart = np.maximum(boxes[member][0] - boxes[other][1], boxes[other][0] - boxes[member][1]).max()
                if apart > _CONTACT_TOLERANCE:
                    continue
                if BRepExtrema_DistShapeShape(solids[member], solids[other]).Value() < _CONTACT_TOLERANCE:
                    group.append(other)
                    left.remove(other)
        bodies.append(body)
    return bodies


def _several(bodies: list[Any], name: str) -> SeveralPartsError:
    """Complaint that one of several bodies must be chosen, with their boxes seen from above [m]."""
    listed, parts = [], {}
    most_named = 6
    for number, body in enumerate(bodies, start=1):
        (x, y, z), (along, across, up) = _box(body)[0], np.ptp(_box(body), axis=0)
        listed.append(
            f"{number}: {along:.4g} x {across:.4g} x {up:.4g} at ({x + 0.0:.4g}, {y + 0.0:.4g}, {z + 0.0:.4g})"
        )
        parts[number] = 1e-3 * np.array([[x, y], [x + along, y], [x + along, y + across], [x, y + across]])
    more = f", and {len(bodies) - most_named} more" if len(bodies) > most_named else ""
    return SeveralPartsError(
        f"{name}: has {len(bodies)} bodies ({'; '.join(listed[:most_named])}{more}): choose one by --part N", parts
    )


def _triangles(shape: Any, name: str, notes: tuple[str, ...]) -> Soup:
    """Triangles of all faces, at most a thousandth of the size away from them."""
    from OCP.BRep import BRep_Tool  # type: ignore[import-not-found]
    from OCP.BRepMesh import BRepMesh_IncrementalMesh  # type: ignore[import-not-found]
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED  # type: ignore[import-not-found]
    from OCP.TopExp import TopExp_Explorer  # type: ignore[import-not-found]
    from OCP.TopLoc import TopLoc_Location  # type: ignore[import-not-found]
    from OCP.TopoDS import TopoDS  # type: ignore[import-not-found]

    size = float(np.ptp(_box(shape), axis=0).max())
    BRepMesh_IncrementalMesh(shape, 1e-3 * size, False, 0.3, False)
    places, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face_s(explorer.Current()) if hasattr(TopoDS, "Face_s") else TopoDS.Face(explorer.Current())
        explorer.Next()
        location = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            continue
        move = location.Transformation()
        nodes = [mesh.Node(index).Transformed(move) for index in range(1, mesh.NbNodes() + 1)]
        corners = np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)], dtype=np.int64)
        if face.Orientation() == TopAbs_REVERSED:
            corners = corners[:, ::-1]
        places.append(np.array([[node.X(), node.Y(), node.Z()] for node in nodes]))
        triangles.append(corners.reshape(-1, 3) - 1 + count)
        count += len(nodes)
        check_count(name, "vertices", count, room=np.inf)
    return Soup(np.concatenate(places), np.concatenate(triangles), 1e-3, notes)
