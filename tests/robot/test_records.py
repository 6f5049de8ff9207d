"""The frozen records and what they check of themselves."""

import pickle
from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import FOAM, box_mesh, box_robot, mesh_body, strip_mesh, strip_robot
from robot_files import SVG, load
from shapely import Point as ShapelyPoint
from shapely import Polygon, unary_union

from hydrostat.errors import InputError
from hydrostat.learning import physics_hash
from hydrostat.robot import (
    Body,
    BodyPart,
    Cable,
    Load,
    Marker,
    Material,
    Mount,
    Pin,
    PoseTarget,
    PronyTerm,
    Robot,
    Source,
    Volume,
    Winch,
    get_material,
)
from hydrostat.simulation import Simulation

INF, NAN = float("inf"), float("nan")
LINE = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.1))


@pytest.mark.parametrize("value", [0.0, -1.0, INF, NAN, -INF])
@pytest.mark.parametrize(
    ("kind", "field", "others"),
    [
        (Material, "young", {"poisson": 0.3, "density": 40.0}),
        (Material, "density", {"poisson": 0.3, "young": 40.0}),
        (Winch, "spool_radius", {"name": "w", "at": (0.0, 0.0)}),
        (Winch, "travel", {"name": "w", "at": (0.0, 0.0)}),
        (Cable, "stiffness", {"winch": "w", "points": LINE}),
        (Cable, "smoothing", {"winch": "w", "points": LINE}),
        (Pin, "stiffness", {"at": (0.0, 0.0)}),
        (PronyTerm, "modulus", {"time": 1.0}),
        (PronyTerm, "time", {"modulus": 1.0}),
    ],
)
def test_positive(kind: type, field: str, others: dict, value: float) -> None:
    """Oracle: the message names the field, the value and what is allowed."""
    with pytest.raises(InputError, match=f"^{field} must be finite and above 0, not ({value:g}|{1e3 * value:g} mm)\\b"):
        kind(**{field: value}, **others)


@pytest.mark.parametrize("value", [-1e-9, INF, NAN])
@pytest.mark.parametrize(
    ("kind", "field", "others"),
    [
        (Material, "viscosity", {"young": 1e3, "poisson": 0.3, "density": 1.0}),
        (Winch, "release", {"name": "w", "at": (0.0, 0.0)}),
        (Cable, "slack", {"winch": "w", "points": LINE}),
        (Pin, "radius", {"at": (0.0, 0.0)}),
    ],
)
def test_not_negative(kind: type, field: str, others: dict, value: float) -> None:
    """Oracle: 0 is allowed, less is not; the message names the field and the value."""
    assert getattr(kind(**{field: 0.0}, **others), field) == 0.0
    with pytest.raises(
        InputError, match=f"^{field} must be finite and not negative, not (-1e-09 Pa s|-1e-06 mm|inf|nan)"
    ):
        kind(**{field: value}, **others)


@pytest.mark.parametrize("point", [(0.0, NAN), (INF, 0.0), (0.0,), (0.0,) * 4, ()])
@pytest.mark.parametrize(
    "make",
    [
        lambda point: Marker(name="m", at=point),
        lambda point: Winch(name="w", at=point),
        lambda point: Pin(at=point),
        lambda point: Pin(box=((0.0, 0.0), point)),
        lambda point: PoseTarget(name="p", targets={"m": point}),
        lambda point: Cable(winch="w", points=(point, (1.0, 1.0))),
    ],
)
def test_points(make, point: tuple) -> None:
    """Oracle: a place is two or three finite numbers."""
    with pytest.raises(InputError, match=r"finite coordinates, not \[|coordinates; a point has two, or three"):
        make(point)


