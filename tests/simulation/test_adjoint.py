"""Slopes of a pose by all that a robot is made of (E16). Oracle: central differences of fully converged solves."""

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_mesh

from hydrostat.errors import InputError
from hydrostat.geometry import Outline, locate
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import (
    BodyPart,
    Cable,
    FoamTerm,
    Load,
    Marker,
    Material,
    Mount,
    Pin,
    Plane,
    Robot,
    Rod,
    Volume,
    Winch,
)
from hydrostat.simulation import Simulation
from hydrostat.simulation.route_points import route_points
from hydrostat.simulation.sensitivities.adjoint import Sensitivity, sensitivities

TIGHT = NewtonOptions(tolerance=1e-13)
RUBBER = replace(FOAM, poisson=0.47)
UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))
LOWER = ((0.0087, -0.0143), (0.0921, -0.0157), (0.1827, -0.0139))


def strip(*, mount: Mount = Mount.BODY, sheathed: tuple[tuple[int, int], ...] = (), shared: bool = False) -> Robot:
    """A strip with a cable above and one below the middle; no point is on the border of an element."""
    upper = ((-0.03, 0.04), *UPPER[1:]) if mount is Mount.WORLD else UPPER
    winches = (Winch(name="up", at=upper[0], mount=mount), Winch(name="down", at=LOWER[0], spool_radius=0.03))
    return Robot(
        name="strip",
        body=mesh_body(strip_mesh(8, 2)),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=3e3),),
        winches=winches[1:] if shared else winches,
        cables=(
            Cable(winch="down" if shared else "up", points=upper, slack=0.001, sheathed=sheathed),
            Cable(winch="down", points=LOWER, slack=0.002, stiffness=3e3),
        ),
        markers=(Marker(name="tip", at=(0.2, 0.0)),),
        poses={},
    )


def box() -> Robot:
    """A box in space with a cable whose winch stands in the world and one whose winch is in the body."""
    one = ((-0.02, 0.013, 0.037), (0.0523, 0.0117, 0.0313), (0.1031, 0.0107, 0.0289))
    two = ((0.0067, 0.0311, 0.0113), (0.0541, 0.0287, 0.0127), (0.1047, 0.0283, 0.0121))
    return Robot(
        name="box",
        body=mesh_body(box_mesh((4, 2, 2), size=(0.12, 0.04, 0.04))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="one", at=one[0], mount=Mount.WORLD), Winch(name="two", at=two[0])),
        cables=(Cable(winch="one", points=one, slack=0.001), Cable(winch="two", points=two, slack=0.001)),
        markers=(Marker(name="tip", at=(0.12, 0.02, 0.02)),),
        poses={},
    )


def heavy_patches(robot: Robot) -> Robot:
    """Nearly incompressible, its volume measured in patches, with weight."""
    down = (0.0,) * (robot.body.mesh.dim - 1) + (-9.81,)
    return replace(robot, body=replace(robot.body, material=RUBBER, volume=Volume.PATCH), gravity=down)


def quadratic(robot: Robot) -> Robot:
    """The same of quadratic elements, by whose points and mean volume Poisson's ratio is felt."""
    heavy = heavy_patches(robot)
    return replace(heavy, body=replace(heavy.body, volume=Volume.ELEMENT).with_elements("quadratic"))


def stepped(robot: Robot) -> Robot:
    """Its cables on spools of 1.5 and 0.7 times the radius of their winches."""
    radii = [
        factor * robot.winch(cable.winch).spool_radius for factor, cable in zip((1.5, 0.7), robot.cables, strict=True)
    ]
    cables = (replace(cable, spool_radius=radius) for cable, radius in zip(robot.cables, radii, strict=True))
    return robot.with_network(robot.winches, cables)


