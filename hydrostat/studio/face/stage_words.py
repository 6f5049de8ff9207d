"""`STAGES`: what each stage is for, in a line for the help and in more for the tour."""

from dataclasses import dataclass

from hydrostat.studio.stage import StageName


@dataclass(frozen=True, kw_only=True)
class StageWords:
    """What a stage is for.

    Attributes:
        title: as on its button.
        icon: likewise.
        line: for the help.
        tour: for who is here for the first time; "": the tour passes it by.
    """

    title: str
    icon: str
    line: str
    tour: str = ""


STAGES = {
    StageName.START: StageWords(
        title="Start",
        icon="home",
        line="Choose a robot, or bring a drawing, a picture or a scan.",
        tour="Choose a robot of the gallery, open a folder, or bring a drawing, a picture or a scan: "
        "it becomes a soft body.",
    ),
    StageName.EDIT: StageWords(
        title="Edit",
        icon="edit",
        line="Place and move pins, markers, winches and cables; the check looks on.",
    ),
    StageName.POSE: StageWords(
        title="Pose",
        icon="back_hand",
        line="Drag the body as if full of muscle, or let its own winches follow.",
        tour="Take hold of any point and drag: the body bends as if it were full of muscle. "
        "Or let its own winches follow your hand. Keep what you like as a pose.",
    ),
    StageName.DESIGN: StageWords(
        title="Design",
        icon="auto_awesome",
        line="From poses to winches and cables, within what can be built.",
        tour="Say how many winches and cables, paint where none may be, and press Design. "
        "The best network so far appears on the body while it works.",
    ),
    StageName.DRIVE: StageWords(
        title="Drive",
        icon="tune",
        line="Turn the winches by hand, set keyframes, play and record.",
        tour="Turn a knob for each winch. Set keyframes, play them in a loop, record a film, "
        "or take the contractions along as a table.",
    ),
    StageName.EXPORT: StageWords(
        title="Export",
        icon="ios_share",
        line="Take home the kit, a report, pictures and the robot itself.",
        tour="Make the kit: patterns or moulds, parts to print, what to buy, and a sheet to follow. "
        "Then build the robot.",
    ),
}
"""In the order of work."""
