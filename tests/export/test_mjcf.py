"""MuJoCo models: MuJoCo itself is the independent program; lengths and masses are those of hydrostat."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_robot

from hydrostat.errors import InputError
from hydrostat.export import find_omissions, mjcf_text
from hydrostat.export.measure_mjcf import MjcfError, SettledModel, measure_mjcf
from hydrostat.export.mjcf_statics import MjcfStatics
from hydrostat.robot import Cable, Marker, Material, Mount, Pin, PinDrive, Robot, Winch
from hydrostat.simulation import Simulation


def _block() -> Robot:
    """Block in space with one cable near its top face, held at its left end."""
    body = mesh_body(box_mesh((8, 2, 2), size=(0.2, 0.05, 0.05)))
    return Robot(
        name="block",
        body=body,
        pins=(Pin(box=((-0.001, -0.1, -0.1), (0.001, 0.1, 0.1))),),
        winches=(Winch(name="top", at=(0.0, 0.025, 0.04), travel=0.03),),
        cables=(Cable(winch="top", points=((0.0, 0.025, 0.04), (0.07, 0.025, 0.04), (0.19, 0.025, 0.04))),),
        markers=(Marker(name="tip", at=(0.2, 0.025, 0.025)),),
        poses={},
    )


def _with_small_strains(robot: Robot) -> Robot:
    """Robot whose cables pull 4 mm at most and begin to pull within 0.1 mm: laws of large strains differ."""
    cables = tuple(replace(cable, smoothing=5e-5) for cable in robot.cables)
    return replace(robot, cables=cables, winches=tuple(replace(winch, travel=0.004) for winch in robot.winches))


def test_a_model_is_well_formed_and_names_each_part() -> None:
    tree = ElementTree.fromstring(mjcf_text(strip_robot(), remarks=["a --- b----"], range_share=0.5))
    winch = strip_robot().winches[0]
    names = [each.get("name") for each in tree.findall("actuator/general")]
    assert names == [cable.name for cable in strip_robot().cables]
    assert float(tree.findall("actuator/general")[0].get("ctrlrange", "").split()[1]) == pytest.approx(winch.travel / 2)


def test_parts_without_counterpart_are_rejected_or_listed() -> None:
    robot = _block()
    drive = PinDrive(name="base", slide=(0.0, 0.0, 1.0), min=-0.01, max=0.01)
    driven = replace(robot, pins=tuple(replace(pin, drive="base") for pin in robot.pins), drives=(drive,))
    with pytest.raises(InputError, match='drive "base": not available in MJCF'):
        mjcf_text(driven)
    rubbing = replace(robot, cables=tuple(replace(cable, friction=0.2) for cable in robot.cables))
    assert find_omissions(robot) == ()
    assert find_omissions(rubbing) == ("cable friction",)
    for young, stiffness in ((30e3, 1.0), (30e6, 200e3)):
        pins = tuple(replace(pin, stiffness=stiffness) for pin in robot.pins)
        assert find_omissions(replace(robot.with_material(young=young), pins=pins)) == (
            "stiffness of pins (they are rigid)",
        )
    assert "did not settle" in MjcfError(share=None, num_poses=3).describe()


@pytest.mark.parametrize("given", [{}, {"mount": Mount.WORLD}, {"sheathed": ((0, 1),), "slack": 1e-3}])
def test_mujoco_reads_masses_and_cable_lengths(given: dict) -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = strip_robot(**given)
    model = mujoco.MjModel.from_xml_string(mjcf_text(robot))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    simulation = Simulation(robot)
    points = simulation.route_points
    spans = np.linalg.norm(points.spans(points.positions(robot.body.mesh.nodes)), axis=1)
    lengths = np.bincount(points.cables, spans, len(robot.cables))
    assert data.ten_length[: len(robot.cables)] == pytest.approx(lengths, rel=1e-6)
    assert np.abs(data.actuator_force).max() == 0.0  # a cable at rest does not pull
    nodes = [number for number in range(model.nbody) if model.body(number).name.startswith("node_")]
    free = [int(model.body(number).name.removeprefix("node_")) for number in nodes]
    assert model.body_mass[nodes] == pytest.approx(simulation.body.masses[free], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("poisson", [0.3, 0.4])
def test_a_flat_model_settles_where_hydrostat_does(poisson: float) -> None:
    pytest.importorskip("mujoco")
    robot = strip_robot(columns=12, rows=4).with_material(Material(young=30e3, poisson=poisson, density=40))
    found = measure_mjcf(_with_small_strains(robot), 2)
    assert found.share == 1.0
    assert found.error < 0.03 * found.travel


@pytest.mark.slow
def test_a_model_in_space_settles_where_hydrostat_does() -> None:
    pytest.importorskip("mujoco")
    found = measure_mjcf(_with_small_strains(_block()), 1)
    assert found.share == 1.0
    assert found.error < 0.03 * found.travel


@pytest.mark.slow
def test_the_weight_of_a_block_bends_it_as_in_hydrostat() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = replace(_block(), cables=(), winches=(), gravity=(0.0, 0.0, -1.0))
    model = mujoco.MjModel.from_xml_string(mjcf_text(robot))
    data = mujoco.MjData(model)
    for _ in range(1500):
        mujoco.mj_step(model, data)
    simulation = Simulation(robot)
    sag = simulation.solve({}).markers["tip"][2] - 0.025
    assert data.site("marker tip").xpos[2] - 0.025 == pytest.approx(sag, rel=0.02)


def test_poses_settle_in_time_where_the_static_search_ends() -> None:
    """An oscillation is slow where it turns, which must not count as rest."""
    pytest.importorskip("mujoco")
    robot = _with_small_strains(strip_robot(columns=12, rows=4))
    simulation = Simulation(robot)
    contractions = np.array([1.0, 0.3]) * [winch.travel for winch in robot.winches]
    pose = simulation.solve(contractions)
    found = MjcfStatics(robot, simulation).find_markers(pose, contractions, pose.nodes)
    settled = SettledModel(robot, None).find_markers(contractions)
    assert found is not None
    assert settled == pytest.approx(found[0], abs=1.5e-5)