def in_parts(robot: Robot) -> Robot:
    """With weight, a stiffer stretch and a rigid end."""
    stiff = Material(young=90e3, poisson=0.42, density=300.0)
    parts = (
        BodyPart(name="stiff", shape="box", at=(0.03, -1.0), to=(0.08, 1.0), material=stiff),
        BodyPart(name="end", shape="box", at=(0.1, -1.0), to=(0.15, 1.0), density=1240.0),
    )
    heavy = heavy_patches(robot)
    return replace(heavy, body=replace(heavy.body, parts=parts))


def with_foam(robot: Robot) -> Robot:
    """The same with a foam part, in plane stress."""
    foam = Material(young=40e3, poisson=0.2, density=90.0, foam=(FoamTerm(share=0.9, exponent=6), SOFT_TERM))
    heavy = in_parts(robot)
    stiff, end = heavy.body.parts
    assert stiff.material is not None
    padded = replace(stiff, material=foam)
    return replace(heavy, body=replace(heavy.body, volume=Volume.ELEMENT, plane=Plane.STRESS, parts=(padded, end)))


SOFT_TERM = FoamTerm(share=0.1, exponent=-2)
CASES = {
    "foam part": (with_foam(strip()), [0.02, 0.009]),
    "parts": (in_parts(strip()), [0.02, 0.009]),
    "taut": (strip(), [0.02, 0.009]),
    "large": (strip(), [0.05, 0.0095]),
    "cubic zone": (strip(), [0.004, 0.0098]),
    "one slack": (strip(), [0.02, -0.01]),
    "shared winch": (strip(shared=True), [0.01]),
    "steps of one shaft": (stepped(strip(shared=True)), [0.01]),
    "sheathed": (strip(sheathed=((1, 2),)), [0.02, 0.011]),
    "world": (strip(mount=Mount.WORLD), [0.015, 0.013]),
    "patches with weight": (heavy_patches(strip(sheathed=((0, 1),))), [0.02, 0.009]),
    "quadratic": (quadratic(strip()), [0.02, 0.009]),
    "quadratic in space": (quadratic(box()), [0.006, 0.008]),
    "space": (box(), [0.006, 0.008]),
    "patches in space": (heavy_patches(box()), [0.006, 0.008]),
}


class Loss:
    """L = v . nodes + t . tensions with random v and t, of the pose of a robot that is changed."""

    def __init__(self, robot: Robot, contractions: np.ndarray) -> None:
        rng = np.random.default_rng(5)
        self.robot, self.contractions = robot, contractions
        self.simulation = Simulation(robot, options=TIGHT)
        self.pose = self.simulation.solve(contractions)
        self.nodes = rng.normal(size=self.pose.nodes.shape)
        self.tensions = 0.02 * rng.normal(size=len(robot.cables))

    def slopes(self) -> Sensitivity:
        return self.simulation.adjoint(self.pose, self.nodes, tensions=self.tensions)

    def at(self, robot: Robot, contractions: np.ndarray | None = None) -> float:
        given = self.contractions if contractions is None else contractions
        pose = Simulation(robot, options=TIGHT).solve(given, start=self.pose)
        return float((self.nodes * pose.nodes).sum() + self.tensions @ pose.tensions)

    def difference(self, changed: Callable[[float], Robot], step: float) -> float:
        """Fourth order: Richardson on central differences."""
        wide, near = ((self.at(changed(h)) - self.at(changed(-h))) / (2 * h) for h in (step, step / 2))
        return (4 * near - wide) / 3

    def by_contractions(self) -> np.ndarray:
        def slope(shift: np.ndarray) -> float:
            ahead, behind = (self.at(self.robot, self.contractions + side * shift) for side in (1, -1))
            return (ahead - behind) / (2 * shift.max())

        shifts = 1e-5 * np.eye(len(self.contractions))
        return np.array([(4 * slope(shift / 2) - slope(shift)) / 3 for shift in shifts])

    def by_cables(self, name: str, step: float) -> np.ndarray:
        def changed(cable: int, change: float) -> Robot:
            one = self.robot.cables[cable]
            return with_cable(self.robot, cable, replace(one, **{name: getattr(one, name) + change}))

        return np.array(
            [self.difference(lambda h, c=cable: changed(c, h), step) for cable in range(len(self.robot.cables))]
        )

    def by_routes(self, step: float) -> list[np.ndarray]:
        found = [np.zeros((len(cable.points), self.robot.body.mesh.dim)) for cable in self.robot.cables]
        for cable, slopes in enumerate(found):
            for place, axis in np.ndindex(*slopes.shape):
                shift = np.zeros(slopes.shape)
                shift[place, axis] = 1.0
                slopes[place, axis] = self.difference(lambda h, c=cable, s=shift: moved(self.robot, c, h * s), step)
        return found

    def by_material(self, name: str, step: float) -> float:
        material = self.robot.body.material
        return self.difference(
            lambda h: with_body(self.robot, material=replace(material, **{name: getattr(material, name) + h})), step
        )


