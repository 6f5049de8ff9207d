"""Strangers stay out. The requests are those that foreign pages, rebound names and hostile programs send."""

import http.client
import re
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route
from toy_server import Server
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from hydrostat.studio.face.class_code import new_code
from hydrostat.studio.face.guard import Guard

pytestmark = pytest.mark.slow

PATHS = ("/", "/socket.io/?EIO=4&transport=polling", "/_nicegui_ws/socket.io/?EIO=4&transport=polling", "/none")

LIMIT = 50_000


def raw(port: int, text: bytes) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of the answer to a request, sent as it is."""
    with socket.create_connection(("127.0.0.1", port), timeout=120) as connection:
        connection.sendall(text)
        response = http.client.HTTPResponse(connection, method=text.split(b" ")[0].decode())
        response.begin()
        return response.status, {key.lower(): value for key, value in response.getheaders()}, response.read()


def ask(
    port: int, path: str = "/", *, method: str = "GET", host: str | None = None, **headers: str
) -> tuple[int, dict[str, str], bytes]:
    """The answer to a request from a page or program of this machine, unless told otherwise."""
    lines = [f"{method} {path} HTTP/1.1", f"Host: {f'127.0.0.1:{port}' if host is None else host}", "Connection: close"]
    lines += [f"{key.replace('_', '-')}: {value}" for key, value in headers.items()]
    return raw(port, "\r\n".join([*lines, "", ""]).encode("latin-1"))


def test_the_page_of_this_machine_is_served(server: Server) -> None:
    status, headers, body = ask(server.port)
    assert status == 200
    assert b"hydrostat" in body
    assert headers["x-frame-options"] == "DENY"
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    for name in (f"localhost:{server.port}", f"LOCALHOST:{server.port}", f"[::1]:{server.port}"):
        assert ask(server.port, host=name)[0] == 200


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{port}", "localhost", "127.0.0.1", "127.0.0.1:1", "localhost.:{port}", "",
     "127.0.0.1:{port}.evil.example", "127.0.0.1:{port}@evil.example", "127.0.0.1.evil.example:{port}", "0:{port}",
     "192.168.0.7:{port}", "[::ffff:127.0.0.1]:{port}", "\xe9vil:{port}", "localhost:{port}:{port}"],
)  # fmt: skip
def test_other_names_are_refused(server: Server, path: str, host: str) -> None:
    for method in ("GET", "HEAD", "OPTIONS", "POST"):
        status, _, body = ask(server.port, path, method=method, host=host.format(port=server.port))
        assert status in (400, 403), method
        assert b"<html" not in body.lower()


def test_no_host_and_two_hosts_are_refused(server: Server) -> None:
    own = f"Host: 127.0.0.1:{server.port}\r\n"
    for hosts in ("", own + "Host: evil.example\r\n", "Host: evil.example\r\n" + own, own + own):
        assert raw(server.port, f"GET / HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n".encode())[0] in (400, 403)
    assert raw(server.port, b"GET / HTTP/1.0\r\n\r\n")[0] in (400, 403)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "", "https://127.0.0.1:{port}", "http://127.0.0.1", "http://127.0.0.1:1",
     "http://localhost:{port}", "http://user@127.0.0.1:{port}", "http://127.0.0.1:{port}.evil.example", "http://[",
     "http://127.0.0.1:{port}/", "file://"],
)  # fmt: skip
def test_other_pages_are_refused(server: Server, path: str, origin: str) -> None:
    for method in ("GET", "POST", "OPTIONS"):
        assert ask(server.port, path, method=method, Origin=origin.format(port=server.port))[0] in (400, 403)


def test_what_other_pages_load_or_frame_is_refused_but_a_link_may_be_followed(server: Server) -> None:
    for site in ("cross-site", "same-site"):
        assert ask(server.port, Sec_Fetch_Site=site, Sec_Fetch_Dest="iframe", Sec_Fetch_Mode="navigate")[0] == 403
        assert ask(server.port, Sec_Fetch_Site=site, Sec_Fetch_Dest="script", Sec_Fetch_Mode="no-cors")[0] == 403
        assert ask(server.port, Sec_Fetch_Site=site, Sec_Fetch_Dest="document", Sec_Fetch_Mode="navigate")[0] == 200
        posted = ask(server.port, method="POST", Sec_Fetch_Site=site, Sec_Fetch_Dest="document")
        assert posted[0] == 403
    assert ask(server.port, Sec_Fetch_Site="same-origin", Sec_Fetch_Dest="script")[0] == 200


@pytest.mark.parametrize("path", ["/stream", "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"])
def test_websockets_of_other_pages_are_refused(server: Server, path: str) -> None:
    address, own = f"ws://127.0.0.1:{server.port}{path}", f"http://127.0.0.1:{server.port}"
    for origin in ("http://evil.example", "null", f"http://localhost:{server.port}", f"{own}.evil.example"):
        with pytest.raises(InvalidStatus), connect(address, origin=origin):  # type: ignore[arg-type]
            pass
    rebound = f"ws://evil.example:{server.port}{path}"
    with (
        pytest.raises(InvalidStatus),
        socket.create_connection(("127.0.0.1", server.port)) as connection,
        connect(rebound, sock=connection, origin=f"http://evil.example:{server.port}"),  # type: ignore[arg-type]
    ):
        pass
    with connect(address, origin=own) as welcome:  # type: ignore[arg-type]
        assert welcome.recv(timeout=120)


def test_no_path_leads_to_other_files(server: Server) -> None:
    _, _, page = ask(server.port)
    roots = sorted(set(re.findall(rb'["\'](/_nicegui/[^"\']*/)[^"\'/]*["\']', page)))
    assert roots
    ups = ("../" * 12, "%2e%2e/" * 12, "..%2f" * 12, "%2e%2e%2f" * 12, "..\\" * 12, "..%5c" * 12, "%252e%252e%252f" * 9,
           "/", "%2f", "....//" * 12)  # fmt: skip
    for root in [*(root.decode() for root in roots), "/", "/static/", "/_nicegui/auto/static/"]:
        for up in ups:
            status, _, body = ask(server.port, f"{root}{up}etc/passwd")
            assert b"root:" not in body
            assert status != 500


def test_a_length_that_is_too_much_or_no_number_is_refused(server: Server) -> None:
    for length in ("200000001", "9" * 40, "9" * 5000, "-1", "\xb2", "0x10", "1,1"):
        assert ask(server.port, "/", method="POST", Content_Length=length)[0] in (400, 403), length


@contextmanager
def small_app(token: str | None = None) -> Iterator[tuple[int, list[int]]]:
    """An app that reads whole bodies behind a guard that allows few bytes; its port, and what it has read.

    With a token, which is a code of a class.
    """
    read: list[int] = []

    async def swallow(request: Request) -> PlainTextResponse:
        read.append(len(await request.body()))
        return PlainTextResponse("thanks")

    listener = socket.socket()
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    port = listener.getsockname()[1]
    inner = Starlette(routes=[Route("/", swallow, methods=["POST"])])
    app = Guard(inner, port=port, token=token, coded=token is not None, largest=LIMIT)
    running = uvicorn.Server(uvicorn.Config(app, log_level="critical", lifespan="off"))
    thread = threading.Thread(target=running.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        yield port, read
    finally:
        running.should_exit = True
        thread.join(timeout=120)


def test_a_body_that_never_ends_is_cut_off() -> None:
    head = "POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nTransfer-Encoding: chunked\r\n\r\n"
    chunk = b"2710\r\n" + b"x" * 10_000 + b"\r\n"
    with small_app() as (port, read):
        status, _, body = raw(port, head.format(port=port).encode() + 5 * chunk + b"0\r\n\r\n")
        assert (status, body, read) == (200, b"thanks", [LIMIT])
        status, _, body = raw(port, head.format(port=port).encode() + 6 * chunk)
        assert (status, read) == (413, [LIMIT])
        assert b"too much" in body


def test_a_code_from_the_board_leads_in() -> None:
    """Oracle: status and cookie; letters may be large, and a browser without the code sees a form, not more."""
    code = new_code()
    assert len(set(code)) > 1
    with small_app(code) as (port, read):
        for path in (f"/{code}", f"/{code.upper()}", f"/?token={code}", f"/?token=+{code.title()}+"):
            status, headers, body = ask(port, path)
            assert (status, code in headers["set-cookie"], code.encode() in body) == (200, True, False), path
            assert "Max-Age" in headers["set-cookie"], "not typed again in the next lesson"
        cookie = f"hydrostat_token_{port}={code}"
        assert ask(port, method="POST", Cookie=cookie)[0] == 200
        for path in ("/", f"/{code[:-1]}", f"/{code}x", "/?token=", "/?token=%00", f"/room/{code}"):
            status, headers, body = ask(port, path)
            assert (status, "set-cookie" in headers, b"Class code" in body) == (403, False, True), path
        assert b"Wrong code" in ask(port, "/?token=%3Cscript%3E")[2]
        told = [b"Wrong code" in ask(port, path)[2] for path in ("/", f"/{code}x", "/room/abcdefghijklmnopq")]
        assert told == [False, True, False]
        assert b"action=" not in ask(port, "/room/abcdefghijklmnopq")[2], "the code leads on to the room"
        assert b"<script" not in ask(port, "/?token=%3Cscript%3E")[2]
        assert b"Class code" not in ask(port, f"/{code}", host="evil.example")[2]
    assert read == [0]


@pytest.fixture(scope="module")
def open_server(serving: Callable[..., Server]) -> Server:
    """A studio that other machines can reach."""
    return serving("0.0.0.0")


def test_other_machines_need_the_token(open_server: Server) -> None:
    port, token = open_server.port, open_server.token
    assert len(token) > 16
    wrong = (
        "",
        "token=",
        "token=x",
        f"token={token}x",
        f"token={token[:-1]}",
        f"Token={token}",
        "token=%ff%00",
        "token",
    )
    for query in wrong:
        for path in PATHS:
            for method in ("GET", "HEAD", "OPTIONS", "POST"):
                address = f"{path}{'&' if '?' in path else '?'}{query}"
                assert ask(port, address, method=method)[0] == 403
    for cookie in (
        "",
        "x",
        f"hydrostat_token={token}",
        f"hydrostat_token_{port}=x",
        f"hydrostat_token_{port}",
        "\xff=\xff",
    ):
        assert ask(port, Cookie=cookie)[0] == 403


def test_the_token_becomes_a_cookie_and_leaves_the_address(open_server: Server) -> None:
    port, token = open_server.port, open_server.token
    status, headers, body = ask(port, f"//evil.example/?token={token}")
    assert status == 200
    assert b'url=/"' in body
    assert token.encode() not in body
    assert "location" not in headers
    cookie = headers["set-cookie"]
    assert "httponly" in cookie.lower()
    assert "samesite=strict" in cookie.lower()
    assert ask(port, Cookie=cookie.partition(";")[0])[0] == 200
    assert ask(port, Cookie=f"other=1; {cookie.partition(';')[0]}")[0] == 200
    assert ask(port, Cookie=cookie.partition(";")[0], Origin="http://evil.example")[0] == 403


def test_websockets_need_the_token(open_server: Server) -> None:
    port, token = open_server.port, open_server.token
    address, own = f"ws://127.0.0.1:{port}/stream", f"http://127.0.0.1:{port}"
    with pytest.raises(InvalidStatus), connect(address, origin=own):  # type: ignore[arg-type]
        pass
    cookie = {"Cookie": f"hydrostat_token_{port}={token}"}
    with connect(address, origin=own, additional_headers=cookie) as welcome:  # type: ignore[arg-type]
        assert welcome.recv(timeout=120)


def test_with_a_token_addresses_in_numbers_will_do_but_names_will_not(open_server: Server) -> None:
    port, cookie = open_server.port, f"hydrostat_token_{open_server.port}={open_server.token}"
    assert ask(port, host=f"192.168.0.7:{port}", Cookie=cookie)[0] == 200
    assert ask(port, host=f"[fe80::1]:{port}", Cookie=cookie)[0] == 200
    assert ask(port, host=f"192.168.0.7:{port}")[0] == 403
    assert ask(port, host=f"evil.example:{port}", Cookie=cookie)[0] == 403
