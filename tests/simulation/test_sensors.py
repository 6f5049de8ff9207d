"""Sensors. Oracles: an arc, stretched and turned bodies in closed form, free fall, the force of an obstacle."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_mesh, strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, ObstacleShape, Pin, Robot, Sensor, SensorKind, load_robot, save_robot
from hydrostat.simulation import Simulation

pytestmark = pytest.mark.usefixtures("unchecked")

BEND = Sensor(name="flex", kind=SensorKind.BEND, points=((0.02, 0.0), (0.18, 0.0)), noise=0.01)
OTHERS = (
    Sensor(name="skin", kind=SensorKind.STRAIN, points=((0.02, 0.02), (0.18, 0.02))),
    Sensor(name="string", kind=SensorKind.LENGTH, points=((0.02, 0.02), (0.1, -0.02), (0.18, 0.02))),
    Sensor(name="tilt", kind=SensorKind.ORIENTATION, at=(0.1, 0.0)),
    Sensor(name="gyro", kind=SensorKind.GYROSCOPE, at=(0.1, 0.0)),
    Sensor(name="acc", kind=SensorKind.ACCELEROMETER, at=(0.1, 0.0)),
)


def strip(*sensors: Sensor) -> Simulation:
    return Simulation(replace(strip_robot(columns=32, rows=8), sensors=sensors))


def moved(simulation: Simulation, nodes: np.ndarray, velocities: np.ndarray | None = None) -> hs.Motion:
    """An instant with the nodes anywhere."""
    motion = simulation.motion_at_rest()
    return replace(motion, nodes=nodes, velocities=motion.velocities if velocities is None else velocities)


def test_a_body_bent_to_an_arc() -> None:
    """Oracle: an arc of radius R turns by L / R along L, its fibre at height h is shorter by h / R."""
    simulation, radius = strip(BEND, *OTHERS), 0.08
    x, y = simulation.robot.body.mesh.nodes.T
    nodes = np.stack([(radius - y) * np.sin(x / radius), radius - (radius - y) * np.cos(x / radius)], axis=1)
    read = hs.SensorReader(simulation).read(moved(simulation, nodes))
    assert read["flex"] == pytest.approx(0.16 / radius, rel=0.01)
    assert read["skin"] == pytest.approx(-0.02 / radius, rel=0.01)
    assert read["tilt"] == pytest.approx(0.1 / radius, rel=0.04)
    assert read["gyro"] == 0.0
    low, high = np.array([radius - 0.02, radius + 0.02]), np.array([0.02, 0.1, 0.18]) / radius
    spots = [low[index % 2] * np.array([np.sin(angle), -np.cos(angle)]) for index, angle in enumerate(high)]
    assert read["string"] == pytest.approx(sum(np.linalg.norm(np.diff(spots, axis=0), axis=1)), rel=0.01)


@pytest.mark.parametrize("angle", [0.7, -2.0])
def test_a_turned_and_stretched_body(angle: float) -> None:
    """Oracle: closed form. A turn bends and stretches nothing; a body that spins at w has w everywhere."""
    simulation = strip(BEND, *OTHERS)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    nodes = simulation.robot.body.mesh.nodes * [1.1, 1.1] @ turn.T
    read = hs.SensorReader(simulation).read(moved(simulation, nodes, 3.0 * nodes @ np.array([[0, 1.0], [-1.0, 0]])))
    assert read["flex"] == pytest.approx(0.0, abs=1e-9)
    assert read["skin"] == pytest.approx(0.1)
    assert read["tilt"] == pytest.approx(angle)
    assert read["gyro"] == pytest.approx(3.0)


def test_inertial_sensors_in_space() -> None:
    """Oracle: closed form; at rest an accelerometer reads minus gravity, in axes that turn with the body."""
    spin, axis = np.array([0.3, -0.5, 0.9]), np.array([1.0, 2.0, -2.0]) / 3
    path = ((0.01, 0.025, 0.025), (0.09, 0.025, 0.025))
    sensors = (
        Sensor(name="turn", kind=SensorKind.ORIENTATION, at=(0.05, 0.02, 0.02)),
        Sensor(name="gyro", kind=SensorKind.GYROSCOPE, at=(0.05, 0.02, 0.02)),
        Sensor(name="acc", kind=SensorKind.ACCELEROMETER, at=(0.05, 0.02, 0.02)),
        Sensor(name="flex", kind=SensorKind.BEND, points=path, normal=(0, 0, 1)),
        Sensor(name="aside", kind=SensorKind.BEND, points=path, normal=(0, 1, 0)),
    )
    body = mesh_body(box_mesh((16, 3, 3)))
    pins = (Pin(box=((-1.0, -1.0, -1.0), (0.001, 1.0, 1.0))),)
    given = {"name": "box", "body": body, "pins": pins, "poses": {}, "sensors": sensors, "gravity": (0.0, 0.0, -9.81)}
    simulation = Simulation(Robot(**given))
    reader = hs.SensorReader(simulation)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(1.1) * cross + (1 - np.cos(1.1)) * cross @ cross
    nodes = body.mesh.nodes @ turn.T
    read = reader.read(moved(simulation, nodes, np.cross(spin, nodes)))
    assert read["turn"] == pytest.approx(1.1 * axis)
    assert read["gyro"] == pytest.approx(turn.T @ spin)
    assert read["acc"] == pytest.approx(turn.T @ [0, 0, 9.81])
    assert read["flex"] == pytest.approx(0.0, abs=1e-9)
    x, y, z = body.mesh.nodes.T
    bent = np.stack([(0.1 - z) * np.sin(10 * x), y, 0.1 - (0.1 - z) * np.cos(10 * x)], axis=1) @ turn.T
    read = reader.read(moved(simulation, bent))
    assert read["flex"] == pytest.approx(0.8, rel=0.01)
    assert read["aside"] == pytest.approx(0.0, abs=0.02)
    assert reader.heads[:3] == ("turn_x", "turn_y", "turn_z")
    assert len(reader.read_vector(simulation.rest)) == len(reader.heads) == 11


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_pressure_of_a_face(friction: float) -> None:
    """Oracle: the force with which a strip rests on an obstacle, by the area of its lower face."""
    block = Robot(
        name="block",
        body=mesh_body(strip_mesh(16, 4), thickness=0.03, material=FOAM),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0))),),
        poses={},
        gravity=(0.0, -9.81),
        contact=Contact(distance=1e-3, friction=friction),
        obstacles=(Obstacle(name="table", shape=ObstacleShape.PLANE, at=(0.0, -0.027), normal=(0.0, 1.0)),),
        sensors=(Sensor(name="pad", kind=SensorKind.PRESSURE, at=(0.1, -0.025), radius=0.11),),
    )
    simulation = Simulation(block)
    pose = simulation.solve({})
    force = sum(patch.force[1] for patch in hs.find_contacts(simulation, pose))
    facets = block.body.mesh.nodes[block.sensors[0].face(block.body.mesh)]
    assert force > 1e-3
    covered = [facet for facet in facets if facet[:, 1].max() < -0.024]
    assert len(covered) == 16
    area = np.linalg.norm(facets[:, 1] - facets[:, 0], axis=1).sum() * 0.03
    assert hs.SensorReader(simulation).read(pose)["pad"] == pytest.approx(force / area, rel=0.02)


def test_readings_are_outputs_of_a_state_space() -> None:
    """Oracle: readings of equilibria next to the pose; the angular velocity of a motion along a mode."""
    simulation = Simulation(replace(strip_robot(columns=16, rows=4), sensors=(BEND, *OTHERS[:4])))
    pose = simulation.solve(np.array([0.006, 0.002]))
    space, reader = hs.linearize(simulation, pose, modes=4, sensors=True), hs.SensorReader(simulation)
    markers = space.outputs[: -len(reader.heads)]
    assert markers == hs.linearize(simulation, pose, modes=4).outputs
    assert space.outputs[len(markers) :] == ("flex", "skin", "string", "tilt", "gyro")
    for winch, step in enumerate(np.eye(2) * 1e-5):
        ahead, behind = (reader.read_vector(simulation.solve(pose.contractions + sign * step)) for sign in (1, -1))
        assert space.gain[len(markers) :, winch] == pytest.approx((ahead - behind) / 2e-5, rel=1e-4, abs=1e-6)
    first = space.basis[:, 0].reshape(pose.nodes.shape)
    spun = reader.read(replace(simulation.motion_at_rest(pose), velocities=first))["gyro"]
    assert spun != 0.0
    assert space.C[-1, space.basis.shape[1]] == pytest.approx(spun)
    other = strip(*OTHERS)
    with pytest.raises(InputError, match='sensor "acc": a linear model has no accelerometer sensor'):
        hs.linearize(other, other.rest, sensors=True)


def test_noise_is_told_and_repeats() -> None:
    simulation = strip(BEND)
    reader, rest = hs.SensorReader(simulation), simulation.rest
    draws = [reader.read_vector(rest, random=np.random.default_rng(seed))[0] for seed in range(200)]
    assert np.std(draws) == pytest.approx(0.01, rel=0.15)
    assert draws[3] == reader.read(rest, random=np.random.default_rng(3))["flex"]


def test_sensors_are_kept_in_files(tmp_path: Path) -> None:
    """Oracle: what was saved."""
    robot = load_robot("gallery:starfish")
    noisy = (
        replace(BEND, points=((0.0, 0.0), (0.0, 0.03)), noise=0.3),
        Sensor(name="gyro", kind=SensorKind.GYROSCOPE, at=(0.0, 0.0), noise=0.02),
        Sensor(name="skin", kind=SensorKind.STRAIN, points=((0.0, 0.0), (0.0, 0.03)), noise=0.01),
    )
    save_robot(replace(robot, sensors=noisy), tmp_path)
    assert load_robot(tmp_path).sensors == noisy


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"kind": "bend", "at": (0.0, 0.0)}, "needs points"),
        ({"kind": "gyroscope", "points": ((0.0, 0.0), (0.1, 0.0))}, "needs at"),
        ({"kind": "pressure", "at": (0.0, 0.0)}, "radius"),
        ({"kind": "bend", "points": ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0))}, "normal"),
        ({"kind": "smell", "at": (0.0, 0.0)}, "bend"),
        ({"kind": "strain", "points": ((0.0, 0.0), (0.1, 0.0)), "noise": -1.0}, "noise"),
        ({"kind": "strain", "points": ((0.0, 0.0), (0.1, 0.0)), "noise": np.nan}, "noise must be .*, not nan$"),
    ],
)
def test_bad_sensors_get_one_line(given: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        Sensor(name="one", **given)
    assert "\n" not in str(caught.value)


def test_sensors_outside_the_body_are_refused() -> None:
    for sensor, told in (
        (replace(BEND, points=((0.02, 0.0), (0.5, 0.0))), r"sensor\[0\].points\[1\] = .* outside the body"),
        (Sensor(name="pad", kind=SensorKind.PRESSURE, at=(0.1, 0.0), radius=1e-4), "no face of the skin"),
        (Sensor(name="tilt", kind=SensorKind.ORIENTATION, at=(0.1, 0.0, 0.0)), "has 3 coordinates"),
    ):
        with pytest.raises(InputError, match=told):
            strip(sensor)


def test_noise_that_is_no_number_gets_one_line(tmp_path: Path) -> None:
    save_robot(strip(replace(OTHERS[0], noise=0.01)).robot, tmp_path)
    file = tmp_path / "robot.toml"
    file.write_text(file.read_text().replace("noise = 0.01", "noise = nan"))
    with pytest.raises(InputError, match=r"sensor\[0\].noise: [^:\n]*finite"):
        load_robot(tmp_path)


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ("time_s", "b", r'sensor\[0\].name: column "time_s" is that of the motion too. Rename the sensor.'),
        ("left_mm", "b", r"sensor\[0\].name: .* the motion too"),
        ("b_x", "b", r"sensor\[1\].name: column \"b_x\" is that of sensor b_x too"),
    ],
)
def test_names_that_clash_in_tables_are_refused(first: str, second: str, told: str) -> None:
    sensors = (replace(OTHERS[0], name=first), replace(OTHERS[4], name=second))
    robot = strip().robot
    robot = robot.with_network([replace(robot.winches[0], name="left")], [replace(robot.cables[0], winch="left")])
    with pytest.raises(InputError, match=told):
        replace(robot, sensors=sensors)
