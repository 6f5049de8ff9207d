"""`Bell`: who wants to know that something has changed."""

from collections.abc import Callable
from enum import StrEnum


class Topic(StrEnum):
    """Topic of a change notification."""

    ROBOT = "robot"
    STAGE = "stage"
    SHAPE = "shape"
    SCENE = "items"
    JOB = "job"
    DRIVE = "drive"
    NOTE = "note"
    LOCK = "lock"


Listener = Callable[[Topic], None]  # told what has changed, in the thread that did; returns at once and never raises


class Bell:
    """Tells all listeners what has changed; they look for themselves."""

    def __init__(self) -> None:
        self._listeners: tuple[Listener, ...] = ()

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Be told from now on; returns a function that ends it."""
        self._listeners = (*self._listeners, listener)

        def leave() -> None:
            self._listeners = tuple(other for other in self._listeners if other is not listener)

        return leave

    def ring(self, *topics: Topic) -> None:
        """Tell that these have changed."""
        for listener in self._listeners:
            for topic in topics:
                listener(topic)
