"""Energies that the house does not know plug in by list. Oracles: their contract, balance, finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot
from toy_energies import Floor, Magnet, SluggishTie, YieldingTie

from hydrostat.errors import InputError
from hydrostat.ik import solve_ik
from hydrostat.mechanics import (
    Assembly,
    DeadLoadEnergy,
    Energy,
    FrictionalSelfContactEnergy,
    FrictionCableEnergy,
    ObstacleEnergy,
)
from hydrostat.simulation import ContractionProfile, Simulation
from hydrostat.testing import check_energy

ROBOT = strip_robot(columns=12, rows=3)
NODES = ROBOT.body.mesh.nodes
PULL = np.array([0.01, 0.0])
TIP = int(np.argmax(NODES[:, 0] + NODES[:, 1]))
ROOT = int(np.argmin(NODES[:, 0] - NODES[:, 1]))
FLOOR = float(NODES[:, 1].min()) - 0.002


def toys() -> dict[str, Energy]:
    return {
        "magnet": Magnet(TIP, ROOT, strength=1e-3, control=0),
        "floor": Floor(FLOOR, reach=0.01, stiffness=1e-2),
        "tie": YieldingTie(NODES, TIP, stiffness=5.0, limit=0.02),
    }


@pytest.mark.parametrize("name", toys())
def test_the_toys_keep_the_contract(name: str) -> None:
    bent = NODES + np.array([0.0, 0.02]) * (NODES[:, :1] / NODES[:, 0].max()) ** 2
    energy = toys()[name].with_active_terms(bent)
    check_energy(energy, bent, np.array([0.3, 0.1]), tolerance=1e-5)


def test_a_magnet_pulls_the_tip_and_has_exact_slopes() -> None:
    """Oracles: forces balance; D nodes / d contractions, to which the magnet's own control adds, by differences."""
    plain, pulled = Simulation(ROBOT), Simulation(ROBOT, energies=[toys()["magnet"]])
    pose = pulled.solve(PULL)
    apart = [np.linalg.norm(found.nodes[TIP] - found.nodes[ROOT]) for found in (plain.solve(PULL), pose)]
    assert apart[1] < apart[0] - 1e-4
    assert np.abs(pulled.forces(pose.nodes, pose.contractions)).max() <= pose.result.allowed
    step = np.array([1e-6, 0.0])
    found = (pulled.solve(PULL + step).nodes - pulled.solve(PULL - step).nodes) / 2e-6
    exact = pulled.jacobian(pose)[:, :, 0]
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()
    assert np.abs(plain.jacobian(plain.solve(PULL))[:, :, 0] - exact).max() > 1e-2 * np.abs(exact).max()


def test_a_floor_holds_and_its_terms_come_and_go() -> None:
    """Oracle: the same floor with a term for every node. The lower cable would pull the tip far below it."""
    down = np.array([0.0, 0.02])
    floor, every = toys()["floor"], Floor(FLOOR, reach=0.01, stiffness=1e-2, every=True, count=len(NODES))
    assert isinstance(floor, Floor)
    simulation = Simulation(ROBOT, energies=[floor])
    pose, other = simulation.solve(down), Simulation(ROBOT, energies=[every]).solve(down)
    assert Simulation(ROBOT).solve(down).nodes[:, 1].min() < FLOOR - 0.01
    assert FLOOR < pose.nodes[:, 1].min() < FLOOR + 0.01
    assert np.abs(pose.nodes - other.nodes).max() < 1e-8
    touching = simulation.assembly.with_active_terms(pose.nodes)
    assert 0 < len(touching.energies[-1].stencils) < len(NODES)
    assert touching.pattern.analysis is simulation.assembly.pattern.analysis  # nodes alone are no new pairs
    exact, h = simulation.jacobian(pose)[:, :, 1], np.array([0.0, 1e-6])
    found = (simulation.solve(down + h, start=pose).nodes - simulation.solve(down - h, start=pose).nodes) / 2e-6
    assert np.abs(found - exact).max() < 1e-4 * np.abs(exact).max()


