"""Emio of SOFA's makers: its four legs as elastic rods, and as volumes on servos, with a rigid connector.

As rods, each leg is a chain of rigid links with elastic joints (bending about both axes of its section, twist), in
equilibrium under weight; unknowns are force and moment at its base. Four angles for three coordinates leave one
freedom: the least elastic energy decides. As volumes, drives turn the pins of the legs.
"""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hydrostat.geometry import Mesh
from hydrostat.mechanics import PinEnergy
from hydrostat.robot import Body, BodyPart, Marker, Material, Pin, PinDrive, Robot, Source
from hydrostat.simulation import BodyPhysics, Equilibrium, Simulation

LINKS = 40
GRAVITY = 9.81  # [m/s^2]
SCALES = np.repeat([1.0, 0.05, 1.0], [12, 12, 7])  # of forces [N], moments [N m], angles
HALF_TURN = np.diag([1.0, -1.0, -1.0])
HELD = 1e7  # stiffness of a clamp and of a weld [N/m]
GRIP = 0.015  # nodes of a leg this near to its far end along each axis belong to the connector [m]
PLACE = np.array([0.0, -0.15, 0.0])  # of the connector in the mesh [m]
CORNERS = 0.012 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
CLAMPED = (((-6, -30, -10), (6, 210, 0)), ((-6, -30, -10), (6, 2, 30)))  # boxes of a leg that turn with its servo [mm]
LEG = "blueleg.vtk"


@dataclass(frozen=True, kw_only=True)
class EmioRobot:
    """Numbers of the robot, in SI, y up; legs in the order of the motors.

    Attributes:
        young: Young's modulus of the legs [Pa].
        poisson: Poisson's ratio.
        density: of legs and connector [kg/m^3].
        section: width along the motor axis and thickness of a leg [m].
        length: free length of a leg [m].
        turns: rotation of each leg from its file to the world, at angle 0.
        motors: place of each motor [m].
        axes: axis of each motor.
        bases: begin of each free length from its motor [m].
        frames: tangent, width and thickness of each leg at rest, as columns.
        seats: place of the end of each leg from the middle of the connector [m].
        seat_frames: tangent, width and thickness of that end, as columns.
        end: place [m] and axes of the end in the file of a leg.
        mass: mass of the connector [kg].
    """

    young: float
    poisson: float
    density: float
    section: tuple[float, float]
    length: float
    turns: np.ndarray
    motors: np.ndarray
    axes: np.ndarray
    bases: np.ndarray
    frames: np.ndarray
    seats: np.ndarray
    seat_frames: np.ndarray
    end: tuple[np.ndarray, np.ndarray]
    mass: float


def read_emio(folder: Path) -> EmioRobot:
    """Read robot.json, the centre line of a leg and the seats of the connector."""
    facts = json.loads((folder / "robot.json").read_text(encoding="utf-8"))
    part = json.loads((folder / "bluepart.json").read_text(encoding="utf-8"))
    line = np.loadtxt(folder / "blueleg_frames.txt")
    extra = facts["leg_extra_euler_deg"]
    motors = [turn_about("y", angle) for angle in facts["motor_euler_deg_y"]]
    mounts = [turn_by(extra[kind]) for kind in facts["leg_position_on_motor"]]
    turns = np.array([motor @ mount for motor, mount in zip(motors, mounts, strict=True)])
    end = 1e-3 * line[-1, :3], quaternion(line[-1, 3:])
    upside = quaternion(part["initialPosition"][0][3:])
    seats = np.array(part["attachPositionInLocalCoord"])
    frames = turns @ end[1]
    seat_frames = np.array([upside @ quaternion(seat[3:]) for seat in seats])
    rolled = np.einsum("lij,lij->l", frames[:, :, 1:2], seat_frames[:, :, 1:2]) < 0
    seat_frames[rolled] = seat_frames[rolled] @ HALF_TURN  # the section is symmetric
    return EmioRobot(
        young=1e3 * facts["youngs_modulus_kPa"],
        poisson=facts["poisson"],
        density=1e9 * facts["density_kg_mm3"],
        section=(1e-3 * facts["leg_section_mm"]["width"], 1e-3 * facts["leg_section_mm"]["thickness"]),
        length=float(end[0][1]),
        turns=turns,
        motors=1e-3 * np.array(facts["motor_centres_mm"]),
        axes=np.array([motor @ facts["motor_axis_local"] for motor in motors]),
        bases=turns @ [0.0, 0.0, 0.022],
        frames=frames,
        seats=1e-3 * seats[:, :3] @ upside.T,
        seat_frames=seat_frames,
        end=end,
        mass=1e9 * facts["density_kg_mm3"] * stl_volume(folder / "bluepart.stl"),
    )


