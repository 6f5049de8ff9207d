"""Links of a class: which computers open them, and their QR codes. Oracle: OpenCV reads the code back."""

from ipaddress import ip_address

import cv2
import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.studio import find_network_address, write_qr_text
from hydrostat.studio.face.share import Links, socket


@pytest.mark.parametrize(
    ("address", "are_local"),
    [
        ("http://127.0.0.1:8080/room/abc", True),
        ("http://localhost:80/", True),
        ("http://[::1]:8080/", True),
        ("http://192.168.1.20:8080/room/abc", False),
        ("http://127.0.0.1.example.org:80/", False),
    ],
)
def test_links_of_this_computer_are_told(address: str, are_local: bool) -> None:
    assert Links(address, address).are_local == are_local


def test_a_code_holds_its_link() -> None:
    link = "http://192.168.1.20:38211/?token=Zk3vQ0n0_x-AbCdEfGhIjK"
    lines = [line.removeprefix("\x1b[97;40m").removesuffix("\x1b[0m") for line in write_qr_text(link).split("\n")]
    halves = {" ": (0, 0), "\u2580": (1, 0), "\u2584": (0, 1), "\u2588": (1, 1)}
    text = [[halves[character] for character in line] for line in lines]
    bits = np.array(text).transpose(0, 2, 1).reshape(2 * len(lines), -1)
    image = cv2.resize(255 * bits.astype(np.uint8), None, fx=8, fy=8, interpolation=cv2.INTER_NEAREST)
    assert cv2.QRCodeDetector().detectAndDecode(image)[0] == link


def test_an_address_in_the_network_is_no_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    class Cut(socket.socket):
        def connect(self, address: object) -> None:
            raise OSError("Network is unreachable")

    monkeypatch.setattr(socket, "socket", Cut)
    with pytest.raises(InputError, match=r"--class: this computer is in no network\. Connect it, or give --host"):
        find_network_address()
    monkeypatch.undo()
    try:
        assert not ip_address(find_network_address()).is_loopback
    except InputError:
        pytest.skip("this computer is in no network")
