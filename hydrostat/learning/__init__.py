"""Learned inverse kinematics: samples of the simulator, networks trained on them, answers certified by it."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.learning.certify import certify, solve_exactly
    from hydrostat.learning.compare import METHODS, Compared, compare
    from hydrostat.learning.correct_model import correct_model
    from hydrostat.learning.draw import Draw
    from hydrostat.learning.export import EXPORTS, check_export, export_samples
    from hydrostat.learning.learn_model import learn_model
    from hydrostat.learning.learn_options import LearnOptions
    from hydrostat.learning.learned_model import LearnedModel
    from hydrostat.learning.learned_pose import LearnedPose, Tier
    from hydrostat.learning.model_file import load_model, save_model
    from hydrostat.learning.portable_policy import PortablePolicy, load_policy
    from hydrostat.learning.sample_folder import SampleFolder
    from hydrostat.learning.sample_plan import SamplePlan, physics_hash, plan_samples
    from hydrostat.learning.sample_robot import BACKENDS, sample_robot
    from hydrostat.learning.sample_shard import sample_shard
    from hydrostat.learning.samples import Samples, read_samples
    from hydrostat.learning.study import Study, StudyRow, run_study

__all__ = [
    "BACKENDS",
    "EXPORTS",
    "METHODS",
    "Compared",
    "Draw",
    "LearnOptions",
    "LearnedModel",
    "LearnedPose",
    "PortablePolicy",
    "SampleFolder",
    "SamplePlan",
    "Samples",
    "Study",
    "StudyRow",
    "Tier",
    "certify",
    "check_export",
    "compare",
    "correct_model",
    "export_samples",
    "learn_model",
    "load_model",
    "load_policy",
    "physics_hash",
    "plan_samples",
    "read_samples",
    "run_study",
    "sample_robot",
    "sample_shard",
    "save_model",
    "solve_exactly",
]

open_package(__name__)