def test_no_step_passes_through_a_floor() -> None:
    """Oracle: a floor so thin that a free step from high above leads far below it, where it would not be felt."""
    floor = Floor(FLOOR, reach=1e-4, stiffness=1e2)
    pose = Simulation(ROBOT, energies=[floor]).solve(np.array([0.0, 0.02]), strict=False)
    assert floor.asked > 0
    assert pose.nodes[:, 1].min() > FLOOR


def test_a_pair_that_never_met_is_analysed_anew() -> None:
    """Oracle: an assembly made with it from the start."""
    simulation, magnet = Simulation(ROBOT), toys()["magnet"]

    class Reach(Magnet):
        """It is there only while the tip is above its rest."""

        def with_active_terms(self, nodes: np.ndarray) -> Energy:
            return magnet if nodes[TIP, 1] > NODES[TIP, 1] else far

    far = Reach(TIP, TIP, strength=0.0, control=0)
    far.stencils = far.stencils[:0]
    far.controls = far.controls[:0]
    assembly = simulation.assembly.with_added_energies([far], control_count=2)
    raised = NODES + np.array([0.0, 1e-3])
    near, below = assembly.with_active_terms(raised), assembly.with_active_terms(NODES - np.array([0.0, 1e-3]))
    assert below is assembly
    assert near.pattern.analysis is not assembly.pattern.analysis
    fresh = Assembly(near.energies, rest=NODES, control_count=2)
    expected, right = fresh.hessian(raised, PULL).toarray(), np.arange(NODES.size, dtype=float)
    assert near.hessian(raised, PULL).toarray() == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    solved, wanted = near.stiffness(raised, PULL).solve(right), fresh.stiffness(raised, PULL).solve(right)
    assert solved == pytest.approx(wanted, abs=1e-8 * np.abs(wanted).max())


def test_a_tie_that_yields_remembers_the_way() -> None:
    """Oracles: the force of the tie never exceeds its limit, and after a pull and back the body is not as before."""
    tie = toys()["tie"]
    simulation = Simulation(ROBOT, energies=[tie])
    there = simulation.solve(np.array([0.03, 0.0]))
    back = simulation.solve(np.zeros(2), start=there)
    assert isinstance(tie, YieldingTie)
    for pose in (there, back):
        assert pose.result.converged
        slipped = tie.with_history(pose.history, pose.nodes, pose.contractions)
        assert tie.stiffness * np.linalg.norm(slipped._off(pose.nodes)) <= 1.0001 * tie.limit
    assert np.linalg.norm(there.history) > 1e-3
    assert np.linalg.norm(back.nodes[TIP] - simulation.rest.nodes[TIP]) > 1e-4
    assert (simulation.rest.history == 0).all()


@pytest.mark.parametrize(("patience", "fits"), [(8, False), (20, True)])
def test_an_energy_says_how_patient_its_corrections_are(patience: int, fits: bool) -> None:
    """Oracle: a tie whose first ten corrections change nothing, beside one that yields at the first."""
    tie = toys()["tie"]
    assert isinstance(tie, YieldingTie)
    slow = SluggishTie(NODES, TIP, stiffness=tie.stiffness, limit=tie.limit)
    slow.max_stalled_corrections = patience  # type: ignore[misc]
    goal = np.array([0.03, 0.0])
    prompt = Simulation(ROBOT, energies=[tie]).solve(goal)
    found = Simulation(ROBOT, energies=[slow]).solve(goal, strict=False)
    assert found.result.converged is fits
    if fits:
        assert np.abs(found.nodes - prompt.nodes).max() < 1e-5


def test_contact_friction_is_more_patient_than_cables() -> None:
    """Oracle: decision 0031, where eight corrections are too few for a grasp."""
    assert FrictionCableEnergy.max_stalled_corrections == 8
    assert min(ObstacleEnergy.max_stalled_corrections, FrictionalSelfContactEnergy.max_stalled_corrections) == 40


