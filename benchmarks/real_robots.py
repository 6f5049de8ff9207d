"""Robots that others built, as models with parameters to identify; see `real.py`."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np

from hydrostat.geometry import Mesh
from hydrostat.identification import IdentificationModel, Parameter
from hydrostat.robot import (
    Body,
    BodyPart,
    Cable,
    Load,
    Marker,
    Material,
    Mount,
    Pin,
    PrandtlElement,
    Robot,
    Rod,
    Source,
    Winch,
)

MM = 1e-3
SHIFT = 20.0  # slack of every tendon at zero [mm], as a cable's slack is not below 0

COILED = 1.15
"""Torsional over bending stiffness of a closely coiled spring of round steel wire, (2 + nu) / 2 (Wahl 1963)."""


def prism(planes: np.ndarray, side: float) -> Mesh:
    """Tetrahedra of a square prism about the z axis, two cells across, with nodes on planes [mm]."""
    across = np.array([-0.5, 0.0, 0.5]) * side
    nodes = np.array([(x, y, z) for z in planes for y in across for x in across])
    number = np.arange(len(nodes)).reshape(len(planes), 3, 3)
    elements = []
    corners = ((0, 0, 0), (0, 0, 1), (0, 1, 0), (0, 1, 1), (1, 0, 0), (1, 0, 1), (1, 1, 0), (1, 1, 1))
    for k, j, i in np.ndindex(len(planes) - 1, 2, 2):
        cube = [int(number[k + dk, j + dj, i + di]) for dk, dj, di in corners]
        for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)):
            elements.append([cube[0], cube[a], cube[b], cube[7]])
    tetrahedra = np.array(elements)
    spans = nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]]
    turned = np.linalg.det(spans) < 0
    tetrahedra[turned, 1:3] = tetrahedra[turned, 2:0:-1]
    return Mesh(MM * nodes, tetrahedra)


def disk_body(mesh: Mesh, disks: np.ndarray) -> Callable[[float, float], Body]:
    """Body with rigid disks between pairs of heights [mm], of a given Young's modulus [Pa] and density [kg/m^3]."""
    parts = tuple(
        BodyPart(name=f"disk {index}", shape="box", at=(-1.0, -1.0, MM * low), to=(1.0, 1.0, MM * high), density=1e3)
        for index, (low, high) in enumerate(disks.tolist(), start=1)
    )
    material = Material(young=1e5, poisson=0.0, density=500.0)
    body = Body(source=Source.MESH, file="disks.vtk", content=b"", material=material, mesh=mesh, parts=parts)
    return cache(lambda young, density: replace(body, material=replace(material, young=young, density=density)))


def turned(values: dict[str, float], places: np.ndarray) -> np.ndarray:
    """Places in the frame of the measurement: tilted about x and y, moved by the place of the base."""
    a, b = values["tilt x"], values["tilt y"]
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(a), -np.sin(a)], [0.0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0.0, np.sin(b)], [0.0, 1.0, 0.0], [-np.sin(b), 0.0, np.cos(b)]])
    return places @ (about_x @ about_y).T + MM * np.array([values[f"base {axis}"] for axis in "xyz"])


def frame_parameters(base: tuple[float, float, float], spread: float) -> list[Parameter]:
    """Place of the base [mm] and tilt of the robot [rad]."""
    moved = [
        Parameter(name=f"base {axis}", start=at, spread=spread, unit="mm") for axis, at in zip("xyz", base, strict=True)
    ]
    return [*moved, *(Parameter(name=f"tilt {axis}", start=0.0, spread=0.05, unit="rad") for axis in "xy")]


