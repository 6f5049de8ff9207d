"""`Motor`: a geared motor that turns a winch, and the table of those that the parts are made for.

All motors stand alike: the shaft is the z axis, the face that is screwed on lies in z = 0, the body is below it.
"""

import math
from dataclasses import dataclass, replace

from hydrostat.errors import InputError
from hydrostat.fabrication.solids.construct import Box, Construction, Corner, Cuboid, Cylinder, segments
from hydrostat.given import list_choices


@dataclass(frozen=True, kw_only=True)
class FaceScrew:
    """A screw with a pan head that holds something on a motor; lengths in millimeters."""

    size: str  # size of the thread, such as "M2"
    hole: float  # diameter of a printed hole that it passes freely [mm]
    head: float  # diameter of its head [mm], ISO 7045
    head_height: float  # height of its head [mm], ISO 7045
    depth: float  # maximum depth in the motor [mm]
    end: str = ""  # words after its name, such as for a nut; empty: the motor has a thread for it

    def length(self, wall: float) -> float:
        """The shortest standard length [mm] that reaches two thirds of its depth through a wall [mm]."""
        return next((each for each in _LENGTHS if each >= wall + 2 / 3 * self.depth), _LENGTHS[-1])

    def floor(self, wall: float) -> float:
        """The least thickness [mm], at least that of a wall, with which the screw does not go too deep."""
        return max(wall, self.length(wall) - self.depth)

    def title(self, wall: float) -> str:
        """Name by which it is bought, for a wall [mm]."""
        return f"{self.size} x {self.length(wall):g} mm pan head screw{self.end}"


