"""A hand that is not there, in a glove that is not there: its sensors follow the contractions of ten winches."""

import numpy as np

from hydrostat.teleop import CyberGlove, Mimicry
from hydrostat.teleop.cyber_glove import SENSORS, EmulatedGlove

OUTPUTS = 10
RANDOM = np.random.default_rng(3)
MIX = np.equal.outer(np.arange(OUTPUTS), np.arange(SENSORS) % OUTPUTS).astype(float)  # two or three sensors a cable,
MIX = RANDOM.uniform(0.7, 1.2, (OUTPUTS, 1)) * MIX + 0.1 * RANDOM.normal(size=MIX.shape)  # and a little of all others


def shown(contractions: np.ndarray, bent: float = 0.0) -> np.ndarray:
    """What the sensors of a synthetic hand show, from 0 to 1; `bent` is how much they are not straight."""
    straight = contractions @ MIX
    return np.clip(0.5 + 0.28 * (straight + bent * straight**2), 0.0, 1.0)


def mimicked(poses: int, *, noise: float = 0.0, repeats: int = 1, bent: float = 0.0, seed: int = 1) -> Mimicry:
    """Random poses, each told so many times by a noisy glove."""
    random = np.random.default_rng(seed)
    made = Mimicry(CyberGlove.names, [f"winch {n}" for n in range(OUTPUTS)])
    emulated = EmulatedGlove(np.zeros(SENSORS), noise=noise)
    glove = CyberGlove(emulated)
    for pose, contractions in enumerate(random.uniform(-1, 1, (poses, OUTPUTS))):
        emulated.values = shown(contractions, bent)
        for _ in range(repeats):
            made.add(pose, glove.read().values, contractions)
    return made


def averaged(made: Mimicry, repeats: int) -> Mimicry:
    """The same with the mean of what each pose was told, as often as this."""
    mean = Mimicry(made.sensors, made.outputs)
    rows = zip(made.inputs.reshape(-1, repeats, SENSORS).mean(1), made.answers[::repeats], strict=True)
    for pose, (sensors, answer) in enumerate(rows):
        mean.add(pose, sensors, answer)
    return mean
