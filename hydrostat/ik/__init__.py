"""Which contractions reach a pose."""

from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.solve_ik import InverseOptions, solve_ik

__all__ = ["InverseOptions", "InverseReason", "ReachedPose", "solve_ik"]
