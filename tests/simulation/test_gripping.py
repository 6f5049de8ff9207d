"""Friction on obstacles, and obstacles that move. Oracles: Coulomb, Euler-Eytelwein, Newton, conservation."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import FOAM, box_mesh, box_robot, mesh_body, strip_mesh, strip_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import DeadLoadEnergy, GuideEnergy, RigidBodyDofs
from hydrostat.robot import Contact, Marker, Obstacle, Pin, Robot
from hydrostat.simulation import (
    BodyPhysics,
    Equilibrium,
    Motion,
    Simulation,
    StepOptions,
    obstacle_forces,
    with_replaced,
)

FRICTION, MASS, WEIGHT = 0.4, 0.05, 0.05 * 9.81

pytestmark = pytest.mark.usefixtures("unchecked")


def pad(dim: int, *, cells: int = 16, young: float = 3e6, viscosity: float = 0.0, lean: float = 0.0) -> Robot:
    """A pad held at its lower side, and a block a hair above its upper one; gravity leans by an angle [rad]."""
    mesh = (
        strip_mesh(cells, 3 if cells > 8 else 1, size=(0.16, 0.03))
        if dim == 2
        else box_mesh((8, 4, 2), size=(0.08, 0.04, 0.02))
    )
    low, high, up = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0), dim - 1
    below = high + 1e-3
    below[up] = low[up] + 1e-3
    half = np.full(dim, 0.008)
    half[up] = 0.005
    middle = 0.5 * (low + high)
    middle[up] = high[up] + half[up] + 0.6e-3
    block = Obstacle(
        name="block", shape="box", at=tuple(middle - half), to=tuple(middle + half), mass=MASS, friction=FRICTION
    )
    gravity = np.zeros(dim)
    gravity[0], gravity[up] = 9.81 * np.sin(lean), -9.81 * np.cos(lean)
    return Robot(
        name="pad",
        body=mesh_body(mesh, material=replace(FOAM, young=young, viscosity=viscosity)),
        pins=(Pin(box=(tuple(low - 1e-3), tuple(below)), stiffness=1e5),),
        winches=(),
        cables=(),
        markers=(),
        poses={},
        contact=Contact(distance=1e-3),
        obstacles=(block,),
        gravity=tuple(gravity),
    )


class Drag:
    """A block that a spring drags over the pad, step by step."""

    def __init__(self, robot: Robot) -> None:
        body = BodyPhysics(robot)
        self.carriage: RigidBodyDofs = body.rigid_dofs[0]
        self.at, self.axes = robot.obstacles[0].frame()
        across = np.eye(len(self.at))
        across[-1, -1] = 0.0
        self.guide = GuideEnergy(self.carriage, place=self.at, axes=self.axes, along=2e3 * across, turning=0.0)
        self.simulation = Simulation(robot, body=body, energies=[self.guide])
        self.pose = self.simulation.solve({})

    def to(self, way: float) -> np.ndarray:
        """Force [N] that drags when the spring's end has gone so far [m]."""
        guide = self.guide.with_target(self.at + way * np.eye(len(self.at))[0], self.axes)
        self.pose = with_replaced(self.simulation, self.guide, guide).solve({}, start=self.pose)
        return guide.pull(self.pose.unknowns)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_block_slips_at_friction_times_its_weight(dim: int) -> None:
    drag = Drag(pad(dim))
    stuck = drag.to(5e-5)[0]
    assert 0.1 * FRICTION * WEIGHT < stuck < 0.9 * FRICTION * WEIGHT
    forces = np.array([drag.to(way)[0] for way in np.arange(1, 8) * 2e-4])
    assert forces[1:] == pytest.approx(FRICTION * WEIGHT, rel=0.01)
    assert obstacle_forces(drag.simulation, drag.pose)[0, -1] == pytest.approx(WEIGHT, rel=1e-6)


@pytest.mark.slow
def test_what_sticks_does_not_creep() -> None:
    """At 0.9 of its limit, and pushed up and down 200 times, it stays within a nanometer each time."""
    drag = Drag(pad(2, cells=8))
    limit = FRICTION * WEIGHT / 2e3
    for way in np.linspace(0, 1, 5)[1:]:
        drag.to(0.9 * limit * way)
    begin = drag.pose.unknowns[drag.carriage.row, 0]
    for number in range(200):
        drag.to((0.9 - 0.05 * (number % 2)) * limit)
    drag.to(0.9 * limit)
    assert drag.pose.unknowns[drag.carriage.row, 0] == pytest.approx(begin, abs=2e-7)


