"""`Skins`: whether skins of stuffed bodies in space can be sewn, found in a process beside all else."""

from dataclasses import dataclass, replace
from threading import Lock

from hydrostat.design import Diagnostic, Severity
from hydrostat.errors import InputError
from hydrostat.fabrication import KitOptions, PatternOptions, Sewing
from hydrostat.robot import Body
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.jobs import Jobs, Report, Slots

TITLE = "Flattening the skin, patch by patch"


@dataclass(frozen=True, eq=False)
class SewnSkin:
    """The skin of a body, and what has come to be known of it."""

    body: Body
    pattern: PatternOptions  # that it would be sewn by
    sewing: Sewing | None = None  # None: not known yet, or not found
    error: str = ""  # why it was not found; "" if it was, or is being looked for

    @property
    def is_awaited(self) -> bool:
        """True if the skin is still being computed."""
        return self.sewing is None and not self.error

    @property
    def words(self) -> str:
        """A line for the person, as `hydrostat check` prints it; "" where only the findings are to be told."""
        if self.sewing is None:
            return f"{TITLE} …" if self.is_awaited else f"skin pattern not computed: {self.error}"
        return "" if self.sewing.problems else f"skin: {self.sewing}"

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """Why it cannot be sewn."""
        problems = self.sewing.problems if self.sewing is not None else ()
        return tuple(Diagnostic(text=text, severity=Severity.REFUSED, places=()) for text in problems)


class Skins:
    """Finds what sewing takes, of one skin after the other: the newest that is asked for comes next.

    What was found is remembered for each body, whatever cables are on it and whatever else it is made of.
    """

    def __init__(self, bell: Bell, slots: Slots | None = None) -> None:
        """Ring when something was found; beside other sessions that share slots."""
        self._bell, self._jobs, self._lock = bell, Jobs(bell, slots), Lock()
        self._known: tuple[SewnSkin, ...] = ()
        self._working: SewnSkin | None = None
        self._next: SewnSkin | None = None

    def of(self, body: Body, options: KitOptions) -> SewnSkin | None:
        """The skin of a body; None where a kit by these options sews none in space, or nobody has asked."""
        if not options.sews_skin(body):
            return None
        skins = (self._working, self._next, *self._known)
        return next((skin for skin in skins if skin is not None and _is_of(skin, body, options)), None)

    def look(self, body: Body, options: KitOptions) -> None:
        """Find what sewing the skin takes, unless it is known, asked for, or sewn flat; returns immediately."""
        with self._lock:
            if not options.sews_skin(body) or self.of(body, options) is not None:
                return
            self._next = SewnSkin(body, options.pattern)
        self._begin()

    def close(self) -> None:
        """End immediately."""
        with self._lock:
            self._next = None
        self._jobs.close()

    def _begin(self) -> None:
        """Take the next one, if none is worked on."""
        with self._lock:
            skin = self._next
            if skin is None or self._working is not None:
                return
            self._next, self._working = None, skin
        try:
            self._jobs.start(TITLE, lay_flat, skin.body, skin.pattern, on_done=self._keep, on_end=self._on_end)
        except InputError as error:  # the studio is closing
            self._on_end(str(error))

    def _keep(self, sewing: Sewing) -> None:
        if self._working is not None:
            self._note(replace(self._working, sewing=sewing))

    def _on_end(self, error: str) -> None:
        if error and self._working is not None:
            self._note(replace(self._working, error=error))
        with self._lock:
            self._working = None
        self._bell.ring(Topic.JOB, Topic.SCENE)
        self._begin()

    def _note(self, skin: SewnSkin) -> None:
        kept = 20  # so many skins are remembered
        with self._lock:
            self._known = (skin, *self._known)[:kept]


def lay_flat(report: Report, body: Body, pattern: PatternOptions) -> Sewing:
    """Find what sewing takes (InputError: a flat body)."""
    report.progress(TITLE, 0, 0)
    return Sewing.find(body, options=pattern)


def _is_of(skin: SewnSkin, body: Body, options: KitOptions) -> bool:
    """True if it is the skin of this body, perhaps of another material."""
    same = skin.body.mesh is body.mesh and skin.body.healing is body.healing
    return (same or skin.body == body) and skin.pattern == options.pattern
