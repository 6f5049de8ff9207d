"""Robots that touch themselves and obstacles. Oracles: ipctk, crossings, whole solves, the body without contact."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from touching import DISTANCE, fork_robot

from hydrostat.errors import InputError
from hydrostat.geometry import BoundaryTree, find_crossings
from hydrostat.ik import solve_ik
from hydrostat.mechanics import Assembly, NewtonOptions, SelfContactEnergy
from hydrostat.robot import Contact, Obstacle, PoseTarget, Robot
from hydrostat.simulation import Simulation

PULLED = {"up": 0.02, "down": 0.016}


def crossings(robot: Robot, nodes: np.ndarray) -> int:
    return len(find_crossings(robot.body.mesh, nodes))


@pytest.mark.parametrize("dim", [2, 3])
def test_prongs_meet_and_do_not_cross(dim: int) -> None:
    free, touching = (Simulation(fork_robot(dim, contact=contact)) for contact in (False, True))
    assert crossings(free.robot, free.solve(PULLED).nodes) > 0
    pose = touching.solve(PULLED)
    assert crossings(touching.robot, pose.nodes) == 0
    assert np.abs(touching.forces(pose.nodes, pose.contractions)).max() <= pose.result.allowed
    energy = next(each for each in touching.assembly.energies if isinstance(each, SelfContactEnergy)).with_active_terms(
        pose.nodes
    )
    squared, begins = energy.skin.compute_squared_distances(pose.nodes, energy.pairs), energy.skin.begins(energy.pairs)
    felt = squared < begins
    assert felt.any()
    assert (squared[felt] / begins[felt]).min() ** 0.5 > 0.3


@pytest.mark.parametrize("dim", [2, 3])
def test_random_contractions(dim: int) -> None:
    """None crosses, by ipctk in space; where nothing touches the pose is the one without contact."""
    robot = fork_robot(dim)
    free, touching = Simulation(fork_robot(dim, contact=False)), Simulation(robot)
    touched = 0
    for contractions in np.random.default_rng(4).uniform(0, 0.03, (12, 2)):
        pose, other = touching.solve(contractions), free.solve(contractions)
        assert crossings(robot, pose.nodes) == 0
        if dim == 3:
            assert not crosses(robot, pose.nodes)
        energy = next(each for each in touching.assembly.energies if isinstance(each, SelfContactEnergy))
        if energy.with_active_terms(pose.nodes).value(pose.nodes, contractions) == 0.0 and not crossings(
            robot, other.nodes
        ):
            np.testing.assert_allclose(pose.nodes, other.nodes, atol=1e-8)
        else:
            touched += 1
    assert 3 <= touched <= 12


def crosses(robot: Robot, nodes: np.ndarray) -> bool:
    """Whether a body in space crosses itself, by an independent program."""
    ipctk = pytest.importorskip("ipctk")
    facets = robot.body.mesh.boundary
    outer, mapped = np.unique(facets, return_inverse=True)
    mapped = mapped.reshape(facets.shape)
    mesh = ipctk.CollisionMesh(robot.body.mesh.nodes[outer], ipctk.edges(mapped), mapped)
    return bool(ipctk.has_intersections(mesh, nodes[outer]))


def test_the_way_does_not_matter() -> None:
    """From rest at once, or step by step from pose to pose, where prongs cannot slide past each other sideways."""
    simulation = Simulation(fork_robot(2))
    pose = simulation.solve(PULLED)
    streamed = None
    for share in np.linspace(0.05, 1, 20):
        streamed = simulation.solve({name: share * pull for name, pull in PULLED.items()}, start=streamed)
    assert streamed is not None
    np.testing.assert_allclose(streamed.nodes, pose.nodes, atol=1e-7)


@pytest.mark.parametrize("dim", [2, 3])
def test_slopes_through_contact(dim: int) -> None:
    """Jacobian and adjoint against differences of whole solves."""
    simulation = Simulation(fork_robot(dim), options=NewtonOptions(tolerance=1e-12))
    pose = simulation.solve(PULLED)
    slopes = simulation.jacobian(pose)
    weights = np.random.default_rng(1).normal(size=pose.nodes.shape)

    def difference(move: np.ndarray) -> np.ndarray:
        ahead, behind = (simulation.solve(pose.contractions + sign * move, start=pose).nodes for sign in (1, -1))
        return (ahead - behind) / (2 * np.abs(move).sum())

    for number, move in enumerate(1e-7 * np.eye(2)):
        wanted = (4 * difference(0.5 * move) - difference(move)) / 3  # Richardson: the barrier bends sharply
        assert np.abs(slopes[:, :, number] - wanted).max() < 1e-6 * np.abs(wanted).max()
    found = simulation.adjoint(pose, weights).contractions
    np.testing.assert_allclose(found, np.einsum("nd,ndw->w", weights, slopes), rtol=1e-8)


def test_slopes_of_a_solved_pose_need_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the Jacobian of the same pose without its factors, which searches for pairs again."""
    simulation = Simulation(fork_robot(3))
    pose = simulation.solve(PULLED)
    wanted = simulation.jacobian(pose.without_factors())
    monkeypatch.delattr(BoundaryTree, "sweep")
    np.testing.assert_allclose(simulation.jacobian(pose), wanted, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize("dim", [2, 3])
def test_what_a_pose_knows_of_its_pairs_serves_the_next_solve(dim: int) -> None:
    """The same pose, without a new pattern; what is sent to another process takes none along."""
    simulation = Simulation(fork_robot(dim))
    pose, onward = simulation.solve(PULLED), {name: 1.002 * pull for name, pull in PULLED.items()}
    found = simulation.solve(onward, start=pose)
    anew = simulation.solve(onward, start=pose.without_factors())
    np.testing.assert_allclose(found.nodes, anew.nodes, atol=1e-8)
    sources = [each.result.stiffness.source for each in (pose, found)]
    assert isinstance(sources[0], Assembly)
    assert isinstance(sources[1], Assembly)
    assert sources[1].pattern.entries is sources[0].pattern.entries
    assert len(sources[1].pattern.entries) > len(simulation.assembly.pattern.entries)
    assert pickle.loads(pickle.dumps(pose)).result.stiffness.source is None
    other = Simulation(fork_robot(dim))
    assert other.assembly.continuing(sources[0]) is other.assembly


def test_inverse_kinematics_keeps_prongs_apart() -> None:
    """A target behind the other prong: the answer without contact lies within it, the one with contact does not."""
    pose = PoseTarget(name="through", targets={"tip": (0.1, -0.012)})
    free, touching = (replace(fork_robot(2, contact=contact), poses={"through": pose}) for contact in (False, True))
    assert crossings(free, solve_ik(Simulation(free), pose).pose.nodes) > 0
    reached = solve_ik(Simulation(touching), pose)
    assert crossings(touching, reached.pose.nodes) == 0


def test_motion_does_not_pass_through() -> None:
    """Pulled at once, without viscosity: the prongs fly together."""
    simulation = Simulation(fork_robot(2))
    motion = simulation.motion_at_rest()
    least = np.inf
    for _ in range(25):
        motion = simulation.step(motion, PULLED, 4e-3)
        assert crossings(simulation.robot, motion.nodes) == 0
        least = min(least, motion.markers["tip"][1])
    assert least < 0.0  # it has bent as far as the other prong lets it


@pytest.mark.parametrize("dim", [2, 3])
def test_a_wall_stops_a_prong(dim: int) -> None:
    """The outer side rests on a plane: its gap is a share of the distance, and pulling more presses more."""
    up = (0.0, 1.0, 0.0)[:dim]
    wall = Obstacle(name="wall", shape="plane", at=(0.0, -0.03, 0.0)[:dim], normal=up)
    robot = replace(fork_robot(dim), obstacles=(wall,))
    simulation = Simulation(robot)
    gaps = []
    for pull in (0.012, 0.02):
        nodes = simulation.solve({"up": pull}).nodes
        gaps.append(wall.field()(nodes).values.min())
        assert crossings(robot, nodes) == 0
    free = Simulation(replace(robot, obstacles=())).solve({"up": 0.02}).nodes
    assert wall.field()(free).values.min() < 0
    assert 0.3 * DISTANCE < gaps[1] < gaps[0] < DISTANCE


def test_a_start_that_crosses_itself_is_refused() -> None:
    crossed = Simulation(fork_robot(2, contact=False)).solve(PULLED)
    with pytest.raises(InputError, match=r"no solve can begin there: self-intersection, e\.g\. at \["):
        Simulation(fork_robot(2)).solve(PULLED, start=crossed)


def test_a_gallery_body() -> None:
    """The starfish, pulled so far that its limbs meet: with contact of its default distance none crosses."""
    robot = replace(gallery_robot("starfish"), contact=Contact())
    simulation = Simulation(robot)
    pulled = {winch.name: 0.9 * winch.travel for winch in robot.winches}
    assert crossings(robot, simulation.solve(pulled).nodes) == 0
    assert crossings(robot, Simulation(gallery_robot("starfish")).solve(pulled).nodes) > 0


@pytest.mark.parametrize("dim", [2, 3])
def test_simulations_with_contact_and_obstacles_can_be_shared(dim: int) -> None:
    """Sent to another process, or asked by two threads: the same bytes."""
    up, far = (0.0, 1.0, 0.0)[:dim], (0.2, 0.05, 0.01)[:dim]
    others = {"sphere": {"radius": 0.01}, "capsule": {"to": (0.25, 0.05, 0.01)[:dim], "radius": 0.01}}
    obstacles = (
        Obstacle(name="wall", shape="plane", at=(0.0, -0.03, 0.0)[:dim], normal=up),
        Obstacle(name="box", shape="box", at=far, to=(0.25, 0.06, 0.02)[:dim]),
        *(Obstacle(name=shape, shape=shape, at=far, **given) for shape, given in others.items()),
    )
    simulation = Simulation(replace(fork_robot(dim), obstacles=obstacles))
    pulls = np.random.default_rng(5).uniform(0, 0.025, (4, 2))
    nodes = [simulation.solve(pull).nodes for pull in pulls]
    sent = pickle.loads(pickle.dumps(simulation))
    np.testing.assert_array_equal(sent.solve(pulls[0]).nodes, nodes[0])
    many = simulation.solve_batch(pulls, threads=2, nodes=True, jacobians=False)
    np.testing.assert_array_equal(many.nodes, nodes)
