"""Files of strangers have a budget, and what was killed, filled or closed leaves nothing behind.

The 20 files of benchmarks/strangers.py are offered there one by one; here those that cost no seconds.
"""

import os
import signal
import subprocess
import sys
import time
import tomllib
import tracemalloc
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from builders import gallery_robot

import strangers
from hydrostat.cli.bounded import run_bounded
from hydrostat.cli.folders import require_folder, result_folder
from hydrostat.cli.new import _commented_text
from hydrostat.errors import InputError
from hydrostat.files import clear_unfinished, read_stranger, replace_file, temporary_path
from hydrostat.geometry import heal, read_drawing, read_surface, triangulate

Run = Callable[..., tuple[int, str, str]]
START = "from hydrostat.cli.main import main; main()"


@pytest.mark.parametrize("name", ["giant.stl", "giant.obj", "giant.vtk", "giant.png", "giant.svg"])
def test_a_giant_is_refused_before_a_byte_is_read(tmp_path: Path, name: str) -> None:
    """Oracle: the memory that Python takes, of a file of 6 GB that is nothing but a hole."""
    path = strangers.make(name, tmp_path)
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=r"has 6000 MB, at most .* are read: save"):
            read_stranger(path)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


def test_a_device_and_a_pipe_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.svg")
    for path in (Path("/dev/zero"), tmp_path / "pipe.svg", tmp_path):
        with pytest.raises(InputError, match="is not a file"):
            read_stranger(path)


DRAWINGS = {
    "closed again and again": (lambda: strangers.closes(1_000_000), "more than 100000 points"),
    "clones of clones": (strangers.clones, "has 1111 closed shapes, more than 200"),
    "a style sheet": (strangers.styles, "a style sheet of 10688890 letters, at most 100000"),
    "an attribute": (
        lambda: (strangers.SVG % f'<path transform="{"scale(1) " * 20_000}" d="M0 0H9V9Z"/>').encode(),
        "an attribute 'transform' of 180000 letters",
    ),
}


@pytest.mark.parametrize("case", DRAWINGS)
def test_drawings_are_counted_before_they_are_read(case: str) -> None:
    make, words = DRAWINGS[case]
    began = time.process_time()
    with pytest.raises(InputError, match=words):
        read_drawing(make(), name="a.svg", size=0.1)
    assert time.process_time() - began < 10.0


SHEETS = {
    "cut short": "a{" * 40_000,
    "spaces": "a" + " " * 99_000,
    "comments in comments": "/*" * 49_000,
    "rules": "/* a { */ circle { fill: red } " * 2000,
}


@pytest.mark.parametrize("case", SHEETS)
def test_a_style_sheet_is_read_once(case: str) -> None:
    """Oracle: the disc; before, the first three took the library a minute to hours."""
    content = strangers.SVG % f'<style>{SHEETS[case]}</style><circle cx="50" cy="50" r="40"/>'
    began = time.process_time()
    assert read_drawing(content.encode(), name="a.svg", size=None).outline.area == pytest.approx(0.005027, rel=1e-3)
    assert time.process_time() - began < 10.0


@pytest.mark.parametrize(("rule", "shapes"), [("circle { visibility: hidden }", 0), (".no { visibility: hidden }", 1)])
def test_a_style_sheet_still_hides(rule: str, shapes: int) -> None:
    content = strangers.SVG % f'<style>/* eyes */ {rule}</style><circle cx="50" cy="50" r="40"/>'
    if shapes:
        assert read_drawing(content.encode(), name="a.svg", size=None).outline.area > 0.005
        return
    with pytest.raises(InputError, match="no closed shape"):
        read_drawing(content.encode(), name="a.svg", size=None)