def test_the_force_does_not_depend_on_the_steps() -> None:
    forces = {}
    for steps in (1, 8):
        drag = Drag(pad(2, young=3e4))
        forces[steps] = [drag.to(way)[0] for way in np.linspace(0, 1.6e-3, 2 * steps + 1)[1:]][-1]
    assert forces[1] == pytest.approx(forces[8], rel=0.01)


def test_a_belt_round_a_drum_is_the_capstan() -> None:
    """A quarter turn of a thin belt, held at one end, loaded at the other: exp(mu angle), but for its own bending."""
    friction, radius, thick, distance, angle = 0.3, 0.05, 0.4e-3, 0.2e-3, 0.5 * np.pi
    flat = strip_mesh(80, 1, size=(angle, 1.0))
    turn, out = flat.nodes.T
    reach = radius + 1.05 * distance + thick * (0.5 + out)
    nodes = np.column_stack([-reach * np.cos(turn), reach * np.sin(turn)])
    mesh = Mesh(nodes, flat.elements)
    held, loaded = nodes[np.isclose(turn, 0)], np.isclose(turn, angle)
    box = (tuple(held.min(axis=0) - 1e-4), tuple(held.max(axis=0) + 1e-4))
    belt = Robot(
        name="belt",
        body=mesh_body(mesh, thickness=0.03, material=replace(FOAM, young=1e6, poisson=0.0)),
        pins=(Pin(box=box, stiffness=1e6),),
        winches=(),
        cables=(),
        markers=(),
        poses={},
        contact=Contact(distance=distance),
        obstacles=(Obstacle(name="drum", shape="sphere", at=(0.0, 0.0), radius=radius, friction=friction),),
    )
    forces = np.zeros_like(nodes)
    forces[loaded, 0] = 1.0 / loaded.sum()
    simulation = Simulation(belt, energies=[DeadLoadEnergy(nodes, forces)])
    pose, reaction = simulation.solve({}), np.zeros_like(nodes)
    simulation.body.pins.add_gradient(pose.nodes, np.zeros(0), reaction)
    assert 1.0 / np.linalg.norm(reaction.sum(axis=0)) == pytest.approx(np.exp(friction * angle), rel=0.02)


@cache
def _leaning(lean: float) -> list[Motion]:
    simulation = Simulation(pad(2, viscosity=2000.0, lean=lean))
    motion, motions = simulation.motion_at_rest(), []
    for _ in range(60):
        motion = simulation.step(motion, {}, 5e-3, options=StepOptions(scheme="euler"))
        motions.append(motion)
    return motions


def test_on_a_slope_below_the_limit_it_comes_to_rest_and_stays() -> None:
    """Oracle: tan(0.3) = 0.31 < 0.4."""
    places = np.array([motion.carried[0][0, 0] for motion in _leaning(0.3) if motion.carried is not None])
    assert np.ptp(places[-10:]) < 1e-6
    energies = [motion.energy for motion in _leaning(0.3)]
    assert (np.diff(energies) < 1e-9).all()


def test_it_flies_as_newton_says() -> None:
    """Free fall to rounding; momentum of turning and energy are kept, and it stays rigid."""
    robot = pad(3)
    block = robot.obstacles[0]
    lifted = replace(
        block, at=(*block.at[:2], block.at[2] + 0.5), to=(*(block.to or ())[:2], (block.to or ())[2] + 0.5)
    )
    simulation = Simulation(replace(robot, obstacles=(lifted,)))
    carriage, motion = simulation.body.rigid_dofs[0], simulation.motion_at_rest()
    assert motion.carried is not None
    places, speeds, others = motion.carried
    spin = np.cross(np.eye(3), np.array([3.0, 5.0, 2.0]))
    speeds = np.vstack([[0.3, 0.2, 0.1], carriage.length * np.eye(3) @ -spin])
    motion = replace(motion, carried=(places, speeds, others))
    masses = simulation.body.inertias[carriage.rows]

    def turning(at: Motion) -> np.ndarray:
        assert at.carried is not None
        axes, ways = at.carried[0][1:], at.carried[1][1:]
        return masses[1:] @ np.cross(axes, ways)

    begin, energy = turning(motion), 0.5 * masses[1:] @ (speeds[1:] ** 2).sum(axis=1)
    for _ in range(60):
        motion = simulation.step(motion, {}, 1e-3)
    assert motion.carried is not None
    time, gravity = motion.time, np.array(robot.gravity)
    assert motion.carried[0][0] == pytest.approx(places[0] + time * speeds[0] + 0.5 * time**2 * gravity, abs=1e-9)
    assert turning(motion) == pytest.approx(begin, rel=5e-3)
    assert 0.5 * masses[1:] @ (motion.carried[1][1:] ** 2).sum(axis=1) == pytest.approx(energy, rel=5e-3)
    axes = motion.carried[0][1:] / carriage.length
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-5)


