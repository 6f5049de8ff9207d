"""`KitOptions`: fabrication method, motor, and options for the pattern, the printed parts and the mold."""

import math
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any

from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.fabrication.board_kind import check_board
from hydrostat.given import check_number
from hydrostat.robot import Body, Robot

PRINTED = ("tpu 85a",)  # materials of filament: a body of them is printed in one piece
CASTABLE = ("flexfoam-it", "ecoflex", "dragon skin")  # beginnings of names of materials that are poured
STUFFINGS = ("polyester fibre",)  # materials that are stuffed into cloth: a body of them is plush, in space too

BLOCKS = ("polyurethane foam", "polyethylene foam")  # materials that are bought as blocks and cut

MATERIAL_FIX = "Set the body's material to"
"""Words of each reason for which a kit needs another material."""

OVER_BUDGET = "more than the budget of"
"""Words of the reason that a kit costs too much."""


def block_problem(name: str) -> str:
    """Return the reason why no method makes a body of a foam that comes in blocks."""
    return (
        f'no method of the kit makes a body of "{name}". Cut it from a block by hand, and take all else from a kit '
        f'with --force. {MATERIAL_FIX} "{STUFFINGS[0]}" to sew it, "flexfoam-it x" to cast it or "{PRINTED[0]}" to '
        "print it, and simulate again"
    )


class Corner(StrEnum):
    """Way in which the cut goes round an outward corner of the seam."""

    ROUND = "round"
    MITRE = "mitre"


class MoldKind(StrEnum):
    """Material that the mold is made of."""

    PRINTED = "printed"
    SILICONE = "silicone"


class StopperKind(StrEnum):
    """End of a cable: a cleat that the line is wound round by hand, or the clamp of Chang (2018) with a screw."""

    CLEAT = "cleat"
    SCREW = "screw"


class Method(StrEnum):
    """Method by which the body is made."""

    PLUSH = "plush"
    FOAM = "foam"
    PRINT = "print"


class Paper(StrEnum):
    """Paper that the pages are printed on."""

    A4 = "a4"
    LETTER = "letter"
    A3 = "a3"


def _check_sizes(options: Any, *, above_zero: tuple[str, ...]) -> None:
    """Refuse numbers that are negative or not finite, and 0 for those of some names (InputError: one is)."""
    for item in fields(options):
        value, least = getattr(options, item.name), item.name in above_zero
        if isinstance(item.default, float):
            check_number(item.name, value, "" if item.name == "spare_wraps" else "mm")
        if isinstance(value, float | int) and not (math.isfinite(value) and (value > 0 if least else value >= 0)):
            unit = "" if item.name == "spare_wraps" else " mm"
            raise InputError(
                f"{item.name} must {f'be above 0{unit}' if least else 'not be negative'}, not {value:g}{unit}"
            )


@dataclass(frozen=True, kw_only=True)
class PatternOptions:
    """Choices for a pattern; lengths in millimeters, as everywhere in fabrication.

    Attributes:
        seam_allowance: width of cloth between the seam and the cut [mm].
        corner: shape of the cut at an outward corner.
        pinhole: diameter of the hole for a cable [mm].
        cloth: minimum width of cloth between a pinhole and the seam [mm].
        gap: distance between the panels, and margin of the sheet [mm].
        back_pinholes: True to cut the mirrored pinholes in the back panel too.
        marker_names: True to draw the markers with their names.
        opening_reach: distance by which the opening passes the outermost winches [mm]; 0 for no opening.
        gusset: True to sew a strip of cloth between front and back, which makes the body as thick as simulated. None:
            only if two stuffed panels alone would stay thinner. A limb that is thinner than simulated is softer, holds
            less cable, and is harder to turn right side out; the price is a second seam round the body.
        gusset_piece: longest piece of that strip, its seam allowances not counted [mm].
        force: True to draw the pattern even if it cannot be cut well; `Pattern.problems` then holds the reasons.

    Raises:
        InputError: a length out of its range, or a text that is no corner.
    """

    seam_allowance: float = 8.0
    corner: Corner = Corner.ROUND
    pinhole: float = 2.0
    cloth: float = 1.5
    gap: float = 10.0
    back_pinholes: bool = False
    marker_names: bool = False
    opening_reach: float = 30.0
    gusset: bool | None = None
    gusset_piece: float = 400.0
    force: bool = False

    def __post_init__(self) -> None:
        make_member(self, "corner", Corner)
        _check_sizes(self, above_zero=("pinhole",))
        shortest = 50.0  # a piece of the gusset that is still worth sewing [mm]
        if self.gusset_piece < shortest:
            raise InputError(f"gusset_piece must be at least {shortest:g} mm, not {self.gusset_piece:g} mm")


