"""Samples of a robot. Oracles: the simulator called directly, other ways of working, and the bytes on disk."""

import errno
import json
import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

import hydrostat as hs
from hydrostat.cli.main import app
from hydrostat.errors import HydrostatError, InputError
from hydrostat.files import temporary_path
from hydrostat.learning import SamplePlan, Samples, SamplingScheme, export_samples, sample_robot, sample_shard
from hydrostat.learning.sample_plan import shared_numbers
from hydrostat.learning.sample_shard import REASONS
from hydrostat.learning.samples import SampleFolder
from hydrostat.robot import Load, LoadDrive, Sensor, SensorKind

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.fixture(scope="module")
def plan() -> SamplePlan:
    return SamplePlan.of_robot(strip_robot(columns=8, rows=2), 22, shard=5, draws=tuple(SamplingScheme)[:3], seed=3)


@pytest.fixture(scope="module")
def once(plan: SamplePlan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sample_robot(plan, tmp_path_factory.mktemp("samples")).path


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}


def test_samples_hold_readings_with_noise(tmp_path: Path) -> None:
    """Oracle: the reader; the same noise when samples are made again."""
    path = ((0.02, 0.0), (0.18, 0.0))
    robot = replace(strip_robot(columns=8, rows=2), sensors=(Sensor(name="flex", kind=SensorKind.BEND, points=path),))
    clean = Samples.read(sample_robot(SamplePlan.of_robot(robot, 5), tmp_path / "clean").path)
    simulation = hs.Simulation(robot)
    reading = hs.SensorReader(simulation).read_vector(simulation.solve(clean.contractions[3]))
    assert clean.sensors is not None
    assert np.array_equal(clean.sensors[3], reading)
    assert clean.facts["sensors"] == ["flex"]
    noisy = replace(robot, sensors=(replace(robot.sensors[0], noise=0.1),))
    again = [Samples.read(sample_robot(SamplePlan.of_robot(noisy, 5), tmp_path / name).path) for name in "ab"]
    assert np.array_equal(again[0].sensors, again[1].sensors)  # type: ignore[arg-type]
    assert 0.01 < np.abs(again[0].sensors - clean.sensors).mean() < 0.3  # type: ignore[operator]
    with pytest.raises(InputError, match="another plan"):
        sample_robot(SamplePlan.of_robot(noisy, 5), tmp_path / "clean")


def test_samples_move_drives_too(tmp_path: Path) -> None:
    """Oracle: the simulator, and differences of its tensions."""
    push = Load(name="push", marker="tip", force=(0.01, -0.02), drive="thumb")
    drives = (LoadDrive(name="thumb", min=-1.0, max=2.0),)
    robot = replace(strip_robot(columns=8, rows=2), loads=(push,), drives=drives)
    samples = Samples.read(sample_robot(SamplePlan.of_robot(robot, 12), tmp_path).path)
    assert samples.facts["drives"] == {"thumb": "share"}
    low, high = samples.limits
    assert (low[-1], high[-1]) == (-1.0, 2.0)
    shares = samples.columns()["drive_thumb_share"]
    assert shares.min() < -0.5
    assert shares.max() > 1.5
    simulation, row = hs.Simulation(robot), int(np.argmax(samples.tensions.sum(axis=1)))
    step = np.r_[np.zeros(len(robot.winches)), 1e-4]
    poses = [simulation.solve(samples.contractions[row] + sign * step) for sign in (0, 1, -1)]
    np.testing.assert_allclose(samples.markers[row], list(poses[0].markers.values()), atol=1e-12)
    slopes = (poses[1].tensions - poses[2].tensions) / 2e-4
    assert samples.tension_jacobians is not None
    np.testing.assert_allclose(samples.tension_jacobians[row][:, -1], slopes, rtol=1e-4, atol=1e-7)
    with pytest.raises(InputError, match='"thumb", are not available in strategy antagonist'):
        SamplePlan(robot=robot, count=2, draws=(SamplingScheme.ANTAGONIST,))


