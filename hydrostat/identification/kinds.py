"""`KINDS`: parameters of a robot and of its measurement that can be fitted by name."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import list_choices
from hydrostat.identification.model import IdentificationModel, Parameter, Values
from hydrostat.robot import FOAM_POISSON_LIMIT, Material, Robot
from hydrostat.units import MM

POISSON_MARGIN = 1e-6
"""Distance that a fitted Poisson's ratio keeps from 0.5."""


@dataclass(frozen=True, kw_only=True)
class ParameterKind:
    """A group of parameters with one name.

    Attributes:
        parameters: parameters of a robot; none where it has nothing of the kind.
        robot: robot with some values in place of its own; None for parameters of the measurement alone.
        contractions: contractions [m] with some values, as in `IdentificationModel`.
        places: places [m] in the frame of the measurement, as in `IdentificationModel`.
        force_scale: measured over simulated forces with some values, as in `IdentificationModel`.
        default: fitted without being named.
        missing: why a robot has none of these parameters.
    """

    parameters: Callable[[Robot], list[Parameter]]
    robot: Callable[[Robot, Values], Robot] | None = None
    contractions: Callable[[Robot, Values, np.ndarray], np.ndarray] | None = None
    places: Callable[[Robot, Values, np.ndarray], np.ndarray] | None = None
    force_scale: Callable[[Values], float] | None = None
    default: bool = False
    missing: str = "this robot has nothing of the kind"


def kind_names(fit: Sequence[str] | None) -> tuple[str, ...] | None:
    """Return names of kinds as a tuple, also of a text such as "young,gain"; None if left out.

    Raises:
        InputError: not names, or an empty text.
    """
    if fit is None:
        return None
    names = fit.split(",") if isinstance(fit, str) else fit
    names = tuple(names) if isinstance(names, Iterable) else (names,)
    if not all(isinstance(name, str) for name in names):
        raise InputError(f'fit must be names, such as ("young", "gain") or "young,gain", not {fit!r:.60}')
    found = tuple(name.strip() for name in names)
    if isinstance(fit, str) and not all(found):
        raise InputError(f'fit has an empty name ("{fit:.60}"). Write names such as "young,gain".')
    return found


def named_model(robot: Robot, kinds: tuple[str, ...] | None = None) -> IdentificationModel:
    """Model with the parameters of some kinds.

    Args:
        robot: robot as it is assumed to be built.
        kinds: names in `KINDS`; those that are fitted by default if left out.

    Raises:
        InputError: an unknown kind, or one that this robot has nothing of.
    """
    if unknown := [name for name in kinds or () if name not in KINDS]:
        raise InputError(f'unknown parameter "{unknown[0]}". {list_choices("parameters", [*KINDS], unknown[0])}')
    if kinds is not None and "scale" in kinds and "frame" not in kinds:
        raise InputError('"scale" needs "frame" as well: a shift of the board would change the scale. Add frame.')
    names = tuple(name for name, kind in KINDS.items() if (kind.default if kinds is None else name in kinds))
    found = {name: KINDS[name].parameters(robot) for name in names}
    all_names = [parameter.name for parameters in found.values() for parameter in parameters]
    if twice := [name for name in all_names if all_names.count(name) > 1]:
        raise InputError(f'two parameters are named "{twice[0]}"; rename the part, winch or cable')
    if kinds is not None and (empty := [name for name in names if not found[name]]):
        raise InputError(f'parameter "{empty[0]}": {KINDS[empty[0]].missing}. Leave it out.')
    used = [KINDS[name] for name in names if found[name]]
    held = replace(robot, pins=tuple(replace(pin, stiffness=float(pin.stiffness)) for pin in robot.pins))
    pulls = [kind.contractions for kind in used if kind.contractions is not None]
    moves = [kind.places for kind in used if kind.places is not None]
    scales = [kind.force_scale for kind in used if kind.force_scale is not None]
    return IdentificationModel(
        parameters=tuple(parameter for name in names for parameter in found[name]),
        robot=lambda values: reduce(lambda one, kind: kind.robot(one, values) if kind.robot else one, used, held),
        contractions=lambda values, commands: reduce(lambda one, pull: pull(robot, values, one), pulls, commands),
        places=lambda values, at: reduce(lambda one, move: move(robot, values, one), moves, at),
        force_scale=scales[0] if scales else lambda _: 1.0,
    )


