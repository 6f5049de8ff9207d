"""`rms_error`: the pose error over several poses."""

from collections.abc import Sequence

import numpy as np

from hydrostat.ik import ReachedPose


def rms_error(reached: Sequence[ReachedPose]) -> float:
    """Root of the mean squared marker error over poses [m]."""
    return float(np.sqrt(np.mean([pose.rms_error**2 for pose in reached])))