def test_a_sample_is_what_the_simulator_finds(plan: SamplePlan, once: Path) -> None:
    samples, simulation = Samples.read(once), hs.Simulation(plan.robot)
    assert len(samples) == 22
    assert samples.lost == 0
    for place in (0, 7, 21):
        pose = simulation.solve(samples.contractions[place])
        assert np.array_equal(np.array(list(pose.markers.values())), samples.markers[place])
        assert np.array_equal(pose.tensions, samples.tensions[place])
        slopes = np.einsum(
            "pc,pcdw->pdw",
            simulation.marker_anchors.weights,
            simulation.jacobian(pose)[simulation.marker_anchors.stencils],
        )
        assert np.array_equal(slopes, samples.jacobians[place])


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_slopes_of_tensions(friction: float, tmp_path: Path) -> None:
    """Oracle: differences of poses, central ones by winch; with friction further on the way from rest."""
    robot = strip_robot(columns=8, rows=2)
    robot = replace(robot, cables=tuple(replace(cable, friction=friction) for cable in robot.cables))
    samples, simulation = Samples.read(sample_robot(SamplePlan.of_robot(robot, 3), tmp_path).path), hs.Simulation(robot)
    assert samples.tension_jacobians is not None
    size = 1e-6 if friction else 1e-7  # of the difference [m]
    for contractions, slopes in zip(samples.contractions, samples.tension_jacobians, strict=True):
        start = simulation.solve(contractions)
        for way in [contractions] if friction else np.eye(2):
            step = size * way / np.linalg.norm(way)
            above = simulation.solve(contractions + step, start=start).tensions
            below = start.tensions if friction else simulation.solve(contractions - step, start=start).tensions
            found = (above - below) / (size if friction else 2 * size)
            assert slopes @ step / size == pytest.approx(found, rel=1e-3, abs=1e-3 * np.abs(slopes).max())


def test_samples_of_an_earlier_version_are_read_but_not_gone_on_with(plan: SamplePlan, tmp_path: Path) -> None:
    """Those were without slopes of tensions."""
    old = sample_robot(replace(plan, count=5), tmp_path).path
    rows, manifest = np.load(old / "samples-000000.npy"), json.loads((old / "samples.json").read_text())
    kept = [column for column in rows.dtype.descr if column[0] != "tension_slopes"]
    without = np.zeros(len(rows), np.dtype(kept))
    for name in without.dtype.names or ():
        without[name] = rows[name]
    np.save(old / "samples-000000.npy", without)
    (old / "samples.json").write_text(json.dumps({k: v for k, v in manifest.items() if k != "tension_slopes"}))
    samples = Samples.read(old)
    assert samples.tension_jacobians is None
    assert len(samples.first(3)) == 3
    with pytest.raises(InputError, match="another plan: tension_slopes is None, asked for True"):
        sample_robot(replace(plan, count=5), old)


def test_samples_that_do_not_tell_their_friction_had_none(tmp_path: Path) -> None:
    """As an earlier version wrote them, which told no friction."""
    robot = replace(strip_robot(columns=8, rows=2), contact=hs.Contact())
    folder = sample_robot(SamplePlan.of_robot(robot, 2, shard=2), tmp_path).path
    manifest = json.loads((folder / "samples.json").read_text())
    del manifest["contact_friction"]
    (folder / "samples.json").write_text(json.dumps(manifest))
    assert len(Samples.read(sample_robot(SamplePlan.of_robot(robot, 3, shard=2), folder).path)) == 3


