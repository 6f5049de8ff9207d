"""`learn_model`, `correct_model`: from samples to a model, and from a few more samples to a better one."""

import time
from dataclasses import asdict, replace
from importlib.metadata import version
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning.known_contact import contact_in_model
from hydrostat.learning.learn_options import LearnOptions
from hydrostat.learning.learned_model import LearnedModel, index_pairs
from hydrostat.learning.model_card import ModelCard
from hydrostat.learning.sample_plan import SamplingScheme
from hydrostat.learning.samples import Samples
from hydrostat.learning.training_set import TrainingSet
from hydrostat.progress import Progress, no_progress


def learn_model(
    samples: Samples, *, options: LearnOptions | None = None, progress: Progress | None = None
) -> LearnedModel:
    """Train forward networks on sample values and derivatives, then an inverse network through them. Needs PyTorch.

    Ctrl-C ends the training early and returns the best model so far, with `card.stopped` set. It has no inverse
    network if that training had not begun.

    Args:
        samples: samples of one robot.
        options: training options.
        progress: callback for progress in training steps; the stages are "forward" and "inverse".

    Raises:
        InputError: too few samples, or PyTorch is missing.
        KeyboardInterrupt: interrupted before the first usable model.
    """
    from hydrostat.learning.train import train_forward, train_inverse

    options, told = options or LearnOptions(), progress or no_progress
    began, training_set, dim = time.process_time(), TrainingSet.of_samples(samples), samples.facts["dim"]
    kept = kept_facts(samples)
    pairs = index_pairs(kept["pairs"], samples.facts["winches"])
    length = float(training_set.unit[0])
    forward = train_forward(training_set, dim, options, told)
    if not np.isfinite(forward.error):
        if forward.stopped:
            raise KeyboardInterrupt
        raise InputError("the networks learned nothing: try a smaller rate")
    inverse = None if forward.stopped else train_inverse(training_set, dim, forward.networks, options, told, pairs)
    known = 2000  # So many samples a model keeps, to begin a search from
    some = np.linspace(0, len(samples) - 1, min(len(samples), known)).astype(int)
    card = ModelCard(
        **kept,
        version=version("hydrostat"),
        samples=len(samples),
        lost=samples.lost,
        error=length * forward.error,
        inverse_error=None if inverse is None or not np.isfinite(inverse.error) else length * inverse.error,
        displacement=float(_marker_distances(samples.markers).mean()),
        stopped=forward.stopped or (inverse is not None and inverse.stopped),
        options=asdict(options),
        seconds=time.process_time() - began,
    )
    return LearnedModel(
        card=card,
        low=training_set.low,
        high=training_set.high,
        middle=training_set.middle,
        unit=training_set.unit,
        forward=forward.networks,
        inverse=None if inverse is None or not np.isfinite(inverse.error) else inverse.networks,
        known=samples.contractions[some].astype(np.float32).astype(float),
        reached=samples.markers[some].reshape(len(some), -1).astype(np.float32).astype(float),
    )


def kept_facts(samples: Samples) -> dict[str, Any]:
    """Return the fields of a `ModelCard` that describe the robot and how it was sampled."""
    known = samples.facts
    pairs = known["pairs"] if list(known["draws"]) == [SamplingScheme.ANTAGONIST] else ()
    return {
        **{name: known[name] for name in ("robot", "physics", "dim", "node_count", "size")},
        **{name: tuple(known[name]) for name in ("draws", "winches", "markers", "cables")},
        "pairs": tuple(tuple(group) for group in pairs),
        **contact_in_model(known)._asdict(),
    }


def _marker_distances(markers: np.ndarray) -> np.ndarray:
    """Return the distances of markers from their mean."""
    return np.linalg.norm(markers - markers.mean(axis=0), axis=-1)


def correct_model(
    model: LearnedModel, samples: Samples, *, options: LearnOptions | None = None, progress: Progress | None = None
) -> LearnedModel:
    """Train the forward networks further on a few samples of another body, such as a finer mesh or the real robot.

    Predictions change only where the new samples differ. The inverse network stays unchanged, as the start point of
    the search; solve with `search=True`. Needs PyTorch.

    Args:
        model: model of the first body.
        samples: samples of the other body, with the same winches, markers, cables and travel.
        options: training options; members, width and depth are those of the model.
        progress: same as for `learn_model`.

    Raises:
        InputError: too few samples; other winches, markers, cables or travel; or PyTorch is missing.
        KeyboardInterrupt: interrupted before the first usable model.
    """
    from hydrostat.learning.train import train_forward

    kept = kept_facts(samples)
    for name in ("winches", "markers", "cables", "dim", "contact"):
        if kept[name] != getattr(model.card, name):
            raise InputError(f"the samples are of a robot with other {name} than the model's")
    if not all(np.allclose(one, other) for one, other in zip(samples.limits, (model.low, model.high), strict=True)):
        raise InputError("the samples are of a robot whose winches have another travel than the model's")
    steps, rate = 6000, 6e-3  # Default number of steps and learning rate of a correction
    options = replace(options or LearnOptions(steps=steps, rate=rate), members=len(model.forward))
    began, training_set = time.process_time(), TrainingSet.of_samples(samples, model)
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