def test_the_adjoint_counts_the_controls_of_all_energies() -> None:
    """Oracle: the Jacobian; the density of a robot without weight moves nothing, whatever hangs at its tip."""
    forces = np.zeros_like(NODES)
    forces[TIP] = [0.0, -0.01]
    simulation = Simulation(ROBOT, energies=[toys()["magnet"], DeadLoadEnergy(NODES, forces)])
    pose, cotangent = simulation.solve(PULL), np.random.default_rng(0).standard_normal(NODES.shape)
    slopes = simulation.adjoint(pose, cotangent)
    expected = np.einsum("nd,ndw->w", cotangent, simulation.jacobian(pose))
    assert slopes.contractions == pytest.approx(expected, rel=1e-8)
    assert slopes.density == 0.0


def test_what_remembers_and_what_comes_and_goes_go_together() -> None:
    """Oracle: the same with a floor whose terms are always there."""
    down = np.array([0.0, 0.02])
    poses = []
    for every in (False, True):
        floor = Floor(FLOOR, reach=0.01, stiffness=1e-2, every=every, count=len(NODES))
        simulation = Simulation(ROBOT, energies=[toys()["tie"], floor])
        pose = simulation.solve(down)
        poses.append((pose, simulation.stiffness(pose).solve(np.arange(NODES.size, dtype=float))))
    (one, moved), (other, expected) = poses
    assert np.abs(one.nodes - other.nodes).max() < 1e-8
    assert one.energy == pytest.approx(other.energy, rel=1e-6)
    assert moved == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_friction_and_another_memory_go_together() -> None:
    """Oracle: the slips of the cables come first in what is remembered; a derivative of both is refused."""
    rubbing = replace(ROBOT, cables=tuple(replace(cable, friction=0.3) for cable in ROBOT.cables))
    alone, both = Simulation(rubbing), Simulation(rubbing, energies=[toys()["tie"]])
    pose = both.solve(PULL)
    assert pose.result.converged
    assert len(pose.history) == len(alone.solve(PULL).history) + 2
    assert (pose.tensions > 0).any()
    with pytest.raises(InputError, match="derivatives follow"):
        both.jacobian(pose)


def test_inverse_kinematics_refuses_what_it_does_not_know() -> None:
    for name, words in (("magnet", "follows winches"), ("tie", "remembers the way")):
        with pytest.raises(InputError, match=words):
            solve_ik(Simulation(ROBOT, energies=[toys()[name]]), {"tip": (0.19, 0.02)})


def test_a_guess_beneath_the_floor_is_no_guess() -> None:
    """Oracle: motion with a floor whose terms are always there."""
    ends = []
    for every in (False, True):
        floor = Floor(FLOOR, reach=5e-3, stiffness=1e-2, every=every, count=len(NODES))
        simulation = Simulation(ROBOT, energies=[floor])
        profile = ContractionProfile(times=np.array([0.0, 0.1]), values=np.array([[0.0, 0.0], [0.0, 0.02]]))
        *_, last = simulation.play(profile, 0.2, 0.05)
        ends.append(last.nodes)
    assert np.abs(ends[0] - ends[1]).max() < 1e-6


def test_a_pose_whose_nodes_were_moved_brings_no_factors() -> None:
    """Oracle: factors made again at the moved nodes."""
    simulation = Simulation(ROBOT)
    pose = simulation.solve(PULL)
    moved = replace(pose, nodes=pose.nodes + 1e-3 * np.sin(40 * pose.nodes))
    right = np.arange(NODES.size, dtype=float)
    expected = simulation.assembly.stiffness(moved.nodes, moved.contractions).solve(right)
    assert simulation.stiffness(moved).solve(right) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("columns", [1, 3])
def test_a_profile_of_other_winches_is_refused(columns: int) -> None:
    profile = ContractionProfile(times=np.array([0.0, 1.0]), values=np.zeros((2, columns)))
    with pytest.raises(InputError, match=f"{columns} contractions given for 2 winches"):
        list(Simulation(ROBOT).play(profile, 0.1, 0.05))


@pytest.mark.parametrize("wrong", [["gravity"], [Magnet(0, 9999, strength=1.0, control=0)]])
@pytest.mark.usefixtures("unchecked")
def test_what_is_no_energy_of_this_body_is_refused(wrong: list) -> None:
    with pytest.raises(InputError, match=r"no Energy|nodes from 0 to"):
        Simulation(ROBOT, energies=wrong)
