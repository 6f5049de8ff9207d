"""`hydrostat export`: files that other programs read; tests/export has what is in them."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.export import MjcfTuning
from hydrostat.export.fit_mjcf import MjcfFit, MjcfPoseErrors
from hydrostat.export.measure_mjcf import MjcfError

Run = Callable[..., tuple[int, str, str]]


def test_export_writes_both_files(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, out, _ = run("export", starfish, "--mjcf", "--usd", "--trials", "0", "--out", tmp_path / "made")
    assert code == 0
    assert "MuJoCo model: error not measured" in out
    assert "error not measured" in (tmp_path / "made" / "robot.xml").read_text()
    assert ElementTree.parse(tmp_path / "made" / "robot.xml").getroot().get("model") == "starfish"
    assert (tmp_path / "made" / "robot.usda").read_text().startswith("#usda 1.0")


def test_export_needs_a_format_and_parts_that_it_can_write(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, _, told = run("export", starfish, "--out", tmp_path / "made")
    assert (code, told) == (2, "hydrostat: error: export needs --mjcf or --usd, or both\n")
    code, _, told = run("export", "gallery:spine", "--mjcf", "--out", tmp_path / "made")
    assert code == 2
    assert "not available in MJCF. Remove it." in told
    assert not (tmp_path / "made").exists()


def test_too_few_poses_to_fit_are_refused_before_any_is_measured(run: Run, starfish: Path, tmp_path: Path) -> None:
    for number in (1, 2):
        code, _, told = run("export", starfish, "--mjcf", "--fit-poses", number, "--out", tmp_path / "made")
        wanted = f"--fit-poses {number}: too few poses. Allowed: 0, or 3 to 1000. Write --fit-poses 20."
        assert (code, told) == (2, f"hydrostat: error: {wanted}\n")


def _replace_programs(
    monkeypatch: pytest.MonkeyPatch, fit: MjcfFit | InputError | None, shares: tuple[float | None, ...]
) -> None:
    """Replace both measurements, without and with a tuning, and the fit by given results."""

    def measure_mjcf(*_: Any, tuning: MjcfTuning | None = None, **__: Any) -> MjcfError:
        return MjcfError(share=shares[0 if tuning is None else 1], num_poses=5, error=1e-4, largest=2e-4, travel=1e-2)

    def fit_mjcf(*_: Any, **__: Any) -> MjcfFit:
        if isinstance(fit, MjcfFit):
            return fit
        raise fit or AssertionError("nothing may be fitted")

    for function in (measure_mjcf, fit_mjcf):
        monkeypatch.setattr(import_module("hydrostat.export"), function.__name__, function)


def _made_fit(after: float) -> MjcfFit:
    """Fit of the starfish that leaves an error where the unfitted model is off by 1 mm."""
    errors = [
        MjcfPoseErrors(rms=rms, median=rms, largest=rms, jacobian=0.05, jacobian_median=0.05, jacobian_largest=0.05)
        for rms in (1e-3, after)
    ]
    return MjcfFit(
        tuning=MjcfTuning(young=1.25, poisson=0.0, gains=np.ones(3)),
        share=0.25,
        num_poses=20,
        num_held_out=11,
        num_left_out=0,
        num_lost=1,
        before=errors[0],
        after=errors[1],
        travel=1e-2,
    )


@pytest.mark.parametrize(
    ("fit", "shares", "line", "is_fitted"),
    [
        (None, (None, None), "not fitted: no trial settled at 12.5 % of the travel", False),
        (InputError("9 of 32 poses"), (0.25, 0.25), "warning: not fitted: 9 of 32 poses", False),
        (_made_fit(0.99e-3), (0.25, 0.25), "unfitted numbers kept: the error falls by less than 5 %", False),
        (_made_fit(0.5e-3), (0.25, None), "warning: unfitted numbers kept: the fitted model did not settle", False),
        (_made_fit(0.5e-3), (0.25, 0.25), "settled, fitted: markers off by 0.1 mm rms", True),
        (_made_fit(0.5e-3), (0.25, 0.25), "warning: the fitted numbers also compensate for what is left out", True),
    ],
)
def test_each_end_of_a_fit_writes_a_model_and_says_which(
    run: Run,
    starfish: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    fit: MjcfFit | InputError | None,
    shares: tuple[float | None, ...],
    line: str,
    is_fitted: bool,
) -> None:
    pytest.importorskip("mujoco")
    _replace_programs(monkeypatch, fit, shares)
    monkeypatch.setattr(import_module("hydrostat.export"), "find_omissions", lambda _: ("loads",))
    code, out, _ = run("export", starfish, "--mjcf", "--fit-poses", "20", "--out", tmp_path / "made")
    written = (tmp_path / "made" / "robot.xml").read_text()
    assert code == 0
    assert f"MuJoCo model: {line}" in out
    assert line in written
    assert ("Young's modulus x 1.250" in written) == is_fitted
