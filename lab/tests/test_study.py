"""Studies of ways to learn, and the command that writes the thesis's tables. Oracles: samples, rows made by hand."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.learning import LearnOptions, Samples
from hydrostat.robot import Robot
from hydrostat_lab import reproduce
from hydrostat_lab.compare import Compared, compare
from hydrostat_lab.others import kernel_ridge
from hydrostat_lab.study import Study, read_rows_of, run_study

pytestmark = pytest.mark.usefixtures("unchecked")

PLAIN = ("constant", "1-NN", "kernel ridge", "kernel ridge, step")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return strip_robot(columns=8, rows=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


def study(**given: object) -> Study:
    return replace(Study(counts=(20, 40), targets=5, methods=PLAIN), **given)  # type: ignore[arg-type]


def test_rows_are_those_of_the_comparison_and_are_kept(robot: Robot, folder: Path) -> None:
    """Oracle: `compare` called directly, on the samples that the study left."""
    rows = list(run_study(study(), robot, folder))
    assert [(row.samples, row.method) for row in rows] == [(count, name) for count in (20, 40) for name in PLAIN]
    train, test = (Samples.read(folder / f"{robot.name}-box-{name}") for name in ("train-40", "test-5"))
    assert not np.isin(test.contractions, train.contractions).any()
    for row, found in zip(rows[4:], compare(hs.Simulation(robot), train, test, PLAIN), strict=True):
        assert row.errors["mean"] == pytest.approx(found.distances.mean(), rel=1e-6)
        assert row.errors["max"] == pytest.approx(found.distances.max(), rel=1e-6)
        assert row.markers["tip"] == pytest.approx(found.distances[:, 0].mean(), rel=1e-6)
        assert row.lost == 0
    assert rows[4].sampling == pytest.approx(2 * rows[0].sampling)
    assert rows[-1].errors["mean"] < rows[-2].errors["mean"] < rows[4].errors["mean"]
    file = folder / "rows.jsonl"
    whole = file.read_bytes()
    assert list(run_study(study(), robot, folder)) == rows
    assert file.read_bytes() == whole
    more = list(run_study(study(seeds=3), robot, folder))
    assert more == rows  # nothing here begins at random
    file.write_bytes(whole[:-20])
    assert read_rows_of(file) == rows[:-1]
    assert file.read_bytes().endswith(b"\n")
    file.write_text("{}\n")
    with pytest.raises(InputError, match="is damaged; delete it"):
        read_rows_of(file)


def test_kernel_ridge_goes_through_what_is_smooth(robot: Robot, tmp_path: Path) -> None:
    """Oracle: contractions that are a smooth function of markers, at places that were not seen."""
    list(run_study(study(counts=(2,), targets=2, methods=("constant",)), robot, tmp_path))
    some = Samples.read(tmp_path / f"{robot.name}-box-train-2")
    draw = np.random.default_rng(0)
    places, new = draw.uniform(-1, 1, (200, 1, 2)), draw.uniform(-0.8, 0.8, (50, 1, 2))
    high = np.array(some.facts["travel"])
    made = [high * (0.5 + 0.2 * np.sin(2 * at[:, 0]) + 0.2 * at[:, 0, ::-1] ** 2) for at in (places, new)]
    train = replace(some, contractions=made[0], markers=places)
    missed = np.abs(kernel_ridge(train, new.reshape(50, 2)) - made[1]).max() / high.max()
    assert missed < 1e-3


@pytest.mark.parametrize("given", [{"counts": ()}, {"counts": (0,)}, {"seeds": 0}, {"targets": 0}, {"methods": ("?",)}])
def test_a_study_is_checked(given: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"must be 1 or more|unknown method"):
        study(**given)


def test_the_tables_and_figures_of_the_thesis(
    robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Oracle: errors made by hand; centimeters and millimeters, means over the targets that have an equilibrium."""

    def found(*given: object, options: LearnOptions) -> list[Compared]:
        distances, rows = np.array([[0.01], [0.02], [np.nan]]) + 2e-3 * options.seed, np.zeros((3, 2))
        curve = np.array([[0.2, 0.3], [0.1, 0.2]])
        ways = {"thesis": curve, "search": None}
        return [
            Compared(method=name, samples=30, distances=distances, seconds=1.0, contractions=rows, curve=ways[name])
            for name in ways
            if name in given[-1]  # type: ignore[operator]
        ]

    monkeypatch.setattr(reproduce, "_robot", lambda name: replace(robot, name="cupping_hand"))
    monkeypatch.setattr("hydrostat_lab.study.compare", found)
    monkeypatch.setattr("hydrostat_lab.catalog.require_extras", lambda names: None)
    reproduce.reproduce(list(reproduce.THINGS), tmp_path, counts="30", targets=3, jobs=1)
    assert "search                  15.000" in capsys.readouterr().out
    table = list(csv.reader((tmp_path / "table-5.1.csv").read_text().splitlines()))
    assert table[1][5:] == ["0.4559", "0.5780", "0.5498", "0.8395", "0.6245", "0.6095", ""]
    assert table[-1] == ["cupping_hand", "box", "30", "0", "search", "1.5000", "1.5000", "1"]
    table = list(csv.reader((tmp_path / "table-5.2.csv").read_text().splitlines()))
    last = dict(zip(table[0], table[-1], strict=True))
    assert (last["mean [mm]"], last["deviation [mm]"], last["max [mm]"]) == ("15.0000", "5.0000", "20.0000")
    for number in ("5.3", "5.4", "5.14"):
        assert (tmp_path / f"figure-{number}.png").stat().st_size > 10_000
    capsys.readouterr()
    reproduce.reproduce(["table-5.2"], tmp_path, counts="30", targets=3, seeds=2, jobs=1)
    last = capsys.readouterr().out.splitlines()[-3]
    assert last.split()[:6] == ["cupping_hand,", "box,", "30", "samples", "search", "16.000"]
    assert last.split()[7:] == ["15.000", "17.000", "2"]
    with pytest.raises(InputError, match='unknown table or figure "table-9"'):
        reproduce.reproduce(["table-9"], tmp_path)
    with pytest.raises(InputError, match="--counts 1,x"):
        reproduce.reproduce(["all"], tmp_path, counts="1,x")
    with pytest.raises(InputError, match=r"--counts 10,100: too few samples\. The minimum is 20"):
        reproduce.reproduce(["all"], tmp_path, counts="10,100")
    with pytest.raises(InputError, match="--sampling tension: only for hydrostat sample"):
        reproduce.reproduce(["all"], tmp_path, sampling="box,tension")


def test_options_of_a_size() -> None:
    chosen, robots = reproduce._study(reproduce.Size.FULL, "box,antagonist", "trunk", "70", None, None)
    assert (robots, chosen.counts, chosen.targets, chosen.seeds) == (["trunk"], (70,), 5000, 5)
    assert chosen.options == LearnOptions()
