"""`solve_stuffed_motion`: motion of a flat robot once it is stuffed and its cables are sewn on one side."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import CableSide, Robot, inflated_robot
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, kw_only=True)
class StuffedMotion:
    """Marker distances between a stuffed robot and its flat model, each the largest over all poses [m]."""

    face: CableSide  # side on which its cables run
    moved: float  # marker displacement in the flat model [m]
    out: float  # marker distance from the plane [m]
    aside: float  # marker distance from the flat model within the plane [m]
    tension: float  # largest cable tension [N]
    nodes: int  # number of nodes of the 3D mesh

    def __str__(self) -> str:
        """Such as "0.4 mm out of plane, 10 mm in-plane deviation (flat model moves 57 mm)"."""
        out, aside, moved = (
            f"{value:.0f}" if value >= 10 else f"{value:.1f}"
            for value in (1e3 * self.out, 1e3 * self.aside, 1e3 * self.moved)
        )
        return f"{out} mm out of plane, {aside} mm in-plane deviation (flat model moves {moved} mm)"

    @property
    def warning(self) -> str | None:
        """Warning of a stuffed body that leaves its plane; None where that is a quarter of the move at most.

        Motion out of the plane is in no flat model, and no flat design counts it. Pairs keep a body in its plane unless
        limbs get much shorter.
        """
        most = 0.25  # share of the displacement in the flat model
        if self.out <= most * self.moved:
            return None
        if self.face.flat:
            return f"stuffed body: {self}. The flat model does not hold for so strong a pull. Choose nearer targets"
        return (
            f"cables {self.face.words}: they bend the stuffed body {1e3 * self.out:.0f} mm out of plane, where the "
            f'flat model moves {1e3 * self.moved:.0f} mm in it. Set face = "pairs" above [body] to sew on both panels'
        )


def is_stuffed_motion_fast(robot: Robot, poses: int) -> bool:
    """Return True if `solve_stuffed_motion` of this number of poses takes seconds: a flat drawn body, not too fine."""
    body = robot.body
    if body.outline is None or body.thickness is None or not robot.cables or not poses:
        return False
    across = max(body.thickness / (body.element_size or body.mesh.size / 25), 1.0)
    deep = 1.5  # nodes of the body in space for each of the flat mesh and each element of its thickness
    quick = 8000  # nodes times poses
    return poses * deep * across * len(body.mesh.nodes) <= quick


def solve_stuffed_motion(
    robot: Robot,
    contractions: Sequence[Vector],
    face: CableSide | str | None = None,
    *,
    element_size: float | None = None,
) -> StuffedMotion:
    """Play contractions on a flat robot and on the body in space that it becomes (`inflated_robot`), and compare.

    Args:
        robot: flat robot with a drawing.
        contractions: contractions of all winches for each pose [m].
        face: side on which its cables run; None: the robot's own, or else the front.
        element_size: size of the tetrahedra [m]; None: that of the flat mesh.

    Raises:
        InputError: a robot in space, one without a drawing, or a body too thick for its outline.
        NotConvergedError: a pose that has no equilibrium.
    """
    face = CableSide(face or robot.face or CableSide.FRONT)
    flat, solid = Simulation(robot), Simulation(inflated_robot(robot, face, element_size=element_size))
    moved, out, aside, tension = 0.0, 0.0, 0.0, 0.0
    for pulled in contractions:
        before, after = flat.solve(pulled), solid.solve(pulled)
        tension = max(tension, float(after.tensions.max(initial=0.0)))
        for marker in robot.markers:
            drawn, found = before.markers[marker.name], after.markers[marker.name]
            moved = max(moved, float(np.linalg.norm(drawn - marker.at)))
            out = max(out, abs(float(found[2])))
            aside = max(aside, float(np.linalg.norm(found[:2] - drawn)))
    nodes = len(solid.robot.body.mesh.nodes)
    return StuffedMotion(face=face, moved=moved, out=out, aside=aside, tension=tension, nodes=nodes)