@pytest.mark.parametrize("point", [0.1, None, "ab", ("a", "b"), (None, 0.0), (1j, 0.0)])
def test_what_is_no_place_is_told_in_one_line(point: Any, unchecked: None) -> None:
    with pytest.raises(InputError, match=r"^targets\.m must be two or three coordinates \[m\], not [^\n]*$"):
        PoseTarget(name="p", targets={"m": point})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Material(young=1.0, poisson=0.5, density=1.0), "poisson must be at least 0 and below 0.5, not 0.5"),
        (lambda: Material(young=1.0, poisson=-0.01, density=1.0), "poisson must be at least 0"),
        (lambda: Material(young=1.0, poisson=NAN, density=1.0), "poisson must be at least 0"),
        (
            lambda: replace(FOAM, relaxation=(PronyTerm(modulus=1.0, time=1.0),) * 11),
            "relaxation must have at most 10 branches, not 11",
        ),
        (lambda: Cable(winch="w", points=LINE, friction=-0.01), "friction must be at least 0 and at most 2, not -0.01"),
        (lambda: Cable(winch="w", points=LINE, friction=2.01), "friction must be at least 0 and at most 2, not 2.01"),
        (lambda: Cable(winch="w", points=LINE, friction=NAN), "friction must be at least 0 and at most 2, not nan"),
        (lambda: get_material("steel"), 'unknown material "steel"; `hydrostat materials` lists all'),
        (lambda: Winch(name="", at=(0.0, 0.0)), "name must not be empty"),
        (lambda: Marker(name="", at=(0.0, 0.0)), "name must not be empty"),
        (lambda: PoseTarget(name="", targets={"m": (0.0, 0.0)}), "name must not be empty"),
        (lambda: PoseTarget(name="p", targets={}), "targets must name at least one marker"),
        (lambda: Pin(), "either at .* or box"),
        (lambda: Pin(at=(0.0, 0.0), box=((0.0, 0.0), (1.0, 1.0))), "either at .* or box"),
        (lambda: Pin(box=((0.0, 0.0), (1.0, 1.0)), radius=1.0), "radius goes with at"),
        (lambda: Cable(winch="w", points=()), "points must hold at least 2 points, not 0"),
        (
            lambda: Cable(winch="w", points=((0.0, 0.0), (1.0, 1.0, 1.0))),
            r"points\[1\] has 3 coordinates, but points\[0\]",
        ),
        (lambda: Cable(winch="w", points=(*LINE, LINE[-1])), r"points\[2\] and points\[3\] are the same"),
        (lambda: Cable(winch="w", points=LINE, sheathed=((0, 3),)), r"sheathed = \[0, 3\] .* from 0 to 2"),
        (lambda: Cable(winch="w", points=LINE, sheathed=((-1, 1),)), r"sheathed = \[-1, 1\]"),
        (lambda: Cable(winch="w", points=LINE, sheathed=((0, 1), (1, 2))), "the whole cable is sheathed"),
        (lambda: mesh_body(box_mesh((1, 1, 1)), thickness=0.1), "thickness is only for flat bodies"),
        (lambda: mesh_body(strip_mesh(1, 1), thickness=-0.1), "thickness must be finite and above 0, not -100 mm"),
        (lambda: replace(mesh_body(strip_mesh(1, 1)), thickness=None), "thickness is missing"),
        (lambda: replace(mesh_body(strip_mesh(1, 1)), size=NAN), "size must be finite"),
    ],
)
def test_refused(make, message: str) -> None:
    """Oracle: the message."""
    with pytest.raises(InputError, match=message) as caught:
        make()
    assert str(caught.value).isprintable()


