"""Emio's four legs as volumes on servos: pins that drives turn, welded to a rigid connector of one element."""

from pathlib import Path

import numpy as np
from emio_rods import GRAVITY, EmioRobot, rotation

from hydrostat.geometry import Mesh
from hydrostat.mechanics import PinEnergy
from hydrostat.robot import Body, BodyPart, Marker, Material, Pin, PinDrive, Robot, Source
from hydrostat.simulation import BodyPhysics, Equilibrium, Simulation

HELD = 1e7  # stiffness of a clamp and of a weld [N/m]
GRIP = 0.015  # nodes of a leg this near to its far end along each axis belong to the connector [m]
PLACE = np.array([0.0, -0.15, 0.0])  # of the connector in the mesh [m]
CORNERS = 0.012 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
CLAMPED = (((-6, -30, -10), (6, 210, 0)), ((-6, -30, -10), (6, 2, 30)))  # boxes of a leg that turn with its servo [mm]
LEG = "blueleg.vtk"


def read_leg(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Nodes [m] and tetrahedra of a leg, in an old VTK file in ASCII."""
    words = file.read_text(encoding="ascii").split()
    first = words.index("POINTS")
    count = int(words[first + 1])
    nodes = np.array(words[first + 3 : first + 3 + 3 * count], dtype=float).reshape(-1, 3)
    first = words.index("CELLS")
    numbers = np.array(words[first + 3 : first + 3 + int(words[first + 2])], dtype=np.int64)
    cells, at = [], 0
    while at < len(numbers):
        if numbers[at] == 4:
            cells.append(numbers[at + 1 : at + 5])
        at += numbers[at] + 1
    used, cells = np.unique(np.array(cells), return_inverse=True)
    return 1e-3 * nodes[used], oriented(nodes[used], cells.reshape(-1, 4))


def oriented(nodes: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Tetrahedra with a positive volume."""
    spans = nodes[cells[:, 1:]] - nodes[cells[:, :1]]
    return np.where((np.linalg.det(spans) < 0)[:, None], cells[:, [0, 1, 3, 2]], cells)


def make_robot(folder: Path, facts: EmioRobot, elements: str) -> Robot:
    """Robot with straight legs and a connector that nothing holds yet, of linear or quadratic elements."""
    leg, cells = read_leg(folder / LEG)
    count = len(leg)
    nodes = np.concatenate([*(leg @ turn.T + at for turn, at in zip(facts.turns, facts.motors, strict=True))])
    nodes = np.concatenate([nodes, PLACE + CORNERS])
    cells = np.concatenate([*(cells + count * number for number in range(4)), 4 * count + np.arange(4)[None]])
    mesh = Mesh(nodes, oriented(nodes, cells))
    material = Material(young=facts.young, poisson=facts.poisson, density=facts.density)
    body = Body(source=Source.MESH, file="emio.vtk", content=b"", material=material, thickness=None, mesh=mesh)
    density = facts.mass / float(mesh.volumes[-1])
    part = BodyPart(name="connector", shape="sphere", at=tuple(PLACE), radius=0.04, density=density)
    pins = [Pin(at=tuple(PLACE), radius=0.03, stiffness=1e-3)]  # a body without a pin is refused
    for number, (turn, at) in enumerate(zip(facts.turns, facts.motors, strict=True)):
        for box in CLAMPED:
            ends = 1e-3 * np.array(box) @ turn.T + at
            sides = tuple(ends.min(axis=0).tolist()), tuple(ends.max(axis=0).tolist())
            pins.append(Pin(box=sides, stiffness=HELD, drive=f"motor {number}"))
    return Robot(
        name="emio",
        body=body.with_parts((part,)).with_elements(elements),
        pins=tuple(pins),
        drives=tuple(
            PinDrive(name=f"motor {number}", at=tuple(at), axis=tuple(axis.round(9)))
            for number, (at, axis) in enumerate(zip(facts.motors, facts.axes, strict=True))
        ),
        markers=(Marker(name="tip", at=tuple(PLACE.tolist())),),
        poses={},
        gravity=(0.0, -GRAVITY, 0.0),
    )


class SolidLegs:
    """Equilibria of the robot, whose legs were led to the connector once."""

    def __init__(self, folder: Path, facts: EmioRobot, elements: str) -> None:
        """Assemble the robot: bend each leg by a quarter turn, then lead its end to its seat."""
        self.robot, self.facts = make_robot(folder, facts, elements), facts
        leg = read_leg(folder / LEG)[0]
        far = leg[np.argmax(np.linalg.norm(leg, axis=1))]
        nodes = self.robot.body.mesh.nodes
        own = [(nodes - at) @ turn for turn, at in zip(facts.turns, facts.motors, strict=True)]
        self.ends = [np.flatnonzero((np.abs(one - far) <= GRIP).all(axis=1)) for one in own]
        place, axes = facts.end
        self.offsets = [(one[ends] - place) @ axes for one, ends in zip(own, self.ends, strict=True)]
        self.corners = np.argmin(np.linalg.norm(nodes[:, None] - (PLACE + CORNERS), axis=2), axis=0)
        body, pose = BodyPhysics(self.robot), None
        for bend, shift in [*((turn, 0.0) for turn in np.linspace(0, np.pi / 2, 10)[1:]), (None, 0.5), (None, 1.0)]:
            welds = self.weld(np.pi / 2 if bend is None else float(bend), shift)
            self.simulation = Simulation(self.robot, body=body, energies=[welds])
            pose = self.simulation.solve(np.zeros(4), start=pose)
        self.pose: Equilibrium = pose

    def weld(self, bend: float, shift: float) -> PinEnergy:
        """Springs from the ends of the legs to the connector, which hold them at an arc or at their seats."""
        facts, nodes = self.facts, self.robot.body.mesh.nodes
        shares = np.linalg.inv(np.column_stack([np.ones(4), nodes[self.corners]]))
        stencils, weights, targets = [], [], []
        for number, (ends, offsets) in enumerate(zip(self.ends, self.offsets, strict=True)):
            down, inward = facts.frames[number][:, 0], facts.seat_frames[number][:, 0]
            arc = facts.length / bend * (np.sin(bend) * down + (1 - np.cos(bend)) * inward)
            seat = PLACE + facts.seats[number]
            start = facts.motors[number] + facts.bases[number] + arc
            turned = rotation(bend * np.cross(down, inward)) @ facts.frames[number]
            fixed = seat + offsets @ facts.seat_frames[number].T
            corners = np.column_stack([np.ones(len(ends)), fixed]) @ shares
            stencils.append(np.column_stack([ends, np.tile(self.corners, (len(ends), 1))]))
            weights.append(np.column_stack([np.ones(len(ends)), -corners]))
            targets.append(start + shift * (seat - start) + offsets @ turned.T - fixed)
        stiffness = np.repeat([HELD / len(ends) for ends in self.ends], [len(ends) for ends in self.ends])
        parts = (np.concatenate(part) for part in (stencils, weights, targets))
        return PinEnergy(**dict(zip(("stencils", "weights", "targets"), parts, strict=True)), stiffness=stiffness)

    def find_tips(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, Equilibrium]:
        """Place [m] and turn of the connector at each row of angles [rad], one after the other; the first pose."""
        tips, turns, first = [], [], None
        for row in angles:
            self.pose = self.simulation.solve(row, start=self.pose)
            first = first or self.pose
            tips.append(self.pose.markers["tip"])
            turns.append((self.pose.nodes[self.corners] - tips[-1]).T @ CORNERS / (CORNERS[:, 0] @ CORNERS[:, 0]))
        return np.array(tips), np.array(turns), first or self.pose
