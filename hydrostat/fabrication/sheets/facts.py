"""`SheetData`: the facts of a sheet by the keys that its templates use; a test compares the keys with the templates."""

from typing import Literal, TypedDict

PictureName = Literal[
    "portrait",
    "map",
    "map_both",
    "winch",
    "stopper",
    "base",
    "seat",
    "mould",
    "undercut",
    "stitches",
    "skin",
    "calibration",
    "wiring",
]
"""Pictures that templates place by name."""


class TableFacts(TypedDict):
    """A table of texts."""

    file: str  # in which all of its rows are
    heads: list[str]  # heading of each column
    right: list[bool]  # True for each right-aligned column
    rows: list[list[str]]


class StepFacts(TypedDict):
    """A step of the assembly."""

    title: str
    time: str  # about how long it takes
    text: str


class SummaryFacts(TypedDict):
    """Difficulty, time, cost or another demand of building a robot."""

    title: str
    lines: list[str]  # sentences


class WinchFacts(TypedDict):
    """A winch."""

    mark: str  # W1, W2, ...
    files: str  # files of the parts that it does not share with all others
    name: str
    cables: str  # names of its cables
    spool: str  # diameter of its spool [mm]


class PieceFacts(TypedDict):
    """A printed or bought piece."""

    number: str  # in the pictures; empty if it is not drawn
    title: str
    count: str
    files: str  # it is printed from


class CheckFacts(TypedDict):
    """A check of the kit on itself."""

    what: str  # the claim
    measured: str
    allowed: str
    passed: bool


class MoldFacts(TypedDict):
    """A mold and its fill."""

    undercut: str  # sentences on the surface that does not slide out
    amounts: list[list[str]]  # names and amounts of materials
    ratio: str  # sentence on the mixing ratio
    pieces: list[str]  # numbers and names of the drawn pieces


class PowerFacts(TypedDict):
    """Power supply and wires."""

    rows: list[list[str]]  # parts and settings of the supply
    warnings: list[str]  # sentences on what may go wrong
    start: list[str]  # steps from the first volt to the first move
    title: str  # title of the table of pins
    heads: list[str]  # heading of each column of that table
    pins: list[list[str]]  # its rows


class PictureFacts(TypedDict):
    """A picture."""

    svg: str
    width: float  # [mm]


class SheetFacts(TypedDict):
    """Words and numbers of a sheet."""

    paper: str
    method: str
    title: str  # name of the robot
    pairs: int  # number of cables that have a twin on the other panel
    inserts: bool  # True if parts or rods are put in
    flat: bool  # True for a flat body
    kind: str  # kind of robot, in words
    facts: list[str]  # size, number of parts, time and cost, a line each
    summary: list[SummaryFacts]  # what building it asks
    mind: list[str]  # problems and warnings
    forced: bool  # True if the kit was written despite problems
    bill: TableFacts
    cables: TableFacts | None  # to cut; None without cables
    tubes: TableFacts | None  # to cut; None without tubes
    log: list[str]  # names of the cables to calibrate
    calibration: list[str]  # steps that set their zeros
    safety: list[str]  # hazards
    checklist: list[str]  # what to look at before the first pose
    winches: list[WinchFacts]
    pieces: list[PieceFacts]
    shown: str  # name of the cable whose stitches are drawn
    motor: str
    steps: list[list[StepFacts]]  # a list for each page
    checks: list[CheckFacts]
    mould: MoldFacts | None
    power: PowerFacts | None
    other_way: list[str]  # title and text of another way to a mold; empty without a mold
    cures: list[list[str]]  # materials and times of cure


class SheetData(SheetFacts):
    """Words, numbers and pictures of a sheet."""

    pictures: dict[PictureName, PictureFacts]
    singles: list[PictureFacts]  # pages of maps with one cable each
