"""`step_bytes`: a printed part as STEP, with true cylinders and planes, for whoever wants to change it in CAD."""

import re
import tempfile
from functools import singledispatch
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hydrostat.errors import InputError
from hydrostat.fabrication.solids.construct import (
    Box,
    Construction,
    Cylinder,
    Difference,
    Intersection,
    Moved,
    Prism,
    Revolve,
    Turned,
    Union,
)
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.version import install_command

_NO_DATE = "1970-01-01T00:00:00"


def step_bytes(printed: Printed) -> bytes:
    """A part as STEP (ISO 10303-21) in millimeters, made from its `model`. One copy; its header has no date.

    Raises InputError: build123d is not installed, or the part has no model.
    """
    if printed.model is None:
        raise InputError(f"{printed.name}: has no STEP: it is no sum of simple shapes; use its STL or 3MF")
    cad = _build123d()
    shape = cad.Part(model_of(printed.model).wrapped)
    shape.label = printed.name
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{printed.name}.step"
        cad.export_step(shape, str(path))
        text = path.read_text(encoding="utf-8")
    return _dateless(text).encode()


@singledispatch
def model_of(construction: Construction) -> Any:
    """The build123d shape of a construction [mm] (InputError: build123d is not installed)."""
    raise TypeError(f"no model is known for {type(construction).__name__}")


@model_of.register
def _(shape: Box) -> Any:
    return _build123d().Solid.make_box(*shape.size)


@model_of.register
def _(shape: Cylinder) -> Any:
    solid = _build123d().Solid
    if shape.top is None or shape.top == shape.radius:
        return solid.make_cylinder(shape.radius, shape.height)
    return solid.make_cone(shape.radius, shape.top, shape.height)


@model_of.register
def _(shape: Prism) -> Any:
    cad = _build123d()
    face = cad.Face(cad.Wire.make_polygon([(x, y, 0) for x, y in shape.profile]))
    return cad.Solid.extrude(face, cad.Vector(0, 0, shape.height))


@model_of.register
def _(shape: Revolve) -> Any:
    cad = _build123d()
    face = cad.Face(cad.Wire.make_polygon([(radius, 0, height) for radius, height in shape.profile]))
    return cad.Solid.revolve(face, 360, cad.Axis.Z)


@model_of.register
def _(shape: Union) -> Any:
    return model_of(shape.one).fuse(model_of(shape.other))


@model_of.register
def _(shape: Difference) -> Any:
    # One after the other: Open CASCADE cuts many holes ten times as fast at once, but ran for minutes on the stopper.
    return model_of(shape.one).cut(model_of(shape.other))


@model_of.register
def _(shape: Intersection) -> Any:
    cad = _build123d()
    shared = model_of(shape.one).intersect(model_of(shape.other))
    return cad.Compound(list(shared or ()))


@model_of.register
def _(shape: Moved) -> Any:
    return model_of(shape.shape).translate(shape.by)


@model_of.register
def _(shape: Turned) -> Any:
    cad = _build123d()
    model = model_of(shape.shape)
    for axis, angle in zip((cad.Axis.X, cad.Axis.Y, cad.Axis.Z), shape.by, strict=True):
        model = model.rotate(axis, angle) if angle else model
    return model


def require_cad() -> None:
    """Make sure, before long work begins, that STEP can be written (InputError: build123d is not installed)."""
    if find_spec("build123d") is None:
        raise InputError(f"STEP needs build123d, which is not installed: {install_command('cad')}")


def _build123d() -> Any:
    require_cad()
    import build123d  # type: ignore[import-not-found]

    return build123d


def _dateless(text: str) -> str:
    """The text of a STEP file with the time stamp of its FILE_NAME replaced by one that is always the same."""
    return re.sub(r"(FILE_NAME\s*\(\s*'(?:[^']|'')*'\s*,\s*)'[^']*'", rf"\g<1>'{_NO_DATE}'", text, count=1)