def with_body(robot: Robot, **changes: object) -> Robot:
    return replace(robot, body=replace(robot.body, **changes))


def with_cable(robot: Robot, index: int, cable: Cable) -> Robot:
    return replace(robot, cables=(*robot.cables[:index], cable, *robot.cables[index + 1 :]))


def moved(robot: Robot, index: int, shift: np.ndarray) -> Robot:
    """The robot with the points of a cable shifted, and its winch with the first of them if that is in the world."""
    cable = robot.cables[index]
    points = tuple(tuple(point) for point in (np.array(cable.points) + shift).tolist())
    winches = tuple(
        replace(winch, at=points[0]) if winch.name == cable.winch and winch.mount is Mount.WORLD else winch
        for winch in robot.winches
    )
    cables = (*robot.cables[:index], replace(cable, points=points), *robot.cables[index + 1 :])
    return robot.with_network(winches, cables)


def agree(slopes: np.ndarray, found: np.ndarray, *, within: float = 1e-6) -> bool:
    """Whether slopes are those found, to a share of the largest."""
    largest = np.abs(found).max(initial=0.0)
    return bool(np.abs(np.asarray(slopes) - found).max(initial=0.0) <= within * largest)


@pytest.fixture(params=CASES)
def loss(request: pytest.FixtureRequest, unchecked: None) -> Loss:
    robot, contractions = CASES[request.param]
    return Loss(robot, np.array(contractions))


def test_by_contractions_and_cables(loss: Loss) -> None:
    slopes = loss.slopes()
    assert agree(slopes.contractions, loss.by_contractions())
    assert agree(slopes.slack, loss.by_cables("slack", 1e-5))
    assert agree(slopes.cable_stiffness, loss.by_cables("stiffness", 20.0))


def test_by_routes(loss: Loss) -> None:
    slopes, found = loss.slopes().routes, loss.by_routes(1e-5)
    assert [part.shape for part in slopes] == [part.shape for part in found]
    rounding = 5e-6 if loss.robot.body.parts else 1e-6  # forces of rigid parts are rounded to more
    assert agree(np.concatenate(slopes), np.concatenate(found), within=rounding)


def test_by_body_and_pins(loss: Loss) -> None:
    """A pin that is left to its default follows the body, so here it has a stiffness of its own."""
    given = replace(loss.robot.pins[0], stiffness=float(loss.robot.pins[0].stiffness))
    loss = Loss(replace(loss.robot, pins=(given,)), loss.contractions)
    slopes, robot = loss.slopes(), loss.robot
    assert slopes.young == pytest.approx(loss.by_material("young", 300.0), rel=1e-6)
    assert slopes.poisson == pytest.approx(loss.by_material("poisson", 1e-3), rel=1e-5)
    pin = robot.pins[0]
    found = loss.difference(lambda h: replace(robot, pins=(replace(pin, stiffness=pin.stiffness + h),)), 30.0)
    assert slopes.pin_stiffness == pytest.approx(found, rel=1e-5)
    if robot.gravity is None:
        assert slopes.density == 0.0
    else:
        assert slopes.density == pytest.approx(loss.by_material("density", 1.0), rel=1e-6)
    if robot.body.thickness is None:
        assert slopes.thickness is None
    else:
        thick = robot.body.thickness
        found = loss.difference(lambda h: with_body(robot, thickness=thick + h), 3e-4)
        assert slopes.thickness == pytest.approx(found, rel=1e-6)


