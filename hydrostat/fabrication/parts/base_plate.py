"""`BasePlate`: a table on legs for winches outside the body (thesis, Fig 4.2): motors hang through it, tubes leave it.

It lies in the plane with its upper side at z = 0. Units stand in a row along x and all cables leave along +y, where the
body stands. It is printed, in tiles if it is larger than the bed, or cut from acrylic by the same outline.
"""

import math
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from manifold3d import Manifold

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.base_plan import (
    COUPLER,
    HOLDER_DEPTH,
    STOP,
    BasePlan,
    Ring,
    Seat,
    holder_at,
    line_coupler,
    post,
    tube_holder,
)
from hydrostat.fabrication.parts.housing import SHEET
from hydrostat.fabrication.parts.winch_unit import WinchUnit, letter_label
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Construction, sides_text, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot

_BELOW = 10.0  # room below the motors for their wires [mm]


@dataclass(frozen=True, eq=False, kw_only=True)
class BasePlate:
    """A base for the winches outside the body."""

    printed: tuple[Printed, ...]  # tiles of the plate, tube holders, legs
    assembly: PartAssembly  # all of it with the units
    # outline of the whole plate, then its holes, to be cut from acrylic in place of the tiles [mm]
    sheet: tuple[Ring, ...]
    thickness: float  # thickness of the plate [mm]
    seats: tuple[Seat, ...]  # seats of the units
    # from the outer face of its housing to where its cable begins, by cable index [mm]
    tubes: tuple[tuple[int, float], ...]
    bought: tuple[tuple[str, int], ...]  # parts to buy for it, with the count of each
    bare: float = 0.0  # length of line from a housing to its tube, where cores are swapped; else tubes begin there [mm]
    problems: tuple[str, ...] = ()  # why it cannot be built well
    warnings: tuple[str, ...] = ()  # warnings for the builder


def base_plate(
    robot: Robot,
    units: Sequence[WinchUnit],
    options: PartOptions,
    bed: tuple[float, float, float],
    *,
    held: Collection[int] = (),
) -> BasePlate | None:
    """The base of all winches outside the body, in pieces that fit the bed (x, y, z) [mm]; None if there are none.

    Tubes of cables `held`, by index, are held where they end by something else.
    """
    outside = [unit for unit in units if unit.mount is Mount.WORLD]
    if not outside:
        return None
    winches = [robot.winch(unit.winch) for unit in outside]
    plan = BasePlan.of(outside, options, bed, reach=max(1e3 * (winch.travel + winch.release) for winch in winches))
    tiles = [
        Printed.of(
            tile.solid,
            name=f"base_{letter_label(place)}" if len(plan.tiles) > 1 else "base",
            title="Base",
            note="Flat on the bed, no support. Or cut the whole base from acrylic, 4 mm.",
        )
        for place, tile in enumerate(plan.tiles)
    ]
    holders, fixed = _swap(outside, plan, options) if options.swap else _hold(outside, plan, options)
    height = max(unit.motor.depth for unit in outside) + _BELOW - SHEET
    legs = Printed.of(
        post(height),
        name="base_leg",
        title="Leg of the base",
        count=len(plan.bolts),
        note="Standing, with a brim, no support; holes for screws M3 at both ends.",
    )
    used = Counter(part.name for part, _ in holders)
    own = {part.name: replace(part, count=used[part.name]) for part, _ in holders}
    printed = (*tiles, *own.values(), legs)
    return BasePlate(
        printed=printed,
        assembly=_assembly(robot, outside, plan, tiles, holders, legs),
        sheet=plan.sheet,
        thickness=SHEET,
        seats=plan.seats,
        tubes=_tubes(robot, outside, plan, options),
        bought=fixed,
        bare=plan.free + STOP if options.swap else 0.0,
        problems=_too_large([*tiles, legs], bed),
        warnings=_to_hold(robot, outside, held),
    )


def _tubes(
    robot: Robot, units: Sequence[WinchUnit], plan: BasePlan, options: PartOptions
) -> tuple[tuple[int, float], ...]:
    """Length of each tube up to the first point of its cable [mm].

    Beyond its holder it goes the run straight on, as far to the side as the other end of the row, and from the nearest
    of the places where cables begin to the farthest. A tube that bends gently, never back, is no longer than the way
    straight on and then to the side; so the body may stand at the run anywhere in front of the row. A tube keeps its
    cable's length however it lies: longer ones do no harm but friction.
    """
    begins = [robot.cables[cable].points[0] for unit in units for cable in unit.cables]
    spread = 1e3 * max(math.dist(one, other) for one in begins for other in begins)
    places = {seat.unit: seat.place_point(holder_at(units[seat.unit], plan.free))[0] for seat in plan.seats}
    low, high = min(places.values()), max(places.values())
    return tuple(
        (cable, plan.free + HOLDER_DEPTH + options.run + max(places[number] - low, high - places[number]) + spread)
        for number, unit in enumerate(units)
        for cable in unit.cables
    )