def opencr(
    lengths: list[float], angles: list[float], radius: float, *, resists_twist: bool = True
) -> IdentificationModel:
    """OpenCR v4: disks on an elastic rod, nine tendons; from the lengths of its segments and its circle [mm, rad]."""
    count, thickness, beyond = 10, 2.0, 12.0  # disks of a segment, a disk, room for the marker beyond the last one
    ends = np.cumsum([0.0, *lengths])
    tops = np.concatenate([np.linspace(a, b, count + 1)[1:] for a, b in pairwise(ends)])
    disks = np.stack([tops - thickness, tops], axis=1)
    middles, top = disks.mean(axis=1), float(tops[-1])
    disks[-1, 1] += beyond
    body = disk_body(prism(np.concatenate([[0.0], disks.ravel()]), 11.0), disks)
    tendons = [(segment, tendon) for segment in range(3) for tendon in range(3)]
    parameters = [
        Parameter(name="young", start=4e5, spread=1.0, unit="Pa", log=True),
        Parameter(name="bending", start=1.5e-3, spread=0.5, unit="N m^2", log=True),
        *([Parameter(name="torsion over bending", start=COILED, spread=0.3, log=True)] if resists_twist else []),
        Parameter(name="marker", start=4.0, spread=4.0, unit="mm", low=0.0, high=beyond),
        *(Parameter(name=f"gravity {axis}", start=0.0, spread=5.0, unit="m/s^2") for axis in "xyz"),
        *frame_parameters((0.0, 0.0, 0.0), 3.0),
    ]
    for segment, angle in enumerate(angles):
        parameters += [
            Parameter(name=f"angle {segment}", start=angle, spread=0.3, unit="rad"),
            Parameter(name=f"radius {segment}", start=radius, spread=0.4, unit="mm"),
            Parameter(name=f"zero {segment}", start=0.3, spread=0.5, unit="mm"),
            Parameter(name=f"stiffness {segment}", start=3.0, spread=0.7, unit="N/mm", log=True),
        ]
    for segment, tendon in tendons:
        parameters += [
            Parameter(name=f"angle {segment}{tendon}", start=0.0, spread=0.05, unit="rad"),
            Parameter(name=f"zero {segment}{tendon}", start=0.0, spread=0.3, unit="mm"),
        ]

    def robot(values: dict[str, float]) -> Robot:
        cables = []
        for segment, tendon in tendons:
            angle = values[f"angle {segment}"] + 2 * np.pi / 3 * tendon + values[f"angle {segment}{tendon}"]
            heights = np.array([-5.0, *middles[: count * (segment + 1)]])
            cables.append((polar(values[f"radius {segment}"], angle, heights), values[f"stiffness {segment}"]))
        bending = values["bending"]
        torsion = values["torsion over bending"] * bending if resists_twist else None
        return tendon_robot(
            body(values["young"], 1e3),
            cables,
            gravity=tuple(values[f"gravity {axis}"] for axis in "xyz"),
            rods=[rod("backbone", 0.0, top, axial=2e4, bending=bending, torsion=torsion)],
            markers={"tip": top + values["marker"]},
        )

    def contractions(values: dict[str, float], commands: np.ndarray) -> np.ndarray:
        zeros = [values[f"zero {segment}"] + values[f"zero {segment}{tendon}"] for segment, tendon in tendons]
        return commands + MM * (SHIFT + np.array(zeros))

    return IdentificationModel(parameters=tuple(parameters), robot=robot, contractions=contractions, places=turned)


def with_play(model: IdentificationModel, history: np.ndarray) -> IdentificationModel:
    """Model in which each tendon follows its motor with a play; the rows of `history` are all commands in order [m]."""
    places = {row.tobytes(): index for index, row in enumerate(history)}

    def contractions(values: dict[str, float], commands: np.ndarray) -> np.ndarray:
        followed, half = history.copy(), 0.5 * MM * values["play"]
        for before, after in pairwise(followed):
            after[:] = np.clip(before, after - half, after + half)
        return model.contractions(values, followed[[places[row.tobytes()] for row in commands]])

    play = Parameter(name="play", start=0.2, spread=0.2, unit="mm", low=0.0)
    return replace(model, parameters=(*model.parameters, play), contractions=contractions)


def with_hysteresis(model: IdentificationModel, held: dict[str, float]) -> IdentificationModel:
    """Model whose gaps keep a part of their bend: one Prandtl element is unknown, all other values are held."""
    parameters = (
        Parameter(name="hysteresis", start=5e5, spread=1.0, unit="Pa", log=True),
        Parameter(name="slip", start=0.008, spread=1.0, log=True),
    )
    elastic = model.robot(held)

    def robot(values: dict[str, float]) -> Robot:
        slider = PrandtlElement(young=values["hysteresis"], strain=values["slip"])
        material = replace(elastic.body.material, hysteresis=(slider,))
        return replace(elastic, body=replace(elastic.body, material=material))

    return IdentificationModel(
        parameters=parameters,
        robot=robot,
        contractions=lambda _, commands: model.contractions(held, commands),
        places=lambda _, places: model.places(held, places),
    )


TRUNK_MOTORS = (
    (1, 0.85, 0.40),
    (2, 1.91, 0.48),
    (0, 2.88, 0.14),
    (2, -2.88, 0.50),
    (0, -1.68, 0.15),
    (1, -0.74, 0.47),
)
"""Segment at whose end the tendons of each motor end, direction of its pull [rad], and pull [mm/degree].

Segments are those by which a regression of the fitted blocks lets a motor move the disks. The other numbers are first
guesses, found in the same blocks by three arcs of constant curvature with springs for tendons.
"""

TRUNK_BENDING = (0.3, 1.4, 1.3)
"""Bending stiffness of the segments over their mean, by the same guess."""


