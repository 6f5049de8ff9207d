"""Items of the bill: everything that a robot takes."""

import math
from dataclasses import replace

from hydrostat.fabrication.board_kind import BOARDS
from hydrostat.fabrication.inserts import Insert, InsertKind, filling_volume
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import Cloth, FoamNeeds, KitPlan
from hydrostat.fabrication.lists.bill import FELT_SHEET, PRICES, BillGroup, Item, Price
from hydrostat.fabrication.lists.cuts import CableCut, SheathCut
from hydrostat.fabrication.lists.line import FishingLine
from hydrostat.fabrication.lists.motors import PowerPlan
from hydrostat.fabrication.lists.searches import UNNAMED, search_term
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.units import plural

THREAD = 4.0  # Thread for a length of seam: two threads of a lock stitch, sewn twice. Assumed.

_SILICONES = ("ecoflex", "dragon skin")  # beginnings of names of materials that are poured and are no foam


def all_needs(
    plan: KitPlan,
    line: FishingLine,
    cuts: tuple[CableCut, ...],
    tubes: tuple[SheathCut, ...],
    power: PowerPlan | None,
) -> list[Item]:
    """Everything that a robot takes, group by group."""
    items = []
    if plan.work.cloth is not None:
        items += _plush(plan, plan.work.cloth)
    if plan.work.foam is not None:
        items += _foam(plan, plan.work.foam)
    if plan.method is Method.PRINT:
        items.append(_filament(plan))
    items += [
        *(_insert_item(insert) for insert in plan.inserts),
        *_cables(plan, line, cuts, tubes),
        *_winches(plan),
        *control_needs(power),
        *_mould(plan),
    ]
    return [item for item in items if item.quantity > 0]


def filling_mass(plan: KitPlan) -> float:
    """Mass of the filling: volume of the body at rest without its parts times the density of its material [g]."""
    body = plan.robot.body
    return 1e-6 * body.material.density * filling_volume(body)


def _item(
    group: BillGroup, what: str, specification: str, quantity: float, price: str | Price, mass: float | None = None
) -> Item:
    """An item of the bill, its price by its key in the table."""
    known, key = (PRICES[price], price) if isinstance(price, str) else (price, "")
    return Item(
        group=group,
        what=what,
        specification=specification,
        quantity=quantity,
        price=known,
        mass=mass,
        search=search_term(key, specification),
    )


def _item_by_kind(group: BillGroup, what: str, specification: str, quantity: float, price: str) -> Item:
    """An item that the sheet names by the beginning of its specification."""
    return replace(_item(group, what, specification, quantity, price), is_named_by_kind=True)


_NEEDLES = replace(_item(BillGroup.BODY, "needles", "sewing, and a long doll needle", 1.0, "needle"), is_tool=True)


def _plush(plan: KitPlan, cloth: Cloth) -> list[Item]:
    mass, thread = filling_mass(plan), THREAD * cloth.seam
    felt = f"that a laser may cut: wool, polyester or acrylic, no PVC; 1 to 2 mm{_felt_pieces(cloth)}"
    filling = plan.robot.body.material.name or UNNAMED
    zipper = f"zipper of {math.ceil(cloth.zipper / 10) * 10:g} mm or longer"
    marks = plan.robot.body.marks
    drawn = f"for {plural(len(marks), 'drawn line')}, such as eyes"
    spool = 100e3  # thread on a spool [mm]
    return [
        _item(BillGroup.BODY, "felt", felt, 1e-6 * cloth.felt, "felt"),
        _item(BillGroup.BODY, "fiber filling", filling, 1e-3 * mass, "filling", mass),
        _item(
            BillGroup.BODY,
            "all-purpose thread",
            f"polyester, {1e-3 * thread:.0f} m",
            math.ceil(thread / spool),
            "thread",
        ),
        _item_by_kind(BillGroup.BODY, "zipper", zipper, float(cloth.zipper > 0), "zipper"),
        _item(BillGroup.BODY, "felt scraps and embroidery thread", drawn, float(bool(marks)), "decoration"),
        _NEEDLES,
    ]


def _felt_pieces(cloth: Cloth) -> str:
    """Size of the largest panel, and of the largest that fits on no craft sheet."""
    if not cloth.panels:
        return ""
    sheet = [math.ceil(side) for side in FELT_SHEET]
    panels = sorted(((math.ceil(wide), math.ceil(high)) for wide, high in cloth.panels), key=math.prod)
    misfits = [sides for sides in panels if min(sides) > sheet[0] or max(sides) > sheet[1]]
    words = "; largest panel {} x {} mm".format(*panels[-1])
    if not misfits:
        return words
    whose = "" if misfits[-1] == panels[-1] else " one of {} x {} mm is".format(*misfits[-1])
    return f"{words},{whose} larger than craft sheets of {sheet[0]} x {sheet[1]} mm"


def _cast_name(plan: KitPlan, foam: FoamNeeds) -> str:
    """Name of the casting material of the body."""
    return foam.material or plan.robot.body.material.name or UNNAMED


