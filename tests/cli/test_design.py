"""`hydrostat design`: what is asked of the search, what is written, what is told.

The search is replaced by one that notes what it was asked for. Oracles: records made by hand, written files read back,
errors word by word.
"""

import itertools
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from builders import strip_robot
from plot.designs import plain_network

import hydrostat as hs
from hydrostat.cli.remedies import body_refusals, design_remedy, kit_remedy
from hydrostat.design import (
    Alternative,
    Constraints,
    DesignRequest,
    FibreKind,
    Lift,
    Network,
    RouteOptions,
    SearchRecord,
    TreeOptions,
    Zone,
)
from hydrostat.fabrication import PatternOptions
from hydrostat.robot import Marker, PoseTarget, robot_hash, save_robot
from hydrostat.simulation import Simulation

Run = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.fixture
def strip(tmp_path: Path) -> Path:
    """The folder of a robot with winches up and down, a cable each."""
    save_robot(plain_network().robot, tmp_path / "strip")
    return tmp_path / "strip"


class Search:
    """Stands for `find_network`."""

    def __init__(self) -> None:
        self.asked: DesignRequest | None = None
        self.known: Sequence[object] = ()
        self.answer: Network = plain_network()

    def __call__(self, robot: hs.Robot, request: DesignRequest, *, record: SearchRecord, **_: object) -> Network:
        self.asked = request
        self.known = record.known
        if not self.answer.complete:
            record.add({"step": "sketch", "tried": 1, "networks": None})
        return replace(self.answer, request=request)


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Search:
    """The search; the kits of its networks pass, until a test says otherwise."""
    fake = Search()
    monkeypatch.setattr("hydrostat.design.find_network", fake)
    monkeypatch.setattr("hydrostat.design.kit_fits", lambda network: True)
    monkeypatch.setattr("hydrostat.design.find_lifts", lambda _: ())
    return fake


@pytest.fixture
def no_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """The report, which takes a second, is a line."""
    monkeypatch.setattr("hydrostat.plot.write_report", lambda _, path, **facts: path.write_text(str(facts)))


