"""`hydrostat train`. Oracles: exit codes, the files that it says it wrote, counts by hand."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]
pytest.importorskip("gymnasium", reason="gymnasium is not installed")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")
def test_a_few_actions_are_judged_and_counted(run: Run, starfish: Path, tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    code, out, _ = run("train", starfish, "--steps", 20, "--goals", 3, "--out", tmp_path / "policy")
    assert code == 0
    curve = json.loads((tmp_path / "policy" / "curve.json").read_text())["curve"]
    assert [point["steps"] for point in curve] == [4, 8, 12, 16, 20]  # four episodes side by side
    assert curve[-1]["equilibria"] >= 40  # a goal and an action each
    assert out.splitlines()[-2].endswith("on 3 unseen goals")
    assert (tmp_path / "policy" / "curve.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--method", "magic"], "--method magic: there are: ddpg-her, td3-her, sac-her, tqc-her"),
        (["--exact", 3], "--exact is for networks, with --model"),
        (["--horizon", 0], "steps must be 1 or more, not 0"),
        (["--processes", 5], "processes must be 1 to 4, the episodes side by side, not 5"),
        (["--model", "none.model"], "none.model: cannot be read"),
    ],
)
def test_what_is_wrong_is_told(run: Run, starfish: Path, tmp_path: Path, words: list, told: str) -> None:
    code, _, err = run("train", starfish, "--out", tmp_path / "policy", *words)
    assert code == 2
    assert told in err
