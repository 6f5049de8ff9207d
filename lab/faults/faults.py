"""Spoiled files and killed commands: is each answered in one line, and is no file left half?

    python lab/faults/faults.py mutations [--count 2000] [--seed 45] [--only KIND] [--out build/faults]
    python lab/faults/faults.py kills [--count 200] [--seed 45] [--only COMMAND] [--out build/faults]

A case follows from the seed and its number alone. Results are added to OUT/mutations_SEED.jsonl and
OUT/kills_SEED.jsonl as they come. The same command goes on with the numbers that are missing. Files of wrong cases are
kept in OUT/wrong. The exit code is 1 if a case is wrong: a traceback, an exit code that is none of ours, a refusal of
several lines, a file that is not whole, a folder of a refused file, or more than a minute of CPU for one file.
"""

import argparse
import gc
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from bases import KINDS, base_files, give
from whole import find_half_files, find_unfinished

SECONDS = 60
"""CPU time that one spoiled file may take [s]."""


@dataclass(kw_only=True)
class Ending:
    """How a case ended."""

    number: int
    kind: str
    code: int
    seconds: float
    line: str = ""
    wrong: list[str] = field(default_factory=list)


def run_forked(work: Callable[[], object], folder: Path, *, group: bool = False) -> int:
    """Begin some work in a copy of this process, in a folder; returns its number. Words go to out.txt and err.txt."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    code = 1
    try:
        if group:
            os.setsid()
        for name, number in (("out.txt", 1), ("err.txt", 2)):
            os.dup2(os.open(folder / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_CPU, (2 * SECONDS, 2 * SECONDS + 5))
        try:
            work()
            code = 0
        except SystemExit as stop:
            code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
        sys.stdout.flush()
    except BaseException:  # noqa: BLE001  # what Python would print
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def command(*arguments: str) -> Callable[[], None]:
    """Work of a command line."""

    def work() -> None:
        from hydrostat.cli.main import main

        sys.argv = ["hydrostat", *arguments]
        main()

    return work


def _words(folder: Path, name: str) -> str:
    return (folder / name).read_text(errors="replace") if (folder / name).exists() else ""


def judge_words(ending: Ending, folder: Path) -> None:
    """Note what is wrong with a code and what was printed as an error."""
    told = _words(folder, "err.txt")
    errors = [line for line in told.splitlines() if line.startswith("hydrostat: ")]
    ending.line = (errors or [""])[-1][:300]
    if "Traceback" in told or "Traceback" in _words(folder, "out.txt"):
        ending.wrong.append("traceback: " + told.strip().splitlines()[-1][:200])
    if ending.code not in (0, 1, 2):
        ending.wrong.append(f"exit code {ending.code}")
    if ending.code == 2 and len(errors) != 1:
        ending.wrong.append(f"{len(errors)} error lines: {told[-200:]!r}")
    if len(ending.line) >= 300:
        ending.wrong.append("an error line of 300 letters or more")


def mutate(number: int, seed: int, only: str | None, folder: Path) -> Ending:
    """Spoil one file and give it to the command that reads it."""
    draw = np.random.default_rng([seed, number])
    kinds = [kind for kind in KINDS if only in (None, kind)]
    kind = kinds[number % len(kinds)]
    bases = base_files()[kind]
    name, content = bases[int(draw.integers(len(bases)))]
    spoiled = KINDS[kind](content, draw)
    work = give(kind, name, spoiled, folder)
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    _, status = os.waitpid(run_forked(work, folder), 0)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
    ending = Ending(number=number, kind=f"{kind}: {name}", code=os.waitstatus_to_exitcode(status), seconds=seconds)
    judge_words(ending, folder)
    if seconds > SECONDS:
        ending.wrong.append(f"{seconds:.0f} s of CPU")
    if (folder / "made").exists():
        ending.wrong += find_half_files(folder / "made", endings=(".toml", ".json", ".png"))  # not the file itself
        if ending.code == 2 and any((folder / "made").iterdir()):
            ending.wrong.append("a folder of a refused file")
    return ending


WORK = {
    "design": ["design", "ROBOT", "--pose", "wave", "--winches", "1", "--cables", "2", "--out", "made"],
    "simulate": ["simulate", "ROBOT", "--contract", "left=12mm", "--jacobian", "--out", "made"],
    "move": ["simulate", "ROBOT", "--contract", "left=12mm", "--dynamic", "--duration", "0.3s", "--out", "made"],
    "pose": ["pose", "ROBOT", "--out", "made"],
    "fabricate": ["fabricate", "ROBOT", "--out", "made"],
    "sample": ["sample", "ROBOT", "--count", "48", "--file-size", "8", "--jobs", "1", "--out", "made"],
    "learn": ["learn", "DATA", "--steps", "300", "--out", "made/a.model"],
    "train": ["train", "ROBOT", "--model", "MODEL", "--steps", "120", "--goals", "3", "--out", "made"],
}
"""Commands that are killed; of a small starfish."""

NEEDS = {"learn": "torch", "train": "stable_baselines3"}
"""Packages of extras without which a command is left out."""

SIGNALS = (signal.SIGTERM, signal.SIGKILL, signal.SIGHUP, signal.SIGINT)
PARTIAL = ("design", "pose", "sample", "train")
"""Commands whose results come one after another: of the others all files are there, or none."""


def _available() -> list[str]:
    from importlib.util import find_spec

    return [name for name in WORK if name not in NEEDS or find_spec(NEEDS[name])]


@cache
def _prepared(place: Path) -> dict[str, str]:
    """Paths of a robot, samples and a model, made once."""
    robot, data, model = place / "robot", place / "data", place / "a.model"
    if not (robot / "robot.toml").exists():
        _finish(["new", str(robot), "--from", "gallery:starfish", "--nodes", "120"], place)
    if "learn" in _available() and not model.exists():
        _finish(["sample", str(robot), "--count", "64", "--jobs", "1", "--out", str(data)], place)
        _finish(["learn", str(data), "--steps", "200", "--out", str(model)], place)
    return {"ROBOT": str(robot), "DATA": str(data), "MODEL": str(model)}


def _finish(arguments: list[str], folder: Path) -> float:
    """Run a command to its end; returns its seconds."""
    began = time.monotonic()
    _, status = os.waitpid(run_forked(command(*arguments), folder, group=True), 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        raise SystemExit(f"{' '.join(arguments)}: {_words(folder, 'err.txt')}")
    return time.monotonic() - began


def _arguments(name: str, place: Path) -> list[str]:
    paths = _prepared(place)
    return [paths.get(word, word) for word in WORK[name]]


@cache
def _whole_run(name: str, place: Path) -> tuple[float, frozenset[str]]:
    """Seconds of a command that is not killed, and the files that it writes."""
    folder = Path(tempfile.mkdtemp(dir=place))
    (folder / "made").mkdir() if name == "learn" else None
    seconds = _finish(_arguments(name, place), folder)
    return seconds, frozenset(_files(folder / "made"))


def _files(folder: Path) -> list[str]:
    paths = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]
    return [str(path) for path in paths if not any(part.startswith(".") for part in path.parts)]


def kill(number: int, seed: int, only: str | None, folder: Path, place: Path) -> Ending:
    """Send a signal to a command at some time, and look at what it leaves."""
    draw = np.random.default_rng([seed, number])
    names = [name for name in _available() if only in (None, name)]
    name = names[number % len(names)]
    seconds, files = _whole_run(name, place)
    sent = SIGNALS[int(draw.integers(len(SIGNALS)))]
    after = float(draw.uniform(0.02, 1.05)) * seconds
    (folder / "made").mkdir() if name == "learn" else None
    child = run_forked(command(*_arguments(name, place)), folder, group=True)
    time.sleep(after)
    began = time.monotonic()
    done, status = os.waitpid(child, os.WNOHANG)
    if not done:
        # A closed terminal tells all processes of a job, a person or a scheduler the first one.
        (os.killpg if sent in (signal.SIGHUP, signal.SIGINT) else os.kill)(child, sent)
        if draw.random() < 0.3:
            time.sleep(float(draw.uniform(0.0, 0.3)))
            _send_again(child, sent)
        _, status = os.waitpid(child, 0)
    words = f"{name}: {signal.Signals(sent).name} after {after:.2f} of {seconds:.2f} s"
    code = os.waitstatus_to_exitcode(status)
    ending = Ending(number=number, kind=words, code=code, seconds=time.monotonic() - began)
    ending.line = (_words(folder, "err.txt").strip().splitlines() or [""])[-1][:300]
    if "Traceback" in _words(folder, "err.txt"):
        ending.wrong.append("traceback: " + ending.line)
    if code not in (0, 1, 130, 128 + sent, -sent):
        ending.wrong.append(f"exit code {code}")
    ending.wrong += _left(name, folder, files, sent)
    if orphans := _processes(child):
        ending.wrong.append(f"processes that go on: {orphans}")
        os.killpg(child, signal.SIGKILL)
    return ending


def _send_again(child: int, sent: int) -> None:
    try:
        os.kill(child, sent)
    except ProcessLookupError:
        return


def _left(name: str, folder: Path, files: frozenset[str], sent: int) -> list[str]:
    """Say what is wrong with the files that a killed command leaves."""
    made, wrong = folder / "made", []
    if not made.exists():
        return []
    wrong += find_half_files(made)
    if name not in PARTIAL and (found := set(_files(made))) and found < files:
        wrong.append(f"a part of its files: {len(found)} of {len(files)}")
    if sent == signal.SIGINT and (left := find_unfinished(folder)):
        wrong.append(f"unfinished files: {left}")
    return wrong


def _processes(group: int) -> list[str]:
    """Command lines of processes of a group that go on for a second after the first has ended."""
    for _ in range(20):
        found = []
        for entry in Path("/proc").iterdir():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split() if entry.name.isdigit() else []
            except OSError:
                continue
            if fields and fields[0] != "Z" and int(fields[2]) == group:
                found.append(entry.name)
        if not found:
            return []
        time.sleep(0.05)
    return found


def main() -> int:
    """Run the cases that have no result yet, and print what came of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", default="mutations", choices=("mutations", "kills"))
    parser.add_argument("--count", type=int)
    parser.add_argument("--seed", type=int, default=45)
    parser.add_argument("--only", help="kind of file, or command")
    parser.add_argument("--again", type=int, help="run one case again and keep its folder")
    parser.add_argument("--out", type=Path, default=Path("build/faults"))
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    out, count = given.out.resolve(), given.count or {"mutations": 2000, "kills": 200}[given.what]
    (out / "wrong").mkdir(parents=True, exist_ok=True)
    (out / "prepared").mkdir(exist_ok=True)
    suffix = f"_{given.only.replace(' ', '_')}" if given.only else ""
    results = out / f"{given.what}_{given.seed}{suffix}.jsonl"
    done = {} if not results.exists() else {row["number"]: row for row in map(json.loads, results.open())}
    _import_all()
    numbers = range(count) if given.again is None else [given.again]
    for number in numbers:
        if number in done and given.again is None:
            continue
        folder = Path(tempfile.mkdtemp(prefix=f"{given.what}_{number}_", dir=out))
        if given.what == "mutations":
            ending = mutate(number, given.seed, given.only, folder)
        else:
            ending = kill(number, given.seed, given.only, folder, out / "prepared")
        done[number] = asdict(ending)
        if ending.wrong or given.again is not None:
            goal = out / "wrong" / f"{given.what}_{given.seed}{suffix}_{number}"
            shutil.rmtree(goal, ignore_errors=True)
            folder.rename(goal)
            print(f"{number} {ending.kind}: {'; '.join(ending.wrong)} ({goal})", flush=True)
        else:
            shutil.rmtree(folder, ignore_errors=True)
        with results.open("a") as file:
            file.write(json.dumps(asdict(ending)) + "\n")
    return _tell(done, given.what)


def _tell(done: dict[int, dict], what: str) -> int:
    """Print how many cases of each kind ended in which way."""
    table: dict[str, Counter] = {}
    for row in done.values():
        words = {0: "done", 1: "not done", 2: "refused", 130: "kept"}.get(row["code"], f"{row['code']}")
        table.setdefault(row["kind"].partition(":")[0], Counter())[words] += 1
    for kind, counts in sorted(table.items()):
        print(f"{kind:<12} {sum(counts.values()):5}  " + ", ".join(f"{w} {n}" for w, n in sorted(counts.items())))
    wrong = [row for row in done.values() if row["wrong"]]
    slowest = max((row["seconds"] for row in done.values()), default=0.0)
    print(f"{len(done)} {what}, slowest {slowest:.1f} s, wrong: {len(wrong)}")
    return int(bool(wrong))


def _import_all() -> None:
    """Load what the commands use, so that each copy of this process begins at once."""
    import hydrostat.cli.main
    import hydrostat.design
    import hydrostat.fabrication
    import hydrostat.learning
    import hydrostat.plot
    import hydrostat.studio  # noqa: F401

    gc.freeze()


if __name__ == "__main__":
    sys.exit(main())
