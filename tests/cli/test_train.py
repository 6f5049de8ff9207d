"""`hydrostat train`. Oracles: exit codes, the files that it says it wrote, counts by hand."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrostat.learning import PortablePolicy
from hydrostat.robot import gallery_folder

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
    assert out.splitlines()[-4].endswith("(3 unseen goals)")
    assert PortablePolicy.load(tmp_path / "policy" / "actor.policy").facts["task"] == "reach"
    assert (tmp_path / "policy" / "curve.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--method", "magic"], "--method magic: unknown method. Available: ddpg-her, td3-her, sac-her, tqc-her"),
        (["--simulator-every", 3], "--simulator-every: needs --model"),
        (["--horizon", 0], "steps must be 1 or more, not 0"),
        (["--marker", "nose"], 'unknown marker "nose". Available: '),
        (["--pair", "left,nose"], 'unknown winch "nose". Available: '),
        (["--pair", "left"], "a pair has two winches, not 1: left"),
        (["--processes", 5], "processes must be 1 to 4, the episodes side by side, not 5"),
        (["--friction", 0.2], "this task has no friction: leave it out"),
        (["--task", "fly"], 'unknown task "fly". Available: reach, reach-with-hysteresis, push, twist, walk.'),
        (["--task", "walk", "--actions", "hops"], 'actions must be one of gait, contractions, not "hops"'),
        (["--task", "walk", "--marker", "top"], "this task has no markers: leave it out"),
        (["--task", "twist"], "has nothing to move: give an [[obstacle]] a mass, or give an object (--object)"),
        (["--task", "push", "--object", "egg:3mm"], '--object egg:3mm: unknown shape "egg"'),
        (["--task", "push", "--object", "sphere:9mm", "--at", "3"], "--at 3: 1 coordinate for a body with 2 axes"),
        (["--task", "push", "--at", "3,4"], "--at: needs --object"),
        (["--model", "none.model"], "none.model: there is no such file; name a file that hydrostat learn wrote"),
    ],
)
def test_what_is_wrong_is_told(run: Run, starfish: Path, tmp_path: Path, words: list, told: str) -> None:
    code, _, err = run("train", starfish, "--out", tmp_path / "policy", *words)
    assert code == 2
    assert told in err


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")
def test_what_an_action_is_can_be_asked_for(run: Run, starfish: Path, tmp_path: Path) -> None:
    """A pair has one number, a marker two coordinates; two steps of a tenth of the range bring it nowhere far."""
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    words = ["--steps", 8, "--goals", 2, "--horizon", 2, "--incremental", "--sparse", "--marker", "top"]
    code, out, _ = run("train", starfish, *words, "--pair", "left,right", "--out", tmp_path)
    assert (code, "policy.model" in out) == (0, False)
    with np.load(tmp_path / "checkpoint-8" / "experience.npz", allow_pickle=False) as kept:
        sizes = [kept[name].shape[-1] for name in ("actions", "observations/desired_goal", "observations/observation")]
    assert sizes == [2, 2, 3]
    curve = json.loads((tmp_path / "curve.json").read_text())["curve"]
    assert [point["steps"] for point in curve] == [8]  # four episodes of two actions side by side are one stretch


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning", "ignore::FutureWarning")
def test_other_tasks_are_learned_by_their_names(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An exact episode with friction is a goal, a start and an action; who watches is led to one page."""
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    words = ["--task", "reach-with-hysteresis", "--friction", 0.3, "--steps", 8, "--goals", 2, "--out", tmp_path]
    code, out, _ = run("train", gallery_folder("letter_s"), *words, "--watch")
    assert code == 0
    assert [address in out and address.startswith("http://127.0.0.1:") for address in opened] == [True]
    curve = json.loads((tmp_path / "curve.json").read_text())["curve"]
    assert [point["steps"] for point in curve] == [4, 8]
    assert curve[-1]["equilibria"] >= 24
    assert "policy.model" not in out
    code, out, _ = run("play", gallery_folder("letter_s"), tmp_path / "moves.csv", "--speed", 4)
    assert code == 0
