"""`Pulse`: the threads that let a session work, and hand what it shows to all screens."""

import logging
import time
from collections.abc import Callable
from functools import partial
from threading import Event, Lock, Thread

from hydrostat.studio.bell import Topic
from hydrostat.studio.jobs import Slots
from hydrostat.studio.session import Session, Tone
from hydrostat.studio.view.picture import Shown

MIN_STEP = 1 / 60
"""One step is taken in this time [s], and one more for each drag that waits for its answer."""

POLL_INTERVAL = 0.25
"""The session is looked at at least so often [s]."""

LONG_STEP = 0.1
"""A step that takes longer [s] does not keep the screens waiting: what changes meanwhile is shown beside it."""

SEEN = (Topic.SHAPE, Topic.SCENE, Topic.ROBOT, Topic.STAGE)
"""Topics that change the picture."""


class Pulse:
    """Works while there is work, sleeps while there is none.

    A thread steps and shows. Where one step takes long, such as the first of a robot, for which kernels may have to be
    compiled, a second thread shows what the pointer changes meanwhile.
    """

    def __init__(self, session: Session, publish: Callable[[Shown], None], turns: Slots | None = None) -> None:
        """Let a session work; `publish` is called in the thread of the pulse. Sessions that share turns take turns."""
        self._session, self._publish, self._turns = session, publish, turns
        self._wake, self._ended = Event(), False
        self._stale = True
        self._stepping: float | None = None  # since when
        self._showing, self._end = Lock(), Event()
        self._leave = session.bell.listen(self._on_topic)
        self._threads = [
            Thread(target=target, name=name, daemon=True)
            for target, name in ((self._run, "studio"), (self._stand_in, "studio, while a step takes long"))
        ]

    def start(self) -> None:
        """Begin."""
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """End; returns when the threads have."""
        self._ended = True
        self._leave()
        self._end.set()
        self._wake.set()
        for thread in self._threads:
            if thread.ident is not None:  # it was begun
                thread.join(timeout=10.0)

    def refresh(self) -> None:
        """Hand over a picture even if nothing has changed, as a new screen needs one."""
        self._stale = True
        self._wake.set()

    def _on_topic(self, topic: Topic) -> None:
        if topic in SEEN:
            self._stale = True
        self._wake.set()

    def _run(self) -> None:
        more = False
        while not self._ended:
            took = (more or self._session.waiting) and self._take_turn()
            self._stepping = begun = time.monotonic()
            self._wake.clear()
            more = self._run_guarded(partial(self._session.step, begun))
            self._stepping = None
            if self._stale or more:
                self._stale = False
                self._run_guarded(self._hand_over)
            if took and self._turns is not None:
                self._turns.give()
            self._pause(begun + MIN_STEP)
            if not more and not self._stale:
                self._wake.wait(POLL_INTERVAL)

    def _take_turn(self) -> bool:
        """Wait for a turn; whether one is to be given back. A wait that can be felt is shown with the picture."""
        if self._turns is None:
            return False
        line, begun = [0], time.monotonic()
        took = self._turns.wait(lambda: self._ended, lambda before: line.append(before + 1))
        self._session.before = max(line) if time.monotonic() - begun > LONG_STEP else 0
        return took

    def _stand_in(self) -> None:
        """Show what has changed while one step takes long."""
        while not self._end.wait(LONG_STEP):
            since = self._stepping
            if self._stale and since is not None and time.monotonic() - since > LONG_STEP:
                self._stale = False
                self._run_guarded(self._hand_over)

    def _pause(self, until: float) -> None:
        """Sleep until a time, or until a drag waits for its answer."""
        while (left := until - time.monotonic()) > 0:
            self._wake.clear()
            if self._session.waiting or self._ended:
                return
            self._wake.wait(left)

    def _hand_over(self) -> bool:
        with self._showing:
            shown = self._session.current_view()
            if shown is not None:
                self._publish(shown)
        return False

    def _run_guarded(self, action: Callable[[], bool]) -> bool:
        """The studio must go on whatever happens; what did is logged and told."""
        try:
            return action()
        except Exception as error:
            logging.getLogger("hydrostat").exception("error in the studio")
            words = f"internal error: {type(error).__name__}: {error}"
            if not self._session.notes or self._session.notes[-1].text != words:
                self._session.tell(words, Tone.BAD)
            time.sleep(POLL_INTERVAL)
            return False