def trunk(lengths: list[float], base: tuple[float, float, float]) -> IdentificationModel:
    """Trunk of six motors with antagonistic tendons on three disks; its places have z up, its commands are degrees.

    The two tendons of a motor are alike and opposite, and all tendons have one radius, stiffness and pretension.
    """
    thickness, layers, radius = 4.0, 5, 15.0  # of a disk; of elements in a segment; circle of the tendons
    ends = np.cumsum([0.0, *lengths])
    disks = np.stack([ends[1:] - thickness, ends[1:]], axis=1)
    between = [np.linspace(a, b - thickness, layers + 1)[1:] for a, b in pairwise(ends)]
    planes = np.concatenate([[0.0], *(np.append(part, end) for part, end in zip(between, ends[1:], strict=True))])
    mesh = prism(planes, 44.0)
    hanging = Mesh(mesh.nodes * np.array([1.0, -1.0, -1.0]), mesh.elements)
    body = disk_body(hanging, -disks[:, ::-1])
    middles = -disks.mean(axis=1)
    parameters = [
        Parameter(name="young", start=3e4, spread=0.7, unit="Pa", log=True),
        Parameter(name="density", start=200.0, spread=0.5, unit="kg/m^3", log=True),
        Parameter(name="tip mass", start=0.1, spread=0.7, unit="kg", log=True),
        Parameter(name="axial", start=1000.0, spread=0.7, unit="N", log=True),
        Parameter(name="stiffness", start=3.0, spread=0.7, unit="N/mm", log=True),
        Parameter(name="pretension", start=6.0, spread=3.0, unit="mm"),
        *frame_parameters(base, 8.0),
        *(
            Parameter(name=f"bending {segment}", start=0.04 * share, spread=0.7, unit="N m^2", log=True)
            for segment, share in enumerate(TRUNK_BENDING)
        ),
    ]
    for motor, (_, angle, pull) in enumerate(TRUNK_MOTORS):
        parameters += [
            Parameter(name=f"angle {motor}", start=angle, spread=0.2, unit="rad"),
            Parameter(name=f"pull {motor}", start=pull, spread=0.5, unit="mm/degree", log=True),
            Parameter(name=f"zero {motor}", start=0.0, spread=8.0, unit="degrees"),
        ]

    def robot(values: dict[str, float]) -> Robot:
        cables = []
        for motor, (segment, *_) in enumerate(TRUNK_MOTORS):
            heights = np.array([8.0, *middles[: segment + 1]])
            for side in (0, 1):
                angle = values[f"angle {motor}"] + np.pi * side
                cables.append((polar(radius, angle, heights), values["stiffness"]))
        rods = [
            rod(
                f"hose {segment}",
                -max(start - thickness, 0.0),
                -end,
                axial=values["axial"],
                bending=values[f"bending {segment}"],
            )
            for segment, (start, end) in enumerate(pairwise(ends))
        ]
        hanging = tendon_robot(
            body(values["young"], values["density"]),
            cables,
            gravity=(0.0, 0.0, -9.81),
            rods=rods,
            markers={f"disk {number}": height for number, height in enumerate(middles.tolist(), start=1)},
            smoothing=5e-4,
        )
        return replace(hanging, loads=(Load(name="tip", marker="disk 3", mass=values["tip mass"]),))

    def contractions(values: dict[str, float], commands: np.ndarray) -> np.ndarray:
        pulls = []
        for motor in range(6):
            for side in (0, 1):
                turn = (1 - 2 * side) * (commands[:, 2 * motor] + values[f"zero {motor}"])
                pulls.append(MM * (SHIFT + values["pretension"] + values[f"pull {motor}"] * turn))
        return np.stack(pulls, axis=1)

    return IdentificationModel(parameters=tuple(parameters), robot=robot, contractions=contractions, places=turned)


def polar(radius: float, angle: float, heights: np.ndarray) -> tuple[tuple[float, float, float], ...]:
    """Points of a straight tendon [m], from a radius, a direction and heights [mm, rad]."""
    x, y = MM * radius * np.cos(angle), MM * radius * np.sin(angle)
    return tuple((float(x), float(y), MM * height) for height in heights.tolist())


def rod(name: str, start: float, end: float, *, axial: float, bending: float, torsion: float | None = None) -> Rod:
    """Rod on the axis between two heights [mm]."""
    points = ((0.0, 0.0, MM * start), (0.0, 0.0, MM * end))
    return Rod(name=name, points=points, axial_stiffness=axial, bending_stiffness=bending, torsional_stiffness=torsion)


def tendon_robot(
    body: Body,
    cables: list[tuple[tuple[tuple[float, float, float], ...], float]],
    *,
    gravity: tuple[float, ...],
    rods: list[Rod],
    markers: dict[str, float],
    smoothing: float = 5e-5,
) -> Robot:
    """Robot held at height 0, with a winch for each cable (points [m], stiffness [N/mm]), markers at heights [mm]."""
    return Robot(
        name="real",
        body=body,
        pins=(Pin(box=((-1.0, -1.0, -1e-4), (1.0, 1.0, 1e-4)), stiffness=1e6),),
        gravity=gravity,
        rods=tuple(rods),
        winches=tuple(
            Winch(name=f"w{number}", at=points[0], mount=Mount.WORLD, travel=0.3, release=0.3)
            for number, (points, _) in enumerate(cables)
        ),
        cables=tuple(
            Cable(winch=f"w{number}", points=points, stiffness=1e3 * stiffness, slack=MM * SHIFT, smoothing=smoothing)
            for number, (points, stiffness) in enumerate(cables)
        ),
        markers=tuple(Marker(name=name, at=(0.0, 0.0, MM * height)) for name, height in markers.items()),
        poses={},
    )