def test_bytes_do_not_depend_on_who_works(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    for part in range(3):
        sample_robot(plan, tmp_path / "parts", part=(2 - part, 3))
    sample_robot(plan, tmp_path / "processes", jobs=2)
    assert contents(tmp_path / "parts") == contents(once) == contents(tmp_path / "processes")


def test_a_number_decides_about_a_sample_however_many_there_are(plan: SamplePlan) -> None:
    whole = plan.contractions(range(22))
    more = replace(plan, count=1000, shard=64)
    assert np.array_equal(more.contractions(range(9, 22)), whole[9:])


def test_draws_keep_to_what_they_say() -> None:
    robot = gallery_robot("cupping_hand")
    plan = SamplePlan.of_robot(robot, 96, draws=[SamplingScheme.ANTAGONIST, SamplingScheme.FACES, SamplingScheme.BOX])
    assert sorted(plan.pairs) == [(2 * finger, 2 * finger + 1) for finger in range(5)]  # flexor and extensor
    rows, travel = plan.contractions(range(96)), np.array([winch.travel for winch in robot.winches])
    assert (rows >= 0).all()
    assert (rows <= travel).all()
    against, faces, box = rows[0::3], rows[1::3], rows[2::3]
    assert (np.minimum(against[:, 0::2], against[:, 1::2]) == 0).all()
    assert 0.4 < (faces == 0).mean() < 0.6
    assert (box > 0).all()
    assert np.abs((box / travel).mean(axis=0) - 0.5).max() < 0.02


def test_numbers_that_two_winches_share_are_found_again() -> None:
    """Oracle: the points that contractions were made of; a winch without partner has a number of its own."""
    points, high = np.random.default_rng(0).random((50, 2)), np.array([0.03, 0.05, 0.04])
    pairs = ((0, 2), (1,))
    rows = SamplingScheme.ANTAGONIST.contractions(points, np.zeros(3), high, pairs)
    assert shared_numbers(rows, high, pairs) == pytest.approx(points, abs=1e-12)


def test_samples_drawn_by_tension_pull_no_harder(tmp_path: Path) -> None:
    plan = SamplePlan.of_robot(strip_robot(columns=8, rows=2), 8, draws=[SamplingScheme.TENSION], tension=0.5)
    free = hs.Simulation(plan.robot).solve_batch(plan.contractions(range(8)), jacobians=False)
    assert free.tensions.max() > 0.6
    samples = Samples.read(sample_robot(plan, tmp_path).path)
    assert samples.tensions.max() <= 0.5
    assert samples.tensions.max(axis=1).min() > 0.0


def test_a_pose_that_is_not_found_is_a_row_with_its_reason(plan: SamplePlan, monkeypatch: pytest.MonkeyPatch) -> None:
    hurried = hs.Simulation(plan.robot, options=hs.NewtonOptions(iterations=1))
    monkeypatch.setattr(sys.modules["hydrostat.learning.sample_shard"], "_simulation", lambda plan: hurried)
    rows = sample_shard(plan, 0)
    lost = rows["reason"] != REASONS.index("converged")
    assert lost.any()
    assert {REASONS[reason] for reason in rows["reason"][lost]} <= {
        "iteration limit reached",
        "no step lowers the energy",
    }
    assert np.isnan(rows["jacobian"][lost]).all()
    assert np.isnan(rows["markers"][lost]).all()
    assert np.array_equal(rows["contractions"], plan.contractions(plan.numbers(0)))


def test_contact_is_told(tmp_path: Path) -> None:
    hand = gallery_robot("starfish")
    draws = [SamplingScheme.BOX]
    apart = Samples.read(sample_robot(SamplePlan.of_robot(hand, 24, contact=True, draws=draws), tmp_path / "a").path)
    through = Samples.read(sample_robot(SamplePlan.of_robot(hand, 24, draws=draws), tmp_path / "b").path)
    assert apart.touches.any()
    assert not apart.crosses.any()
    assert through.crosses.any()
    assert not through.touches.any()
    assert (apart.touches >= through.crosses).all()


def test_going_on_makes_only_what_is_missing(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    sample_robot(plan, tmp_path)
    kept = (tmp_path / "samples-000001.npy").stat().st_mtime_ns
    (tmp_path / "samples-000003.npy").unlink()
    left = temporary_path(tmp_path / "samples-000003.npy")  # of a run that was killed
    left.with_name(left.name.replace(f"-{os.getpid()}-", "-999999999-")).write_bytes(b"half")
    sample_robot(plan, tmp_path)
    assert contents(tmp_path) == contents(once)
    assert (tmp_path / "samples-000001.npy").stat().st_mtime_ns == kept


def test_a_killed_run_leaves_whole_files_and_goes_on(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    program = (
        "import os, signal, sys, pickle\n"
        "from pathlib import Path\n"
        "from hydrostat.learning import sample_robot\n"
        "plan = pickle.load(open(sys.argv[1], 'rb'))\n"
        "kill = lambda stage, done, total: os.kill(os.getpid(), signal.SIGKILL) if done >= 10 else None\n"
        "sample_robot(plan, Path(sys.argv[2]), progress=kill)\n"
    )
    (tmp_path / "plan").write_bytes(pickle.dumps(plan))
    out = tmp_path / "out"
    ended = subprocess.run([sys.executable, "-c", program, tmp_path / "plan", out], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert len(list(out.glob("samples-*.npy"))) == 2
    sample_robot(plan, out)
    assert contents(out) == contents(once)


@pytest.mark.slow  # processes begin
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="children are found in /proc")
def test_a_killed_run_leaves_no_workers_behind(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    program = (
        "import glob, os, signal, sys, pickle\n"
        "from pathlib import Path\n"
        "from hydrostat.learning import sample_robot\n"
        "def kill(stage, done, total):\n"
        "    for file in glob.glob('/proc/self/task/*/children'):\n"
        "        print(open(file).read(), end=' ')\n"
        "    sys.stdout.flush()\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
        "plan = pickle.load(open(sys.argv[1], 'rb'))\n"
        "sample_robot(plan, Path(sys.argv[2]), jobs=2, progress=kill)\n"
    )
    (tmp_path / "plan").write_bytes(pickle.dumps(plan))
    with (tmp_path / "told").open("wb") as told:
        command = [sys.executable, "-c", program, tmp_path / "plan", tmp_path / "out"]
        assert subprocess.run(command, check=False, stdout=told).returncode == -signal.SIGKILL
    workers = [Path("/proc") / number / "stat" for number in (tmp_path / "told").read_text().split()]
    assert len(workers) >= 2
    end = time.monotonic() + 60
    while any(map(_works, workers)):
        assert time.monotonic() < end
        time.sleep(0.2)
    sample_robot(plan, tmp_path / "out")
    assert contents(tmp_path / "out") == contents(once)


def _works(stat: Path) -> bool:
    """Whether a process is there, and no corpse that nobody has buried."""
    try:
        return stat.read_text().rpartition(")")[2].split()[0] not in "ZX"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_folder_grows_to_a_larger_count_and_to_no_smaller_one(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    """The oracle is a run that was asked for all at once; a kill before the short last file is made again is tried."""
    sample_robot(replace(plan, count=12), tmp_path)
    first = (tmp_path / "samples-000000.npy").stat().st_mtime_ns
    SampleFolder.begin(tmp_path, plan)  # a run that was killed just then
    assert len(Samples.read(tmp_path)) == 12
    sample_robot(plan, tmp_path, part=(1, 2))  # a job of an array, whose files the short one is not among
    assert len(Samples.read(tmp_path)) == 12 + 5
    sample_robot(plan, tmp_path)
    assert contents(tmp_path) == contents(once)
    assert (tmp_path / "samples-000000.npy").stat().st_mtime_ns == first
    told = r"is for 22 samples already, more than the 12 .* hydrostat learn --max-samples 12$"
    with pytest.raises(InputError, match=told):
        sample_robot(replace(plan, count=12), tmp_path)
    with pytest.raises(InputError, match="another plan: seed is 3, asked for 4"):
        sample_robot(replace(plan, count=40, seed=4), tmp_path)
    assert contents(tmp_path) == contents(once)


def test_workers_that_die_are_made_good(
    plan: SamplePlan, once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def dies(plan: SamplePlan, shards: list[int], jobs: int) -> Iterator[tuple[int, np.ndarray]]:
        yield shards[0], sample_shard(plan, shards[0])
        raise BrokenPipeError

    monkeypatch.setitem(sys.modules["hydrostat.learning.sample_robot"]._BY, "loky", dies)
    sample_robot(plan, tmp_path / "some", jobs=2)
    assert contents(tmp_path / "some") == contents(once)

    def dead(plan: SamplePlan, shards: list[int], jobs: int) -> Iterator[tuple[int, np.ndarray]]:
        raise BrokenPipeError
        yield

    monkeypatch.setitem(sys.modules["hydrostat.learning.sample_robot"]._BY, "loky", dead)
    with pytest.raises(HydrostatError, match="workers died"):
        sample_robot(plan, tmp_path / "none", jobs=2)


def test_a_full_disk_is_one_line_and_nothing_half_written(
    plan: SamplePlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sync, calls = os.fsync, []

    def full(file: int) -> None:
        calls.append(file)
        if len(calls) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(file)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match=r"samples-000001.npy: cannot be written \(No space left on device\)"):
        sample_robot(plan, tmp_path)
    assert sorted(contents(tmp_path)) == ["samples-000000.npy", "samples.json"]


def test_a_folder_of_something_else_is_refused(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="another plan: seed is 3, asked for 4"):
        sample_robot(replace(plan, seed=4), once)
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(InputError, match=r"holds other files, such as letter.txt"):
        sample_robot(plan, tmp_path)
    with pytest.raises(InputError, match=r"samples.json: there is no such file"):
        Samples.read(tmp_path)


def test_damaged_files_are_told(plan: SamplePlan, tmp_path: Path) -> None:
    sample_robot(plan, tmp_path)
    file = tmp_path / "samples-000002.npy"
    file.write_bytes(file.read_bytes()[:-9])
    with pytest.raises(InputError, match=r"samples-000002.npy: is damaged"):
        Samples.read(tmp_path)
    file.write_bytes(file.read_bytes()[:10] + b"{'descr': [(" + file.read_bytes()[22:])
    with pytest.raises(InputError, match=r"samples-000002.npy: is damaged"):  # a header that is no Python any more
        Samples.read(tmp_path)
    (tmp_path / "samples.json").write_text("{")
    with pytest.raises(InputError, match=r"samples.json: is no JSON"):
        Samples.read(tmp_path)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"count": 0}, "count must be 1 or more"),
        ({"shard": 0}, "shard must be 1 or more"),
        ({"seed": -1}, "seed must be 0 or more"),
        ({"draws": ()}, "no sampling strategy"),
        ({"draws": (SamplingScheme.TENSION,)}, "needs a maximum cable tension"),
    ],
)
def test_a_wrong_plan_is_one_line(plan: SamplePlan, wrong: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        replace(plan, **wrong)


def test_what_cannot_be_exported_is_told_before_sampling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: no folder of samples is begun."""
    (tmp_path / "there.zarr").mkdir()
    monkeypatch.setattr("hydrostat.learning.export.find_spec", lambda name: None)
    for name, words in (
        ("a.csv", "must end in"),
        ("there.zarr", "is there already"),
        ("a.parquet", "package pyarrow"),
    ):
        command = ["sample", "gallery:starfish", "--count", "1", "--out", str(tmp_path / "out")]
        with pytest.raises(InputError, match=words):
            app([*command, "--export", str(tmp_path / name)], standalone_mode=False)
    assert not (tmp_path / "out").exists()


def test_exports_hold_the_same_numbers(plan: SamplePlan, once: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must end in .parquet or .zarr"):
        export_samples(once, tmp_path / "all.csv")
    samples = Samples.read(once)
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(export_samples(once, tmp_path / "all.parquet"))
    winch, marker = plan.robot.winches[1].name, plan.robot.markers[0].name
    assert np.array_equal(table[f"contractions.{winch}"].to_numpy(), samples.contractions[:, 1])
    assert np.array_equal(table[f"jacobian.{marker}.y.{winch}"].to_numpy(), samples.jacobians[:, 0, 1, 1])
    cable = plan.robot.cables[0].name
    assert samples.tension_jacobians is not None
    assert np.array_equal(table[f"tension_slopes.{cable}.{winch}"].to_numpy(), samples.tension_jacobians[:, 0, 1])
    assert json.loads(table.schema.metadata[b"hydrostat"])["count"] == 22
    zarr = pytest.importorskip("zarr")
    group = zarr.open_group(export_samples(once, tmp_path / "all.zarr"), mode="r")
    assert np.array_equal(group["jacobian"][:], samples.jacobians)
    with pytest.raises(InputError, match="is there already"):
        export_samples(once, tmp_path / "all.zarr")


@pytest.mark.slow
def test_a_ray_cluster_that_loses_a_worker_gives_the_same_bytes(once: Path, plan: SamplePlan, tmp_path: Path) -> None:
    pytest.importorskip("ray")
    program = Path(__file__).with_name("ray_cluster.py")
    (tmp_path / "plan").write_bytes(pickle.dumps(plan))
    subprocess.run([sys.executable, program, tmp_path / "plan", tmp_path / "out"], check=True, timeout=300)
    assert contents(tmp_path / "out") == contents(once)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="the script is for bash")
def test_an_array_of_jobs_gives_the_same_bytes(tmp_path: Path) -> None:
    """The script for Slurm, one job after another, the first one twice, as if lost. Oracle: one process."""
    examples, program = Path(__file__).parents[2] / "examples", tmp_path / "bin" / "hydrostat"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m hydrostat "$@"\n')
    program.chmod(0o755)
    paths = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
    for part in ("1", "2", "1"):
        variables = {"PATH": paths, "SLURM_ARRAY_TASK_ID": part, "SLURM_ARRAY_TASK_COUNT": "2"}
        command = ["bash", examples / "sample_array.sh", examples / "letter_s", "100", tmp_path / "array"]
        subprocess.run(command, env=os.environ | variables, check=True, capture_output=True)
    alone = sample_robot(SamplePlan.of_robot(hs.load_robot(examples / "letter_s"), 100), tmp_path / "alone", jobs=1)
    assert contents(tmp_path / "array") == contents(alone.path)
