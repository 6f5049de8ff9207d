"""`bill_facts`, `piece_facts`, `power_facts`: the bill, pieces by their numbers, and wires, for a sheet."""

from dataclasses import dataclass

from hydrostat.fabrication.board_kind import BOARDS
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.bill import BillRow
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.lists.motors import PowerPlan
from hydrostat.fabrication.sheets.facts import PieceFacts, PowerFacts, TableFacts
from hydrostat.fabrication.sheets.legible import shorten_text
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Robot

_UNITS = {"piece": "", "m^2": "m²"}


def bill_facts(lists: Lists) -> TableFacts:
    """Names, amounts and costs of what is bought, and the totals."""
    items = [row for row in lists.bill.rows if not row.is_total]
    rows = [[shorten_text(row.short_name, 40), _amount(row), _cost_words(row)] for row in items]
    return {
        "file": f"lists/{lists.bill.name}.csv",
        "heads": ["what", "amount", "USD"],
        "right": [False, True, True],
        "rows": [*rows, *([words, "", f"{cost:.0f}"] for words, cost in _costs(lists))],
    }


def _amount(row: BillRow) -> str:
    """Amount of an item, small masses in grams."""
    if row.amount is None:
        return ""
    if row.unit == "kg" and row.amount < 1:
        return f"{1e3 * row.amount:.0f} g"
    return f"{row.amount:.3g} {_UNITS.get(row.unit, row.unit)}".strip()


def _cost_words(row: BillRow) -> str:
    """Cost of an item in full dollars; a tool is kept."""
    if row.cost_used == 0 < row.cost_packs:
        return "0 (kept)"
    return "<1" if 0 < row.cost_used < 0.5 else f"{row.cost_used:.0f}"


def _costs(lists: Lists) -> list[tuple[str, float]]:
    """Costs of all that is used up, and of all in whole packs [USD], by their names; none if nothing is bought."""
    if all(row.is_total for row in lists.bill.rows):
        return []
    columns = lists.bill.columns
    return list(zip((columns["cost_used"].title, columns["cost_packs"].title), lists.cost, strict=True))


def cost_text(lists: Lists) -> tuple[str, ...]:
    """Cost in words; empty if nothing is bought."""
    told = [f"{cost:.0f} USD {name}" for name, cost in _costs(lists)]
    return (f"about {', '.join(told)}",) if told else ()


_BOUGHT = " (bought)"


def piece_numbers(plan: KitPlan) -> tuple[dict[str, int], dict[str, int]]:
    """Numbers of the pieces of the winch and of the stopper by name; pieces of one title share a number."""
    numbers: list[dict[str, int]] = []
    count = 0
    for assembly in _numbered_assemblies(plan):
        titles: dict[str, int] = {}
        for placed in assembly.pieces if assembly else ():
            if placed.title not in titles:
                count += 1
                titles[placed.title] = count
        numbers.append({placed.name: titles[placed.title] for placed in assembly.pieces} if assembly else {})
    return numbers[0], numbers[1]


def _numbered_assemblies(plan: KitPlan) -> tuple[PartAssembly | None, PartAssembly | None]:
    """Assemblies whose pieces have numbers: the winch and the stopper."""
    return plan.rigid.winch_assembly, plan.rigid.stopper_assembly


@dataclass
class _Piece:
    """A piece that is counted."""

    title: str
    count: int = 0
    files: str = ""

    def facts(self, number: str) -> PieceFacts:
        return {"number": number, "title": self.title, "count": str(self.count), "files": self.files}


def piece_facts(plan: KitPlan) -> list[PieceFacts]:
    """Every piece of the pictures with its number and how many are needed in all, then what else is printed."""
    units = (len(plan.robot.winches), len(plan.robot.cables))
    kinds: dict[str, list[Printed]] = {}
    for part in plan.printed:
        kinds.setdefault(_kind_of(part, plan), []).append(part)
    pieces: dict[int, _Piece] = {}
    for assembly, numbers, unit in zip(_numbered_assemblies(plan), piece_numbers(plan), units, strict=True):
        for placed in assembly.pieces if assembly else ():
            piece = pieces.setdefault(numbers[placed.name], _Piece(_short_title(placed)))
            if placed.printed and placed.title in kinds:
                piece.count, piece.files = _count_and_files(kinds.pop(placed.title))
            elif not piece.files:
                piece.count += unit
                piece.title += "" if placed.printed or piece.title.endswith(_BOUGHT) else _BOUGHT
    rest = [_Piece(kind, *_count_and_files(parts)) for kind, parts in kinds.items()]
    return [*(piece.facts(str(number)) for number, piece in pieces.items()), *(piece.facts("") for piece in rest)]


def winch_files(plan: KitPlan, winch: str) -> list[str]:
    """Stems of the files that a winch does not share with all others."""
    if len(plan.robot.winches) == 1:
        return []
    return [part.name for part in plan.printed if winch in part.winches]


