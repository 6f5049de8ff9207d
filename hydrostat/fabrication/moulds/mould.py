"""`make_mold`: all that is printed and poured to cast the body of a robot, and what is said of it."""

from collections.abc import Mapping
from dataclasses import dataclass

from manifold3d import Manifold

from hydrostat.fabrication.inserts import displaced_volume
from hydrostat.fabrication.kit_options import MoldKind, MoldOptions
from hydrostat.fabrication.moulds.casting import Casting, make_casting
from hydrostat.fabrication.moulds.closing import RIM, MoldBlock, make_closing
from hydrostat.fabrication.moulds.halves import Halves, make_cavity, make_halves, mold_prints
from hydrostat.fabrication.moulds.linked import interlock_count
from hydrostat.fabrication.moulds.openings import Sprue, Vent, make_sprue, make_vents
from hydrostat.fabrication.moulds.pocket import Pocket, Sides, WinchRoom, cable_dents, clashes, make_pockets
from hydrostat.fabrication.moulds.positive import Frames, Positive, make_frames, make_positive
from hydrostat.fabrication.moulds.pull import Pull
from hydrostat.fabrication.moulds.setting import mold_setting
from hydrostat.fabrication.moulds.split import grid
from hydrostat.fabrication.moulds.stance import MoldOrientation
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import sides_text
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Material, Robot
from hydrostat.units import plural

TOP_RIM = 20.0  # height of the rim above the body [mm]: the funnel is in it


@dataclass(frozen=True, eq=False, kw_only=True)
class Mold:
    """A mold in two halves; lengths in millimeters."""

    kind: MoldKind  # printed halves, or silicone round a printed positive
    pull: Pull  # directions in which the halves come off, in the coordinates of the robot
    stance: MoldOrientation  # orientation in these coordinates, and the upward direction for pouring
    printed: tuple[Printed, ...]  # printed parts, as they lie on the bed
    # halves and body; of a mold of silicone: positive and frames. In coordinates of the mold: x across, y upwards as
    # it stands, z along the pull, parted at z = 0.
    assembly: PartAssembly
    # volumes in the block [mm^3], each measured on its own solid. Printed: upper + lower + cavity + sprue + vents +
    # bolts + slots + keys = box; "cutting" is what upper and lower lose to holes for dowels when they are cut to fit
    # the bed. Silicone: cavity + sprue + silicone_lower + silicone_upper = box; "cutting" is what the positive loses.
    # Both: cavity = body - dents - pockets.
    volumes: dict[str, float]
    poured: Manifold  # all that is filled with foam, in coordinates of the mold
    box: tuple[float, float, float]  # sides of the closed mold: across, upwards as it stands, along the pull [mm]
    bolts: int  # number of M4 bolts that hold it; 0 for silicone
    dowels: int  # number of 3 mm dowels that join pieces
    vents: int  # number of vents
    stands: str  # instruction to set it up for pouring
    casting: Casting  # amounts and times
    problems: tuple[str, ...]  # why it cannot be built well
    warnings: tuple[str, ...]  # warnings for the builder
    notes: tuple[str, ...] = ()  # information for the builder


@dataclass(frozen=True, eq=False, kw_only=True)
class _Inside:
    """Contents of the block, in the coordinates of the mold."""

    body: Manifold
    dents: Manifold
    pockets: tuple[Pocket, ...]
    cavity: Manifold
    block: MoldBlock
    sprue: Sprue | None
    vents: tuple[Vent, ...]


