"""The page of a toy on Web Serial: a browser whose port is a stand-in for emulated motors. Oracle: these motors."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from math import inf, pi
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from emulated_board import BoardMotor, EmulatedBoard

from hydrostat.control import Calibration, EmulatedChain, EmulatedServo, robot_word
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.feetech_bus import find_filler
from hydrostat.learning import Perceptrons
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.toy import LearnedShape, toy_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

STAND_IN = """
const port = {
  async open({ baudRate }) {
    window.baud = baudRate;
    this.readable = new ReadableStream({ start: (to) => { this.to = to; } });
    this.writable = new WritableStream({
      write: async (bytes) => {
        const told = await window.boardWrite(Array.from(bytes));
        if (window.stopWhileArming && /^\\d+ A /.test(new TextDecoder().decode(bytes))) {
          window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
        }
        if (told === null) throw new Error("gone");
        if (told.length) this.to.enqueue(Uint8Array.from(told));
      },
      close: () => { window.written = (window.written ?? 0) + 1; }, // all that was told has left
    });
  },
  async close() {
    if (this.readable.locked || this.writable.locked) throw new Error("locked");
    window.closedPorts = (window.closedPorts ?? 0) + 1;
  },
};
Object.defineProperty(navigator, "serial", { value: { requestPort: async () => port } });
"""

HIDE = """() => {
  Object.defineProperty(document, "hidden", { value: true, configurable: true });
  document.dispatchEvent(new Event("visibilitychange"));
}"""
SLEEP = "() => { window.write = window.boardWrite; window.boardWrite = async () => []; }"
"""Nothing leaves the computer any more, nor does it say so."""
WAKE = """() => {
  Object.defineProperty(document, "hidden", { value: false, configurable: true });
  window.boardWrite = window.write ?? window.boardWrite;
}"""

COUNTS = 1000.0

Connect = Callable[..., "Page"]


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot(gallery_folder("starfish"))


@pytest.fixture(scope="module")
def motors(robot: Robot) -> Calibration:
    usual = Calibration.usual(robot)
    curves = ((), (), ((10.0, 0.09),))  # layers of the last spool wind it wider than its radius
    counted = zip(usual.motors, curves, strict=True)
    return Calibration(tuple(replace(each, counts=COUNTS, zero=0.5, curve=curve) for each, curve in counted))


@pytest.fixture(scope="module")
def text(robot: Robot, motors: Calibration) -> str:
    return _text(robot, motors)


def _text(robot: Robot, motors: Calibration, *, forged: float = 1.0, moved: float = 0.0, silent: int = 1500) -> str:
    """A page with motors; its shape moves as a whole by so much [m] for each winch. Its ranges may be forged."""
    winches = robot.winches
    shape = LearnedShape(
        low=np.array([-each.release for each in winches]),
        high=np.array([forged * each.travel for each in winches]),
        network=Perceptrons.of_layers([(moved * np.eye(3), np.zeros(3))]),
        mean=robot.body.mesh.nodes,
        basis=np.stack(
            [np.broadcast_to(way, robot.body.mesh.nodes.shape) for way in ((1.0, 0), (0, 1.0), (-1.0, -1.0))]
        ),
        samples=1,
        held_out=1,
        error=0.0,
        worst=0.0,
        moved=0.0,
        stopped=False,
    )
    module = import_module("hydrostat.toy.toy_page")
    script = module._script().replace("SILENT = 160", f"SILENT = {silent}")  # a busy machine is not a silent board
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_script", lambda: script)
        return toy_page(robot, shape, motors=motors)


@pytest.fixture
def board(robot: Robot, motors: Calibration) -> EmulatedBoard:
    most = 0.06 / 0.006
    made = EmulatedBoard([BoardMotor(counts=COUNTS, most=most) for _ in robot.winches], robot_word(robot, motors))
    made.marked = True
    return made


@pytest.fixture
def connect(browser: "Browser", text: str, tmp_path: Path) -> "Iterator[Connect]":
    """Open the page with motors behind its port, whose time is that of the clock, and press Connect."""
    contexts, lost = [], list[bool]()

    def open_page(board: EmulatedChain, text: str = text, name: str = "Connect") -> "Page":
        clock = [time.monotonic()]
        # Others than Feetech's hold in silence, and a busy machine is none.
        longest = inf if isinstance(board, EmulatedFeetechChain) else 0.15

        def write(data: list[int]) -> list[int] | None:
            now = time.monotonic()
            board.wait(min(now - clock[0], longest))
            clock[0] = now
            with suppress(OSError):
                board.write(bytes(data))
                answer = list(board.read(10_000))
                return [] if lost and lost.pop() else answer
            return None

        (tmp_path / "toy.html").write_text(text, encoding="utf-8")
        context = browser.new_context()
        contexts.append(context)
        page = context.new_page()
        page.expose_function("loseAnswer", lambda: lost.append(True))
        page.expose_function("boardWrite", write)
        page.add_init_script(STAND_IN)
        page.goto((tmp_path / "toy.html").as_uri())
        page.get_by_role("button", name=name).click()
        return page

    yield open_page
    for context in contexts:
        context.close()


def _wait(page: "Page", truth: Callable[[], bool]) -> None:
    for _ in range(600):
        if truth():
            return
        page.wait_for_timeout(50)
    pytest.fail("never true; the page says: " + page.locator("#motors p").inner_text())


def _hold(page: "Page") -> None:
    zero, button = (page.get_by_role("button", name=name) for name in ("Set zero", "Hold to arm"))
    _wait(page, lambda: zero.is_visible() or button.is_visible())
    if zero.is_visible():
        zero.click()
    _wait(page, button.is_visible)
    button.hover()
    page.mouse.down()


def _says(page: "Page", words: str) -> Callable[[], bool]:
    return lambda: words in page.locator("#motors p").inner_text()


def _arm(page: "Page", board: EmulatedChain) -> None:
    _hold(page)
    _wait(page, lambda: getattr(board, "state", "armed") == "armed" and page.locator("#motors .armed").is_visible())
    page.mouse.up()


def _turn(page: "Page", winch: int, millimeters: float) -> None:
    page.locator(".knob input").nth(winch).fill(str(millimeters))


def _drive(page: "Page", board: EmulatedChain, winch: int, millimeters: float, truth: Callable[[], bool]) -> None:
    """Turn a knob and wait; where the page was late, on a busy machine, arm and turn again."""
    for _ in range(10):
        if not page.locator("#motors .armed").is_visible():
            _arm(page, board)
        _turn(page, winch, millimeters)
        for _ in range(200):
            if truth():
                return
            if _says(page, "was late")():
                break
            page.wait_for_timeout(50)
    pytest.fail("never true; the page says: " + page.locator("#motors p").inner_text())


def test_the_robot_follows_the_page_and_stops_when_it_is_hidden(connect: Connect, board: EmulatedBoard) -> None:
    page = connect(board)
    _hold(page)
    page.wait_for_timeout(250)  # too short a press
    page.mouse.up()
    page.wait_for_timeout(900)
    assert board.state == "off"
    wanted = COUNTS * 0.012 / (2 * pi * 0.006)
    _drive(page, board, 0, 12.0, lambda: abs(board.motors[0].count - wanted) < 2)
    assert [motor.count for motor in board.motors[1:]] == [0, 0]
    _drive(page, board, 1, 60.0, lambda: board.motors[1].count > 20)
    page.evaluate(HIDE)
    _wait(page, _says(page, "page was hidden"))  # a busy machine may be late by more than the wait below
    page.wait_for_timeout(100)
    before = board.motors[1].count
    board.wait(1.0)
    assert board.motors[1].count - before <= 2


def test_motors_stand_within_a_quarter_second_of_closing(connect: Connect, board: EmulatedBoard) -> None:
    page = connect(board)
    _drive(page, board, 2, 60.0, lambda: board.motors[2].count > 20)
    assert 0.055 < 0.009 * board.motors[2].pace <= 0.06  # speed of the cable where the spool is wound wider [m/s]
    page.close()
    board.wait(0.25)
    before = board.motors[2].count
    board.wait(1.0)
    assert board.motors[2].count == before


def test_a_thousand_drags_outside_leave_motors_within_limits(
    connect: Connect, robot: Robot, motors: Calibration, board: EmulatedBoard
) -> None:
    page = connect(board, _text(robot, motors, moved=0.03))
    _arm(page, board)
    page.evaluate("""() => {
      const canvas = document.getElementById("above"), { left, top } = canvas.getBoundingClientRect();
      const { data, shown } = toy;
      canvas.setPointerCapture = () => {};
      window.send = (kind, x, y) => canvas.dispatchEvent(
        new PointerEvent(kind, { pointerId: 1, clientX: left + x, clientY: top + y, bubbles: true }));
      const [, first] = data.groups.find(([kind]) => kind === "marker");
      send("pointerdown", ...shown().sight.see(shown().points, data.dim * first));
    }""")
    counts = list[list[int]]()
    for begun in range(0, 1000, 50):
        page.evaluate(
            """begun => {
          for (let i = begun; i < begun + 50; i++) send("pointermove", 1e4 * Math.sin(i / 90), 1e4 * Math.cos(i / 90));
        }""",
            begun,
        )
        page.wait_for_timeout(50)
        counts.append([motor.count for motor in board.motors])
    taken = np.array(counts) * 2 * pi * 0.006 / COUNTS
    assert np.ptp(taken[:, :2], axis=0).min() > 0.01
    for winch, own in zip(robot.winches[:2], taken.T, strict=False):  # the last spool winds wider
        assert own.min() > -winch.release - 3e-4
        assert own.max() < winch.travel + 3e-4
    assert taken[:, 2].max() < robot.winches[2].travel


@pytest.mark.parametrize("kind", ["Dynamixel", "Feetech"])
def test_a_port_that_answers_nonsense_is_refused(connect: Connect, robot: Robot, kind: str) -> None:
    class Noise(EmulatedChain):
        def read(self, most: int) -> bytes:
            return np.random.default_rng(most).bytes(400)

    page = connect(Noise([]), _text(robot, Calibration.usual(robot), silent=160), f"Connect {kind}")
    _wait(page, _says(page, "Motor 1 does not answer"))
    assert page.locator("#motors button:visible").all_inner_texts() == ["Connect Dynamixel", "Connect Feetech"]


def test_a_board_of_another_robot_is_refused(connect: Connect, board: EmulatedBoard) -> None:
    board.robot = "starfish.00000000"
    page = connect(board)
    status = page.locator("#motors p")
    _wait(page, lambda: "built for starfish.00000000" in status.inner_text())
    assert board.state == "off"
    assert not page.get_by_role("button", name="Hold to arm").is_visible()


def test_a_board_that_is_reset_is_never_armed_on_its_old_zero(connect: Connect, board: EmulatedBoard) -> None:
    """Each connection asks for the zero, which the board is not told: `play` would then believe motors.toml."""
    board.marked = False
    page = connect(board)
    zero = page.get_by_role("button", name="Set zero")
    _wait(page, zero.is_visible)
    board.motors[0].angle = -5.0  # a place within the limits as seen from the old zero
    zero.click()
    _wait(page, page.get_by_role("button", name="Hold to arm").is_visible)
    assert not board.marked
    board.begin_anew()
    page.evaluate("loseAnswer()")  # to the line that shows a reset: the board has taken it
    _hold(page)
    _wait(page, _says(page, "did not answer"))
    page.mouse.up()
    assert board.state == "off"
    zero.click()
    _wait(page, page.get_by_role("button", name="Hold to arm").is_visible)
    board.begin_anew()
    page.keyboard.press("Escape")  # a stop that a reset board took would hide the reset
    _hold(page)
    _wait(page, _says(page, "was reset"))
    page.mouse.up()
    assert board.state == "off"
    assert zero.is_visible()
    _arm(page, board)
    board.begin_anew()
    _wait(page, zero.is_visible)
    assert _says(page, "was reset")()
    zero.click()
    _wait(page, page.get_by_role("button", name="Hold to arm").is_visible)
    board.motors[0].angle += 20.0
    _hold(page)
    _wait(page, _says(page, "W1 stands at 120.0 mm"))
    page.mouse.up()
    assert board.state == "off"


def test_a_stop_while_arming_counts_and_a_pulled_cable_frees_the_port(connect: Connect, board: EmulatedBoard) -> None:
    page = connect(board)
    page.evaluate("window.stopWhileArming = true")
    _hold(page)
    _wait(page, _says(page, "Stopped"))
    page.mouse.up()
    _turn(page, 1, 60.0)
    page.wait_for_timeout(300)
    assert not page.locator("#motors .armed").is_visible()
    assert board.motors[1].count == 0
    page.evaluate("window.stopWhileArming = false")
    _arm(page, board)
    board.gone = True
    _wait(page, _says(page, "unplugged"))
    _wait(page, lambda: page.evaluate("window.closedPorts") == 1)
    board.gone = False
    board.begin_anew()
    page.get_by_role("button", name="Connect").click()
    _arm(page, board)


@pytest.fixture
def servo_page(robot: Robot) -> str:
    """A page for servos, with contractions of a forged model that go to twice the limits of the winches."""
    motors = [replace(each, zero=1.0) for each in Calibration.usual(robot).motors]
    return _text(robot, Calibration(tuple(motors)), forged=2.0)


def _servos(kind: str, count: int = 3) -> EmulatedChain:
    """Servos that stand at their zeros, one of them a turn away."""
    angles = [1.0, 1.0 + 2 * pi, 1.0, 1.0]
    if kind == "Feetech":
        return EmulatedFeetechChain([EmulatedSts(n + 1, angle=angles[n]) for n in range(count)])
    chain = EmulatedChain([EmulatedServo(n + 1, angle=angles[n]) for n in range(count)])
    for servo in chain.servos:
        servo.step(0.0, 1e-3)
    return chain


@pytest.mark.parametrize(("kind", "baud"), [("Dynamixel", 57600), ("Feetech", 1_000_000)])
def test_servos_follow_within_limits_and_stand_by_themselves(
    connect: Connect, servo_page: str, kind: str, baud: int
) -> None:
    chain, written = _servos(kind), list[bytes]()
    chain.towards = lambda data: written.append(data) or data
    page = connect(chain, servo_page, f"Connect {kind}")
    _arm(page, chain)
    assert page.evaluate("window.baud") == baud
    chain.towards = lambda data: data
    sent = list[bytes]()
    for data in written if kind == "Feetech" else ():
        filler = find_filler(sent[-3:])
        assert data.startswith(filler + b"\xff\xff")
        sent.append(data[len(filler) :])
    first, second, third = chain.servos
    assert third.most == pytest.approx(0.4 * third.constant, rel=0.01)
    fastest, farthest = [0.0], [0.0]

    def watch() -> None:
        told = (
            first.table[46] + 256 * first.table[47]
        )  # Feetech's speed [steps/s], more than the emulated servo reaches
        fastest.append(2 * pi / 4096 * told if kind == "Feetech" else abs(first.speed))
        farthest.append(first.angle - 1.0)

    chain.watch = watch
    _drive(page, chain, 0, 110.0, lambda: first.angle - 1.0 > 0.059 / 0.006)
    page.wait_for_timeout(300)
    assert max(farthest) * 0.006 == pytest.approx(0.06, abs=3e-4)
    assert 0.05 < 0.006 * max(fastest) < 0.061
    assert "W1 0.00 A" in page.locator("#motors output").inner_text()
    for stop in (
        lambda: page.keyboard.press("Escape"),
        lambda: page.evaluate(HIDE),
        lambda: page.evaluate(SLEEP),
        lambda: setattr(chain, "gone", True),
    ):
        if not page.locator("#motors .armed").is_visible():
            _arm(page, chain)
        _turn(page, 1, 50.0)
        start = second.angle
        goal = 0.0 if start > 3 + 2 * pi else 50.0
        _drive(page, chain, 1, goal, lambda start=start: abs(second.angle - start) > 0.5)
        stop()
        chain.wait(0.25)
        before = second.angle
        assert 0.006 * abs(before - start) < 0.045  # on the way
        chain.wait(1.0)
        assert second.angle == pytest.approx(before, abs=2e-3)
        page.evaluate(WAKE)
    _wait(page, _says(page, "unplugged"))
    assert [servo.table[40 if kind == "Feetech" else 64] for servo in chain.servos] == [1, 1, 1]


@pytest.mark.parametrize("kind", ["Dynamixel", "Feetech"])
def test_servos_stand_within_a_quarter_second_of_closing(connect: Connect, servo_page: str, kind: str) -> None:
    chain = _servos(kind)
    page, motor = connect(chain, servo_page, f"Connect {kind}"), chain.servos[0]
    _drive(page, chain, 0, 60.0, lambda: motor.angle - 1.0 > 0.5)
    page.close()
    chain.wait(0.25)
    before = motor.angle
    assert 0.006 * (before - 1.0) < 0.045  # on the way
    chain.wait(1.0)
    assert motor.angle == pytest.approx(before, abs=2e-3)


@pytest.mark.parametrize("kind", ["Dynamixel", "Feetech"])
def test_servos_of_another_robot_or_after_a_reset_are_refused(connect: Connect, servo_page: str, kind: str) -> None:
    place = 40 if kind == "Feetech" else 64
    chain, late = _servos(kind, 4), [0.3]  # time for which a busy computer keeps the first question [s]
    chain.towards = lambda data: time.sleep(late.pop() if late else 0.0) or data
    page = connect(chain, servo_page, f"Connect {kind}")
    _wait(page, _says(page, "Motor 4 is not in motors.toml"))
    assert not page.get_by_role("button", name="Set zero").is_visible()
    chain.servos = chain.servos[:3]
    chain.servos[2].angle += 1.0  # 6 mm of cable
    chain.wait(0.01)
    again, zero = (page.get_by_role("button", name=name) for name in (f"Connect {kind}", "Set zero"))
    again.click()
    _wait(page, zero.is_visible)
    zero.click()
    _wait(page, _says(page, "W3 is 6.0 mm from its zero"))
    chain.servos[2].angle -= 1.0
    chain.wait(0.01)
    zero.click()
    _wait(page, page.get_by_role("button", name="Hold to arm").is_visible)
    chain.servos[1].begin_anew()
    _hold(page)
    _wait(page, _says(page, "lost power"))
    page.mouse.up()
    assert [servo.table[place] for servo in chain.servos] == [0, 0, 0]
    chain.servos[1].angle += 2 * pi  # from where its count does not begin after a reset
    chain.wait(0.01)
    _arm(page, chain)
    chain.servos[1].begin_anew()
    _wait(page, _says(page, "lost power, and its count of turns. Connect again"))
    _wait(page, lambda: page.evaluate("window.written") == 2)  # after the first Connect, and now
    assert [servo.table[place] for servo in chain.servos] == [1, 0, 1]
    again.click()
    _arm(page, chain)
    chain.servos[0].ails.hot = True
    _wait(page, _says(page, "W1 reports a fault"))
    assert not page.locator("#motors .armed").is_visible()