def _material(robot: Robot, key: str, spread: float, limits: tuple[float, float], unit: str) -> list[Parameter]:
    """A parameter for the body's material and one for that of each part."""
    low, high = limits
    owners = [("body", robot.body.material)]
    owners += [(part.name, part.material) for part in robot.body.parts if part.material is not None]
    return [
        Parameter(
            name=f"{owner}.{key}",
            start=getattr(material, key),
            spread=spread,
            unit=unit,
            log=key != "poisson",
            low=low,
            high=min(high, FOAM_POISSON_LIMIT) if key == "poisson" and material.foam else high,
        )
        for owner, material in owners
    ]


def _with_material(key: str) -> Callable[[Robot, Values], Robot]:
    def change_material(material: Material, value: float) -> Material:
        return material.with_young(value) if key == "young" else replace(material, **{key: value})

    def change(robot: Robot, values: Values) -> Robot:
        parts = tuple(
            part
            if part.material is None
            else replace(part, material=change_material(part.material, values[f"{part.name}.{key}"]))
            for part in robot.body.parts
        )
        material = change_material(robot.body.material, values[f"body.{key}"])
        return replace(robot, body=replace(robot.body, material=material, parts=parts))

    return change


def _thickness(robot: Robot) -> list[Parameter]:
    start = robot.body.thickness
    return [] if start is None else [Parameter(name="thickness", start=start / MM, spread=0.2, log=True, unit="mm")]


def _with_thickness(robot: Robot, values: Values) -> Robot:
    return replace(robot, body=replace(robot.body, thickness=MM * values["thickness"]))


def _hysteresis(robot: Robot) -> list[Parameter]:
    return [Parameter(name="hysteresis.scale", start=1.0, spread=0.7, log=True)] * robot.body.has_hysteresis


def _with_hysteresis(robot: Robot, values: Values) -> Robot:
    """Robot whose sliders all have this multiple of their modulus."""

    def scale(material: Material) -> Material:
        sliders = (replace(each, young=each.young * values["hysteresis.scale"]) for each in material.hysteresis)
        return replace(material, hysteresis=tuple(sliders))

    parts = (
        part if part.material is None else replace(part, material=scale(part.material)) for part in robot.body.parts
    )
    return replace(robot, body=replace(robot.body, material=scale(robot.body.material), parts=tuple(parts)))


def _each_cable(robot: Robot, key: str) -> list[Parameter]:
    return [
        Parameter(name=f"{cable.name}.{key}", start=getattr(cable, key), spread=0.7, log=True, unit="N/m")
        for cable in robot.cables
    ]


def _with_stiffness(robot: Robot, values: Values) -> Robot:
    cables = [replace(cable, stiffness=values[f"{cable.name}.stiffness"]) for cable in robot.cables]
    return robot.with_network(robot.winches, cables)


def _routes(robot: Robot) -> list[Parameter]:
    """Offset of each point of each cable but the one at its winch."""
    axes = "xyz"[: robot.body.mesh.dim]
    return [
        Parameter(name=f"{cable.name}.{number}.{axis}", start=0.0, spread=1.0, unit="mm")
        for cable in robot.cables
        for number in range(2, len(cable.points) + 1)
        for axis in axes
    ]


def _with_routes(robot: Robot, values: Values) -> Robot:
    axes = "xyz"[: robot.body.mesh.dim]
    cables = []
    for cable in robot.cables:
        moved = [
            tuple(at + MM * values[f"{cable.name}.{number}.{axis}"] for at, axis in zip(point, axes, strict=True))
            for number, point in enumerate(cable.points[1:], start=2)
        ]
        cables.append(replace(cable, points=(cable.points[0], *moved)))
    return robot.with_network(robot.winches, cables)


