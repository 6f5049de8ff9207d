"""USD scenes: usd-core reads them back; the volume of the skin is that of the body."""

from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

from hydrostat.errors import InputError
from hydrostat.export import usd_text


def _volume(points: np.ndarray, counts: np.ndarray, corners: np.ndarray) -> float:
    """Volume inside a closed skin, by the divergence theorem."""
    total, first = 0.0, 0
    for count in counts:
        face = points[corners[first : first + count]]
        first += count
        total += sum(np.dot(face[0], np.cross(face[j], face[j + 1])) / 6 for j in range(1, count - 1))
    return total


def test_frames_that_do_not_fit_are_rejected() -> None:
    robot = strip_robot()
    with pytest.raises(InputError, match="frame 0 must be finite"):
        usd_text(robot, [robot.body.mesh.nodes[1:]], step=0.1)
    with pytest.raises(InputError, match="needs frames and a time step above 0 s"):
        usd_text(robot, [robot.body.mesh.nodes], step=0.0)


@pytest.mark.parametrize("name", ["strip", "octopus_arm"])
def test_usd_core_reads_the_skin_and_cables_over_time(name: str, tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd")
    geometry = pytest.importorskip("pxr.UsdGeom")
    robot = strip_robot() if name == "strip" else gallery_robot(name)
    nodes = robot.body.mesh.nodes
    path = tmp_path / f"{name}.usda"
    path.write_text(usd_text(robot, [nodes, 1.5 * nodes], step=0.04))
    stage = usd.Stage.Open(str(path))
    assert stage.GetTimeCodesPerSecond() == 25
    assert stage.GetEndTimeCode() == 1
    mesh = geometry.Mesh(stage.GetPrimAtPath("/robot/body"))
    counts, corners = (
        np.array(each.Get()) for each in (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr())
    )
    for time, scale in ((0, 1.0), (1, 1.5)):
        volume = _volume(np.array(mesh.GetPointsAttr().Get(time), dtype=float), counts, corners)
        body = robot.body.mesh.volumes.sum() * (robot.body.thickness or 1.0)
        assert volume == pytest.approx(scale**robot.body.mesh.dim * body, rel=1e-4)
    curve = geometry.BasisCurves(stage.GetPrimAtPath("/robot/cable_0"))
    assert np.array(curve.GetPointsAttr().Get(0))[:, : robot.body.mesh.dim] == pytest.approx(
        np.array(robot.cables[0].points), abs=1e-3
    )