POSE = PoseTarget(name="p", targets={"tip": (0.2, 0.0)})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": ""}, "name must not be empty"),
        ({"gravity": (0.0, 0.0, -9.81)}, "gravity has 3 entries, but the body has 2 axes; give one for each"),
        ({"gravity": ()}, "gravity has 0 entries, but the body has 2"),
        ({"gravity": (NAN, 0.0)}, r"gravity\[0\] must be from -1000 to 1000 m/s\^2, not nan m/s"),
        ({"gravity": (0.0, -INF)}, r"gravity\[1\] must be from -1000 to 1000 m/s\^2, not -inf m/s"),
        ({"gravity": (1000.5, 0.0)}, r"gravity\[0\] must be from -1000 to 1000 m/s\^2, not 1000.5 m/s"),
        ({"length_unit": "nonsense"}, 'length_unit: unknown unit "nonsense"; write a length'),
        ({"pins": ()}, r"no \[\[pin\]\]: the body is unconstrained"),
        ({"pins": (Pin(at=(0.1, 0.0)),)}, "can still turn"),
        ({"pins": (Pin(at=(9.0, 0.0)),)}, r"pin\[0\]: the pin lies outside the body"),
        ({"pins": (Pin(at=(0.1, 0.0, 0.0)),)}, r"pin\[0\] has 3 coordinates, but the body has 2"),
        ({"cables": (Cable(winch="no", points=LINE),)}, r'cable\[0\].winch: unknown winch "no"\. Available: up, down'),
        ({"winches": (Winch(name="a", at=(0.0, 0.0)),) * 2, "cables": ()}, r'winch\[1\].name: there are two .* "a"'),
        ({"winches": (Winch(name="a", at=(0.0, 9.0)),), "cables": ()}, r"winch\[0\].at = \[0, 9000\] lies 8975 mm out"),
        ({"markers": (Marker(name="m", at=(0.1, 0.0)),) * 2}, r'marker\[1\].name: there are two of the name "m"'),
        (
            {"markers": (), "poses": {"p": POSE}},
            r'pose\[0\].targets.tip: unknown marker "tip"\. The robot has no markers',
        ),
        ({"poses": {"q": POSE}}, r'pose\[0\].name: a pose called "p" is filed under "q"'),
        (
            {"poses": {"p": PoseTarget(name="p", targets={"tip": (0.1, 0.0, 0.0)})}},
            r"pose\[0\].targets.tip has 3 coordinates",
        ),
    ],
)
def test_parts_fit(changes: dict, message: str) -> None:
    """Oracle: the message names the part as robot.toml would."""
    with pytest.raises(InputError, match=message):
        replace(strip_robot(columns=4, rows=2), **changes)


def test_texts_of_a_closed_set(unchecked: None) -> None:
    """Oracle: a text gives the obstacle itself that it names, any other one line that says what there is."""
    body, winch = strip_robot(columns=4, rows=2).body, Winch(name="w", at=(0.0, 0.0), mount="world")  # type: ignore[arg-type]
    given: dict[str, Any] = {"volume": "patch", "source": "mesh", "material": "Flexfoam-it X"}
    named = replace(body, **given)
    assert winch.mount is Mount.WORLD
    assert (named.volume, named.source) == (Volume.PATCH, Source.MESH)
    assert named.volume is Volume.PATCH
    assert named.material is get_material("flexfoam-it x")
    assert replace(strip_robot(columns=4, rows=2), gravity="-y").gravity == (0.0, -9.80665)
    with pytest.raises(InputError, match=r'^gravity: "down" is no direction of this body; .* -x, .x, -y, .y$'):
        replace(strip_robot(columns=4, rows=2), gravity="down")
    for field, words in {
        "volume": "volume must be one of element, patch, not",
        "source": "source must be one of outline, surface, mesh, not",
        "material": "unknown material",
    }.items():
        with pytest.raises(InputError, match=f'^{words} "nonsense"'):
            replace(body, **{field: "nonsense"})
    for wrong, words in {"World": '"World"', None: "None", 3: "3", "": '""'}.items():
        with pytest.raises(InputError, match=f"^mount must be one of body, world, not {words}$"):
            replace(winch, mount=wrong)


def test_pins_in_space() -> None:
    """Oracle: rigid motions: a point or a line of pins leaves a body in space free to turn, a triangle does not."""
    robot = box_robot()
    corners = tuple(Pin(at=tuple(map(float, node))) for node in robot.body.mesh.nodes[[0, 1, 2]])
    assert len(replace(robot, pins=(corners[0], Pin(at=(0.1, 0.02, 0.03)), corners[1])).pins) == 3
    for pins in (corners[:1], corners[:2], corners):  # the three lie on a line
        with pytest.raises(InputError, match="can still turn"):
            replace(robot, pins=pins)


def test_world_winch_and_its_cable() -> None:
    """Oracle: a winch in the world may stand outside; its cable begins there exactly and is inside from then on."""
    robot = strip_robot(columns=4, rows=2, mount=Mount.WORLD)
    cable = robot.cables[0]
    moved = replace(cable, points=((-0.05, 0.041), *cable.points[1:]))
    with pytest.raises(InputError, match="a cable begins at its winch, but this is 1 mm from"):
        replace(robot, cables=(moved,))
    with pytest.raises(InputError, match=r"cable\[0\].points\[1\] = .* lies .* outside the body"):
        replace(robot, cables=(replace(cable, points=(cable.points[0], (-0.01, 0.0), (0.1, 0.0))),))