@pytest.mark.parametrize("make", [in_parts, with_foam])
def test_by_numbers_of_parts(make: Callable[[Robot], Robot], unchecked: None) -> None:
    loss = Loss(make(strip()), np.array([0.02, 0.009]))
    slopes, (stiff, end) = loss.slopes(), loss.robot.body.parts
    material = stiff.material
    assert material is not None

    def change(**values: float) -> Robot:
        return with_body(loss.robot, parts=(replace(stiff, material=replace(material, **values)), end))

    for name, step in (("young", 900.0), ("poisson", 1e-3), ("density", 30.0)):
        found = loss.difference(lambda h, name=name: change(**{name: getattr(material, name) + h}), step)
        assert getattr(slopes, f"part_{name}")[0] == pytest.approx(found, rel=1e-5)
    heavier = loss.difference(lambda h: with_body(loss.robot, parts=(stiff, replace(end, density=1240.0 + h))), 100.0)
    assert slopes.part_density[1] == pytest.approx(heavier, rel=1e-5)
    assert slopes.part_young[1] == slopes.part_poisson[1] == 0.0


def test_the_projected_hessian_or_a_wrong_sign_would_fail() -> None:
    """The check can fail, and why E16 asks for the full Hessian."""
    loss = Loss(strip(), np.array([0.05, 0.0095]))
    simulation, pose = loss.simulation, loss.pose
    lifted = simulation.assembly.stiffness(pose.nodes, pose.contractions, projection=1.0)
    wrong = sensitivities(
        simulation.body,
        simulation.assembly,
        simulation.cables,
        pose,
        rows=(loss.nodes[None], loss.tensions[None]),
        points=route_points(loss.robot),
        response=lifted.solve,
    )[0]
    right, found = loss.slopes(), loss.by_contractions()
    assert agree(right.contractions, found)
    assert not agree(wrong.contractions, found, within=1e-3)
    assert not agree(-right.contractions, found, within=1e-3)
    routes = loss.by_routes(1e-5)
    assert not agree(np.concatenate(wrong.routes), np.concatenate(routes), within=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_rows_together_have_the_gradients_of_each(friction: float) -> None:
    """Oracle: the adjoint of each row alone, by nodes and by tensions, with and without cable friction."""
    robot = in_parts(strip())
    robot = robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in robot.cables])
    simulation = Simulation(robot)
    pose, rng = simulation.solve([0.02, 0.009]), np.random.default_rng(2)
    nodes, tensions = rng.standard_normal((3, *pose.nodes.shape)), rng.standard_normal((3, len(pose.tensions)))
    for found, by_node, by_tension in zip(simulation.adjoints(pose, (nodes, tensions)), nodes, tensions, strict=True):
        alone = simulation.adjoint(pose, by_node, tensions=by_tension)
        for field in fields(alone):
            values = (getattr(each, field.name) for each in (found, alone))
            one, other = (
                np.concatenate([np.ravel(part) for part in value]) if field.name == "routes" else np.ravel(value)
                for value in values
            )
            assert one == pytest.approx(other, rel=1e-8, abs=1e-8 * np.abs(other).max(initial=0.0)), field.name


def test_by_contractions_it_is_the_jacobian_transposed() -> None:
    loss = Loss(strip(), np.array([0.02, 0.009]))
    slopes = loss.simulation.adjoint(loss.pose, loss.nodes).contractions
    expected = np.einsum("ndw,nd->w", loss.simulation.jacobian(loss.pose), loss.nodes)
    assert slopes == pytest.approx(expected, rel=1e-9)


