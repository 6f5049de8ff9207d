"""What drives a robot: keys, gamepads, MIDI, OSC, hands.

Oracles: a pseudo-terminal, SDL's own virtual gamepad, mido's own sockets, python-osc's own client, and angles by hand.
"""

import ctypes
import json
import os
import socket
import time
from collections.abc import Callable
from math import inf
from pathlib import Path

import numpy as np
import pytest

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop import HandMap, MappedHand, open_source
from hydrostat.teleop.camera_hand import COUNT, HandLandmarks, bends
from hydrostat.teleop.cyber_glove import SENSORS, CyberGlove, EmulatedGlove
from hydrostat.teleop.gamepad import Gamepad
from hydrostat.teleop.keys import Keys
from hydrostat.teleop.midi_osc import MidiKnobs, Osc
from hydrostat.teleop.ridge import Ridge
from hydrostat.teleop.source import DriveChannels, HandReading

WINCHES = DriveChannels(
    names=("index flexor", "thumb"),
    low=np.array([-0.002, 0.0]),
    high=np.array([0.03, 0.02]),
    rest=np.zeros(2),
    groups=((0,), (1,)),
)
TIPS = DriveChannels(
    names=("index x", "index y", "index z"),
    low=np.full(3, -0.1),
    high=np.full(3, 0.1),
    rest=np.array([0.01, 0.02, 0.03]),
    groups=((0, 1, 2),),
)


