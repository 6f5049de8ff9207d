"""`trajectory_frames`: a trajectory as frames of an animation, at the pace at which it is played."""

from math import ceil

import numpy as np

from hydrostat.ik import KeyPose, Trajectory
from hydrostat.plot.frame import Frame
from hydrostat.plot.labels import shorten
from hydrostat.plot.sheet import MILLIMETRES

MOST = 240
"""Frames of a long trajectory."""

STEP = 0.04
"""Time of a frame of a short trajectory [s]."""

END = 0.6
"""How long the last pose is shown [s]."""


def trajectory_frames(trajectory: Trajectory) -> tuple[list[Frame], float]:
    """Frames at equal times, each the sample that is nearest; and the time of a frame [s]."""
    step = max(STEP, ceil(100 * trajectory.seconds / MOST) / 100)
    count = max(ceil(trajectory.seconds / step), 1)
    frames = []
    for time in np.linspace(0.0, trajectory.seconds, count + 1):
        sample = int(np.argmin(np.abs(trajectory.times - time)))
        key, there = _key(trajectory, sample)
        frames.append(Frame.of(trajectory.poses[sample], target=key.target, words=_words(key, there)))
    return [*frames, *[frames[-1]] * ceil(END / step)], step


def _key(trajectory: Trajectory, sample: int) -> tuple[KeyPose, bool]:
    """The keyframe that is approached, or in which the robot stays."""
    for before in reversed(trajectory.keys):
        if before.index <= sample:
            stays = (trajectory.contractions[sample] == trajectory.contractions[before.index]).all()
            if stays or before is trajectory.keys[-1]:
                return before, True
            break
    return next(key for key in trajectory.keys if key.index > sample), False


def _words(key: KeyPose, there: bool) -> str:
    name = shorten(key.name)
    if not there:
        return f"to {name}"
    return f"{name}: marker error {MILLIMETRES * key.rms_error:.1f} mm rms" if key.errors else name
