"""`Links`, `share_dialog`: addresses of a room, to work in it together or only to watch; QR codes of links."""

import socket
from collections.abc import Callable
from dataclasses import dataclass
from io import StringIO
from urllib.parse import urlsplit

import segno
from nicegui import ui

from hydrostat.errors import InputError
from hydrostat.studio.face.guard import LOOPBACK
from hydrostat.studio.face.page import show_heading

MAX_CODE_LETTERS = 2900  # letters in a QR code; 2953 bytes fit
_SHOW = "Show it, or write it on the board."


@dataclass(frozen=True)
class Links:
    """The addresses of a room; "" where there is none."""

    work: str  # who opens it works in the room
    watch: str  # who opens it sees the robot, and can change nothing; "": there is none
    home: str = ""  # the studio, which opens a robot in a link

    @property
    def are_local(self) -> bool:
        """True if no other computer can open them."""
        return urlsplit(self.work or self.home).netloc.rpartition(":")[0] in LOOPBACK


def find_network_address() -> str:
    """Address of this computer in its network, by the route that packets to the outside would take; none is sent.

    Raises:
        InputError: it is in no network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # an address of documentation (RFC 5737), never anybody's
        except OSError:
            raise InputError("--class: this computer is in no network. Connect it, or give --host ADDRESS.") from None
        return str(probe.getsockname()[0])


def write_qr_text(link: str) -> str:
    """QR code of a link in block characters, white on black whatever the colors of the terminal."""
    stream = StringIO()
    segno.make(link, error="m").terminal(stream, compact=True)
    return "\n".join(f"\x1b[97;40m{line}\x1b[0m" for line in stream.getvalue().split("\n") if line)


def share_dialog(links: Links, pack: Callable[[], str] | None = None) -> Callable[[], object]:
    """Build the dialog with both addresses, and the robot in a link if a function packs it; returns what opens it."""
    with (
        ui.dialog().props('aria-label="Share"') as dialog,
        ui.card().classes("q-pa-md gap-3").style("width: 520px; max-width: 92vw"),
    ):
        show_heading("Share" if pack is not None else "Link for pupils", 1)
        if links.work and links.are_local:
            hint = "These links open on this computer only. For others, start hydrostat studio --class without --host."
            ui.label(hint).classes("studio-hint").props('data-testid="share-local"')
        for words, hint, link, name in (
            (
                "Work together",
                "People with this link can edit everything." if links.watch else "" if links.are_local else _SHOW,
                links.work,
                "share-work",
            ),
            ("View only", "People with this link see the robot move and cannot edit.", links.watch, "share-watch"),
        ):
            if not link:
                continue
            with ui.column().classes("w-full gap-1"):
                if links.watch:
                    show_heading(words)
                if hint:
                    ui.label(hint).classes("studio-hint")
                _link_box(words, link, name)
                if link == links.work and not links.are_local:
                    _code(words, link, 420 if pack is None else 160)
        robot = ui.column().classes("w-full gap-1")
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat no-caps")

    def show() -> None:
        robot.clear()
        with robot:
            show_heading("Robot in a link")
            try:
                link = f"{links.home}{pack() if pack is not None else ''}"
            except InputError as error:
                ui.label(str(error)).classes("studio-hint").props('data-testid="share-none"')
                return
            hint = "A copy of the robot as it is now. Open it here, or elsewhere with hydrostat studio 'LINK'."
            ui.label(hint).classes("studio-hint")
            _link_box("Robot in a link", link, "share-robot")
            if len(link) <= MAX_CODE_LETTERS and not links.are_local:
                _code("Robot in a link", link, 160 if len(link) < 400 else 480)

    return dialog.open if pack is None else lambda: (show(), dialog.open())


def _link_box(words: str, link: str, name: str) -> None:
    """A link to copy. Pages without encryption have no clipboard but this one."""
    with ui.row().classes("w-full no-wrap items-center gap-1"):
        box = ui.input(value=link).props(f'readonly dense outlined aria-label="{words}" data-testid="{name}"')
        box.classes("w-full studio-figure").on("focus", js_handler="(event) => event.target.select()")
        copy = ui.button(icon="content_copy").props(f'flat round dense aria-label="Copy: {words}"')
        pick = f"document.querySelector('input[data-testid={name}]').select(); document.execCommand('copy')"
        copy.tooltip("Copy").on("click", js_handler=f"() => {{ {pick} }}")


def _code(words: str, link: str, width: int) -> None:
    """QR code of a link, of a width [pixels] if there is room."""
    level = "m" if len(link) < 400 else "l"
    code = segno.make(link, error=level).svg_inline(omitsize=True, dark="#2b2833", light="#ffffff")
    drawn = ui.html(code, sanitize=False).classes("self-center")
    drawn.style(f"width: min({width}px, 100%, 60vh)").props(f'role="img" aria-label="{words}, QR code"')