def _friction(robot: Robot) -> list[Parameter]:
    if not robot.cables:
        return []
    start = max(float(np.mean([cable.friction for cable in robot.cables])), 0.1)
    return [Parameter(name="friction", start=start, spread=0.7, log=True, high=2.0)]


def _with_friction(robot: Robot, values: Values) -> Robot:
    cables = [replace(cable, friction=values["friction"]) for cable in robot.cables]
    return robot.with_network(robot.winches, cables)


def _pins(robot: Robot) -> list[Parameter]:
    return [
        Parameter(name=f"pin {number}.stiffness", start=pin.stiffness, spread=1.5, log=True, unit="N/m")
        for number, pin in enumerate(robot.pins, start=1)
    ]


def _with_pins(robot: Robot, values: Values) -> Robot:
    pins = (replace(pin, stiffness=values[f"pin {number}.stiffness"]) for number, pin in enumerate(robot.pins, start=1))
    return replace(robot, pins=tuple(pins))


def _gravity(robot: Robot) -> list[Parameter]:
    if robot.gravity is None:
        return []
    strength = float(np.linalg.norm(robot.gravity))
    return [
        Parameter(name=f"gravity.{axis}", start=component, spread=0.05 * strength, unit="m/s^2")
        for axis, component in zip("xyz", robot.gravity, strict=False)
    ]


def _with_gravity(robot: Robot, values: Values) -> Robot:
    axes = "xyz"[: robot.body.mesh.dim]
    return replace(robot, gravity=tuple(values[f"gravity.{axis}"] for axis in axes))


def _rods(robot: Robot) -> list[Parameter]:
    numbers = [(f"{rod.name}.bending", rod.stiffnesses[1]) for rod in robot.rods]
    numbers += [(f"{rod.name}.torsion", rod.torsional_stiffness) for rod in robot.rods if rod.torsional_stiffness]
    return [Parameter(name=name, start=start, spread=0.7, log=True, unit="N m^2") for name, start in numbers]


def _with_rods(robot: Robot, values: Values) -> Robot:
    rods = (
        replace(
            rod,
            diameter=None,
            young=None,
            axial_stiffness=rod.stiffnesses[0],
            bending_stiffness=values[f"{rod.name}.bending"],
            torsional_stiffness=values.get(f"{rod.name}.torsion"),
        )
        for rod in robot.rods
    )
    return replace(robot, rods=tuple(rods))


def _sheets(robot: Robot) -> list[Parameter]:
    return [
        Parameter(name=f"{sheet.name}.young", start=sheet.material.young, spread=0.7, log=True, unit="Pa")
        for sheet in robot.sheets
    ]


def _with_sheets(robot: Robot, values: Values) -> Robot:
    sheets = (
        replace(sheet, material=replace(sheet.material.with_young(values[f"{sheet.name}.young"]), name=""))
        for sheet in robot.sheets
    )
    return replace(robot, sheets=tuple(sheets))


def _offsets(robot: Robot) -> list[Parameter]:
    spread = 0.01 * robot.body.mesh.size / MM
    return [Parameter(name=f"{winch.name}.zero", start=0.0, spread=spread, unit="mm") for winch in robot.winches]


def _add_zeros(robot: Robot, values: Values, commands: np.ndarray) -> np.ndarray:
    return commands + MM * np.array([values[f"{winch.name}.zero"] for winch in robot.winches])


def _gains(robot: Robot) -> list[Parameter]:
    return [Parameter(name=f"{winch.name}.gain", start=1.0, spread=0.05, log=True) for winch in robot.winches]


def _apply_gains(robot: Robot, values: Values, commands: np.ndarray) -> np.ndarray:
    return commands * np.array([values[f"{winch.name}.gain"] for winch in robot.winches])


def _frame(robot: Robot) -> list[Parameter]:
    axes = "xyz"[: robot.body.mesh.dim]
    shift = 0.02 * robot.body.mesh.size / MM
    shifts = [Parameter(name=f"frame.{axis}", start=0.0, spread=shift, unit="mm") for axis in axes]
    about = "z" if len(axes) == 2 else axes
    return [*shifts, *(Parameter(name=f"frame.about {axis}", start=0.0, spread=3.0, unit="degrees") for axis in about)]


