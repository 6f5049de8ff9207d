"""`Trail`: what was held before each drag, so that drags can be undone."""

from collections.abc import Mapping
from dataclasses import dataclass

from hydrostat.project import Work
from hydrostat.studio.document import Document
from hydrostat.studio.posing.held import HeldPoint

MOST_STEPS = 200  # so many drags can be undone


@dataclass(frozen=True, kw_only=True, eq=False)
class _Step:
    """A drag, or another change of what is held."""

    label: str  # such as "drag tip"
    work: Work  # of the document when it was done
    held: Mapping[str, HeldPoint]  # before it; of one that was undone, after it


class Trail:
    """Drags beside the changes of the document: each is undone while the work is the one it was made on.

    So what was dragged after a change is undone before that change, and what was dragged before it after it.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self._past: list[_Step] = []
        self._future: list[_Step] = []

    @property
    def undo_label(self) -> str:
        """Label of the drag that undo takes back; "" if the document has to be undone first, or nothing was dragged."""
        return self._label(self._past)

    @property
    def redo_label(self) -> str:
        """Label of the drag that redo makes again; "" if there is none."""
        return self._label(self._future)

    def note(self, label: str, held: Mapping[str, HeldPoint]) -> None:
        """Note that something is done now to what was held."""
        self._past.append(_Step(label=label, work=self._document.work, held=held))
        del self._past[:-MOST_STEPS]
        self._future = []

    def undo(self, held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        """Return the points held before the last step; `held` are held now. Call only if there is an `undo_label`."""
        return self._move(self._past, self._future, held)

    def redo(self, held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        """Return the points held after the step that was undone last. Call only if there is a `redo_label`."""
        return self._move(self._future, self._past, held)

    def _label(self, steps: list[_Step]) -> str:
        return steps[-1].label if steps and steps[-1].work is self._document.work else ""

    def _move(self, source: list[_Step], goal: list[_Step], held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        step = source.pop()
        goal.append(_Step(label=step.label, work=step.work, held=held))
        return step.held