@pytest.mark.parametrize(
    "record",
    [
        strip_robot(columns=2, rows=1),
        FOAM,
        Pin(at=(0.0, 0.0)),
        Marker(name="m", at=(0.0, 0.0)),
        POSE,
        PronyTerm(modulus=1.0, time=1.0),
    ],
    ids=lambda record: type(record).__name__,
)
def test_frozen(record) -> None:
    """Oracle: Python's own refusal."""
    with pytest.raises(FrozenInstanceError):
        record.name = "other"


def test_look_up() -> None:
    """Oracle: the records given; a wrong name lists the right ones."""
    robot = replace(strip_robot(columns=4, rows=2), poses={"p": POSE})
    assert robot.winch("down") is robot.winches[1]
    assert robot.pose("p") is POSE
    with pytest.raises(InputError, match=r'unknown winch "left"\. Available: up, down'):
        robot.winch("left")
    with pytest.raises(InputError, match=r'unknown pose "q"\. Available: p'):
        robot.pose("q")
    with pytest.raises(InputError, match=r'unknown winch "left"\. The robot has no winches'):
        robot.with_network([], []).winch("left")


def test_with_network() -> None:
    """Oracle: everything else is the same object; the new parts are checked."""
    robot = strip_robot(columns=4, rows=2)
    other = robot.with_network(iter(robot.winches[:1]), iter(robot.cables[:1]))
    assert (other.winches, other.cables) == (robot.winches[:1], robot.cables[:1])
    assert all(getattr(other, field) is getattr(robot, field) for field in ("body", "pins", "markers", "poses"))
    assert len(robot.winches) == 2
    with pytest.raises(InputError, match='unknown winch "down"'):
        robot.with_network(robot.winches[:1], robot.cables)


