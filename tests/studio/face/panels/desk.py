"""`Desk`: a window on a session, without a browser and without a server."""

import asyncio
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from nicegui import Client, core, events, helpers, ui

from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.studio.face.window import build_window
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName


class IdleJobs(Jobs):
    """Starts no process; what would have been started is in `begun`: titles and arguments."""

    begun: list[tuple[str, tuple[Any, ...]]]

    def warm(self, *modules: str) -> None:
        pass

    def start(self, title: str, function: Callable[..., Any], *arguments: Any, **calls: Any) -> None:
        self.begun.append((title, arguments))


class Desk:
    """What a person sees and does in one window."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.client = Client(ui.page("/"), request=None)
        with self.client:
            self.page = build_window(session)
        self.told: list[str] = []
        self.page.tell = lambda text, tone=None: self.told.append(text)  # type: ignore[method-assign]

    @property
    def robot(self) -> Robot:
        return self.session.document.robot

    @property
    def begun(self) -> list[tuple[str, tuple[Any, ...]]]:
        jobs = self.session.jobs
        assert isinstance(jobs, IdleJobs)
        return jobs.begun

    def beat(self) -> None:
        """Let the page follow the session, as its timer does."""
        with self.client:
            self.page.beat()

    def go(self, stage: StageName) -> None:
        self.session.go(stage)
        self.beat()

    def all(self, name: str) -> list[Any]:
        """Elements with a mark, a data-testid or an aria-label of this name."""
        return [
            element
            for element in self.client.elements.values()
            if name in (*element._markers, element.props.get("data-testid"), element.props.get("aria-label"))
        ]

    def one(self, name: str) -> Any:
        found = self.all(name)
        assert len(found) == 1, f"{len(found)} elements are called {name}"
        return found[0]

    async def press(self, what: str | ui.element, event: str = "click", args: Any = None) -> None:
        """Click it, or let another of its events happen; then the page follows."""
        element = self.one(what) if isinstance(what, str) else what
        with self.client:
            for listener in list(element._event_listeners.values()):
                if listener.type == helpers.event_type_to_camel_case(event):
                    told = events.GenericEventArguments(sender=element, client=self.client, args=args)
                    events.handle_event(listener.handler, told)
        await self.follow()

    async def type(self, name: str, value: Any) -> None:
        """Type a value into a box and press Enter."""
        await self.choose(name, value)
        await self.press(name, "keydown.enter")

    async def choose(self, name: str, value: Any) -> None:
        """Choose a value of a toggle, a select, a switch or a box."""
        with self.client:
            self.one(name).set_value(value)
        await self.follow()

    async def follow(self) -> None:
        """Let what was begun run, and the page show it."""
        for _ in range(5):
            await asyncio.sleep(0)
        self.beat()

    async def until(self, ready: Callable[[], bool]) -> None:
        """Wait for what a thread or a task of the page does."""
        for _ in range(6000):
            self.beat()
            if ready():
                return
            await asyncio.sleep(0.01)
        raise AssertionError("it never came")

    @property
    def words(self) -> list[str]:
        """All words that are shown."""
        own = [element for element in self.client.elements.values() if is_shown(element)]
        return [str(getattr(element, "text", "") or element.props.get("label") or "") for element in own]


def is_shown(element: ui.element) -> bool:
    """Whether neither it nor what it is in is hidden."""
    while element.visible:
        if element.parent_slot is None:
            return True
        element = element.parent_slot.parent
    return False


def at_desk(robot: Robot | None, act: Callable[[Desk], Awaitable[None]]) -> None:
    """Open a window on a session, at the stage "start", and act."""

    async def run() -> None:
        core.loop = asyncio.get_running_loop()
        session = Session()
        session.jobs.__class__, session.jobs.begun = IdleJobs, []  # type: ignore[attr-defined]
        if robot is not None:
            session.document.open(Work(robot=robot))
        desk = Desk(session)
        try:
            await act(desk)
        finally:
            desk.client.delete()
            desk.page.close()
            session.close()

    with ThreadPoolExecutor(1) as apart:  # a browser test before this one may have left a loop running in this thread
        apart.submit(lambda: asyncio.run(run())).result()