def until(read: Callable, wanted: Callable, seconds: float = 60.0):
    """What is read first that is wanted."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if wanted(found := read()):
            return found
        time.sleep(2e-3)
    raise AssertionError("it did not come")


def test_keys_of_a_terminal() -> None:
    ours, theirs = os.openpty()
    keys = Keys(WINCHES, file=theirs, clock=lambda: 3.0)
    os.write(ours, b"dd\x1b[C\x1b[DA")
    wish = keys.read()
    assert wish.steps == pytest.approx({"index flexor": 2 * 0.5e-3 - 3e-3})
    assert (wish.stamp, wish.places, wish.hold, wish.over) == (3.0, {}, False, False)
    os.write(ours, b"\td")
    assert keys.read().steps == pytest.approx({"thumb": 0.5e-3})
    os.write(ours, b"\x1b[Z ")
    wish = keys.read()
    assert wish.hold
    assert wish.words.startswith("index flexor")
    os.write(ours, b"2 r")
    wish = keys.read()
    assert (wish.hold, wish.places, wish.words[:5]) == (False, {"index flexor": 0.0, "thumb": 0.0}, "thumb")
    os.write(ours, b"q")
    assert keys.read().over
    assert keys.read().steps == {}
    keys.close()
    os.close(ours)
    with pytest.raises(HydrostatError, match="terminal closed"):
        keys.read()
    os.close(theirs)


def test_keys_move_a_marker_in_space() -> None:
    ours, theirs = os.openpty()
    keys = Keys(TIPS, file=theirs)
    os.write(ours, b"d\x1b[A\x1b[A<")
    assert keys.read().steps == pytest.approx({"index x": 0.5e-3, "index z": 1e-3, "index y": -0.5e-3})
    os.close(ours)
    os.close(theirs)


class VirtualPad:
    """A gamepad that SDL emulates, in the library that pygame brings."""

    def __init__(self) -> None:
        pygame = pytest.importorskip("pygame")
        found = [*Path(pygame.__file__).parents[1].glob("pygame*.libs/libSDL2-2*")]
        if not found:
            pytest.skip("pygame has no SDL of its own here")
        os.environ["SDL_VIDEODRIVER"] = "dummy"
        os.environ["SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS"] = "1"
        pygame.display.init()
        pygame.joystick.init()
        self.sdl = ctypes.CDLL(str(found[0]))
        self.index = self.sdl.SDL_JoystickAttachVirtual(1, 6, 15, 0)
        self.sdl.SDL_JoystickOpen.restype = ctypes.c_void_p
        self.stick = ctypes.c_void_p(self.sdl.SDL_JoystickOpen(self.index))
        for axis in range(6):
            self.axis(axis, 0.0)

    def axis(self, number: int, value: float) -> None:
        self.sdl.SDL_JoystickSetVirtualAxis(self.stick, number, ctypes.c_int16(round(32767 * value)))

    def button(self, number: int, down: bool) -> None:
        self.sdl.SDL_JoystickSetVirtualButton(self.stick, number, int(down))

    def unplug(self) -> None:
        self.sdl.SDL_JoystickDetachVirtual(self.index)


@pytest.fixture
def pad():
    virtual = VirtualPad()
    yield virtual
    virtual.unplug()


def test_a_gamepad(pad: VirtualPad) -> None:
    now = [0.0]
    source = Gamepad(WINCHES, pad.index, clock=lambda: now[0])
    assert source.read().steps == {}
    pad.axis(1, -1.0)
    now[0] = 0.05
    assert source.read().steps == pytest.approx({"index flexor": 0.05 * 0.04}, rel=1e-3)
    now[0] = 60.0  # whoever did not look for a minute does not leap
    assert source.read().steps == pytest.approx({"index flexor": 0.1 * 0.04}, rel=1e-3)
    pad.axis(1, 0.1)  # where the middle of a worn stick may be
    pad.button(14, True)
    now[0] = 60.1
    assert source.read().words.startswith("thumb")
    assert source.read().words.startswith("thumb")
    pad.button(14, False)
    pad.button(0, True)
    assert source.read().hold
    pad.button(0, False)
    pad.button(1, True)
    wish = source.read()
    assert (wish.hold, wish.places) == (True, {"index flexor": 0.0, "thumb": 0.0})
    pad.button(6, True)
    assert source.read().over
    pad.unplug()
    with pytest.raises(HydrostatError, match="gamepad disconnected"):
        source.read()
    source.close()


def test_a_gamepad_that_is_not_there() -> None:
    pytest.importorskip("pygame")
    with pytest.raises(HydrostatError, match="gamepad 7 is not there"):
        Gamepad(WINCHES, 7)


def test_knobs_over_midi() -> None:
    mido = pytest.importorskip("mido")
    sockets = pytest.importorskip("mido.sockets")
    server = sockets.PortServer("127.0.0.1", 0)
    client = sockets.connect("127.0.0.1", server._socket.getsockname()[1])
    port = server.accept()
    knobs = MidiKnobs(WINCHES, first=16, port=port)
    assert knobs.read().places == {}
    for knob, value in ((16, 127), (17, 0), (16, 64)):
        client.send(mido.Message("control_change", control=knob, value=value))
    client.send(mido.Message("note_on", note=60))
    places: dict[str, float] = {}

    def read() -> dict[str, float]:
        places.update(knobs.read().places)
        return places

    until(read, lambda found: len(found) == 2)
    until(read, lambda found: abs(found["index flexor"] - (-0.002 + 0.032 * 64 / 127)) < 1e-9)
    assert places["thumb"] == 0.0
    client.send(mido.Message("control_change", control=40, value=1))
    assert "midi:NAME@40" in until(knobs.read, lambda wish: "turns nothing" in wish.words).words
    port.close()
    with pytest.raises(HydrostatError, match="MIDI port lost"):
        knobs.read()
    client.close()
    server.close()


def test_messages_over_osc() -> None:
    client = pytest.importorskip("pythonosc.udp_client")
    now = [1.0]
    osc = Osc(WINCHES, port=0, clock=lambda: now[0])
    assert osc.address[0] == "127.0.0.1"
    sender = client.SimpleUDPClient(*osc.address)
    sender.send_message("/winch/index_flexor", 12.5)
    sender.send_message("/winch/thumb", [3])
    places = until(osc.read, lambda wish: wish.places).places
    places = {**places, **osc.read().places}
    assert places == pytest.approx({"index flexor": 0.0125, "thumb": 0.003})
    sender.send_message("/winch/elbow", 1.0)
    assert "/winch/elbow" in until(osc.read, lambda wish: "not understood" in wish.words).words
    for wrong in ("many", float("nan"), float("inf")):
        sender.send_message("/winch/thumb", wrong)
        assert osc.read().places == {}
    sender._sock.sendto(b"no osc at all", osc.address)
    now[0] = 100.0
    wish = osc.read()
    assert (wish.stamp, osc.silence) == (100.0, inf)  # a word holds, as that of a knob
    sender.send_message("/alive", [])
    until(osc.read, lambda wish: osc.silence < 1)
    now[0] = 101.0
    assert now[0] - osc.read().stamp > osc.silence
    sender.send_message("/hold", 1)
    assert until(osc.read, lambda wish: wish.hold).stamp == 101.0
    sender.send_message("/end", [])
    assert until(osc.read, lambda wish: wish.over)
    sender._sock.close()
    taken = osc.address[1]
    with pytest.raises(HydrostatError, match=f"port {taken} of 127.0.0.1 cannot be heard"):
        Osc(WINCHES, port=taken)
    osc.close()
    osc.close()


def test_markers_over_osc() -> None:
    client = pytest.importorskip("pythonosc.udp_client")
    osc = Osc(TIPS, port=0)
    sender = client.SimpleUDPClient(*osc.address)
    sender.send_message("/marker/index", [30.0, -50.0, 120.0])
    sender._sock.close()
    places = until(osc.read, lambda wish: wish.places).places
    assert places == pytest.approx({"index x": 0.03, "index y": -0.05, "index z": 0.12})
    osc.close()


def straight(outputs: tuple[str, ...] = WINCHES.names) -> HandMap:
    """A map from the mean of the first sensors to each channel."""
    weights = np.zeros((SENSORS, len(outputs)))
    weights[0] = 0.01
    ridge = Ridge(np.zeros(SENSORS), np.zeros(len(outputs)), weights, 0.0)
    return HandMap(robot="r", sensors=CyberGlove.names, outputs=outputs, ridge=ridge, poses=3, error=0.0)


def test_a_hand_that_falls_silent_and_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    emulated = EmulatedGlove(np.full(SENSORS, 1.0))
    source = MappedHand(WINCHES, CyberGlove(emulated), straight())
    wish = until(source.read, lambda wish: wish.places)
    assert wish.places == pytest.approx({"index flexor": 0.01, "thumb": 0.01})
    emulated.spoil = lambda answer: b""
    wish = until(source.read, lambda wish: time.monotonic() - wish.stamp > source.silence)
    assert "does not answer" in wish.words
    emulated.spoil = lambda answer: answer
    assert until(source.read, lambda wish: time.monotonic() - wish.stamp < source.silence).places
    monkeypatch.setattr("hydrostat.teleop.mapped_hand.STARTUP_TIMEOUT", 0.1)
    emulated.spoil = lambda answer: b""
    with pytest.raises(HydrostatError, match="does not answer with 22 sensors"):
        until(source.read, lambda wish: False)
    source.close()


def test_maps_are_kept_and_fit_one_hand_and_robot(tmp_path: Path) -> None:
    path = straight().save(tmp_path / "hand.json")
    known = HandMap.open(path)
    sensors = np.linspace(0, 1, SENSORS)
    assert known(sensors) == straight()(sensors)
    assert (known.sensors, known.outputs, known.poses) == (CyberGlove.names, WINCHES.names, 3)
    with pytest.raises(InputError, match="use --markers"):
        known.check(CyberGlove.names, TIPS.names)
    with pytest.raises(InputError, match="another kind of hand"):
        known.check(HandLandmarks.names, WINCHES.names)


@pytest.mark.parametrize("text", ["", "{}", '{"format": "other"}', "[1]"])
def test_files_that_are_no_map(tmp_path: Path, text: str) -> None:
    (tmp_path / "map.json").write_text(text)
    with pytest.raises(InputError, match=r"map\.json: .*`hydrostat mimic` makes it"):
        HandMap.open(tmp_path / "map.json")


def landmarks(bend: float, spread: float = 0.2) -> np.ndarray:
    """A hand with straight fingers that are spread by angles, each bent by an angle at its middle joint [rad]."""
    places = [np.zeros(3)]
    for finger in range(5):
        way = np.array([np.sin(spread * finger), np.cos(spread * finger), 0.0])
        bent = np.cos(bend) * way + np.sin(bend) * np.array([0.0, 0.0, -1.0])
        places += [2 * way, 3 * way, 3 * way + bent, 3 * way + 2 * bent]
    return np.array(places)


def test_landmarks_become_bends_wherever_the_hand_is() -> None:
    told = dict(zip(HandLandmarks.names, bends(landmarks(0.7)), strict=True))
    for finger in ("thumb", "index", "little"):
        assert np.pi * told[f"{finger} middle"] == pytest.approx(0.7)
        assert [told[f"{finger} {joint}"] for joint in ("root", "end")] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert np.pi * told["index-middle"] == pytest.approx(0.2)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    assert bends(5.0 + 0.3 * landmarks(0.7) @ turn) == pytest.approx(bends(landmarks(0.7)), abs=1e-7)
    assert np.isfinite(bends(np.zeros((COUNT, 3)))).all()


def test_what_is_no_number_is_silence_and_ends_nothing() -> None:
    """Landmarks in any unit have finite bends; a hand that tells none is not heard, and is again when it tells some."""
    assert bends(1e200 * landmarks(0.7)) == pytest.approx(bends(landmarks(0.7)), abs=1e-7)
    told = [np.full(SENSORS, np.nan)]

    class Hand(CyberGlove):
        def read(self) -> HandReading:
            time.sleep(1e-3)
            return HandReading(told[0], time.monotonic())

    source = MappedHand(WINCHES, Hand(EmulatedGlove(np.zeros(SENSORS))), straight())
    assert until(source.read, lambda wish: "is no number" in wish.words).places == {}
    told[0] = np.full(SENSORS, 0.5)
    assert np.isfinite(list(until(source.read, lambda wish: wish.places).places.values())).all()
    source.close()


def test_landmarks_over_udp() -> None:
    hand = HandLandmarks(0, clock=lambda: 9.0)
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for bend in (0.1, 0.5):  # the newest counts
        sender.sendto(json.dumps({"landmarks": landmarks(bend).tolist()}).encode(), hand.address)
    reading = hand.read()
    assert (len(reading.values), reading.stamp) == (len(hand.names), 9.0)
    assert np.pi * reading.values[hand.names.index("index middle")] == pytest.approx(0.5)
    for wrong, told in (
        (b"hello", "no landmarks"),
        (b'{"landmarks": [[1, 2, 3]]}', "21 landmarks"),
        (b'{"landmarks": [1, {}]}', "no landmarks"),
        (json.dumps({"landmarks": [[float("nan")] * 3] * COUNT}).encode(), "finite"),
    ):
        sender.sendto(wrong, hand.address)
        with pytest.raises(HydrostatError, match=told):
            hand.read()
    with pytest.raises(HydrostatError, match="no landmarks come"):
        hand.read()
    sender.close()
    hand.close()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pedals", "Available: keys, gamepad:0"),
        ("keys:now", "has no place"),
        ("gamepad:x", "must end with a number"),
        ("osc:99999999", "must end with a number"),
        ("midi:nano@x", "must end with a number"),
        ("midi:@127", "MIDI has 0 to 127"),
        ("glove:/dev/ttyUSB0", "needs --map FILE"),
    ],
)
def test_words_that_name_no_source(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        open_source(text, WINCHES)
