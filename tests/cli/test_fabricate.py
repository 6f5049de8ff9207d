"""`hydrostat fabricate` as a user meets it."""

import csv
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
from builders import gallery_robot
from plush import near_the_edge

from hydrostat.cli.design_results import (
    count_cables,
    designed_motor,
    designed_tension,
    designed_torque,
    find_over_budget,
    find_refused_better,
    kit_motor,
)
from hydrostat.cli.remedies import design_remedy, kit_remedy, note_room
from hydrostat.cli.servo_zeros import tell_zero_loss
from hydrostat.design import Alternative, BuildCost, Constraints, Network
from hydrostat.errors import InputError
from hydrostat.fabrication import ALL_MOTORS, Demand, KitOptions, build_kit, find_refusals
from hydrostat.project import Wishes, Work
from hydrostat.robot import CableSide, Marker, Pin, PoseTarget, load_robot, robot_hash, save_robot, scaled_robot

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_a_plush_kit(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, out, err = run("fabricate", starfish, "--out", tmp_path)
    assert code == 0
    assert "Quality checks: 8 of 8 passed" in out
    assert f"Start with {tmp_path / 'assembly_sheet.pdf'}" in out
    assert "Pattern ..." in err
    told = json.loads((tmp_path / "manifest.json").read_text())
    files = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert files == {*told["files"], "manifest.json"}
    assert {"pattern/pattern.svg", "pattern/pattern_a4.pdf", "parts/plate_1.3mf", "lists/cable_cuts.csv"} <= files
    assert "tags.pdf" in files


BAD = {
    ("--method", "clay"): '--method must be one of plush, foam, print, not "clay"',
    ("--mould", "sand"): '--mould must be one of printed, silicone, not "sand"',
    ("--paper", "a5"): '--paper must be one of a4, letter, a3, not "a5"',
    (
        "--bed",
        "220 mm",
    ): '--bed 220 mm: not a build volume. Write three lengths with a unit, e.g. "220 x 220 x 250 mm".',
    ("--bed", "0x220x250mm"): "--bed 0 mm: must be above 0, e.g. 12 mm",
    ("--seam", "0 mm"): "--seam 0 mm: must be above 0, e.g. 12 mm",
    ("--print-clearance", "0.3"): '--print-clearance 0.3: "0.3" has no unit; write for example "12 mm"',
    ("--tension", "-1 N"): "--tension -1 N: must be above 0, e.g. 20 N",
    ("--line", "3 mm"): "cable 3 mm, bore 1 mm and tube 2 mm must rise: the cable runs in the bore of the tube",
}


@pytest.mark.parametrize("options", BAD, ids=" ".join)
def test_bad_options_are_refused_before_the_work(
    run: Run, tmp_path: Path, starfish: Path, options: tuple[str, str]
) -> None:
    code, out, err = run("fabricate", starfish, *options, "--out", tmp_path / "kit")
    assert (code, out, err) == (2, "", f"hydrostat: error: {BAD[options]}\n")
    assert not (tmp_path / "kit").exists()


def test_a_mould_for_plush_is_refused(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, _, err = run("fabricate", starfish, "--mould", "silicone", "--out", tmp_path / "kit")
    assert code == 2
    assert err == "hydrostat: error: --mould: needs a foam body. Remove it, or add --method foam.\n"


def test_a_file_in_the_way_is_said_before_the_work(run: Run, tmp_path: Path, starfish: Path) -> None:
    (tmp_path / "file").write_text("x")
    code, out, err = run("fabricate", starfish, "--out", tmp_path / "file" / "kit")
    assert (code, out) == (2, "")
    assert (
        err == f"hydrostat: error: --out {tmp_path / 'file' / 'kit'}: {tmp_path / 'file'} is a file. Name a folder.\n"
    )


def test_a_summary_writes_nothing(run: Run, tmp_path: Path) -> None:
    """Oracle: the listing of the folder; the two holes that `fabricate` refuses."""
    save_robot(near_the_edge(), tmp_path / "robot")
    code, out, err = run("fabricate", tmp_path / "robot", "--summary", "--out", tmp_path / "kit")
    assert code == 2
    assert err.endswith(
        "robot: 2 problems prevent fabrication. Fix the robot, or add --force to write the kit anyway.\n"
    )
    assert run("fabricate", tmp_path / "robot", "--summary", "--force")[0] == 0
    assert {"Difficulty", "Money", "You must own"} <= {line.partition(":")[0] for line in out.splitlines()}
    assert out.count("pinhole needs") == 2
    assert not (tmp_path / "kit").exists()
    code, _, err = run("fabricate", tmp_path / "robot")
    assert (code, err) == (2, "hydrostat: error: missing option --out. Name a folder, or add --summary.\n")


def test_a_simple_version_is_set_beside_the_full_one(run: Run, tmp_path: Path) -> None:
    """Oracle: two cables of one winch that pull alike: one and its hole go, and so do grommets."""
    robot = near_the_edge()
    bends = zip(robot.cables, (0.01, 0.0), strict=True)
    posed = replace(
        robot,
        pins=(Pin(at=(-0.05, -0.05), radius=0.03),),
        markers=(Marker(name="tip", at=(0.04, 0.02)),),
        poses={"up": PoseTarget(name="up", targets={"tip": (0.039, 0.02)})},
        cables=tuple(replace(cable, points=(cable.points[0], (0.0, y), cable.points[1])) for cable, y in bends),
    )
    save_robot(posed, tmp_path / "robot")
    code, out, _ = run("fabricate", tmp_path / "robot", "--simple", "--summary", "--force")
    assert code == 0
    said = " ".join(out.replace("│", " ").split())
    assert "Left out: 1 of 2 cables of the robot file. Printed grommets." in said
    assert "2 cables, 5 holes, " in said
    assert "1 cable, 3 holes, " in said
    assert "Expected as-built error" in said
    code, _, err = run("fabricate", tmp_path / "robot", "--simple", "--summary", "--method", "foam")
    assert (code, err) == (2, "hydrostat: error: --simple: needs a plush robot. Remove it, or add --method plush.\n")


def test_an_unknown_motor_is_refused(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, _, err = run("fabricate", starfish, "--motor", "v8", "--out", tmp_path / "kit")
    assert code == 2
    assert err.startswith('hydrostat: error: unknown motor "v8"')
    assert not (tmp_path / "kit").exists()


@pytest.mark.slow
def test_what_cannot_be_built_is_refused_with_every_reason(run: Run, tmp_path: Path) -> None:
    save_robot(near_the_edge(), tmp_path / "robot")
    code, out, err = run("fabricate", tmp_path / "robot", "--out", tmp_path / "kit")
    assert code == 2
    reasons = [line for line in out.splitlines() if line.startswith("error: ")]
    assert len(reasons) == 2
    assert "2 problems prevent" in err.splitlines()[-1]
    assert "--force" in err.splitlines()[-1]
    assert not (tmp_path / "kit").exists()


def test_check_refuses_with_the_same_sentences(run: Run, tmp_path: Path) -> None:
    """Oracle: the two holes that `fabricate` refuses above."""
    save_robot(near_the_edge(), tmp_path / "robot")
    code, out, _ = run("check", tmp_path / "robot")
    assert code == 1
    reasons = [line for line in out.splitlines() if line.startswith("error: ")]
    assert len(reasons) == 2
    assert out.splitlines()[-1].startswith("2 errors, ")


def test_the_tension_of_its_design_is_beside_a_robot(tmp_path: Path) -> None:
    """Oracles: the score.json of a design and of another robot, for the network and for an alternative."""
    robot = near_the_edge()
    card = {"robot": robot_hash(robot), "alternatives": [{"robot": "other"}], "tension_limit": 12.5, "motor": "xl330"}
    out = tmp_path / "out"
    (out / "alternatives").mkdir(parents=True)
    (out / "score.json").write_text(json.dumps(card))
    assert designed_tension(robot, out / "robot") == 12.5
    assert designed_motor(robot, out / "robot") == "xl330"
    assert designed_motor(replace(robot, motor="n20"), out / "robot") == "auto"
    assert designed_motor(robot, tmp_path / "alone") == "auto"
    open_card = card | {"motor": "auto", "craft": {"motor": "sts3215"}}
    (tmp_path / "open").mkdir()
    (tmp_path / "open" / "score.json").write_text(json.dumps(open_card))
    assert [kit_motor(robot, tmp_path / place / "robot") for place in ("open", "out", "alone")] == [
        "sts3215",
        "xl330",
        "auto",
    ]
    assert designed_tension(robot.with_network(robot.winches, robot.cables[:1]), out / "robot") is None
    assert designed_tension(robot, tmp_path / "alone" / "robot" / "deep") is None
    card |= {"robot": "other", "alternatives": [{"robot": robot_hash(robot)}]}
    (out / "score.json").write_text(json.dumps(card))
    assert designed_tension(robot, out / "alternatives" / "01") == 12.5
    (out / "score.json").write_text("{")
    assert designed_tension(robot, out / "robot") is None
    limited = replace(robot, max_tension=4.0, max_torque=0.02)
    assert (designed_tension(limited, tmp_path / "copy"), designed_torque(limited, tmp_path / "copy")) == (4.0, 0.02)


def test_a_robot_of_the_studio_keeps_to_the_limit_that_it_had_there(tmp_path: Path) -> None:
    """Oracle: the wish; by its kit in the studio no cable is pulled harder either."""
    robot = near_the_edge()
    Work(robot=robot).save(tmp_path / "usual")
    assert designed_tension(robot, tmp_path / "usual") == Wishes().constraints.tension
    Work(robot=robot, wishes=Wishes.of(tension=7.5)).save(tmp_path / "weak")
    assert designed_tension(robot, tmp_path / "weak") == designed_tension(robot, tmp_path / "weak/robot.toml") == 7.5
    (tmp_path / "weak" / "studio.json").write_text("{")
    with pytest.raises(InputError, match=r"^studio\.json: .*\. Fix the file, or set the limit with --tension"):
        designed_tension(robot, tmp_path / "weak")
    save_robot(replace(robot, max_tension=4.0), tmp_path / "designed")
    opened = Work.open(tmp_path / "designed")
    assert opened.wishes == Wishes.of(tension=4.0)
    Work(robot=opened.robot, wishes=Wishes.of(tension=7.5)).save(tmp_path / "designed")
    assert designed_tension(opened.robot, tmp_path / "designed") == 7.5
    Work(robot=robot.with_network((), ())).save(tmp_path / "bare")
    assert not (tmp_path / "bare" / "studio.json").exists()


@pytest.mark.slow
def test_a_kit_keeps_to_a_tension(run: Run, tmp_path: Path, starfish: Path) -> None:
    """Oracle: the largest tension of its list: of the 3 N that the studio kept to, and more if the command says so."""
    largest, robot = {}, tmp_path / "robot"
    Work(robot=load_robot(starfish), wishes=Wishes.of(tension=3.0)).save(robot)
    for limit, asked in {"3 N": (), "200 N": ("--tension", "200 N")}.items():
        code, out, _ = run("fabricate", robot, *asked, "--force", "--out", tmp_path / limit[0])
        assert code == 0
        assert ("Cable tension: at most 3 N, the limit of" in out) == (not asked)
        text = (tmp_path / limit[0] / "lists" / "line_strength.csv").read_text()
        rows = [row for row in csv.reader(text.splitlines()) if row and re.fullmatch(r"C\d+", row[0])]
        largest[limit] = max(float(row[2]) for row in rows)
        assert json.loads((tmp_path / limit[0] / "manifest.json").read_text())["options"]["tension"] == float(
            limit[:-2]
        )
    assert largest["3 N"] <= 3.01 < largest["200 N"]


@pytest.mark.slow
def test_force_builds_it_and_says_why_not(run: Run, tmp_path: Path) -> None:
    save_robot(near_the_edge(), tmp_path / "robot")
    code, out, _ = run("fabricate", tmp_path / "robot", "--force", "--out", tmp_path / "kit")
    assert code == 0
    assert out.count("error: ") == 2
    assert (tmp_path / "kit" / "assembly_sheet.pdf").is_file()


@pytest.mark.slow
def test_a_budget_refuses_and_names_the_cheapest_way(run: Run, tmp_path: Path) -> None:
    """Oracle: the cost in whole packs of the kit without a budget, and the prices in its table of motors."""
    robot = gallery_robot("finger")
    save_robot(replace(robot, poses={}), tmp_path / "robot")
    code, out, _ = run("fabricate", tmp_path / "robot", "--motor", "25d", "--out", tmp_path / "kit")
    assert code == 0
    cost = int(re.findall(r"full packs\): (\d+) USD", out)[0])
    rows = [line.split("│")[1:5] for line in out.splitlines() if "│" in line]
    assert {row[0].strip() for row in rows} == {motor.key for motor in ALL_MOTORS}
    assert [row[3].strip().split(",")[0] for row in rows if row[0].strip() == "25d"] == ["chosen"]
    code, out, _ = run(
        "fabricate", tmp_path / "robot", "--motor", "25d", "--budget", f"{cost - 1} USD", "--out", tmp_path / "less"
    )
    assert code == 2
    assert not (tmp_path / "less").exists()
    assert f"costs {cost} USD in whole packs" in out
    ((motor, least),) = re.findall(r"With --motor (\S+) it costs about (\d+) USD", out)
    prices = {row[0].strip(): int(row[1].split()[0]) for row in rows}
    by_name = {"xc330", "st3020", "scs0009"}  # never chosen by auto
    assert motor == min(prices.keys() - by_name, key=prices.__getitem__)
    assert int(least) == pytest.approx(cost - prices["25d"] + prices[motor], abs=2)
    assert f"--motor {motor} --budget {cost - 1}USD" in out


@pytest.mark.parametrize(
    ("motor", "board", "words"),
    [("foo", "uno", 'unknown motor "foo"'), ("sts3215", "uno", "drives no bus servos"), ("xl330", "mega", "needs no")],
)
def test_motor_and_board_are_checked_before_the_robot_is_read(
    run: Run, tmp_path: Path, motor: str, board: str, words: str
) -> None:
    """Oracle: robot.toml is empty, which is an error of its own once it is read."""
    (tmp_path / "robot.toml").write_text("")
    code, _, err = run("fabricate", tmp_path, "--motor", motor, "--board", board, "--out", tmp_path / "kit")
    assert code == 2
    assert words in err


def test_servos_that_lose_their_zeros_are_named_and_stand_on_the_sheet(
    run: Run, tmp_path: Path, starfish: Path
) -> None:
    """By hand: spools of 6 mm take in 37.7 mm a turn, travels are larger."""
    options = ("--motor", "sts3215", "--board", "esp32s3", "--force", "--out", tmp_path / "kit")
    code, out, _ = run("fabricate", starfish, *options)
    words = "n an esp32s3 servos lose their zeros without power: right, left and feet turn up to"
    remedy = "Write travel and release of 33 mm in all into robot.toml, or use a spool radius of at least"
    assert (code, out.count(f"warning: o{words}"), out.count(remedy)) == (0, 1, 1)
    assert f"O{words}" in (tmp_path / "kit" / "steps.txt").read_text(encoding="utf-8")
    assert tell_zero_loss(load_robot(starfish), "n20") == ""


def test_zeros_last_where_travel_is_short(starfish: Path) -> None:
    """By hand: a spool of 6 mm takes in 37.7 mm a turn, less 2 mm at each end; poses that use more need a spool.

    Where winches differ, each has its own remedy: 75.4 mm a turn of the second, 125.7 mm of the third, which lasts.
    """
    robot = load_robot(starfish)
    for travel, taken, told in (
        (
            0.06,
            (0.0, 0.01, 0.02),
            "into robot.toml (poses and release use 20 mm), or use a spool radius of at least 10.2 mm",
        ),
        (0.06, (0.0, 0.01, 0.04), "at each end. Use a spool radius of at least 10.2 mm"),
        (0.033, (0.0, 0.01, 0.02), ""),
    ):
        winches = tuple(replace(winch, spool_radius=0.006, travel=travel, release=0.0) for winch in robot.winches)
        assert tell_zero_loss(replace(robot, winches=winches), "sts3215", taken).endswith(told)
        assert tell_zero_loss(replace(robot, winches=winches), "scs0009", taken) == ""
    assert tell_zero_loss(replace(robot, winches=winches), "sts3215", taken) == ""
    own = zip(robot.winches, (0.006, 0.012, 0.02), (0.06, 0.09, 0.09), strict=True)
    winches = tuple(replace(winch, spool_radius=r, travel=most, release=0.0) for winch, r, most in own)
    first, second = (f"for {winch.name}" for winch in winches[:2])
    told = tell_zero_loss(replace(robot, winches=winches), "sts3215", (0.02, 0.08, 0.0))
    assert told.endswith(
        f" 33 mm in all into robot.toml {first} (poses and release use 20 mm), or use a spool radius of at least "
        f"10.2 mm. Use a spool radius of at least 15.0 mm {second}"
    )


def test_the_robots_own_motor_is_checked_with_the_board_before_its_loads() -> None:
    robot, stages = replace(gallery_robot("finger"), motor="sts3215"), []
    with pytest.raises(InputError, match="drives no bus servos"):
        build_kit(robot, options=KitOptions(board="uno"), progress=lambda *stage: stages.append(stage))
    assert stages == []


@pytest.mark.parametrize("text", ["120 EUR", "0 USD", "-5USD", "much", "nan USD"])
def test_a_budget_is_an_amount_of_dollars(run: Run, tmp_path: Path, text: str) -> None:
    code, _, err = run("fabricate", "gallery:finger", f"--budget={text}", "--out", tmp_path / "kit")
    assert code == 2
    assert "e.g. 120USD" in err


def test_a_budget_below_the_motors_stops_a_design(run: Run, tmp_path: Path) -> None:
    """Oracle: two STS3215 with boards and power are 59 USD (test_power)."""
    code, _, err = run(
        "design", "gallery:finger", "--winches", "2", "--cables", "2", "--budget", "50USD", "--out", tmp_path / "design"
    )
    assert code == 2
    assert "2 motors with boards and power cost at least 59 USD (sts3215)" in err


def test_a_better_network_that_a_kit_refuses_is_named() -> None:
    """Oracle: errors by hand, and the reasons of `find_refusals` for a robot whose kit is refused."""
    robot = near_the_edge()
    others = tuple(Alternative(robot=robot, ik_results=(), expected_error=error) for error in (0.005, 0.004, 0.003))
    network = cast(Network, SimpleNamespace(alternatives=others, expected_error=0.006))
    found = find_refused_better(network)
    assert found is not None
    assert (found[0], found[1]) == (others[2], find_refusals(robot, Demand.of_results(robot, []))[0])
    assert find_refused_better(cast(Network, SimpleNamespace(alternatives=others, expected_error=0.0032))) is None


def test_design_and_fabricate_judge_one_budget(run: Run, tmp_path: Path) -> None:
    """Oracle: the sentence of `fabricate --summary`, a dollar below the price of the whole kit."""
    robot = replace(near_the_edge(), poses={})
    save_robot(robot, tmp_path / "robot")
    values = {"robot": robot, "source": robot, "alternatives": (), "constraints": Constraints()}
    network = cast(Network, SimpleNamespace(**values))
    assert find_over_budget(network, None) == ()
    over = find_over_budget(network, 1.0)
    (said,) = over
    (cost,) = (int(each) for each in re.findall(r"costs (\d+) USD in whole packs", said))
    assert "No cheaper motor than" in said
    assert said.rstrip().endswith("fits")
    assert cost > BuildCost.of_robot(robot, []).price + 5  # the body comes on top
    assert find_over_budget(network, cost + 1) == ()
    tried = design_remedy(network, tmp_path / "robot", Path("out"), budget=1.0, over=over)
    assert tried == f"hydrostat fabricate out/robot --budget {cost + 1}USD --out out/kit"
    three = replace(robot, winches=tuple(replace(robot.winches[0], name=name) for name in "abc"), cables=())
    said = "the kit costs 256 USD in whole packs (body 18, winches 193), more than the budget of {} USD. No cheaper"
    for budget, way in ((200.0, "--winches 2 --two-way --budget 200USD"), (5.0, "fabricate robot --budget 257USD")):
        options, reasons = KitOptions(budget=budget), [said.format(budget)]
        assert way in kit_remedy(three, Path("robot"), Path("kit"), options=options, reasons=reasons)
    _, out, _ = run("fabricate", tmp_path / "robot", "--budget", f"{cost - 1}USD", "--summary")
    assert f"costs {cost} USD in whole packs" in out


def test_a_body_without_room_for_motors_is_told_how_large_it_must_be() -> None:
    """Oracle: the reasons of the larger body, and of one that is 0.8 times as large as that."""
    robot, options = scaled_robot(gallery_robot("starfish"), 0.5), KitOptions(motor="n20")
    reasons = find_refusals(robot, options=options)
    note = note_room(robot, "tiny", options=options, reasons=reasons)
    assert note.startswith("note: a body 1.25 times as large has room for n20: hydrostat scale tiny 1.25")
    assert not any("smaller motor" in each for each in find_refusals(scaled_robot(robot, 1.25), options=options))
    assert note_room(robot, "tiny", options=options, reasons=["the cloth is red"]) == ""
    tiny = scaled_robot(robot, 0.2)
    told = kit_remedy(tiny, Path("tiny"), Path("kit"), options=options, reasons=["choose a smaller motor"])
    assert told == "", "no design has room"


def test_a_pair_of_cables_is_counted_once_and_sewn_twice() -> None:
    robot = replace(gallery_robot("starfish"), face=CableSide.PAIRS)
    assert count_cables(robot) == "5 pairs of cables, 10 to sew"
    assert count_cables(replace(robot, face=CableSide.FRONT)) == "5 cables"


def test_a_body_that_cannot_cure_in_its_mould_is_poured_into_a_printed_one() -> None:
    reasons = ["ecoflex 00-30 does not cure against Mold Max 30. Print the mold (--mould printed)"]
    tried = kit_remedy(near_the_edge(), Path("robot"), Path("kit"), options=KitOptions(), reasons=reasons)
    assert tried == "hydrostat fabricate robot --mould printed --out kit"
