"""
Your own objective
==================

At the end, inverse kinematics brings both feet of a starfish to the same height.
"""

# %%
# An objective is data. On a robot it becomes a residual [m] with its Jacobian.
import numpy as np

import hydrostat as hs
from hydrostat.testing import check_objective


class LevelFeet(hs.Objective):
    """Left and right foot at one height."""

    def bind(self, simulation):
        """Return the residual on this robot: rows that interpolate markers from nodes."""
        names = [marker.name for marker in simulation.robot.markers]
        matrix = simulation.marker_anchors.matrix(len(simulation.rest.nodes)).toarray()
        return LevelResidual(matrix[names.index("left_foot")] - matrix[names.index("right_foot")])


class LevelResidual(hs.Residual):
    """Difference in height of two markers."""

    def __init__(self, weights):
        self.weights = weights

    def residual(self, posture):
        """Return the difference in height [m]."""
        return self.weights[None] @ posture.nodes[:, 1]

    def jacobian(self, posture, moves):
        """Return its change with the contractions."""
        return self.weights[None] @ moves.nodes[:, 1]

    def errors(self, posture):
        """Return what is left [m]."""
        return {"level": abs(float(self.residual(posture)[0]))}


# %%
# Check the Jacobian by finite differences, then combine the objective with a target.
simulation = hs.Simulation(hs.load_robot("gallery:starfish"))
check_objective(LevelFeet(), simulation, [0.01, 0.015, 0.01])
found = hs.solve_ik(simulation, {"left": (-0.121, 0.045)}, objectives=[LevelFeet()])
level = found.errors["level"]
print(found.status, f"feet differ by {1e3 * level:.3f} mm", np.round(1e3 * found.pose.contractions, 1), "mm")
figure = found.pose.plot()
