"""`Judge`: what is said of the robots that are shown, alike in Edit, Design and Export."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from hydrostat.design import Diagnostic, Severity, places_in, review_robot
from hydrostat.errors import HydrostatError
from hydrostat.fabrication import Demand, KitOptions, find_refusals
from hydrostat.project import Wishes
from hydrostat.robot import Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.jobs import Slots
from hydrostat.studio.skins import SewnSkin, Skins

QUIET = 0.2  # a robot is judged when it is shown unchanged for so long [s]
CACHE_SIZE = 80  # robots that are kept, the candidates of some designs among them


@dataclass(frozen=True, eq=False)
class _RobotFacts:
    """Facts about a robot that other work has found."""

    robot: Robot
    demand: Demand | None = None  # loads of its poses, as a design has found them
    torque: float | None = None  # torque limit of its design [N m]
    refused: tuple[str, ...] = ()  # sentences with which a kit of it was refused


@dataclass(frozen=True, eq=False)
class _Review:
    """A robot that was judged, with all that it was judged by."""

    robot: Robot
    wishes: Wishes
    options: KitOptions
    known: _RobotFacts | None
    said: tuple[Diagnostic, ...]


@dataclass(frozen=True, eq=False)
class _KitVerdict:
    """A network of a design that was looked at for what a kit is refused for, with all that counted."""

    robot: Robot
    options: KitOptions
    known: _RobotFacts | None
    refused: bool


class Judge:
    """Judges robots as they rest, and remembers what was said; a finding can be chosen, to be marked and read.

    Where a design has solved the poses of a robot their loads count; else only what holds whatever they ask. A kit that
    was refused adds its reasons, and so does a skin that cannot be sewn, which is found beside.
    """

    def __init__(self, bell: Bell, slots: Slots | None = None) -> None:
        """Ring when something is to be said; long work waits for slots that other sessions share."""
        self.skins = Skins(bell, slots)  # of bodies that are sewn
        self.options = KitOptions()  # of the kit that the next judgement is for
        self.chosen: Diagnostic | None = None  # that is shown with its words
        self._bell = bell
        self._known: tuple[_RobotFacts, ...] = ()
        self._reviews: tuple[_Review, ...] = ()
        self._verdicts: tuple[_KitVerdict, ...] = ()
        self._seen: tuple[Robot, Wishes, KitOptions, float] | None = None

    def of(self, robot: Robot, wishes: Wishes) -> tuple[Diagnostic, ...] | None:
        """Return the findings on a robot; None until it has been reviewed."""
        review = self._review_of(robot, wishes)
        if review is None:
            return None
        skin = self.skin(robot)
        told = {finding.text for finding in review.said}
        more = () if skin is None else (finding for finding in skin.findings if finding.text not in told)
        return (*more, *review.said)

    def skin(self, robot: Robot) -> SewnSkin | None:
        """The skin of a robot that is sewn in space, once it was looked at; None for others."""
        return self.skins.of(robot.body, self.options)

    def look(self, robot: Robot, wishes: Wishes, now: float, *, held: bool = False) -> None:
        """Judge a robot that is shown once it has rested, unless it is held or was judged [s]."""
        if self._review_of(robot, wishes) is not None:
            self.skins.look(robot.body, self.options)
            return
        seen = self._seen
        if seen is None or seen[0] is not robot or seen[1] != wishes or seen[2] != self.options:
            self._seen = (robot, wishes, self.options, now)
        elif now - seen[3] >= QUIET and not held:
            options, known = self.options, self._of(robot)
            review = _Review(robot, wishes, options, known, _all_findings(robot, wishes, options, known))
            self._reviews = (review, *self._reviews)[:CACHE_SIZE]
            self.skins.look(robot.body, options)
            self._bell.ring(Topic.JOB, Topic.SCENE)

    def is_refused(self, robot: Robot) -> bool | None:
        """True if a kit of a network that `review_kits` has reviewed would be refused; None: not known."""
        verdict = self._verdict_of(robot)
        return None if verdict is None else verdict.refused

    def review_kits(self, robots: Iterable[Robot]) -> None:
        """Look at one of some networks that nobody has looked at yet: whether a kit of it would be refused."""
        robot = next((robot for robot in robots if self._verdict_of(robot) is None), None)
        if robot is not None:
            options, known = self.options, self._of(robot)
            verdict = _KitVerdict(robot, options, known, _is_refused(robot, options, known))
            self._verdicts = (verdict, *self._verdicts)[:CACHE_SIZE]
            self._bell.ring(Topic.JOB)

    def torque_limit(self, robot: Robot) -> float | None:
        """Torque limit of the design that found a robot's network [N m]; None: no design or no limit."""
        known = self._of(robot)
        return None if known is None else known.torque

    def learn(
        self,
        robot: Robot,
        *,
        demand: Demand | None = None,
        torque: float | None = None,
        refused: tuple[str, ...] = (),
    ) -> None:
        """Remember the loads of a robot's poses with the torque limit of their design, or why a kit was refused."""
        before = self._of(robot) or _RobotFacts(robot)
        if demand is not None:
            before = replace(before, demand=demand, torque=torque)
        known = replace(before, robot=robot, refused=refused or before.refused)
        self._known = (known, *(other for other in self._known if not _alike(other.robot, robot)))[:CACHE_SIZE]
        self._seen = None
        self._bell.ring(Topic.JOB, Topic.SCENE)

    def choose(self, finding: Diagnostic | None) -> None:
        """Show a finding with its words; chosen again or None: none."""
        self.chosen = None if finding == self.chosen else finding
        self._bell.ring(Topic.JOB, Topic.SCENE)

    def _review_of(self, robot: Robot, wishes: Wishes) -> _Review | None:
        known = self._of(robot)
        return next(
            (
                review
                for review in self._reviews
                if review.robot is robot
                and review.wishes == wishes
                and review.options == self.options
                and review.known is known
            ),
            None,
        )

    def _verdict_of(self, robot: Robot) -> _KitVerdict | None:
        known = self._of(robot)
        return next(
            (
                one
                for one in self._verdicts
                if one.robot is robot and one.known is known and one.options == self.options
            ),
            None,
        )

    def _of(self, robot: Robot) -> _RobotFacts | None:
        return next((known for known in self._known if _alike(known.robot, robot)), None)


def _alike(one: Robot, other: Robot) -> bool:
    """True if two robots have the same body, network, poses and motor, so that facts about one hold for the other."""
    return one is other or (
        one.body is other.body
        and one.winches == other.winches
        and one.cables == other.cables
        and one.poses == other.poses
        and one.motor == other.motor
    )


def _all_findings(
    robot: Robot, wishes: Wishes, options: KitOptions, known: _RobotFacts | None
) -> tuple[Diagnostic, ...]:
    """All findings, the reasons of a refused kit among them; what cannot be judged is not said."""
    try:
        constraints = wishes.to_constraints(robot)
        demand = None if known is None else known.demand
        found = review_robot(robot, demand=demand, constraints=constraints, options=options)
    except HydrostatError:
        return ()
    told = {finding.text for finding in found}
    more = (text for text in (known.refused if known else ()) if text not in told)
    return (*(Diagnostic(text=text, severity=Severity.REFUSED, places=places_in(text, robot)) for text in more), *found)


def _is_refused(robot: Robot, options: KitOptions, known: _RobotFacts | None) -> bool:
    """True if a kit would be refused for any reason; a robot that cannot be reviewed has none."""
    try:
        return bool((known and known.refused) or find_refusals(robot, known.demand if known else None, options=options))
    except HydrostatError:
        return False