def files_in(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


PLAIN = Constraints()
OPTIONS = {
    (): {},
    ("--winches", "1", "--cables", "3"): {"winches": 1, "cables": 3},
    ("--winches", "auto"): {"winches": "auto"},
    ("--winches", "auto", "--tolerance", "3 mm"): {"winches": "auto", "options": RouteOptions(tolerance=0.003)},
    ("--warm-start",): {"warm_start": True},
    ("--method", "trees"): {"method": "trees", "options": TreeOptions()},
    ("--method", "chang2018", "--tree-option", "phi=0.2"): {
        "method": "chang2018",
        "options": TreeOptions.single(phi=0.2),
    },
    ("--method", "chang2018"): {"method": "chang2018", "options": TreeOptions.single()},
    ("--time", "5 s"): {"seconds": 5.0},
    ("--method", "trees", "--fibres", "elements"): {
        "method": "trees",
        "options": TreeOptions(fibres=FibreKind.ELEMENTS),
    },
    ("--cables-per-winch", "3"): {"constraints": replace(PLAIN, cables_per_winch=3)},
    ("--clearance", "7 mm"): {"constraints": replace(PLAIN, clearance=0.007)},
    ("--tension", "12 N"): {"constraints": replace(PLAIN, tension=12.0)},
    ("--slack", "4 mm"): {"constraints": replace(PLAIN, slack=0.004)},
    ("--front",): {"front": True},
    ("--stepped-spools",): {"constraints": replace(PLAIN, spool_ratio=2.0)},
    ("--symmetric", "y"): {"constraints": replace(PLAIN, mirror="y")},
    ("--lock-winch", "down", "--lock-winch", "up"): {"constraints": replace(PLAIN, locked_winches=("down", "up"))},
    ("--lock-cable", "2", "--lock-cable", "down 1"): {"constraints": replace(PLAIN, locked_cables=("down 1",))},
}


@pytest.mark.parametrize("options", OPTIONS)
def test_options_reach_the_search(
    run: Run, strip: Path, search: Search, no_report: None, options: tuple[str, ...], tmp_path: Path
) -> None:
    assert run("design", strip, *options, "--out", tmp_path / "out")[0] == 0
    poses = tuple(hs.load_robot(strip).poses.values())
    assert search.asked == DesignRequest(poses=poses, **OPTIONS[options])


def test_options_come_before_the_file(run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path) -> None:
    file = tmp_path / "limits.toml"
    file.write_text(
        'clearance = "4 mm"\ntension = "9 N"\nlocked_cables = [1]\n[[keep_out]]\nat = [50, 0]\nradius = 5\n'
    )
    options = ("--constraints", file, "--tension", "12 N", "--lock-cable", "2")
    assert run("design", strip, *options, "--out", tmp_path / "out")[0] == 0
    zone = Zone(at=(0.05, 0.0), radius=0.005)
    assert search.asked is not None
    assert search.asked.constraints == Constraints(
        clearance=0.004, tension=12.0, locked_cables=("down 1",), keep_out=(zone,)
    )
    card = json.loads((tmp_path / "out" / "score.json").read_text())
    kept = card["request"]["constraints"]
    assert kept["keep_out"] == [{"at": [0.05, 0.0], "radius": 0.005, "box": None, "outline": []}]
    assert kept["tension"] == 12.0
    told = (tmp_path / "out" / "report.html").read_text()
    for words in ("'clearance': '4 mm'", "'tension': '12 N'", "'keep out': '1'", "'locked cables': 'down 1'"):
        assert words in told
    assert "still" not in told


def test_a_design_that_no_kit_can_be_made_of_is_an_error(
    run: Run, strip: Path, search: Search, no_report: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Oracle: the strip's own refusals; the command continues with the alternative that fits, else with fewer winches.

    A rejected network of one winch and one cable is not asked for again. All is written anyway.
    """
    found, other = search.answer, search.answer.alternatives[1]
    out = tmp_path / "out"
    least = replace(found.robot, winches=found.robot.winches[:1], cables=found.robot.cables[:1])
    small = replace(found, robot=least, alternatives=())
    assert design_remedy(small, strip, out) == f"hydrostat check {out}/robot"
    hasty = replace(found, alternatives=(), complete=False)
    for seconds, advised in ((8.0, " --time 32s --out "), (0.1, " --time 0.4s --out "), (2400.0, " --winches ")):
        told = design_remedy(replace(hasty, request=replace(found.request, seconds=seconds)), strip, out)
        assert advised in told
        assert ("--time" in told) is ("--time" in advised)
    for fits, remedy in (
        (lambda network: network is other, f"hydrostat fabricate {out}/alternatives/02_1_winches_1_cables "),
        (lambda network: False, f"hydrostat design {strip} --winches 1 --cables 1 "),
    ):
        monkeypatch.setattr("hydrostat.design.kit_fits", fits)
        code, told, err = run("design", strip, "--out", out)
        assert code == 1
        assert "error: the units of winches" in told
        assert f"Try: {remedy}" in told
        assert "Next: " not in told
        assert "the kit of this network would be rejected" in err
        assert (out / "robot" / "robot.toml").exists()


def test_a_body_without_a_kit_is_reported_before_the_search(
    run: Run, search: Search, no_report: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Oracle: a hole narrower than two seams. No network helps, so the next command is not another design."""
    ring = "M0,0 H200 V60 H0 Z M100,28 V32 H104 V28 Z"
    drawing = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 60"><path fill-rule="evenodd" d="{ring}"/></svg>'
    )
    (tmp_path / "holed.svg").write_text(drawing)
    plain = plain_network()
    robot = hs.new_robot(tmp_path / "holed.svg", size=0.2)
    marker = Marker(name="tip", at=tuple(robot.body.mesh.nodes[0].tolist()))
    posed = replace(robot, markers=(marker,), poses={"up": PoseTarget(name="up", targets={"tip": marker.at})})
    save_robot(posed, tmp_path / "holed")
    search.answer = replace(plain, source=posed)
    monkeypatch.setattr("hydrostat.design.kit_fits", lambda network: False)
    code, told, err = run("design", tmp_path / "holed", "--out", tmp_path / "out")
    assert (code, told, search.asked, (tmp_path / "out").exists()) == (2, "", None, False)
    assert err.startswith("hydrostat: error: no kit can be made of this body: hole 1 of the outline")
    assert err.count("\n") == 1
    assert "To design without a kit: built_in = false" in err
    (tmp_path / "limits.toml").write_text("built_in = false\n")
    code, told, err = run(
        "design", tmp_path / "holed", "--constraints", tmp_path / "limits.toml", "--out", tmp_path / "out"
    )
    assert code == 1
    assert search.asked is not None
    assert "warning: no kit can be made of this body: hole 1 of the outline" in err
    assert f"Try: hydrostat check {tmp_path / 'holed'}" in told
    told = run("check", tmp_path / "holed")[1]
    assert "warning: no kit can be made of this body: hole 1 of the outline" in told
    assert 'set inner = "drawn" in [body]' in told
    reasons = body_refusals(posed)
    for seam, tried in ((8.0, "check holed"), (1.5, "design holed --winches 1 --cables 1 --out kit_design")):
        options = hs.KitOptions(pattern=PatternOptions(seam_allowance=seam))
        asked = reasons if seam > 2 else ("another",)
        assert kit_remedy(posed, Path("holed"), Path("kit"), options=options, reasons=asked) == f"hydrostat {tried}"


@pytest.mark.slow
def test_design_and_kit_report_each_problem_once(run: Run, strip: Path, search: Search, no_report: None) -> None:
    """Oracle: the problems of the kit, one line each, among those of the design."""
    code, told, _ = run("design", strip, "--kit", "--out", strip.parent / "out")
    assert code == 1
    lines = [line for line in told.splitlines() if line.startswith(("error: ", "warning: ", "note: "))]
    assert any(line.startswith("error: the units of winches") for line in lines)
    assert len(lines) == len(set(lines))


@pytest.mark.slow
def test_everything_is_written_and_can_be_read(run: Run, strip: Path, search: Search, tmp_path: Path) -> None:
    out = tmp_path / "new" / "out"
    code, told, _ = run("design", strip, "--out", out)
    assert code == 0
    assert files_in(out) == [
        "alternatives/01_2_winches_2_cables/made.vtk",
        "alternatives/01_2_winches_2_cables/robot.toml",
        "alternatives/02_1_winches_1_cables/made.vtk",
        "alternatives/02_1_winches_1_cables/robot.toml",
        "report.html",
        "robot/made.vtk",
        "robot/robot.toml",
        "score.json",
    ]
    assert [path.name for path in out.parent.iterdir()] == ["out"]
    network, card = search.answer, json.loads((out / "score.json").read_text())
    assert card["robot"] == robot_hash(hs.load_robot(out / "robot")) == robot_hash(network.robot)
    for other, folder in zip(card["alternatives"], sorted((out / "alternatives").iterdir()), strict=True):
        assert other["robot"] == robot_hash(hs.load_robot(folder))
    assert f"model error {1e3 * network.rms_error:.2f} mm rms (at rest 31.62 mm), expected as-built error " in told
    corrected = f"{1e3 * card['rms_error_corrected']:.2f} mm after one correction by measured markers"
    assert f"error {1e3 * network.expected_error:.2f} mm, {corrected} (4 candidates, " in told
    assert card["rms_error_corrected"] < network.expected_error
    assert f"Open {out / 'report.html'}" in told
    assert "How it grew" in (out / "report.html").read_text()


def test_an_earlier_design_is_replaced_and_what_else_lies_there_stays(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert run("design", strip, "--out", out)[0] == 0
    sheet = {"assembly_sheet.pdf": b"of the earlier design"}
    told = {"files": {name: {"sha256": sha256(content).hexdigest()} for name, content in sheet.items()}}
    (out / "kit").mkdir()
    for name, content in {**sheet, "manifest.json": json.dumps(told).encode()}.items():
        (out / "kit" / name).write_bytes(content)
    for name in ("notes.txt", "alternatives/mine/robot.toml", "robot/photo.png", "kit/notes.txt"):
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_text("mine")
    search.answer = replace(plain_network(), alternatives=plain_network().alternatives[1:])
    assert run("design", strip, "--out", out)[0] == 0
    kept = {"notes.txt", "alternatives/mine/robot.toml", "robot/photo.png", "kit/notes.txt"}
    assert {name for name in files_in(out) if (out / name).read_bytes() == b"mine"} == kept
    assert sorted(folder.name for folder in (out / "alternatives").iterdir()) == ["01_1_winches_1_cables", "mine"]
    assert [path.name for path in (out / "kit").iterdir()] == ["notes.txt"]
    assert not list(tmp_path.rglob("*.part"))


def test_nothing_is_written_where_writing_is_stopped(
    run: Run, strip: Path, search: Search, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrostat.plot.write_report", stop)
    before = sorted(tmp_path.rglob("*"))
    assert run("design", strip, "--out", tmp_path / "out")[0] == 130
    assert sorted(tmp_path.rglob("*")) == before


def test_a_killed_search_leaves_its_steps(
    run: Run, strip: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Oracle: steps that a second run is given, after one whose end writes nothing, by a clock of 10 s a look."""
    clock = itertools.count(step=10.0)
    monkeypatch.setattr("hydrostat.cli.design_record.time", SimpleNamespace(perf_counter=lambda: next(clock)))
    steps = [{"step": str(number), "tried": 1, "networks": None} for number in range(3)]
    known = []

    def die(*_: object, record: SearchRecord, **__: object) -> None:
        known.append(record.known)
        for step in steps[len(record.known) :]:
            record.add(step)
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrostat.design.find_network", die)
    for more in ((), ("--resume",), ()):
        code, _, errors = run("design", strip, *more, "--out", tmp_path / "out")
        assert code == 130
        assert errors.endswith(f"first network; to continue, add --resume ({tmp_path / 'out' / 'search.json'})\n")
    first, second, _ = known
    assert (tmp_path / "out" / "search.old.json").exists()  # a new search does not overwrite it
    assert (first, second[0]) == ((), steps[0])


def test_a_search_that_is_stopped_before_it_has_found_anything(
    run: Run, strip: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrostat.design.find_network", stop)
    code, _, errors = run("design", strip, "--out", tmp_path / "out")
    assert (code, errors) == (130, "hydrostat: interrupted before the first network; no files written\n")
    assert not (tmp_path / "out").exists()


def test_a_search_that_its_time_ends_names_what_comes_on_top(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path
) -> None:
    search.answer = replace(plain_network(), complete=False, timed_out=True)
    _, told, err = run("design", strip, "--time", "9 s", "--out", tmp_path / "out")
    assert told.endswith("time limit of 9 s reached: best network so far\n")
    assert "search ended by --time. The report takes additional time\n" in err


def test_the_best_so_far_where_the_search_is_stopped(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path
) -> None:
    search.answer = replace(plain_network(), complete=False)
    code, told, _ = run("design", strip, "--out", tmp_path / "out")
    assert code == 130
    assert told.endswith("interrupted: best network so far\n")
    assert json.loads((tmp_path / "out" / "score.json").read_text())["complete"] is False
    assert hs.load_robot(tmp_path / "out" / "robot").cables == search.answer.robot.cables

    assert "run the same command with --resume" in told
    assert run("design", strip, "--winches", "1", "--resume", "--out", tmp_path / "out")[2].endswith(
        "record of another search (winches differs). Start without --resume.\n"
    )
    search.answer = plain_network()
    assert run("design", strip, "--time", "9 s", "--resume", "--out", tmp_path / "out")[0] == 0
    assert len(search.known) == 1
    assert not (tmp_path / "out" / "search.json").exists()
    assert (
        "out has no search.json, so no search was stopped there"
        in run("design", strip, "--resume", "--out", tmp_path / "out")[2]
    )
    told = run("check", tmp_path / "out")[2]
    assert told == f"hydrostat: error: {tmp_path / 'out'}: results of a design. The robot is {tmp_path / 'out'}/robot\n"


def test_auto_tells_the_error_against_winches_and_cables(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path
) -> None:
    network = plain_network()
    worse = Alternative(
        robot=network.robot, ik_results=(replace(network.ik_results[0], errors={"tip": 0.05}),), expected_error=0.05
    )
    search.answer = replace(network, alternatives=(*network.alternatives, worse))
    _, told, _ = run("design", strip, "--winches", "auto", "--out", tmp_path / "out")
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in told.splitlines() if line.startswith("│")]
    assert ["1", "1", "45.60 mm", ""] in rows
    assert ["2", "2", f"{1e3 * network.expected_error:.2f} mm", "chosen"] in rows
    assert "by number of winches" not in run("design", strip, "--out", tmp_path / "out")[1]


def test_clear_gains_are_printed_and_written_as_alternatives(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: a network by hand; a stop while it is searched keeps the result."""
    network = plain_network()
    other = replace(network.alternatives[0], expected_error=0.002)
    monkeypatch.setattr("hydrostat.design.find_lifts", lambda _: (Lift(words="--two-way", network=other),))
    code, told, _ = run("design", strip, "--out", tmp_path / "out")
    assert code == 0
    assert "note: --two-way would leave at most 2 mm as built, by a quick search" in told
    assert "best network for each number of winches" in told
    *_, last = sorted((tmp_path / "out" / "alternatives").iterdir())
    assert last.name.startswith(f"{len(network.alternatives) + 1:02d}_")
    assert robot_hash(hs.load_robot(last)) == robot_hash(other.robot)

    def stop(_: Network) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrostat.design.find_lifts", stop)
    assert run("design", strip, "--out", tmp_path / "out")[0] == 0


@pytest.mark.parametrize(
    ("held", "complete", "words"),
    [
        ((), False, "the search was stopped before its end. Give it more time"),
        (("up: at maximum tension, 20 N", "down: slack"), True, "20 N, down: slack. Raise these limits, or move the"),
        ((), True, "Allow more cables, or move the targets nearer"),
    ],
)
def test_what_keeps_a_network_from_its_targets_is_told(
    run: Run, strip: Path, search: Search, no_report: None, held: tuple[str, ...], complete: bool, words: str,
    tmp_path: Path,
) -> None:  # fmt: skip
    """Oracle: half of the way to the target, by hand; a network with a tenth of it left says nothing."""
    network = plain_network()
    (reached,) = network.ik_results
    for share, told in ((0.5, True), (0.1, False)):
        miss = replace(reached, errors={"tip": share * network.rest_error}, active_limits=held)
        robot = replace(network.robot, motor="sts3215" if told else "auto")
        search.answer = replace(network, robot=robot, ik_results=(miss,), complete=complete)
        _, out, _ = run("design", strip, "--out", tmp_path / "out")
        assert ("note: on an esp32s3 servos lose their zeros without power: " in out) == told, "spools turn twice"
        assert ("note: 50 % of the way to the targets is left: " in out) == told
        assert (words in out) == told


def test_few_elements_across_a_limb_warn_where_they_move_the_markers(
    run: Run, strip: Path, search: Search, no_report: None, tmp_path: Path
) -> None:
    """Oracle: the tip of a strip of quadratic elements a quarter as long."""
    network = plain_network()
    thin, fine = strip_robot(columns=10, rows=1), strip_robot(columns=40, rows=4)
    fine = replace(fine, body=fine.body.with_elements("quadratic"))
    poses = [Simulation(robot).solve(np.array([0.01, 0.0])) for robot in (thin, fine)]
    away = float(np.linalg.norm(poses[0].markers["tip"] - poses[1].markers["tip"]))
    results = (replace(network.ik_results[0], pose=poses[0]),)
    coarse = replace(network, robot=thin, ik_results=results)
    assert coarse.element_error == pytest.approx(away, rel=0.15)
    for error, words in ((1.2 * away, "note: few elements across a limb: "), (0.8 * away, "warning: body: a limb has")):
        search.answer = replace(coarse, expected_error=error)
        out = run("design", strip, "--out", tmp_path / "out")[1]
        (said,) = (line for line in out.splitlines() if "elements across" in line)
        assert said.startswith(words)
        assert said.endswith(f": quadratic elements move the markers by {1e3 * coarse.element_error:.2g} mm rms")


STARTS = '--method "trees" needs a number of winches and cannot improve a network. Use method "routes".'
BAD = {
    ("--winches", "many"): "--winches must be a whole number from 1 to 20 or \"auto\", not 'many'",
    ("--winches", "0"): '--winches must be a whole number from 1 to 20 or "auto", not 0',
    ("--winches", "²"): "--winches must be a whole number from 1 to 20 or \"auto\", not '²'",
    ("--method", "magic"): '--method must be one of routes, trees, chang2018, not "magic"',
    ("--time", "0 s"): "--time 0 s: must be above 0, e.g. 2 s",
    ("--method", "trees", "--time", "5 s"): '--method "trees" has no time limit. Use method "routes".',
    ("--method", "trees", "--fibres", "hairs"): '--fibres must be one of edges, elements, not "hairs"',
    ("--fibres", "edges"): "--fibres: needs --method trees or chang2018. Add it.",
    ("--tree-option", "phi=0.3"): "--tree-option: needs --method trees or chang2018. Add it.",
    ("--method", "trees", "--tree-option", "phi=3"): "TreeOptions.phis must be at least 0 and at most 1, not 3.0",
    ("--method", "trees", "--tree-option", "steps=some"): "--tree-option steps=some: must be a whole number",
    (
        "--method",
        "trees",
        "--tree-option",
        "psi=3",
    ): "--tree-option psi=3: unknown setting. Write threshold, distance, steps or phi with a value, e.g. phi=0.5.",
    ("--tolerance", "1 mm"): "--tolerance: needs --winches auto. Add it.",
    ("--winches", "auto", "--tolerance", "0 mm"): "--tolerance 0 mm: must be above 0, e.g. 12 mm",
    ("--cables", "61"): "--cables must be a whole number from 1 to 60, not 61",
    ("--method", "trees", "--winches", "auto"): STARTS,
    ("--method", "trees", "--warm-start"): STARTS,
    ("--method", "trees", "--stepped-spools"): '--method "trees" does not keep spool_ratio. Use method "routes", '
    "which does.",
    ("--clearance", "5"): '--clearance 5: "5" has no unit; write for example "12 mm"',
    ("--tension", "0 N"): "--tension 0 N: must be above 0, e.g. 20 N",
    ("--slack", "-1 mm"): "--slack -1 mm: must be 0 or more, e.g. 12 mm",
    ("--symmetric", "w"): "--symmetric w: unknown axis. Allowed: x, y, z.",
    (
        "--symmetric",
        "x",
    ): "--symmetric x: body not centered on x = 0 (0 to 200 mm). Move it there or remove --symmetric.",
    ("--symmetric", "z"): '--symmetric z: no such axis in a flat body. Allowed: "x" or "y".',
    ("--lock-winch", "bob"): '--lock-winch bob: unknown winch "bob". Available: up, down.',
    ("--lock-cable", "3"): '--lock-cable 3: unknown cable "3". Available: up 1, down 1.',
    ("--constraints", "none.toml"): "none.toml: there is no such file",
    ("--pose", "dance"): '--pose dance: unknown pose "dance". Available: up.',
}


@pytest.mark.parametrize("options", BAD)
def test_what_is_wrong_is_one_line(
    run: Run, strip: Path, search: Search, options: tuple[str, ...], tmp_path: Path
) -> None:
    code, out, errors = run("design", strip, *options, "--out", tmp_path / "out")
    assert (code, out, errors) == (2, "", f"hydrostat: error: {BAD[options]}\n")
    assert search.asked is None
    assert not (tmp_path / "out").exists()


def test_help_shows_an_example(run: Run) -> None:
    code, out, _ = run("design", "--help")
    assert code == 0
    assert "Example: hydrostat design gallery:starfish" in out
