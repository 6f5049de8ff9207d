"""`sample_robot`: poses of a robot for learning, by one process, many, or many machines."""

import os
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from typing import Any, cast

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.given import check_type, path_of
from hydrostat.learning.sample_plan import SamplePlan
from hydrostat.learning.sample_shard import sample_shard
from hydrostat.learning.samples import SampleFolder
from hydrostat.progress import Progress
from hydrostat.version import install_command

Sampled = tuple[int, np.ndarray]


def sample_robot(
    plan: SamplePlan,
    folder: str | Path,
    *,
    part: tuple[int, int] = (0, 1),
    jobs: int = 1,
    backend: str = "loky",
    progress: Progress | None = None,
) -> SampleFolder:
    """Sample a robot into a folder, or continue an earlier run, which may have had a smaller count.

    The bytes depend on the plan alone, not on the number of processes or their order, on machines of one kind. If a
    worker dies, the others take over its samples.

    Args:
        plan: plan of the samples.
        folder: folder for the samples (created if missing).
        part: (i, n) to compute only part i of n of the files, counted from 0.
        jobs: number of processes; -1 for one on each core.
        backend: one of `BACKENDS`.
        progress: callback for progress.

    Raises:
        InputError: a folder of another plan or of more samples, or one that cannot be written; a wrong part or backend.
        HydrostatError: the workers died without progress.
    """
    check_type(plan, SamplePlan, "samples follow a SamplePlan, such as SamplePlan(robot=robot, count=100)")
    folder = path_of(folder, "samples are written into a folder, given by its path")
    index, parts = part
    if not 0 <= index < parts:
        raise InputError(f"part must be i of n, with i from 0 to n - 1, not {index} of {parts}")
    if jobs == 0:
        raise InputError("jobs must be 1 or more, or -1 for one on each core")
    if backend not in _BY:
        raise InputError(f'unknown backend "{backend}". Available: {", ".join(_BY)}.')
    samples = SampleFolder.begin(folder, plan)
    mine = sum(len(plan.numbers(shard)) for shard in range(index, plan.shards, parts))
    run = _in_turn if jobs == 1 and backend == "loky" else _BY[backend]
    missing = samples.missing(part)
    while missing:
        trouble: Exception | None = None
        done = mine - sum(len(plan.numbers(shard)) for shard in missing)
        try:
            for shard, rows in run(plan, missing, jobs):
                samples.write(shard, rows)
                done += len(rows)
                if progress is not None:
                    progress("samples", done, mine)
        except HydrostatError:
            raise
        except Exception as error:
            if run is _in_turn:
                raise
            trouble = error  # a worker that was killed; each back end has errors of its own
        left = samples.missing(part)
        if trouble is not None and len(left) == len(missing):
            raise HydrostatError(f"the workers died: {type(trouble).__name__}: {trouble}") from trouble
        missing = left
    return samples


def _in_turn(plan: SamplePlan, shards: list[int], jobs: int) -> Iterator[Sampled]:
    """Shards one after another, in this process."""
    del jobs
    for shard in shards:
        yield shard, sample_shard(plan, shard)


def _by_joblib(plan: SamplePlan, shards: list[int], jobs: int) -> Iterator[Sampled]:
    """Shards as they are finished by processes of this machine."""
    from joblib import Parallel, delayed, parallel_config

    with parallel_config(backend="loky", n_jobs=jobs, inner_max_num_threads=1):
        options: dict[str, Any] = {"batch_size": 1, "initializer": end_with, "initargs": (os.getpid(),)}
        work = Parallel(return_as="generator_unordered", **options)
        yield from cast(Iterator[Sampled], work(delayed(_sample_numbered)(plan, shard) for shard in shards))


def _by_ray(plan: SamplePlan, shards: list[int], jobs: int) -> Iterator[Sampled]:
    """Shards as they are finished by a Ray cluster: the one that RAY_ADDRESS names, else one of this machine.

    Ray's back end for joblib gives nothing before all is done; so these are tasks of Ray itself, which it gives to
    another worker where one dies.
    """
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError(f"package ray not found. Install it: {install_command('cluster')}") from None
    if not ray.is_initialized():
        here = "RAY_ADDRESS" not in os.environ
        ray.init(num_cpus=(os.cpu_count() if jobs < 0 else jobs) if here else None, log_to_driver=False)
    retries = 5  # So often Ray gives a file to another worker
    work = ray.remote(num_cpus=1, max_retries=retries)(_sample_numbered)
    shared, waiting, running = ray.put(plan), list(reversed(shards)), []
    ahead = 2  # Files for each worker that Ray knows of at a time
    most = ahead * max(1, int(ray.cluster_resources().get("CPU", 1)))
    try:
        while waiting or running:
            while waiting and len(running) < most:
                running.append(work.remote(shared, waiting.pop()))
            done, running = ray.wait(running, num_returns=1)
            yield from ray.get(done)
    finally:
        for task in running:
            ray.cancel(task, force=True)


def _sample_numbered(plan: SamplePlan, shard: int) -> Sampled:
    return shard, sample_shard(plan, shard)


def end_with(parent: int) -> None:
    """End this process soon after its parent was killed: workers of joblib would wait for more work for ever."""
    if os.name == "posix":  # elsewhere the number of a parent stays when it has gone
        Thread(target=_watch, args=(parent,), name="end with the parent", daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


_BY = {"loky": _by_joblib, "ray": _by_ray}

BACKENDS = tuple(_BY)
"""Ways to work in many processes: of this machine, or of a Ray cluster."""