def _count_and_files(parts: list[Printed]) -> tuple[int, str]:
    """Number of parts of a kind, and their files."""
    files = [part.name + (f" × {part.count}" if len(parts) > 1 and part.count > 1 else "") for part in parts]
    return sum(part.count for part in parts), shorten_text(", ".join(files), 90)


def _kind_of(part: Printed, plan: KitPlan) -> str:
    """Name of a printed part in the list."""
    kind = part.kind or part.title
    mould = plan.work.mould
    if mould and part.name in {piece.name for piece in mould.printed} and "positive" not in kind:
        kind = f"Mold, {kind[:1].lower()}{kind[1:]}"
    optional = ", optional" if part.name.startswith("grommet") else ""
    return shorten_text(kind[:1].upper() + kind[1:], 44) + optional


def _short_title(placed: Placed) -> str:
    """A bought piece without its details, which are in the bill."""
    return placed.title if placed.printed else placed.title.partition(",")[0]


def power_facts(plan: PowerPlan | None, robot: Robot, cautions: tuple[str, ...] = ()) -> PowerFacts | None:
    """Supply, fuse, leads, battery, warnings, first start and wiring table; None without motors."""
    if plan is None:
        return None
    marks, is_measured = winch_marks_of(robot), not any(cable.reverse for cable in robot.cables)
    named = [f"{marks[name]} {shorten_text(name, 24)}" for name in plan.winches]
    warnings = [
        "The fuse sits in the plus lead, at the supply. Keep the switch for the motors within reach while they turn.",
        "Join minus of the supply and GND of the board. Never connect plus to a pin of the board that is not a "
        "supply pin.",
        f"With NiMH cells, use {plan.cells} in series with the same fuse; never charge them in the robot.",
    ]
    warnings += [plan.motor.caution] if plan.motor.caution else []
    warnings += cautions
    if plan.servos:
        if plan.motor.is_feetech:
            warnings += [
                "The bus adapter passes the supply on as it is. Read the range printed on it: some state 9 to 12.6 V.",
            ]
        return {
            "rows": [list(row) for row in plan.table.texts],
            "warnings": warnings,
            "start": _list_first_steps(plan, is_measured=is_measured),
            "title": "Servos",
            "heads": ["ID", "winch"],
            "pins": [[str(number), name] for number, name in enumerate(named, start=1)],
        }
    pins, place = [], 0
    for number, board in enumerate(plan.boards, start=1):
        for wires in BOARDS[board].wiring[: len(named) - place]:
            pins.append([named[place], board if len(plan.boards) == 1 else f"{board} {number}", *wires])
            place += 1
    warnings += [
        "10 kOhm from each PWM pin to GND keeps motors off while the board starts.",
        "If a motor runs away, its two wires are swapped: the board stops it after 0.2 s.",
    ]
    if not plan.resets:
        warnings.append(_encoder_warning(plan))
    if len(plan.boards) > 1:
        warnings.append("Each board has its own USB cable. Separate their ports by commas: firmware:PORT,PORT.")
    return {
        "rows": [list(row) for row in plan.table.texts],
        "warnings": warnings,
        "start": _list_first_steps(plan, is_measured=is_measured),
        "title": "Pins of the board",
        "heads": ["winch", "board", "PWM", "direction", "A", "B", "current"],
        "pins": pins,
    }


def _encoder_warning(plan: PowerPlan) -> str:
    """Warning about encoders on a board with pins of 3.3 V."""
    begin = "Pins of the ESP32-S3 withstand 3.3 V only. "
    if plan.motor.key == "n20":
        return begin + "Supply the encoders from its pin 3V3."
    return begin + "Supply the encoders with 5 V, and lead A and B of each through the level shifter."