def _foam(plan: KitPlan, foam: FoamNeeds) -> list[Item]:
    kind = _cast_name(plan, foam)
    foams = not kind.startswith(_SILICONES)
    what = "foam" if foams else "silicone"
    return [
        *(
            replace(_item(BillGroup.BODY, f"{what}, part {part}", kind, 1e-3 * mass, what, mass), is_poured=True)
            for part, mass in (("A", foam.part_a), ("B", foam.part_b))
        ),
        _item(BillGroup.BODY, "skin", "knitted glove or sleeve", 1.0, "skin"),
        _item(BillGroup.BODY, "spray glue", "3M Super 77, between foam and skin", float(foams), "glue"),
        _NEEDLES,
    ]


def _filament(plan: KitPlan) -> Item:
    """Filament of a printed body, solid."""
    material = plan.robot.body.material
    mass = 1e-6 * material.density * sum(part.volume for part in plan.work.printed)
    name = f"{material.name or UNNAMED}, solid"
    return _item(BillGroup.BODY, "filament for the body", name, 1e-3 * mass, "flexible filament", mass)


def _insert_item(insert: Insert) -> Item:
    """A part or rod of the body; a rod by its length, a part by its mass."""
    what = {InsertKind.ROD: "rod", InsertKind.SHEET: "sheet"}.get(insert.kind, "part")
    name = f"{what} {insert.mark} {insert.name}"
    words = f"{insert.material}, {insert.size}"
    if insert.kind is InsertKind.ROD:
        return _item(BillGroup.BODY, name, words, 1e-3 * (insert.length or 0.0), "wire", insert.mass)
    if insert.kind is InsertKind.SHEET:
        return _item(BillGroup.BODY, name, words, 1e-6 * (insert.area or 0.0), "felt", insert.mass)
    kilograms = 1e-3 * (insert.mass or 0.0)
    price = "stiff part" if insert.kind is InsertKind.RIGID else "soft part"
    return _item(BillGroup.BODY, name, words, kilograms, price, insert.mass)


def _cables(plan: KitPlan, line: FishingLine, cuts: tuple[CableCut, ...], tubes: tuple[SheathCut, ...]) -> list[Item]:
    length, tube = sum(cut.cut_length for cut in cuts), sum(cut.length for cut in tubes)
    # density of the fibers of braided line [g/mm^3] (gel-spun polyethylene floats: 0.97 g/cm^3)
    polyethylene = 0.97e-3
    thread = polyethylene * math.pi / 4 * line.diameter**2 * length
    ring = math.pi / 4 * (plan.options.parts.tube**2 - plan.options.parts.bore**2)
    sizes = f"{plan.options.parts.bore:g} mm inside, {plan.options.parts.tube:g} mm outside"
    ptfe = 2.15e-3  # density of the tube [g/mm^3]; ASTM D792, in data sheets of PTFE tube
    return [
        _item(
            BillGroup.CABLES,
            "braided fishing line",
            f"{line.name}, {line.diameter:g} mm",
            1e-3 * length,
            "line",
            thread,
        ),
        _item(BillGroup.CABLES, "PTFE tube", sizes, 1e-3 * tube, "tube", ptfe * ring * tube),
    ]


def _winches(plan: KitPlan) -> list[Item]:
    motor, count = plan.rigid.motor, plan.num_motors
    source = f"the table of motors ({motor.price_source})"
    price = Price(amount=motor.price, source=source, month=f"noted {motor.price_month}")
    bought = [
        _item(BillGroup.WINCHES, "geared motor", motor.title, float(count), price, count * motor.mass),
        *(
            _item(BillGroup.WINCHES, "screw or nut", title, float(number), "screws")
            for title, number in plan.rigid.screws.items()
        ),
    ]
    return [
        *(replace(item, is_named_by_kind=True) for item in bought),
        _plastic(BillGroup.WINCHES, "PLA for printed parts", plan.rigid.printed),
    ]


def _plastic(group: BillGroup, what: str, parts: tuple[Printed, ...]) -> Item:
    """Filament for printed parts."""
    mass, pieces = sum(part.count * part.mass for part in parts), sum(part.count for part in parts)
    return _item(group, what, f"{pieces} pieces, with a little infill", 1e-3 * mass, "pla", mass)


