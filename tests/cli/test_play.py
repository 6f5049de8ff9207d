"""`hydrostat play`. Oracles: exit codes, a clock that waits for nobody, real signals, and what each line says."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from own_time import PROGRAM, run_in_own_time

from hydrostat.cli.design_results import kit_motor
from hydrostat.cli.play_camera import require_rest
from hydrostat.control import Calibration, Motors, SimulatedLink
from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import Motor
from hydrostat.robot import Winch, gallery_folder, load_robot, robot_hash, save_robot

Run = Callable[..., tuple[int, str, str]]

WAVE = "time_s,left,feet\n0,3,0\n0.3,9,4.5\n0.6,3,0\n"


@pytest.fixture
def wave(tmp_path: Path) -> Path:
    path = tmp_path / "wave.csv"
    path.write_text(WAVE)
    return path


@pytest.mark.slow
def test_it_plays_in_real_time_and_says_that_it_is_simulated(run: Run, starfish: Path, wave: Path) -> None:
    began = time.monotonic()
    code, out, err = run("play", starfish, wave, "--repeat", 2, "--speed", 0.5)
    assert time.monotonic() - began > 2.4
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert all(line.startswith("simulated: ") for line in lines)
    assert lines[0] == f"simulated: {wave} on starfish, 3 winches: 0.60 s, 2 times, at 0.5x"
    assert "round 1 of 2" in lines[1]
    assert lines[-1] == "simulated: finished; motors holding at right 0.0 mm, left 3.0 mm, feet 0.0 mm"


@pytest.mark.slow
def test_it_plays_on_emulated_motors(starfish: Path, wave: Path) -> None:
    code, out, err = run_in_own_time("play", starfish, wave, "--motors", "emulated", "--speed", 0.5)
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert all(line.startswith("emulated: ") for line in lines)
    assert any(line.endswith("left: motor 2, XL330-M288, firmware 52, stops by itself") for line in lines)
    played = next(line for line in lines if "finished" in line)
    places = [float(word) for word in re.findall(r"(-?[0-9.]+) mm", played)]
    assert places == pytest.approx([0.0, 3.0, 0.0], abs=0.4)
    assert [line.rpartition(" s: ")[2] for line in lines[-3:-1]] == ["stopped", "closed"], "and by nobody's hand"


def test_motors_toml_remembers_the_motor(starfish: Path, tmp_path: Path) -> None:
    """Oracle: the motor that the file is written with, where robot.toml and designs name none."""
    folder = shutil.copytree(starfish, tmp_path / "robot")
    robot = load_robot(folder)
    usual = Calibration.usual(robot)
    usual.write(folder)
    assert kit_motor(robot, folder) == "auto"
    Calibration(tuple(replace(motor, model="sts3215") for motor in usual.motors)).write(folder)
    assert Calibration.read(folder, robot).model == "sts3215"
    assert kit_motor(robot, folder) == "sts3215"
    assert kit_motor(replace(robot, motor="n20"), folder) == "n20"
    with pytest.raises(InputError, match='unknown motor "sts"'):
        replace(usual.motors[0], model="sts")
    motors = folder / "motors.toml"
    motors.write_text(motors.read_text().replace("sts3215", "sts321", 1))
    with pytest.raises(InputError, match=r'motors\.toml: unknown motor "sts321"\. .* Did you mean "sts3215"'):
        kit_motor(robot, folder)


@pytest.mark.slow
def test_it_emulates_the_motor_of_the_design(starfish: Path, wave: Path, tmp_path: Path) -> None:
    """Oracle: the motor in score.json next to a robot that names none."""
    robot = shutil.copytree(starfish, tmp_path / "robot")
    card = {"robot": robot_hash(load_robot(robot)), "alternatives": [], "motor": "xc330"}
    (tmp_path / "score.json").write_text(json.dumps(card))
    code, out, err = run_in_own_time("play", robot, wave, "--motors", "emulated")
    assert (code, err) == (0, "")
    assert 'emulated: motors are XC330-M288 (motor = "xc330" of motors.toml or its design)' in out


@pytest.mark.parametrize(
    ("port", "told"),
    [
        ("nonsense", "--motors nonsense: write emulated, or one such as dynamixel:/dev/ttyUSB0"),
        ("dynamixel:", "--motors dynamixel:: write emulated"),
        ("dynamixel:/dev/ttyUSB0@fast", "the baud rate after @ must be a number"),
        ("dynamixel:/dev/ttyUSB0", "has no motors.toml; `hydrostat calibrate` makes it"),
    ],
)
def test_ports_that_are_none(run: Run, starfish: Path, wave: Path, port: str, told: str) -> None:
    code, _, err = run("play", starfish, wave, "--motors", port)
    assert code == 2
    assert told in err


@pytest.mark.slow
def test_on_a_terminal_one_line_is_updated(starfish: Path, wave: Path) -> None:
    import pty

    ours, theirs = pty.openpty()
    words = ["play", str(starfish), str(wave)]
    work = subprocess.Popen([sys.executable, "-c", PROGRAM, *words], stdout=theirs, stderr=theirs)
    os.close(theirs)
    told = b""
    while work.poll() is None or told.count(b"\n") < 3:
        try:
            told += os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
    os.close(ours)
    assert work.wait(300) == 0
    words = [line.strip() for line in re.split(r"[\r\n]+", told.decode()) if line.strip()]
    assert all(line.startswith("simulated: ") for line in words)
    assert words[-1].startswith("simulated: finished")
    assert told.count(b"\rsimulated: ") >= 3


@pytest.mark.parametrize(
    ("number", "code", "ignored"),
    [
        (signal.SIGINT, 130, False),
        (signal.SIGINT, 130, True),
        (signal.SIGTERM, 143, False),
        (signal.SIGHUP, 129, False),
    ],
    ids=["interrupt", "in the background", "terminate", "hang up"],
)
@pytest.mark.slow
def test_a_signal_stops_the_motors(starfish: Path, wave: Path, number: int, code: int, ignored: bool) -> None:
    """Also in the background of a script, where SIGINT comes ignored."""

    def begin() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN if ignored else signal.SIG_DFL)
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # tests may run under nohup

    work = subprocess.Popen(
        [sys.executable, "-uc", PROGRAM, "play", str(starfish), str(wave), "--repeat", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=begin,
    )
    assert work.stdout is not None
    lines = [work.stdout.readline() for _ in range(2)]
    assert "round 1:" in lines[1]
    time.sleep(0.3)
    work.send_signal(number)
    printed, beside = work.communicate(timeout=300)
    assert (work.returncode, beside) == (code, "")
    last = printed.splitlines()[-1]
    assert re.fullmatch(r"simulated: stopped at \d\.\d\d s; motors holding at right 0\.0 mm, left .*", last)


def test_an_error_while_playing_stops_the_motors(
    run: Run, starfish: Path, wave: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stops = []

    def refuse(*arguments: object, **options: object) -> None:
        raise HydrostatError("the line is broken")

    monkeypatch.setattr(SimulatedLink, "send", refuse)
    monkeypatch.setattr(SimulatedLink, "stop", lambda self: stops.append(self))
    code, _, err = run("play", starfish, wave)
    assert code == 1
    assert err == "hydrostat: error: simulated: motors stopped at 0.00 s: the line is broken\n"
    assert stops


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (None, (), "wave.csv: there is no such file"),
        ("time_s,tail\n0,1\n", (), 'wave.csv, line 1: unknown winch "tail". Available: right, left, feet.'),
        ("time_s,left\n0,1\n1,\n", (), 'wave.csv, line 3, column left: write a number of millimeters, not ""'),
        ("time_s,left\n0,1\n1,99\n", (), "wave.csv, line 3, column left: 99 mm is beyond what the winch can take in"),
        ("time_s,left\n0,0\n1,50\n", ("--speed", 4), "line 3, column left: moves at 200 mm/s, the motors at 150 mm/s"),
        (WAVE, ("--speed", 9), "--speed 9: the speed must be from 0.1 to 4 times, not 9"),
        (WAVE, ("--repeat", -1), "--repeat -1: must be 0 or more"),
    ],
)
def test_one_clear_line(
    run: Run, starfish: Path, tmp_path: Path, text: str | None, options: tuple[object, ...], words: str
) -> None:
    path = tmp_path / "wave.csv"
    if text is not None:
        path.write_text(text)
    code, out, err = run("play", starfish, path, *options)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert words in err


@pytest.mark.slow
def test_a_robot_without_winches_is_refused(run: Run, tmp_path: Path, wave: Path) -> None:
    drawing = tmp_path / "box.svg"
    drawing.write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><path d="M0 0H60V40H0Z"/></svg>')
    assert run("new", tmp_path / "box", "--from", drawing, "--size", "60 mm")[0] == 0
    code, _, err = run("play", tmp_path / "box", wave)
    assert code == 2
    assert "no winches. Add" in err


def test_a_table_too_fast_for_the_motors_is_refused_before_they_are_armed(
    run: Run, starfish: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """100 mm/s: simulated motors can, those of a link (60 mm/s) cannot."""
    armed = list[object]()
    monkeypatch.setattr("hydrostat.control.arm_motors", lambda *_, **__: armed.append(1))
    table = tmp_path / "fast.csv"
    table.write_text("time_s,left\n0,0\n0.1,10\n")
    code, _, err = run("play", starfish, table, "--motors", "emulated")
    assert (code, armed) == (2, [])
    assert "moves at 100 mm/s, the motors at 60 mm/s at most" in err


@pytest.mark.parametrize(
    "words",
    [("play", "wave.csv"), ("drive", "--source", "osc:0"), ("mimic", "--glove", "emulated", "--out", "out")],
    ids=["play", "drive", "mimic"],
)
def test_signals_are_caught_from_before_motors_are_armed(
    run: Run, starfish: Path, wave: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    """Arming tries watchdogs, and turns motors: SIGTERM must not end the program then without a word to them."""
    caught = list[object]()

    def armed(*_: object, **__: object) -> None:
        caught.append(signal.getsignal(signal.SIGTERM))
        raise HydrostatError("no motors here")

    monkeypatch.setattr("hydrostat.control.arm_motors", armed)
    monkeypatch.chdir(wave.parent)
    before = signal.getsignal(signal.SIGTERM)
    code, _, err = run(words[0], starfish, *words[1:], "--motors", "emulated")
    assert (code, "no motors here" in err) == (1, True)
    assert caught != [before]
    assert callable(caught[0])


@pytest.mark.parametrize(("place", "is_refused"), [(0.0019, False), (0.0021, True), (-0.0021, True)])
def test_a_camera_begins_at_rest(place: float, is_refused: bool) -> None:
    winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=0.006, travel=0.04, release=0.005) for name in ("a", "b")]
    places = np.array([0.0, place])
    motors = Motors(winches, SimulatedLink(places), places=places)
    with pytest.raises(InputError, match=f"b stands at {1e3 * place:.1f} mm") if is_refused else nullcontext():
        require_rest(motors)


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--camera", 0), 2, "--camera: simulated motors move no robot. Add --motors."),
        (("--camera", 0, "--motors", "emulated", "--lag", "2s"), 2, "--lag 2s: must be 500 ms or less"),
        (("--camera", 0, "--motors", "emulated", "--lost", "run"), 2, "--lost"),
        (("--camera", 0, "--motors", "emulated"), 2, "photographs need OpenCV"),
    ],
)
def test_a_camera_that_cannot_correct_is_refused(
    run: Run,
    starfish: Path,
    wave: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: tuple[object, ...],
    code: int,
    words: str,
) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    found, _, err = run("play", starfish, wave, *options)
    assert (found, err.count("\n")) == (code, 1)
    assert words in err


def test_firmware_keeps_the_motor_that_is_known(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: options of the command: a servo is kept, and counts of a motor without a name clear it."""
    own = Path(shutil.copytree(starfish, tmp_path / "own"))
    for options, model in (
        (("--motor", "st3020", "--board", "esp32s3"), "st3020"),
        (("--board", "esp32s3"), "st3020"),
        (("--counts", "900", "--board", "mega"), None),
        (("--motor", "25d", "--board", "mega"), "25d"),
    ):
        assert run("firmware", own, *options, "--out", tmp_path / "made")[0] == 0
        assert Calibration.read(own, load_robot(own)).model == model