def _to_hold(robot: Robot, units: Sequence[WinchUnit], held: Collection[int]) -> tuple[str, ...]:
    """A sentence for each cable whose tube ends where it begins, and has to be held there."""
    found = []
    for unit in units:
        for index in unit.cables:
            cable = robot.cables[index]
            if cable.bare[0] and index not in held:
                place = ", ".join(f"{1e3 * value + 0.0:.1f}" for value in cable.points[0])
                found.append(
                    f'cable C{index + 1} of winch "{unit.winch}" has no sheath at its start. Clamp the end of its '
                    f"tube at ({place}) mm, in the robot's coordinates, to what the robot is fixed to"
                )
    return tuple(found)


Stood = list[tuple[Printed, Manifold]]  # parts on the base, and each as it stands there
Bought = tuple[tuple[str, int], ...]


def _hold(units: Sequence[WinchUnit], plan: BasePlan, options: PartOptions) -> tuple[Stood, Bought]:
    """The tube holder of each unit, equal ones the same, and their screws."""
    made: dict[Construction, Printed] = {}
    found: Stood = []
    for seat in plan.seats:
        unit = units[seat.unit]
        model = tube_holder([leaves.point[2] for leaves in unit.exits], options)
        if model not in made:
            made[model] = Printed.of(
                model,
                name=f"tube_holder_{letter_label(len(made))}",
                title="Tube holder",
                note="Standing on its foot, the slot upwards, no support.",
            )
        part = made[model]
        found.append((part, part.solid.translate((*seat.place_point(holder_at(unit)), 0))))
    return found, (
        ("M3 x 10 mm screw (legs and tube holders)", len(plan.bolts) + len(found)),
        ("M2 x 8 mm screw (tube holders)", len(found)),
    )


def _swap(units: Sequence[WinchUnit], plan: BasePlan, options: PartOptions) -> tuple[Stood, Bought]:
    """A core plate on each tile and a coupler for each line, and their screws."""
    coupler = Printed.of(
        line_coupler(options),
        name="line_coupler",
        title="Line coupler",
        note="Flat, no support, all walls (100 % infill).",
    )
    found: Stood = []
    for place, tile in enumerate(plan.tiles):
        bores, level = [], 0.0
        for seat in plan.seats:
            if tile.low[0] < seat.x < tile.high[0]:
                x, level = seat.place_point(holder_at(units[seat.unit], plan.free))
                for leaves in units[seat.unit].exits:
                    height = leaves.point[2]
                    bores.append((x, height))
                    at_rest = (x, level - HOLDER_DEPTH / 2 - COUPLER[0] / 2 - 4.0, height - COUPLER[2] / 2)
                    found.append((coupler, coupler.solid.rotate((0, 0, 90)).translate(at_rest)))
        model, start = tile.core_plate(bores, options)
        part = Printed.of(
            model,
            name=f"core_plate_{letter_label(place)}" if len(plan.tiles) > 1 else "core_plate",
            title="Core plate",
            note="Standing on its long side, no support.",
        )
        found.append((part, solid_of(model).translate((start, level, 0))))
    return found, (
        ("M3 x 10 mm screw (legs)", len(plan.bolts)),
        ("M3 x 25 mm screw (core plate)", 2 * len(plan.tiles)),
        ("M3 wing nut (core plate)", 2 * len(plan.tiles)),
    )


def _assembly(
    robot: Robot,
    units: Sequence[WinchUnit],
    plan: BasePlan,
    tiles: Sequence[Printed],
    holders: Stood,
    legs: Printed,
) -> PartAssembly:
    tall = legs.size[2]
    pieces = [
        Placed(name=tile.name, title=tile.title, solid=tile.solid.translate((*place.low, -SHEET)))
        for tile, place in zip(tiles, plan.tiles, strict=True)
    ]
    pieces += [
        Placed(
            name=f"{legs.name} {number}",
            title=legs.title,
            solid=legs.solid.translate((*bolt, -SHEET - tall)),
            pulled=(0, 0, -tall / 2),
        )
        for number, bolt in enumerate(plan.bolts, start=1)
    ]
    for seat in plan.seats:
        unit = units[seat.unit]
        pieces += [
            replace(
                piece,
                name=f"{piece.name} ({unit.winch})",
                solid=seat.place_solid(piece.solid),
                pulled=(0, 0, unit.motor.depth + 20),
            )
            for piece in unit.assembly.pieces
        ]
    pieces += [
        Placed(name=f"{part.name} {number}", title=part.title, solid=solid, pulled=(0, 0, 20))
        for number, (part, solid) in enumerate(holders, start=1)
    ]
    return PartAssembly(name=f"base of {robot.name}", pieces=tuple(pieces))


def _too_large(pieces: Sequence[Printed], bed: tuple[float, float, float]) -> tuple[str, ...]:
    return tuple(
        f"{piece.name} is {sides_text(piece.size)} mm, the bed {sides_text(bed)} mm. Cut the base from acrylic or "
        "choose smaller motors"
        for piece in pieces
        if any(side > room + 1e-6 for side, room in zip(piece.size, bed, strict=True))
    )