def test_pins_and_markers_of_a_body_are_checked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another network does not check them again; others are checked, also after such as were refused."""
    robot, asked, distances = strip_robot(columns=4, rows=2), [], Body.distances
    monkeypatch.setattr(Body, "distances", lambda body, points: asked.append(len(points)) or distances(body, points))
    robot.with_network(robot.winches, robot.cables)
    assert asked == [len(robot.winches) + sum(len(cable.points) for cable in robot.cables)]
    outside = (Marker(name="tip", at=(0.3, 0.0)),)
    for _ in range(2):
        with pytest.raises(InputError, match="outside the body"):
            replace(robot, markers=outside)
        with pytest.raises(InputError, match=r"pin\[0\]"):
            replace(robot, pins=(Pin(at=(0.5, 0.0), radius=0.001),))
    assert replace(robot, poses={}).pins is robot.pins
    with pytest.raises(InputError, match="outside the body"):
        replace(robot, body=mesh_body(strip_mesh(4, 2, size=(0.1, 0.05))))


def test_a_pickled_body_holds_no_parts_of_a_robot() -> None:
    robot = strip_robot(columns=4, rows=2)
    assert b"hydrostat.robot.pin" in pickle.dumps(robot)
    assert b"hydrostat.robot.pin" not in pickle.dumps(robot.body)


@pytest.mark.parametrize("mesh", [strip_mesh(8, 4), box_mesh((3, 2, 2))], ids=["triangles", "tetrahedra"])
@pytest.mark.parametrize("seed", range(3))
def test_pin_holds_nodes(mesh, seed: int) -> None:
    """Oracle: each node in turn, measured by hand."""
    random = np.random.default_rng(seed)
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    at, corner = (tuple(map(float, random.uniform(low, high))) for _ in range(2))
    near = [node for node in mesh.nodes if np.sqrt(sum((node - at) ** 2)) <= 0.03]
    between = [
        node
        for node in mesh.nodes
        if all(min(a, b) <= x <= max(a, b) for x, a, b in zip(node, at, corner, strict=True))
    ]
    for pin, nodes in ((Pin(at=at, radius=0.03), near), (Pin(box=(at, corner)), between)):
        nodes = nodes or [np.array(at) if pin.box is None else 0.5 * np.add(at, corner)]
        assert pin.anchors(mesh).positions(mesh.nodes) == pytest.approx(np.array(nodes), abs=1e-12)


def test_pin_between_nodes() -> None:
    """Oracle: with no node in reach the pin holds its own point; outside the body it is refused."""
    mesh = strip_mesh(2, 1)
    held = Pin(at=(0.03, 0.004), radius=1e-3).anchors(mesh)
    assert held.positions(mesh.nodes) == pytest.approx(np.array([[0.03, 0.004]]), abs=1e-15)
    held = Pin(box=((0.02, 0.0), (0.04, 0.01))).anchors(mesh)
    assert held.positions(mesh.nodes) == pytest.approx(np.array([[0.03, 0.005]]), abs=1e-15)
    with pytest.raises(InputError, match="the pin lies outside the body and holds no node; move it"):
        Pin(at=(0.3, 0.0), radius=0.05).anchors(mesh)


def test_cable_lengths() -> None:
    """Oracle: the sides of a square."""
    cable = Cable(winch="w", points=((0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)), sheathed=((1, 3),))
    assert cable.segments == pytest.approx([0.1, 0.1, 0.1])
    assert cable.bare.tolist() == [True, False, False]
    assert cable.length == pytest.approx(0.3)


def test_mechanics_by_default() -> None:
    """Oracle: what robots were before these fields: weightless, elastic, without friction, volume in each element."""
    robot = strip_robot(columns=2, rows=1)
    assert (robot.gravity, robot.body.volume) == (None, Volume.ELEMENT)
    assert (FOAM.viscosity, FOAM.relaxation) == (0.0, ())
    assert {cable.friction for cable in robot.cables} == {0.0}


def test_limits_are_allowed() -> None:
    """Oracle: the ends of each range, and ten branches."""
    robot = replace(strip_robot(columns=2, rows=1), gravity=(-1000.0, 1000.0))
    assert robot.gravity == (-1000.0, 1000.0)
    assert [Cable(winch="w", points=LINE, friction=value).friction for value in (0.0, 2.0)] == [0.0, 2.0]
    assert len(replace(FOAM, relaxation=(PronyTerm(modulus=1.0, time=1.0),) * 10).relaxation) == 10


def test_elastic() -> None:
    """Oracle: the material before it was given a viscosity and a branch; its elastic numbers do not change."""
    viscous = replace(FOAM, viscosity=3.0, relaxation=(PronyTerm(modulus=1.0, time=1.0),))
    assert viscous != FOAM
    assert viscous.elastic == FOAM
    assert viscous.lame == FOAM.lame


def test_lame() -> None:
    """Oracle: the bulk and shear moduli by their textbook formulas."""
    mu, lam = Material(young=30e3, poisson=0.3, density=40).lame
    assert mu == pytest.approx(30e3 / 2.6)
    assert lam + 2 * mu / 3 == pytest.approx(30e3 / (3 * (1 - 2 * 0.3)))


def test_distances(tmp_path: Path) -> None:
    """Oracle: shapely's distance to the drawing and its hole, 0 also in triangles whose sides cut the hole's arc."""
    shapes = '<rect width="60" height="40" rx="18"/><circle cx="32" cy="20" r="6"/>'
    robot = load(tmp_path, 'format = 1\nname = "r"\n[body]\noutline = "body.svg"\nelement_size = "9 mm"\n'
                 'thickness = "9 mm"\nmaterial = "polyester fibre"\n[[pin]]\nat = [-20, 0]\nradius = 12\n',
                 svg=SVG.format(shapes))  # fmt: skip
    body = robot.body
    random = np.random.default_rng(1)
    ring = body.outline.exterior * 0.9999
    points = np.concatenate([random.uniform(-0.04, 0.04, (300, 2)), ring])
    drawn, meshed = body.outline.polygon, unary_union([Polygon(body.mesh.nodes[row]) for row in body.mesh.elements])
    places = [ShapelyPoint(point) for point in points]
    expected = [0.0 if meshed.intersects(place) else drawn.distance(place) for place in places]
    assert body.distances(points) == pytest.approx(expected, abs=1e-9)
    assert body.distances(np.array([[0.002, 0.0]])) == pytest.approx(6e-3, rel=1e-3)
    assert (body.distances(ring) == 0).all()


def test_distances_of_a_ready_mesh() -> None:
    """Oracle: the distance to a box, by hand."""
    body = mesh_body(strip_mesh(4, 2))
    places = np.array([[0.1, 0.0], [0.0, 0.025], [0.1, 0.035], [-0.03, 0.065]])
    assert body.distances(places) == pytest.approx([0, 0, 0.01, 0.05], abs=1e-12)


def test_bodies_compare_by_what_they_are_made_of() -> None:
    """Oracle: the definition: same file, same numbers, same body; the mesh follows from them."""
    body = mesh_body(strip_mesh(4, 2))
    assert body == mesh_body(strip_mesh(4, 2))
    assert body != replace(body, content=b"other")
    assert isinstance(body, Body)
    assert body.source is Source.MESH
    assert isinstance(strip_robot(columns=2, rows=1), Robot)


def test_a_pin_of_default_stiffness_holds_stiff_bodies() -> None:
    """Oracle: the same bar clamped by a pin that is a thousand times as stiff, under the same load."""

    def tip(young: float, **given: float) -> tuple[Robot, float]:
        robot = box_robot().with_material(young=young)
        pins = tuple(replace(pin, **given) for pin in robot.pins)
        load = Load(name="down", marker="tip", force=(0.0, 0.0, -1e-5 * young))
        held = replace(robot, pins=pins, loads=(load,))
        return held, float(Simulation(held).solve({}).markers["tip"][2])

    for young in (30e3, 60e3, 1e6, 12e6):
        robot, found = tip(young)
        clamped = tip(young, stiffness=1e3 * robot.pins[0].stiffness)[1]
        assert found - 0.02 == pytest.approx(clamped - 0.02, rel=0.02)
    assert tip(12e6, stiffness=1e5)[1] - 0.02 < 1.5 * (clamped - 0.02)  # as soft as in plush


def test_a_pin_of_default_stiffness_follows_the_body_and_a_given_one_does_not() -> None:
    strip = strip_robot()
    assert strip.pins[0].stiffness == 100e3  # plush
    stiff = strip.with_material(young=12e6)
    held, thickness = 5, strip.body.thickness or 0.0
    assert stiff.pins[0].stiffness == pytest.approx(100 * held * 12e6 * thickness, rel=1e-2)
    assert stiff.with_material(young=30e3).pins == strip.pins
    assert (strip.pins[0].is_sized, stiff.pins[0].is_sized) == (False, True)
    given = replace(strip, pins=(replace(strip.pins[0], stiffness=100e3),))
    assert given.with_material(young=12e6).pins == given.pins


def test_a_pin_of_default_stiffness_is_sized_by_the_parts_at_its_nodes() -> None:
    strip = strip_robot()
    steel, (pin,) = replace(strip.body.material, young=2e11), strip.pins
    left, right = strip.body.mesh.nodes[:, 0].min(), strip.body.mesh.nodes[:, 0].max()
    held = strip.body.mesh.nodes[pin.holds(strip.body.mesh), 0].mean() - left
    assert held < 0.3 * (right - left)
    for low, high, is_sized in ((0.7, 2.0, False), (-1.0, 0.3, True)):
        x = left + np.array([low, high]) * (right - left)
        part = BodyPart(name="insert", shape="box", at=(x[0], -1.0), to=(x[1], 1.0), material=steel)
        assert replace(strip, body=strip.body.with_parts([part])).pins[0].is_sized is is_sized


def test_the_physics_hash_knows_the_pins_that_a_body_sized(monkeypatch: pytest.MonkeyPatch) -> None:
    """Their stiffness is in no robot.toml; plush keeps the default, and its hash."""
    plush, stiff = strip_robot(), strip_robot().with_material(young=12e6)
    before = physics_hash(plush), physics_hash(stiff)
    monkeypatch.setattr("hydrostat.robot.pin._RIGID", 50)
    assert physics_hash(strip_robot()) == before[0]
    assert physics_hash(strip_robot().with_material(young=12e6)) != before[1]