_LENGTHS = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0)


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A shaft with one flat, which faces +x; lengths in millimeters."""

    diameter: float  # diameter of the round part [mm]
    across: float  # from the flat to the round side opposite [mm]
    length: float  # above the face of the motor [mm]
    boss: float  # radius of the raised ring round it [mm]
    boss_height: float  # height of that ring above the face [mm]

    def shape(self, length: float, grown: float = 0.0) -> Construction:
        """Shape of it from z = 0 upwards [mm], thicker by so much on each side [mm]."""
        radius = self.diameter / 2 + grown
        flat = self.across - self.diameter / 2 + grown
        side = 2 * radius + 2
        return Cylinder(length, radius) & Box((side, side, length)).move(flat - side, -side / 2, 0)


@dataclass(frozen=True, kw_only=True)
class Horn:
    """A disc on the output of a servo, which a coupling with a shaft is screwed on; lengths in millimeters."""

    radius: float  # radius of the disc [mm]
    height: float  # height of its top above the face of the motor [mm]
    circle: float  # radius of the circle of its screw holes [mm]
    count: int  # number of its screw holes, the first at +x
    screw: FaceScrew  # screws in these holes
    under: float = 0.0  # height of the lower side of the disc above the face, where a boss lifts it; 0: near the face
    hub: float = 0.0  # radius of the hub or screw head that stands on the disc; 0: there is none
    hub_height: float = 0.0  # height of that hub above the disc


@dataclass(frozen=True, kw_only=True)
class Motor:
    """A geared motor; lengths in millimeters."""

    key: str  # by which it is chosen
    title: str  # title to buy it by
    body: Construction  # its envelope below the face, without shaft, boss and horn
    outline: tuple[Corner, ...]  # outline of all of it below the face, seen along the shaft, counter-clockwise
    depth: float  # depth below the face [mm]
    shaft: Shaft  # shaft that turns the spool; with a horn the coupling's, its length counted from the horn's top
    horn: Horn | None = None  # horn of a servo; None: the shaft is the motor's own
    holes: tuple[Corner, ...]  # places of the screws in the face
    ridge: Cuboid | None = None  # part of its case that stands above the face
    # half length of the slots in the mating part along x [mm], as the place of the motor's holes is uncertain
    slot: float = 0.0
    screw: FaceScrew  # screw in the face
    stall_torque: float  # at which it stands still, at the voltage that its title or source names [N mm]
    rated_torque: float  # maximum continuous torque [N mm]
    speed: float  # without load [rpm]
    volts: float  # voltage of all its figures [V]
    stall_current: float  # [A]
    free_current: float  # without load [A]
    turns: float = math.inf  # turns of its shaft from one end to the other
    counts: float = 0.0  # counts of its encoder in a turn of the shaft, all edges; 0: it has none
    mass: float  # [g]
    price: float  # price of one, rough [USD]
    price_source: str  # source of the price, with its date
    price_month: str  # month of that price, or in which it was noted where the source has no date
    bus: str = ""  # bus of a servo, by the name that --motors takes; empty for a geared motor
    caution: str = ""  # warning on the page of the wires; empty if there is none
    source: str  # sources of its figures, and those that are uncertain

    @property
    def envelope(self) -> Construction:
        """Shape of all of it with what turns, without the coupling."""
        body = self.body
        if self.ridge is not None:
            body = body + Box(self.ridge.size).move(*self.ridge.low)
        if self.horn is not None:
            hub = Cylinder(self.horn.height + self.horn.hub_height, self.horn.hub or self.shaft.diameter / 2)
            disc = Cylinder(self.horn.height - self.horn.under, self.horn.radius).move(0, 0, self.horn.under)
            return body + disc + hub + Cylinder(max(self.horn.under, 0.1), self.shaft.boss)
        boss = Cylinder(self.shaft.boss_height, self.shaft.boss)
        return body + boss + self.shaft.shape(self.shaft.length)

    def largest_torque(self, *, inside: bool = False) -> float:
        """Largest torque of poses [N m], with the margin: outside the body for long, inside for seconds."""
        return 1e-3 * (BRIEF_TORQUE_SHARE * self.stall_torque if inside else self.rated_torque) / MARGIN

    @property
    def is_feetech(self) -> bool:
        """True for servos of Feetech, which hang on a bus adapter."""
        return self.bus in ("feetech", "scs")

    @property
    def volume(self) -> float:
        """Volume of the box round its outline [mm^3]."""
        xs, ys = zip(*self.outline, strict=True)
        return (max(xs) - min(xs)) * (max(ys) - min(ys)) * self.depth

    @staticmethod
    def choose(key: str) -> "Motor":
        """The motor of a key (InputError: no motor has it)."""
        for motor in ALL_MOTORS:
            if motor.key == key:
                return motor
        known = list_choices("motors", ["auto", *(each.key for each in ALL_MOTORS)], key)
        raise InputError(f'unknown motor "{key}". {known}')


def check_motor(key: str) -> None:
    """Check that a motor has this key (InputError: none has it; the text begins with the key of robot.toml)."""
    try:
        Motor.choose(key)
    except InputError as error:
        raise InputError(f"motor: {error}") from None


def _box_outline(low: Corner, high: Corner) -> tuple[Corner, ...]:
    return low, (high[0], low[1]), high, (low[0], high[1])


def _disc_outline(radius: float) -> tuple[Corner, ...]:
    angles = (2 * math.pi * corner / segments(radius) for corner in range(segments(radius)))
    return tuple((radius * math.cos(angle), radius * math.sin(angle)) for angle in angles)


_M1_6 = FaceScrew(size="M1.6", hole=1.9, head=3.2, head_height=1.3, depth=1.3)
_M2 = FaceScrew(size="M2", hole=2.4, head=4.0, head_height=1.6, depth=4.0)
_M2_HORN = FaceScrew(size="M2", hole=2.4, head=4.0, head_height=1.6, depth=2.5)
_M2_NUT = replace(_M2, depth=5.0, end=" with nut")  # through an ear of 1.6 mm
_M2_DRILLED = replace(_M2, depth=2.0)
_M3_HORN = FaceScrew(size="M3", hole=3.4, head=5.6, head_height=2.4, depth=2.5)
_M3 = FaceScrew(size="M3", hole=3.4, head=5.6, head_height=2.4, depth=3.0)

_N20 = Motor(
    key="n20",
    title="Pololu micro metal gearmotor LP 6V, 298:1, with extended motor shaft (N20)",
    body=Box((12, 10, 9)).move(-6, -5, -9) + (Cylinder(16, 6) & Box((12, 10, 16)).move(-6, -5, 0)).move(0, 0, -25),
    outline=_box_outline((-6, -5), (6, 5)),
    depth=25.0,
    shaft=Shaft(diameter=3.0, across=2.5, length=9.0, boss=2.0, boss_height=0.8),
    holes=((-4.5, 0.0), (4.5, 0.0)),
    screw=_M1_6,
    stall_torque=196.0,
    rated_torque=49.0,
    speed=45.0,
    volts=6.0,
    stall_current=0.36,
    free_current=0.02,
    counts=3575.04,
    mass=10.0,
    price=18.0,
    price_source="of its sister HPCB 75:1, 17.95 in an order list of the team ASROB-sumo, which has no date",
    price_month="2026-11",
    caution="The encoder stands behind the motor, on its extended shaft. Leave 10 mm (no source): neither drawn "
    "nor counted in the size of its unit.",
    source="Pololu, Micro Metal Gearmotors, Rev 2.0, May 2018: stall 20 kg mm (extrapolated), 45 rpm, 10 g, gearbox "
    "9 mm, M1.6 screws at most 1.3 mm deep; LP 6V: 0.36 A at stall, 0.02 A without load, 297.92:1. Pololu, product "
    "page 5215: section 10 x 12 mm, D shaft 3 x 9 mm. Load at most a quarter of stall: Pololu's forum, thread 14572 "
    "(20 to 30 %). Holes 9 mm apart, flat of 2.5 mm, boss and length of the motor: measured on none, check yours.",
)

_XL330 = Motor(
    key="xl330",
    title="Robotis Dynamixel XL330-M288-T",
    body=Box((20, 34, 23)).move(-10, -24.5, -23),
    outline=_box_outline((-10, -24.5), (10, 9.5)),
    depth=23.0,
    shaft=Shaft(diameter=6.0, across=5.0, length=0.0, boss=8.0, boss_height=0.0),
    horn=Horn(radius=8.0, height=3.0, circle=6.0, count=4, screw=_M2_HORN),
    holes=((-8.0, 7.5), (8.0, 7.5), (-8.0, -22.5), (8.0, -22.5)),
    slot=0.5,
    screw=_M2,
    stall_torque=520.0,
    rated_torque=104.0,
    speed=103.0,
    volts=5.0,
    stall_current=1.47,
    free_current=0.02,
    mass=18.0,
    price=24.0,
    price_source="bill of materials of the Koch arms (huggingface/lerobot): 24 USD, 40 to 46 EUR, no date",
    price_month="2026-11",
    bus="dynamixel",
    source="Robotis e-Manual, XL330-M288-T: 20 x 34 x 26 mm, 18 g, at 5 V stall 0.52 N m at 1.47 A, and 103 rpm. "
    "Load at most a fifth of stall: the same manual's note on XL-320 and AX-18A. Axis 9.5 mm below the top, case "
    "23 mm, horn 16 mm wide with 4 holes 6 mm from its axis, holes of the case 16 x 30 mm apart: a public OpenSCAD "
    "model of the project Orbigator, 2025-12-13; measured on none, check yours: the holes for the case are slots. "
    "Current without load, 0.02 A: its standby current of 17 mA.",
)

_POLOLU_25D = Motor(
    key="25d",
    title="Pololu 25D metal gearmotor LP 6V, 172:1, with encoder (item 4828)",
    body=Cylinder(71, 12.5).move(0, 0, -71),
    outline=_disc_outline(12.5),
    depth=71.0,
    shaft=Shaft(diameter=4.0, across=3.5, length=12.5, boss=3.5, boss_height=2.5),
    holes=((-8.5, 0.0), (8.5, 0.0)),
    screw=_M3,
    stall_torque=1373.0,
    rated_torque=343.0,
    speed=35.0,
    volts=6.0,
    stall_current=2.0,
    free_current=0.12,
    counts=8245.92,
    mass=100.0,
    price=47.0,
    price_source="AUD 72.95 for its sister 4822 at robotgear.com.au, no date, at 0.65 USD",
    price_month="2026-11",
    source="Pololu, product page 4828: 25 mm wide, 71 mm long with encoder, D shaft 4 x 12.5 mm, stall 14 kg cm "
    "(extrapolated) at 2.0 A, 35 rpm at 0.12 A, 48 counts in a turn of the motor, 171.79:1. M3 holes 17 mm apart: Core "
    "Electronics, on the face of the motor of this family. Load at most a quarter of stall: Pololu's forum, thread "
    "14572 (20 to 30 %). Holes of the gearbox, boss (7 x 2.5 mm in a public OpenSCAD model), flat of 3.5 mm, depth of "
    "the threads, mass: measured on none, check yours.",
)

_XC330 = replace(
    _XL330,
    key="xc330",
    title="Robotis Dynamixel XC330-M288-T",
    stall_torque=930.0,
    rated_torque=186.0,
    speed=81.0,
    stall_current=1.8,
    mass=23.0,
    price=107.0,
    price_source="335.60 GBP for four in the bill of an adapter for surgical tools (Manaf2584), no date, at 1.28 USD",
    source="Robotis e-Manual, XC330-M288-T: 20 x 34 x 26 mm, 23 g, at 5 V stall 0.93 N m at 1.80 A, and 81 rpm, metal "
    "gears. Same case and horn as XL330 (the manual: same form factor); all places of holes as there, check yours.",
)

_STS3215 = Motor(
    key="sts3215",
    title="Feetech STS3215-C001, 7.4 V, 19.5 kg cm (DFRobot: SER0069)",
    body=Box((24.8, 45.4, 30.2)).move(-12.4, -35.2, -30.2)
    + Cylinder(2.2, 10.0).move(0, 0, -32.4)
    + Box((24.8, 29.9, 3.9)).move(-12.4, -35.2, -34.1),
    outline=_box_outline((-12.4, -35.2), (12.4, 10.2)),
    depth=34.1,
    ridge=Cuboid(low=(-7.0, -34.8, 0.0), high=(7.0, -28.5, 2.7)),
    shaft=Shaft(diameter=6.0, across=5.0, length=0.0, boss=10.0, boss_height=0.0),
    horn=Horn(radius=10.0, height=2.5, circle=7.0, count=4, screw=_M3_HORN, hub=4.5, hub_height=3.0),
    holes=((-10.25, -8.4), (10.25, -8.4), (-10.25, -29.1), (10.25, -29.1)),
    slot=0.5,
    screw=_M2,
    stall_torque=1912.0,
    rated_torque=382.0,
    speed=52.0,
    volts=7.4,
    stall_current=2.7,
    free_current=0.15,
    mass=55.0,
    price=15.0,
    price_source="parts list of SO-ARM100 1.3 (TheRobotStudio): 15 USD, 13 EUR each, no date",
    price_month="2026-11",
    bus="feetech",
    caution="STS3215 are sold for 7.4 V and for 12 V, in one case. This kit needs those for 7.4 V: read the label of "
    "each servo. On the wrong supply, hydrostat rejects them at connection.",
    source="Little Bird Electronics, SER0069: 19.5 kg cm and 52 rpm at 7.4 V, 0.15 A without load, 4 to 7.4 V. Case, "
    "horn (20 x 2.5 mm, 4 holes of 2.5 mm on a circle of 14 mm, M3 cut into them), ridge and depth: table of verified "
    "parts of the robot Nova SM3, from Feetech's own model, 2026-07. Holes of the upper face: an OpenSCAD file of the "
    "like case of LX-16A (plastibot/nenemiz), whose lower holes are those of that table. Load at most a fifth of "
    "stall, as for the other servos. Current at stall: that of the 12 V variant. Mass, radius of the hub (4.5 mm): "
    "measured on none, check yours.",
)

_STS3215_12V = replace(
    _STS3215,
    key="sts3215-12v",
    title="Feetech STS3215-C018, 12 V, 30 kg cm (Waveshare: ST3215)",
    stall_torque=2942.0,
    rated_torque=588.0,
    speed=45.0,
    volts=12.0,
    free_current=0.2,
    caution=_STS3215.caution.replace("those for 7.4 V", "those for 12 V"),
    price=17.6,
    price_source="105.66 USD for six with an adapter (Alibaba) in the list of mhered/my_SO100ARM, no date",
    source="Robonine, test of STS3215 C018: 30 kg cm and 45 rpm at 12 V by the data sheet; measured 35 kg cm, 46 rpm, "
    "48 degree C after an hour at 15 kg cm, 71 degree C after two hours of swinging. Waveshare's ST3215: 6 to 12.6 V, "
    "30 kg cm (robotika.vosrk.cz); that it is the same servo is assumed. Load at most a fifth of stall. "
    "Case, horn, holes: as of the 7.4 V variant; current without load: estimate, check yours.",
)

_ST3020 = Motor(
    key="st3020",
    title="Waveshare ST3020, 12 V, 25 kg cm (Feetech STS3020)",
    body=Box((20.2, 40.2, 40.5)).move(-10.1, -30.0, -40.5)
    + Cylinder(1.4, 6.25).move(0, 0, -41.9)
    + Cylinder(4.0, 3.1).move(0, 0, -45.9),
    outline=_box_outline((-10.1, -30.0), (10.1, 10.2)),
    depth=45.9,
    shaft=Shaft(diameter=6.0, across=5.0, length=0.0, boss=6.25, boss_height=1.4),
    horn=Horn(radius=10.0, height=6.2, under=3.7, circle=7.0, count=4, screw=_M3_HORN, hub=3.0, hub_height=2.4),
    holes=((-8.0, -6.7), (8.0, -6.7), (-7.0, -20.15), (7.0, -20.15)),
    slot=0.5,
    screw=_M2,
    stall_torque=2452.0,
    rated_torque=490.0,
    speed=60.0,
    volts=12.0,
    stall_current=2.7,
    free_current=0.2,
    mass=65.0,
    price=29.6,
    price_source="2,618 INR at Robu in the notes of thenar-jx1 (nickthelegend) of 2026-09-24, at 0.0113 USD",
    price_month="2026-09",
    bus="feetech",
    source="Waveshare's wiki, ST3020 Servo: 25 kg cm at 2.7 A and 60 rpm at 12 V, 0.2 A without load, 6 to 14 V, "
    "40.2 x 20.2 x 40 mm, two shafts. Case, holes, boss, rear pin and horn (20 x 2.5 mm, 4 holes on a circle of "
    "14 mm): a public OpenSCAD file of the like case of SCS20 (N. Hendrich, 2020), measured by hand to 0.1 mm. Load at "
    "most a fifth of stall, as for the other servos. Height of the horn, head of its screw: drawn from that file. "
    "Mass: estimate. Measured on none, check yours: the holes for the case are slots.",
)

_SCS0009 = Motor(
    key="scs0009",
    title="Feetech SCS0009, 6 V, 2.3 kg cm (Waveshare: SC09)",
    body=Box((12.4, 23.4, 19.1)).move(-6.2, -17.7, -19.1) + Box((12.4, 32.4, 1.6)).move(-6.2, -22.2, -1.6),
    outline=_box_outline((-6.2, -22.2), (6.2, 10.2)),
    depth=19.1,
    ridge=Cuboid(low=(-6.2, -17.7, 0.0), high=(6.2, 5.7, 2.5)),
    shaft=Shaft(diameter=6.0, across=5.0, length=0.0, boss=5.95, boss_height=6.2),
    horn=Horn(radius=8.0, height=9.5, under=7.0, circle=6.0, count=4, screw=_M2_DRILLED, hub=2.2, hub_height=1.6),
    holes=((0.0, 8.5), (0.0, -20.5)),
    slot=0.5,
    screw=_M2_NUT,
    stall_torque=226.0,
    rated_torque=45.0,
    speed=100.0,
    volts=6.0,
    stall_current=1.0,
    free_current=0.15,
    turns=280 / 360,
    mass=13.2,
    price=12.1,
    price_source="1,074.91 INR at Evelta in the notes of thenar-jx1 (nickthelegend) of 2026-09-24, at 0.0113 USD",
    price_month="2026-09",
    bus="scs",
    caution="SCS0009 turn by 300 degrees only, of which this kit uses 280. Screw on each coupling at position 34, with "
    "all cable paid out. Raise the position by 100: the spool must take in cable. If not, screw the coupling on at "
    "990. Drill the four holes of the horn (1.6 mm) through the coupling.",
    source="Waveshare's wiki, SC09 Servo: 2.3 kg cm and 100 rpm at 6 V, 0.15 A without load, 1.0 A at stall, 23.2 x "
    "12.0 x 25.5 mm, 300 degrees; that Feetech's SCS0009 is the same servo is assumed. Case, ears, boss: a public "
    "OpenSCAD file of SCS09 (N. Hendrich, 2020), measured by hand to 0.1 mm. Mass: a public CAD model (botcad). Load "
    "at most a fifth of stall, as for the other servos. Horn: no source has its holes or height. A round "
    "one of 16 mm, its top 3.3 mm above the boss, is assumed: check yours, and drill it through the coupling.",
)

MOTORS = (_N20, _XL330, _POLOLU_25D)
"""From the weakest to the strongest: designs look for room in the body for the strongest of these that has it."""
AUTO_MOTORS = (*MOTORS, _STS3215, _STS3215_12V)
"""Motors that "auto" chooses among, but no XC330 (four times the price), no ST3020 (dearer than a stronger STS3215), no
SCS0009 (its horn has no source)."""
ALL_MOTORS = (*MOTORS, _XC330, _STS3215, _STS3215_12V, _ST3020, _SCS0009)
"""All that kits mount."""

MARGIN = 2.0
"""Torque that a motor should have over the largest that was simulated. Simulated cables mostly run without friction:
one that turns by 360 degrees in all at mu = 0.1 needs exp(0.1 * 2 pi) = 1.9 times the tension at its winch (capstan).
Bodies also differ from their assumed stiffness, and motors age."""

BRIEF_TORQUE_SHARE = 0.5
"""Share of its stall torque that a motor gives for seconds, as coils warm up slowly. Assumed, measured on none."""
