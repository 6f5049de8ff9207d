"""Fig 5.6. Oracle: a hand without noise whose sensors are straight in the contractions, so that the map is exact."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from hydrostat.teleop import Mimicry

SCRIPT = Path(__file__).parents[1] / "teleoperation" / "glove_poses.py"


@pytest.mark.slow
def test_a_straight_hand_shows_what_the_robot_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made, random = Mimicry(["a", "b", "c"], ["right", "left", "feet"]), np.random.default_rng(0)
    for pose, contractions in enumerate(random.uniform(0.0, 0.02, (9, 3))):
        made.add(pose, contractions @ np.diag([30.0, 20.0, 40.0]), contractions)
    made.save(tmp_path / "poses.csv")
    runpy.run_path(str(SCRIPT))["main"]("gallery:starfish", tmp_path)
    said = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in said] == [
        f"{kind} {n}" for kind in ("training", "new") for n in (1, 2, 3)
    ]
    assert all(float(line.split()[2]) < 0.3 for line in said)
    assert (tmp_path / "glove_poses.png").stat().st_size > 10_000