def stl_volume(file: Path) -> float:
    """Volume of a binary STL in millimeters [m^3]."""
    raw = file.read_bytes()
    (count,) = struct.unpack("<I", raw[80:84])
    kind = np.dtype([("normal", "<3f4"), ("corners", "<(3,3)f4"), ("more", "<u2")])
    corners = np.frombuffer(raw[84:], dtype=kind, count=count)["corners"].astype(float)
    return 1e-9 * abs(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


def turn_about(axis: str, degrees: float) -> np.ndarray:
    """Rotation about a coordinate axis."""
    return rotation(np.deg2rad(degrees) * np.eye(3)["xyz".index(axis)])


def turn_by(degrees: list[float]) -> np.ndarray:
    """Rotation by Euler angles about x, then y, then z."""
    return turn_about("z", degrees[2]) @ turn_about("y", degrees[1]) @ turn_about("x", degrees[0])


def quaternion(values: np.ndarray) -> np.ndarray:
    """Rotation of a quaternion x, y, z, w."""
    x, y, z, w = np.array(values) / np.linalg.norm(values)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation(vectors: np.ndarray) -> np.ndarray:
    """Rotations by rotation vectors, (..., 3)."""
    angles = np.maximum(np.linalg.norm(vectors, axis=-1), 1e-12)[..., None, None]
    spins = np.zeros((*vectors.shape, 3))
    spins[..., 2, 1], spins[..., 0, 2], spins[..., 1, 0] = np.moveaxis(vectors, -1, 0)
    spins = spins - np.swapaxes(spins, -1, -2)
    return np.eye(3) + np.sin(angles) / angles * spins + (1 - np.cos(angles)) / angles**2 * (spins @ spins)


def rotation_vector(turns: np.ndarray) -> np.ndarray:
    """Rotation vectors of rotations below a half turn, (..., 3, 3)."""
    skew = 0.5 * (turns - np.swapaxes(turns, -1, -2))
    vectors = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
    sines = np.linalg.norm(vectors, axis=-1)
    angles = np.arctan2(sines, 0.5 * (np.trace(turns, axis1=-2, axis2=-1) - 1))
    return vectors * np.where(sines < 1e-9, 1.0, angles / np.maximum(sines, 1e-12))[..., None]


class RodLegs:
    """Equilibrium of the four rods and the connector."""

    def __init__(self, robot: EmioRobot) -> None:
        """Stiffness and weight of the links of a robot."""
        self.robot = robot
        width, thick = robot.section
        shear = robot.young / (2 + 2 * robot.poisson)
        torsion = width * thick**3 * (1 / 3 - 0.21 * thick / width * (1 - (thick / width) ** 4 / 12))
        bend = robot.young * width * thick**3 / 12, robot.young * thick * width**3 / 12
        self.half = robot.length / LINKS / 2
        self.compliance = 2 * self.half / np.array([shear * torsion, *bend])
        self.weight = np.array([0.0, -GRAVITY * robot.density * width * thick * self.half, 0.0])  # of half a link

    def shoot(self, angles: np.ndarray, forces: np.ndarray, moments: np.ndarray) -> tuple[np.ndarray, ...]:
        """End, frame, force and moment on the connector of each leg, and elastic energy, from loads at the bases."""
        robot = self.robot
        turned = rotation(robot.axes * angles[..., None])
        places = robot.motors + (turned @ robot.bases[..., None])[..., 0]
        frames, energy = turned @ robot.frames, np.zeros(angles.shape[:-1])
        for half in range(2 * LINKS):
            step = self.half * frames[..., :, 0]
            moments = moments - np.cross(step, forces + self.weight / 2)
            forces, places = forces + self.weight, places + step
            if half % 2 == 0:  # the middle of a link bends
                own = (np.swapaxes(frames, -1, -2) @ moments[..., None])[..., 0]
                energy = energy + 0.5 * (own * own * self.compliance).sum(axis=(-1, -2))
                frames = frames @ rotation(-own * self.compliance)
        return places, frames, forces, moments, energy

    def residual(self, unknowns: np.ndarray, place: np.ndarray, yaw: float) -> tuple[np.ndarray, np.ndarray]:
        """Gaps at the seats, load on the connector and distance from a value of the freedom; elastic energy."""
        robot, values = self.robot, unknowns * SCALES
        shape = values.shape[:-1]
        forces, moments = values[..., :12].reshape(*shape, 4, 3), values[..., 12:24].reshape(*shape, 4, 3)
        angles, turn = values[..., 24:28], rotation(values[..., 28:])[..., None, :, :]
        places, frames, forces, moments, energy = self.shoot(angles, forces, moments)
        arms = (turn @ robot.seats[..., None])[..., 0]
        gaps = 10 * (places - place - arms), rotation_vector(np.swapaxes(turn @ robot.seat_frames, -1, -2) @ frames)
        load = forces.sum(axis=-2) + np.array([0.0, -GRAVITY * robot.mass, 0.0])
        torque = 20 * (moments + np.cross(arms, forces)).sum(axis=-2)
        parts = [*(gap.reshape(*shape, 12) for gap in gaps), load, torque, angles.sum(axis=-1)[..., None] - yaw]
        return np.concatenate(parts, axis=-1), energy

    def solve(self, unknowns: np.ndarray, place: np.ndarray, yaw: float) -> tuple[np.ndarray, float]:
        """Newton's method by differences; unknowns and elastic energy at a place of the connector [m]."""
        step = 1e-6
        for _ in range(40):
            values, energy = self.residual(np.vstack([unknowns, unknowns + step * np.eye(31)]), place, yaw)
            if np.linalg.norm(values[0]) < 2e-8:
                return unknowns, float(energy[0])
            unknowns = unknowns - np.linalg.solve((values[1:] - values[0]).T / step, values[0])
        raise RuntimeError(f"no equilibrium of the rods at {1e3 * place} mm")

    def least_energy(self, unknowns: np.ndarray, place: np.ndarray, yaw: float) -> tuple[np.ndarray, float]:
        """Unknowns and value of the freedom with the least elastic energy at a place [m]."""
        width = 0.02
        for _ in range(5):
            unknowns, middle = self.solve(unknowns, place, yaw)
            above, below = (self.solve(unknowns, place, yaw + sign * width)[1] for sign in (1, -1))
            change = -0.5 * width * (above - below) / (above - 2 * middle + below)
            yaw += change
            if abs(change) < 1e-3:
                break
        return self.solve(unknowns, place, yaw)[0], yaw

    def begin(self, place: np.ndarray) -> np.ndarray:
        """Unknowns with all angles 0: legs bent by a quarter turn, then led to their seats at a place [m]."""
        robot, zero = self.robot, np.zeros(4)
        bend = (np.pi / 2) / (LINKS * self.compliance[1])
        inward = np.einsum(
            "li,li->l", np.cross(robot.frames[:, :, 0], robot.seat_frames[:, :, 0]), robot.frames[:, :, 1]
        )
        loads = np.concatenate([np.zeros((4, 3)), -bend * inward[:, None] * robot.frames[:, :, 1]], axis=1)
        places, frames, *_ = self.shoot(zero, loads[:, :3], loads[:, 3:])
        scale = np.repeat([1.0, 0.05], 3)
        loads, shifts = loads / scale, place + robot.seats - places
        turns = rotation_vector(np.swapaxes(frames, -1, -2) @ robot.seat_frames)
        for share in np.linspace(0, 1, 31)[1:]:
            goal, aim = places + share * shifts, frames @ rotation(share * turns)
            for _ in range(20):
                tried = np.concatenate([loads[None], loads + 1e-6 * np.eye(6)[:, None]]) * scale
                ends, axes, *_ = self.shoot(np.zeros((7, 4)), tried[..., :3], tried[..., 3:])
                gaps = np.concatenate([10 * (ends - goal), rotation_vector(np.swapaxes(aim, -1, -2) @ axes)], axis=-1)
                if np.linalg.norm(gaps[0]) < 1e-8:
                    break
                slopes = np.moveaxis((gaps[1:] - gaps[0]) / 1e-6, 0, -1)
                loads = loads - np.linalg.solve(slopes, gaps[0][..., None])[..., 0]
        return np.concatenate([loads[:, :3].ravel(), loads[:, 3:].ravel(), np.zeros(7)])

    def yielding(self, found: np.ndarray, places: np.ndarray, compliance: float) -> np.ndarray:
        """Unknowns if servos asked for the angles in `found` at `places` [m] yield by a compliance [rad/(N m)]."""
        robot, asked, step = self.robot, found[:, 24:28], 1e-6
        unknowns = np.concatenate([found, 10 * places], axis=1)
        for _ in range(20):
            tried = np.concatenate([unknowns[:, None], unknowns[:, None] + step * np.eye(34)], axis=1)
            values, _ = self.residual(tried[..., :31], tried[..., None, 31:] / 10, 0.0)
            loads, angles = tried[..., :24] * SCALES[:24], tried[..., 24:28]
            forces, moments = (part.reshape(*tried.shape[:-1], 4, 3) for part in np.split(loads, 2, axis=-1))
            arms = (rotation(robot.axes * angles[..., None]) @ robot.bases[..., None])[..., 0]
            torques = ((moments + np.cross(arms, forces)) * robot.axes).sum(axis=-1)
            sagged = angles + compliance * torques - asked[:, None]
            values = np.concatenate([values[..., :-1], sagged], axis=-1)
            if np.abs(values[:, 0]).max() < 1e-8:
                return unknowns[:, :31]
            slopes = np.swapaxes(values[:, 1:] - values[:, :1], 1, 2) / step
            unknowns = unknowns - np.linalg.solve(slopes, values[:, 0, :, None])[..., 0]
        raise RuntimeError(f"no equilibrium of the rods on servos of {compliance} rad/(N m)")

    def find_states(self, places: np.ndarray) -> np.ndarray:
        """Unknowns that lead the connector to each place [m], one after the other; 24 to 27 are the angles [rad]."""
        at, yaw, found = np.array([0.0, -0.15, 0.0]), 0.0, []
        unknowns = self.begin(at)
        for place in places:
            steps = max(1, int(np.ceil(np.linalg.norm(place - at) / 8e-3)))
            for share in np.linspace(0, 1, steps + 1)[1:]:
                unknowns, _ = self.solve(unknowns, at + share * (place - at), yaw)
            unknowns, yaw = self.least_energy(unknowns, place, yaw)
            at = place
            found.append(unknowns)
        return np.array(found)


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