def test_all_stiffnesses_together_change_no_weightless_pose() -> None:
    """Oracle: Euler's theorem; the pose is homogeneous of degree 0 in Young's modulus and the springs."""
    loss = Loss(strip(), np.array([0.02, 0.009]))
    slopes = loss.simulation.adjoint(loss.pose, loss.nodes)
    springs = slopes.cable_stiffness @ [cable.stiffness for cable in loss.robot.cables]
    springs += slopes.pin_stiffness @ [pin.stiffness for pin in loss.robot.pins]
    assert loss.robot.body.material.young * slopes.young == pytest.approx(-springs, rel=1e-8)
    assert loss.robot.body.thickness is not None
    assert slopes.thickness is not None
    assert loss.robot.body.thickness * slopes.thickness == pytest.approx(-springs, rel=1e-8)


def test_a_slack_cable_has_no_slopes() -> None:
    slopes = Loss(strip(), np.array([0.02, -0.01])).slopes()
    assert slopes.contractions[1] == slopes.slack[1] == slopes.cable_stiffness[1] == 0.0
    assert not slopes.routes[1].any()
    assert slopes.routes[0].all()


def test_a_point_inside_a_sheath_has_no_slopes() -> None:
    slopes = Loss(strip(sheathed=((0, 2),)), np.array([0.02, 0.0])).slopes().routes[0]
    assert not slopes[:2].any()
    assert slopes[2:].all()


@pytest.mark.parametrize("toward", [1.0, -1.0])
def test_on_the_border_of_two_elements_it_is_that_of_the_one_that_holds_the_point(toward: float) -> None:
    """Oracle: one-sided differences, which agree on the side of that element alone."""
    points = (UPPER[0], (0.05, 0.0131), *UPPER[2:])  # on the edge x = 50 mm
    robot = strip()
    robot = with_cable(robot, 0, replace(robot.cables[0], points=points))
    loss = Loss(robot, np.array([0.02, 0.009]))
    mesh = robot.body.mesh
    held = locate(mesh, np.array([points[1]])).stencils[0]
    side = np.sign(mesh.nodes[held, 0].mean() - 0.05)
    shift = np.zeros((4, 2))
    shift[1, 0] = toward

    def forward(step: float) -> float:
        ahead = loss.at(moved(robot, 0, step * shift)), loss.at(moved(robot, 0, 2 * step * shift))
        return (4 * ahead[0] - ahead[1] - 3 * loss.at(robot)) / (2 * step)

    slope = toward * loss.slopes().routes[0][1, 0]
    assert agree(np.array(slope), np.array(forward(1e-6)), within=1e-4) == (side == toward)


@pytest.mark.parametrize("beside", [(0.1129, 0.0281), (0.2013, 0.0269)])
def test_a_point_beside_the_mesh_moves_with_its_nearest_place(beside: tuple[float, float]) -> None:
    """Inside the drawing, but off its mesh: by an edge, and by a corner, where it does not move at all."""
    robot = strip()
    corners = np.array([[-0.003, -0.03], [0.203, -0.03], [0.203, 0.03], [-0.003, 0.03]])
    robot = with_body(robot, outline=Outline(corners))
    robot = with_cable(robot, 0, replace(robot.cables[0], points=(*UPPER[:2], beside)))
    loss = Loss(robot, np.array([0.02, 0.009]))
    slopes, found = loss.slopes().routes, loss.by_routes(1e-5)
    assert agree(np.concatenate(slopes), np.concatenate(found))
    assert slopes[0][2, 1] == pytest.approx(0.0, abs=1e-12)
    assert (slopes[0][2, 0] == 0.0) == (beside[0] > 0.2)