def _list_first_steps(plan: PowerPlan, *, is_measured: bool) -> list[str]:
    """Steps from the first volt to the first move, each with its check."""
    chain = (
        "Chain the servos in the order of the table. Where the drawing feeds the chain, join the leads to plus and "
        "minus of the servo cable."
    )
    kind = "firmware" if plan.has_relay else plan.motor.bus or "firmware"
    if plan.motor.is_feetech:
        limits = "set both angle limits to 0" if plan.motor.bus == "feetech" else "move it to position 34"
        ready = [
            "Plug in one servo at a time, with the switch off. Turn it on. Give the servo its number with the "
            f"program FD of Feetech (Windows), and {limits}. Turn the switch off. Write the number on the servo.",
            *(_list_relay_steps(plan, chain) if plan.has_relay else [chain + _PLUG_IN]),
        ]
    elif plan.servos:
        ready = [
            "Load the example usb_to_dynamixel onto the OpenRB-150 with the Arduino IDE. Leave its power jumper on 5 V "
            "and cut the plus wire of the cable between board and chain: USB then feeds the board alone.",
            "Plug in one servo at a time, with the switch off. Turn it on. Give the servo its number with ROBOTIS' "
            "Dynamixel Wizard. Turn the switch off. Write the number on the servo.",
            chain + _PLUG_IN,
        ]
    else:
        flash = f" --flash {','.join(['PORT'] * len(plan.boards))}" if plan.resets else ""
        ready = [
            "Wire one winch as in the table, then the others: PWM to EN of its driver, direction to PH, current to its "
            f"current sense. On a DRV8874, PMODE goes to GND and SLEEP to {'5V' if plan.resets else '3V3'}. Names "
            "differ between carriers: read the page of yours.",
            f"Run: hydrostat firmware ROBOT --board {','.join(plan.boards)} --motor {plan.motor.key} --out DIR"
            f"{flash}. It prints the pins: compare them with the table.",
            "Put 10 uF from RESET to GND (plus to RESET). The board then keeps running when a program opens its port. "
            "Take it out before you flash again."
            if plan.resets
            else _UPLOAD,
        ]
    return [
        "Leave the switch off. The supply gives 1.5 times the current of all motors at full torque, and enough for two "
        f"that stall. Measure it behind the fuse: {plan.motor.volts:g} V, plus on the plus lead.",
        "In the commands below, ROBOT is the folder with the robot.toml of this robot, and MOVES is the file "
        "dance/trajectory.csv. To make it from the poses, run: hydrostat trajectory ROBOT --return --out dance.",
        *ready,
        'Install the motor package: pip install -e ".[motors]" in the folder of hydrostat. Then find the port: '
        "/dev/ttyUSB0 or /dev/ttyACM0 on Linux, and in WSL after usbipd has attached it.",
        f"Keep a hand on the switch and turn it on. Run: hydrostat calibrate ROBOT --motors {kind}:PORT. Check that "
        "the winch that turns is the one that the command names."
        if is_measured
        else "Keep a hand on the switch and turn it on. Write the zeros of the winches, as under Calibrate.",
        f"Run: hydrostat play ROBOT MOVES --motors {kind}:PORT. Begin with small moves.",
        *_list_steps_alone(plan),
    ]


_PLUG_IN = " Then plug the board into the computer."
_UPLOAD = (
    "Open DIR/winches/winches.ino in the Arduino IDE, with the board package esp32 3 of Espressif. Choose the board "
    "ESP32S3 Dev Module and USB CDC On Boot: Disabled, then upload through the USB port UART."
)


def _list_relay_steps(plan: PowerPlan, chain: str) -> list[str]:
    """Steps that put a board between servos and computer."""
    kind = BOARDS[plan.board or ""]
    sender, receiver = kind.servo_pins
    return [
        f"{chain} Set the jumper of the adapter to UART. Connect its TX to pin {sender}, RX to pin {receiver} "
        f"and GND to GND of the ESP32-S3, and an LED with 330 Ohm between pin {kind.light} and GND.",
        f"Run: hydrostat firmware ROBOT --board {plan.board} --motor {plan.motor.key} --moves MOVES --out DIR. "
        "Compare the pins that it prints.",
        _UPLOAD,
    ]


def _list_steps_alone(plan: PowerPlan) -> list[str]:
    """Steps for a board that plays moves without a computer."""
    if not plan.servos and len(plan.boards) == 1:
        pin = BOARDS[plan.boards[0]].button
        button = f"a push button between pin {pin} and GND" if plan.resets else "the button BOOT of the board"
        feed = "a 9 V battery at its jack" if plan.resets else "a USB power bank at its port USB"
        return [
            f"Optional: add --moves MOVES to that hydrostat firmware command, and upload. After calibration, {button} "
            f"starts and stops these moves without a computer. Feed the board by {feed} before you calibrate.",
            f"Optional, if cells power the motors: add --min-supply {plan.cells} to that command. Connect plus of the "
            f"motors, 47 kOhm, pin {BOARDS[plan.boards[0]].supply}, 10 kOhm and GND in series. The motors then stop at "
            f"{plan.cells} V, and the light blinks.",
        ]
    if plan.has_relay:
        return [
            "To play without a computer, run hydrostat firmware again as above, and upload: the sketch then has the "
            "zeros, or the command says why not. Feed the ESP32-S3 from the power bank at its port USB. Without zeros "
            "in the sketch, calibrate through its port UART after each start. When the light is on, its button BOOT "
            "starts and stops the moves."
        ]
    if plan.motor.is_feetech:
        return [
            "Optional: an ESP32-S3 wired to the bus adapter plays moves without a computer; --board esp32s3 "
            "adds it to a kit. Run: hydrostat firmware ROBOT --board esp32s3 --motor "
            f"{plan.motor.key} --moves MOVES --out DIR, upload, and calibrate with --motors firmware:PORT. Then run "
            "and upload it again: it stores the zeros, or prints why not."
        ]
    return []
