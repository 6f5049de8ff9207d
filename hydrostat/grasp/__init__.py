"""Grasps: a robot closes on a thing, which is pulled out again."""

from hydrostat.grasp.pull_out import PullOptions, PullOut, pull_out

__all__ = ["PullOptions", "PullOut", "pull_out"]