def make_mold(robot: Robot, options: MoldOptions, *, pockets: Mapping[str, Sides | WinchRoom] | None = None) -> Mold:
    """The mold for a robot's body.

    `pockets` are what winches that sit in the body take up, by name; three sides [mm] if the shaft is in the middle.
    Raises InputError: the body is not closed, or a pocket is of a winch that is not there.
    """
    setting = mold_setting(robot)
    pull, stance = setting.pull, setting.stance
    inside = _fill_block(robot, options, setting.solid, pull, stance, pockets or {})
    closing = make_closing(
        inside.block,
        sprue=inside.sprue,
        vents=tuple(float(vent.at[0]) for vent in inside.vents if vent.upward),
        clearance=options.key_clearance,
    )
    halves = make_halves(
        inside.block, inside.body, inside.dents, inside.pockets, sprue=inside.sprue, vents=inside.vents, closing=closing
    )
    silicone = options.kind is MoldKind.SILICONE
    positive = make_positive(halves.cavity, inside.sprue)
    frames = make_frames(halves.cavity, inside.sprue) if silicone else None
    printed, dowels, lost = mold_prints(halves, positive, frames, inside.block, options.bed)
    fill = sum(halves.volumes[part] for part in ("cavity", "sprue", "vents"))
    casting, unlike = make_casting(
        robot.body.material, fill - displaced_volume(robot.body), pours=frames.pours if frames else ()
    )
    volumes = _silicone_volumes(halves, positive, frames) if frames else halves.volumes
    links = interlock_count(halves.lower, halves.cavity), interlock_count(halves.upper, halves.cavity)
    shape = frames.inside if frames else inside.block
    return Mold(
        kind=options.kind,
        pull=pull,
        stance=stance,
        printed=printed,
        assembly=_assembly(robot.name, halves, frames, positive, inside.block),
        volumes=volumes | {"cutting": lost},
        poured=halves.poured,
        box=shape.size,
        bolts=0 if silicone else len(closing.bolts),
        dowels=dowels,
        vents=len(inside.vents),
        stands=set_upright(stance, inside.sprue, inside.vents, options.kind),
        casting=casting,
        problems=(
            *unlike,
            *mold_problems(
                pull, robot.body.material, inside.sprue, inside.pockets, printed, options, halves, links=links
            ),
        ),
        warnings=mold_warnings(options.kind, links=links),
        notes=mold_notes(pull, robot.body.material, options.kind),
    )


def _silicone_volumes(halves: Halves, positive: Positive, frames: Frames) -> dict[str, float]:
    """Account of the room in the frames [mm^3]."""
    kept = {part: halves.volumes[part] for part in ("body", "dents", "pockets", "cavity")}
    lower, upper = frames.pours
    sides = float(frames.inside.solid.volume())
    return kept | {"box": sides, "sprue": positive.stub, "silicone_lower": lower, "silicone_upper": upper}


def _fill_block(
    robot: Robot,
    options: MoldOptions,
    solid: Manifold,
    pull: Pull,
    stance: MoldOrientation,
    rooms: Mapping[str, Sides | WinchRoom],
) -> _Inside:
    """Cavity, openings and the block round them."""
    body = stance.enter(solid)
    pockets = make_pockets(robot, body, stance, rooms, clearance=options.pocket_clearance)
    marks = options.mark_cables
    dents = cable_dents(robot, pull.surface, stance, deepest=options.mark_depth) if marks else Manifold()
    cavity = make_cavity(body, dents, pockets)
    block = _block(body, options)
    top = block.high[1]
    deep = min(-block.low[2], block.high[2])
    sprue = make_sprue(cavity, top=top, room=(block.low[0] + RIM, block.high[0] - RIM), deep=deep)
    vents = make_vents(cavity, sprue, low=block.low[2], high=block.high[2], top=top)
    return _Inside(body=body, dents=dents, pockets=pockets, cavity=cavity, block=block, sprue=sprue, vents=vents)


def _block(body: Manifold, options: MoldOptions) -> MoldBlock:
    """The outside: walls at the backs, a rim for keys and bolts, a higher one at the top for the funnel."""
    box = body.bounding_box()
    rim = max(options.wall, RIM)
    low = (box[0] - rim, box[1] - rim, box[2] - options.wall)
    high = (box[3] + rim, box[4] + max(options.wall, TOP_RIM), box[5] + options.wall)
    return MoldBlock(*grid(low, high, options.bed), low=low, high=high)


def _assembly(name: str, halves: Halves, frames: Frames | None, positive: Positive, block: MoldBlock) -> PartAssembly:
    """Assembly of the mold, in its coordinates."""
    ahead, aback = (0.0, 0.0, 0.6 * block.size[2]), (0.0, 0.0, -0.6 * block.size[2])
    if frames is None:
        pieces = (
            Placed(name="mould_lower", title="lower half", solid=halves.lower, pulled=aback),
            Placed(name="body", title="cast body", solid=halves.cavity, printed=False),
            Placed(name="mould_upper", title="upper half", solid=halves.upper, pulled=ahead),
        )
    else:
        pieces = (
            Placed(name="frame_lower", title="lower frame", solid=frames.lower, pulled=aback),
            Placed(name="positive_lower", title="lower half of the positive", solid=positive.lower),
            Placed(name="positive_upper", title="upper half of the positive", solid=positive.upper),
            Placed(name="frame_upper", title="upper frame", solid=frames.upper, pulled=ahead),
        )
    return PartAssembly(name=f"mold of {name}", pieces=pieces)


