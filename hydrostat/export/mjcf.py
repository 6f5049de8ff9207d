"""`mjcf_text`: a robot as a MuJoCo model (MJCF)."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from xml.sax.saxutils import quoteattr

import numpy as np

from hydrostat.arrays import Bool, Int, Vector
from hydrostat.errors import InputError
from hydrostat.export.mjcf_tuning import MjcfTuning
from hydrostat.geometry import Anchors
from hydrostat.robot import Material, Pin, Plane, Robot
from hydrostat.simulation import Simulation

TIE_MASS = 0.1  # mass of the body at a via point or marker, as a share of the mean mass of a node
TIE_STIFFNESS = 5.0  # stiffness of the springs that tie it to its element, in stiffnesses of the stiffest cable
DAMPING = 0.01  # Rayleigh damping of materials without viscosity [s]: without any, a model does not settle
CHORD = (7 / 8, 5 / 7)  # slope and zero of the line for a cable's tension: shares of its stiffness and smoothing


def mjcf_text(
    robot: Robot, *, remarks: Iterable[str] = (), range_share: float = 1.0, tuning: MjcfTuning | None = None
) -> str:
    """Return the MuJoCo model of a robot as text; it needs MuJoCo 4 or newer.

    Nodes are bodies on slide joints, elements are flexes (one for each material), and pinned nodes are fixed to the
    world. Each via point and marker is a small body, tied to the nodes of its element by springs. Each cable is a
    tendon with an actuator that only pulls; its control is the contraction of its winch [m].

    Args:
        robot: robot to write.
        remarks: comment lines at the start.
        range_share: share of the travel of each winch that its control range covers.
        tuning: parameters that differ from the robot's, found by `fit_mjcf`.

    Raises:
        InputError: a drive, rod or sheet, which have no counterpart in MuJoCo.
    """
    for what, parts in (("drive", robot.drives), ("rod", robot.rods), ("sheet", robot.sheets)):
        if parts:
            raise InputError(f'{what} "{parts[0].name}": not available in MJCF. Remove it.')
    return "\n".join(MjcfModel(robot, tuning).lines(tuple(remarks), range_share)) + "\n"


def find_omissions(robot: Robot) -> tuple[str, ...]:
    """Return the parts and laws of a robot that its MuJoCo model omits or replaces, one phrase each."""
    materials = robot.body.materials
    found = {
        "contact and obstacles": robot.contact is not None or bool(robot.obstacles),
        "loads": bool(robot.loads),
        "stiffness of pins (they are rigid)": any(
            pin.stiffness < replace(pin, stiffness=Pin.stiffness).sized_for(robot.body).stiffness for pin in robot.pins
        ),
        "cable friction": any(cable.friction for cable in robot.cables),
        "relaxation": any(material.relaxation for material in materials),
        "graded stiffness": robot.body.grading is not None,
        "hysteresis": any(material.hysteresis for material in materials),
        "foam laws (replaced by a linear law)": any(material.foam for material in materials),
        "quadratic elements (replaced by linear ones)": robot.body.mesh.quadratic is not None,
        "patches against locking": str(robot.body.volume) == "patch",
    }
    return tuple(name for name, is_there in found.items() if is_there)


@dataclass(frozen=True, eq=False)
class MjcfTie:
    """Body at a point of an element."""

    name: str
    place: Vector  # in the rest pose [m]
    nodes: Int[np.ndarray, " corners"]
    weights: Vector
    is_free: bool  # False where it is part of the world


class MjcfModel:
    """Lines of a model, part by part."""

    def __init__(self, robot: Robot, tuning: MjcfTuning | None = None, simulation: Simulation | None = None) -> None:
        self.robot, self.mesh, self._simulation = robot, robot.body.mesh, simulation or Simulation(robot)
        self._tuning = tuning or MjcfTuning.none(robot)
        self.dim, self.axes = self.mesh.dim, "xyz"[: self.mesh.dim]

    @cached_property
    def held(self) -> Bool[np.ndarray, " nodes"]:
        """Mask of the nodes that pins hold."""
        pins, held = self._simulation.body.pins, np.zeros(len(self.mesh.nodes), dtype=bool)
        nearest = pins.weights.argmax(axis=1)[:, None]
        held[np.take_along_axis(pins.stencils, nearest, axis=1)] = True
        return held

    @cached_property
    def ties(self) -> list[MjcfTie]:
        """Ties of all via points, cable after cable, then of the markers."""
        points, found = self._simulation.route_points, []
        for number, place in enumerate(points.rests):
            found.append(self._tie(f"point {number}", place, points.anchors, number, bool(points.world[number])))
        anchors = self._simulation.marker_anchors
        places = anchors.positions(self.mesh.nodes)
        for number, marker in enumerate(self.robot.markers):
            found.append(self._tie(f"marker {marker.name}", places[number], anchors, number, False))
        return found

    def _tie(self, name: str, place: Vector, anchors: Anchors, number: int, in_world: bool) -> MjcfTie:
        nodes, weights = anchors.stencils[number], anchors.weights[number]
        is_free = not in_world and bool(((weights > 0) & ~self.held[nodes]).any())
        return MjcfTie(name, place, nodes, weights, is_free)

    def lines(self, remarks: tuple[str, ...], range_share: float) -> Iterator[str]:
        """All lines of the file."""
        gravity = np.zeros(3)
        gravity[: self.dim] = self.robot.gravity or 0.0
        yield f"<mujoco model={quoteattr(self.robot.name)}>"
        yield from (f"  <!-- {re.sub('-(?=-)', '- ', line)} -->" for line in remarks)
        yield _tag("compiler", angle="radian", autolimits="true", inertiafromgeom="false")
        yield _tag("option", timestep="0.002", gravity=_numbers(gravity), integrator="discrete", solver="Newton")
        yield _tag("size", memory="256M")
        yield from _group("worldbody", self._bodies())
        yield from _group("deformable", self._flexes())
        yield from _group("tendon", [*self._cables(), *self._springs()])
        yield from _group("actuator", self._actuators(range_share))
        yield "</mujoco>"

    def _bodies(self) -> Iterator[str]:
        masses = self._simulation.body.masses
        for number in np.flatnonzero(~self.held):
            yield from self._body(f"node_{number}", self.mesh.nodes[number], float(masses[number]), None)
        for tie in self.ties:
            if tie.is_free:
                yield from self._body(f"tie {tie.name}", tie.place, TIE_MASS * float(masses.mean()), tie.name)
            else:
                yield _tag("site", 4, name=tie.name, pos=_place(tie.place), size="0.001")

    def _body(self, name: str, place: Vector, mass: float, site: str | None) -> Iterator[str]:
        yield f'    <body name={quoteattr(name)} pos="{_place(place)}">'
        yield _tag("inertial", 6, pos="0 0 0", mass=_numbers([mass]), diaginertia="1e-6 1e-6 1e-6")
        for axis, direction in zip(self.axes, np.eye(3), strict=False):
            yield _tag("joint", 6, name=f"{name} {axis}", type="slide", axis=_numbers(direction))
        if site is not None:
            yield _tag("site", 6, name=site, size="0.001")
        yield "    </body>"

    def _flexes(self) -> Iterator[str]:
        for index, material in enumerate(self.robot.body.materials):
            elements = self.mesh.elements[self.robot.body.element_materials == index]
            if len(elements):
                yield from self._flex(f"material {index}", material, elements)

    def moduli(self, material: Material) -> tuple[bool, float, float]:
        """True if a flex is thin; Young's modulus [Pa] and Poisson's ratio before they are tuned."""
        young, poisson = material.young, material.poisson
        if self.dim == 2 and self.robot.body.plane is Plane.STRESS:
            return True, young, poisson
        if self.dim == 2 and poisson < 1 / 3:  # plane strain is plane stress of these numbers
            return True, young / (1 - poisson**2), poisson / (1 - poisson)
        return False, young, poisson

    def _flex(self, name: str, material: Material, elements: Int[np.ndarray, "elements corners"]) -> Iterator[str]:
        used, numbers = np.unique(elements, return_inverse=True)
        cells, held = numbers.reshape(elements.shape), self.held[used]
        places = np.where(held[:, None], np.pad(self.mesh.nodes[used], ((0, 0), (0, 3 - self.dim))), 0.0)
        bodies = np.where(held, "world", [f"node_{node}" for node in used])
        thickness, shell = self.robot.body.thickness or 1.0, ""
        damping = material.viscosity * 2 * (1 + material.poisson) / material.young or DAMPING
        is_thin, young, poisson = self.moduli(material)
        if is_thin:
            shell = f' elastic2d="stretch" thickness="{thickness:.9g}"'
        elif self.dim == 2:  # slabs that cannot become thicker
            half = np.array([0.0, 0.0, thickness / 2])
            cells, places = _prisms(cells, len(used)), np.concatenate([places - half, places + half])
            bodies = np.concatenate([bodies, bodies])
        young, poisson = self._tuning.young * young, self._tuning.shift_poisson(poisson)
        yield _tag(
            "flex",
            4,
            close=False,
            name=name,
            dim="2" if is_thin else "3",
            radius="0.0005",
            rgba="0.85 0.45 0.35 1",
            body=" ".join(bodies),
            vertex=_numbers(places.ravel()),
            element=" ".join(map(str, cells.ravel())),
        )
        yield f'      <elasticity young="{young:.9g}" poisson="{poisson:.9g}" damping="{damping:.9g}"{shell}/>'
        yield _tag("contact", 6, contype="0", conaffinity="0", selfcollide="none")
        yield "    </flex>"

    def _cables(self) -> Iterator[str]:
        first = 0
        for cable in self.robot.cables:
            yield _tag("spatial", 4, close=False, name=cable.name, width="0.0008", rgba="0.1 0.1 0.1 1")
            last = None
            for start in np.flatnonzero(cable.bare):
                if last is not None and start != last:  # a sheath, which keeps its length
                    yield _tag("pulley", 6, divisor="1")
                if start != last:
                    yield _tag("site", 6, site=self.ties[first + start].name)
                yield _tag("site", 6, site=self.ties[first + start + 1].name)
                last = start + 1
            yield "    </spatial>"
            first += len(cable.points)

    def _springs(self) -> Iterator[str]:
        """Springs that hold each tie at its place in its element."""
        stiffness = TIE_STIFFNESS * max((cable.stiffness for cable in self.robot.cables), default=4e3)
        for tie in self.ties:
            for axis in self.axes if tie.is_free else "":
                spring = _numbers([stiffness])
                yield _tag("fixed", 4, close=False, name=f"tie {tie.name} {axis}", stiffness=spring, springlength="0")
                yield _tag("joint", 6, joint=f"tie {tie.name} {axis}", coef="-1")
                for node, weight in zip(tie.nodes, tie.weights, strict=True):
                    if weight and not self.held[node]:
                        yield _tag("joint", 6, joint=f"node_{node} {axis}", coef=_numbers([weight]))
                yield "    </fixed>"

    def _actuators(self, range_share: float) -> Iterator[str]:
        points = self._simulation.route_points
        spans = np.linalg.norm(points.spans(points.rests), axis=1)
        lengths = np.bincount(points.cables, spans, len(self.robot.cables))
        gains = dict(zip((winch.name for winch in self.robot.winches), self._tuning.gains, strict=True))
        for cable, ratio, length in zip(self.robot.cables, self.robot.spool_ratios, lengths, strict=True):
            winch, stiffness = self.robot.winch(cable.winch), CHORD[0] * cable.stiffness
            free = length + cable.slack + CHORD[1] * cable.smoothing
            yield _tag(
                "general",
                4,
                name=cable.name,
                tendon=cable.name,
                gaintype="fixed",
                biastype="affine",
                gainprm=_numbers([-stiffness * ratio * gains[cable.winch]]),
                biasprm=_numbers([stiffness * free, -stiffness, 0.0]),
                ctrlrange=_numbers([-winch.release, range_share * winch.travel]),
                forcerange="-100000 0",
            )


def _prisms(cells: Int[np.ndarray, "triangles 3"], count: int) -> Int[np.ndarray, "tetrahedra 4"]:
    """Three tetrahedra for each triangle, between a lower and an upper copy of the nodes."""
    a, b, c = np.sort(cells, axis=1).T
    each = [[a, b, c, c + count], [a, b, b + count, c + count], [a, a + count, b + count, c + count]]
    return np.array(each).transpose(2, 0, 1).reshape(-1, 4)


def _group(name: str, lines: Iterable[str]) -> Iterator[str]:
    yield f"  <{name}>"
    yield from lines
    yield f"  </{name}>"


def _tag(kind: str, indent: int = 2, /, *, close: bool = True, **attributes: str) -> str:
    given = " ".join(f"{key}={quoteattr(value)}" for key, value in attributes.items())
    return f"{' ' * indent}<{kind} {given}{'/' if close else ''}>"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _place(place: Vector) -> str:
    return _numbers([*place, 0.0][:3])
