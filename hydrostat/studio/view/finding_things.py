"""`finding_things`: what is said of a robot, as rings where it is and in the words of the screen."""

from collections.abc import Iterable

from hydrostat.design import Diagnostic, Severity
from hydrostat.drawing import SEAM
from hydrostat.robot import Mount, Robot, in_words
from hydrostat.studio.view.things import Dot, Look, Thing

TONES = {Severity.REFUSED: "#c8243f", Severity.LIMIT: "#6d6875", Severity.MIND: SEAM}  # colour of each weight
BRIEF = 64  # letters that are written beside a ring


def finding_things(robot: Robot, said: Iterable[Diagnostic], chosen: Diagnostic | None = None) -> list[Thing]:
    """A ring at each place of each finding; its words are seen where it is chosen, or its part under the pointer."""
    loose = {f"winch:{winch.name}" for winch in robot.winches if winch.mount is Mount.WORLD}
    things: list[Thing] = []
    most = 24  # rings of one finding: more say no more
    for finding in said:
        words = in_words(finding.text)
        label = words if len(words) <= BRIEF else words[: BRIEF - 1].rsplit(" ", 1)[0].rstrip(",;:") + " …"
        things += [
            Dot(
                at=place.at,
                look=Look.FLAG,
                colour=TONES[finding.weight],
                label=label,
                about=place.part,
                stuck=place.part not in loose,
                chosen=finding == chosen,
            )
            for place in finding.places[:most]
        ]
    return things
