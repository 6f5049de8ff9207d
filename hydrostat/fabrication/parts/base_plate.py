"""`BasePlate`: a table on legs for winches outside the body (thesis, Fig 4.2): motors hang through it, tubes leave it.

It lies in the plane with its upper side at z = 0. Units stand in a row along x and all cables leave along +y, where the
body stands. It is printed, in tiles if it is larger than the bed, or cut from acrylic by the same outline.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.base_plan import FREE, HOLDER_DEPTH, BasePlan, Ring, Seat, holder_at, post, tube_holder
from hydrostat.fabrication.parts.housing import SHEET
from hydrostat.fabrication.parts.winch_unit import WinchUnit, letter_label
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Construction, sides_text
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
    plan = BasePlan.of(outside, options, bed)
    tiles = [
        Printed.of(
            tile.solid,
            name=f"base_{letter_label(place)}" if len(plan.tiles) > 1 else "base",
            title="Base",
            note="Flat on the bed, no support. Or cut the whole base from acrylic, 4 mm.",
        )
        for place, tile in enumerate(plan.tiles)
    ]
    holders = _holders(outside, options)
    height = max(unit.motor.depth for unit in outside) + _BELOW - SHEET
    legs = Printed.of(
        post(height),
        name="base_leg",
        title="Leg of the base",
        count=len(plan.bolts),
        note="Standing, with a brim, no support; holes for screws M3 at both ends.",
    )
    used = {holder.name: sum(mine is holder for mine in holders) for holder in holders}
    own = {holder.name: replace(holder, count=used[holder.name]) for holder in holders}
    printed = (*tiles, *own.values(), legs)
    return BasePlate(
        printed=printed,
        assembly=_assembly(robot, outside, plan, tiles, holders, legs),
        sheet=plan.sheet,
        thickness=SHEET,
        seats=plan.seats,
        tubes=_tubes(robot, outside, plan, options),
        bought=(
            ("M3 x 10 mm screw (legs and tube holders)", len(plan.bolts) + len(holders)),
            ("M2 x 8 mm screw (tube holders)", len(holders)),
        ),
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
    places = {seat.unit: seat.place_point(holder_at(units[seat.unit]))[0] for seat in plan.seats}
    low, high = min(places.values()), max(places.values())
    return tuple(
        (cable, FREE + HOLDER_DEPTH + options.run + max(places[number] - low, high - places[number]) + spread)
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


def _holders(units: Sequence[WinchUnit], options: PartOptions) -> list[Printed]:
    """The holder of each unit; equal ones are the same."""
    made: dict[Construction, Printed] = {}
    found = []
    for unit in units:
        model = tube_holder([leaves.point[2] for leaves in unit.exits], options)
        if model not in made:
            made[model] = Printed.of(
                model,
                name=f"tube_holder_{letter_label(len(made))}",
                title="Tube holder",
                note="Standing on its foot, the slot upwards, no support.",
            )
        found.append(made[model])
    return found


def _assembly(
    robot: Robot,
    units: Sequence[WinchUnit],
    plan: BasePlan,
    tiles: Sequence[Printed],
    holders: Sequence[Printed],
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
    for seat, holder in zip(plan.seats, holders, strict=True):
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
        x, y = seat.place_point(holder_at(unit))
        pieces.append(
            Placed(
                name=f"{holder.name} ({unit.winch})",
                title=holder.title,
                solid=holder.solid.translate((x, y, 0)),
                pulled=(0, 0, 20),
            )
        )
    return PartAssembly(name=f"base of {robot.name}", pieces=tuple(pieces))


def _too_large(pieces: Sequence[Printed], bed: tuple[float, float, float]) -> tuple[str, ...]:
    return tuple(
        f"{piece.name} is {sides_text(piece.size)} mm, the bed {sides_text(bed)} mm. Cut the base from acrylic or "
        "choose smaller motors"
        for piece in pieces
        if any(side > room + 1e-6 for side, room in zip(piece.size, bed, strict=True))
    )
