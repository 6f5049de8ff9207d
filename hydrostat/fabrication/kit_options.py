"""`KitOptions`: what kind of robot is built, and how."""

from dataclasses import dataclass, field
from enum import StrEnum

from hydrostat.fabrication.moulds.mould_options import MouldOptions
from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.robot import Body

STUFFINGS = ("polyester fibre",)
"""Materials that are stuffed into cloth: a body of them is plush, in space too."""


class Method(StrEnum):
    """How the body is made."""

    PLUSH = "plush"
    FOAM = "foam"


class Paper(StrEnum):
    """What the pages are printed on."""

    A4 = "a4"
    LETTER = "letter"


@dataclass(frozen=True, kw_only=True)
class KitOptions:
    """What kind of robot is built, and how.

    Attributes:
        method: None: plush for a flat body and for one that is stuffed, foam for others.
        motor: key of a motor in the table, or "auto": the first that is strong enough.
        paper: of the pages.
        step: also write each printed part as STEP; needs the extra `cad`.
        force: write what cannot be built well all the same, with the reasons on the sheet.
        pattern: of a plush robot; its `force` is that of the kit.
        parts: of the printed parts.
        mould: of a robot of foam.
    """

    method: Method | None = None
    motor: str = "auto"
    paper: Paper = Paper.A4
    step: bool = False
    force: bool = False
    pattern: PatternOptions = field(default_factory=PatternOptions)
    parts: PartOptions = field(default_factory=PartOptions)
    mould: MouldOptions = field(default_factory=MouldOptions)

    def method_for(self, body: Body) -> Method:
        """How a body is made."""
        stuffed = body.mesh.dim == 2 or body.material.name in STUFFINGS
        return self.method or (Method.PLUSH if stuffed else Method.FOAM)
