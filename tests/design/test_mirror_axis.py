"""Poses that are their own mirror image. Oracle: a plate, even about y = 0, with markers and targets placed by hand."""

from dataclasses import replace

import numpy as np
import pytest
from builders import mesh_body
from plate_networks import network

from hydrostat.design import find_mirror_axis, find_unmirrored_poses
from hydrostat.geometry import Mesh
from hydrostat.robot import Marker, PoseTarget, Robot


def plate(*, low: tuple[float, float] = (0.2, -0.05)) -> Robot:
    """A plate with a marker at each corner of its free end and one between them."""
    markers = {"high": (0.2, 0.05), "middle": (0.2, 0.0), "low": low}
    return replace(network(), markers=tuple(Marker(name=name, at=at) for name, at in markers.items()))


HIGH, LOW = (0.18, 0.02), (0.18, -0.02)


@pytest.mark.parametrize(
    ("targets", "axis"),
    [
        ({"high": HIGH, "low": LOW}, "y"),
        ({"high": HIGH, "low": LOW, "middle": (0.19, 0.0)}, "y"),
        ({"high": HIGH, "low": (0.18, -0.03)}, None),
        ({"high": HIGH}, None),
        ({"high": HIGH, "low": LOW, "middle": (0.19, 0.01)}, None),
    ],
)
def test_targets_of_twins_are_images(targets: dict[str, tuple[float, ...]], axis: str | None) -> None:
    assert find_mirror_axis(plate(), [PoseTarget(name="pose", targets=targets)]) == axis


def test_the_body_and_its_markers_are_images_too() -> None:
    both = PoseTarget(name="both", targets={"high": HIGH, "low": LOW})
    assert find_mirror_axis(plate(low=(0.15, -0.05)), [both]) is None
    robot, mesh = plate(), plate().body.mesh
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    kept = mesh.elements[~((middles[:, 1] > 0.025) & (middles[:, 0] > 0.05) & (middles[:, 0] < 0.15))]
    nodes, elements = np.unique(kept, return_inverse=True)
    notched = Mesh(mesh.nodes[nodes], elements.reshape(kept.shape))
    assert find_mirror_axis(replace(robot, body=mesh_body(notched), winches=(), cables=()), [both]) is None


def test_poses_may_be_images_of_each_other() -> None:
    """Oracle: one marker lifted in each pose, by as much; by another length neither is an image."""
    one = PoseTarget(name="one", targets={"high": HIGH, "low": (0.2, -0.05)})
    two = PoseTarget(name="two", targets={"low": LOW, "high": (0.2, 0.05)})
    far = PoseTarget(name="far", targets={"low": (0.18, -0.03), "high": (0.2, 0.05)})
    assert find_mirror_axis(plate(), [one, two]) == "y"
    assert find_mirror_axis(plate(), [one, far]) is None
    assert find_mirror_axis(plate(), [one]) is None
    assert find_unmirrored_poses(plate(), [one, two], "y") == ()
    assert find_unmirrored_poses(plate(), [one, far, two], "y") == ("far",)
    assert find_unmirrored_poses(plate(low=(0.15, -0.05)), [one], "y") == ("one",), "a marker without an image"