def _move_to_frame(robot: Robot, values: Values, places: np.ndarray) -> np.ndarray:
    axes = "xyz"[: robot.body.mesh.dim]
    middle = robot.body.mesh.nodes.mean(axis=0)
    turn = np.eye(3)
    for axis in "xyz":
        angle = np.radians(values.get(f"frame.about {axis}", 0.0))
        one, two = ("xyz".index(axis) + 1) % 3, ("xyz".index(axis) + 2) % 3
        step = np.eye(3)
        step[[one, one, two, two], [one, two, one, two]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
        turn = step @ turn
    turn = turn[: len(axes), : len(axes)]
    return (places - middle) @ turn.T + middle + MM * np.array([values[f"frame.{axis}"] for axis in axes])


def _scale_places(robot: Robot, values: Values, places: np.ndarray) -> np.ndarray:
    middle = robot.body.mesh.nodes.mean(axis=0)
    return (places - middle) * values["frame.scale"] + middle


_NO_CABLES, _NO_GRAVITY = "this robot has no cables", "robot.toml has no gravity"

KINDS: dict[str, ParameterKind] = {
    "young": ParameterKind(
        parameters=lambda robot: _material(robot, "young", 0.7, (1.0, 1e13), "Pa"),
        robot=_with_material("young"),
        default=True,
    ),
    "poisson": ParameterKind(
        parameters=lambda robot: _material(robot, "poisson", 0.1, (0.0, 0.5 - POISSON_MARGIN), ""),
        robot=_with_material("poisson"),
    ),
    "density": ParameterKind(
        parameters=lambda robot: (
            [] if robot.gravity is None else _material(robot, "density", 0.3, (1e-3, 1e5), "kg/m^3")
        ),
        robot=_with_material("density"),
        missing=_NO_GRAVITY,
    ),
    "thickness": ParameterKind(parameters=_thickness, robot=_with_thickness, missing="a 3D body has no thickness"),
    "hysteresis": ParameterKind(
        parameters=_hysteresis, robot=_with_hysteresis, missing="no material of this robot has hysteresis"
    ),
    "stiffness": ParameterKind(
        parameters=lambda robot: _each_cable(robot, "stiffness"),
        robot=_with_stiffness,
        default=True,
        missing=_NO_CABLES,
    ),
    "zero": ParameterKind(
        parameters=_offsets,
        contractions=_add_zeros,
        default=True,
        missing=_NO_CABLES,
    ),
    "gain": ParameterKind(
        parameters=_gains,
        contractions=_apply_gains,
        default=True,
        missing=_NO_CABLES,
    ),
    "routes": ParameterKind(parameters=_routes, robot=_with_routes, missing=_NO_CABLES),
    "friction": ParameterKind(parameters=_friction, robot=_with_friction, missing=_NO_CABLES),
    "pins": ParameterKind(parameters=_pins, robot=_with_pins, missing="this robot has no pins"),
    "gravity": ParameterKind(parameters=_gravity, robot=_with_gravity, missing=_NO_GRAVITY),
    "rods": ParameterKind(parameters=_rods, robot=_with_rods, default=True, missing="this robot has no rods"),
    "sheets": ParameterKind(parameters=_sheets, robot=_with_sheets, default=True, missing="this robot has no sheets"),
    "frame": ParameterKind(
        parameters=_frame,
        places=_move_to_frame,
        default=True,
    ),
    "scale": ParameterKind(  # measured over true distances: of a board printed too small, or tags nearer than stated
        parameters=lambda _: [Parameter(name="frame.scale", start=1.0, spread=0.02, log=True)],
        places=_scale_places,
    ),
    "force": ParameterKind(
        parameters=lambda robot: [Parameter(name="force.scale", start=1.0, spread=0.2, log=True)] * bool(robot.winches),
        force_scale=lambda values: values["force.scale"],
        missing=_NO_CABLES,
    ),
}
"""Kinds of parameters by name, in the order in which they change a robot."""
