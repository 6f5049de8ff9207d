"""Objectives of every kind, on a robot in the plane and on one in space."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import trimesh
from builders import box_robot, strip_robot

from hydrostat.geometry import Outline, Surface
from hydrostat.ik.objectives.center_of_mass_target import CenterOfMassTarget
from hydrostat.ik.objectives.effort import Effort
from hydrostat.ik.objectives.marker_target import MarkerTarget
from hydrostat.ik.objectives.objective import Objective
from hydrostat.ik.objectives.pose_regularizer import PoseRegularizer
from hydrostat.ik.objectives.shape_target import ShapeTarget
from hydrostat.robot import Marker, Robot
from hydrostat.simulation import Simulation


def flat() -> Robot:
    """A strip whose upper cable is taut and whose lower one hangs loose by 5 mm; two markers."""
    robot = strip_robot(columns=12, rows=3)
    loose = replace(robot.cables[1], slack=0.005)
    top = Marker(name="top", at=(0.1, 0.025))
    return replace(robot, cables=(robot.cables[0], loose), markers=(*robot.markers, top))


def space() -> Robot:
    """A box with two markers."""
    robot = box_robot()
    return replace(robot, markers=(*robot.markers, Marker(name="top", at=(0.06, 0.02, 0.04))))


FLAT, SPACE = Simulation(flat()), Simulation(space())
BENT = {2: np.array([0.02, 0.001]), 3: np.array([0.012, 0.004])}
"""In the plane the lower cable is slack, as the upper one bends the strip away from it."""

BEFORE = {dim: simulation.solve(0.6 * BENT[dim]) for dim, simulation in ((2, FLAT), (3, SPACE))}


def arc(length: float = 0.2, height: float = 0.05, turn: float = 0.9, count: int = 40) -> Outline:
    """A strip bent upwards along an arc of a circle, its left end where that of `strip_robot` is."""
    radius, angles = length / turn, np.linspace(0, turn, count)
    sides = [
        np.column_stack([(radius - offset) * np.sin(angles), radius - (radius - offset) * np.cos(angles)])
        for offset in (-0.5 * height, 0.5 * height)
    ]
    return Outline(np.concatenate([sides[0], sides[1][::-1]]))


def ring() -> Outline:
    """The arc with a hole in it."""
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    return Outline(
        arc().exterior, (np.column_stack([0.1, 0.025]) + 0.01 * np.column_stack([np.cos(angles), np.sin(angles)]),)
    )


def surface(made: trimesh.Trimesh) -> Surface:
    return Surface(np.asarray(made.vertices, dtype=float), np.asarray(made.faces))


def box(
    low: tuple[float, float, float] = (0.0, 0.0, 0.0), size: tuple[float, float, float] = (0.12, 0.04, 0.04)
) -> Surface:
    """A box of twelve triangles."""
    made = trimesh.creation.box(size)
    return surface(made.apply_translation(np.array(low) + 0.5 * np.array(size)))


def capsule() -> Surface:
    """A round rod along the body, all its normals different."""
    made = trimesh.creation.capsule(height=0.1, radius=0.025, count=(14, 14))
    made.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0)))
    return surface(made.apply_translation((0.011, 0.023, 0.031)))


PLANE: Mapping[str, Objective] = {
    "markers": MarkerTarget(targets={"tip": (0.17, 0.06), "top": (0.09, 0.05)}),
    "weighted markers": MarkerTarget(
        targets={"tip": (0.17, 0.06), "top": (0.09, 0.05)}, weights={"tip": 3.0, "top": 0.0}, free={"tip": "x"}
    ),
    "outline": ShapeTarget(outline=arc()),
    "outline with a hole": ShapeTarget(outline=ring(), weight=2.5, samples=77),
    "center": CenterOfMassTarget(target=(0.09, 0.02), weight=0.7),
    "contraction": Effort(weight=1e-2),
    "tension": Effort(of="tension", scale=3.0),
    "slack": Effort(of="slack"),
    "as before": PoseRegularizer(pose=BEFORE[2]),
    "contractions as before": PoseRegularizer(pose=BEFORE[2], of="contractions"),
    "body as before": PoseRegularizer(pose=BEFORE[2], of="nodes", weight=0.3),
    "markers as before": PoseRegularizer(pose=BEFORE[2], of="markers", weight=0.3),
    "a marker as before": PoseRegularizer(pose=BEFORE[2], of="markers", markers=("top",)),
}
BODIES: Mapping[str, Objective] = {
    "markers": MarkerTarget(targets={"tip": (0.1, 0.03, 0.05), "top": (0.05, 0.02, 0.05)}),
    "weighted markers": MarkerTarget(targets={"tip": (0.1, 0.03, 0.05)}, weights={"tip": 0.2}, free={"tip": "xz"}),
    "surface": ShapeTarget(surface=capsule()),
    "box": ShapeTarget(surface=box(low=(0.003, -0.002, 0.005)), weight=0.5, samples=150),
    "center": CenterOfMassTarget(target=(0.05, 0.02, 0.03)),
    "contraction": Effort(),
    "tension": Effort(of="tension"),
    "slack": Effort(of="slack", scale=0.02),
    "contractions as before": PoseRegularizer(pose=BEFORE[3], of="contractions"),
    "body as before": PoseRegularizer(pose=BEFORE[3], of="nodes"),
}
