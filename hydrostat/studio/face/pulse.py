"""`Pulse`: the thread that lets a session work, and hands what it shows to all screens."""

import logging
import time
from collections.abc import Callable
from functools import partial
from threading import Event, Thread

from hydrostat.studio.bell import Topic
from hydrostat.studio.session import Session, Tone
from hydrostat.studio.view.picture import Shown

SHORTEST = 1 / 60
"""One step is taken in this time [s], and one more for each drag that waits for its answer."""

PATIENCE = 0.25
"""The session is looked at at least so often [s]."""

SEEN = (Topic.SHAPE, Topic.THINGS, Topic.ROBOT, Topic.STAGE)
"""What changes the picture."""


class Pulse:
    """Works while there is work, sleeps while there is none."""

    def __init__(self, session: Session, publish: Callable[[Shown], None]) -> None:
        """Let a session work; `publish` is called in the thread of the pulse."""
        self._session, self._publish = session, publish
        self._wake, self._ended = Event(), False
        self._stale = True
        self._leave = session.bell.listen(self._hear)
        self._thread = Thread(target=self._run, name="studio", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End; returns when the thread has."""
        self._ended = True
        self._leave()
        self._wake.set()
        self._thread.join(timeout=10.0)

    def refresh(self) -> None:
        """Hand over a picture even if nothing has changed, as a new screen needs one."""
        self._stale = True
        self._wake.set()

    def _hear(self, topic: Topic) -> None:
        if topic in SEEN:
            self._stale = True
        self._wake.set()

    def _run(self) -> None:
        while not self._ended:
            begun = time.monotonic()
            self._wake.clear()
            more = self._guarded(partial(self._session.step, begun))
            if self._stale or more:
                self._stale = False
                self._guarded(self._hand_over)
            self._pause(begun + SHORTEST)
            if not more and not self._stale:
                self._wake.wait(PATIENCE)

    def _pause(self, until: float) -> None:
        """Sleep until a time, or until a drag waits for its answer."""
        while (left := until - time.monotonic()) > 0:
            self._wake.clear()
            if self._session.waiting or self._ended:
                return
            self._wake.wait(left)

    def _hand_over(self) -> bool:
        shown = self._session.shown()
        if shown is not None:
            self._publish(shown)
        return False

    def _guarded(self, action: Callable[[], bool]) -> bool:
        """The studio must go on whatever happens; what did is logged and told."""
        try:
            return action()
        except Exception as error:
            logging.getLogger("hydrostat").exception("the studio stumbled")
            words = f"something went wrong: {type(error).__name__}: {error}"
            if not self._session.notes or self._session.notes[-1].text != words:
                self._session.tell(words, Tone.BAD)
            time.sleep(PATIENCE)
            return False
