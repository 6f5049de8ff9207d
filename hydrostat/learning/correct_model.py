"""`correct_model`: a model of one body, corrected by a few samples of another that is nearer to the truth."""

import time
from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning.learn_model import kept_facts
from hydrostat.learning.learn_options import LearnOptions
from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.samples import Samples
from hydrostat.learning.training_set import make_training_set
from hydrostat.progress import Progress, no_progress


def correct_model(
    model: LearnedModel, samples: Samples, *, options: LearnOptions | None = None, progress: Progress | None = None
) -> LearnedModel:
    """A model whose forward networks have learned on from a few samples of another body: a finer mesh, or the robot.

    What they know of the first body stays where the samples say nothing against it. The inverse network stays as it
    is, as a place for the search to begin; so answers are found by the search. Needs PyTorch.

    Args:
        model: model of the first body.
        samples: samples of the other, with the same winches, markers, cables and travel.
        options: options of training; its members, width and depth are the model's.
        progress: same as for `learn_model`.

    Raises:
        InputError: too few samples, of a robot with other winches, markers, cables or travel, or no PyTorch.
        KeyboardInterrupt: before there was anything to keep.
    """
    from hydrostat.learning.train import train_forward

    kept = kept_facts(samples)
    for name in ("winches", "markers", "cables", "dim", "contact"):
        if kept[name] != getattr(model.card, name):
            raise InputError(f"the samples are of a robot with other {name} than the model's")
    if not all(np.allclose(one, other) for one, other in zip(samples.limits, (model.low, model.high), strict=True)):
        raise InputError("the samples are of a robot whose winches have another travel than the model's")
    options = replace(options or LearnOptions(steps=_STEPS, rate=_RATE), members=len(model.forward))
    began, training_set = time.process_time(), make_training_set(samples, model)
    trained = train_forward(training_set, model.card.dim, options, progress or no_progress, start=model.forward)
    if not np.isfinite(trained.error):
        if trained.stopped:
            raise KeyboardInterrupt
        raise InputError("the networks learned nothing: try a smaller rate")
    card = replace(
        model.card,
        **kept,
        corrected=len(samples),
        error=float(training_set.unit[0]) * trained.error,
        stopped=trained.stopped,
        seconds=model.card.seconds + time.process_time() - began,
    )
    return replace(model, card=card, forward=trained.networks)


_STEPS, _RATE = 6000, 6e-3
"""Default number of steps and learning rate of a correction."""