def test_firmware_follows_robot_toml_or_names_the_contradiction(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the motor that robot.toml names, with and without another in the command."""
    own = Path(shutil.copytree(starfish, tmp_path / "own"))
    robot = load_robot(own)
    save_robot(replace(robot, motor="n20"), own)
    for options, motor in (((), "n20"), (("--motor", "25d"), "25d"), (("--motor", "n20"), "n20")):
        code, out, _ = run("firmware", own, *options, "--out", tmp_path / "made")
        assert (code, Motor.choose(motor).title in out) == (0, True)
        told = 'warning: motor 25d of this firmware contradicts motor = "n20" in robot.toml, which calibrate and play'
        assert (told in out) == (motor == "25d")


def test_a_board_drives_the_servos_of_feetech_alone(run: Run, starfish: Path, tmp_path: Path) -> None:
    """An ESP32-S3 gets a sketch for the servo of the command, of robot.toml or of motors.toml; other boards none."""
    made, own = tmp_path / "made", Path(shutil.copytree(starfish, tmp_path / "own"))
    for option, told in (
        (("--motor", "xl330"), "boards drive no Dynamixel servos. Run `hydrostat play ROBOT MOVES --motors dynamixel:"),
        (("--motor", "scs0009", "--board", "mega"), "--board mega drives no bus servos. Use --board esp32s3"),
        (("--motor", "scs0009", "--counts", "4000"), "--counts: a scs0009 has 1228.8. Remove it."),
        (("--motor", "st3020", "--board", "esp32s3,esp32s3"), "one board drives up to 16 servos. Use --board esp32s3."),
        (("--board", "mega2"), '--board mega2: unknown board. Available: uno, mega, esp32s3. Did you mean "mega"?\n'),
        (("--motor", "st3020", "--board", "mega2"), "--board mega2: unknown board."),
        (
            ("--motor", "st3020,sts3215"),
            'Available: n20, 25d, sts3215, sts3215-12v, st3020, scs0009. Did you mean "sts3215"?\n',
        ),
        (("--motor", "scs0009"), "degrees for its travel, scs0009 turns by 280. Choose another motor, or a spool"),
    ):
        code, _, err = run("firmware", own, *option, "--out", made)
        assert (code, err.count("\n")) == (2, 1)
        assert told in err
    assert not made.exists()
    assert not (own / "motors.toml").exists()
    dance = tmp_path / "dance.csv"
    dance.write_text("time_s\n0\n2\n")
    given = ("firmware", own, "--moves", dance, "--min-supply", "6", "--out", made)
    code, out, _ = run(*given, "--motor", "st3020", "--board", "esp32s3")
    assert code == 0
    assert "3 servos on a bus adapter, GND to GND, for UART." in out
    assert "Waveshare: its TX to pin 17, RX to 18. Seeed: its RX to pin 17, TX to 18." in out
    assert "Motors stop below 6 V, as the servos measure it." in out
    assert "Button BOOT (pin 0) plays and stops it" in out
    assert re.search(
        r"No zeros in the sketch: right, left and feet turn up to 1\.\d\d times\. .* at each end\. Write travel and "
        r"release of 33 mm in all into robot\.toml, or use a spool radius of at least .*\n"
        r"Calibrate from a computer after",
        out,
    )
    settings = (made / "winches" / "settings.h").read_text()
    assert "#define FEETECH 1" in settings
    assert "#define MOVE_ROWS 52" in settings
    assert sorted(path.name for path in (made / "winches").iterdir()) == [
        "esp32s3.h", "feetech.h", "moves.h", "settings.h", "winches.cpp", "winches.ino",
    ]  # fmt: skip
    motors = own / "motors.toml"
    assert motors.read_text().count("counts = 4096.0") == 3
    code, out, _ = run(*given)  # what motors.toml says
    assert (code, (made / "winches" / "settings.h").read_text().count("FEETECH")) == (0, 1)
    large = motors.read_text().replace('radius = "6 mm"', 'radius = "20 mm"')
    motors.write_text(large)
    told = "spool radius 20 mm in motors.toml, 6 mm in robot.toml"
    code, out, _ = run(*given)
    assert (code, "No zeros in the sketch: not calibrated." in out, out.count(told)) == (0, True, 3)
    motors.write_text(large.replace("turns = 1", "zero = 1.0\nturns = 1"))
    code, out, _ = run(*given)
    assert (code, "Zeros are in the sketch" in out) == (0, True)
    file = own / "robot.toml"
    file.write_text(file.read_text().replace("format = 1", 'format = 1\nmotor = "scs0009"', 1))
    code, out, _ = run(*given)
    assert (code, "SCS0009" in out) == (0, True)
    assert out.count("counts 4096 replaced by 1228.8, and its zero is removed") == 3
    assert "zero" not in re.sub("#.*", "", motors.read_text())  # steps of other servos


def test_boards_turn_no_drives(run: Run, tmp_path: Path) -> None:
    code, _, err = run("firmware", gallery_folder("emio"), "--out", tmp_path / "made")
    assert code == 2
    assert 'drives, such as "front", are not available in firmware' in err
    assert not (tmp_path / "made").exists()