MALFORMED = {
    "a transform": ('<g transform="matrix(1,2,3)"><circle r="9"/></g>', "a part of it is missing or malformed"),
    "a turn": ('<g transform="rotate(nan)"><circle r="9"/></g>', "a part of it is missing or malformed"),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_what_python_says_of_itself_is_not_passed_on(case: str) -> None:
    text, words = MALFORMED[case]
    with pytest.raises(InputError, match=words):
        read_drawing((strangers.SVG % text).encode(), name="a.svg", size=0.1)


@pytest.mark.parametrize("box", ["0 0 0 0", "0 0 -100 100", "a b c", "0 0 1e300 1"])
def test_a_page_without_a_size_is_refused(box: str) -> None:
    """Such a viewBox was left out, and the body made a fifth of its size."""
    content = (strangers.SVG % '<circle cx="50" cy="50" r="40"/>').replace("0 0 100 100", box)
    with pytest.raises(InputError, match=r"its viewBox, .* must be four numbers, the last two above 0"):
        read_drawing(content.encode(), name="a.svg", size=None)


def test_the_name_of_a_file_stays_in_its_comment() -> None:
    """Oracle: tomllib; a name with an end of line wrote keys of its own into robot.toml."""
    text = _commented_text(gallery_robot("starfish"), 'a\ngravity = "down"\x1b[31m.svg')
    assert "gravity" not in tomllib.loads(text)
    assert text.splitlines()[0].startswith("# starfish, made from a\\ngravity")


OUTLINES = {
    "a spiral": (lambda: strangers.spiral(3000), "only .* mm wide on average, too thin for elements of 4 mm"),
    "a comb": (lambda: strangers.zigzag(8000), "only .* mm wide on average|m long, .* elements of 4 mm, at most 50000"),
}


@pytest.mark.parametrize("case", OUTLINES)
def test_outlines_that_wind_are_refused_at_once(case: str) -> None:
    make, words = OUTLINES[case]
    outline = read_drawing(make(), name="a.svg", size=0.1).outline
    with pytest.raises(InputError, match=words):
        triangulate(outline, 0.004)


SURFACES = {
    "a fan": (lambda: strangers.fan(20_000), "20000 triangles meet at one edge"),
    "a soup": (lambda: strangers.soup(25_000, 0.5), "falls into 25000 loose parts, at most 20000"),
    "shells in shells": (lambda: strangers.nested(1500), "lie about each other, as in shells within shells"),
    "a tangle": (lambda: strangers.soup(15_000, 30.0), "run through each other everywhere"),
}


@pytest.mark.parametrize("case", SURFACES)
def test_what_is_no_surface_is_refused_at_once(case: str) -> None:
    make, words = SURFACES[case]
    with pytest.raises(InputError, match=words):
        heal(read_surface(make(), name="a.stl"), resolution=1e-3)


@pytest.mark.parametrize("kind", ["bulge", "splines"])
def test_nothing_is_said_that_is_not_ours(kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    """Oracle: warnings are errors, and nothing is written past Python."""
    with warnings.catch_warnings(action="error"):
        read_drawing(strangers.dxf(kind), name="a.dxf", size=0.1)
    assert capfd.readouterr() == ("", "")


def _spin() -> None:
    while True:
        pass


def _hoard() -> None:
    kept = []
    while True:
        kept.append(bytearray(50_000_000))


def _refuse() -> None:
    raise InputError("no")


def bound(work: Callable[[], object], seconds: float = 20.0) -> object:
    """Within 400 MB more than this process has, which its child begins with."""
    here = int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return run_bounded(work, file="a.stl", words="healing ...", seconds=seconds, memory=here + 400_000_000)


def test_work_within_its_budget_is_as_if_done_here() -> None:
    assert bound(lambda: {"a": 1}) == {"a": 1}
    with pytest.raises(InputError, match=r"^no$"):
        bound(_refuse)


def test_work_beyond_its_budget_is_ended() -> None:
    began = time.monotonic()
    with pytest.raises(InputError, match=r"a\.stl: time limit reached \(0.2 s\)\. Simplify it or allow more time"):
        bound(_spin, seconds=0.2)
    with pytest.raises(InputError, match=r"a\.stl: memory limit reached \(.* GB\)"):
        bound(_hoard)
    with pytest.raises(InputError, match=r"reading failed \(signal 9\)"):
        bound(lambda: os.kill(os.getpid(), signal.SIGKILL))
    assert time.monotonic() - began < 120.0


def test_ctrl_c_ends_it_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the clock, and that its child is no child any more (other tests may have left theirs)."""
    fork, children = os.fork, list[int]()

    def forked() -> int:
        children.append(fork())
        return children[-1]

    monkeypatch.setattr(os, "fork", forked)
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    began = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            bound(lambda: time.sleep(60))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
    assert time.monotonic() - began < 50.0
    assert len(children) == 1
    with pytest.raises(ChildProcessError):
        os.waitpid(children[0], os.WNOHANG)


def dead_process() -> int:
    """Number of a process that is no more."""
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    return gone.pid


def test_what_killed_runs_left_is_cleared_by_the_next(tmp_path: Path) -> None:
    own = temporary_path(tmp_path / "robot.toml")
    left = [tmp_path / own.name.replace(f"-{os.getpid()}-", f"-{dead_process()}-"), tmp_path / "kit"]
    left[1] = left[0].with_name(left[0].name.replace("robot.toml", "kit"))
    left[0].write_text("half")
    left[1].mkdir()
    (left[1] / "half.svg").write_text("half")
    stays = [own, tmp_path / ".hidden.part", tmp_path / "robot.toml"]
    for path in stays:
        path.write_text("whole")
    require_folder(tmp_path / "out")
    assert sorted(tmp_path.iterdir()) == sorted(stays)
    clear_unfinished(tmp_path / "nowhere")


@pytest.mark.parametrize(
    "command", ["learn nothing --out here/m.model", "train gallery:starfish --method guess --out here"]
)
def test_what_killed_learning_left_is_cleared_too(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """Also by a command that is then refused."""
    pytest.importorskip("gymnasium", reason="gymnasium is not installed")
    monkeypatch.chdir(tmp_path)
    own = temporary_path(tmp_path / "here" / "m.model")
    own.parent.mkdir()
    left = own.with_name(own.name.replace(f"-{os.getpid()}-", f"-{dead_process()}-"))
    left.write_text("half")
    assert run(*command.split())[0] == 2
    assert not left.exists()


@pytest.mark.parametrize(
    "command",
    [
        "design gallery:starfish --winches 1 --cables 1 --out out",
        "learn data --out m.model",
        "fabricate gallery:starfish --out out/kit",
        "calibrate robot --motors emulated",
    ],
)
def test_where_nothing_can_be_written_is_told_before_the_work(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """After the work it was told, by design with a hidden name, by calibrate after motors had turned."""
    (tmp_path / "robot").mkdir()
    monkeypatch.chdir(tmp_path)
    may = os.access

    def access(path: Path | str, mode: int, **more: Any) -> bool:
        here = Path(path).absolute().is_relative_to(tmp_path)
        return not (here and mode & os.W_OK) and may(path, mode, **more)

    monkeypatch.setattr(os, "access", access)
    place = tmp_path / "robot" if "robot" in command else tmp_path
    code, out, err = run(*command.split())
    assert (code, out) == (2, "")
    assert f"cannot write to {place}. Name another folder or change its permissions.\n" in err


def test_a_folder_that_takes_no_files_is_told_before_the_work(run: Run) -> None:
    """Oracle: /proc, which says of itself that a root may write there."""
    code, out, err = run("simulate", "gallery:starfish", "--out", "/proc/x")
    assert (code, out) == (2, "")
    assert err.startswith("hydrostat: error: --out /proc/x: cannot write to /proc. Name another folder")


def test_two_writers_of_one_folder(tmp_path: Path) -> None:
    """Each is whole, and the later stays; neither stumbles over what the other has under way."""
    out = tmp_path / "out"
    with result_folder(out) as one:
        (one / "a.txt").write_text("one")
        (out / "made").mkdir(parents=True)
        (out / "a.txt").write_text("other")
    assert (out / "a.txt").read_text() == "one"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]
    assert temporary_path(out / "a") != replace_file(out / "a", b"x")
    assert sorted(path.name for path in out.iterdir()) == ["a", "a.txt", "made"]


def test_results_come_whole_where_only_the_record_of_a_search_is(tmp_path: Path) -> None:
    """Oracle: the number of the folder itself, which a folder that is filled file by file keeps."""
    (out := tmp_path / "out").mkdir()
    (out / "search.json").write_text("steps")
    for known, is_new in ((("search.json",), True), ((), False)):
        before = out.stat().st_ino
        with result_folder(out, kept=known) as part:
            (part / "a").mkdir()
            (part / "a" / "b.txt").write_text("b")
            assert not (out / "a" / "b.txt").exists() or not is_new
        assert (out.stat().st_ino != before) == is_new
        assert (out / "search.json").read_text() == "steps"
        assert (out / "a" / "b.txt").read_text() == "b"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_complaints_name_the_folder_that_was_asked_for(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match=rf"^{tmp_path}/out/a\.gif: cannot be written$"),
        result_folder(tmp_path / "out") as part,
    ):
        raise InputError(f"{part}/a.gif: cannot be written")
    assert list(tmp_path.iterdir()) == []


def test_a_name_as_long_as_any_may_be_can_be_written(tmp_path: Path) -> None:
    long = tmp_path / ("ü" * 120)
    assert replace_file(long, b"whole").read_bytes() == b"whole"


@pytest.mark.slow
def test_a_closed_pipe_and_a_full_disk_end_without_a_trace() -> None:
    """Oracle: the exit codes of a shell, and what is said. A pipe that is closed is no error, such as that of head."""
    command = [sys.executable, "-c", START, "materials"]
    shell = {name: value for name, value in os.environ.items() if not name.startswith("PYTHONUNBUFFERED")}
    reader, writer = os.pipe()
    os.close(reader)
    closed = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False, env=shell)
    os.close(writer)
    assert (closed.returncode, closed.stderr) == (0, "")
    with open("/dev/full", "w") as full:
        filled = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False, env=shell)
    assert filled.returncode == 2
    assert filled.stderr == "hydrostat: error: output: No space left on device\n"


def test_the_files_of_the_benchmark_are_all_there() -> None:
    """Oracle: those of the first attack, and of the second."""
    assert len(strangers.FILES) == 20 + 4


HOLDER = (
    "import sys; from pathlib import Path; from hydrostat.files import hold_folder; "
    "hold_folder(Path(sys.argv[1])); print('held', flush=True); input()"
)


def test_a_second_process_is_told_that_another_writes_there(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: a process that holds the folder; when it is killed the folder is free."""
    out = tmp_path / "out"
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(out)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    code, _, err = run("simulate", starfish, "--out", out)
    words = f"hydrostat: error: {out}: another hydrostat writes there. Wait for it, or name another folder.\n"
    assert (code, err, out.exists()) == (2, words, False)
    holder.kill()
    holder.communicate()
    assert run("simulate", starfish, "--out", out)[0] == 0


def test_a_picture_that_cannot_be_written_leaves_no_folder(
    run: Run, starfish: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: a full disk, played by a PNG writer that has no space."""

    def full(_: object, path: Path) -> Path:
        raise InputError(f"{path}: cannot be written (No space left on device)")

    monkeypatch.setattr("hydrostat.plot.save_png", full)
    out = tmp_path / "out"
    code, _, err = run("simulate", starfish, "--out", out)
    assert (code, err) == (2, f"hydrostat: error: {out}/pose.png: cannot be written (No space left on device)\n")
    assert list(tmp_path.iterdir()) == []