@dataclass(frozen=True, kw_only=True)
class PartOptions:
    """Sizes that depend on the printer and on the parts that you buy; lengths in millimeters.

    Attributes:
        clearance: gap between parts that move in each other, on each side [mm].
        fit: gap between parts that are pressed into each other, on each side [mm].
        wall: minimum wall thickness [mm].
        cable: diameter of the cable, a braided line [mm].
        tube: outer diameter of the PTFE sheath [mm].
        bore: inner diameter of the sheath [mm].
        run: distance between the base of winches outside the body and the body [mm].
        spare_wraps: turns of cable that stay on a spool at maximum payout.
        grommets: True to print a grommet for each pinhole.
        stopper: end of each cable.
        swap: True for a base whose cores are swapped: tubes end in a plate of their own, lines have couplers.

    Raises:
        InputError: a number out of its range, or a text that is no kind of stopper.
    """

    clearance: float = 0.3
    fit: float = 0.15
    wall: float = 1.6
    cable: float = 0.4
    tube: float = 2.0
    bore: float = 1.0
    run: float = 100.0
    spare_wraps: float = 2.0
    grommets: bool = True
    stopper: StopperKind = StopperKind.CLEAT
    swap: bool = False

    def __post_init__(self) -> None:
        make_member(self, "stopper", StopperKind)
        _check_sizes(self, above_zero=("wall", "cable", "tube", "bore"))
        if not self.cable < self.bore < self.tube:
            raise InputError(
                f"cable {self.cable:g} mm, bore {self.bore:g} mm and tube {self.tube:g} mm must rise: "
                "the cable runs in the bore of the tube"
            )


@dataclass(frozen=True, kw_only=True)
class MoldOptions:
    """Choices for a mold; lengths in millimeters.

    Attributes:
        kind: material of the mold: printed halves, or silicone cast round a printed positive (R52).
        wall: minimum thickness round the body [mm].
        bed: largest piece that the printer takes, along x, y and z [mm].
        key_clearance: gap between a key and its socket, on each side [mm].
        pocket_clearance: gap between a winch in the body and the foam, on each side [mm].
        mark_cables: True to mark the cable paths by dents in the foam.
        mark_depth: maximum depth of the cable points that are marked [mm].

    Raises:
        InputError: a length that is not above 0 (a clearance of pockets may be 0), or a text that is no kind of mold.
    """

    kind: MoldKind = MoldKind.PRINTED
    wall: float = 8.0
    bed: tuple[float, float, float] = (220.0, 220.0, 250.0)
    key_clearance: float = 0.2
    pocket_clearance: float = 1.0
    mark_cables: bool = True
    mark_depth: float = 10.0

    def __post_init__(self) -> None:
        make_member(self, "kind", MoldKind)
        _check_sizes(self, above_zero=("wall", "key_clearance", "mark_depth"))
        for axis, side in enumerate(self.bed):
            if not (math.isfinite(side) and side > 0):
                raise InputError(f"bed[{axis}] must be above 0 mm, not {side:g} mm")


@dataclass(frozen=True, kw_only=True)
class KitOptions:
    """Options for the kit of a robot.

    Attributes:
        method: fabrication method. None: print for filament, foam for what is poured, plush for a flat or stuffed body.
        motor: key of a motor in the table, or "auto": that of the robot, else the cheapest that fits, is strong enough
            and not slow.
        budget: maximum price of the kit in whole packs [USD]; None: no limit.
        board: kind of board for motors without a bus, such as "esp32s3"; None: the smallest Arduino.
        tension: maximum cable tension in its poses [N], for the choice of motors and lines. None: the limit of its
            winches. A designed robot keeps to the limit of its design.
        torque: maximum torque of a winch in its poses [N m], as the tension.
        paper: paper size of the pages; assembly sheets for A3 are of A4.
        cautions: further warnings for the page of wires, a sentence each.
        left_out: parts that a simple version leaves out, for the first page.
        step: also write each printed part as STEP; needs the extra `cad`.
        force: True to write a kit that cannot be built well, with the reasons on the sheet.
        pattern: options for the pattern of a plush robot; its `force` is that of the kit.
        parts: options for the printed parts.
        mould: options for the mold of a foam robot.

    Raises:
        InputError: a text that is no method, paper or board, a tension, torque or budget that is not above 0.
    """

    method: Method | None = None
    motor: str = "auto"
    budget: float | None = None
    board: str | None = None
    tension: float | None = None
    torque: float | None = None
    paper: Paper = Paper.A4
    cautions: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    step: bool = False
    force: bool = False
    pattern: PatternOptions = field(default_factory=PatternOptions)
    parts: PartOptions = field(default_factory=PartOptions)
    mould: MoldOptions = field(default_factory=MoldOptions)

    def __post_init__(self) -> None:
        if self.method is not None:
            make_member(self, "method", Method)
        make_member(self, "paper", Paper)
        if self.board is not None:
            check_board(self.board)
        for name, unit in (("tension", "N"), ("torque", "N m"), ("budget", "USD")):
            value = getattr(self, name)
            if value is None:
                continue
            check_number(name, value, unit)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"{name} must be above 0 {unit}, not {value:g} {unit}")

    def motor_for(self, robot: Robot) -> str:
        """Key of the motor: that of the options, else that of the robot."""
        return robot.motor if self.motor == "auto" else self.motor

    def method_for(self, body: Body) -> Method:
        """Method by which a body is made."""
        if self.method is not None:
            return self.method
        name = body.material.name
        if name in PRINTED:
            return Method.PRINT
        flat = body.mesh.dim == 2 and not name.startswith(CASTABLE)
        return Method.PLUSH if flat or name in STUFFINGS else Method.FOAM

    def sews_skin(self, body: Body) -> bool:
        """Return True if the kit sews a skin that is cut and flattened: for a stuffed body in space."""
        return body.mesh.dim == 3 and self.method_for(body) is Method.PLUSH