UNNOTICED = 0.05  # share of undercut that nobody notices: foam is pressed past it

TOLERATED = 0.3
"""Share of undercut beyond which a rigid mold is a problem. A judgment, measured on none: soft foam is squeezed to
less than half its thickness as it is drawn out, and comes back; but what grips all round tears it."""


def set_upright(stance: MoldOrientation, sprue: Sprue | None, vents: tuple[Vent, ...], kind: MoldKind) -> str:
    """Return the sentences on how to set up the mold for pouring."""
    held = ", the held end at the top" if stance.held_upwards else ""
    upward = sum(vent.upward for vent in vents)
    backward = len(vents) - upward
    text = f"Stand it on its edge, the parting plane upright, the funnel on top{held}."
    if sprue is not None:
        text += f" The sprue is {2 * sprue.radius:g} mm across."
    if vents and kind is MoldKind.SILICONE:
        return text + f" Punch {len(vents)} vents of 3 mm through the silicone at the high points."
    if upward:
        text += f" {upward} {_vents(upward)} open at the top."
    if backward:
        text += f" {backward} {_vents(backward)} open at the back of a half: close them with tape when foam comes out."
    return text


def _vents(count: int) -> str:
    return "vent is" if count == 1 else "vents are"


def mold_problems(
    pull: Pull,
    material: Material,
    sprue: Sprue | None,
    pockets: tuple[Pocket, ...],
    printed: tuple[Printed, ...],
    options: MoldOptions,
    halves: Halves,
    *,
    links: tuple[int, int] = (0, 0),
) -> tuple[str, ...]:
    """Return the problems of a mold; `links` counts holes of the body that the lower and upper half close."""
    found = [pocket.problem for pocket in pockets if pocket.problem] + clashes(pockets)
    rigid = options.kind is MoldKind.PRINTED
    if rigid and any(links):
        found.append(
            f"{_reaches(links)} and closes behind it like a link of a chain, so it cannot come off. Close "
            f"{'that hole' if sum(links) == 1 else 'these holes'} in the surface and cut the foam out afterwards, or "
            "choose a mold of silicone, which is cut open there"
        )
    stiff = 1e6  # Young's modulus from which on a body is not squeezed past an undercut by hand [Pa]
    if rigid and (pull.share > TOLERATED or (pull.share > UNNOTICED and material.young > stiff)):
        found.append(
            f"{100 * pull.share:.0f} % of the surface is undercut along the best of {len(pull.shares)} pulls: the body "
            "would tear as a rigid mold comes off. Choose a mold of silicone, which yields"
        )
    if sprue is None:
        found.append("the parting plane does not cross the body, so it cannot be poured. Simplify its surface")
    if rigid:
        found += [
            f"the {half} half of the mold falls into {len(parts)} pieces: the body reaches through its walls"
            for half, parts in (("upper", halves.upper.decompose()), ("lower", halves.lower.decompose()))
            if sum(part.volume() > 0 for part in parts) > 1
        ]
    for piece in printed:
        if not piece.fits(options.bed):
            found.append(f"{piece.title}: {sides_text(piece.size)} mm does not fit the printer. Use a larger printer")
    return tuple(found)


def _reaches(links: tuple[int, int]) -> str:
    """Return the words on how many holes of the body each half reaches through."""
    parts = [
        f"the {half} half of the mold reaches through {plural(count, 'hole')} of the body"
        for half, count in zip(("lower", "upper"), links, strict=True)
        if count
    ]
    return " and ".join(parts)


def mold_warnings(kind: MoldKind, *, links: tuple[int, int] = (0, 0)) -> tuple[str, ...]:
    """Return the warnings for the builder; `links` as in `mold_problems`."""
    found = []
    if kind is MoldKind.SILICONE and any(links):
        found.append(
            f"{_reaches(links)} and closes behind it. Silicone yields, but a closed loop cannot be drawn out. "
            "Cut the silicone open there with a knife, and tape the cut from outside before you pour"
        )
    return tuple(found)


def mold_notes(pull: Pull, material: Material, kind: MoldKind) -> tuple[str, ...]:
    """Return a note on a little undercut, which foam is squeezed past; empty if there is none."""
    if pull.share <= (UNNOTICED if kind is MoldKind.PRINTED else TOLERATED):
        return ()
    return (
        f"{100 * pull.share:.0f} % of the surface is undercut: {material.name or 'the body'} is squeezed past it. Use "
        "plenty of release agent, open the mold slowly and draw the body out part by part",
    )
