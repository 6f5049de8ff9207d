"""Learned inverse kinematics: samples of the simulator, networks trained on them, answers certified by it."""

from hydrostat.learning.draw import Draw
from hydrostat.learning.export import EXPORTS, export_samples
from hydrostat.learning.sample_folder import SampleFolder
from hydrostat.learning.sample_plan import SamplePlan, plan_samples
from hydrostat.learning.sample_robot import BACKENDS, sample_robot
from hydrostat.learning.sample_shard import sample_shard
from hydrostat.learning.samples import Samples, read_samples

__all__ = [
    "BACKENDS",
    "EXPORTS",
    "Draw",
    "SampleFolder",
    "SamplePlan",
    "Samples",
    "export_samples",
    "plan_samples",
    "read_samples",
    "sample_robot",
    "sample_shard",
]
