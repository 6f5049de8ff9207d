"""Learned inverse kinematics: simulated samples, networks trained on them, answers checked by simulation."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.learning.export import check_export, export_samples
    from hydrostat.learning.learn_model import correct_model, learn_model
    from hydrostat.learning.learn_options import LearnOptions
    from hydrostat.learning.learned_model import TANH_SCALE, LearnedModel
    from hydrostat.learning.model_card import ModelCard
    from hydrostat.learning.perceptrons import Perceptrons
    from hydrostat.learning.portable_policy import PortablePolicy
    from hydrostat.learning.sample_plan import SamplePlan, SamplingScheme, antagonists, physics_hash, shared_numbers
    from hydrostat.learning.sample_robot import sample_robot
    from hydrostat.learning.sample_shard import sample_shard
    from hydrostat.learning.samples import Samples
    from hydrostat.learning.train import answer, tensors_of, train_forward
    from hydrostat.learning.training_set import MIN_SAMPLES, TrainingSet, linear_map
    from hydrostat.learning.verify import exact_steps, solve_exactly, verify

__all__ = [
    "MIN_SAMPLES",
    "TANH_SCALE",
    "LearnOptions",
    "LearnedModel",
    "ModelCard",
    "Perceptrons",
    "PortablePolicy",
    "SamplePlan",
    "Samples",
    "SamplingScheme",
    "TrainingSet",
    "answer",
    "antagonists",
    "check_export",
    "correct_model",
    "exact_steps",
    "export_samples",
    "learn_model",
    "linear_map",
    "physics_hash",
    "sample_robot",
    "sample_shard",
    "shared_numbers",
    "solve_exactly",
    "tensors_of",
    "train_forward",
    "verify",
]

open_package(__name__)
