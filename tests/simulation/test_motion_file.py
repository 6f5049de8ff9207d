"""A motion on disk; oracle: the motion itself, and the files read back by meshio and an XML reader."""

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from builders import box_robot, strip_robot

import hydrostat as hs
from hydrostat.robot import Sensor, SensorKind
from hydrostat.simulation import write_motion


@pytest.mark.parametrize("make", [lambda: strip_robot(columns=4, rows=2), box_robot])
def test_table_and_frames_hold_the_motion(tmp_path: Path, make: object) -> None:
    robot = make()
    simulation = hs.Simulation(robot)
    motions = list(simulation.play(hs.ContractionProfile.ramp(np.array([0.004, 0.001]), 0.05), 0.1, 0.01))
    files, table, last = write_motion(robot, iter(motions), tmp_path / "new")
    assert last is motions[-1]
    assert table.times == pytest.approx(0.01 * np.arange(11))
    with files[0].open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 11
    for row, motion in zip(rows, motions, strict=True):
        winch = robot.winches[0].name
        assert float(row[f"{winch}_mm"]) == pytest.approx(1e3 * motion.contractions[0])
        assert float(row["tip_y_mm"]) == pytest.approx(1e3 * motion.markers["tip"][1], rel=1e-8)
        assert float(row["cable_1_N"]) == pytest.approx(motion.tensions[0], rel=1e-8)
        assert float(row["potential_J"]) == pytest.approx(motion.potential, rel=1e-8)
    sets = ElementTree.parse(files[1]).getroot().findall("*/DataSet")
    assert [float(entry.get("timestep")) for entry in sets] == pytest.approx([0.0, 0.04, 0.07, 0.1])
    for entry in sets:
        motion = motions[round(float(entry.get("timestep")) / 0.01)]
        read = meshio.read(files[1].parent / entry.get("file"))
        dim = robot.body.mesh.dim
        assert (read.points[:, :dim] == motion.nodes).all()
        assert (read.point_data["velocity"][:, :dim] == motion.velocities).all()
    assert not list(tmp_path.rglob("*part*"))


def test_a_motion_that_stops_is_written_as_far_as_it_got(tmp_path: Path) -> None:
    robot = strip_robot(columns=4, rows=2)
    simulation = hs.Simulation(robot)

    def stopping() -> Iterator[hs.Motion]:
        yield simulation.motion_at_rest()
        yield simulation.step(simulation.motion_at_rest(), {}, 0.01)
        raise hs.NotConvergedError("stuck", None)

    with pytest.raises(hs.NotConvergedError, match="stuck"):
        write_motion(robot, stopping(), tmp_path)
    assert len((tmp_path / "motion.csv").read_text().splitlines()) == 3
    assert "motion_0000.vtu" in (tmp_path / "motion.pvd").read_text()


def test_readings_are_columns(tmp_path: Path) -> None:
    """Oracle: the reader, at the last instant."""
    path = ((0.02, 0.0), (0.18, 0.0))
    sensors = (
        Sensor(name="flex", kind=SensorKind.BEND, points=path),
        Sensor(name="acc", kind=SensorKind.ACCELEROMETER, at=(0.1, 0.0)),
    )
    simulation = hs.Simulation(replace(strip_robot(columns=8, rows=2), sensors=sensors))
    reader, profile = hs.SensorReader(simulation), hs.ContractionProfile.ramp(np.array([0.01, 0.0]), 0.05)
    motions = simulation.play(profile, 0.05, 0.01)
    files, table, last = write_motion(simulation.robot, motions, tmp_path, reader=reader)
    head, *_, final = files[0].read_text().splitlines()
    assert head.split(",")[-3:] == ["flex_deg", "acc_x_m_s2", "acc_y_m_s2"]
    assert np.array_equal(table.sensors[-1], reader.read_vector(last))
    assert np.array(final.split(",")[-3:], float) == pytest.approx(table.sensors[-1] * [180 / np.pi, 1, 1])
    assert abs(table.sensors[-1, 1]) > 0
