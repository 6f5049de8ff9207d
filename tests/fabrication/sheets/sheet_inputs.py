"""Small inputs of sheets: a square of plush, a box of foam, parts of a few shapes, lists of a few rows."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from builders import box_mesh, mesh_body
from kit_plans import change_plan, make_plan
from manifold3d import Manifold
from plush_robots import SQUARE, drawn_body

from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import Method, MoldKind
from hydrostat.fabrication.kit_plan import KitFindings, KitPlan
from hydrostat.fabrication.lists.bill import BillGroup, Item, Price, bill_table
from hydrostat.fabrication.lists.cuts import CableCut, SheathRow, cable_table
from hydrostat.fabrication.lists.line import LineRow
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.lists.motors import MotorRow
from hydrostat.fabrication.lists.table import Table
from hydrostat.fabrication.moulds.casting import make_casting
from hydrostat.fabrication.moulds.mould import Mold
from hydrostat.fabrication.moulds.pull import Pull
from hydrostat.fabrication.moulds.release import FineSurface
from hydrostat.fabrication.moulds.stance import MoldOrientation
from hydrostat.fabrication.parts.motor import MOTORS
from hydrostat.fabrication.patterns.stitches import cable_stitches
from hydrostat.fabrication.sheets.map_layout import body_solid
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Box, Cylinder, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.geometry import Mesh
from hydrostat.robot import MATERIALS, Body, Cable, Mount, Pin, Robot, Winch


class Given(NamedTuple):
    """Arguments of `assembly_sheet`."""

    plan: KitPlan
    lists: Lists
    findings: KitFindings


def winch() -> PartAssembly:
    """A motor, a spool and a housing on one axis."""
    spool = Cylinder(2, 9) + Cylinder(12, 6) + Cylinder(2, 9).move(0, 0, 10) - Cylinder(12, 1.5)
    housing = Box((24, 24, 17)).move(-12, -12, 0) - Cylinder(14, 10).move(0, 0, 3) - Cylinder(30, 2.2)
    motor = Box((12, 10, 25)).move(-6, -5, -25) + Cylinder(12, 1.5)
    return PartAssembly(
        name="winch",
        pieces=(
            Placed(name="motor", title="Geared motor", solid=solid_of(motor), pulled=(0, 0, -22), printed=False),
            Placed(name="housing", title="Housing", solid=solid_of(housing)),
            Placed(name="spool", title="Spool", solid=solid_of(spool.move(0, 0, 4)), pulled=(0, 0, 26)),
        ),
    )


def stopper() -> PartAssembly:
    """Two blocks."""
    block = solid_of(Box((10, 8, 3)))
    return PartAssembly(
        name="stopper",
        pieces=(
            Placed(name="stopper_base", title="Stopper base", solid=block),
            Placed(name="stopper_lid", title="Stopper lid", solid=block.translate((0, 0, 3)), pulled=(0, 0, 9)),
        ),
    )


def printed(winches: int, cables: int) -> tuple[Printed, ...]:
    """The printed pieces of both."""
    pieces = [(placed, winches) for placed in winch().pieces] + [(placed, cables) for placed in stopper().pieces]
    return tuple(
        Printed(name=placed.name, title=placed.title, solid=placed.solid, count=count)
        for placed, count in pieces
        if placed.printed
    )


def lists(cables: int, items: int | tuple[Item, ...] = 8, **more: Any) -> Lists:
    """Lists of a number of cables, each in a tube, and of some things to buy."""
    price = Price(amount=3.0, unit="m")
    if isinstance(items, int):
        names = [f"thing number {number}" for number in range(1, items + 1)]
        items = tuple(
            Item(group=BillGroup.BODY, what=name, specification="", quantity=1.0, price=price) for name in names
        )
    cuts = [
        CableCut(
            number=number, winch="pull", body=40.0, slack=1.5, outside=0.0, lead=0.0, wraps=0.0, release=0.0, tail=80.0
        )
        for number in range(1, cables + 1)
    ]
    tubes = [
        SheathRow(
            cable=f"C{number}",
            winch="pull",
            start="1 (winch)",
            end="2",
            bore=1,
            tube=2,
            run=23.25,
            seat=0,
            length=23.25,
        )
        for number in range(1, cables + 1)
    ]
    known = {
        "bill": bill_table(items),
        "cables": cable_table(tuple(cuts)),
        "tubes": Table(name="sheath_cuts", title="Sheaths", row=SheathRow, rows=tuple(tubes)),
        "stitching": None,
        "strength": Table(name="line_strength", title="Line", row=LineRow, rows=()),
        "motors": Table(name="motor_sizing", title="Motors", row=MotorRow, rows=()),
        "power": None,
    }
    return Lists(**(known | more))


def checks(count: int, *, failed: int = 0) -> tuple[Check, ...]:
    """Claims, of which the last fail."""
    return tuple(
        Check(what=f"claim {number}", measured="0.004 mm", allowed="0.1 mm", passed=number < count - failed)
        for number in range(count)
    )


def plush(*, name: str = "Sam", winches: int = 1, cables: int = 2, **more: Any) -> Given:
    """A square of plush with cables side by side."""
    body = drawn_body(SQUARE)
    routes = [
        tuple((1e-3 * x, 1e-3 * y) for x, y in ((at, -30.0), (at, -10.0), (at, 10.0), (at, 30.0)))
        for at in np.linspace(-40, 40, cables).tolist()
    ]
    robot = _robot(name, body, routes, winches, Mount.BODY)
    seam = body.outline.polygon if body.outline is not None else None
    assert seam is not None
    return _given(robot, method=Method.PLUSH, stitches=cable_stitches(robot, _millimeters(seam)), **more)


def foam(*, name: str = "Sam", winches: int = 2, cables: int = 2, silicone: bool = False, **more: Any) -> Given:
    """A box of foam with cables side by side, their winches below it."""
    mesh = box_mesh((5, 4, 3), size=(0.1, 0.08, 0.06))
    body = mesh_body(Mesh(mesh.nodes - 0.04, mesh.elements), material=MATERIALS["flexfoam-it x"])
    routes = [
        ((at, -0.08, 0.0), (at, -0.03, 0.0), (at, 0.0, 0.01), (at, 0.03, 0.0))
        for at in np.linspace(-0.03, 0.05, cables).tolist()
    ]
    robot = _robot(name, body, routes, winches, Mount.WORLD)
    return _given(robot, **({"method": Method.FOAM, "mould": mould(robot, silicone=silicone)} | more))


def mould(robot: Robot, *, silicone: bool = False) -> Mold:
    """Two halves of a box, parted along z; what looks down along y is said to hold."""
    piece = body_solid(robot)
    one, two, three = (piece.vertices[corner] for corner in piece.triangles.T)
    held = np.cross(two - one, three - one)[:, 1] < 0
    half = Box((120, 100, 40)) - Box((100, 80, 30)).move(10, 10, 10)
    casting, _ = make_casting(robot.body.material, 480e3, pours=(400e3, 300e3) if silicone else ())
    pieces = (
        Placed(name="mould_lower", title="lower half", solid=solid_of(half), pulled=(0, 0, -40)),
        Placed(name="mould_upper", title="upper half", solid=solid_of(half.rotate(x=180).move(0, 100, 80))),
    )
    return Mold(
        kind=MoldKind.SILICONE if silicone else MoldKind.PRINTED,
        pull=Pull(
            direction=np.array([0.0, 0.0, 1.0]),
            height=0.0,
            share=0.123,
            surface=FineSurface(piece.vertices, piece.triangles),
            undercut=held,
            directions=np.eye(3),
            shares=np.zeros(3),
        ),
        stance=MoldOrientation(np.eye(3), 0.0),
        printed=(),
        assembly=PartAssembly(name="mould", pieces=pieces),
        volumes={},
        poured=Manifold(),
        box=(120.0, 100.0, 80.0),
        bolts=0 if silicone else 6,
        dowels=0,
        vents=2,
        stands="It stands on its edge, the funnel on top.",
        casting=casting,
        problems=(),
        warnings=(),
    )


def _robot(name: str, body: Body, routes: list[Any], winches: int, mount: Mount) -> Robot:
    """Cables shared among winches in turn; each winch is where its first cable begins."""
    names = [f"pull {number}" for number in range(1, winches + 1)]
    if mount is Mount.WORLD:
        routes = [(routes[index % winches][0], *route[1:]) for index, route in enumerate(routes)]
        return _made(name, body, routes, names, mount, {})
    return _made(name, body, routes, names, mount, {"spool_radius": 0.05})


def _made(name: str, body: Body, routes: list[Any], names: list[str], mount: Mount, winch: dict[str, float]) -> Robot:
    count = len(names)
    return Robot(
        name=name,
        body=body,
        pins=(Pin(at=(0.0,) * body.mesh.dim, radius=1.0),),
        winches=tuple(Winch(name=own, at=routes[index][0], mount=mount, **winch) for index, own in enumerate(names)),
        cables=tuple(
            Cable(winch=names[index % count], points=route, sheathed=((0, 1),)) for index, route in enumerate(routes)
        ),
        poses={},
    )


def _given(robot: Robot, **more: Any) -> Given:
    winches, cables = len(robot.winches), len(robot.cables)
    demand = Demand(poses=(), tensions=np.zeros(cables), torques=np.zeros(winches), taken=np.zeros((winches, 2)))
    known = {
        "motor": replace(MOTORS[0], title="Geared motor, 6 V"),
        "winch_assembly": winch(),
        "stopper_assembly": stopper(),
        "printed": printed(winches, cables),
        "checks": checks(6),
    }
    return changed(Given(make_plan(robot, demand), lists(cables), KitFindings()), **(known | more))


def changed(given: Given, **facts: Any) -> Given:
    """Other facts of the plan, the findings and the lists, by their names."""
    told = {name: facts.pop(name) for name in ("checks", "problems", "warnings") if name in facts}
    made = facts.pop("lists", given.lists)
    return Given(change_plan(given.plan, **facts), made, replace(given.findings, **told))


def _millimeters(polygon: Any) -> Any:
    from shapely.affinity import scale

    return scale(polygon, 1e3, 1e3, origin=(0, 0))