def control_needs(plan: PowerPlan | None) -> list[Item]:
    """Boards, drivers, supply, fuse, switch and wires that turn the motors of a plan."""
    if plan is None:
        return []
    count, area, gauge = float(len(plan.winches)), *plan.wire
    feed = [
        _item(BillGroup.CONTROL, "power supply", f"{plan.motor.volts:g} V, {plan.supply:g} A or more", 1.0, "supply"),
        _item(BillGroup.CONTROL, "fuse with holder", f"blade fuse, {plan.fuse:g} A", 1.0, "fuse"),
        _item(BillGroup.CONTROL, "switch", f"for {plan.fuse:g} A, large enough to be hit", 1.0, "switch"),
        _item(BillGroup.CONTROL, "twin lead", f"{area:g} mm^2 (AWG {gauge}) or thicker", 2.0, "lead"),
    ]
    if plan.motor.is_feetech:
        adapter = "Waveshare bus servo adapter or alike, USB to the three wires of ST and SC servos"
        chain = "of three wires with plugs of 2.54 mm (5264-3), one from servo to servo"
        board = _item_by_kind(BillGroup.CONTROL, "bus servo adapter", adapter, 1.0, "bus adapter")
        price = "servo's own cable" if plan.motor.key.startswith("sts3215") else "servo cable"
        relay = _list_relay(plan) if plan.has_relay else []
        return [board, *relay, _item(BillGroup.CONTROL, "servo cable", chain, max(count - 1, 1), price), *feed]
    if plan.servos:
        bus = "OpenRB-150 or alike, drives the servos by their bus"
        chain = "of three wires with JST EH plugs (X3P), one from servo to servo"
        plugs = [_item(BillGroup.CONTROL, "servo cable", chain, count, "servo cable")]
        return [_item_by_kind(BillGroup.CONTROL, "controller board for servos", bus, 1.0, "servo board"), *plugs, *feed]
    kinds = {name: plan.boards.count(name) for name in dict.fromkeys(plan.boards)}
    bridge = f"carrier of a DRV8874 or alike, for {plan.motor.stall_current:g} A, current sense of 1.1 V/A"
    parts = [
        _item_by_kind(
            BillGroup.CONTROL,
            "controller board",
            f"{BOARDS[name].title} or alike",
            float(many),
            f"{name.removesuffix('s3')} board",
        )
        for name, many in kinds.items()
    ]
    if plan.motor.key == "n20":
        magnets = "magnetic, for micro metal gearmotors with a long shaft, 12 counts a turn"
        parts.append(_item(BillGroup.CONTROL, "encoder", magnets, count, "encoder"))
    small = "1 of 10 uF from RESET to GND of each board, and 10 kOhm from each PWM pin to GND"
    if not plan.resets:
        small = "10 kOhm from each PWM pin to GND, an LED with 330 Ohm"
        if plan.motor.key == "25d":
            shifter = "4 channels, 5 V to 3.3 V, for two encoders"
            parts.append(_item(BillGroup.CONTROL, "level shifter", shifter, float(math.ceil(count / 2)), "shifter"))
    parts.append(_item(BillGroup.CONTROL, "capacitor and resistors", small, 1.0, "small parts"))
    return [*parts, _item_by_kind(BillGroup.CONTROL, "motor driver", bridge, count, "driver"), *feed]


def _list_relay(plan: PowerPlan) -> list[Item]:
    """The board that drives servos, its wires and its supply."""
    kind = BOARDS[plan.board or ""]
    return [
        _item_by_kind(BillGroup.CONTROL, "controller board", f"{kind.title} or alike", 1.0, "esp32 board"),
        _item(
            BillGroup.CONTROL, "jumper wires", "3 from board to bus adapter, an LED with 330 Ohm", 1.0, "small parts"
        ),
        _item(BillGroup.CONTROL, "USB supply", "power bank or charger of 5 V, 1 A, with a cable", 1.0, "USB supply"),
    ]


def _mould(plan: KitPlan) -> list[Item]:
    """Material of a mold, and what joins, holds and seals its pieces."""
    foam = plan.work.foam
    if foam is None:
        return []
    poured = foam.silicone_mass
    litres = f"for molds, Mold Max 30 or alike, both parts, {1e-6 * foam.silicone:.2f} L"
    nut = "and two washers, longer than the closed mold is thick; or threaded rod"
    dowel = 15.0  # length of a dowel [mm]: a little less than the holes in both pieces are deep
    rod = f"wood or steel, for {foam.dowels} dowels of {dowel:g} mm"
    varnish = "shellac or acrylic varnish, two coats on the printed mold"
    sealed = bool(plan.work.printed) and not poured > 0
    cast = "silicone" if _cast_name(plan, foam).startswith(_SILICONES) else "polyurethane foam"
    return [
        _item(BillGroup.MOULD, "silicone", litres, 1e-3 * poured, "silicone", poured),
        _plastic(BillGroup.MOULD, "PLA for the mold", plan.work.printed),
        _item(BillGroup.MOULD, "bolt M4 with nut", nut, float(foam.bolts), "bolts"),
        _item(BillGroup.MOULD, "rod of 3 mm", rod, 1e-3 * dowel * foam.dowels, "rod"),
        _item(
            BillGroup.MOULD,
            "glue for plastic",
            "for pieces with dowels between them",
            float(foam.dowels > 0),
            "plastic glue",
        ),
        _item(
            BillGroup.MOULD,
            "modeling clay",
            "without sulfur, seals the frames of the silicone",
            float(poured > 0),
            "clay",
        ),
        _item(BillGroup.MOULD, "sealer", varnish, float(sealed), "sealer"),
        _item(BillGroup.MOULD, "release agent", f"for {cast}", 1.0, "release"),
    ]
