"""Which contractions reach a pose."""

from hydrostat.ik.reached_pose import InverseReason, ReachedPose

__all__ = ["InverseReason", "ReachedPose"]
