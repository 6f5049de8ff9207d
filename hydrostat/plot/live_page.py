"""`LivePage`: a page of this machine that shows pictures as they come, while something runs."""

import html
import io
import sys
import webbrowser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Condition, Thread
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from PIL import Image

from hydrostat.plot.frame_pictures import Picture


class LivePage:
    """Shows the newest picture in the browser; one that nobody looks at is not even made a file of.

    It listens at 127.0.0.1 only, answers to that name of this machine only, and takes nothing.
    """

    def __init__(self, title: str, *, browser: bool = True) -> None:
        """A page with a title; the first picture opens it in the browser, unless that is not wanted."""
        self._title, self._browser = title, browser
        self._server: ThreadingHTTPServer | None = None
        self._news, self._number, self._ended = Condition(), 0, False
        self._picture: Picture = np.zeros((1, 1, 3), np.uint8)
        self._file: tuple[int, bytes] = (0, b"")

    def __reduce__(self) -> tuple[type["LivePage"], tuple[str]]:
        """Make again, without pictures, what is copied or sent: a page is where it was opened."""
        return LivePage, (self._title,)

    @property
    def address(self) -> str:
        """Start the server if it is not running, and return the address of the page."""
        if self._server is None:
            self._ended = False
            self._server = _Server(("127.0.0.1", 0), _handler(self))
            Thread(target=self._server.serve_forever, daemon=True).start()
        return f"http://127.0.0.1:{self._server.server_port}/"

    def show(self, picture: Picture) -> None:
        """Show a picture, in place of the one before."""
        with self._news:
            self._picture, self._number = picture, self._number + 1
            self._news.notify_all()
        if self._browser:
            self._browser = False
            webbrowser.open(self.address)

    def close(self) -> None:
        """End it; browsers keep the last picture."""
        if self._server is not None:
            self._server.shutdown()
            with self._news:
                self._ended = True
                self._news.notify_all()
            self._server.server_close()
            self._server = None

    def names(self) -> tuple[str, ...]:
        """Hosts that it answers to: a page of another site could give its own name our address."""
        port = self._server.server_port if self._server else 0
        return f"127.0.0.1:{port}", f"localhost:{port}"

    def page(self) -> bytes:
        """The page itself."""
        return _PAGE.replace("TITLE", html.escape(self._title)).encode()

    def newer(self, number: int) -> tuple[int, bytes] | None:
        """A picture newer than that of a number, as PNG, with its own number; None if none comes for a while."""
        timeout = 20.0  # Seconds that a request waits for news
        with self._news:
            self._news.wait_for(lambda: self._number > number or self._ended, timeout)
            if self._number <= number:
                return None
            if self._file[0] != self._number:
                file = io.BytesIO()
                Image.fromarray(self._picture).save(file, "PNG", compress_level=1)
                self._file = self._number, file.getvalue()
            return self._file


class _Server(ThreadingHTTPServer):
    """Says nothing of a browser that has gone while it waited; that is no fault of the run."""

    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _handler(live: LivePage) -> type[BaseHTTPRequestHandler]:
    """Return the class of HTTP handlers for a page."""

    class Answers(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked = urlsplit(self.path)
            if self.headers.get_all("host") not in [[name] for name in live.names()]:
                self._send(403, b"this page is not reached by that name\n")
            elif asked.path == "/":
                self._send(200, live.page(), "text/html; charset=utf-8")
            elif asked.path == "/picture":
                after = parse_qs(asked.query).get("after", ["0"])[0]
                found = live.newer(int(after) if after.isascii() and after.isdigit() and len(after) < 16 else 0)
                number, file = found or (0, b"")
                self._send(200 if found else 204, file, "image/png", number)
            else:
                self._send(404, b"there is nothing here\n")

        def _send(self, status: int, body: bytes, kind: str = "text/plain", number: int = 0) -> None:
            self.send_response(status)
            told = {**_HEADERS, "content-type": kind, "content-length": str(len(body)), "x-number": str(number)}
            for name, value in told.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing: the run has its own words."""

    return Answers


_HEADERS = {
    "cache-control": "no-store",
    "content-security-policy": "default-src 'self' blob: data: 'unsafe-inline'; frame-ancestors 'none'",
    "cross-origin-resource-policy": "same-origin",
    "x-content-type-options": "nosniff",
}

_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>TITLE</title>
<meta name="viewport" content="width=device-width"><link rel="icon" href="data:,">
<style>
  body { margin: 0; font: 15px/1.5 system-ui, sans-serif; color: #2b2833; background: #f3f1f5; text-align: center }
  h1 { font-size: 1.1rem; margin: 1.2rem 0 .8rem }
  img { max-width: min(94vw, 960px); width: 100%; border-radius: 12px; background: #fff; min-height: 40vh }
  p { color: #85808f; min-height: 1.5em }
</style>
<h1>TITLE</h1>
<img alt="what is to be seen now">
<p role="status">waiting for the first picture</p>
<script>
  const image = document.querySelector("img"), told = document.querySelector("p");
  (async () => {
    for (let after = 0; ; ) {
      try {
        const got = await fetch("picture?after=" + after);
        if (got.status !== 200) continue;
        after = Number(got.headers.get("x-number"));
        const before = image.src;
        image.src = URL.createObjectURL(await got.blob());
        URL.revokeObjectURL(before);
        told.textContent = "";
      } catch {
        told.textContent = "It has ended; this was the last picture.";
        return;
      }
    }
  })();
</script></html>
"""
