"""`hydrostat identify --suggest`. Oracle: `hydrostat measure` reads the names that it prints."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hydrostat.camera import Photo
from hydrostat.design import Constraints
from hydrostat.errors import InputError
from hydrostat.robot import load_robot

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_names_of_suggested_photographs_can_be_read(run: Run, starfish: Path) -> None:
    code, text, _ = run("identify", starfish, "--suggest", 4, "--fit", "gain", "--tension", "10N")
    assert code == 0
    names = [line.strip() for line in text.splitlines() if line.endswith(".jpg")]
    photos = Photo.read_all([Path(name) for name in names], load_robot(starfish))
    assert len({photo.pose for photo in photos}) == 4
    assert "with tensions up to 10 N" in text
    assert all(0 <= pull <= 0.06 for photo in photos for pull in photo.contractions.values())


def test_pulls_are_bounded_by_the_usual_limit_of_designs(
    run: Run, starfish: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def suggested(*_: object, tension: float, **__: object) -> None:
        raise InputError(f"{tension:g} N")

    monkeypatch.setattr("hydrostat.identification.suggest_measurements", suggested)
    assert run("identify", starfish, "--suggest", 4)[2] == f"hydrostat: error: {Constraints().tension_limit:g} N\n"


def test_fit_or_suggest(run: Run, starfish: Path, tmp_path: Path) -> None:
    for arguments, words in (
        ((), "or --suggest N to plan"),
        (("--suggest", 3, "--out", tmp_path), "Remove --out"),
        ((tmp_path / "a.csv", "--out", tmp_path / "b", "--hang", "5g"), "need --suggest"),
        (("--suggest", 3, "--hang", "50g"), "has no gravity"),
    ):
        code, _, err = run("identify", starfish, *arguments)
        assert (code, words in err) == (2, True), err


def test_steps_keep_equal_poses_apart(run: Run, starfish: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the order of the motion, from names that come in another."""
    stroke = SimpleNamespace(
        commands=1e-3 * np.outer([10.5, 21, 10.5, 0], [1, 0, 0]),
        markers=("top",),
        masses=np.zeros((4, 1)),
        deviations={"friction": 0.5},
        candidates=48,
        noise=1e-3,
        in_order=True,
    )
    monkeypatch.setattr("hydrostat.identification.suggest_measurements", lambda *_, **__: stroke)
    code, text, _ = run("identify", starfish, "--suggest", 4, "--fit", "friction")
    assert (code, "in this order" in text) == (0, True)
    names = [line.strip() for line in text.splitlines() if line.endswith(".jpg")]
    assert names == ["01 right=10.5mm.jpg", "02 right=21mm.jpg", "03 right=10.5mm.jpg", "04 rest.jpg"]
    robot = load_robot(starfish)
    photos = Photo.read_all([Path(name) for name in [*reversed(names), "03 right=10.5mm (2).jpg"]], robot)
    assert [photo.step for photo in photos] == [1, 2, 3, 3, 4]
    assert len({photo.pose for photo in photos}) == 4
