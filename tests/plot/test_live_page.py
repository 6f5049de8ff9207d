"""A page that shows pictures as they come. Oracles: the pixels that were given, the sockets of the system."""

import http.client
import io
import socket
import struct
import threading
from collections.abc import Iterator
from copy import deepcopy
from threading import Timer

import numpy as np
import pytest
from PIL import Image

from hydrostat.plot.live_page import LivePage

Got = tuple[int, bytes, str | None]


@pytest.fixture
def page() -> Iterator[LivePage]:
    made = LivePage("a <robot>", browser=False)
    yield made
    made.close()


def ask(page: LivePage, path: str, host: str = "", method: str = "GET") -> Got:
    name, _, port = page.address.removeprefix("http://").rstrip("/").partition(":")
    connection = http.client.HTTPConnection(name, int(port))
    connection.request(method, path, headers={"host": host or f"{name}:{port}"})
    answer = connection.getresponse()
    got = answer.status, answer.read(), answer.getheader("x-number")
    connection.close()
    return got


def pixels(file: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(file)))


def test_the_newest_picture_is_given_and_one_that_is_not_there_yet_is_waited_for(page: LivePage) -> None:
    random = np.random.default_rng(0)
    first, second, third = random.integers(0, 256, (3, 8, 12, 3), dtype=np.uint8)
    assert b"a &lt;robot&gt;" in ask(page, "/")[1]
    page.show(first)
    page.show(second)
    status, file, number = ask(page, "/picture?after=0")
    assert (status, number) == (200, "2")
    assert (pixels(file) == second).all()
    later = Timer(0.05, page.show, [third])
    later.start()
    status, file, number = ask(page, "/picture?after=2")
    assert (status, number, (pixels(file) == third).all()) == (200, "3", True)


def test_only_this_machine_by_its_own_name_is_answered(page: LivePage) -> None:
    page.show(np.zeros((2, 2, 3), np.uint8))
    port = page.address.rstrip("/").rpartition(":")[2]
    assert page.address.startswith("http://127.0.0.1:")
    assert page._server is not None
    assert page._server.socket.getsockname()[0] == "127.0.0.1"
    assert ask(page, "/", f"localhost:{port}")[0] == 200
    for host in ("evil.example", f"evil.example:{port}", f"127.0.0.1:{int(port) + 1}"):
        assert ask(page, "/picture?after=0", host)[0] == 403
    assert ask(page, "/../secret")[0] == 404
    assert ask(page, "/", method="POST")[0] == 501
    for number in ("nothing", 5000 * "9"):
        assert ask(page, f"/picture?after={number}")[0] == 200


def test_a_browser_that_has_gone_is_no_news(page: LivePage, capfd: pytest.CaptureFixture[str]) -> None:
    """Oracle: what is written on the terminal; each that went while it waited left a traceback there."""
    where = page.address.removeprefix("http://").rstrip("/")
    gone = http.client.HTTPConnection(where)
    gone.request("GET", "/picture?after=0")
    gone.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # it ends at once
    gone.close()
    threads = [each for each in threading.enumerate() if "process_request_thread" in each.name]
    page.show(np.zeros((2, 2, 3), np.uint8))
    assert ask(page, "/picture?after=0")[0] == 200
    for each in threads:
        each.join(60.0)
    assert capfd.readouterr().err == ""


def test_a_page_that_was_ended_can_be_opened_again(page: LivePage) -> None:
    """Oracle: who asks for news waits for them; it was answered at once that there are none."""
    page.show(np.zeros((2, 2, 3), np.uint8))
    assert page.address
    page.close()
    assert page.address
    found: list[tuple[int, bytes] | None] = []
    asks = threading.Thread(target=lambda: found.append(page.newer(1)))
    asks.start()
    asks.join(0.2)
    page.show(np.ones((2, 2, 3), np.uint8))
    asks.join(60.0)
    assert [each and each[0] for each in found] == [2]


def test_the_first_picture_opens_the_browser_and_a_copy_is_another_page(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    page = LivePage("robot")
    for _ in range(2):
        page.show(np.zeros((2, 2, 3), np.uint8))
    other = deepcopy(page)
    assert other.address != page.address
    assert opened == [page.address]
    where = page.address
    for each in (page, other):
        each.close()
    with pytest.raises(ConnectionRefusedError):
        http.client.HTTPConnection(where.removeprefix("http://").rstrip("/")).request("GET", "/")