def test_what_does_not_fit_is_refused() -> None:
    loss = Loss(strip(), np.array([0.02, 0.009]))
    with pytest.raises(InputError, match=r"cotangent of nodes must be finite numbers of shape \(27, 2\)"):
        loss.simulation.adjoint(loss.pose, loss.nodes[:-1])
    with pytest.raises(InputError, match="cotangent of nodes"):
        loss.simulation.adjoint(loss.pose, np.nan * loss.nodes)
    with pytest.raises(InputError, match="cotangent of tensions"):
        loss.simulation.adjoint(loss.pose, loss.nodes, tensions=np.zeros(3))
    other = Simulation(box())
    with pytest.raises(InputError, match="the pose is of another robot"):
        other.adjoint(loss.pose, np.zeros(other.assembly.shape))


@pytest.mark.parametrize("pose", [None, {"up": 0.02}])
def test_only_a_solved_pose_has_an_adjoint(pose: Any, unchecked: None) -> None:
    simulation = Simulation(strip())
    with pytest.raises(InputError, match=f"needs an Equilibrium, as solve.. returns it, not a {type(pose).__name__}"):
        simulation.adjoint(pose, simulation.rest.nodes)
    words: Any = "up"
    with pytest.raises(InputError, match=r"cotangent of nodes must be numbers of shape .*, not 'up'"):
        simulation.adjoint(simulation.rest, words)


def test_a_robot_without_cables_has_slopes_of_its_weight() -> None:
    robot = replace(heavy_patches(strip()), winches=(), cables=())
    loss = Loss(robot, np.zeros(0))
    slopes = loss.slopes()
    assert slopes.routes == ()
    assert slopes.density == pytest.approx(loss.by_material("density", 1.0), rel=1e-6)


def test_the_page_on_derivatives_is_true(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the Jacobian, whose columns are solved one by one."""
    root = Path(__file__).parents[2]
    monkeypatch.chdir(root)
    page = (root / "docs" / "theory" / "derivatives.md").read_text()
    plain, bridged = (part.split("```")[0] for part in page.split("```python")[1:])
    names: dict[str, Any] = {}
    exec(plain, names)
    jacobian = names["simulation"].jacobian(names["pose"])
    expected = np.einsum("ndw,nd->w", jacobian, names["nodes"])
    assert names["sensitivity"].contractions == pytest.approx(expected, rel=1e-8)
    pytest.importorskip("torch", exc_type=ImportError)
    exec(bridged, names)
    assert names["contractions"].grad.numpy() == pytest.approx(expected, rel=1e-6)
    assert names["routes"][1].grad.numpy() == pytest.approx(names["sensitivity"].routes[1], rel=1e-5, abs=1e-9)


def test_by_gravity_and_stiffness_of_rods(unchecked: None) -> None:
    heavy = heavy_patches(box())
    wire = Rod(
        name="wire",
        points=((0.0, 0.021, 0.019), (0.12, 0.021, 0.019)),
        axial_stiffness=50.0,
        bending_stiffness=2e-3,
        torsional_stiffness=3e-3,
    )
    loss = Loss(
        replace(heavy, rods=(wire,), loads=(Load(name="nut", marker="tip", mass=0.004),)), np.array([0.006, 0.002])
    )
    slopes, robot = loss.slopes(), loss.robot
    for axis in range(3):
        step = 0.02 * np.eye(3)[axis]
        found = loss.difference(
            lambda h, step=step: replace(robot, gravity=tuple((np.array(robot.gravity) + h * step).tolist())), 1.0
        )
        assert slopes.gravity[axis] * 0.02 == pytest.approx(found, rel=1e-4)
    for key, slope, step in (
        ("axial_stiffness", slopes.rod_axial, 0.5),
        ("bending_stiffness", slopes.rod_bending, 2e-5),
        ("torsional_stiffness", slopes.rod_torsion, 3e-5),
    ):
        found = loss.difference(
            lambda h, key=key: replace(robot, rods=(replace(wire, **{key: getattr(wire, key) + h}),)), step
        )
        assert slope[0] == pytest.approx(found, rel=1e-4)