@pytest.mark.parametrize("dim", [2, 3])
def test_slopes_with_an_obstacle_that_moves(dim: int) -> None:
    """How the nodes move with the winches while an object gives way. Oracle: central differences."""
    if dim == 2:
        robot, at = strip_robot(columns=12, rows=3), (0.14, 0.055)
    else:
        robot, at = box_robot(), (0.1, 0.02, 0.0612)
    ball = Obstacle(name="ball", shape="sphere", at=at, radius=0.02, mass=0.05)
    full = replace(robot, contact=Contact(distance=1e-3), obstacles=(ball,))
    body = BodyPhysics(full)
    place, axes = ball.frame()
    guide = GuideEnergy(body.rigid_dofs[0], place=place, axes=axes, along=30.0 * np.eye(dim), turning=1.0)
    simulation = Simulation(full, body=body, energies=[guide])
    winch = robot.winches[0].name
    pose = simulation.solve({winch: 0.03 if dim == 2 else 0.02})
    assert np.abs(obstacle_forces(simulation, pose)).max() > 1e-2
    step = 1e-7 * np.eye(2)[0]
    sides = [simulation.solve(pose.contractions + sign * step, start=pose).nodes for sign in (1, -1)]
    slopes = simulation.jacobian(pose)[..., 0]
    assert np.abs((sides[0] - sides[1]) / 2e-7 - slopes).max() < 1e-4 * np.abs(slopes).max()


def test_inverse_kinematics_leaves_friction_out_and_follows_the_way() -> None:
    robot = strip_robot(columns=12, rows=3)
    tip = robot.body.mesh.nodes.max(axis=0)
    floor = Obstacle(name="floor", shape="plane", at=(0.0, float(-tip[1]) - 2e-3), normal=(0.0, 1.0), friction=0.5)
    simulation = Simulation(replace(robot, contact=Contact(distance=1e-3), obstacles=(floor,)))
    marker: Marker = robot.markers[0]
    target = {marker.name: (marker.at[0] - 2e-3, marker.at[1] - 4e-3)}
    found = hs.solve_ik(simulation, target)
    again: Equilibrium = simulation.solve(found.pose.contractions)
    assert np.array_equal(found.pose.nodes, again.nodes)
    miss = np.linalg.norm(again.markers[marker.name] - target[marker.name])
    assert found.errors[marker.name] == pytest.approx(miss)


def test_what_knows_no_obstacle_that_moves_says_so() -> None:
    ball = Obstacle(name="ball", shape="sphere", at=(0.1, 0.2), radius=0.02, mass=0.05)
    simulation = Simulation(replace(strip_robot(columns=8, rows=2), obstacles=(ball,)))
    with pytest.raises(InputError, match='inverse kinematics knows no obstacle that moves: "ball" has a mass'):
        hs.solve_ik(simulation, {simulation.robot.markers[0].name: (0.1, 0.0)})


def test_a_thing_that_nothing_holds_is_told_and_falls_in_time() -> None:
    """Oracle: free fall."""
    ball = Obstacle(name="ball", shape="sphere", at=(0.1, 0.2), radius=0.02, mass=0.05)
    simulation = Simulation(replace(strip_robot(columns=8, rows=2), obstacles=(ball,), gravity=(0.0, -9.81)))
    with pytest.raises(InputError, match='nothing holds "ball", which has a mass'):
        simulation.solve({})
    motion = simulation.motion_at_rest()
    for _ in range(20):
        motion = simulation.step(motion, {}, 1e-3)
    assert motion.carried is not None
    assert motion.carried[0][0] == pytest.approx((0.1, 0.2 - 0.5 * 9.81 * 0.02**2), abs=1e-9)
