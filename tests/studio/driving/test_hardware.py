"""Motors behind the studio. Oracle: emulated servos, which know where they are."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from hydrostat.control import Bus, LinkState, open_bus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import gallery_folder
from hydrostat.studio.bell import Topic
from hydrostat.studio.driving.machine import kit_speed
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName

pytestmark = pytest.mark.usefixtures("unchecked")


def until(done: Callable[[], bool], seconds: float = 120.0) -> bool:
    """Wait for something; long enough for a machine that is busy."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if done():
            return True
        time.sleep(0.01)
    return done()


@pytest.fixture
def session() -> Iterator[Session]:
    made = Session()
    made.open_folder(gallery_folder("starfish"))
    made.go(StageName.DRIVE)
    yield made
    made.close()


def step(session: Session, seconds: float) -> None:
    """Let the studio work while somebody looks at the page."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        session.hardware.beat()
        session.step(time.monotonic())
        time.sleep(0.005)


def test_motors_do_what_is_shown_once_they_are_armed(session: Session) -> None:
    hardware = session.hardware
    with pytest.raises(InputError, match="connect the motors first"):
        hardware.arm()
    hardware.connect("emulated")
    assert hardware.state is LinkState.CALIBRATED
    session.driver.turn("left", 0.008)
    step(session, 0.4)
    assert hardware.places["left"] == 0.0  # nothing turns before it is armed
    hardware.arm()
    end = time.monotonic() + 120
    while hardware.places["left"] < 0.0075 and time.monotonic() < end:
        step(session, 0.05)
    assert hardware.places["left"] == pytest.approx(0.008, abs=5e-4)
    assert hardware.places["right"] == pytest.approx(0.0, abs=5e-4)
    assert set(hardware.currents) == set(hardware.places)
    session.key("escape")
    assert hardware.state is LinkState.STOPPED
    with pytest.raises(HydrostatError, match="do not turn"):
        hardware._link.send(np.zeros(3), 0.0, speed=0.01)  # type: ignore[union-attr]


def test_they_hold_when_nobody_looks_at_the_page(session: Session) -> None:
    hardware = session.hardware
    hardware.connect("emulated")
    hardware.arm()
    assert until(lambda: not hardware.is_armed)  # no sign of life comes
    assert "no active browser tab" in hardware.words


def test_a_link_that_stopped_by_itself_is_told(session: Session) -> None:
    """The deadline is kept by a thread of the link, which knows no page."""
    hardware = session.hardware
    hardware.connect("emulated")
    hardware.arm()
    link = hardware._link
    assert link is not None
    assert until(lambda: hardware.beat() or hardware._follows)
    link._stop_with_error(LinkState.HOLD, "this computer is late")
    assert until(lambda: "this computer is late" in hardware.words)


def test_another_stage_and_another_robot_hold_them(session: Session) -> None:
    hardware = session.hardware
    hardware.connect("emulated")
    hardware.arm()
    session.go(StageName.POSE)
    assert not hardware.is_armed
    assert "Re-arm to continue" in hardware.words
    session.open_folder(gallery_folder("fish_tail"))
    session.step(time.monotonic())
    assert hardware.state is None
    assert "motors disconnected. Connect again" in hardware.words


def test_a_pose_that_is_dragged_streams_its_iterates(session: Session) -> None:
    """Fig 3.7: the solver still works while motors follow; each shape is an equilibrium."""
    session.go(StageName.POSE)
    hardware, told = session.hardware, []
    hardware.connect("emulated")
    hardware.arm()
    session.poser.set_mode(Mode.CABLES)
    session.poser.show_pose("wave")
    end = time.monotonic() + 30.0  # a busy computer may let the emulated motors wait
    while time.monotonic() < end and (len(told) < 40 or max(hardware.places.values()) <= 1e-3):
        hardware.beat()
        session.step(time.monotonic())
        told.append(hardware._goal.copy())
        time.sleep(0.01)
    assert len({row.tobytes() for row in told}) > 3
    np.testing.assert_array_equal(told[-1], session.poser.shape().contractions)
    assert max(hardware.places.values()) > 1e-3


def test_a_line_that_is_gone_is_told(session: Session) -> None:
    class Dying:
        """A bus whose line is pulled."""

        def __init__(self, bus: Bus) -> None:
            self.bus, self.gone = bus, False

        def __getattr__(self, name: str):
            if self.gone and name in ("read", "write"):
                raise HydrostatError("the line to the motors is gone")
            return getattr(self.bus, name)

    made: list[Dying] = []

    def opener(*given) -> Dying:
        made.append(Dying(open_bus(*given)))
        return made[-1]

    hardware = session.hardware
    hardware._opener = opener  # type: ignore[assignment]
    hardware.connect("emulated")
    hardware.arm()
    made[0].gone = True

    def stopped() -> bool:
        hardware.beat()
        return hardware.state is LinkState.FAULT and bool(hardware.words)

    assert until(stopped)
    assert "the line to the motors is gone" in hardware.words


def test_two_windows_that_connect_at_once_leave_no_port_open(session: Session) -> None:
    """Oracle: ports that are counted; the second finds the motors of the first, and lets its own go."""
    hardware, inner = session.hardware, session.hardware._opener
    opened, closed, both = [], [], threading.Barrier(2, timeout=120)

    def opener(*given) -> Bus:
        bus = inner(*given)
        close = bus.close
        bus.close = lambda: (closed.append(bus), close())  # type: ignore[method-assign]
        opened.append(bus)
        both.wait()
        return bus

    hardware._opener, wrong = opener, []

    def connect() -> None:
        try:
            hardware.connect("emulated")
        except HydrostatError as error:
            wrong.append(str(error))

    windows = [threading.Thread(target=connect) for _ in range(2)]
    for window in windows:
        window.start()
    for window in windows:
        window.join()
    assert len(opened) == 2
    assert len(closed) == 1
    assert "meanwhile. Connect again" in wrong[0]
    hardware.arm()
    assert hardware.is_armed
    hardware.close()
    assert set(map(id, closed)) == set(map(id, opened))


def test_guests_have_none() -> None:
    guest = Session(guest=True)
    with pytest.raises(InputError, match="guests cannot"):
        guest.hardware.connect("emulated")
    guest.close()


def test_a_folder_without_motors_is_told(session: Session, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"has no motors\.toml"):
        session.hardware.connect("dynamixel:/dev/nothing")
    with pytest.raises(InputError, match="write emulated, or one such as"):
        session.hardware.connect("steam:/dev/nothing")


def test_the_kits_speed_by_hand(session: Session) -> None:
    """The starfish at 20 N a cable needs the 25D: 35 rpm, less the share of its stall torque."""
    robot = session.document.robot
    speed, name = kit_speed(robot, 20.0)
    radius = min(winch.spool_radius for winch in robot.winches)
    counts = [sum(cable.winch == winch.name for cable in robot.cables) for winch in robot.winches]
    load = max(count * 20.0 * winch.spool_radius for count, winch in zip(counts, robot.winches, strict=True))
    assert "25D" in name or "XL330" in name or "N20" in name
    if "25D" in name:
        assert speed == pytest.approx(2 * np.pi * radius * 35 / 60 * (1 - load / 1.373))
    assert 0.01 < speed < 0.07


def test_escape_stops_motors_while_another_thread_works_with_the_session(session: Session) -> None:
    hardware = session.hardware
    hardware.connect("emulated")
    hardware.arm()
    hardware.beat()
    with session._lock:  # a thread that solves something long
        pressed = threading.Thread(target=session.key, args=("escape",))
        pressed.start()
        assert until(lambda: hardware.state is LinkState.STOPPED, 1.0)
    pressed.join()


def test_a_stop_while_motors_are_armed_leaves_them_standing(session: Session) -> None:
    hardware = session.hardware
    hardware.connect("emulated")
    link = hardware._link
    assert link is not None
    arm = link._bus.arm

    def slow(currents: np.ndarray) -> None:
        arm(currents)
        pressed = threading.Thread(target=hardware.hold)
        pressed.start()
        pressed.join(5.0)
        assert not pressed.is_alive()  # it did not wait

    link._bus.arm = slow  # type: ignore[method-assign]
    with pytest.raises(HydrostatError, match="stopped while they were armed"):
        hardware.arm()
    assert hardware.state is LinkState.STOPPED


def test_motors_armed_before_anything_is_shown_stay_where_they_are(session: Session) -> None:
    hardware = session.hardware
    hardware.connect("emulated")
    link = hardware._link
    assert link is not None
    hardware.arm()
    hardware._goal = np.full(len(hardware.places), 0.006)
    assert until(lambda: (hardware.beat(), min(hardware.places.values()) > 0.0055)[1]), hardware.words
    hardware.hold()
    hardware._goal = np.zeros(len(hardware.places))  # as it is when motors are connected
    hardware.arm()
    until(lambda: bool(hardware.beat()), 0.5)
    assert min(hardware.places.values()) > 0.0055


def test_who_is_told_may_fail_and_motors_are_still_told_and_armed_anew(session: Session) -> None:
    """The thread that tells motors goes on when a listener of it raises, just as nobody looks at the page."""
    hardware = session.hardware

    def broken(_: Topic) -> None:
        if threading.current_thread().name == "motors of the studio":
            raise RuntimeError("its line is gone")

    session.bell.listen(broken)
    hardware._silent = 0.2
    hardware.connect("emulated")
    hardware.arm()
    assert until(lambda: not hardware.is_armed)
    assert "no active browser tab" in hardware.words
    hardware._silent = 1e3
    session.driver.turn("left", 0.008)

    def turned() -> bool:
        step(session, 0.05)
        if not hardware.is_armed:  # this computer was too busy to tell them
            hardware.arm()
        return hardware.places["left"] > 0.007

    assert until(turned)
